"""Writers that copy shards into a data set: one class for each kind of column.

A new kind of column is a class with `append` and `close`, and its place in `column_writers`. In
that place it appends the rows of each shard; at the end writers are closed from the last to the
first. Both orders decide where HDF5 puts the data, and so the bytes of dataset.h5.
"""

import csv
import hashlib
import io
from collections.abc import Callable
from math import prod
from typing import Any, Protocol

import h5py
import numpy as np
from numpy.typing import NDArray

from radhar_cli.config.data_set import AnyConfig
from radhar_cli.dataset import layout, scene_fields
from radhar_cli.dataset.layout import SPLITS, Rows
from radhar_cli.dataset.shards import chunked_dataset
from radhar_cli.dataset.split import persons, split_rows
from radhar_cli.numerics.arrays import Float
from radhar_cli.readers.untrusted_hdf5 import NumberColumn, UntrustedFile
from radhar_cli.scene.checks.flags import FLAG_TYPE, Flags

RUN, RUN_BYTES = 128, 2**28
COLUMN_RUN, CHUNK_BYTES = 4096, 2**16


class ColumnWriter(Protocol):
    """Copies the columns of one kind from shards into a data set."""

    def append(self, part: UntrustedFile, rows: range) -> None:
        """Copy the columns of a shard, which holds these rows; shards come in row order.

        Raises:
            FolderError: a column is missing or damaged.
        """

    def close(self) -> dict[str, str]:
        """Write what is held back; return checksums {name in dataset.h5: SHA-256 in hex}."""


def column_writers(
    file: h5py.File, check: Callable[[], None], config: AnyConfig, table: io.TextIOBase
) -> tuple[list[ColumnWriter], "FlagCounter"]:
    """Create the datasets of a data set, and the writers that fill them.

    Args:
        file: the unfinished dataset.h5; the datasets of /scene are in it.
        check: raises errors of writing the file, of `new_hdf5`.
        config: config of the data set.
        table: the unfinished scenes.csv.

    Returns:
        The writers in the order in which they append, and that of the flags among them.
    """
    chunks = ChunkWriter(file, check, config)
    small = SmallColumnWriter(file, config)
    scenes = SceneWriter(file, config, table)
    flags = FlagCounter()
    return [ProductWriter(file, config), small, scenes, flags, chunks], flags


class ChunkWriter:
    """Copies maps, power and slow time, a compressed chunk a sample, as the bytes that they are.

    Chunks are stored in runs of RUN rows, or of RUN_BYTES, dataset after dataset: the file's layout
    does not depend on how shards cut the rows, and a reader of one map reads long stretches.
    """

    def __init__(self, file: h5py.File, check: Callable[[], None], config: AnyConfig) -> None:
        self._check, self._count = check, len(Rows.of(config))
        self._run = max(1, min(RUN, RUN_BYTES // layout.row_bytes(config)))
        self._parts = layout.large_datasets(config)
        self._targets = {
            name: chunked_dataset(file, name, self._count, config).id for name in self._parts
        }
        self._held: dict[str, list[tuple[int, bytes]]] = {name: [] for name in self._parts}
        self._written = 0  # rows

    def append(self, part: UntrustedFile, rows: range) -> None:
        """Hold the chunks of a shard; write whole runs, and the rest after the last shard."""
        for name, (dtype, shape) in self._parts.items():
            chunks = part.chunks(name, dtype, (len(rows), *shape))
            self._held[name] += [chunks.stored(row) for row in range(len(rows))]
        while rows.stop - self._written >= self._run or self._written < rows.stop == self._count:
            self._write_run()
            self._check()

    def _write_run(self) -> None:
        """Write the next run of every dataset."""
        for name, target in self._targets.items():
            corner = (0,) * len(self._parts[name][1])
            for row, (mask, chunk) in enumerate(self._held[name][: self._run], self._written):
                target.write_direct_chunk((row, *corner), chunk, mask)
            del self._held[name][: self._run]
        self._written += self._run

    def close(self) -> dict[str, str]:
        """Return nothing: the checksums of chunks are columns of their own."""
        return {}


class SmallColumnWriter:
    """Copies the small columns: checksums, counts, entropies, edges, labels."""

    def __init__(self, file: h5py.File, config: AnyConfig) -> None:
        count = len(Rows.of(config))
        self._parts = layout.small_datasets(config)
        self._targets = {
            name: _BufferedColumn(file.create_dataset(name, (count, *shape), dtype))
            for name, (dtype, shape) in self._parts.items()
        }

    def append(self, part: UntrustedFile, rows: range) -> None:
        """Copy the small columns of a shard."""
        for name, (dtype, shape) in self._parts.items():
            values = part.column(name, np.dtype(dtype), (len(rows), *shape))[:]
            self._targets[name].append(values)

    def close(self) -> dict[str, str]:
        """Write the last rows; return the checksum of each column."""
        return {name: target.finish() for name, target in self._targets.items()}


class SceneWriter:
    """Copies the numbers of scenes: in SI units into /scene, in units of the config into a table.

    Args:
        file: the unfinished dataset.h5; the datasets of /scene are in it.
        config: config of the data set.
        table: the unfinished scenes.csv.
    """

    def __init__(self, file: h5py.File, config: AnyConfig, table: io.TextIOBase) -> None:
        self._fields = scene_fields.fields(config)
        self._targets = {
            f"scene/{field.name}": _BufferedColumn(file[f"scene/{field.name}"])
            for field in self._fields
        }
        self._rows, self._split = Rows.of(config), split_rows(config)
        self._persons = persons(config)
        self._table = csv.writer(table, lineterminator="\n")
        keys = (field.key for field in self._fields)
        self._table.writerow(["label", "class", "slug", "index", "split", "subject", *keys])

    def append(self, part: UntrustedFile, rows: range) -> None:
        """Copy the numbers of the scenes of a shard."""
        values = part.column("scene", np.float64, (len(rows), len(self._fields)))[:]
        for number, (field, target) in enumerate(
            zip(self._fields, self._targets.values(), strict=True)
        ):
            target.append(values[:, number] * field.factor)
        self._write_table(values, rows)

    def _write_table(self, values: Float, rows: range) -> None:
        """Write rows of scenes.csv, of values [row, field]."""
        for row, numbers in zip(rows, values.tolist(), strict=True):
            activity, index = self._rows[row]
            label = self._rows.activities.index(activity)
            self._table.writerow(
                [label, activity.label, activity.slug, index, SPLITS[self._split[row]]]
                + ["" if self._persons is None else self._persons[row]]
                + ["" if value != value else repr(value) for value in numbers]
            )

    def close(self) -> dict[str, str]:
        """Write the last rows; return the checksum of each column of /scene."""
        return {name: target.finish() for name, target in self._targets.items()}


class FlagCounter:
    """Counts the rows that have each flag; dataset.h5 holds the warnings that follow from them.

    Attributes:
        counts: number of rows of each flag.
    """

    def __init__(self) -> None:
        self.counts = dict.fromkeys(Flags, 0)

    def append(self, part: UntrustedFile, rows: range) -> None:
        """Count the flags of a shard."""
        row_flags = part.column("flags", FLAG_TYPE, (len(rows),))[:]
        for flag in self.counts:
            self.counts[flag] += int(np.count_nonzero(row_flags & flag))

    def close(self) -> dict[str, str]:
        """Return nothing: flags are no column of dataset.h5."""
        return {}


class ProductWriter:
    """Copies products, whose arrays of all samples lie one after the other along axis 0."""

    def __init__(self, file: h5py.File, config: AnyConfig) -> None:
        self._file, self._names = file, config.stored
        self._level = config.output.hdf5_level

    def append(self, part: UntrustedFile, rows: range) -> None:
        """Copy the products of a shard."""
        for name in self._names:
            self._append_samples(part.samples(f"products/{name}", may_be_empty=True), name)

    def _append_samples(self, samples: NumberColumn, name: str) -> None:
        """Add the arrays of the next samples to the dataset of a product."""
        values = samples[:]
        if f"products/{name}" not in self._file:
            self._create_dataset(f"products/{name}", values)
        target = self._file[f"products/{name}"]
        start = len(target)
        target.resize(start + len(values), axis=0)
        target[start:] = values

    def _create_dataset(self, name: str, values: NDArray[Any]) -> None:
        """Create the empty dataset of a product, for rows like these values."""
        row_shape = values.shape[1:]
        row_bytes = max(1, values.dtype.itemsize * prod(row_shape))
        self._file.create_dataset(
            name,
            (0, *row_shape),
            values.dtype,
            maxshape=(None, *row_shape),
            chunks=(max(1, CHUNK_BYTES // row_bytes), *row_shape),
            compression="gzip" if self._level else None,
            compression_opts=self._level or None,
        )

    def close(self) -> dict[str, str]:
        """Return nothing: products have no checksums."""
        return {}


class _BufferedColumn:
    """Small dataset, written COLUMN_RUN rows at a time: a write takes h5py 0.1 ms."""

    def __init__(self, target: h5py.Dataset) -> None:
        self._target, self._start, self._stop, self._digest = target, 0, 0, hashlib.sha256()
        self._held: list[NDArray[Any]] = []

    def append(self, values: NDArray[Any]) -> None:
        """Add the next rows."""
        self._held.append(values)
        self._digest.update(values.astype(self._target.dtype).tobytes())
        self._stop += len(values)
        if self._stop - self._start >= COLUMN_RUN:
            self.finish()

    def finish(self) -> str:
        """Write the rows that are held; return the checksum of all rows."""
        if self._held:
            self._target[self._start : self._stop] = np.concatenate(self._held)
            self._start = self._stop
            self._held.clear()
        return self._digest.hexdigest()
