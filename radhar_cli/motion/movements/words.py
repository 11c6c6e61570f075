"""Places that people add to the word for a movement, and that change nothing."""

_SEATS = "chair sofa couch stool bench seat armchair"


def join_words(beginnings: str, ends: str) -> str:
    """Join each of some words with each of others, as one word: `get_up_from_chair`."""
    return " ".join(f"{first}_{last}" for first in beginnings.split() for last in ends.split())


ONTO_SEATS = join_words("on in onto into to", _SEATS)
OFF_SEATS = join_words("from off out_of", _SEATS)
ON_FLOOR = join_words("on onto to from off", "floor ground carpet mat")
