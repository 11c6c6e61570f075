"""Tables of positions as text: `.csv` with a line of names, `.trc` of OpenSim and Pose2Sim."""

import csv
import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from radhar_cli.motion.files.keypoints import TIME_UNITS, Keypoints, make_keypoints
from radhar_cli.motion.files.position_arrays import two_dimensional
from radhar_cli.motion.files.recording import MAX_FRAMES, MAX_JOINTS, motion_file_error
from radhar_cli.numerics.arrays import Float

MAX_TEXT = 2**26  # bytes
MAX_COLUMNS = 10 * MAX_JOINTS
TRC_UNITS = {"m": 1.0, "cm": 0.01, "mm": 0.001, "in": 0.0254}
_AXIS_LAST = re.compile(
    r"^(?P<name>.+?)(?:[ _.:\-]*(?:position|pos|location|translation))?"
    r"[ _.:\-\[(]*(?P<axis>[xyz])[\])]?(?:[ _]?[(\[]?(?:mm|cm|m)[)\]]?)?$",
    re.I,
)
_CONFIDENCE = re.compile(
    r"^(?P<name>.+?)[ _.:\-\[(]*(?:visibility|vis|confidence|conf|likelihood|score|v|c)[\])]?$",
    re.I,
)
_AXIS_FIRST = re.compile(r"^(?P<axis>[xyz])[ _.:\-]*(?P<name>.+)$", re.I)
_TIME = re.compile(
    r"^(?:time|times|timestamp|timestamps|elapsed|elapsed_time|t)"
    r"(?:[ _(\[]*(?:(?P<unit>s|ms|us|ns)|sec|secs|seconds)[)\]]?)?$",
    re.I,
)
_LOST = frozenset({"", "nan", "null", "none", "na", "n/a"})


class _Columns(NamedTuple):
    """Columns of a table: names of joints, their three columns each, the column of times."""

    names: list[str]
    places: list[tuple[int, int, int]]
    time: int | None
    unit: str | None
    confidences: list[int | None]  # columns of which 0 is a lost joint


def read_csv(data: bytes, where: str) -> Keypoints:
    """Read a table whose first line names columns: `nose_x`, `nose_y`, `nose_z`, ..., and `time`.

    Args:
        data: Bytes of the file; columns are separated by commas, semicolons or tabs.
        where: Name of the file in messages.

    Raises:
        MotionFileError: Names the line and what is odd.
    """
    lines = _lines(data, where)
    heading = next(
        (n for n, line in enumerate(lines) if line.strip() and not line.startswith(("#", "%"))),
        None,
    )
    if heading is None:
        raise motion_file_error(where, "is empty")
    delimiter = max(",;\t", key=lines[heading].count)
    if lines[heading].count(delimiter) > MAX_COLUMNS:
        raise motion_file_error(where, f"has more than {MAX_COLUMNS} columns")
    try:
        head, *rows = csv.reader(lines[heading:], delimiter=delimiter)
    except csv.Error as error:
        raise motion_file_error(where, f"is not a table ({error})") from None
    head = [name.strip().lstrip("\ufeff") for name in head]
    if _is_number(head[0]) and all(_is_number(word) or word.lower() in _LOST for word in head):
        numbers = _numbers([head, *rows], len(head), f"{where}", heading + 1)
        return _without_names(numbers, where)
    columns = _find_columns(head, where)
    numbers = _numbers(rows, len(head), where, heading + 2)
    values = numbers[:, np.array(columns.places).ravel()].reshape(len(numbers), -1, 3)
    for joint, column in enumerate(columns.confidences):
        if column is not None:
            values[numbers[:, column] == 0, joint] = np.nan
    times = None if columns.time is None else numbers[:, columns.time]
    if times is not None and columns.unit:
        times = times * TIME_UNITS[columns.unit]
    names = None if all(name.isdigit() for name in columns.names) else columns.names
    return make_keypoints(where, names, values, times=times)


def read_trc(data: bytes, where: str) -> Keypoints:
    """Read a TRC file: its rate and units, names of joints, and their positions.

    Args:
        data: Bytes of the file.
        where: Name of the file in messages.

    Raises:
        MotionFileError: Names the line and what is odd.
    """
    lines = _lines(data, where)
    if len(lines) < 6 or not lines[0].startswith("PathFileType"):
        raise motion_file_error(where, "is not a TRC file: it should begin with PathFileType")
    keys, texts = lines[1].split(), lines[2].split()
    header = dict(zip(keys, texts, strict=False))
    rate, unit = header.get("DataRate", ""), header.get("Units", "").lower()
    if not _is_number(rate):
        raise motion_file_error(f"{where}:3", f"DataRate {rate[:30]!r} should be a number")
    if unit not in TRC_UNITS:
        raise motion_file_error(f"{where}:3", f"Units {unit[:30]!r} should be m, cm, mm or in")
    names = [name.strip() for name in lines[3].split("\t")[2:] if name.strip()]
    if not 0 < len(names) <= MAX_JOINTS:
        raise motion_file_error(
            f"{where}:4", f"has {len(names)} names; should have 1 to {MAX_JOINTS}"
        )
    first = 5
    rows = [line.rstrip("\r\n").split("\t") for line in lines[first:]]
    width = 2 + 3 * len(names)
    rows = [[*row[:width], *[""] * (width - len(row))] for row in rows]
    numbers = _numbers(rows, width, where, first + 1)
    values = numbers[:, 2:].reshape(len(numbers), len(names), 3)
    return make_keypoints(where, names, values, float(rate), unit=TRC_UNITS[unit])


def _lines(data: bytes, where: str) -> list[str]:
    """Lines of a text of bounded length."""
    if len(data) > MAX_TEXT:
        raise motion_file_error(where, f"is {len(data)} bytes; should be at most {MAX_TEXT}")
    if b"\0" in data:
        raise motion_file_error(where, "is not a text")
    return data.decode("utf-8", "replace").splitlines()


def _find_columns(head: Sequence[str], where: str) -> _Columns:
    """Columns of the joints that a line of names has.

    Raises:
        MotionFileError: No joint has x, y and z.
    """
    parts: dict[str, dict[str, int]] = {}
    time, unit = None, None
    for number, name in enumerate(head):
        as_time = _TIME.match(name)
        if as_time:
            time, unit = number, as_time["unit"] and as_time["unit"].lower()
            continue
        matched = _AXIS_LAST.match(name) or _AXIS_FIRST.match(name)
        if matched and matched["name"].strip(" _.:-"):
            joint = matched["name"].strip(" _.:-")
            parts.setdefault(joint, {}).setdefault(matched["axis"].lower(), number)
    complete = {name: axes for name, axes in parts.items() if set(axes) == set("xyz")}
    if not complete:
        pairs = [name for name, axes in parts.items() if {"x", "y"} <= set(axes)]
        if pairs:
            raise motion_file_error(
                where, two_dimensional(f"{pairs[0][:30]} has x and y, but no z")
            )
        raise motion_file_error(
            f"{where}:1",
            "should name its columns, such as time, nose_x, nose_y, nose_z; it has "
            + ", ".join(name[:20] for name in head[:8]),
        )
    if len(complete) > MAX_JOINTS:
        raise motion_file_error(where, f"has {len(complete)} joints; should have 1 to {MAX_JOINTS}")
    places = [(axes["x"], axes["y"], axes["z"]) for axes in complete.values()]
    matches = [(number, _CONFIDENCE.match(name)) for number, name in enumerate(head)]
    confidences = {m["name"].strip(" _.:-"): number for number, m in matches if m}
    return _Columns([*complete], places, time, unit, [confidences.get(name) for name in complete])


def _numbers(rows: Sequence[Sequence[str]], width: int, where: str, first: int) -> Float:
    """Numbers [rows, width] of rows of text, NaN where a cell is empty; empty rows are left out.

    Args:
        rows: Rows of cells.
        width: Cells that a row has.
        where: Name of the file in messages.
        first: Number of the line of the first row.
    """
    numbers: list[Float] = []
    for line, row in enumerate(rows, first):
        if not any(cell.strip() for cell in row):
            continue
        if len(row) != width:
            raise motion_file_error(
                f"{where}:{line}", f"has {len(row)} columns; the line of names has {width}"
            )
        try:
            numbers.append(np.array([float(cell) for cell in row]))
        except ValueError:
            numbers.append(np.array([_number(cell, f"{where}:{line}") for cell in row]))
        if len(numbers) > MAX_FRAMES:
            raise motion_file_error(where, f"has more than {MAX_FRAMES} frames")
    return np.array(numbers).reshape(len(numbers), width)


def _number(cell: str, place: str) -> float:
    """Number of a cell; NaN where it is lost, or a word that is no coordinate."""
    text = cell.strip()
    if text.lower() in _LOST:
        return float("nan")
    try:
        return float(text)
    except ValueError:
        raise motion_file_error(place, f"{text[:30]!r} should be a number") from None


def _is_number(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return False
    return True


def _without_names(numbers: Float, where: str) -> Keypoints:
    """Recording of a table without a line of names: columns are x, y, z of each joint."""
    width = numbers.shape[1]
    if width % 3 == 1:  # the first column is time, or the number of the frame
        first, numbers = numbers[:, 0], numbers[:, 1:]
        is_time = len(first) > 1 and not (np.diff(first) == 1).all()
        times = first if is_time else None
    elif width % 3 == 0:
        times = None
    else:
        raise motion_file_error(
            where, f"has {width} columns without names; should have x, y, z of each joint"
        )
    return make_keypoints(where, None, numbers.reshape(len(numbers), -1, 3), times=times)
