"""Shards -> dataset.h5, scenes.csv, config.yaml and the manifest of what was put together.

The layout of dataset.h5 is a contract, described in docs/dataset.md.
"""

import csv
import io
import json
from collections import defaultdict
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import yaml

from radhar_cli.activity import ACTIVITIES
from radhar_cli.arrays import Float
from radhar_cli.config.experiment import Config
from radhar_cli.config.identity import config_hash, resolved
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.files import unfinished_path, write_whole
from radhar_cli.dataset.identity import identity, identity_hash, versions
from radhar_cli.dataset.layout import COLUMNS, CONFIG, DATASET, MANIFEST, SCENES, SPLITS, WORK, Rows
from radhar_cli.dataset.shards import Shard, ShardError, check_shards, image_dataset, require_tiling
from radhar_cli.dataset.split import split_rows
from radhar_cli.dataset.untrusted_hdf5 import UntrustedFile
from radhar_cli.errors import UnfinishedError
from radhar_cli.pipeline.survey import fallback_warnings
from radhar_cli.scenario import subject_of

SCHEMA_VERSION = 1
RUN = 128
LEVELS_TEXT = (
    "level = floor(255 (dB / dynamic_range_db + 1) + 1/2), dB = 10 log10(power / largest power), "
    "clipped to [-dynamic_range_db, 0]; level 0 everywhere for an all-zero map"
)


@contextmanager
def assembled(
    config: Config, folder: Path, shards: Sequence[Shard], said: list[dict[str, Any]]
) -> Iterator[tuple[Path, list[dict[str, Any]]]]:
    """Put a data set together; yield the path of its whole file, which becomes dataset.h5 after.

    With the path come all warnings stored in it: those given, and of what fell back to the cube.

    Args:
        config: the data set's.
        folder: the output folder.
        shards: that hold every row once.
        said: the physical warnings, stored with the data.

    Raises:
        UnfinishedError: rows are missing, held twice, or in a shard that cannot be used.
    """
    count, whose, shards = len(Rows.of(config)), identity_hash(identity(config)), sorted(shards)
    require_tiling(folder, shards, count)
    unfinished = unfinished_path(folder)
    unfinished.parent.mkdir(parents=True, exist_ok=True)
    try:
        with h5py.File(unfinished, "w") as file:
            scene_values, fell_back, held = _copy_shards(file, config, shards, whose)
            _describe_samples(file, config, scene_values)
            _describe_maps(file, config)
            said = said + fallback_warnings(fell_back, count)
            _root_attributes(file, config, said)
        yield unfinished, said
        _write_csv(config, folder, scene_values)
        write_whole(folder, folder / CONFIG, _config_text(config).encode())
        manifest = {"identity": whose, "rows": count, "shards": held}
        write_whole(folder, folder / WORK / MANIFEST, json.dumps(manifest).encode())
        unfinished.replace(folder / DATASET)
    except ShardError as error:
        require_tiling(folder, check_shards(shards, whose)[0], count)
        raise UnfinishedError(f"{folder}: {error}; the same command goes on") from None
    finally:
        unfinished.unlink(missing_ok=True)


def _copy_shards(
    file: h5py.File, config: Config, shards: Sequence[Shard], whose: str
) -> tuple[Float, int, list[dict[str, Any]]]:
    """Copy maps and columns, each shard read and checked once.

    Chunks are stored in runs of RUN rows, map after map: the file's layout does not depend on how
    shards cut the rows, and who reads one map reads long stretches.

    Returns:
        The scene values [N, fields], how many samples fell back to the cube, what each shard held.
    """
    count, stored = shards[-1].stop, 0
    maps = file.create_group("maps")
    targets = {name: image_dataset(maps, name, count, config).id for name in config.maps}
    chunks: dict[str, list[tuple[int, bytes]]] = {name: [] for name in config.maps}
    columns: dict[str, list[Any]] = defaultdict(list)
    held: list[dict[str, Any]] = []
    width = len(scene_fields.fields(config))
    for shard in shards:
        start, stop, rows = shard.start, shard.stop, shard.stop - shard.start
        data, checksum = shard.read(whose)
        held.append({"start": start, "stop": stop, "bytes": len(data), "sha256": checksum})
        with UntrustedFile(shard.path, data) as part:
            columns["scene"].append(part.column("scene", np.float64, (rows, width))[:])
            columns["fell_back"].append(part.column("fell_back", np.uint8, (rows,))[:])
            for name in config.maps:
                source = part.images(f"maps/{name}", (rows, *config.image.size_px))
                chunks[name] += [source.stored(row) for row in range(rows)]
                for kind, (dtype, shape) in COLUMNS.items():
                    column = f"{kind}/{name}"
                    columns[column].append(part.column(column, dtype, (rows, *shape))[:])
        while stop - stored >= RUN or stored < stop == count:
            for name, target in targets.items():
                for row, (mask, chunk) in enumerate(chunks[name][:RUN], stored):
                    target.write_direct_chunk((row, 0, 0), chunk, mask)
                del chunks[name][:RUN]
            stored += RUN
    scene_values = np.concatenate(columns.pop("scene"))
    fell_back = sum(int(part.sum()) for part in columns.pop("fell_back"))
    for column, values in columns.items():
        file[column] = np.concatenate(values)
    return scene_values, fell_back, held


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
    file.attrs["class_names"] = [activity.label for activity in ACTIVITIES]
    file.attrs["class_slugs"] = [activity.slug for activity in ACTIVITIES]
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


def _config_text(config: Config) -> str:
    return "# The resolved config of this data set, every default filled in.\n" + yaml.safe_dump(
        resolved(config), sort_keys=False, default_flow_style=None, width=100
    )
