"""Words of the package's tables of data that stand for several: `face_0..67`, `antenna2..16?`."""

import re

_NUMBERED = re.compile(r"(\D*)(\d+)\.\.(\d+)(\D*)")


def expand_words(text: str) -> list[str]:
    """List the words of a text; `a1..3?` is a1?, a2? and a3?."""
    words = list[str]()
    for word in text.split():
        numbered = _NUMBERED.fullmatch(word)
        if numbered is None:
            words.append(word)
            continue
        begin, first, last, end = numbered.groups()
        words += [f"{begin}{number}{end}" for number in range(int(first), int(last) + 1)]
    return words
