"""Frames of an AMC as text: a frame's number, then a line for each bone with its numbers."""

import re
from collections import Counter
from collections.abc import Iterator, Mapping

import numpy as np

from radhar_cli.motion.recorded.recording import motion_file_error
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.motion.frames import BLOCK, SHOWN, first_bad_number, parse_numbers

MAX_FRAME = 2**20  # bytes of one frame; the largest skeleton allowed has about 100 kB
FRAME_NUMBER = re.compile(rb"(?m)^[ \t]*(\d{1,9})[ \t]*\r?$")
_NAME = re.compile(rb"(?m)^[ \t]*[A-Za-z_]\S*")


def amc_frames(
    data: bytes, start: int, line: int, widths: Mapping[str, int], where: str
) -> Iterator[Float]:
    """Read the frames of an AMC in blocks.

    Every frame has the bones in the order of the first one, whichever that is.

    Args:
        data: Bytes of the file.
        start: Byte at which the number of the first frame begins.
        line: Number of the line there.
        widths: {bone: numbers that a frame has of it}, in the order of the columns.
        where: Name of the file in messages.

    Yields:
        Numbers [frames, columns] of one block.

    Raises:
        MotionFileError: A bone is missing, unknown or has other numbers; frames are missing.
    """
    first = FRAME_NUMBER.match(data, start)
    assert first is not None
    expected = int(first[1])
    end = _next_frame(data, first.end(), line, where)
    names = _names_of_first_frame(data[start:end], line, widths, where)
    columns, order = sum(widths.values()), _columns(names, widths)
    while start < len(data):
        stop = _next_frame(data, min(start + BLOCK, len(data) - 1), line, where)
        piece = data[start:stop]
        listed = [name.strip() for name in _NAME.findall(piece)]
        values = parse_numbers(_NAME.sub(b"", piece))
        count = len(listed) // len(names)
        if (
            values is None
            or not np.isfinite(values).all()
            or listed != names * count
            or values.size != count * (columns + 1)
            or (values[:: columns + 1] != np.arange(expected, expected + count)).any()
        ):
            _refuse_frames(piece, line, widths, names, expected, where)
            raise motion_file_error(
                f"{where}:{line}", "the frames from here on are not like the first"
            )
        yield values.reshape(count, columns + 1)[:, 1:][:, order]
        expected += count
        start, line = stop, line + piece.count(b"\n")


def _next_frame(data: bytes, position: int, line: int, where: str) -> int:
    """Byte at which the first frame begins whose number stands in a line after `position`."""
    begin = data.find(b"\n", position) + 1 or len(data)
    match = FRAME_NUMBER.search(data, begin, begin + MAX_FRAME)
    if match is not None:
        return match.start()
    if len(data) - begin > MAX_FRAME:
        raise motion_file_error(
            f"{where}:{line}", f"a frame after this line is longer than {MAX_FRAME} bytes"
        )
    return len(data)


def _names_of_first_frame(
    frame: bytes, line: int, widths: Mapping[str, int], where: str
) -> list[bytes]:
    """Names of the bones of a frame, in their order."""
    names = [name.strip() for name in _NAME.findall(frame)]
    times, moving = Counter(names), {name.encode() for name in widths}
    for name in times:
        if name not in moving:
            bone_name = name[:SHOWN].decode("ascii", "replace")
            raise motion_file_error(
                f"{where}:{line}", f"the skeleton has no bone {bone_name!r} that moves"
            )
    for bone in widths:
        if times[bone.encode()] != 1:
            raise motion_file_error(
                f"{where}:{line}", f"its first frame should have the bone {bone!r} once"
            )
    return names


def _columns(names: list[bytes], widths: Mapping[str, int]) -> list[int]:
    """Place in a frame of the file of each column, in the order of `widths`."""
    starts, column = dict[str, int](), 0
    for name in map(bytes.decode, names):
        starts[name] = column
        column += widths[name]
    return [starts[name] + k for name, width in widths.items() for k in range(width)]


def _refuse_frames(
    piece: bytes,
    first: int,
    widths: Mapping[str, int],
    names: list[bytes],
    expected: int,
    where: str,
) -> None:
    """Raise the error of the first line that is wrong in a block of an AMC."""
    missing: list[bytes] = []  # bones that the frame does not have yet, the next one last
    for line, text in enumerate(piece.split(b"\n"), first):
        words, place = text.split(), f"{where}:{line}"
        if not words:
            continue
        if len(words) == 1 and words[0].isdigit():
            if missing:
                raise motion_file_error(
                    place, f"frame {expected - 1} lacks the bone {missing[-1].decode()!r}"
                )
            if int(words[0][:18]) != expected:
                word = words[0][:SHOWN].decode()
                raise motion_file_error(
                    place, f"frame {word} should be frame {expected}: frames are missing"
                )
            missing, expected = names[::-1], expected + 1
            continue
        name, row = words[0], parse_numbers(b" ".join(words[1:]))
        word = name[:SHOWN].decode("ascii", "replace")
        if not missing or name != missing[-1]:
            expected_word = missing[-1].decode() if missing else "a frame's number"
            raise motion_file_error(
                place, f"{word!r} should be {expected_word!r}, as in the first frame"
            )
        if row is None or not np.isfinite(row).all():
            raise motion_file_error(
                place, f"{first_bad_number(b' '.join(words[1:]))!r} should be a number"
            )
        if row.size != widths[name.decode()]:
            raise motion_file_error(
                place, f"{word} has {row.size} numbers; should have {widths[name.decode()]}"
            )
        missing.pop()
    if missing:
        raise motion_file_error(
            f"{where}:{line}", f"the file ends before the bone {missing[-1].decode()!r}"
        )
