"""Captures that are text: columns of numbers, named or not, and the layout of the Glasgow set.

The Glasgow set (University of Glasgow, doi 10.5525/gla.researchdata.848) begins with four numbers:
carrier (Hz), sweep time (ms), samples of a sweep, bandwidth (Hz); complex samples follow, sweep
after sweep.
"""

import io
import re
from collections.abc import Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from radhar_cli.capture.array_files import StoredArray, as_source
from radhar_cli.capture.named_parts import find_pair, find_times, seconds_of_unit
from radhar_cli.capture.source import CaptureFiles, CaptureFormat, Source
from radhar_cli.errors import CaptureError, did_you_mean
from radhar_cli.files.untrusted import text_of
from radhar_cli.numerics.arrays import Complex, Float

MAX_TEXT = 2**28  # bytes
MAX_COLUMNS = 2**16
MAX_PREAMBLE = 200  # lines before the numbers
FEWEST_COLUMNS = 8  # of a matrix, a pulse a line, whose columns have no names
SUFFIXES = (".csv", ".txt", ".tsv", ".dat", ".asc")
HEADER_OF_GLASGOW = 4  # numbers
_SPLIT = re.compile(r"[,;\t ]+")
_IMAGINARY = re.compile(r"[ij]\s*$", re.IGNORECASE)


def _is_text(path: Path, head: bytes) -> bool:
    """Whether a file is text by its name and its first bytes."""
    return path.suffix.lower() in SUFFIXES and b"\0" not in head


def _open_text(capture: CaptureFiles) -> Source:
    """Open a text of columns: slow time, a pulse a line, or a matrix, a pulse a line.

    Raises:
        CaptureError: lines differ in their columns, or columns have no names that tell.
    """
    path, settings = capture.paths[0], capture.settings
    text = text_of(path, MAX_TEXT, CaptureError).removeprefix("\ufeff")
    lines = [line for line in text.splitlines() if line.strip() and not _is_comment(line)]
    if not lines:
        raise CaptureError(f"{path}: holds no numbers")
    if _is_of_glasgow(lines):
        return _open_glasgow(path, lines, capture)
    layout = _layout_of(lines)
    table = _table(path, lines[layout.first :], 1 + layout.first, layout)
    names = layout.names
    times: Float | None = None
    samples: NDArray[Any] = table
    if names:
        if len(names) != table.shape[1]:
            raise CaptureError(
                f"{path}: names {len(names)} columns; lines have {table.shape[1]} numbers"
            )
        samples, times = _choose_columns(path, dict(zip(names, table.T, strict=True)), capture)
    elif table.shape[1] == 1:
        samples = table[:, 0]
    elif table.shape[1] == 2 and np.isrealobj(table) and settings.axes is None:
        samples = table[:, 0] + 1j * table[:, 1]
    elif table.shape[1] < FEWEST_COLUMNS and settings.axes is None:
        raise CaptureError(
            f"{path}: has {table.shape[1]} columns without names; a first line such as time,I,Q "
            "should say what they are, or --set axes=[pulse,sample] that they are samples of a "
            "pulse"
        )
    if samples.ndim == 2 and settings.axes is None:
        settings = settings.model_copy(update={"axes": ("pulse", "sample")})
    array = StoredArray(str(path), partial(np.asarray, samples))
    return as_source(path, array, settings, times)


class Layout(NamedTuple):
    """Layout of a text.

    Attributes:
        delimiter: What stands between columns; None of blanks.
        has_decimal_comma: Whether numbers have a comma for the point.
        first: Number of the first line of numbers.
        names: Names of the columns; none without a line of them.
    """

    delimiter: str | None
    has_decimal_comma: bool
    first: int
    names: list[str]

    def words(self, line: str) -> list[str]:
        """Words of a line, an empty one where nothing stands between two delimiters."""
        line = line.strip(" ").rstrip(self.delimiter or " \t")
        if line.count(self.delimiter or " ") and self.delimiter is None:
            return line.split()
        words = [word.strip().strip("\"'") for word in line.split(self.delimiter)]
        return [word.replace(",", ".") for word in words] if self.has_decimal_comma else words


def _layout_of(lines: Sequence[str]) -> Layout:
    """Find the layout of lines, the first of which may say something else than numbers."""
    typical = lines[len(lines) // 2].strip(" ")
    delimiter = next((mark for mark in ";\t," if mark in typical), None)
    has_decimal_comma = delimiter != "," and "," in typical and "." not in typical
    plain = Layout(delimiter, has_decimal_comma, 0, [])
    count = len(plain.words(typical))
    first = next(
        (
            index
            for index, line in enumerate(lines[:MAX_PREAMBLE])
            if all(_is_number(word or "nan") for word in plain.words(line))
            and (index == 0 or len(plain.words(line)) == count)
        ),
        1 if len(lines) > 1 else 0,
    )
    if first == 0:
        return plain
    names = plain._replace(has_decimal_comma=False).words(lines[first - 1])
    fits = len(names) == count or first == 1
    return plain._replace(first=first, names=names if fits else [])


def _is_comment(line: str) -> bool:
    """Whether a line is a comment."""
    return line.lstrip().startswith(("#", "%", "//"))


def _is_number(word: str) -> bool:
    """Whether a word is a real or complex number."""
    try:
        complex(word.replace("i", "j").replace("I", "j"))
    except ValueError:
        return False
    return True


def _table(
    path: Path, lines: Sequence[str], first_line: int, layout: Layout | None = None
) -> NDArray[Any]:
    """Numbers of lines [line, column], complex where any is; NaN where nothing stands.

    Raises:
        CaptureError: a word is no number, or lines differ in length.
    """
    if layout is not None and layout.delimiter is not None:
        columns = len(layout.words(lines[0]))
        rows = (layout.words(line) for line in lines)
        filled = ([*row, *[""] * (columns - len(row))] if not all(row) else row for row in rows)
        padded = (
            row + [""] * (columns - len(row))
            if line.count(layout.delimiter) >= columns - 1
            else row
            for row, line in zip(filled, lines, strict=True)
        )
        lines = [" ".join(word.replace(" ", "") or "nan" for word in row) for row in padded]
    body = "\n".join(lines)
    is_complex = any(_IMAGINARY.search(word) for word in _SPLIT.split(lines[0].strip())) or bool(
        re.search(r"\d[ij]", body[: 2**16], re.IGNORECASE)
    )
    if is_complex:
        body = re.sub(r"[iI](?=[\s,;]|$)", "j", body)
    body = _SPLIT.sub(" ", body.replace("\n", "\0")).replace("\0", "\n")
    try:
        table = np.loadtxt(
            io.StringIO(body), dtype=complex if is_complex else float, ndmin=2, comments=None
        )
    except ValueError as error:
        reason = str(error).partition(";")[0].partition("\n")[0]
        raise CaptureError(
            f"{path}: after line {first_line}: {reason}; should be lines of as many numbers each"
        ) from None
    if table.shape[1] > MAX_COLUMNS:
        raise CaptureError(f"{path}: has {table.shape[1]} columns; at most {MAX_COLUMNS} are read")
    return table


def _choose_columns(
    path: Path, columns: dict[str, NDArray[Any]], capture: CaptureFiles
) -> tuple[NDArray[Any], Float | None]:
    """Samples, and times where there are such, of columns by their names.

    Raises:
        CaptureError: nothing tells which columns the samples are.
    """
    settings = capture.settings
    for name in filter(None, (settings.dataset, settings.imaginary, settings.times)):
        if name not in columns:
            hint = did_you_mean(name, columns, f"there are {', '.join(columns)}")
            raise CaptureError(f"{path}: {name}: no such column; {hint}")
    clock = settings.times or find_times(columns)
    times = None
    if clock is not None:
        times = columns[clock].real.astype(float) * seconds_of_unit(clock)
    pair = find_pair(columns)
    if settings.dataset is not None:
        real, imaginary = columns[settings.dataset], settings.imaginary
        samples = real if imaginary is None else real + 1j * columns[imaginary]
        return samples, times
    if pair is not None:
        return columns[pair[0]] + 1j * columns[pair[1]], times
    signals = [name for name in columns if name != clock]
    if len(signals) != 1:
        raise CaptureError(
            f"{path}: has columns {', '.join([*columns][:20])}; --set dataset=NAME should name the "
            "samples, or dataset=NAME and imaginary=NAME I and Q"
        )
    return columns[signals[0]], times


def _is_of_glasgow(lines: Sequence[str]) -> bool:
    """Whether four real numbers are followed by complex ones, a number a line."""
    start = [line.strip() for line in lines[: HEADER_OF_GLASGOW + 2]]
    if len(start) < HEADER_OF_GLASGOW + 2 or not all(map(_is_number, start)):
        return False
    are_complex = [bool(_IMAGINARY.search(word)) for word in start]
    return are_complex == [False] * HEADER_OF_GLASGOW + [True] * 2


def _open_glasgow(path: Path, lines: Sequence[str], capture: CaptureFiles) -> Source:
    """Open a file of the Glasgow set, which says carrier, sweep, samples and bandwidth itself."""
    carrier, sweep_ms, count, bandwidth = (float(line) for line in lines[:HEADER_OF_GLASGOW])
    values = _table(path, lines[HEADER_OF_GLASGOW:], HEADER_OF_GLASGOW)[:, 0]
    samples = int(count) if 2 <= count <= len(values) and sweep_ms > 0 else 0
    if not samples:
        raise CaptureError(
            f"{path}: has {len(values)} samples; line 3 says {count:g} a sweep of {sweep_ms:g} ms"
        )
    sweeps: Complex = values[: len(values) // samples * samples].reshape(-1, samples)
    settings = capture.settings.model_copy(update={"axes": ("pulse", "sample")})
    array = StoredArray(str(path), partial(np.asarray, sweeps))
    prf = 1e3 / sweep_ms
    header = {
        "carrier_hz": carrier,
        "bandwidth_hz": bandwidth,
        "prf_hz": prf,
        "adc_rate_hz": samples * prf,
    }
    return replace(as_source(path, array, settings), settings=header)


TEXT = CaptureFormat("text (.csv, .txt, .dat)", _is_text, _open_text)
