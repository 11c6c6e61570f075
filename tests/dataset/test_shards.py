"""A shard names its content, and any other content is refused."""

import io
import time
from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers.small import small_config

from radhar_cli.config import load_config
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.identity import identity, identity_hash
from radhar_cli.dataset.sample import SampleRow, StoredSample
from radhar_cli.dataset.shards import (
    ForeignShardError,
    Shard,
    ShardError,
    check_shards,
    encode_shard,
    list_shards,
    missing_rows,
    require_tiling,
    write_shard,
)
from radhar_cli.errors import UnfinishedError
from radhar_cli.processing.power_map import MapImage


@pytest.fixture(scope="module")
def config(tmp_path_factory):
    return load_config(small_config(tmp_path_factory.mktemp("config")), ["maps=[stft]"])


def stub(config, start, stop):
    """A shard whose level is the row's number everywhere."""
    size = config.image.size_px
    levels = (np.full(size, row, np.uint8) for row in range(start, stop))
    images = (MapImage(each, float(each[0, 0]), (0.0, 1.0, 2.0, 3.0)) for each in levels)
    samples = (StoredSample({"stft": image}, -100.0) for image in images)
    values = np.full(len(scene_fields.fields(config)), float(start))
    rows = [SampleRow(sample, values, row) for row, sample in enumerate(samples, start)]
    return encode_shard(config, whose(config), start, rows)


def whose(config):
    return identity_hash(identity(config))


def test_what_was_stored_is_read_and_hdf5(config, tmp_path):
    write_shard(tmp_path, 4, 7, stub(config, 4, 7))
    shard = Shard(4, 7, tmp_path)
    data = shard.read(whose(config))
    for source in (shard.path, io.BytesIO(data)):
        with h5py.File(source) as file:
            assert file["maps/stft"][:, 0, 0].tolist() == [4, 5, 6]
            assert file["entropy/stft"][:].tolist() == [4, 5, 6]
            assert file["flags"][:].tolist() == [4, 5, 6]


def test_the_same_rows_give_the_same_bytes_at_another_time(config):
    """HDF5 counts in seconds."""
    before = stub(config, 0, 2)
    time.sleep(1.1)
    assert stub(config, 0, 2) == before


def test_every_changed_or_missing_byte_is_found(config, tmp_path):
    right = stub(config, 0, 2)
    shard = Shard(0, 2, tmp_path)
    places = {*range(0, 220, 7), *range(220, len(right), 499), len(right) - 1}
    for place in sorted(places):
        wrong = bytearray(right)
        wrong[place] ^= 1
        write_shard(tmp_path, 0, 2, bytes(wrong))
        with pytest.raises(ShardError):
            shard.read(whose(config))
        write_shard(tmp_path, 0, 2, right[:place])
        with pytest.raises(ShardError):
            shard.read(whose(config))


def test_why_a_shard_cannot_be_used(config, tmp_path):
    shard = Shard(0, 2, tmp_path)
    with pytest.raises(ShardError, match="is not there"):
        shard.read(whose(config))
    shard.path.mkdir(parents=True)
    with pytest.raises(ShardError, match="is not there"):
        shard.read(whose(config))
    shard.path.rmdir()
    write_shard(tmp_path, 0, 2, stub(config, 2, 4))
    with pytest.raises(ShardError, match="holds rows 2 to 3"):
        shard.read(whose(config))
    other = config.model_copy(update={"seed": 8})
    write_shard(tmp_path, 0, 2, stub(other, 0, 2))
    with pytest.raises(ForeignShardError, match="another data set"):
        shard.read(whose(config))
    assert shard.read(whose(other))


def test_of_two_shards_with_the_same_rows_one_is_used(config, tmp_path):
    for start, stop in ((0, 4), (2, 6), (4, 6), (8, 9)):
        write_shard(tmp_path, start, stop, stub(config, start, stop))
    Shard(6, 8, tmp_path).path.write_bytes(b"half")
    (Shard(0, 4, tmp_path).path.parent / "notes.txt").write_text("mine")
    sound, unusable = check_shards(list_shards(tmp_path), whose(config))
    assert [(s.start, s.stop) for s in sound] == [(0, 4), (4, 6), (8, 9)]
    assert [(s.start, s.stop) for s, _ in unusable] == [(6, 8)]


def shards(*runs):
    return [Shard(start, stop, Path("set")) for start, stop in runs]


def test_missing_rows():
    assert missing_rows(shards((4, 6), (0, 4)), 6) == []
    assert missing_rows(shards((2, 4), (6, 8)), 9) == [(0, 2), (4, 6), (8, 9)]
    assert missing_rows([], 3) == [(0, 3)]
    assert missing_rows(shards((5, 6)), 8, 4) == [(4, 5), (6, 8)]


def test_gaps_are_refused_and_their_rows_named(tmp_path):
    require_tiling(tmp_path, shards((0, 4), (4, 9)), 9)
    with pytest.raises(UnfinishedError, match=r"rows 2-3, 8 \(3 of 9\) are missing"):
        require_tiling(tmp_path, shards((0, 2), (4, 8)), 9)
    every_other = shards(*((row, row + 1) for row in range(1, 1000, 2)))
    with pytest.raises(UnfinishedError, match=r"rows 0, 2, .*18, \.\.\. \(500 of 1000\)") as caught:
        require_tiling(tmp_path, every_other, 1000)
    assert len(str(caught.value)) < 250 + len(str(tmp_path))
