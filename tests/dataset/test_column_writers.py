"""Shards are merged by writers, each of which copies one kind of column."""

from pathlib import Path

import numpy as np
import pytest
from helpers.small import small_config

from radhar_cli.config import Config, load_config
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.assembly import merge_shards
from radhar_cli.dataset.column_writers import FlagCounter
from radhar_cli.dataset.sample import SampleRow, StoredSample
from radhar_cli.dataset.shards import Shard, ShardError, encode_shard, write_shard
from radhar_cli.processes.progress import NO_PROGRESS
from radhar_cli.processing.power_map import MapImage
from radhar_cli.readers.untrusted_hdf5 import UntrustedFile
from radhar_cli.scene.checks.flags import Flags

OWNER = "0" * 64


class EntropyWriter:
    """A kind of column of one's own: the entropies of a map, added up."""

    def __init__(self, calls: list[str], name: str) -> None:
        self.total, self._calls, self._name = 0.0, calls, name

    def append(self, part: UntrustedFile, rows: range) -> None:
        self._calls.append(f"{self._name} {rows.start}")
        self.total += float(part.column("entropy/stft", "f4", (len(rows),))[:].sum())

    def close(self) -> dict[str, str]:
        self._calls.append(f"{self._name} closes")
        return {self._name: "digest"}


@pytest.fixture(scope="module")
def config(tmp_path_factory: pytest.TempPathFactory) -> Config:
    path: Path = tmp_path_factory.mktemp("config")
    return load_config(small_config(path), ["maps=[stft]"])


def write_rows(config: Config, folder: Path, rows: range) -> Shard:
    """Write a shard whose entropies are the numbers of its rows; every row is aliased."""
    levels = np.zeros(config.image.size_px, np.uint8)
    values = np.zeros(len(scene_fields.fields(config)))
    content = [
        SampleRow(
            StoredSample({"stft": MapImage(levels, float(row), (0.0, 1.0, -1.0, 1.0))}),
            values,
            Flags.ALIASING,
        )
        for row in rows
    ]
    write_shard(folder, rows.start, rows.stop, encode_shard(config, OWNER, rows.start, content))
    return Shard(rows.start, rows.stop, folder)


def test_writers_append_in_their_order_and_close_in_reverse(config: Config, tmp_path: Path) -> None:
    shards = [write_rows(config, tmp_path, range(0, 2)), write_rows(config, tmp_path, range(2, 5))]
    calls: list[str] = []
    first, second = EntropyWriter(calls, "first"), EntropyWriter(calls, "second")
    digests = merge_shards(shards, OWNER, [first, second], NO_PROGRESS)
    assert calls == ["first 0", "second 0", "first 2", "second 2", "second closes", "first closes"]
    assert first.total == second.total == 0 + 1 + 2 + 3 + 4
    assert digests == {"first": "digest", "second": "digest"}


def test_flags_are_counted_over_all_shards(config: Config, tmp_path: Path) -> None:
    shards = [write_rows(config, tmp_path, range(0, 2)), write_rows(config, tmp_path, range(2, 5))]
    flags = FlagCounter()
    merge_shards(shards, OWNER, [flags], NO_PROGRESS)
    assert flags.counts[Flags.ALIASING] == 5
    assert flags.counts[Flags.BLACK] == 0


def test_a_shard_of_another_data_set_is_refused(config: Config, tmp_path: Path) -> None:
    shard = write_rows(config, tmp_path, range(0, 2))
    with pytest.raises(ShardError, match="belongs to another data set"):
        merge_shards([shard], "1" * 64, [FlagCounter()], NO_PROGRESS)
