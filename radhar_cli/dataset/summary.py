"""What `radhar inspect` tells, as plain values: of a data set, a half-built folder, a scene."""

import json
from collections import Counter
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from radhar_cli.config.reading import config_from_json
from radhar_cli.dataset.folder import stored_identity
from radhar_cli.dataset.identity import identity_hash
from radhar_cli.dataset.layout import DATASET, SPLITS, Rows
from radhar_cli.dataset.reading import Dataset, open_dataset
from radhar_cli.dataset.shards import check_shards, listed_shards
from radhar_cli.errors import FolderError

HISTOGRAM_BINS = 12


def summarise(path: Path) -> dict[str, Any]:
    """Summarise whatever of ours lies at `path`.

    Raises:
        FolderError: nothing of ours, or damaged.
    """
    if path.is_dir() and not (path / DATASET).exists():
        if (path / "scene.h5").exists():
            return _scene(path / "scene.h5")
        return _half_built(path)
    if path.is_file() and h5py.is_hdf5(path):
        try:
            with h5py.File(path, "r") as file:
                if "truth" in file and "scene" in file.attrs:
                    return _scene(path)
        except OSError:
            pass
    with open_dataset(path) as data:
        return _data_set(data)


def _data_set(data: Dataset) -> dict[str, Any]:
    labels, splits = data.label[:], data.split[:]
    slugs = [data.class_slugs[label] for label in labels]
    return {
        "kind": "data set",
        "path": str(data.path),
        "samples": len(data),
        "bytes": data.path.stat().st_size,
        "seed": int(data.file.attrs["seed"]),
        "config_hash": str(data.file.attrs["config_hash"]),
        "versions": {
            key.removesuffix("_version"): str(value)
            for key, value in data.file.attrs.items()
            if key.endswith("_version") and key != "schema_version"
        },
        "maps": {name: list(array.shape[1:]) for name, array in data.maps.items()},
        "classes": {
            slug: {
                part: int(np.count_nonzero((labels == label) & (splits == number)))
                for number, part in enumerate(SPLITS)
            }
            for label, slug in Counter(zip(labels.tolist(), slugs, strict=True))
        },
        "entropy_bits": {
            name: {
                data.class_slugs[label]: _spread(values[:][labels == label])
                for label in sorted(set(labels.tolist()))
            }
            for name, values in data.entropy.items()
        },
        "drawn": {
            name: _histogram(values) for name, values in data.scene.items() if _varies(values)
        },
        "warnings": data.warnings,
    }


def _spread(values: np.ndarray[Any, Any]) -> dict[str, float]:
    return {"mean": float(values.mean()), "min": float(values.min()), "max": float(values.max())}


def _varies(values: h5py.Dataset) -> bool:
    finite = values[:][np.isfinite(values[:])]
    return bool(finite.size and finite.min() < finite.max())


def _histogram(values: h5py.Dataset) -> dict[str, Any]:
    finite = values[:][np.isfinite(values[:])]
    counts, edges = np.histogram(finite, HISTOGRAM_BINS)
    return {
        "unit": str(values.attrs["unit"]),
        **_spread(finite),
        "samples": int(finite.size),
        "counts": counts.tolist(),
        "edges": edges.tolist(),
    }


def _half_built(path: Path) -> dict[str, Any]:
    identity = stored_identity(path)
    if identity is None:
        raise FolderError(f"{path}: holds nothing that radhar wrote")
    rows = Rows.of(config_from_json(json.dumps(identity["config"]), str(path)))
    shards, _ = check_shards(listed_shards(path), identity_hash(identity))
    return {
        "kind": "unfinished data set",
        "path": str(path),
        "samples": len(rows),
        "finished": sum(shard.stop - shard.start for shard in shards),
        "config_hash": identity["hash"],
        "seed": identity["keys"]["seed"],
    }


def _scene(path: Path) -> dict[str, Any]:
    try:
        with h5py.File(path, "r") as file:
            described: dict[str, Any] = json.loads(file.attrs["scene"])
            maps = {name: list(array.shape) for name, array in file["maps"].items()}
    except (OSError, KeyError, ValueError) as error:
        raise FolderError(f"{path}: is no whole scene of radhar's ({error})") from None
    return {"kind": "scene", "path": str(path), "maps": maps, **described}
