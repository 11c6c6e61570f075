"""Shards -> dataset.h5, scenes.csv and config.yaml.

The layout of dataset.h5 is a contract, described in docs/reference/files.md. Nothing here grows
with the rows but the list of shards: columns go into the file as shards are read.
"""

import csv
import hashlib
import io
import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from math import prod
from pathlib import Path
from typing import Any

import h5py
import numpy as np
from numpy.typing import NDArray

from radhar_cli.assembly.physics import kinds_of
from radhar_cli.config.data_set import AnyConfig, Config
from radhar_cli.config.identity import as_yaml, config_hash, resolved
from radhar_cli.config.maps import FRAME_MAPS
from radhar_cli.dataset import layout, scene_fields
from radhar_cli.dataset.column_labels import label_names
from radhar_cli.dataset.files import digest_of, unfinished_path, write_whole
from radhar_cli.dataset.identity import identity, identity_hash, versions
from radhar_cli.dataset.layout import SPLITS, TIME, Rows
from radhar_cli.dataset.shards import (
    Runs,
    Shard,
    ShardError,
    check_shards,
    chunked_dataset,
    require_tiling,
)
from radhar_cli.dataset.split import persons, split_rows
from radhar_cli.dataset.untrusted_hdf5 import (
    DIGESTS,
    NumberColumn,
    UntrustedFile,
    attribute_digests,
    remember,
)
from radhar_cli.errors import UnfinishedError
from radhar_cli.files.new_hdf5 import new_hdf5
from radhar_cli.files.replacing import replacing
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Float
from radhar_cli.processes.progress import Progress
from radhar_cli.processing.points import COLUMNS
from radhar_cli.scene_checks.validity import FLAG_TYPE, Flags, flagged, warnings

RUN, RUN_BYTES = 128, 2**28
COLUMN_RUN, CHUNK_BYTES = 4096, 2**16
SCENES_DIGEST = "scenes_sha256"
CONFIG_HEADING = "# The resolved config of this data set, every default filled in.\n"
CFAR_TEXT = (
    "255 where a pixel exceeds its threshold over the mean of the training cells around it, else 0 "
    "(image.cfar in the config)"
)
LEVELS_TEXT = (
    "level = floor(255 (dB / dynamic_range_db + 1) + 1/2), dB = 10 log10(power / largest power), "
    "clipped to [-dynamic_range_db, 0]; level 0 everywhere for an all-zero map"
)
SHEET_TEXT = "frames side by side, row by row, evenly spread over the sample; edges are a frame's"
SLOW_TIME_TEXT = (
    "x[m] after receiver and canceller, for unit transmit power; NaN after the last pulse of "
    "a recording that is shorter than others"
)


@contextmanager
def assemble(
    config: AnyConfig,
    folder: Path,
    shards: Sequence[Shard],
    progress: Progress,
    remedy: Callable[[Runs], str] | None = None,
) -> Iterator[tuple[Path, list[dict[str, Any]]]]:
    """Assemble a data set; yield the path of the complete file and the warnings stored in it.

    On exit the file is renamed to dataset.h5.

    Args:
        config: that of the data set.
        folder: output folder.
        shards: shards that hold every row once.
        progress: is told of every row.
        remedy: advice on runs of missing rows, if not to run the same command again.

    Raises:
        UnfinishedError: rows are missing, or a shard is damaged.
    """
    count, own_hash, shards = len(Rows.of(config)), identity_hash(identity(config)), sorted(shards)
    require_tiling(folder, shards, count, remedy)
    unfinished_path(folder).parent.mkdir(parents=True, exist_ok=True)
    try:
        with (  # replaced from the last to the first: dataset.h5 comes when the others are there
            replacing(folder / layout.DATASET, unfinished_path(folder)) as unfinished,
            replacing(folder / layout.SCENES, unfinished_path(folder)) as table,
        ):
            with (
                new_hdf5(unfinished, folder / layout.DATASET) as (file, check),
                table.open("w", newline="", encoding="utf-8") as text,
            ):
                _describe_samples(file, config)
                flags = _copy_shards(file, check, config, shards, own_hash, progress, text)
                text.flush()
                file.attrs[SCENES_DIGEST] = digest_of(table)
                messages = flagged(flags, count)
                if isinstance(config, Config):
                    messages = warnings(config, flags, count)
                _root_attributes(file, config, messages)
                file.attrs[DIGESTS] = json.dumps(attribute_digests(file), sort_keys=True)
            remember(unfinished)
            yield unfinished, messages
            write_whole(folder, folder / layout.CONFIG, (CONFIG_HEADING + as_yaml(config)).encode())
    except ShardError as error:
        sound, unusable = check_shards(shards, own_hash)
        require_tiling(folder, sound, count, remedy, unusable)
        raise UnfinishedError(f"{folder}: {error}; the same command resumes") from None


def _copy_shards(
    file: h5py.File,
    check: Callable[[], None],
    config: AnyConfig,
    shards: Sequence[Shard],
    own_hash: str,
    progress: Progress,
    table: io.TextIOBase,
) -> dict[Flags, int]:
    """Copy maps and columns of shards into the file, each shard read and checked once.

    Chunks are stored in runs of RUN rows, or of RUN_BYTES, dataset after dataset: the file's layout
    does not depend on how shards cut the rows, and who reads one map reads long stretches.

    Returns:
        How many rows have each flag.
    """
    count, written_rows = shards[-1].stop, 0
    run, large = max(1, min(RUN, RUN_BYTES // layout.row_bytes(config))), layout.chunked(config)
    targets = {name: chunked_dataset(file, name, count, config).id for name in large}
    small = {
        name: (_Column(file.create_dataset(name, (count, *shape), dtype)), np.dtype(dtype), shape)
        for name, (dtype, shape) in layout.columns(config).items()
    }
    chunks: dict[str, list[tuple[int, bytes]]] = {name: [] for name in large}
    fields = scene_fields.fields(config)
    scene = [_Column(file[f"scene/{field.name}"]) for field in fields]
    products = {name: _Ragged(file, config, name) for name in config.stored}
    rows_csv = _SceneTable(config, table)
    flags = dict.fromkeys(Flags, 0)
    extents: dict[str, set[tuple[float, ...]]] = {f"extent/{name}": set() for name in config.maps}
    for shard in shards:
        start, stop, rows = shard.start, shard.stop, shard.stop - shard.start
        with UntrustedFile(shard.path, shard.read(own_hash)) as part:
            values = part.column("scene", np.float64, (rows, len(fields)))[:]
            row_flags = part.column("flags", FLAG_TYPE, (rows,))[:]
            for name, (dtype, shape) in large.items():
                chunk_column = part.chunks(name, dtype, (rows, *shape))
                chunks[name] += [chunk_column.stored(row) for row in range(rows)]
            for name in config.stored:
                products[name].append(part.samples(f"products/{name}", may_be_empty=True))
            for column, (target, kind, shape) in small.items():
                rows_of_column = part.column(column, kind, (rows, *shape))[:]
                target.append(rows_of_column)
                if column in extents and len(extents[column]) < 2:
                    extents[column].update(map(tuple, rows_of_column.tolist()))
        for number, (field, target) in enumerate(zip(fields, scene, strict=True)):
            target.append(values[:, number] * field.factor)
        rows_csv.write(start, values)
        progress.advance(rows)
        for flag in flags:
            flags[flag] += int(np.count_nonzero(row_flags & flag))
        while stop - written_rows >= run or written_rows < stop == count:
            for name, target in targets.items():
                corner = (0,) * len(large[name][1])
                for row, (mask, chunk) in enumerate(chunks[name][:run], written_rows):
                    target.write_direct_chunk((row, *corner), chunk, mask)
                del chunks[name][:run]
            written_rows += run
            check()
    scene_columns = zip((f"scene/{field.name}" for field in fields), scene, strict=True)
    small_columns = {
        **dict(scene_columns),
        **{name: target for name, (target, _, _) in small.items()},
    }
    digests = {name: target.finish() for name, target in small_columns.items()}
    file.attrs["columns_sha256"] = json.dumps(digests)
    for name in config.maps:
        _describe_map(file, config, name, extents[f"extent/{name}"])
    if isinstance(config, Config):
        _describe_products(file, config)
    return flags


def _describe_products(file: h5py.File, config: Config) -> None:
    """Write the attributes of products, labels of people and slow time."""
    if "products/points" in file:
        file["products/points"].attrs["columns"] = [*COLUMNS]
    recorded = any(config.files_of(activity) is not None for activity in config.chosen_activities)
    if "products/points_kind" in file:
        file["products/points_kind"].attrs["kinds"] = kinds_of(config)
    if "products/skeleton" in file and not recorded:
        file["products/skeleton"].attrs["joint_names"] = [*JOINTS]
    if config.people:
        file[layout.LABELS].attrs["class_slugs"] = [
            activity.slug for activity in config.every_class
        ]
        meaning = "place in class_slugs of /labels, the sample's main person first; -1 absent"
        file[layout.PERSON_LABEL].attrs["meaning"] = meaning
    if config.output.slow_time:
        file["slow_time"].attrs.update({"axes": ["sample", "pulse"], "meaning": SLOW_TIME_TEXT})


class _Ragged:
    """Product of the file that holds the arrays of all samples one after the other, axis 0."""

    def __init__(self, file: h5py.File, config: AnyConfig, name: str) -> None:
        self._file, self._name = file, f"products/{name}"
        self._level = config.output.hdf5_level

    def append(self, part: NumberColumn) -> None:
        """Add the rows of the next samples."""
        values = part[:]
        if self._name not in self._file:
            size = max(1, values.dtype.itemsize * prod(values.shape[1:]))
            self._file.create_dataset(
                self._name,
                (0, *values.shape[1:]),
                values.dtype,
                maxshape=(None, *values.shape[1:]),
                chunks=(max(1, CHUNK_BYTES // size), *values.shape[1:]),
                compression="gzip" if self._level else None,
                compression_opts=self._level or None,
            )
        target = self._file[self._name]
        start = len(target)
        target.resize(start + len(values), axis=0)
        target[start:] = values


class _Column:
    """Small dataset of the file, written COLUMN_RUN rows at a time: a write takes h5py 0.1 ms."""

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


def _describe_samples(file: h5py.File, config: AnyConfig) -> None:
    """Write the datasets of labels, splits and keys, and the empty ones of /scene."""
    rows = Rows.of(config)
    count = len(rows)
    file["label"] = rows.label.astype(np.uint8)
    file["label"].attrs["names"] = rows.names
    file["label"].attrs["meaning"] = "place in names: the order of `activities` in the config"
    file["split"] = split_rows(config)
    file["split"].attrs["meaning"] = ", ".join(f"{i} {name}" for i, name in enumerate(SPLITS))
    keys = file.create_dataset("sample_key", (count, 2), np.int64)
    keys.attrs["columns"] = ["label", "index"]
    if (person := persons(config)) is not None:
        subject = file.create_dataset("scene/subject", (count,), np.int64, data=person)
        subject.attrs["unit"] = "1"
    keys[:, 0] = rows.label
    keys[:, 1] = np.concatenate([np.arange(number) for number in rows.counts])
    for field in scene_fields.fields(config):
        dataset = file.create_dataset(f"scene/{field.name}", (count,), np.float64)
        dataset.attrs["unit"] = field.unit
        dataset.attrs["config_key"] = field.key


def _describe_map(
    file: h5py.File, config: AnyConfig, name: str, extents: set[tuple[float, ...]]
) -> None:
    """Write the attributes of a map; of its extents, where there are more, two are enough."""
    same = len(extents) == 1
    start, stop, low, high = next(iter(extents)) if same else [np.nan] * 4
    (rows, unit), (across, column_unit) = layout.row_axis(name), layout.column_axis(name)
    image, sheet = config.image, name in FRAME_MAPS
    decibel = image.kind == "decibel"
    sides = "time" if across == TIME[0] else across
    described = {
        "axes": ["sample", f"{rows} (row 0 is the highest)", sides],
        "row_quantity": rows,
        "row_unit": unit,
        "row_top": high,
        "row_bottom": low,
        "column_quantity": across,
        "column_unit": column_unit,
        "column_left": start,
        "column_right": stop,
        "kind": image.kind,
        **({"dynamic_range_db": image.dynamic_range_db} if decibel else {}),
        "levels": LEVELS_TEXT if decibel else CFAR_TEXT,
        **({"sheet": SHEET_TEXT} if sheet else {}),
        **({} if same else {"edges": "differ from sample to sample: see /extent"}),
    }
    file[f"maps/{name}"].attrs.update(described)
    edges = [f"{sides} left ({column_unit})", f"{sides} right ({column_unit})"]
    edges += [f"{rows} bottom ({unit})", f"{rows} top ({unit})"]
    file[f"extent/{name}"].attrs["columns"] = edges
    file[f"entropy/{name}"].attrs["unit"] = "bit"
    if config.output.power is not None:
        file[f"power/{name}"].attrs["unit"] = f"dB below /largest_db/{name}"
        file[f"power/{name}"].attrs["meaning"] = "resized power, not clipped; rows as in /maps"
        file[f"largest_db/{name}"].attrs["unit"] = "dB for unit transmit power"
    if config.output.column_labels:
        labels = file[f"{layout.COLUMN_LABEL}/{name}"].attrs
        labels["names"] = label_names(config)
        labels["meaning"] = "number in names of what is under way at the middle of each column"


def _root_attributes(file: h5py.File, config: AnyConfig, messages: list[dict[str, Any]]) -> None:
    """Write the attributes of the file itself; `messages` are its warnings."""
    named = identity(config)
    named = {part: named[part] for part in ("keys", "versions", "hash")}
    described = {
        "schema_version": layout.SCHEMA_VERSION,
        "config": json.dumps(resolved(config)),
        "config_hash": config_hash(config),
        "identity": json.dumps(named, sort_keys=True),
        "seed": config.seed,
        "class_names": [activity.label for activity in config.chosen_activities],
        "class_slugs": [activity.slug for activity in config.chosen_activities],
        "warnings": json.dumps(messages),
        **{f"{library}_version": version for library, version in versions().items()},
    }
    file.attrs.update(described)


class _SceneTable:
    """The table scenes.csv, written some rows at a time."""

    def __init__(self, config: AnyConfig, table: io.TextIOBase) -> None:
        self._config, self._rows, self._split = config, Rows.of(config), split_rows(config)
        self._persons = persons(config)
        self._writer = csv.writer(table, lineterminator="\n")
        columns = (field.key for field in scene_fields.fields(config))
        self._writer.writerow(["label", "class", "slug", "index", "split", "subject", *columns])

    def write(self, start: int, values: Float) -> None:
        """Write the rows from `start` on, of values [row, field]."""
        for row, numbers in enumerate(values.tolist(), start):
            activity, index = self._rows[row]
            label = self._rows.activities.index(activity)
            self._writer.writerow(
                [label, activity.label, activity.slug, index, SPLITS[self._split[row]]]
                + ["" if self._persons is None else self._persons[row]]
                + ["" if value != value else repr(value) for value in numbers]
            )
