"""Summaries for `radhar inspect`: a data set, an unfinished one or a scene, as plain values."""

from pathlib import Path
from typing import Any

import numpy as np

from radhar_cli.config.identity import config_hash
from radhar_cli.config.maps import ANGLE_TIME_MAPS, CADENCE_MAPS, MAP_NAMES
from radhar_cli.dataset.folder import stored_identity
from radhar_cli.dataset.identity import identity_hash
from radhar_cli.dataset.layout import DATASET, SPLITS, Rows
from radhar_cli.dataset.reading import Dataset, open_dataset, stored_config
from radhar_cli.dataset.shards import check_shards, list_shards
from radhar_cli.errors import FolderError
from radhar_cli.readers.untrusted_hdf5 import Column, UntrustedFile

MAX_VALUE = 1e30
SCENE_FILE = "scene.h5"


def summarise(path: Path) -> dict[str, Any]:
    """Summarise a data set, finished or not, or a scene, for `radhar inspect`.

    Raises:
        FolderError: the path holds nothing that radhar wrote, or it is damaged.
    """
    if path.is_dir() and not (path / DATASET).exists():
        if (path / SCENE_FILE).exists():
            return _summarise_scene(path / SCENE_FILE)
        return _summarise_unfinished(path)
    if path.is_file():
        with UntrustedFile(path) as file:
            if file.has_attribute("scene"):
                return _summarise_scene(path)
    with open_dataset(path) as data:
        return _summarise_dataset(data)


def _summarise_dataset(data: Dataset) -> dict[str, Any]:
    """Summarise a finished data set."""
    labels, splits = data.label, data.split
    return {
        "kind": "data set",
        "path": str(data.path),
        "samples": len(data),
        "bytes": data.path.stat().st_size,
        "seed": data.config.seed,
        "config_hash": config_hash(data.config),
        "versions": data.versions,
        "maps": {name: list(array.shape[1:]) for name, array in data.maps.items()},
        "classes": {
            data.class_slugs[label]: {
                part: int(np.count_nonzero((labels == label) & (splits == number)))
                for number, part in enumerate(SPLITS)
            }
            for label in np.unique(labels)
        },
        "labels": None
        if data.labels is None
        else {
            slug: int(count)
            for slug, count in zip(data.class_slugs, data.labels.sum(axis=0), strict=True)
            if count
        },
        "entropy_bits": {
            name: {
                data.class_slugs[label]: _mean_and_range(bits[labels == label])
                for label in sorted(set(labels.tolist()))
            }
            for name, bits in ((name, data.entropy(name)) for name in data.maps)
        },
        "drawn": _summarise_drawn_numbers(data),
        "warnings": data.warnings,
    }


def _mean_and_range(values: np.ndarray[Any, Any]) -> dict[str, float]:
    """Mean, smallest and largest of values."""
    return {"mean": float(values.mean()), "min": float(values.min()), "max": float(values.max())}


def _summarise_drawn_numbers(data: Dataset) -> dict[str, Any]:
    """Summarise the numbers of /scene that differ from sample to sample."""
    units = {field.name: field.unit for field in data.fields}
    drawn = {}
    for name, column in data.scene.items():
        values = _finite_numbers(column)
        if values.size and values.min() < values.max():
            drawn[name] = {
                "unit": units.get(name, "1"),
                **_mean_and_range(values),
                "samples": int(values.size),
            }
    return drawn


def _finite_numbers(column: Column) -> np.ndarray[Any, Any]:
    """The numbers of a scene field, without the NaN of samples that it does not apply to."""
    values: np.ndarray[Any, Any] = column[:]
    values = values[~np.isnan(values)]
    if (np.abs(values) > MAX_VALUE).any():
        raise FolderError(f"{column.where}: should be at most {MAX_VALUE:g}")
    return values


def _summarise_unfinished(path: Path) -> dict[str, Any]:
    """Summarise the folder of an unfinished build."""
    identity = stored_identity(path)
    if identity is None:
        raise FolderError(f"{path}: holds nothing that radhar wrote")
    config = stored_config(identity.get("config"), str(path))
    rows = Rows.of(config)
    shards, _ = check_shards(list_shards(path), identity_hash(identity))
    return {
        "kind": "unfinished data set",
        "path": str(path),
        "samples": len(rows),
        "finished": sum(shard.stop - shard.start for shard in shards),
        "config_hash": config_hash(config),
        "seed": config.seed,
    }


def _summarise_scene(path: Path) -> dict[str, Any]:
    """Summarise a scene.h5."""
    with UntrustedFile(path) as file:
        described = file.json("scene")
        if not isinstance(described, dict) or not isinstance(described.get("entropy_bits"), dict):
            raise FolderError(f"{path}: is not a complete scene file: entropy_bits is missing")
        maps = {name: file.shape(f"maps/{name}") for name in described["entropy_bits"]}
    for name, shape in maps.items():
        if name not in (*MAP_NAMES, *CADENCE_MAPS, *ANGLE_TIME_MAPS) or len(shape) != 2:
            raise FolderError(f"{path}: /maps/{name}: should be a map over time or cadence")
    return {**described, "kind": "scene", "path": str(path), "maps": maps}
