"""Shards -> dataset.h5, scenes.csv and config.yaml.

The layout of dataset.h5 is a contract, described in docs/dataset.md.
"""

import csv
import io
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.config.identity import as_yaml, config_hash, resolved
from radhar_cli.config.schema import Config
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.files import unfinished_path, write_whole
from radhar_cli.dataset.identity import identity, versions
from radhar_cli.dataset.layout import CONFIG, DATASET, SCENES, SPLITS, Rows
from radhar_cli.dataset.shards import Shard, image_dataset, pieces
from radhar_cli.dataset.split import split_rows
from radhar_cli.scene import subject_of

SCHEMA_VERSION = 1
CONFIG_HEADING = "# The resolved config of this data set, every default filled in.\n"
LEVELS_TEXT = (
    "level = floor(255 (dB / dynamic_range_db + 1) + 1/2), dB = 10 log10(power / largest power), "
    "clipped to [-dynamic_range_db, 0]; level 0 everywhere for an all-zero map"
)


def assemble(
    config: Config, folder: Path, shards: Sequence[Shard], said: list[dict[str, Any]]
) -> None:
    """Write scenes.csv and config.yaml, then dataset.h5, and rename it into place last.

    Args:
        config: the data set's.
        folder: the output folder.
        shards: that hold every row.
        said: the physical warnings, stored with the data.
    """
    unfinished = unfinished_path(folder)
    unfinished.parent.mkdir(parents=True, exist_ok=True)
    try:
        with h5py.File(unfinished, "w") as file:
            scene_values = _copy_shards(file, config, shards)
            _describe_samples(file, config, scene_values)
            _describe_maps(file, config)
            _root_attributes(file, config, said)
        _write_csv(config, folder, scene_values)
        write_whole(folder, folder / CONFIG, (CONFIG_HEADING + as_yaml(config)).encode())
        unfinished.replace(folder / DATASET)
    finally:
        unfinished.unlink(missing_ok=True)


def _copy_shards(file: h5py.File, config: Config, shards: Sequence[Shard]) -> Float:
    count = len(Rows.of(config))
    width = len(scene_fields.fields(config))
    scene_values = np.empty((count, width))
    for name in config.maps:
        image_dataset(file.require_group("maps"), name, count, config)
    _copy(shards, count, "scene", scene_values)
    # Map by map, row by row: the file's layout does not depend on how shards cut the rows.
    for name in config.maps:
        for kind, shape, dtype in (
            ("entropy", (), "f4"),
            ("sha256", (), "S64"),
            ("extent", (4,), "f8"),
        ):
            column = np.empty((count, *shape), dtype)
            _copy(shards, count, f"{kind}/{name}", column)
            file[f"{kind}/{name}"] = column
        target = file[f"maps/{name}"].id
        for shard, first, stop in pieces(shards, count):
            with h5py.File(shard.path, "r") as part:
                source = part[f"maps/{name}"].id
                for row in range(first, stop):
                    mask, chunk = source.read_direct_chunk((row - shard.start, 0, 0))
                    target.write_direct_chunk((row, 0, 0), chunk, mask)
    return scene_values


def _copy(
    shards: Sequence[Shard], count: int, name: str, column: np.ndarray[Any, np.dtype[Any]]
) -> None:
    for shard, first, stop in pieces(shards, count):
        with h5py.File(shard.path, "r") as part:
            column[first:stop] = part[name][first - shard.start : stop - shard.start]


def _describe_samples(file: h5py.File, config: Config, scene_values: Float) -> None:
    rows = Rows.of(config)
    labels = np.repeat(np.array([a.index for a in rows.activities], np.uint8), rows.per_class)
    indices = np.tile(np.arange(rows.per_class), len(rows.activities))
    file["label"] = labels
    file["label"].attrs["meaning"] = "0..11 for S1..S12, whatever subset was built"
    file["split"] = split_rows(config)
    file["split"].attrs["meaning"] = ", ".join(f"{i} {name}" for i, name in enumerate(SPLITS))
    file["sample_key"] = np.stack([labels.astype(np.int64), indices], axis=1)
    file["sample_key"].attrs["columns"] = ["class", "index"]
    for column, field in enumerate(scene_fields.fields(config)):
        dataset = file.create_dataset(
            f"scene/{field.name}", data=scene_values[:, column] * field.factor
        )
        dataset.attrs["unit"] = field.unit
        dataset.attrs["config_key"] = field.key
    if config.split.subjects is not None:
        subjects = [subject_of(config, int(index)) for index in indices]
        file["scene/subject"] = np.array(subjects, dtype=np.int64)
        file["scene/subject"].attrs["unit"] = "1"


def _describe_maps(file: h5py.File, config: Config) -> None:
    for name in config.maps:
        extent = file[f"extent/{name}"][:]
        same = bool((extent == extent[0]).all())
        start, stop, low, high = extent[0] if same else [np.nan] * 4
        vertical = ("range", "m") if name == "rtm" else ("Doppler frequency", "Hz")
        attributes = file[f"maps/{name}"].attrs
        attributes["axes"] = ["sample", f"{vertical[0]} (row 0 is the highest)", "time"]
        attributes["row_quantity"], attributes["row_unit"] = vertical
        attributes["row_top"], attributes["row_bottom"] = high, low
        attributes["column_quantity"], attributes["column_unit"] = "slow time", "s"
        attributes["column_left"], attributes["column_right"] = start, stop
        attributes["dynamic_range_db"] = config.image.dynamic_range_db
        attributes["levels"] = LEVELS_TEXT
        if not same:
            attributes["edges"] = "differ from sample to sample: see /extent"
        file[f"extent/{name}"].attrs["columns"] = [
            "time left (s)",
            "time right (s)",
            f"{vertical[0]} bottom ({vertical[1]})",
            f"{vertical[0]} top ({vertical[1]})",
        ]
        file[f"entropy/{name}"].attrs["unit"] = "bit"


def _root_attributes(file: h5py.File, config: Config, said: list[dict[str, Any]]) -> None:
    file.attrs["schema_version"] = SCHEMA_VERSION
    file.attrs["config"] = json.dumps(resolved(config))
    file.attrs["config_hash"] = config_hash(config)
    named = identity(config)
    file.attrs["identity"] = json.dumps(
        {part: named[part] for part in ("keys", "versions", "hash")}, sort_keys=True
    )
    file.attrs["seed"] = config.seed
    file.attrs["class_names"] = [activity.label for activity in config.classes]
    file.attrs["class_slugs"] = [activity.slug for activity in config.classes]
    file.attrs["warnings"] = json.dumps(said)
    for library, version in versions().items():
        file.attrs[f"{library}_version"] = version


def _write_csv(config: Config, folder: Path, scene_values: Float) -> None:
    rows, split = Rows.of(config), split_rows(config)
    columns = scene_fields.fields(config)
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(
        ["label", "class", "slug", "index", "split", "subject", *(f.column for f in columns)]
    )
    for row in range(len(rows)):
        activity, index = rows[row]
        subject = subject_of(config, index)
        writer.writerow(
            [activity.index, activity.label, activity.slug, index, SPLITS[split[row]]]
            + ["" if subject is None else subject]
            + ["" if np.isnan(value) else repr(float(value)) for value in scene_values[row]]
        )
    write_whole(folder, folder / SCENES, text.getvalue().encode())
