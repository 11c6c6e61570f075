"""A data set of many rows: every worker checks its own scenes, and the master holds little.

Every shard is a copy of one but for its rows, so that what is left is the master's work.
"""

import tracemalloc

import h5py
import pytest
from helpers.listener import Listener
from helpers.small import small_config
from helpers.stub_shards import stub_shard
from PIL import ImageFont

from radhar_cli.config import load_config
from radhar_cli.dataset import build as build_module
from radhar_cli.dataset.build import build
from radhar_cli.dataset.png import colour_table
from radhar_cli.errors import FolderError, UnfinishedError
from radhar_cli.readers import hdf5_check
from radhar_cli.readers.untrusted_hdf5 import try_files

ROWS, MANY, FEW, SIZE, BATCH = 150_000, 15_000, 9_000, 16, 32
BYTES_A_ROW = 16
SHARDS = 400


def built(rows, folder, monkeypatch):
    """Build that many rows of stubs; return the most memory that Python held, bytes."""
    folder.mkdir()
    changes = ["maps=[stft]", f"image.size_px={SIZE}", f"samples_per_class={rows // 3}"]
    by_person = "split={by: subject, subjects: 10, train: 0.8, validation: 0.2}"
    config = load_config(small_config(folder), [*changes, by_person, "output.png=false"])
    made: dict[int, bytes] = {}

    def stub(batch):
        return stub_shard(batch, SIZE, made)

    monkeypatch.setattr(build_module, "run_batch", stub)
    notes = Listener()
    for warm in (lambda: colour_table("viridis"), lambda: ImageFont.load_default(11)):
        warm()  # what they import is no row's memory
    tracemalloc.start()
    try:
        build(config, folder / "set", 1, notes, batch_size=BATCH)
        peak = tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()
    assert any(f"{rows} of {rows} recordings" in message for message in notes.messages)
    return peak


@pytest.mark.slow
def test_the_master_of_150_000_rows_holds_a_few_bytes_a_row(tmp_path, monkeypatch):
    large = built(ROWS, tmp_path / "large", monkeypatch)
    small = built(FEW, tmp_path / "small", monkeypatch)
    print(f"{(large - small) / (ROWS - FEW):.1f} bytes a row")
    assert large - small < BYTES_A_ROW * (ROWS - FEW)
    with h5py.File(tmp_path / "large/set/dataset.h5") as file:
        assert file["maps/stft"].id.get_num_chunks() == ROWS
    with (tmp_path / "large/set/scenes.csv").open() as table:
        assert sum(1 for _ in table) == ROWS + 1


# A quarter of a second on the way to each fortieth shard: more than a second in all.
SLOW_WALK = """
from itertools import count
from time import process_time
number, walk = count(), hdf5_check.walk
def slow_walk(file):
    end = process_time() + 0.25
    if next(number) % 40 == 0:
        while process_time() < end:
            pass
    walk(file)
hdf5_check.walk = slow_walk
"""
ENDLESS_WALK = """
def endless_walk(file):
    while file.filename.endswith("1.h5"):
        pass
hdf5_check.walk = endless_walk
"""


def allow_a_second(folder, monkeypatch, more=""):
    """Try HDF5 files within a second of CPU time."""
    program = "from radhar_cli.readers import hdf5_check\nhdf5_check.SECONDS = 1\n"
    (folder / "check.py").write_text(f"{program}{more}\nhdf5_check.main()\n")
    monkeypatch.setattr(hdf5_check, "__file__", str(folder / "check.py"))
    monkeypatch.setattr(hdf5_check, "SECONDS", 1)


def test_a_build_of_many_shards_resumes_near_its_end(tmp_path, monkeypatch):
    """The time that HDF5 may take is a shard's, not that of all shards together."""
    config = load_config(
        small_config(tmp_path),
        [
            *("maps=[stft]", f"image.size_px={SIZE}", f"samples_per_class={SHARDS}"),
            *("activities=[walking]", "output.png=false"),
        ],
    )
    made: dict[int, bytes] = {}

    def stop_at_the_last(batch):
        if batch.stop == SHARDS:
            raise UnfinishedError("killed")
        return stub_shard(batch, SIZE, made)

    monkeypatch.setattr(build_module, "run_batch", stop_at_the_last)
    with pytest.raises(UnfinishedError, match="killed"):
        build(config, tmp_path / "set", 1, Listener(), batch_size=1)
    monkeypatch.setattr(build_module, "run_batch", lambda batch: stub_shard(batch, SIZE, made))
    allow_a_second(tmp_path, monkeypatch, SLOW_WALK)
    outcome = build(config, tmp_path / "set", 1, Listener(), batch_size=1)
    assert (outcome.samples, outcome.new_samples) == (SHARDS, 1)


def test_a_file_that_takes_for_ever_is_refused_among_sound_ones(tmp_path, monkeypatch):
    files = [tmp_path / f"{number}.h5" for number in range(3)]
    for file in files:
        h5py.File(file, "w").close()
    allow_a_second(tmp_path, monkeypatch, ENDLESS_WALK)
    with pytest.raises(FolderError, match="takes HDF5 more than 1 s to open") as caught:
        try_files(files)
    assert str(caught.value).startswith(f"{files[1]}: cannot be read")
