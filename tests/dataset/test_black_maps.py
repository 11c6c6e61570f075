"""Maps of which nothing is left are refused or counted, never shown in silence."""

from dataclasses import replace

import numpy as np
import pytest
from helpers.listener import Listener

from radhar_cli.config import Config
from radhar_cli.dataset.build import build
from radhar_cli.errors import RadharError, SceneError
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import draw_scene
from radhar_cli.scene.single.simulate import simulate

ENGINES = pytest.mark.parametrize("engine", ["direct", "cube"])
OPAQUE = {"wall": {"loss_tangent": 1}, "snr_reference": "received"}  # 77 GHz: 1e-170 or less
GATED = {"processing": {"range_sum": "gated"}}
MASKS = {"image": {"size_px": 32, "kind": "cfar", "cfar": {"guard": [1, 1], "training": [2, 2]}}}


def config_of(engine, **more):
    return Config.model_validate(
        {
            "samples_per_class": 1,
            "duration_s": 0.5,
            "activities": ["stationary", "punching"],
            "motion": {"model": "paper"},
            "engine": {"kind": engine},
            "maps": ["stft"],
            "snr_db": None,
            "image": {"size_px": 32},
            "split": {"train": 1, "validation": 0},
        }
        | more
    )


@ENGINES
@pytest.mark.parametrize("maps", [["rtm"], ["stft", "fsst_compensated"]])
def test_noise_below_an_echo_of_nothing_is_refused(engine, maps, tmp_path):
    """No noise is 10 dB below an echo that has no power."""
    config = config_of(engine, **OPAQUE, snr_db=10, maps=maps)
    words = r"stationary/0: the echo's power is 0; snr_db = 10 needs .*wall\.loss_tangent"
    with pytest.raises(SceneError, match=words):
        build(config, tmp_path, 1, Listener())
    with pytest.raises(SceneError, match=words):
        simulate(config, "stationary")


@ENGINES
@pytest.mark.parametrize(
    "more", [{"maps": ["rtm"]}, {"maps": ["stft", "fsst"]}, GATED, MASKS], ids=str
)
def test_black_maps_are_counted(engine, more, tmp_path):
    """One warning for all of them; without a wall the canceller removes who stands still."""
    for name, wall, count in (("wall", OPAQUE, 2), ("air", {}, 1)):
        listener = Listener()
        done = build(config_of(engine, **wall, **more), tmp_path / name, 1, listener)
        (said,) = [one for one in done.warnings if one["kind"] == "black"]
        assert said["recordings"] == count
        assert said["message"].startswith(f"{count} of 2 recordings: a map is black")
        assert sum(said["message"] in message for message in listener.messages) == 1


@pytest.mark.parametrize(("dbm", "kind"), [(100, "black"), (-300, "white")])
def test_maps_whose_powers_all_lie_beyond_an_absolute_scale_are_counted(dbm, kind, tmp_path):
    listener = Listener()
    image = {"size_px": 32, "reference": {"dbm": dbm}}
    done = build(config_of("direct", snr_db=20, image=image), tmp_path, 1, listener)
    (said,) = [one for one in done.warnings if one["kind"] == kind]
    assert said["recordings"] == 2
    assert "image.reference.dbm" in said["message"]


@ENGINES
def test_a_black_map_of_one_scene_is_named(engine):
    warnings = simulate(config_of(engine), "stationary", maps=("rtm", "stft")).warnings
    assert [one for one in warnings if one.startswith("rtm, stft: a map is black")]
    assert not [one for one in simulate(config_of(engine), "punching").warnings if "black" in one]


@ENGINES
@pytest.mark.parametrize("snr_db", [None, 10])
@pytest.mark.parametrize("map_name", ["image:rtm", "image:stft", "image:fsst"])
@pytest.mark.filterwarnings("ignore::RuntimeWarning")
def test_a_motion_that_is_no_number_is_refused(engine, snr_db, map_name):
    config = config_of(engine, snr_db=snr_db)
    scene = draw_scene(config, config.chosen_activities[0], 0)
    nowhere = replace(motion_of(scene.people[0]), start=(np.nan, 0.0))
    with pytest.raises(RadharError, match=r"power is nan|should be finite"):
        record(scene, [map_name], motions=(nowhere,))
