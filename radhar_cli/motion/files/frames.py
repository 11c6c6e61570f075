"""Frames as text: numbers by NumPy in blocks, and the line that is wrong."""

import warnings
from collections.abc import Iterator

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.motion.files.recording import MAX_FRAMES, wrong

BLOCK = 2**20  # bytes of text at once
SHOWN = 30


def numbers(text: bytes) -> Float | None:
    """The numbers in a text, None where something else stands in it."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # NumPy warns of text that is no number
            return np.fromstring(text, sep=" ")
    except (ValueError, DeprecationWarning):
        return None


def bvh_frames(data: bytes, start: int, line: int, columns: int, where: str) -> Iterator[Float]:
    """Blocks [frames, columns] of a text with a frame a line, from byte `start` in `line` on."""
    while start < len(data):
        stop = data.find(b"\n", min(start + BLOCK, len(data) - 1)) + 1 or len(data)
        piece = data[start:stop]
        values = numbers(piece)
        whole = values is not None and np.isfinite(values).all()
        lines = piece.count(b"\n") + (not piece.endswith(b"\n"))
        if not whole or values is None or values.size != columns * lines:
            values = _line_by_line(piece, line, columns, where)
        if values.size:
            yield values.reshape(-1, columns)
        start, line = stop, line + piece.count(b"\n")


def _line_by_line(piece: bytes, first: int, columns: int, where: str) -> Float:
    """The numbers of a piece with empty lines, or the error in its first wrong line."""
    rows: list[Float] = [np.empty(0)]
    for line, text in enumerate(piece.split(b"\n"), first):
        if not text.strip():
            continue
        place, row = f"{where}:{line}", numbers(text)
        if row is None or not np.isfinite(row).all():
            raise wrong(place, f"{odd_word(text)!r} should be a number")
        if row.size != columns:
            raise wrong(place, f"has {row.size} numbers; its joints have {columns} channels")
        rows.append(row)
    return np.concatenate(rows)


def odd_word(text: bytes) -> str:
    """The first word of a text that is no finite number, as messages show it."""
    for word in text.split():
        value = numbers(word)
        if value is None or value.size != 1 or not np.isfinite(value).all():
            return word[:SHOWN].decode("ascii", "replace")
    return text[:SHOWN].decode("ascii", "replace")


def stacked(parts: Iterator[Float], where: str) -> Float:
    """The blocks [frames, ...] one after the other; a MotionFileError if there are too many."""
    kept, count = [], 0
    for part in parts:
        kept.append(part)
        count += len(part)
        if count > MAX_FRAMES:
            raise wrong(where, f"has more than {MAX_FRAMES} frames; cut it into pieces")
    return np.concatenate(kept) if kept else np.empty((0, 0, 3))
