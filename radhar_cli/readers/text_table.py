"""Tables of any text: encoding, separator, decimal commas, lines above the numbers, lost cells.

Captures and motions read their tables here. A text is bounded in bytes and columns, numbers are
read line by line, and an error names the line.
"""

import csv
import re
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import islice
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.errors import RadharError
from radhar_cli.files.clocks import READ_CLOCKS, seconds_of_texts
from radhar_cli.files.plain_text import decode_text
from radhar_cli.numerics.arrays import Float

MAX_COLUMNS = 2**16
SAMPLED = 200  # first lines that are checked, and last ones by which the separator is chosen
LONGEST_CELL = 2000  # characters, of the first lines, where names are looked for
COMMENTS = ("#", "%", "//")
LOST = frozenset({"", "nan", "null", "none", "na", "n/a", "-nan(ind)", "nan(ind)", "1.#qnan"})
BLOCK = 2**14  # lines that are split at once
SHOWN = 30  # characters of a cell in messages
_DECIMAL_COMMA = re.compile(r"\s*[-+]?\d+,\d+(?:[eE][-+]?\d+)?\s*")


@dataclass(frozen=True)
class TextTable:
    """Lines of a text, and how their cells are written.

    Attributes:
        where: Name of the file in messages.
        lines: Lines of the text; comments and empty ones among them.
        separator: Mark between cells; None of blanks.
        has_decimal_comma: Whether numbers have a comma for the point.
        refusal: Makes an error of a place (file, or file and line) and a problem.
        first: Number of the first line in the file, from 0.
    """

    where: str
    lines: Sequence[str]
    separator: str | None
    has_decimal_comma: bool
    refusal: Callable[[str, str], RadharError]
    first: int = 0

    @cached_property
    def rows(self) -> list[list[str]]:
        """Cells of the first lines, above the numbers; an empty line has none."""
        return self.cells(self.lines[:SAMPLED])

    def cells(self, lines: Iterable[str]) -> list[list[str]]:
        """Cells of lines."""
        if self.separator is None:
            rows = [line.split() for line in lines]
        else:
            try:
                rows = [*csv.reader(lines, delimiter=self.separator)]
            except csv.Error as error:
                raise self.refusal(self.where, f"is not a table ({error})") from None
        if self.has_decimal_comma:
            rows = [[cell.replace(",", ".") for cell in row] for row in rows]
        return rows

    def place(self, row: int) -> str:
        """File and line of a row, from 0 on, as messages name them."""
        return f"{self.where}:{self.first + row + 1}"

    def filled_rows(
        self, begin: int, width: int | None, end: int | None = None
    ) -> Iterator[tuple[int, list[str]]]:
        """Yield (number, cells) of rows that are neither empty nor comments.

        Args:
            begin: First row.
            width: Cells that a row has, beside empty ones at its end; None of any.
            end: Row before which to end; None is the last.

        Raises:
            RadharError: A row has another width; names the line.
        """
        stop = len(self.lines) if end is None else end
        for first in range(begin, stop, BLOCK):
            block = self.lines[first : min(first + BLOCK, stop)]
            for number, row in enumerate(self.cells(block), first):
                if not any(map(str.strip, row)) or row[0].startswith(COMMENTS):
                    continue
                if width is not None and len(row) != width:
                    if len(row) < width or any(map(str.strip, row[width:])):
                        problem = f"has {len(row)} columns; lines above have {width}"
                        raise self.refusal(self.place(number), problem)
                    row = row[:width]
                yield number, row

    def numbers(
        self,
        rows: Iterable[tuple[int, list[str]]],
        columns: Sequence[int],
        max_rows: int,
        parse: type[float] | type[complex] = float,
    ) -> NDArray[Any]:
        """Numbers [rows, columns] of some columns, NaN where a cell is lost or not there.

        Args:
            rows: Rows with their numbers (`filled_rows`).
            columns: Numbers of the columns.
            max_rows: Most rows that are read.
            parse: `float` or `complex`.

        Raises:
            RadharError: Names the line of what is no number, or there are too many rows.
        """
        dtype: np.dtype[Any] = np.dtype(parse)
        blocks, count, rows = [np.empty((0, len(columns)), dtype)], 0, iter(rows)
        while block := [*islice(rows, BLOCK)]:
            if (count := count + len(block)) > max_rows:
                raise self.refusal(self.where, f"has more than {max_rows} rows of numbers")
            try:
                values = [[parse(row[column]) for column in columns] for _, row in block]
            except (ValueError, IndexError):
                values = [
                    [self.number("".join(row[c : c + 1]), number, parse) for c in columns]
                    for number, row in block
                ]
            blocks.append(np.array(values, dtype))
        return np.concatenate(blocks)

    def number(self, cell: str, row: int, parse: type[float] | type[complex] = float) -> complex:
        """Number of a cell; NaN where it is lost.

        Raises:
            RadharError: It is neither.
        """
        text = cell.strip()
        if text.lower() in LOST:
            return float("nan")
        try:
            return parse(text)
        except ValueError:
            raise self.refusal(self.place(row), f"{text[:SHOWN]!r} should be a number") from None

    def instants(self, rows: Iterable[tuple[int, list[str]]], column: int) -> tuple[Float, bool]:
        """Instants of a column: numbers as they are, clocks and dates in s from the first.

        Returns:
            Instants [rows], and whether they are of clocks.

        Raises:
            RadharError: Names a cell that is neither.
        """
        cells = [(number, row[column] if column < len(row) else "") for number, row in rows]
        texts = [text for _, text in cells]
        clocks = None if not texts or is_number(texts[0]) else seconds_of_texts(texts)
        if clocks is not None:
            return clocks, True
        unread = next((text.strip() for text in texts if ":" in text), None)
        if unread is not None:
            problem = f"'{unread[:SHOWN]}' is no clock that is read; such are {READ_CLOCKS}"
            raise self.refusal(self.where, problem)
        return np.array([self.number(text, number) for number, text in cells], float), False


def read_text_table(
    data: bytes, where: str, max_bytes: int, refusal: Callable[[str, str], RadharError]
) -> TextTable:
    """Find the lines of a text and how their cells are written.

    Args:
        data: Bytes in UTF-8, UTF-16 or Latin-1; tabs, semicolons, commas or else blanks separate
            cells.
        where: Name of the file in messages.
        max_bytes: Most bytes that are read.
        refusal: Makes an error of a place and a problem.

    Raises:
        RadharError: It is too long, no text, empty, or has too many columns.
    """
    return split_lines(text_of_bytes(data, where, max_bytes, refusal).splitlines(), where, refusal)


def text_of_bytes(
    data: bytes, where: str, max_bytes: int, refusal: Callable[[str, str], RadharError]
) -> str:
    """Text of at most so many bytes in UTF-8, UTF-16 or Latin-1.

    Raises:
        RadharError: It is too long, or no text.
    """
    if len(data) > max_bytes:
        raise refusal(where, f"is {len(data)} bytes; should be at most {max_bytes}")
    try:
        return decode_text(data)
    except ValueError as error:
        raise refusal(where, str(error)) from None


def split_lines(
    lines: Sequence[str], where: str, refusal: Callable[[str, str], RadharError]
) -> TextTable:
    """Find the separator of lines, and whether numbers have decimal commas.

    Raises:
        RadharError: There is nothing in them, more than MAX_COLUMNS, or a cell is too long.
    """
    filled = (line for line in reversed(lines) if line.strip() and not is_comment(line))
    last = [*islice(filled, SAMPLED)]
    if not last:
        raise refusal(where, "is empty")
    counts = {mark: int(np.median([line.count(mark) for line in last])) for mark in "\t;,"}
    separator = next((mark for mark, count in counts.items() if count), None)
    if max(line.count(separator or " ") for line in lines) > MAX_COLUMNS:
        raise refusal(where, f"has more than {MAX_COLUMNS} columns")
    table = TextTable(where, lines, separator, False, refusal)
    long = (line for line in lines[:SAMPLED] if len(line) > LONGEST_CELL)
    if any(len(cell) > LONGEST_CELL for row in table.cells(long) for cell in row):
        raise refusal(where, f"has a cell of more than {LONGEST_CELL} characters")
    has_comma = separator != "," and any(
        _DECIMAL_COMMA.fullmatch(cell) for row in table.cells(last) for cell in row
    )
    return TextTable(where, lines, separator, has_comma, refusal)


def is_comment(line: str) -> bool:
    """Whether a line is a comment."""
    return line.lstrip().startswith(COMMENTS)


def is_number(text: str) -> bool:
    """Whether a cell is a real number."""
    try:
        float(text)
    except ValueError:
        return False
    return True
