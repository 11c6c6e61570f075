"""Captures that are text: columns with names, or columns of numbers, a pulse a line.

Names tell I and Q, amplitude and phase, and times; two columns without names are I and Q, one of
complex numbers both. What columns of a matrix are, `axes` says.
"""

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from itertools import islice
from pathlib import Path
from statistics import mode
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from radhar_cli.errors import CaptureError
from radhar_cli.files import plain_text
from radhar_cli.files.clocks import TIME_WORDS, seconds_of_texts
from radhar_cli.files.untrusted import bytes_of, regular_size
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.readers.captures.array_axes import as_source, settings_with_frames
from radhar_cli.readers.captures.named_arrays import choose_arrays
from radhar_cli.readers.captures.named_parts import POLAR, find_pair, find_receivers, unit_of_angle
from radhar_cli.readers.captures.point_tables import refuse_array_of_points, refuse_names_of_points
from radhar_cli.readers.captures.pulse_clock import seconds_of
from radhar_cli.readers.captures.settings import NO_TIMES, AxisName, CaptureSettings
from radhar_cli.readers.captures.source import CaptureFiles, CaptureFormat, MissingKeysError, Source
from radhar_cli.readers.captures.stored_arrays import FrameFiles, StoredArray
from radhar_cli.readers.text_table import (
    LOST,
    SAMPLED,
    TextTable,
    is_comment,
    is_number,
    split_lines,
    text_of_bytes,
)

MAX_TEXT = 2**28  # bytes, of all files
MAX_PULSES = 2**26
MAX_PREAMBLE = 200  # lines before the numbers
SUFFIXES = (".csv", ".txt", ".tsv", ".dat", ".asc")
EPOCH_S = 1e9  # seconds from 1970 to 2001, before which nobody has recorded
# Words of a second line of names, which holds the units.
UNITS = {*TIME_WORDS, "", "-", "v", "mv", "a", "ma", "counts", "rad", "deg"}
# It begins where no digit precedes it, so that the time grows with the length of a word alone.
_REAL = r"[-+]?(?<![\d.])(?:\d+(?:\.\d*)?|\.\d+)(?:e[-+]?\d+)?"
# The ways in which programs write 1+2j: (1+2j), 1 + 2i, 1+2*I, 1 + j2; and C++'s (1,2).
_COMPLEX = re.compile(
    rf"\(?(?P<re>{_REAL})\s*(?:(?P<sign>[-+])\s*(?:[ij]\s*\*?\s*(?P<last>{_REAL[5:]})|"
    rf"(?P<first>{_REAL[5:]})\s*\*?\s*[ij])\)?|,\s*(?P<pair>{_REAL})\s*\))(?![\w.])",
    re.IGNORECASE,
)


class TextSignal(NamedTuple):
    """Samples of a text.

    Attributes:
        samples: Numbers [pulse], [pulse, sample] or [pulse, receiver].
        axes: Names of the axes, if the text tells them.
        times: Times of the pulses [pulse], s; None without.
        notes: What was assumed, in words.
    """

    samples: NDArray[Any]
    axes: tuple[AxisName, ...] | None = None
    times: Float | None = None
    notes: tuple[str, ...] = ()


def capture_error(where: str, problem: str) -> CaptureError:
    """Error to raise about a file, or about a file and a line."""
    return CaptureError(f"{where}: {problem}")


def is_text(path: Path, head: bytes) -> bool:
    """Whether a file is text by its name and its first bytes."""
    if path.suffix.lower() not in SUFFIXES:
        return False
    try:
        plain_text.decode_text(head)
    except ValueError:
        return False
    return True


def read_capture_lines(path: Path) -> list[str]:
    """Lines of a text of at most MAX_TEXT bytes, whose complex numbers are written as 1+2j.

    Raises:
        CaptureError: it is too large, or no text.
    """
    data = bytes_of(path, MAX_TEXT, CaptureError)
    lines = text_of_bytes(data, str(path), MAX_TEXT, capture_error).splitlines()
    if _COMPLEX.search(_last_line(lines)):
        return [_COMPLEX.sub(_plain_complex, line) for line in lines]
    return lines


def _plain_complex(match: re.Match[str]) -> str:
    """Text of a complex number as Python reads it."""
    imaginary = match["pair"] or f"{match['sign']}{match['first'] or match['last']}"
    return f"{match['re']}{'' if imaginary[0] in '+-' else '+'}{imaginary}j"


def _last_line(lines: Sequence[str]) -> str:
    """Last line that is neither empty nor a comment; "" where all are."""
    return next((line for line in reversed(lines) if line.strip() and not is_comment(line)), "")


def _open_text(capture: CaptureFiles) -> Source:
    """Open a text of columns: slow time, or a matrix, a pulse a line; of several files frames.

    Raises:
        CaptureError: lines differ in their columns, or nothing tells what columns are.
    """
    paths, settings = capture.paths, capture.settings
    if len(paths) > 1 and sum(map(regular_size, paths)) > MAX_TEXT:
        raise CaptureError(f"{paths[0]}: with the others takes more than {MAX_TEXT} bytes")
    signals = [_read_signal(path, settings) for path in paths]
    first = signals[0]
    if settings.axes is None and first.axes is not None:
        settings = settings.model_copy(update={"axes": first.axes})
    arrays = [
        StoredArray(str(path), partial(np.asarray, signal.samples))
        for path, signal in zip(paths, signals, strict=True)
    ]
    if len(arrays) > 1:
        samples = FrameFiles(arrays)
        settings = settings_with_frames(settings, of_matlab=False)
        return replace(as_source(paths[0], samples, settings), files=tuple(paths))
    source = as_source(paths[0], arrays[0], settings, first.times)
    return replace(source, notes=(*source.notes, *first.notes))


def _read_signal(path: Path, settings: CaptureSettings) -> TextSignal:
    """Samples of a text.

    Raises:
        CaptureError: lines differ in their columns, or nothing tells what columns are.
    """
    table = split_lines(read_capture_lines(path), str(path), capture_error)
    begin, names = _find_heading(table)
    if names:
        twins = sorted({name for name in names if name and names.count(name) > 1})
        if twins:
            raise CaptureError(f"{path}: several columns are named {', '.join(twins)}")
        return _choose_columns(path, table, begin, names, settings)
    width = _usual_width(table)
    samples = _read_columns(table, begin, range(width), width)
    if width == 1:
        return TextSignal(samples[:, 0])
    refuse_array_of_points(StoredArray(str(path), partial(np.asarray, samples)))
    if settings.axes is not None:
        return _signal_of_matrix(path, samples, settings.axes, settings.times != NO_TIMES)
    if width == 2 and np.isrealobj(samples):
        return TextSignal(samples[:, 0] + 1j * samples[:, 1])
    raise MissingKeysError(
        f"{path}: has {width} columns without names: are they samples of a pulse "
        "(axes=[pulse,sample]), receivers (axes=[pulse,receiver]), I and then Q, and maybe a time "
        "(axes=[pulse,iq,sample]), or I and Q by turns (axes=[pulse,sample,iq])? A first line such "
        "as time,I,Q names columns",
        {"axes": "[pulse,iq,sample]" if width % 2 else "[pulse,sample]"},
    )


def _signal_of_matrix(
    path: Path, table: NDArray[Any], axes: tuple[AxisName, ...], has_times: bool
) -> TextSignal:
    """Samples of a matrix [pulse, number], whose last column may be times since 1970.

    So do programs around uRAD's radars write a sweep a line: all I, all Q, and the time.
    """
    times, notes, clock = None, tuple[str, ...](), table[:, -1].real
    is_clock = bool((clock > EPOCH_S).all() and (np.diff(clock) >= 0).all())
    if is_clock and table.shape[1] > 2 and np.isrealobj(table):
        table = table[:, :-1]
        if has_times:
            times, _ = seconds_of(clock, "times_s" if clock[0] < 1e11 else "times", str(path))
            notes = ("times of the pulses: the last column (times=none leaves it out)",)
    return TextSignal(table, axes, times, notes)


def _find_heading(table: TextTable) -> tuple[int, list[str]]:
    """First row of numbers of a table, and the names of its columns; none without such a line.

    The line above the numbers holds the names, or the units of those above it; it may be a comment.
    """
    count = _usual_width(table)
    head, begin = list[list[str]](), None
    first, names = 0, list[str]()  # row below the line that may have the names
    for number, line in enumerate(islice(table.lines, MAX_PREAMBLE)):
        is_remark = is_comment(line)
        row = _trim_row(next(iter(table.cells([line.lstrip("#%/ ") if is_remark else line])), []))
        if not is_remark and len(row) == count and _is_numeric(row):
            begin = number
            break
        if row and (not is_remark or len(row) == count > 1):
            head.append([cell.strip().strip("\"'") for cell in row])
            if not names or len(names) != count:
                first, names = number + 1, head[-1]
    if begin is None:
        return first, names
    names = head[-1] if head and (len(head) == 1 or len(head[-1]) == count) else []
    units = [name.strip("()[] ") for name in names]
    if len(head) > 1 and len(head[-2]) == count and {u.lower() for u in units} <= UNITS:
        names = [f"{name} ({unit})" for name, unit in zip(head[-2], units, strict=True)]
    return begin, names


def _usual_width(table: TextTable) -> int:
    """Number of cells of most of the last lines, of which one may be cut off."""
    filled = (line for line in reversed(table.lines) if line.strip() and not is_comment(line))
    return mode(len(_trim_row(row)) for row in table.cells(islice(filled, SAMPLED)))


def _trim_row(row: Sequence[str]) -> list[str]:
    """Cells of a row without the empty ones at its end."""
    cells = [*row]
    while cells and not cells[-1].strip():
        cells.pop()
    return cells


def _is_numeric(row: Sequence[str]) -> bool:
    """Whether the cells of a row are numbers, lost ones or instants."""
    return any(map(_is_complex, row)) and all(
        _is_complex(cell) or cell.strip().lower() in LOST or seconds_of_texts([cell]) is not None
        for cell in row
    )


def _is_complex(cell: str) -> bool:
    """Whether a cell is a real or complex number."""
    try:
        complex(cell)
    except ValueError:
        return False
    return True


def _read_columns(table: TextTable, begin: int, columns: Sequence[int], width: int) -> NDArray[Any]:
    """Numbers [pulse, column] of some columns, complex where any of the first line is."""
    rows = table.filled_rows(begin, width)
    _, first = next(table.filled_rows(begin, None), (0, [""] * width))
    are_real = all(
        is_number(first[column]) or not _is_complex(first[column])
        for column in columns
        if column < len(first)
    )
    return table.numbers(rows, columns, MAX_PULSES, float if are_real else complex)


def _choose_columns(
    path: Path, table: TextTable, begin: int, names: Sequence[str], settings: CaptureSettings
) -> TextSignal:
    """Samples, and times where there are such, of columns by their names.

    Raises:
        CaptureError: nothing tells which columns the samples are.
    """
    refuse_names_of_points(path, names)
    width = len(names)
    shapes = {name: (max(len(table.lines) - begin, 2),) for name in names}
    receivers = find_receivers(names) if settings.dataset is None else []
    polar = find_pair(names, POLAR) if settings.dataset is None else None
    likely = receivers[0] if receivers else polar or (settings.dataset, settings.imaginary)
    chosen = choose_arrays(
        path,
        shapes,
        settings.model_copy(update={"dataset": likely[0], "imaginary": likely[1]}),
    )
    pairs: Sequence[tuple[str, str | None]]
    pairs = receivers or [(chosen.samples, chosen.imaginary)]
    wanted = [name for pair in pairs for name in pair if name is not None]
    places = [names.index(name) for name in wanted]
    values = dict(zip(wanted, _read_columns(table, begin, places, width).T, strict=True))
    times, notes = None, list[str]()
    if chosen.times is not None:
        instants, are_clocks = table.instants(
            table.filled_rows(begin, width), names.index(chosen.times)
        )
        times, note = instants, None
        if not are_clocks:
            times, note = seconds_of(instants, chosen.times, str(path))
        notes += [note] if note else []
    if polar and not receivers:
        samples, unit = _of_polar(path, values, *polar)
        notes.append(f"{polar[0]} and {polar[1]} in {unit} make I and Q")
    else:
        signals = [values[i] if q is None else values[i] + 1j * values[q] for i, q in pairs]
        samples = np.stack(signals, axis=1) if receivers else signals[0]
    if receivers:
        notes.append(f"receivers: {', '.join(f'{i} and {q}' for i, q in receivers)}")
        return TextSignal(samples, ("pulse", "receiver"), times, tuple(notes))
    axes: tuple[AxisName, ...] | None = ("pulse",) if width > 1 else None
    if np.isrealobj(samples) and axes is not None and settings.dataset is None:
        notes.append(f"{chosen.samples}: real samples")
    return TextSignal(samples, axes, times, tuple(notes))


def _of_polar(
    path: Path, columns: Mapping[str, NDArray[Any]], amplitude: str, phase: str
) -> tuple[Complex, str]:
    """Complex samples of amplitude and phase, and the unit of the phase.

    Raises:
        CaptureError: a phase without a unit goes beyond one turn: degrees, or radians of many.
    """
    angles, unit = columns[phase].real, unit_of_angle(phase)
    if unit is None and np.nanmax(np.abs(angles)) > 2 * np.pi:
        raise CaptureError(
            f"{path}: {phase}: goes beyond 2 pi; its name should say the unit, such as "
            f"{phase}_deg or {phase}_rad"
        )
    unit = unit or "rad"
    radians = np.radians(angles) if unit == "deg" else angles
    return columns[amplitude] * np.exp(1j * radians), unit


TEXT = CaptureFormat("text (.csv, .tsv, .txt, .dat)", is_text, _open_text, is_split=True)
