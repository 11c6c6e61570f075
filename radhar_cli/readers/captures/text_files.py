"""Captures that are text: columns of numbers, named or not."""

import io
import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from radhar_cli.errors import CaptureError, did_you_mean
from radhar_cli.files import plain_text
from radhar_cli.files.clocks import READ_CLOCKS, replace_clocks
from radhar_cli.files.untrusted import regular_size
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.readers.captures.array_axes import as_source, settings_with_frames
from radhar_cli.readers.captures.glasgow_files import is_of_glasgow, open_glasgow
from radhar_cli.readers.captures.named_parts import (
    POLAR,
    find_pair,
    find_receivers,
    find_times,
    unit_of_angle,
)
from radhar_cli.readers.captures.point_tables import refuse_array_of_points, refuse_names_of_points
from radhar_cli.readers.captures.pulse_clock import seconds_of
from radhar_cli.readers.captures.settings import NO_TIMES, AxisName, CaptureSettings
from radhar_cli.readers.captures.source import CaptureFiles, CaptureFormat, MissingKeysError, Source
from radhar_cli.readers.captures.stored_arrays import FrameFiles, StoredArray

MAX_TEXT = 2**28  # bytes, of all files
MAX_COLUMNS = 2**16
MAX_PREAMBLE = 200  # lines before the numbers
FEWEST_COLUMNS = 8  # of a matrix, a pulse a line, whose columns have no names
SUFFIXES = (".csv", ".txt", ".tsv", ".dat", ".asc")
EPOCH_S = 1e9  # seconds from 1970 to 2001, before which nobody has recorded
_SPLIT = re.compile(r"[,;\t ]+")
_IMAGINARY = re.compile(r"[ij]\s*\)?\s*$", re.IGNORECASE)
_REAL = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
# 1 + 2i, 1 + j2, 1+2*I, all of which become 1+2j; and C++'s (1,2).
_SUM = re.compile(
    rf"(?P<re>{_REAL})\s*(?P<sign>[-+])\s*(?:[ij]\s*\*?\s*(?P<first>{_REAL[5:]})|"
    rf"(?P<last>{_REAL[5:]})\s*\*?\s*[ij])(?![\w.])",
    re.IGNORECASE,
)
# A second line of names may hold the units.
_UNIT_WORD = re.compile(r"[(\[].*[)\]]||-|[munµ]?[sVA]|sec(?:onds?)?|volts?|counts?|rad|deg", re.I)
_UNREAD_CLOCK = re.compile(r"[^,;\t\"']*\d:\d\d[^,;\t\"']*")
_PAIR = re.compile(rf"\(\s*({_REAL})\s*[,;]\s*({_REAL})\s*\)")


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


def _is_text(path: Path, head: bytes) -> bool:
    """Whether a file is text by its name and its first bytes."""
    if path.suffix.lower() not in SUFFIXES:
        return False
    try:
        plain_text.decode_text(head)
    except ValueError:
        return False
    return True


def _decode(path: Path) -> str:
    """Text of a file.

    Raises:
        CaptureError: it is too large, or no text.
    """
    size = regular_size(path)
    if size > MAX_TEXT:
        raise CaptureError(f"{path}: has {size} bytes; should have at most {MAX_TEXT}")
    try:
        return plain_text.decode_text(path.read_bytes())
    except ValueError as error:
        raise CaptureError(f"{path}: {error}") from None


def _open_text(capture: CaptureFiles) -> Source:
    """Open a text of columns: slow time, a pulse a line, or a matrix, a pulse a line.

    Of several files each is a frame.

    Raises:
        CaptureError: lines differ in their columns, or columns have no names that tell.
    """
    paths, settings = capture.paths, capture.settings
    if len(paths) > 1 and sum(map(regular_size, paths)) > MAX_TEXT:
        raise CaptureError(f"{paths[0]}: with the others takes more than {MAX_TEXT} bytes")
    signals = list[TextSignal]()
    for path in paths:
        if len(paths) == 1 and is_of_glasgow(path):
            return open_glasgow(path, settings)
        lines = _lines_of(_decode(path))
        if not lines:
            raise CaptureError(f"{path}: holds no numbers")
        signals.append(_signal_of(path, lines, settings))
    first = signals[0]
    if settings.axes is None and first.axes is not None:
        settings = settings.model_copy(update={"axes": first.axes})
    arrays = [
        StoredArray(str(path), partial(np.asarray, signal.samples))
        for path, signal in zip(paths, signals, strict=True)
    ]
    if len(arrays) > 1:
        samples = FrameFiles(arrays)
        settings = settings_with_frames(samples, settings, of_matlab=False)
        return replace(as_source(paths[0], samples, settings), files=tuple(paths))
    source = as_source(paths[0], arrays[0], settings, first.times)
    return replace(source, notes=(*source.notes, *first.notes))


def _lines_of(text: str) -> list[str]:
    """Lines of numbers and names of a text, its numbers in one way of writing.

    Of comments the last before the numbers stays, as it may name the columns.
    """
    text = replace_clocks(text)
    text = _SUM.sub(lambda m: f"{m['re']}{m['sign']}{m['first'] or m['last']}j", text)
    text = _PAIR.sub(lambda m: f"{m[1]}{m[2] if m[2][0] in '+-' else '+' + m[2]}j", text)
    lines, comment = list[str](), ""
    for line in text.splitlines():
        if _is_comment(line):
            comment = line if not lines else comment
        elif line.strip():
            if not lines and comment:
                comment = comment.lstrip("#%/ ")
            lines.append(line)
    if comment and len(lines) > 1:
        names, layout = _SPLIT.split(comment.strip()), _layout_of(lines)
        words = layout.words(comment) if layout.delimiter else names
        fits = layout.first == 0 and len(words) == len(layout.words(lines[0]))
        if fits and len(words) > 1 and not all(map(_is_number, words)):
            return [comment, *lines]
    return lines


def _signal_of(path: Path, lines: Sequence[str], settings: CaptureSettings) -> TextSignal:
    """Samples of the lines of a text.

    Raises:
        CaptureError: lines differ in their columns, or columns have no names that tell.
    """
    layout = _layout_of(lines)
    table = _table(path, lines[layout.first :], 1 + layout.first, layout)
    if layout.names:
        twins = sorted({name for name in layout.names if layout.names.count(name) > 1})
        if twins and set(twins) != {""}:
            raise CaptureError(f"{path}: several columns are named {', '.join(twins)}")
        if len(layout.names) != table.shape[1]:
            raise CaptureError(
                f"{path}: names {len(layout.names)} columns; lines have {table.shape[1]} numbers"
            )
        return _choose_columns(path, dict(zip(layout.names, table.T, strict=True)), settings)
    if table.shape[1] == 1:
        return TextSignal(table[:, 0])
    refuse_array_of_points(StoredArray(str(path), partial(np.asarray, table)))
    if table.shape[1] == 2 and np.isrealobj(table) and settings.axes is None:
        return TextSignal(table[:, 0] + 1j * table[:, 1])
    if table.shape[1] < FEWEST_COLUMNS and settings.axes is None:
        raise CaptureError(
            f"{path}: has {table.shape[1]} columns without names; a first line such as time,I,Q "
            "should say what they are, or --set axes=[pulse,sample] that they are samples of a "
            "pulse"
        )
    return _signal_of_matrix(path, table, settings)


def _signal_of_matrix(path: Path, table: NDArray[Any], settings: CaptureSettings) -> TextSignal:
    """Samples of a matrix [pulse, number], whose last column may be times since 1970.

    So do programs around uRAD's radars write a sweep a line: all I, all Q, and the time.

    Raises:
        MissingKeysError: numbers beside such times may be I and Q, or real samples.
    """
    times, clock = None, table[:, -1].real
    is_clock = len(table) > 2 and bool((clock > EPOCH_S).all() and (np.diff(clock) >= 0).all())
    notes: tuple[str, ...] = ()
    if is_clock and np.isrealobj(table):
        table = table[:, :-1]
        if settings.times != NO_TIMES:
            times, _ = seconds_of(clock, "times_s" if clock[0] < 1e11 else "times", str(path))
            notes = ("times of the pulses: the last column (times=none leaves it out)",)
    axes, numbers = settings.axes, table.shape[1]
    if axes is None and is_clock and numbers % 2 == 0:
        raise MissingKeysError(
            f"{path}: has {numbers} real numbers a line and a time: are they samples "
            "(axes=[pulse,sample]), I and then Q (axes=[pulse,iq,sample]), or I and Q by turns "
            "(axes=[pulse,sample,iq])?",
            {"axes": "[pulse,iq,sample]"},
        )
    if axes in (("pulse", "iq", "sample"), ("pulse", "sample", "iq")) and numbers % 2 == 0:
        sizes = (2, numbers // 2) if axes[1] == "iq" else (numbers // 2, 2)
        return TextSignal(table.reshape(len(table), *sizes), axes, times, notes)
    return TextSignal(table, ("pulse", "sample"), times, notes)


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
    has_decimal_comma = delimiter != "," and "," in typical
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
    header = plain._replace(has_decimal_comma=False)
    names = header.words(lines[first - 1])
    above = header.words(lines[first - 2]) if first > 1 else []
    if len(above) == len(names) and all(map(_UNIT_WORD.fullmatch, names)):
        names = [f"{a} ({u.strip('()[]')})" for a, u in zip(above, names, strict=True)]
    fits = len(names) == count or first == 1
    return plain._replace(first=first, names=names if fits else [])


def _is_comment(line: str) -> bool:
    """Whether a line is a comment."""
    return line.lstrip().startswith(("#", "%", "//"))


def _is_number(word: str) -> bool:
    """Whether a word is a real or complex number."""
    if not (any(map(str.isdigit, word)) or word.lower() in ("nan", "inf")):
        return False
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
    stored = lines
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
        if clock := next(filter(None, map(_UNREAD_CLOCK.search, stored)), None):
            raise CaptureError(
                f"{path}: '{clock[0]}' is no clock that is read; such are {READ_CLOCKS}"
            ) from None
        reason = str(error).partition(";")[0].partition("\n")[0]
        raise CaptureError(
            f"{path}: after line {first_line}: {reason}; should be lines of as many numbers each"
        ) from None
    if table.shape[1] > MAX_COLUMNS:
        raise CaptureError(f"{path}: has {table.shape[1]} columns; at most {MAX_COLUMNS} are read")
    return table


def _choose_columns(
    path: Path, columns: Mapping[str, NDArray[Any]], settings: CaptureSettings
) -> TextSignal:
    """Samples, and times where there are such, of columns by their names.

    Raises:
        CaptureError: nothing tells which columns the samples are.
    """
    refuse_names_of_points(path, columns)
    named_times = None if settings.times == NO_TIMES else settings.times
    for name in filter(None, (settings.dataset, settings.imaginary, named_times)):
        if name not in columns:
            hint = did_you_mean(name, columns, f"there are {', '.join(columns)}")
            raise CaptureError(f"{path}: {name}: no such column; {hint}")
    clock = named_times or find_times(columns)
    times, note = None, None
    if clock is not None and settings.times != NO_TIMES:
        times, note = seconds_of(columns[clock].real.astype(float), clock, str(path))
    notes = (note,) if note else ()
    if settings.dataset is not None:
        real, imaginary = columns[settings.dataset], settings.imaginary
        samples = real if imaginary is None else real + 1j * columns[imaginary]
        return TextSignal(samples, ("pulse",), times, notes)
    receivers = find_receivers(columns)
    if receivers:
        pairs = ", ".join(f"{real} and {imaginary}" for real, imaginary in receivers)
        samples = np.stack([columns[real] + 1j * columns[q] for real, q in receivers], axis=1)
        return TextSignal(samples, ("pulse", "receiver"), times, (*notes, f"receivers: {pairs}"))
    pair = find_pair(columns)
    if pair is not None:
        return TextSignal(columns[pair[0]] + 1j * columns[pair[1]], ("pulse",), times, notes)
    polar = find_pair(columns, POLAR)
    if polar is not None:
        samples, unit = _of_polar(path, columns, *polar)
        words = f"{polar[0]} and {polar[1]} in {unit} make I and Q"
        return TextSignal(samples, ("pulse",), times, (*notes, words))
    signals = [name for name in columns if name != clock]
    if len(signals) != 1:
        raise CaptureError(
            f"{path}: has columns {', '.join([*columns][:20])}; --set dataset=NAME should name the "
            "samples, or dataset=NAME and imaginary=NAME I and Q"
        )
    samples = columns[signals[0]]
    axes: tuple[AxisName, ...] | None = ("pulse",) if len(columns) > 1 else None
    if np.isrealobj(samples) and axes is not None:
        notes = (*notes, f"{signals[0]}: real samples")
    return TextSignal(samples, axes, times, notes)


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


TEXT = CaptureFormat("text (.csv, .tsv, .txt, .dat)", _is_text, _open_text, is_split=True)
