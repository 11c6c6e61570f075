"""A map of a board's frames is added in one file, and one line of FRAME_MAP_KINDS."""

import json
import subprocess
import sys
from pathlib import Path

from helpers.boards import CFG

CONFIG = """
radar: {device: IWR1443BOOST, cfg: board.cfg, position_m: [0, 0, 1]}
activities: [punching]
motion: {range_m: 2.2}
duration_s: 0.5
samples_per_class: 2
split: {train: 0.5, validation: 0.5}
maps: [range_loop]
image: {size_px: 32}
"""
# The file that whoever adds a map writes, then the line, then all that has to know of it: config,
# products, data set, figures and pages. A process of its own, as the line stands before the config
# is imported.
PROGRAM = """
import json
import sys
from pathlib import Path

import h5py
import numpy as np

from radhar_cli.processing import frame_maps
from radhar_cli.processing.frame_maps import (
    RANGE, FrameAxis, FrameMapKind, FrameMaps, hann, range_spectrum, without_mean
)

LOOP = FrameAxis("loop", "1", lambda board: np.arange(float(board.loops)))


def range_loop(cube, board, remove_mean):
    samples = without_mean(cube) if remove_mean else cube
    x = range_spectrum(samples, board, hann(board.samples))
    power = (x.real**2 + x.imag**2).mean(axis=2).transpose(0, 2, 1)
    return FrameMaps(power, RANGE.of(board), LOOP.of(board), board.middles)


frame_maps.FRAME_MAP_KINDS["range_loop"] = FrameMapKind(
    "range_loop", "range over loops", range_loop, RANGE, LOOP
)

from radhar_cli.cli import main
from radhar_cli.config import load_config
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.dataset.sample_page import sample_entries
from radhar_cli.figures.frames_panel import draw_frames, of_simulation
from radhar_cli.scene.single.simulate import simulate

folder = Path(sys.argv[1])
config = load_config(folder / "config.yaml")
simulation = simulate(config, "punching")
draw_frames(of_simulation(simulation), folder / "frames.png")
sys.argv = ["radhar", "generate", str(folder / "config.yaml"), "-o", str(folder / "out"), "-q"]
try:
    main()
except SystemExit as end:
    assert not end.code, end.code
with h5py.File(folder / "out" / "dataset.h5") as file:
    columns = file["maps/range_loop"].attrs["column_quantity"]
with open_dataset(folder / "out") as data:
    stored = data.products["range_loop"][0]
    entry = json.dumps(sample_entries(data, [0]), default=str)
print(json.dumps({
    "made": list(simulation.frames["range_loop"].power.shape),
    "stored": list(stored.shape),
    "columns": columns,
    "title": "range over loops" in entry,
}))
"""


def test_a_map_of_frames_reaches_config_data_set_and_figures(tmp_path: Path) -> None:
    (tmp_path / "board.cfg").write_text(CFG)
    (tmp_path / "config.yaml").write_text(CONFIG)
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(tmp_path)], capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert json.loads(done.stdout.splitlines()[-1]) == {
        "made": [5, 128, 32],
        "stored": [5, 128, 32],
        "columns": "loop",
        "title": True,
    }
    assert (tmp_path / "frames.png").stat().st_size > 10_000
