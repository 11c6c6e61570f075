"""Tables in long form: a row for each joint of each frame, with the joint's name or number."""

import re
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from radhar_cli.motion.recorded.image_landmarks import two_dimensional
from radhar_cli.motion.recorded.recording import MAX_FRAMES, MAX_JOINTS, motion_file_error
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.motion.table_headings import MOST_LINES, find_time
from radhar_cli.readers.text_table import TextTable, is_number

OFTEN = 0.5  # share of the rows of the main person from which another one is a second person
_JOINT = re.compile(
    r"^(?:(?:joint|landmark|marker|keypoint|body_?part|bone|point|kp)_?(?:name|label|type|id|index|idx|no|number"
    r"|num)?s?|name|label)$"
)
_FRAME = re.compile(
    r"^(?:frame|image|img|row)_?(?:id|no|number|num|index|idx|count|name)?$|^(?:f|sample)$"
)
_PERSON = re.compile(
    r"^(?:person|body|track|tracking|subject|skeleton|user|player|pose)_?(?:id|no|index|idx|number)?$|^id$"
)
_CONFIDENCE = re.compile(
    r"^(?:visibility|confidence|conf|likelihood|score|tracking_?state|state|tracked)$"
)
_PREFIXES = ("", "world_", "position_", "pos_", "camera_", "joint_", "coord_")
_NOT_TRACKED = frozenset({"nottracked", "not_tracked", "none", "false", "lost", "low"})


class LongTable(NamedTuple):
    """Joints of the frames of a table in long form."""

    names: list[str] | None
    values: Float  # [frames, J, 3]; NaN where a row is missing or says that its joint is lost
    instants: list[str] | None  # as texts, one a frame
    time_unit: str | None
    remarks: tuple[str, ...]


class _LongColumns(NamedTuple):
    xyz: tuple[int, int, int]
    joint: int
    frame: int | None
    time: int | None
    time_unit: str | None
    person: int | None
    confidence: int | None


def find_long_heading(table: TextTable) -> tuple[int, tuple[int, int, int], int] | None:
    """Find the row of a long table's names: the row, columns x, y and z, and that of the joint.

    Raises:
        MotionFileError: It has x and y of joints, but no z.
    """
    for number, row in enumerate(table.rows[:MOST_LINES]):
        names = [_plain(cell) for cell in row]
        joint = _first_matching(_JOINT, names)
        if joint is None or len(names) > 60:
            continue
        for prefix in ("world_", *_PREFIXES):
            axes = [_column_of_axis(names, prefix, axis) for axis in "xyz"]
            if None not in axes:
                x, y, z = (column for column in axes if column is not None)
                return number, (x, y, z), joint
            if None not in axes[:2]:
                raise motion_file_error(
                    table.where, two_dimensional("joints have x and y, but no z")
                )
    return None


def read_long(table: TextTable, heading: int, xyz: tuple[int, int, int], joint: int) -> LongTable:
    """Read a table of a row for each joint of each frame.

    Args:
        table: Rows of cells.
        heading: Row of the names of the columns.
        xyz: Columns of the coordinates.
        joint: Column of the joint's name or number.

    Raises:
        MotionFileError: Names the line and what is odd, or several people are there.
    """
    names = [_plain(cell) for cell in table.rows[heading]]
    time, time_unit = find_time([cell.strip() for cell in table.rows[heading]])
    columns = _LongColumns(
        xyz,
        joint,
        _first_matching(_FRAME, names),
        time,
        time_unit,
        _first_matching(_PERSON, names),
        _first_matching(_CONFIDENCE, names),
    )
    rows = [*table.filled_rows(heading + 1, len(names))]
    if len(rows) > MAX_FRAMES * 4:
        raise motion_file_error(table.where, f"has more than {4 * MAX_FRAMES} rows")
    rows, remarks = _rows_of_person(rows, columns.person, table.where)
    joints = [*dict.fromkeys(row[joint].strip() for _, row in rows)]
    is_numbered = all(name.isdigit() for name in joints)
    if is_numbered:
        joints.sort(key=int)
    if not 0 < len(joints) <= MAX_JOINTS:
        raise motion_file_error(
            table.where, f"has {len(joints)} joints; should have 1 to {MAX_JOINTS}"
        )
    values, instants = _arrange(table, rows, columns, {name: n for n, name in enumerate(joints)})
    texts = None if time is None else instants
    return LongTable(None if is_numbered else joints, values, texts, time_unit, remarks)


def _plain(cell: str) -> str:
    """Name of a column in lower case with underscores, without a unit."""
    name = re.sub(r"([a-z])([A-Z])", r"\1_\2", cell.strip().lstrip("\ufeff")).lower()
    name = re.sub(r"[\s_]*[\[(](?:mm|cm|m)[\])]$", "", name)
    return re.sub(r"[^a-z0-9]+", "_", name).strip("_")


def _first_matching(pattern: re.Pattern[str], names: Sequence[str]) -> int | None:
    """First column whose name is of a pattern."""
    return next((n for n, name in enumerate(names) if pattern.match(name)), None)


def _column_of_axis(names: Sequence[str], prefix: str, axis: str) -> int | None:
    """Column of a coordinate: x, pos_x, x_pos, x_m, x_mm, x3d."""
    bare = prefix.rstrip("_")
    forms = {prefix + axis, bare + axis, f"{axis}_{bare}".rstrip("_"), f"{prefix}{axis}_m"}
    forms |= {f"{prefix}{axis}_mm", f"{prefix}{axis}_cm", f"{axis}3d", f"{axis}_3d"}
    return next((n for n, name in enumerate(names) if name in forms), None)


def _rows_of_person(
    rows: Sequence[tuple[int, list[str]]], person: int | None, where: str
) -> tuple[list[tuple[int, list[str]]], tuple[str, ...]]:
    """Rows of the person who is in most of them, and a remark where others are.

    Raises:
        MotionFileError: Another one is in more than half as many.
    """
    if person is None or not rows:
        return [*rows], ()
    counts: dict[str, int] = {}
    for _, row in rows:
        counts[row[person]] = counts.get(row[person], 0) + 1
    first, *others = sorted(counts, key=lambda name: -counts[name])
    often = [name for name in others if counts[name] > OFTEN * counts[first]]
    if often:
        raise motion_file_error(
            where, f"has {1 + len(often)} people; should be one: keep the rows of one of them"
        )
    remark = f"of {len(counts)} people the one is taken who is in most rows"
    return [pair for pair in rows if pair[1][person] == first], (remark,) if others else ()


def _arrange(
    table: TextTable,
    rows: Sequence[tuple[int, list[str]]],
    columns: _LongColumns,
    numbers: dict[str, int],
) -> tuple[Float, list[str]]:
    """Positions [frames, J, 3] of rows, and the text of each frame's instant.

    A frame ends where its number (else its time) changes, or else where a joint comes again.
    """
    key_column = columns.time if columns.frame is None else columns.frame
    frames, instants, seen_joints = list[Float](), list[str](), set[int]()
    key: str | None = None
    for line, row in rows:
        number = numbers[row[columns.joint].strip()]
        is_new = not frames or number in seen_joints
        if key_column is not None:
            is_new |= row[key_column] != key
            key = row[key_column]
        if is_new:
            if len(frames) >= MAX_FRAMES:
                raise motion_file_error(table.where, f"has more than {MAX_FRAMES} frames")
            frames.append(np.full((len(numbers), 3), np.nan))
            seen_joints = set()
            instants.append("" if columns.time is None else row[columns.time])
        seen_joints.add(number)
        if not _is_lost(row, columns.confidence):
            frames[-1][number] = [table.number(row[column], line) for column in columns.xyz]
    return np.stack(frames) if frames else np.empty((0, len(numbers), 3)), instants


def _is_lost(row: Sequence[str], confidence: int | None) -> bool:
    """Whether a row says that its joint is lost: no confidence, or not tracked."""
    if confidence is None:
        return False
    text = row[confidence].strip().lower()
    return text in _NOT_TRACKED or (is_number(text) and float(text) <= 0)
