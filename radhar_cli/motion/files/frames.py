"""Frames as text: numbers by NumPy in blocks, and the line that is wrong."""

import re
import warnings
from collections.abc import Callable, Iterator

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


def blocks(
    data: bytes, start: int, line: int, cut: Callable[[int], int]
) -> Iterator[tuple[bytes, int]]:
    """Pieces of some MiB of the text from `start` on, and the line in which each begins.

    Args:
        data: the file.
        start: first byte.
        line: number of the line there.
        cut: the end of a piece that should hold at least the byte at this place.
    """
    while start < len(data):
        stop = cut(min(start + BLOCK, len(data) - 1))
        piece = data[start:stop]
        yield piece, line
        start, line = stop, line + piece.count(b"\n")


def bvh_frames(data: bytes, start: int, line: int, columns: int, where: str) -> Iterator[Float]:
    """Blocks [frames, columns] of a text with a frame a line.

    Raises:
        MotionFileError: a line with something that is no number, or too many or too few.
    """

    def next_line(at: int) -> int:
        end = data.find(b"\n", at)
        return len(data) if end < 0 else end + 1

    for piece, first in blocks(data, start, line, next_line):
        values = numbers(piece)
        whole = values is not None and np.isfinite(values).all()
        if not whole or values is None or values.size != columns * count_lines(piece):
            values = _line_by_line(piece, first, columns, where)
        if values.size:
            yield values.reshape(-1, columns)


def count_lines(text: bytes) -> int:
    """Lines of a text, the last one without its end too."""
    return text.count(b"\n") + (not text.endswith(b"\n"))


def _line_by_line(piece: bytes, first: int, columns: int, where: str) -> Float:
    """The numbers of a piece with empty lines, or the error in its first wrong line."""
    rows: list[Float] = [np.empty(0)]
    for line, text in enumerate(piece.split(b"\n"), first):
        if not text.strip():
            continue
        place, row = f"{where}:{line}", numbers(text)
        if row is None or not np.isfinite(row).all():
            raise wrong(place, f"{_odd(text)!r} should be a number")
        if row.size != columns:
            raise wrong(place, f"has {row.size} numbers; its joints have {columns} channels")
        rows.append(row)
    return np.concatenate(rows)


def _odd(text: bytes) -> str:
    """The first word that is no finite number."""
    for word in text.split():
        value = numbers(word)
        if value is None or value.size != 1 or not np.isfinite(value).all():
            return word[:SHOWN].decode("ascii", "replace")
    return text[:SHOWN].decode("ascii", "replace")


FRAME_NUMBER = re.compile(rb"(?m)^[ \t]*\d+[ \t]*\r?$")
NAMED = re.compile(rb"(?m)^[ \t]*[A-Za-z_]\S*")


def amc_frames(
    data: bytes, start: int, line: int, widths: dict[str, int], where: str
) -> Iterator[Float]:
    """Blocks [frames, columns] of an AMC: a frame's number, then lines of a name and numbers.

    Args:
        data: the file.
        start: where the first frame's number begins.
        line: number of the line there.
        widths: {bone: numbers} in the order of the columns.
        where: what messages call the file.

    Raises:
        MotionFileError: a bone missing, unknown or with other numbers; frames out of order.
    """
    order = [name.encode() for name in widths]
    columns, expected = sum(widths.values()), 1

    def next_frame(at: int) -> int:
        match = FRAME_NUMBER.search(data, data.find(b"\n", at) + 1 or len(data))
        return match.start() if match else len(data)

    permutation, names = None, list[bytes]()
    for piece, first in blocks(data, start, line, next_frame):
        if permutation is None:
            names = _names_of_first_frame(piece, first, order, where)
            permutation = _columns(names, order, list(widths.values()))
        listed = [name.strip() for name in NAMED.findall(piece)]
        values = numbers(NAMED.sub(b"", piece))
        count = len(listed) // len(names)
        sound = (
            values is not None
            and np.isfinite(values).all()
            and listed == names * count
            and values.size == count * (columns + 1)
            and (values[:: columns + 1] == np.arange(expected, expected + count)).all()
        )
        if not sound or values is None:
            _refuse_frames(piece, first, widths, names, expected, where)
            raise wrong(f"{where}:{first}", "the frames from here on are not of one kind")
        expected += count
        yield values.reshape(count, columns + 1)[:, 1:][:, permutation]


def _names_of_first_frame(piece: bytes, line: int, order: list[bytes], where: str) -> list[bytes]:
    ends = [match.start() for match in FRAME_NUMBER.finditer(piece)]
    frame = piece[: ends[1]] if len(ends) > 1 else piece
    names = [name.strip() for name in NAMED.findall(frame)]
    for name in names:
        if name not in order:
            shown = name[:SHOWN].decode("ascii", "replace")
            raise wrong(f"{where}:{line}", f"the skeleton has no bone {shown!r} that moves")
    for name in order:
        if names.count(name) != 1:
            raise wrong(f"{where}:{line}", f"frame 1 should have the bone {name.decode()!r} once")
    return names


def _columns(names: list[bytes], order: list[bytes], widths: list[int]) -> list[int]:
    """For each wanted column its place in a frame of the file."""
    starts, at = {}, 0
    for name in names:
        starts[name] = at
        at += widths[order.index(name)]
    return [
        starts[name] + k for name, width in zip(order, widths, strict=True) for k in range(width)
    ]


def _refuse_frames(
    piece: bytes, first: int, widths: dict[str, int], names: list[bytes], expected: int, where: str
) -> None:
    """Find the first line that is wrong in a block of an AMC."""
    left: list[bytes] = []
    for line, text in enumerate(piece.split(b"\n"), first):
        words, place = text.split(), f"{where}:{line}"
        if not words:
            continue
        if len(words) == 1 and words[0].isdigit():
            if left:
                raise wrong(place, f"frame {expected - 1} lacks the bone {left[0].decode()!r}")
            if int(words[0][:18]) != expected:
                shown = words[0][:SHOWN].decode()
                raise wrong(place, f"frame {shown} should be frame {expected}: frames are missing")
            left, expected = list(names), expected + 1
            continue
        name, row = words[0], numbers(b" ".join(words[1:]))
        shown = name[:SHOWN].decode("ascii", "replace")
        if not left or name != left[0]:
            right = left[0].decode() if left else "a frame's number"
            raise wrong(place, f"{shown!r} should be {right!r}, as in the first frame")
        if row is None or not np.isfinite(row).all():
            raise wrong(place, f"{_odd(b' '.join(words[1:]))!r} should be a number")
        if row.size != widths[name.decode()]:
            raise wrong(place, f"{shown} has {row.size} numbers; should have {widths[shown]}")
        del left[0]
    if left:
        raise wrong(f"{where}:{line}", f"the file ends before the bone {left[0].decode()!r}")


def stacked(parts: Iterator[Float], where: str) -> Float:
    """The blocks [frames, ...] one after the other.

    Raises:
        MotionFileError: there are too many frames.
    """
    kept, count = [], 0
    for part in parts:
        kept.append(part)
        count += len(part)
        if count > MAX_FRAMES:
            raise wrong(where, f"has more than {MAX_FRAMES} frames; cut it into pieces")
    return np.concatenate(kept) if kept else np.empty((0, 0, 3))
