"""Cells of tables as text: encodings, separators, decimal commas, numbers and what is lost."""

import csv
import re
from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np

from radhar_cli.files import plain_text
from radhar_cli.motion.recorded.recording import MAX_FRAMES, MAX_JOINTS, motion_file_error
from radhar_cli.numerics.arrays import Float

MAX_TEXT = 2**26  # bytes
MAX_COLUMNS = 10 * MAX_JOINTS
SAMPLED = 200  # lines by which the separator is chosen
LOST = frozenset({"", "nan", "null", "none", "na", "n/a", "-nan(ind)", "nan(ind)", "1.#qnan"})
_DECIMAL_COMMA = re.compile(r"^\s*-?\d+,\d+(?:[eE][-+]?\d+)?\s*$")


class CellTable(NamedTuple):
    """Rows of cells of a text, and where it is from."""

    rows: list[list[str]]  # empty lines are empty rows: row n is line n + 1 where `first` is 1
    first: int  # number of the line of the first row
    where: str

    def place(self, row: int) -> str:
        """File and line of a row, as messages name them."""
        return f"{self.where}:{self.first + row}"


def decode_text(data: bytes, where: str) -> str:
    """Text of bytes in UTF-8, in UTF-16 (as Excel and Windows write), or in Latin-1.

    Raises:
        MotionFileError: It is too long, or no text.
    """
    if len(data) > MAX_TEXT:
        raise motion_file_error(where, f"is {len(data)} bytes; should be at most {MAX_TEXT}")
    try:
        return plain_text.decode_text(data)
    except ValueError as error:
        raise motion_file_error(where, str(error)) from None


def split_cells(text: str, where: str) -> CellTable:
    """Split a text into rows of cells.

    Args:
        text: Its cells are separated by tabs, semicolons or commas, or else by spaces.
        where: Name of the file in messages.

    Raises:
        MotionFileError: There is nothing in it, or more than MAX_COLUMNS in a line.
    """
    lines = text.splitlines()
    filled = [line for line in lines if line.strip() and not line.startswith(("#", "%"))]
    if not filled:
        raise motion_file_error(where, "is empty")
    sampled = filled[-SAMPLED:] if len(filled) > SAMPLED else filled
    counts = {mark: int(np.median([line.count(mark) for line in sampled])) for mark in "\t;,"}
    separator = next((mark for mark, count in counts.items() if count > 1), None)
    if separator is None and not any(len(line.split()) > 3 for line in sampled):
        separator = next((mark for mark, count in counts.items() if count), ",")
    if max(line.count(separator or " ") for line in filled) > MAX_COLUMNS:
        raise motion_file_error(where, f"has more than {MAX_COLUMNS} columns")
    if separator is None:
        rows = [line.split() for line in lines]
    else:
        try:
            rows = [*csv.reader(lines, delimiter=separator)]
        except csv.Error as error:
            raise motion_file_error(where, f"is not a table ({error})") from None
    if separator != "," and any(_DECIMAL_COMMA.match(cell) for cell in _last_cells(rows)):
        rows = [[cell.replace(",", ".") for cell in row] for row in rows]
    return CellTable(rows, 1, where)


def _last_cells(rows: Sequence[Sequence[str]]) -> Iterable[str]:
    """Cells of the last rows of a table."""
    return (cell for row in rows[-SAMPLED:] for cell in row)


def is_number(text: str) -> bool:
    """Whether a cell is a number."""
    try:
        float(text)
    except ValueError:
        return False
    return True


def number_of(cell: str, place: str) -> float:
    """Number of a cell; NaN where it is lost.

    Raises:
        MotionFileError: It is neither.
    """
    text = cell.strip()
    if text.lower() in LOST:
        return float("nan")
    try:
        return float(text)
    except ValueError:
        raise motion_file_error(place, f"{text[:30]!r} should be a number") from None


def numbers_of(table: CellTable, begin: int, columns: Sequence[int], width: int | None) -> Float:
    """Numbers [rows, columns] of some columns of a table, NaN where a cell is empty.

    Args:
        table: Rows of cells; empty ones are left out.
        begin: First row of numbers.
        columns: Numbers of the columns.
        width: Cells that a row has; None where empty ones at its end may be left out.

    Raises:
        MotionFileError: Names the line and what is odd.
    """
    numbers: list[list[float]] = []
    rows = rows_of(table, begin, width)
    for number, row in rows:
        try:
            numbers.append([float(row[column]) for column in columns])
        except ValueError:
            place = table.place(number)
            numbers.append([number_of(row[column], place) for column in columns])
        if len(numbers) > MAX_FRAMES:
            raise motion_file_error(table.where, f"has more than {MAX_FRAMES} frames")
    return np.array(numbers).reshape(len(numbers), len(columns))


def rows_of(table: CellTable, begin: int, width: int | None) -> Iterable[tuple[int, list[str]]]:
    """Rows from one on that are not empty, and their numbers.

    Args:
        table: Rows of cells.
        begin: First row.
        width: Cells that a row has; None fills rows up as the widest row above them needs.

    Raises:
        MotionFileError: A row has another width.
    """
    widest = max(map(len, table.rows[: begin + 1]))
    for number, row in enumerate(table.rows[begin:], begin):
        if not any(cell.strip() for cell in row):
            continue
        if width is not None and len(row) != width:
            trimmed = row[:width] if not any(cell.strip() for cell in row[width:]) else row
            if len(trimmed) != width:
                raise motion_file_error(
                    table.place(number),
                    f"has {len(row)} columns; the line of names has {width}",
                )
            row = trimmed
        yield number, row + [""] * (widest - len(row))
