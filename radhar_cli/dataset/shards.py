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
from numpy.typing import NDArray

from radhar_cli.arrays import Float
from radhar_cli.config.schema import AnyConfig
from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.layout import WORK, checksum_of, chunked, count_of
from radhar_cli.dataset.png import deflated
from radhar_cli.dataset.sample import Synthesised
from radhar_cli.errors import SceneError, UnfinishedError

USER_BLOCK = 512
RUNS_NAMED = 10
_NAME = re.compile(r"rows-(\d{9,})-(\d{9,})\.h5")
_HEADER = re.compile(rb"radhar shard of (\w{64})\nrows (\d+) (\d+)\nsha256 (\w{64})\n\0*")


class ShardError(Exception):
    """A shard that cannot be used; says why."""


class ForeignShardError(ShardError):
    """A sound shard of another data set."""


class Shard(NamedTuple):
    """The shard of rows start .. stop - 1."""

    start: int
    stop: int
    folder: Path

    @property
    def path(self) -> Path:
        """Of its file."""
        return shard_folder(self.folder) / f"rows-{self.start:09d}-{self.stop:09d}.h5"

    def read(self, identity_hash: str) -> bytes:
        """The bytes of the shard, an HDF5 file.

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
    """Where the shards of an output folder lie."""
    return folder / WORK / "shards"


def chunked_dataset(file: h5py.File, name: str, count: int, config: AnyConfig) -> h5py.Dataset:
    """Create an empty large dataset [count, ...], one sample a chunk, compressed."""
    dtype, shape = chunked(config)[name]
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
    samples: Sequence[Synthesised],
    scene_values: Float,
    flags: NDArray[np.uint16],
) -> bytes:
    """The bytes of the shard of the rows from `start` on; a full disk is then one failed write.

    Args:
        scene_values: [rows, fields].
        flags: what there is to warn of in each row (`Flags`).
    """
    buffer, level = io.BytesIO(), config.output.hdf5_level
    # Not libver="latest", whose groups hold the time at which they were made.
    with h5py.File(buffer, "w", userblock_size=USER_BLOCK) as file:
        for name, (dtype, shape) in chunked(config).items():
            target, checksums = chunked_dataset(file, name, len(samples), config), []
            for row, sample in enumerate(samples):
                raw = np.asarray(sample.chunk(name, shape), dtype).tobytes()
                stored = deflated(raw, level) if level else raw
                target.id.write_direct_chunk((row, *[0] * len(shape)), stored)
                checksums.append(hashlib.sha256(raw).hexdigest())
            file[checksum_of(name)] = np.array(checksums, dtype="S64")
        every = [sample.columns for sample in samples]
        for name in every[0]:
            file[name] = np.stack([one[name] for one in every])
        for name in config.stored:
            arrays = [sample.products[name] for sample in samples]
            if len({(array.dtype, array.shape[1:]) for array in arrays}) > 1:
                raise SceneError(f"output.products: {name}: should differ in its first axis alone")
            file[f"products/{name}"] = np.concatenate(arrays)
            file[count_of(name)] = np.array([len(array) for array in arrays])
        file["scene"] = scene_values
        file["flags"] = flags
    stop = start + len(samples)
    with buffer.getbuffer() as data:
        checksum = _checksum(identity_hash, start, stop, data[USER_BLOCK:])
        header = (
            f"radhar shard of {identity_hash}\nrows {start} {stop}\nsha256 {checksum}\n".encode()
        )
        data[: len(header)] = header
    return buffer.getvalue()


def _checksum(owner: str, start: int, stop: int, content: memoryview) -> str:
    digest = hashlib.sha256(f"{owner} {start} {stop}\n".encode())
    digest.update(content)
    return digest.hexdigest()


def write_shard(folder: Path, start: int, stop: int, data: bytes) -> None:
    """Store the shard of rows start .. stop - 1."""
    write_whole(folder, Shard(start, stop, folder).path, data)


def listed_shards(folder: Path, rows: range | None = None) -> list[Shard]:
    """Files that have the name of a shard, of these rows if they are given, in row order."""
    place = shard_folder(folder)
    names = (_NAME.fullmatch(path.name) for path in (place.iterdir() if place.is_dir() else ()))
    shards = sorted(Shard(int(name[1]), int(name[2]), folder) for name in names if name)
    if rows is None:
        return shards
    return [one for one in shards if rows.start <= one.start < one.stop <= rows.stop]


def check_shards(
    shards: Iterable[Shard], identity_hash: str
) -> tuple[list[Shard], list[tuple[Shard, ShardError]]]:
    """Read shards, in row order: (usable ones, unusable ones with the reason).

    Of two shards that share rows, from runs with other batch sizes, the first is used.
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
    """Runs (first row, past-last row) of first .. count - 1 that none of the shards holds."""
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
    """Refuse shards, none of which share rows, that do not hold each of `count` rows.

    Args:
        remedy: what to do about rows, if not to run the same command again.
        unusable: shards that were left out, and why.
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
