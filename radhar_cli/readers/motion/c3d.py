"""C3D, the binary format of motion laboratories: points of a frame, their names, units and rate.

Blocks of 512 bytes: a header, parameters in groups, frames of x, y, z and a residual for each
point, followed by analog samples (https://www.c3d.org, "The C3D File Format User Guide"). Points
are often markers on the skin; POINT:LABELS names them. Nothing but points is read.
"""

import struct
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from radhar_cli.files.plain_text import decode_text
from radhar_cli.motion.recorded.keypoints import Keypoints, make_keypoints
from radhar_cli.motion.recorded.recording import MAX_FRAMES, MAX_JOINTS, motion_file_error

BLOCK = 512
MAGIC = 0x50
INTEL, DEC, MIPS = 84, 85, 86
MOST_PARAMETERS = 5000
UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254, "inches": 0.0254}
AXES = ("x", "y", "z", "-x", "-y", "-z")
_BYTES_OF_TYPE = {-1: 1, 1: 1, 2: 2, 4: 4}


@dataclass(frozen=True)
class _Parameter:
    kind: int  # -1 texts, 1 bytes, 2 integers, 4 numbers
    shape: tuple[int, ...]
    data: bytes


@dataclass(frozen=True)
class _Header:
    points: int
    analog: int  # samples of all channels in a frame of points
    first: int
    last: int
    scale: float  # negative: coordinates are numbers
    start: int  # block of the first frame
    rate: float
    order: str  # < little-endian, > big-endian


def read_c3d(data: bytes, where: str) -> Keypoints:
    """Read the points of a C3D file.

    Args:
        data: Bytes of the file.
        where: Name of the file in messages.

    Raises:
        MotionFileError: Names the file and what is damaged, or odd.
    """
    try:
        header, parameters = _read_head(data, where)
        values = _read_points(data, header, parameters, where)
        names = _labels(parameters, header.points)
    except (struct.error, IndexError, ValueError, OverflowError):
        raise motion_file_error(where, "is a damaged C3D file") from None
    unit = _texts(parameters.get("POINT:UNITS"))
    unit_m = UNITS.get(unit[0].lower()) if unit else None
    # Y_SCREEN is the axis that points up on a screen, such as +Z; laboratories choose their own.
    screen = _texts(parameters.get("POINT:Y_SCREEN"))
    up = screen[0].lower().removeprefix("+") if screen else None
    up = up if up in AXES else None
    return replace(make_keypoints(where, names, values, header.rate, unit=unit_m), up=up)


def _read_head(data: bytes, where: str) -> tuple[_Header, dict[str, _Parameter]]:
    """Header and parameters of a file."""
    if len(data) < 2 * BLOCK or data[1] != MAGIC or not data[0]:
        raise motion_file_error(where, "is not a C3D file")
    place = (data[0] - 1) * BLOCK
    kind = data[place + 3]
    if kind == DEC:
        raise motion_file_error(
            where, "has numbers of a DEC computer; save it anew (Mokka, ezc3d) with those of Intel"
        )
    if kind not in (INTEL, MIPS):
        raise motion_file_error(where, f"has numbers of an unknown processor, {kind}")
    order = "<" if kind == INTEL else ">"
    points, analog, first, last = struct.unpack_from(f"{order}4H", data, 2)
    scale, start, _, rate = struct.unpack_from(f"{order}fHHf", data, 12)
    header = _Header(points, analog, first, last, scale, start, rate, order)
    if not 0 < points <= MAX_JOINTS:
        raise motion_file_error(where, f"has {points} points; should have 1 to {MAX_JOINTS}")
    return header, _read_parameters(data, place + 4, order)


def _read_parameters(data: bytes, place: int, order: str) -> dict[str, _Parameter]:
    """Parameters {GROUP:NAME: value} from a byte on."""
    groups = dict[int, str]()
    parameters = list[tuple[int, str, _Parameter]]()
    for _ in range(MOST_PARAMETERS):
        length, group = struct.unpack_from("<bb", data, place)
        length = abs(length)
        if not length or not group:
            break
        name = data[place + 2 : place + 2 + length].decode("latin-1").upper()
        at_offset = place + 2 + length
        (offset,) = struct.unpack_from(f"{order}H", data, at_offset)
        if group < 0:
            groups[-group] = name
        else:
            parameters.append((group, name, _read_parameter(data, at_offset + 2)))
        if not offset:
            break
        place = at_offset + offset
    return {f"{groups.get(group, '')}:{name}": value for group, name, value in parameters}


def _read_parameter(data: bytes, place: int) -> _Parameter:
    """Type, shape and bytes of a parameter."""
    kind, dimensions = struct.unpack_from("<bB", data, place)
    shape = tuple(data[place + 2 : place + 2 + dimensions])
    if len(shape) != dimensions or kind not in _BYTES_OF_TYPE:
        raise ValueError
    size = _BYTES_OF_TYPE[kind] * int(np.prod(shape, dtype=np.int64))
    begin = place + 2 + dimensions
    if begin + size > len(data):
        raise ValueError
    return _Parameter(kind, shape, data[begin : begin + size])


def _texts(parameter: _Parameter | None) -> list[str]:
    """Texts of a parameter; none where it is of another type."""
    if parameter is None or parameter.kind != -1 or not parameter.shape or not parameter.shape[0]:
        return []
    size = parameter.shape[0]
    pieces = (parameter.data[n : n + size] for n in range(0, len(parameter.data), size))
    return [decode_text(piece.replace(b"\0", b" ")).strip() for piece in pieces]


def _labels(parameters: Mapping[str, _Parameter], points: int) -> list[str]:
    """Names of the points; numbers follow where labels end."""
    labels = _texts(parameters.get("POINT:LABELS"))
    for number in range(2, 6):
        labels += _texts(parameters.get(f"POINT:LABELS{number}"))
    labels = labels[:points]
    return [*labels, *(f"point {n}" for n in range(len(labels), points))]


def _read_points(
    data: bytes, header: _Header, parameters: Mapping[str, _Parameter], where: str
) -> np.ndarray[tuple[int, ...], np.dtype[np.float64]]:
    """Positions [frames, points, 3]; NaN where the residual says that a point is lost."""
    is_float = header.scale < 0
    number = np.dtype(f"{header.order}{'f4' if is_float else 'i2'}")
    width = 4 * header.points + header.analog
    start = (header.start - 1) * BLOCK
    available = (len(data) - start) // (width * number.itemsize) if start > 0 else 0
    frames = header.last - header.first + 1
    if header.last == 0xFFFF or "TRIAL:ACTUAL_END_FIELD" in parameters:
        frames = _true_frames(parameters, header) or available
    if not 0 < frames <= min(available, MAX_FRAMES):
        raise motion_file_error(
            where, f"says {frames} frames; it has {available} and may have {MAX_FRAMES}"
        )
    table = np.frombuffer(data, number, frames * width, start).reshape(frames, width)
    with np.errstate(invalid="ignore"):  # of signalling NaN in damaged files
        points = table[:, : 4 * header.points].reshape(frames, header.points, 4).astype(float)
    values = points[..., :3] if is_float else points[..., :3] * header.scale
    return np.where(points[..., 3:] < 0, np.nan, values)


def _true_frames(parameters: Mapping[str, _Parameter], header: _Header) -> int | None:
    """Frames of a long file, whose number two words of 16 bits make."""
    ends = list[int]()
    for key in ("TRIAL:ACTUAL_START_FIELD", "TRIAL:ACTUAL_END_FIELD"):
        parameter = parameters.get(key)
        if parameter is None or parameter.kind != 2 or len(parameter.data) != 4:
            return None
        low, high = struct.unpack(f"{header.order}2H", parameter.data)
        ends.append(low + 65536 * high)
    return ends[1] - ends[0] + 1
