"""Draw pictures of the guide that are figures of the program.

    python scripts/draw_guide.py [--bvh test_freebvh.bvh] [NAME ...]

board.png, streams.png, impulse_iq.png; with --bvh, a file of bvhtoolbox 0.1.3, motion_files.png.
Two figures of the program stand below each other in the last two.
"""

import argparse
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from draw_pictures import PICTURES, save_as_rgb, save_picture
from PIL import Image

from radhar_cli.commands.terminal import BarProgress
from radhar_cli.config import Config, load_config
from radhar_cli.dataset.build import build
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.dataset.stream_files import draw_streams
from radhar_cli.figures import frames_panel, maps_panel
from radhar_cli.figures.page import DPI
from radhar_cli.scene.single.simulate import Simulation, simulate

ROOT = Path(__file__).resolve().parents[1]
BY = "python scripts/draw_guide.py"
STREAMS = 3
RADAR_24: dict[str, Any] = {
    "radar": {"carrier_hz": 24e9, "bandwidth_hz": 1e9, "prf_hz": 3000},
    "body": {"scatterers": "segments"},
    "processing": {"window_s": 0.1},
    "maps": ["stft"],
    "snr_db": 30,
    "seed": 1,
}
FACING = {"angle_deg": 180, "range_m": 5}


def draw_board(path: Path, _: Path | None) -> None:
    """Frames of a board: walking."""
    config = load_config(ROOT / "configs/boards/iwr1443.yaml", ["duration_s=2"])
    simulation = simulate(config, "walking")
    frames_panel.draw_frames(frames_panel.of_simulation(simulation), path)
    save_as_rgb(path, BY)


def draw_some_streams(path: Path, _: Path | None) -> None:
    """Streams with their labels."""
    few = [f"stream.count={2 * STREAMS}", f"split.subjects={2 * STREAMS}"]
    config = load_config(ROOT / "configs/human/streams.yaml", few)
    with tempfile.TemporaryDirectory() as folder:
        build(config, Path(folder) / "streams", 1, BarProgress())
        with open_dataset(Path(folder) / "streams") as data:
            save_picture(draw_streams(data, "stft", STREAMS), path, DPI, BY)


def draw_impulses(path: Path, _: Path | None) -> None:
    """Maps of a walker by an X4 and an A121."""
    configs = (ROOT / f"configs/human/impulse_{name}.yaml" for name in ("x4", "a121"))
    _draw_below_each_other([simulate(load_config(one), "walking") for one in configs], path)


def draw_motion_files(path: Path, bvh: Path | None) -> None:
    """A recorded walk with a half turn, and walking of the human model."""
    if bvh is None:
        print(f"{path}: needs --bvh")
        return
    recorded_walk = {"files": [bvh.name], "start": 0, "playback_speed": 1, "mirror": 0}
    classes = {"from_file": recorded_walk}
    chosen = {
        "classes": classes,
        "activities": ["from_file"],
        "motion": {"folder": str(bvh.parent)},
    }
    recorded = Config.model_validate({**RADAR_24, **chosen, "duration_s": 2.2})
    walking = {"activities": ["walking"], "motion": FACING, "duration_s": 2.2}
    model = Config.model_validate({**RADAR_24, **walking})
    _draw_below_each_other([simulate(recorded), simulate(model)], path)


DRAW: dict[str, Callable[[Path, Path | None], None]] = {
    "board.png": draw_board,
    "streams.png": draw_some_streams,
    "impulse_iq.png": draw_impulses,
    "motion_files.png": draw_motion_files,
}


def _draw_below_each_other(simulations: list[Simulation], path: Path) -> None:
    """Draw the pages of maps of several simulations, one below the other."""
    pages = []
    with tempfile.TemporaryDirectory() as folder:
        for simulation in simulations:
            maps_panel.draw_maps(
                maps_panel.of_simulation(simulation, False), Path(folder) / "a.png"
            )
            with Image.open(Path(folder) / "a.png") as page:
                pages.append(np.asarray(page.convert("RGB")))
    Image.fromarray(np.concatenate(pages)).save(path)
    save_as_rgb(path, BY)


def main() -> None:
    """Draw the pictures."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("names", nargs="*", metavar="NAME", help="pictures; the default is all")
    parser.add_argument("--bvh", type=Path, help="motion file of motion_files.png")
    options = parser.parse_args()
    for name in options.names or DRAW:
        DRAW[name](PICTURES / name, options.bvh)


if __name__ == "__main__":
    main()
