"""What is said of numba is true of the config."""

import pytest

from radhar_cli.config import load_config
from radhar_cli.echo import compiled
from radhar_cli.numerics import accelerators
from radhar_cli.numerics.accelerators import installed
from radhar_cli.processing import fsst
from radhar_cli.scene.products import acceleration
from radhar_cli.scene.products.run import run
from radhar_cli.scene.products.table import plan_images
from radhar_cli.scene.scene import draw_scene

CASES = {
    "configs/quickstart.yaml": ("a sixth", []),
    "configs/human/free_space_77GHz.yaml": ("half", []),
    "configs/human/streams.yaml": ("a tenth", ["duration_s=6"]),
}
NOT = {
    "configs/human/through_wall_2GHz.yaml": [],
    "configs/human/through_wall_uwb.yaml": [],
    "configs/boards/iwr1443.yaml": [],
    "configs/quickstart.yaml": ["engine.precision=double"],
    "configs/paper/free_space.yaml": ["duration_s=1"],
}


@pytest.mark.parametrize("path", CASES)
def test_what_is_missing_is_said_with_what_it_saves(path, monkeypatch):
    saved, more = CASES[path]
    monkeypatch.setattr(acceleration, "installed", lambda library: None)
    said = acceleration.describe_acceleration(load_config(path, more))
    assert "pip install numba saves" in said
    assert saved in said


@pytest.mark.every(4)
@pytest.mark.parametrize("path", [*CASES, *NOT])
def test_numba_is_named_where_it_compiles(path, monkeypatch):
    config = load_config(path, CASES[path][1] if path in CASES else NOT[path])
    compilations = []

    def counted(function, *called):
        compilations.append(function)
        return accelerators.machine_code(function, *called)

    for module in (compiled, fsst):
        monkeypatch.setattr(module, "machine_code", counted)
    said = acceleration.describe_acceleration(config)
    run(plan_images(config), {"scene": draw_scene(config, config.chosen_activities[0], 0)})
    assert (said is not None) == bool(compilations)
    assert said is None or installed("numba") in said
