"""Frames as text: NumPy reads numbers in blocks; errors name the line that is wrong."""

import warnings
from collections.abc import Iterator

import numpy as np

from radhar_cli.motion.recorded.recording import MAX_FRAMES, motion_file_error
from radhar_cli.numerics.arrays import Float

BLOCK = 2**20  # bytes of text at once
SHOWN = 30


def parse_numbers(text: bytes) -> Float | None:
    """Numbers [N] in a text; None where something else stands in it."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error")  # NumPy warns of text that is no number
            return np.fromstring(text, sep=" ")
    except (ValueError, DeprecationWarning):
        return None


def bvh_frames(data: bytes, start: int, line: int, columns: int, where: str) -> Iterator[Float]:
    """Read the frames of a BVH in blocks, one frame a line.

    Args:
        data: Bytes of the file.
        start: Byte at which the first frame begins.
        line: Number of the line there.
        columns: Numbers that a frame has.
        where: Name of the file in messages.

    Yields:
        Numbers [frames, columns] of one block.

    Raises:
        MotionFileError: A line has other numbers than its joints have channels.
    """
    while start < len(data):
        stop = data.find(b"\n", min(start + BLOCK, len(data) - 1)) + 1 or len(data)
        piece = data[start:stop]
        values = parse_numbers(piece)
        is_finite = values is not None and np.isfinite(values).all()
        lines = piece.count(b"\n") + (not piece.endswith(b"\n"))
        if not is_finite or values is None or values.size != columns * lines:
            values = _read_lines(piece, line, columns, where)
        if values.size:
            yield values.reshape(-1, columns)
        start, line = stop, line + piece.count(b"\n")


def _read_lines(piece: bytes, first: int, columns: int, where: str) -> Float:
    """Numbers of a piece with empty lines; raises the error of its first wrong line."""
    rows: list[Float] = [np.empty(0)]
    for line, text in enumerate(piece.split(b"\n"), first):
        if not text.strip():
            continue
        place, row = f"{where}:{line}", parse_numbers(text)
        if row is None or not np.isfinite(row).all():
            raise motion_file_error(place, f"{first_bad_number(text)!r} should be a number")
        if row.size != columns:
            raise motion_file_error(
                place, f"has {row.size} numbers; its joints have {columns} channels"
            )
        rows.append(row)
    return np.concatenate(rows)


def first_bad_number(text: bytes) -> str:
    """First word of a text that is no finite number, as messages show it."""
    for word in text.split():
        value = parse_numbers(word)
        if value is None or value.size != 1 or not np.isfinite(value).all():
            return word[:SHOWN].decode("ascii", "replace")
    return text[:SHOWN].decode("ascii", "replace")


def concatenate_blocks(blocks: Iterator[Float], where: str) -> Float:
    """Join blocks of frames [frames, ...].

    Raises:
        MotionFileError: There are more than MAX_FRAMES frames.
    """
    joined, count = [], 0
    for block in blocks:
        joined.append(block)
        count += len(block)
        if count > MAX_FRAMES:
            raise motion_file_error(where, f"has more than {MAX_FRAMES} frames; cut it into pieces")
    return np.concatenate(joined) if joined else np.empty((0, 0, 3))
