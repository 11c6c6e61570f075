"""Every built-in radar: movements of all kinds, every map that it makes, data sets, limits."""

from pathlib import Path

import draw_radars
import numpy as np
import pytest
import yaml
from helpers.command_line import ok

from radhar_cli.config.documents import RADARS, WRITTEN_RADARS
from radhar_cli.config.offered_maps import possible_maps
from radhar_cli.config.starting_file import of_board
from radhar_cli.processing.frame_maps import FrameMaps
from radhar_cli.scene.single.simulate import simulate

pytestmark = pytest.mark.slow
each = pytest.mark.parametrize("name", [*WRITTEN_RADARS, *RADARS])
written = pytest.mark.parametrize("name", WRITTEN_RADARS)
ACTIVITIES = "walking", "falling", "punching"
ALIASES = "a joint moves faster than the Doppler PRF/2"
NOT_SIMULATED = "what is set there is not simulated"


@each
def test_it_makes_every_map_of_who_walks_falls_and_punches(name: str) -> None:
    config = draw_radars.load_radar(name)
    promised = {*possible_maps(config)} - {"points", "cube"}
    for activity in ACTIVITIES:
        scene = simulate(config, activity, maps="all")
        made = {**scene.maps, **scene.frames}
        assert promised <= made.keys()
        for product in made.values():
            if isinstance(product, FrameMaps) or hasattr(product, "rows"):
                assert np.isfinite(product.power).all()
                assert product.power.max() > 0
        for warning in scene.warnings:
            assert ALIASES in warning or NOT_SIMULATED in warning, warning


@each
def test_its_data_set_is_built_and_verified(name: str, tmp_path: Path) -> None:
    document = yaml.safe_load(of_board(name, tmp_path))
    document |= {"activities": [*ACTIVITIES], "samples_per_class": 2}
    document["split"] = {"train": 0.5, "validation": 0.5}
    (tmp_path / "radar.yaml").write_text(yaml.safe_dump(document))
    ok("generate", tmp_path / "radar.yaml", "-o", tmp_path / "set")
    ok("verify", tmp_path / "set")


@written
def test_its_limits_are_found(name: str) -> None:
    """As many as there is time for; at pulses that are longer than the range axis, too."""
    config = f"configs/boards/{name}.yaml"
    said = ok("limits", config, "--key", "radar", "--minutes", "0.3").stdout
    assert "\nradar." in said
