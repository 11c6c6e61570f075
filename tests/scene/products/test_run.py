"""A plan, run on a scene: the physics that the finished maps must show."""

import numpy as np
import pytest
from helpers import reference as ref

from radhar_cli.config.data_set import Config
from radhar_cli.config.maps import MAP_NAMES
from radhar_cli.motion.activities.activity import ACTIVITIES, activity_named
from radhar_cli.motion.paper.body import PaperBody
from radhar_cli.scene.products.run import Results, run
from radhar_cli.scene.products.run import record as record_scene
from radhar_cli.scene.products.table import plan_images
from radhar_cli.scene.scene import Scene, draw_scene, scene_numbers

FREE_SPACE: dict = {}
THROUGH_WALL = {"radar": {"carrier_hz": 2e9, "bandwidth_hz": 1e9, "prf_hz": 128}, "wall": {}}
scenarios = pytest.mark.parametrize(
    "scenario", [FREE_SPACE, THROUGH_WALL], ids=["free space", "through the wall"]
)
# The paper's walker: from 1 m, 1.5 m/s for 4 s, straight away. Its wall is at 1 m as well.
AWAY = {"model": "paper", "range_m": 1.0, "angle_deg": 0}


def record(scenario: dict, *products: str, slug: str = "walking", **more: object) -> Results:
    config = Config.model_validate({"snr_db": None, "motion": AWAY} | scenario | more)
    scene = draw_scene(config, activity_named(slug), 0)
    return record_scene(scene, [*products, "waveform", "scene"])


@pytest.fixture
def only_the_torso(monkeypatch):
    monkeypatch.setattr(PaperBody, "cross_sections", lambda self, t: np.eye(13)[0][:, None])


def torso_legs(scene: Scene, t: np.ndarray) -> np.ndarray:
    """Distance from transmitter to torso to receiver [M], m, for the motion AWAY."""
    v = scene_numbers(scene)
    torso = [
        v["motion.range_m"] + v["motion.walking.speed_mps"] * t,
        0.0,
        1.2 * v["subject.height_m"] / 1.8,
    ]
    return sum(
        np.sqrt(sum((torso[axis] - v[f"radar.{antenna}_m.{axis}"]) ** 2 for axis in range(3)))
        for antenna in ("tx", "rx")
    )


@pytest.mark.usefixtures("only_the_torso")
@pytest.mark.parametrize("kind", ["stft", "fsst"])
@pytest.mark.parametrize("engine", ["direct", "cube"])
def test_ridge_of_the_torso_is_where_its_speed_puts_it(kind, engine):
    """f_D = -(R_tx + R_rx)' f0/c at the centre of every frame: walking away is negative."""
    # The cube takes a quarter of a second for a second of the paper's fast radar.
    scenario = FREE_SPACE | {"radar": {"prf_hz": 2000}}
    recording = record(scenario, kind, engine={"kind": engine}, duration_s=2.0)
    found = recording[kind]
    frequency, time = found.rows.values, found.columns.values
    ridge = frequency[found.power.argmax(axis=0)]
    scene, h = recording["scene"], 1e-4
    rate = (torso_legs(scene, time + h) - torso_legs(scene, time - h)) / (2 * h)
    expected = -rate * (77e9 + 2e9) / ref.C
    assert -800 < expected.min() < expected.max() < -400
    # Half a bin of rounding; the track bends by less than one more within a frame.
    assert np.abs(ridge - expected).max() <= 1.5 * (frequency[1] - frequency[0])


@pytest.mark.usefixtures("only_the_torso")
@scenarios
@pytest.mark.parametrize("kind", ["stft_compensated", "fsst_compensated"])
def test_compensation_stops_the_torso(scenario, kind):
    """Zero Doppler in every frame, out of the wall or in it."""
    recording = record(scenario, kind)
    power = recording[kind].power
    assert (power.argmax(axis=0) == power.shape[0] // 2).all()
    middle = power[power.shape[0] // 2 - 2 : power.shape[0] // 2 + 3]
    assert middle.sum() > 0.99 * power.sum()


@pytest.mark.usefixtures("only_the_torso")
def test_the_delay_of_the_wall_is_compensated_too():
    """From 1 m to 1.12 m the walker is in the wall and 2.4 times as slow to the radar."""
    slow = {"motion": AWAY | {"range_m": 0.9, "walking": {"speed_mps": 0.3}}, "duration_s": 1.0}
    recording = record(THROUGH_WALL, "signal_compensated", "signal", **slow)
    phase = np.unwrap(np.angle(recording["signal_compensated"].x[0, 0]))
    turned = np.unwrap(np.angle(recording["signal"].x[0, 0]))
    assert np.ptp(turned) > 2 * np.pi
    assert np.ptp(phase) < 0.1 * np.ptp(turned)


@scenarios
def test_compensation_moves_the_whole_walker_towards_zero(scenario):
    plain, compensated = "stft", "stft_compensated"
    recording = record(scenario, plain, compensated)
    frequency = recording[plain].rows.values

    def centroid(name):
        power = recording[name].power
        return float(np.sum(frequency[:, None] * power) / power.sum())

    bulk = 2 * 1.5 * recording["waveform"].f0 / ref.C
    # Arms and legs are not centred with it, and MTI favours the fast among them.
    assert centroid(plain) < -0.7 * bulk
    assert abs(centroid(compensated)) < 0.4 * bulk


@scenarios
@pytest.mark.parametrize("with_mti", [True, False])
@pytest.mark.parametrize("width", [32, 1024])
def test_engines_show_the_same_range_time_map(scenario, with_mti, width):
    """Without noise both are exact, at pulses apart and where pairs share a pulse."""
    more = {
        "processing": {"clutter": "difference" if with_mti else "none"},
        "image": {"size_px": [16, width]},
        "duration_s": 1.0 if scenario is THROUGH_WALL else 0.5,
    }
    maps = [
        record(scenario, "rtm", engine={"kind": kind}, **more)["rtm"].power
        for kind in ("cube", "direct")
    ]
    assert maps[0].shape == maps[1].shape
    assert np.abs(maps[1] - maps[0]).max() < 1e-10 * maps[0].max()


@pytest.mark.parametrize("engine", ["direct", "cube"])
def test_rerunning_gives_the_same_bytes(engine):
    config = Config.model_validate(
        {
            "radar": {"carrier_hz": 24e9, "bandwidth_hz": 1e9, "prf_hz": 500},
            "duration_s": 1.0,
            "maps": MAP_NAMES,
            "image": {"size_px": 32},
            "engine": {"kind": engine},
        }
    )
    scene = draw_scene(config, ACTIVITIES[11], 5)
    asked = [*MAP_NAMES, *(f"image:{name}" for name in MAP_NAMES)]
    one, two = (record_scene(scene, asked) for _ in range(2))
    for name in MAP_NAMES:
        assert one[name].power.tobytes() == two[name].power.tobytes()
        assert one[f"image:{name}"].sha256 == two[f"image:{name}"].sha256


@pytest.mark.parametrize("engine", ["direct", "cube"])
def test_a_motionless_scene_without_noise_is_black(engine):
    config = Config.model_validate(
        {"snr_db": None, "maps": MAP_NAMES, "image": {"size_px": 16}, "engine": {"kind": engine}}
        | {"radar": {"carrier_hz": 24e9, "bandwidth_hz": 1e9, "prf_hz": 500}}
        | {"motion": {"model": "paper"}}
    )
    scene = draw_scene(config, activity_named("stationary"), 0)
    images = run(plan_images(config), {"scene": scene})
    for name in MAP_NAMES:
        assert not images[f"image:{name}"].levels.any()
        assert images[f"image:{name}"].entropy == 0


def test_each_processing_key_changes_its_map_alone():
    """Every processing key changes the map it is about, and no other."""
    base = {"radar": {"carrier_hz": 24e9, "bandwidth_hz": 1e9, "prf_hz": 500}, "duration_s": 2.0}
    names = ("rtm", "stft", "stft_denoised", "fsst", "stft_compensated")
    scene_slug = activity_named("walking")

    def maps(**processing):
        chosen = {"range_window": "rectangular"} | processing
        config = Config.model_validate(base | {"processing": chosen})
        recording = record_scene(draw_scene(config, scene_slug, 0), names)
        return {name: recording[name].power for name in names}

    right = maps()
    doppler = {"stft", "stft_denoised", "fsst", "stft_compensated"}
    for processing, touched in (
        ({"clutter": "none"}, {"rtm"} | doppler),
        ({"range_fft_length": 1000}, {"rtm"} | doppler),
        ({"range_reference": "start"}, doppler),
        ({"range_window": "hann"}, {"rtm"} | doppler),
        ({"window_s": 0.3}, doppler),
        ({"overlap_fraction": 0.5}, doppler),
        ({"stft_fft_length": 200}, doppler - {"fsst"}),
        ({"savgol": {"order": 3, "frame": 11}}, {"stft_denoised"}),
        ({"fsst_threshold": 0.1}, {"fsst"}),
        ({"fsst_hop_pulses": 7}, {"fsst"}),
    ):
        found = maps(**processing)
        # P_s, and with it the noise, is a mean over knots, which lie where the phase needs them.
        changed = {
            name
            for name in names
            if found[name].shape != right[name].shape
            or not np.allclose(found[name], right[name], rtol=1e-4, atol=0)
        }
        assert changed == touched, processing
