"""Numbers that come with recordings: order, length, names of files, and columns of a table.

Measured data sets leak by how they were recorded: class after class, each of another length, on
another day, by other people. S. Kapoor and A. Narayanan, "Leakage and the reproducibility crisis in
machine-learning-based science", Patterns 4, 2023, list such features that stand for the label.
"""

import csv
import io
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from datetime import date
from pathlib import Path, PurePosixPath

import numpy as np

from radhar_cli.config.data_set import MeasuredConfig
from radhar_cli.dataset.recorded import windows
from radhar_cli.errors import FolderError
from radhar_cli.files.untrusted import text_of
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.study.audit.evidence import Evidence, EvidencePart

KEYS = ("file", "sample", "image", "name")  # columns by which a table is matched, the first of them
WHO = ("person", "subject")
RECORDING = ("recording", "session")
LABELS = ("class", "label", "activity")
SPLIT = "split"
MAX_TABLE = 2**26  # bytes
MAX_COLUMNS = 200
MAX_ROWS = 1_000_000
RECORD_ALIKE = "record each class at several times, in turn, for the same length"


@dataclass(frozen=True)
class RecordingTable:
    """A table of samples: texts by column [N], "" where a cell is empty."""

    path: Path
    columns: dict[str, list[str]]

    def __len__(self) -> int:
        return len(next(iter(self.columns.values())))

    def first_of(self, names: Sequence[str]) -> list[str] | None:
        """The first column of some names that the table has."""
        return next((self.columns[name] for name in names if name in self.columns), None)


def read_table(path: Path) -> RecordingTable:
    """Read a CSV file with a line of names, and a row for each sample or file.

    Raises:
        FolderError: it cannot be read, or has no such lines.
    """
    text = text_of(path, MAX_TABLE, FolderError).removeprefix("\ufeff")
    try:
        rows = [row for row in csv.reader(io.StringIO(text, newline=""), strict=True) if row]
    except csv.Error as error:
        raise FolderError(f"{path}: is no CSV table ({error})") from None
    names = [name.strip().lower() for name in rows[0]] if rows else []
    if len(rows) < 2 or len(rows) - 1 > MAX_ROWS or len(names) > MAX_COLUMNS:
        raise FolderError(
            f"{path}: should have a line of names, then 1 to {MAX_ROWS} rows of at most "
            f"{MAX_COLUMNS} columns"
        )
    if not all(names) or len(set(names)) != len(names):
        raise FolderError(f"{path}: line 1: {','.join(rows[0])}: should name each column once")
    for number, row in enumerate(rows[1:], 2):
        if len(row) != len(names):
            raise FolderError(
                f"{path}: row {number} has {len(row)} cells; should have {len(names)}, as line 1"
            )
    cells = zip(*rows[1:], strict=True)
    return RecordingTable(
        path, {n: [cell.strip() for cell in c] for n, c in zip(names, cells, strict=True)}
    )


def match_table(table: RecordingTable, names: Sequence[str]) -> RecordingTable:
    """Rows of a table for each sample, by its name or the path of its file.

    Args:
        table: table with a column file, sample, image or name.
        names: paths or names of the samples [N].

    Raises:
        FolderError: it has no such column, names a sample twice, or fits none of the samples.
    """
    key = next((name for name in KEYS if name in table.columns), None)
    if key is None:
        raise FolderError(
            f"{table.path}: has the columns {', '.join(table.columns)}; one should be "
            f"{' or '.join(KEYS)}"
        )
    places: dict[str, int] = {}
    for row, cell in enumerate(table.columns[key]):
        if cell in places:
            raise FolderError(f"{table.path}: {key} = {cell!r}: stands there twice")
        places[cell] = row
    rows = [next((places[form] for form in _forms(name) if form in places), None) for name in names]
    if all(row is None for row in rows):
        raise FolderError(
            f"{table.path}: {key} = {table.columns[key][0]!r}: no sample is called so; they are "
            f"called as {next(_forms(names[0]))!r}"
        )
    return RecordingTable(
        table.path,
        {
            name: ["" if row is None else cells[row] for row in rows]
            for name, cells in table.columns.items()
            if name != key
        },
    )


def _forms(name: str) -> Iterator[str]:
    """Yield a name as tables may have it: whole, its ends, with and without the file's suffix."""
    path = PurePosixPath(name.replace("\\", "/"))
    for start in range(len(path.parts)):
        end = PurePosixPath(*path.parts[start:])
        yield str(end)
        yield str(end.with_suffix(""))


def table_evidence(table: RecordingTable) -> list[Evidence]:
    """Evidence of each column of a table that differs from sample to sample."""
    groups = {*WHO, *RECORDING}
    return [
        Evidence(
            EvidencePart.RECORDINGS,
            name,
            as_numbers(cells)[:, None],
            name,
            "everybody should do every class as often" if name in groups else RECORD_ALIKE,
            tells_who=name in groups,
        )
        for name, cells in table.columns.items()
        if name not in (*LABELS, SPLIT) and len(set(cells)) > 1
    ]


def as_numbers(cells: Sequence[str]) -> Float:
    """Numbers [N] of a column: numbers, days of dates, or places in the alphabet; "" is NaN."""
    for read in (float, _day):
        try:
            return np.array([np.nan if cell == "" else read(cell) for cell in cells])
        except ValueError:
            continue
    texts = {cell: float(place) for place, cell in enumerate(sorted(set(cells)))}
    return np.array([np.nan if cell == "" else texts[cell] for cell in cells])


def _day(cell: str) -> float:
    return float(date.fromisoformat(cell[:10]).toordinal())


def name_evidence(files: Sequence[Path]) -> list[Evidence]:
    """Evidence of the numbers in the names of files: order, day, session.

    Args:
        files: image files of the samples [N], in class folders.
    """
    found_numbers = [re.findall(r"\d+", file.stem) for file in files]
    count = max(map(len, found_numbers), default=0)
    evidence = []
    for place in range(min(count, 8)):
        values = np.array(
            [float(n[place][:15]) if place < len(n) else np.nan for n in found_numbers]
        )
        if np.unique(values).size > 1:
            words = f"number {place + 1} in the file's name" if count > 1 else "number in the name"
            evidence.append(
                Evidence(EvidencePart.RECORDINGS, words, values[:, None], cure=RECORD_ALIKE)
            )
    return evidence


def window_evidence(config: MeasuredConfig) -> list[Evidence]:
    """Evidence of the origin of windows of recordings: order, length, time, and person."""
    cuts = windows(config)
    orders = _orders([(cut.part.person, cut.number) for cut in cuts])
    columns: Mapping[str, Float] = {
        "order of the recording": np.array([cut.number for cut in cuts], float),
        "order among the person's recordings": orders,
        "length of the recording (s)": np.array([c.part.stop_s - c.part.start_s for c in cuts]),
        "time within the recording (s)": np.array([c.start - c.part.start_s for c in cuts]),
    }
    evidence = [
        Evidence(EvidencePart.RECORDINGS, name, values[:, None], cure=RECORD_ALIKE)
        for name, values in columns.items()
        if np.unique(values).size > 1
    ]
    names = [cut.part.person or "" for cut in cuts]
    if len(set(names)) > 1:
        cure = "everybody should do every class as often"
        person = as_numbers([f"person {name}" if name else "" for name in names])
        evidence.append(
            Evidence(
                EvidencePart.RECORDINGS, "who it is", person[:, None], cure=cure, tells_who=True
            )
        )
    return evidence


def _orders(parts: Sequence[tuple[str | None, int]]) -> Float:
    """Place [N] of each part among the parts of its person, from 0."""
    numbers = dict[str | None, list[int]]()
    for person, number in sorted(set(parts), key=lambda part: part[1]):
        numbers.setdefault(person, []).append(number)
    return np.array([numbers[person].index(number) for person, number in parts], float)


def recording_of_window(config: MeasuredConfig) -> list[str]:
    """File of the recording that each window was cut from [N]."""
    return [cut.part.file for cut in windows(config)]


def numbered(names: Sequence[object]) -> Index:
    """Numbers [N] of names; samples whose name is empty are each their own."""
    texts = [
        f"is {name}" if name not in (None, "") else f"row {row}" for row, name in enumerate(names)
    ]
    return np.unique(np.array(texts, dtype=object), return_inverse=True)[1]
