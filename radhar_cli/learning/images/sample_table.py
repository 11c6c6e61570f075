"""Table of the samples of a data set in memory, one row each."""

from collections.abc import Iterable
from dataclasses import dataclass, fields
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from radhar_cli.learning.intervals import Groups
from radhar_cli.numerics.arrays import Index, Levels

Objects: TypeAlias = NDArray[np.object_]


@dataclass(frozen=True)
class SampleTable:
    """One row a sample; each column has length N, or is None where the source does not say."""

    label: Index  # [N] index into the classes of the set
    name: Objects  # [N] text, for messages and tables
    source: Index  # [N] which of several joined sets the sample came from
    split: Levels | None = None  # [N] 0 train, 1 validation, 2 test
    scene: Objects | None = None  # [N] fingerprint of person and motion, text
    person: Objects | None = None  # [N] text: who is seen, or the recording it was cut from
    recording: Objects | None = None  # [N] text; None where each sample is a recording of its own
    # [N] tuples of the classes of all persons, the main person's first; None with one person each
    activities: Objects | None = None
    frame_labels: Index | None = None  # [N, W] class of each column of streams, -1 unknown
    first_column: Index | None = None  # [N] of a window in its recording

    def __len__(self) -> int:
        return len(self.label)

    @property
    def recordings(self) -> Objects:
        """Name of the recording of each row [N]; a row is its own where none is named."""
        return self.name if self.recording is None else self.recording

    @property
    def first_columns(self) -> Index:
        """First column of each row in its recording [N]; 0 of those that are no windows."""
        return np.zeros(len(self), np.intp) if self.first_column is None else self.first_column

    def groups(self, rows: Index, by_person: bool = True) -> Groups:
        """Persons, recordings or scenes of some rows, whichever is known first; else the rows.

        Args:
            rows: rows [N] of the table.
            by_person: whether other persons could have been seen; not where the person is learned.
        """
        columns = {"recording": self.recording, "scene": self.scene}
        if by_person and self.person is not None:
            is_named = (self.person != self.recordings)[rows].any()
            columns = {"person" if is_named else "recording": self.person}
        for kind, column in columns.items():
            if column is None or (column[rows] == "").any():
                continue
            number = np.unique(column[rows].astype(str), return_inverse=True)[1]
            if number.max() + 1 < rows.size:
                return Groups(number, kind)
        return Groups(np.arange(rows.size), "sample")

    def take(self, rows: Index) -> "SampleTable":
        """Take rows in the order given; a row may come twice."""
        columns: dict[str, Any] = {}
        for field in fields(self):
            column = getattr(self, field.name)
            columns[field.name] = None if column is None else column[rows]
        return SampleTable(**columns)


def objects(values: Iterable[object]) -> Objects:
    """Column of texts or tuples [N]."""
    return np.fromiter(values, dtype=object)
