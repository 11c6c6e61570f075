"""Shards: the finished rows of one batch in a small HDF5 file, compressed as in dataset.h5."""

import io
import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import NamedTuple

import h5py
import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.config.schema import Config
from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.layout import WORK
from radhar_cli.processing.power_map import MapImage

_NAME = re.compile(r"^rows-(\d+)-(\d+)\.h5$")


class Shard(NamedTuple):
    """A finished shard: rows start .. stop - 1."""

    start: int
    stop: int
    path: Path


def shard_folder(folder: Path) -> Path:
    """Where the shards of an output folder lie."""
    return folder / WORK / "shards"


def image_dataset(group: h5py.Group, name: str, count: int, config: Config) -> h5py.Dataset:
    """Create an empty uint8 dataset [count, H, W], one sample a chunk, compressed."""
    size = config.image.size_px
    level = config.output.hdf5_level
    return group.create_dataset(
        name,
        shape=(count, *size),
        dtype=np.uint8,
        chunks=(1, *size),
        compression="gzip" if level else None,
        compression_opts=level or None,
    )


def encode_shard(
    config: Config, samples: Sequence[Mapping[str, MapImage]], scene_values: Float
) -> bytes:
    """The bytes of a shard; made in memory so that a full disk is one failed write."""
    buffer = io.BytesIO()
    with h5py.File(buffer, "w", libver="latest") as file:
        for name in config.maps:
            images = [sample[name] for sample in samples]
            levels = image_dataset(file.require_group("maps"), name, len(images), config)
            for row, image in enumerate(images):
                levels[row] = image.levels
            file[f"entropy/{name}"] = np.array([i.entropy for i in images], dtype=np.float32)
            file[f"sha256/{name}"] = np.array([i.sha256 for i in images], dtype="S64")
            file[f"extent/{name}"] = np.array([i.extent for i in images], dtype=float)
        file["scene"] = scene_values
    return buffer.getvalue()


def write_shard(folder: Path, start: int, stop: int, data: bytes) -> None:
    """Store the shard of rows start .. stop - 1."""
    write_whole(folder, shard_folder(folder) / f"rows-{start:09d}-{stop:09d}.h5", data)


def finished_shards(folder: Path) -> list[Shard]:
    """Shards that are there, in row order; of two that overlap, each row counts once."""
    found = []
    place = shard_folder(folder)
    for path in sorted(place.iterdir()) if place.is_dir() else ():
        match = _NAME.match(path.name)
        if match:
            found.append(Shard(int(match[1]), int(match[2]), path))
    return found


def pieces(shards: Sequence[Shard], count: int) -> Iterator[tuple[Shard, int, int]]:
    """Yield (shard, first row, past-last row) that tile as much of 0 .. count - 1 as there is."""
    row = 0
    for shard in sorted(shards):
        first = max(row, shard.start)
        stop = min(shard.stop, count)
        if first < stop:
            yield shard, first, stop
            row = stop


def missing_runs(shards: Sequence[Shard], count: int) -> list[tuple[int, int]]:
    """Runs of rows that no shard holds."""
    gaps, row = [], 0
    for _, first, stop in pieces(shards, count):
        if first > row:
            gaps.append((row, first))
        row = stop
    if row < count:
        gaps.append((row, count))
    return gaps
