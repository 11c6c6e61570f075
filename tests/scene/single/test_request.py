"""What a request for one scene asks for, without computing it."""

from pathlib import Path

import numpy as np
import pytest
from helpers.small import small_config

from radhar_cli.config import Config, load_config
from radhar_cli.errors import ConfigError
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.single.request import SceneRequest
from radhar_cli.scene.single.simulate import simulate, simulate_scene


@pytest.fixture(scope="module")
def config(tmp_path_factory: pytest.TempPathFactory) -> Config:
    path: Path = tmp_path_factory.mktemp("config")
    return load_config(small_config(path), ["duration_s=0.5"])


def test_a_request_gives_what_the_arguments_of_simulate_give(config: Config) -> None:
    request = SceneRequest(config, "walking", seed=3, index=1, maps=("stft",))
    by_arguments = simulate(config, "walking", 3, index=1, maps=("stft",))
    by_request = simulate_scene(request)
    assert by_request.scene.config == by_arguments.scene.config
    assert list(by_request.maps) == ["stft"]
    np.testing.assert_array_equal(by_request.maps["stft"].power, by_arguments.maps["stft"].power)


def test_a_scene_has_the_seed_and_the_maps_of_its_request(config: Config) -> None:
    scene = SceneRequest(config, "punching", seed=5, maps=("rtm",), nominal=True).draw_scene()
    assert (scene.config.seed, scene.config.maps) == (5, ("rtm",))
    assert SceneRequest(config, "punching").draw_scene().config.maps == config.maps


def test_products_follow_from_maps_and_raw(config: Config) -> None:
    names = SceneRequest(config, "walking", raw=True).product_names(("stft", "rtm"))
    assert names.maps == ("stft", "rtm")
    assert "signal" in names.signals.values()
    assert names.frames == ()
    assert {"waveform", "antennas", "wall", "raw_echo"} <= set(names.others)
    assert "raw_echo" not in SceneRequest(config, "walking").product_names(("stft",)).others


def test_a_joint_echoes_alone(config: Config) -> None:
    request = SceneRequest(config, "walking", joint="right ankle")
    motions = tuple(map(motion_of, request.draw_scene().people))
    (alone,) = request.echoing_motions(motions)
    assert alone.names == ("right_ankle",)
    with pytest.raises(ConfigError, match="'tail' is not a joint"):
        SceneRequest(config, "walking", joint="tail").echoing_motions(motions)


def test_a_map_that_the_radar_does_not_make_is_refused_before_the_scene(config: Config) -> None:
    with pytest.raises(ConfigError, match="maps"):
        SceneRequest(config, "walking", maps=("range_azimuth",)).draw_scene()
