"""A data set of many rows: every worker checks its own scenes, and the master holds little.

Every shard is a copy of one but for its rows, so that what is left is the master's work.
"""

import tracemalloc

import h5py
import pytest
from listener import Listener
from PIL import ImageFont
from small import small_config
from stub_shards import stub_shard

from radhar_cli.config import load_config
from radhar_cli.dataset import build as build_module
from radhar_cli.dataset.build import build
from radhar_cli.dataset.png import colour_table

ROWS, MANY, FEW, SIZE, BATCH = 150_000, 15_000, 9_000, 16, 32
BYTES_A_ROW = 16


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
