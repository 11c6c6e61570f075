"""The arrays of a data set by name, in pieces: what the formats without images hold."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.dataset.formats.checked import Samples
from radhar_cli.dataset.reading import BLOCK, Dataset


@dataclass(frozen=True)
class Array:
    """An array [N, ...] whose rows are those of dataset.h5.

    Attributes:
        name: as in dataset.h5.
        dtype: of its numbers.
        shape: of all of it.
        pieces: makes its rows, in order.
    """

    name: str
    dtype: np.dtype[Any]
    shape: tuple[int, ...]
    pieces: Iterator[NDArray[Any]]


def arrays(data: Dataset) -> Iterator[Array]:
    """Every array but entropies, extents and checksums; the large ones first."""
    samples = Samples(data)
    for name, large in data.large.items():
        rows = (samples.array(name, row)[None] for row in range(len(data)))
        yield Array(name, large.dtype, large.shape, rows)
    columns = {
        "sample_key": data.sample_key,
        **{f"scene/{name}": column for name, column in data.scene.items()},
        **{f"column_label/{name}": column for name, column in data.column_label.items()},
    }
    for name in ("label", "split"):
        values = getattr(data, name)
        yield Array(name, values.dtype, values.shape, iter([values]))
    for name, column in columns.items():
        starts = range(0, len(data), BLOCK)
        pieces = (column.rows(start, start + BLOCK) for start in starts)
        yield Array(name, column.dtype, column.shape, pieces)
