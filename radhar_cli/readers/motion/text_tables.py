"""Tables of positions as text: `.csv`, `.tsv` and `.txt`; `.trc` of OpenSim and Pose2Sim."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from radhar_cli.files.clocks import TIME_UNITS
from radhar_cli.motion.recorded.keypoints import (
    Keypoints,
    make_keypoints,
)
from radhar_cli.motion.recorded.recording import MAX_FRAMES, MAX_JOINTS, motion_file_error
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.motion.long_tables import find_long_heading, read_long
from radhar_cli.readers.motion.position_arrays import arrange_positions
from radhar_cli.readers.motion.table_headings import (
    UNITS,
    Heading,
    find_heading,
    rate_above,
    unit_above,
)
from radhar_cli.readers.text_table import TextTable, is_number, read_text_table, text_of_bytes

MAX_TEXT = 2**26  # bytes
# Parts of a table of Vicon Nexus, each below a line with its name and one with its rate.
NEXUS_PARTS = {
    name.lower(): name
    for name in ("Devices", "Joints", "Segments", "Model Outputs", "Events", "Trajectories")
}


def read_table(data: bytes, where: str) -> Keypoints:
    """Read a table of a row a frame, whose lines above name its columns, or of a row a joint.

    Args:
        data: Bytes of the file; columns are separated by commas, semicolons, tabs or spaces.
        where: Name of the file in messages.

    Raises:
        MotionFileError: Names the line and what is odd.
    """
    table = read_text_table(data, where, MAX_TEXT, motion_file_error)
    table = _trajectories(table)
    long_heading = find_long_heading(table)
    if long_heading is not None:
        return _read_long(table, *long_heading)
    heading = find_heading(table)
    if heading is None:
        return _without_names(table)
    columns = [column for place in heading.places for column in place]
    numbers = _numbers_of(table, heading.begin, columns, heading.width)
    values = numbers.reshape(len(numbers), len(heading.places), 3)
    lost = [column for column in heading.confidences if column is not None]
    if lost:
        certain = iter(_numbers_of(table, heading.begin, lost, heading.width).T)
        for joint, column in enumerate(heading.confidences):
            if column is not None:
                values[next(certain) <= 0, joint] = np.nan
    times = _times_of(table, heading)
    return make_keypoints(
        where,
        heading.names,
        values,
        None if times is not None else heading.rate,
        times,
        heading.unit,
    )


def _trajectories(table: TextTable) -> TextTable:
    """Part of a table of Vicon Nexus that has trajectories; the table itself if of another program.

    Raises:
        MotionFileError: It has other parts of Nexus alone.
    """
    marks = (table.separator or " ") + ' \t"'
    words = [line.strip(marks).lower() for line in table.lines]
    begins = [
        number
        for number, (word, rate) in enumerate(zip(words, [*words[1:], ""], strict=True))
        if word in NEXUS_PARTS and (word == "trajectories" or is_number(rate))
    ]
    if not begins:
        return table
    parts = {words[a]: (a, b) for a, b in pairwise([*begins, len(words)])}
    if "trajectories" not in parts:
        listed = " and ".join(NEXUS_PARTS[word] for word in parts)
        raise motion_file_error(
            table.where,
            f"has {listed} of Vicon Nexus, which are no positions of joints; export Trajectories, "
            "too (Export ASCII: Trajectories), or C3D",
        )
    begin, end = parts["trajectories"]
    return replace(table, lines=table.lines[begin:end], first=begin)


def _read_long(table: TextTable, heading: int, xyz: tuple[int, int, int], joint: int) -> Keypoints:
    """Recording of a table of a row for each joint of each frame."""
    long = read_long(table, heading, xyz, joint)
    rows = [(heading + 1 + n, [text]) for n, text in enumerate(long.instants or ())]
    times = _instants(table, rows, 0, long.time_unit)
    return make_keypoints(
        table.where,
        long.names,
        long.values,
        None if times is not None else rate_above(table, heading),
        times,
        unit_above(table, heading),
        long.remarks,
    )


def _times_of(table: TextTable, heading: Heading) -> Float | None:
    """Instants of the rows of a table; None where it has none, or nothing stands in the column."""
    if heading.time is None:
        return None
    rows = [*table.filled_rows(heading.begin, heading.width)]
    return _instants(table, rows, heading.time, heading.time_unit)


def _instants(
    table: TextTable, rows: Sequence[tuple[int, list[str]]], column: int, unit: str | None
) -> Float | None:
    """Instants of a column: numbers in a unit, or clocks in s; None where nothing stands there."""
    if not any("".join(row[column : column + 1]).strip() for _, row in rows):
        return None
    times, are_clocks = table.instants(rows, column)
    return times * TIME_UNITS[unit] if unit and not are_clocks else times


def _numbers_of(table: TextTable, begin: int, columns: Sequence[int], width: int | None) -> Float:
    """Numbers [rows, columns] of some columns, NaN where a cell is lost."""
    return table.numbers(table.filled_rows(begin, width), columns, MAX_FRAMES)


def read_trc(data: bytes, where: str) -> Keypoints:
    """Read a TRC file: its rate and units, names of joints, and their positions, y up (OpenSim).

    Args:
        data: Bytes of the file.
        where: Name of the file in messages.

    Raises:
        MotionFileError: Names the line and what is odd.
    """
    lines = text_of_bytes(data, where, MAX_TEXT, motion_file_error).splitlines()
    if len(lines) < 6 or not lines[0].startswith("PathFileType"):
        raise motion_file_error(where, "is not a TRC file: it should begin with PathFileType")
    keys, texts = lines[1].split(), lines[2].split()
    header = dict(zip(keys, texts, strict=False))
    rate, unit = header.get("DataRate", ""), header.get("Units", "").lower()
    if not is_number(rate):
        raise motion_file_error(f"{where}:3", f"DataRate {rate[:30]!r} should be a number")
    if unit not in UNITS:
        raise motion_file_error(f"{where}:3", f"Units {unit[:30]!r} should be m, cm, mm or in")
    names = [name.strip() for name in lines[3].split("\t")[2:] if name.strip()]
    if not 0 < len(names) <= MAX_JOINTS:
        raise motion_file_error(
            f"{where}:4", f"has {len(names)} names; should have 1 to {MAX_JOINTS}"
        )
    table = TextTable(where, lines[5:], "\t", False, motion_file_error, first=5)
    numbers = _numbers_of(table, 0, range(2, 2 + 3 * len(names)), None)
    values = numbers.reshape(len(numbers), len(names), 3)
    return replace(make_keypoints(where, names, values, float(rate), unit=UNITS[unit]), up="y")


def _without_names(table: TextTable) -> Keypoints:
    """Recording of a table without a line of names: columns are x, y, z of each joint."""
    where = table.where
    begin = next(
        n
        for n, row in enumerate(table.rows)
        if any(c.strip() for c in row) and not row[0].startswith(("#", "%"))
    )
    width = len(table.rows[begin])
    numbers = _numbers_of(table, begin, range(width), width)
    columns = width - width % 3
    if np.array_equal(numbers[0, -columns:], np.arange(columns)):  # as pandas names columns
        is_index = width > columns and not table.rows[begin][0].strip()
        numbers = numbers[1:, is_index:]
    if numbers.shape[1] % 3:
        raise motion_file_error(
            where,
            f"has {width} columns without names; should have x, y, z of each joint, or a line "
            "above them that names all: time,nose_x,nose_y,nose_z,...",
        )
    values, rate = arrange_positions(numbers, None, where), rate_above(table, begin)
    return replace(make_keypoints(where, None, values, rate), are_columns=True)
