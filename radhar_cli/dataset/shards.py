"""Shards: the finished rows of one batch in a small HDF5 file, compressed as in dataset.h5.

A shard says in its first 512 bytes (the user block of HDF5) which data set and rows it holds, with
a checksum of that and of all that follows. Nothing of a shard is used before these are compared.
"""

import hashlib
import io
import re
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import NamedTuple, TypeAlias

import h5py
import numpy as np

from radhar_cli.config.data_set import AnyConfig
from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.layout import WORK, checksum_of, count_of, large_datasets
from radhar_cli.dataset.png import deflate
from radhar_cli.dataset.sample import SampleRow
from radhar_cli.errors import SceneError, UnfinishedError
from radhar_cli.scene.checks.flags import FLAG_TYPE

USER_BLOCK = 512
RUNS_NAMED = 10
_NAME = re.compile(r"rows-(\d{9,})-(\d{9,})\.h5")
_HEADER = re.compile(rb"radhar shard of (\w{64})\nrows (\d+) (\d+)\nsha256 (\w{64})\n\0*")


class ShardError(Exception):
    """Reason for which a shard cannot be used."""


class ForeignShardError(ShardError):
    """The shard is sound, but belongs to another data set."""


class Shard(NamedTuple):
    """A shard: rows start .. stop - 1 of the data set that is built in a folder."""

    start: int
    stop: int
    folder: Path

    @property
    def rows(self) -> range:
        """Rows of the data set that the shard holds."""
        return range(self.start, self.stop)

    @property
    def path(self) -> Path:
        """Path of the shard's file."""
        return shard_folder(self.folder) / f"rows-{self.start:09d}-{self.stop:09d}.h5"

    def read(self, identity_hash: str) -> bytes:
        """Read the bytes of the shard, an HDF5 file, and check its header.

        Raises:
            ShardError: it is gone, damaged, of another data set, or holds other rows.
        """
        if not self.path.is_file():
            raise ShardError("is not there")
        data = self.path.read_bytes()
        header = _HEADER.fullmatch(data[:USER_BLOCK])
        if header is None:
            raise ShardError("is not a shard, or is damaged")
        owner, start, stop, checksum = (part.decode() for part in header.groups())
        if checksum != _checksum(owner, int(start), int(stop), memoryview(data)[USER_BLOCK:]):
            raise ShardError("does not match its checksum")
        if owner != identity_hash:
            raise ForeignShardError("belongs to another data set")
        if (int(start), int(stop)) != (self.start, self.stop):
            raise ShardError(f"holds rows {start} to {int(stop) - 1}")
        return data


def shard_folder(folder: Path) -> Path:
    """Folder in which the shards of an output folder lie."""
    return folder / WORK / "shards"


def chunked_dataset(file: h5py.File, name: str, count: int, config: AnyConfig) -> h5py.Dataset:
    """Create an empty large dataset [count, ...], one sample a chunk, compressed."""
    dtype, shape = large_datasets(config)[name]
    level = config.output.hdf5_level
    return file.create_dataset(
        name,
        shape=(count, *shape),
        dtype=dtype,
        chunks=(1, *shape),
        compression="gzip" if level else None,
        compression_opts=level or None,
    )


def encode_shard(
    config: AnyConfig,
    identity_hash: str,
    start: int,
    rows: Sequence[SampleRow],
) -> bytes:
    """Encode the rows from `start` on as a shard; a full disk is then one failed write.

    Args:
        config: that of the data set.
        identity_hash: hash of its identity.
        start: first row.
        rows: the rows, at least one.

    Raises:
        SceneError: arrays of a product differ in more than their first axis.
    """
    buffer, level = io.BytesIO(), config.output.hdf5_level
    samples = [row.sample for row in rows]
    # Not libver="latest", whose groups hold the time at which they were made.
    with h5py.File(buffer, "w", userblock_size=USER_BLOCK) as file:
        for name, (dtype, shape) in large_datasets(config).items():
            target, checksums = chunked_dataset(file, name, len(samples), config), []
            for row, sample in enumerate(samples):
                raw = np.asarray(sample.chunk(name, shape), dtype).tobytes()
                stored = deflate(raw, level) if level else raw
                target.id.write_direct_chunk((row, *[0] * len(shape)), stored)
                checksums.append(hashlib.sha256(raw).hexdigest())
            file[checksum_of(name)] = np.array(checksums, dtype="S64")
        columns = [sample.columns for sample in samples]
        for name in columns[0]:
            file[name] = np.stack([values[name] for values in columns])
        for name in config.stored:
            arrays = [sample.products[name] for sample in samples]
            if len({(array.dtype, array.shape[1:]) for array in arrays}) > 1:
                raise SceneError(f"output.products: {name}: should differ in its first axis alone")
            file[f"products/{name}"] = np.concatenate(arrays)
            file[count_of(name)] = np.array([len(array) for array in arrays])
        file["scene"] = np.stack([row.values for row in rows])
        file["flags"] = np.array([row.flags for row in rows], FLAG_TYPE)
    stop = start + len(samples)
    with buffer.getbuffer() as data:
        checksum = _checksum(identity_hash, start, stop, data[USER_BLOCK:])
        header = (
            f"radhar shard of {identity_hash}\nrows {start} {stop}\nsha256 {checksum}\n".encode()
        )
        data[: len(header)] = header
    return buffer.getvalue()


def _checksum(owner: str, start: int, stop: int, content: memoryview) -> str:
    """SHA-256 of a shard's owner, rows and content, in hex."""
    digest = hashlib.sha256(f"{owner} {start} {stop}\n".encode())
    digest.update(content)
    return digest.hexdigest()


def write_shard(folder: Path, start: int, stop: int, data: bytes) -> None:
    """Write the bytes of the shard of rows start .. stop - 1 into its file."""
    write_whole(folder, Shard(start, stop, folder).path, data)


def list_shards(folder: Path, rows: range | None = None) -> list[Shard]:
    """List files that have the name of a shard, in row order: all, or those within `rows`."""
    place = shard_folder(folder)
    names = (_NAME.fullmatch(path.name) for path in (place.iterdir() if place.is_dir() else ()))
    shards = sorted(Shard(int(name[1]), int(name[2]), folder) for name in names if name)
    if rows is None:
        return shards
    return [shard for shard in shards if rows.start <= shard.start < shard.stop <= rows.stop]


def check_shards(
    shards: Iterable[Shard], identity_hash: str
) -> tuple[list[Shard], list[tuple[Shard, ShardError]]]:
    """Read and check shards, which are in row order.

    Of two shards that share rows, from runs with other batch sizes, the first is used.

    Returns:
        The usable shards, and the unusable ones with the reason of each.
    """
    sound: list[Shard] = []
    unusable = []
    for shard in shards:
        try:
            shard.read(identity_hash)
        except ShardError as error:
            unusable.append((shard, error))
        else:
            if not sound or shard.start >= sound[-1].stop:
                sound.append(shard)
    return sound, unusable


Runs: TypeAlias = Sequence[tuple[int, int]]  # first row, past-last row


def missing_rows(shards: Sequence[Shard], count: int, first: int = 0) -> list[tuple[int, int]]:
    """List runs (first row, past-last row) of rows first .. count - 1 that no shard holds."""
    missing, row = [], first
    for shard in (*sorted(shards), Shard(count, count, Path())):
        if shard.start > row:
            missing.append((row, shard.start))
        row = shard.stop
    return missing


def require_tiling(
    folder: Path,
    shards: Sequence[Shard],
    count: int,
    remedy: Callable[[Runs], str] | None = None,
    unusable: Sequence[tuple[Shard, ShardError]] = (),
) -> None:
    """Refuse shards that do not hold each of `count` rows; no two of them share rows.

    Args:
        folder: output folder, for the message.
        count: number of rows of the data set.
        remedy: advice on runs of missing rows, if not to run the same command again.
        unusable: shards that were left out, and why.

    Raises:
        UnfinishedError: rows are missing.
    """
    why = "".join(f", {shard.path} {error}" for shard, error in unusable[:RUNS_NAMED])
    why += ", ..." if len(unusable) > RUNS_NAMED else ""
    if runs := missing_rows(shards, count):
        named = [f"{a}-{b - 1}" if b - a > 1 else f"{a}" for a, b in runs[:RUNS_NAMED]]
        rows = ", ".join(named) + (", ..." if len(runs) > RUNS_NAMED else "")
        raise UnfinishedError(
            f"{folder}: rows {rows} ({sum(b - a for a, b in runs)} of {count}) are missing from "
            f"the finished shards{why}; "
            + (remedy(runs) if remedy else "the rest is kept, and the same command resumes")
        )
