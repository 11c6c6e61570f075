"""Text of files from elsewhere, in the encodings in which programs write tables."""

WIDE = {b"\xff\xfe": "utf-16", b"\xfe\xff": "utf-16"}
SAMPLED = 2000  # bytes by which an encoding is told
MOST_ZEROS = 0.05  # share of the bytes that are not the upper halves of letters
LEAST_ZEROS = 0.5  # share of those that are


def decode_text(data: bytes) -> str:
    """Text of bytes in UTF-8, in UTF-16 (as Excel and Windows write), or in Latin-1.

    Raises:
        ValueError: They are no text.
    """
    wide = WIDE.get(data[:2]) or _find_wide(data[:SAMPLED])
    if wide is not None:
        return data.decode(wide, "replace")
    if b"\0" in data:
        raise ValueError("is not a text")
    try:
        return data.decode("utf-8-sig")
    except UnicodeDecodeError:
        return data.decode("latin-1")


def _find_wide(sample: bytes) -> str | None:
    """UTF-16 whose mark is missing: every other byte is mostly zero, and all can be printed."""
    sample = sample[: len(sample) // 2 * 2]
    halves = {"utf-16-le": (sample[1::2], sample[::2]), "utf-16-be": (sample[::2], sample[1::2])}
    for name, (upper, lower) in halves.items():
        size = len(upper)
        if size and upper.count(0) >= LEAST_ZEROS * size and lower.count(0) <= MOST_ZEROS * size:
            text = sample.decode(name, "ignore")
            if all(letter.isprintable() or letter in "\t\r\n\f" for letter in text):
                return name
    return None
