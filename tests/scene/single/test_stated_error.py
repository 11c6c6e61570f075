"""The error that scene.json and data sets state is that of the numbers as they are stored."""

from pathlib import Path

import h5py
import numpy as np
import pytest

from radhar_cli.config import Config, load_config
from radhar_cli.dataset.sample import store
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import draw_scene
from radhar_cli.scene.single.scene_file import describe, write_scene
from radhar_cli.scene.single.simulate import simulate

ROOT = Path(__file__).resolve().parents[3]
# Tight enough for sums in double precision, far below what single precision holds.
PRECISE = ["engine.tolerance_db=-170", "duration_s=0.3", "body.scatterers=points", "snr_db=null"]


def _config(path: str, *more: str) -> Config:
    return load_config(ROOT / path, [*PRECISE, *more])


def test_of_a_cube(tmp_path: Path) -> None:
    config = _config("configs/boards/iwr1443.yaml", "receiver.noise_figure_db=null")
    simulation = simulate(config, "walking", raw=True)
    write_scene(simulation, tmp_path / "scene.h5")
    with h5py.File(tmp_path / "scene.h5") as file:
        stored = file["cube"][:]
    exact_config = _config(
        "configs/boards/iwr1443.yaml", "receiver.noise_figure_db=null", "engine.kind=cube"
    )
    exact = record(draw_scene(exact_config, simulation.scene.activity, 0), ["cube"])["cube"]
    true_db = 20 * np.log10(np.linalg.norm(stored - exact) / np.linalg.norm(exact))
    assert stored.dtype == np.complex64
    assert true_db <= describe(simulation)["accuracy"]["error_db"] < -140


@pytest.mark.parametrize("stores", [True, False])
def test_of_slow_time_in_a_data_set(stores: bool) -> None:
    config = _config("configs/quickstart.yaml", f"output.slow_time={str(stores).lower()}")
    scene = draw_scene(config, config.chosen_activities[0], 0)
    wanted = ["signal", "accuracy", *(f"image:{name}" for name in config.maps)]
    sample = store(record(scene, wanted), scene, config)
    assert (sample.error_db > -145) == stores
