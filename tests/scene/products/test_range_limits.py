"""`image.range_limits_m`: the range axis of images, of rtm and of a board's frame maps."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from helpers import reference as ref

import radhar_cli.config
from radhar_cli.config.data_set import Config
from radhar_cli.config.reading import load_config
from radhar_cli.errors import ConfigError
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.scene.products.run import Results, record
from radhar_cli.scene.scene import draw_scene

RADAR = {"carrier_hz": 24e9, "bandwidth_hz": 500e6, "prf_hz": 1000, "adc_rate_hz": 10e6}
STEP = ref.C / 1e9
RADARS = Path(radhar_cli.config.__file__).parent / "radars"


def config(image: dict[str, Any], **more: Any) -> Config:
    document = {"radar": RADAR, "maps": ["rtm"], "duration_s": 2.0, "image": image, "snr_db": None}
    return Config.model_validate(document | more)


def made(chosen: Config, *names: str, activity: str = "walking") -> Results:
    return record(draw_scene(chosen, activity_named(activity), 0), names)


@pytest.mark.parametrize("limits", [(0.0, 12.0), (1.0, 7.3), (2.05, 2.95)], ids=str)
def test_an_image_has_the_edges_that_were_asked_for(limits):
    found = made(config({"size_px": 64, "range_limits_m": limits}), "rtm", "image:rtm")
    power_map, image = found["rtm"], found["image:rtm"]
    assert image.extent[2:] == limits
    assert power_map.extent == image.extent
    assert image.entropy == pytest.approx(power_map.entropy, abs=1e-4)
    low, high = power_map.rows.edges
    assert low <= limits[0] < low + STEP
    assert high - STEP < limits[1] <= high


def test_a_map_keeps_the_bins_within_and_their_power():
    whole = made(config({"range_limits_m": [0, 1e4]}), "rtm")["rtm"]
    part = made(config({"range_limits_m": [1.0, 7.3]}), "rtm")["rtm"]
    bins = np.rint(part.rows.values / STEP).astype(int)
    assert np.array_equal(bins, np.arange(3, 25))  # cells from (k - 1/2) to (k + 1/2) times 0.3 m
    assert np.array_equal(part.power, whole.power[bins])
    assert whole.rows.values.size == 200
    assert whole.extent[2:] == pytest.approx((0, 59.81), abs=0.01)  # cut where the radar ends


def test_a_reflector_is_in_the_row_of_its_range():
    """The brightest row of whoever stands still at R holds R, by the edges of the image."""
    limits = (0.0, 12.0)
    chosen = config(
        {"size_px": 256, "range_limits_m": limits},
        motion={"range_m": 5.0, "angle_deg": 180},
        radar=RADAR | {"bandwidth_hz": 2e9, "tx_m": [0, 0, 1], "rx_m": [0, 0, 1]},
    )
    levels = made(chosen, "image:rtm", activity="punching")["image:rtm"].levels
    row = int(levels.astype(float).sum(axis=1).argmax())
    centre = limits[1] - (row + 0.5) * (limits[1] - limits[0]) / 256
    assert centre == pytest.approx(4.75, abs=0.45)  # fists are ahead of the feet


def test_people_have_an_axis_by_default_that_no_sample_decides():
    assert config({}).image.range_limits_m == (0.0, 12.0)  # 8 m, and a walk of 2 s
    chosen = config({}, motion={"range_m": {"uniform": [3, 4]}, "cross_range_m": 3.0})
    assert chosen.image.range_limits_m == (0.0, 9.0)  # towards or away, as anybody may
    other = {"activity": "walking", "motion": {"range_m": 20.0}}
    assert config({}, people=[other]).image.range_limits_m == (0.0, 24.0)
    away = {"range_m": 5.0, "angle_deg": {"uniform": [-40, 170]}}
    walks = config({}, motion=away, activities=["walking"])
    assert walks.image.range_limits_m == (0.0, 9.0)  # 1.3 m/s for 2 s, and 1 m
    stays = config({}, motion=away, activities=["punching"])
    assert stays.image.range_limits_m == (0.0, 6.0)
    lane = away | {"walking": {"lane_m": 0.5}}
    assert config({}, motion=lane, activities=["walking"]).image.range_limits_m == (0.0, 7.0)
    behind = RADAR | {"tx_m": [-2, 0, 1], "rx_m": [-2, 0, 1]}
    further = config({}, motion=away, activities=["punching"], radar=behind)
    assert further.image.range_limits_m == (0.0, 8.0)
    extents = {
        made(chosen, "image:rtm", activity=name)["image:rtm"].extent[2:]
        for name in ("walking", "punching", "falling_to_walking")
    }
    assert extents == {(0.0, 9.0)}


def test_the_paper_has_the_whole_axis():
    chosen = config({}, motion={"model": "paper"})
    assert chosen.image.range_limits_m is None
    power_map = made(chosen, "rtm")["rtm"]
    assert power_map.rows.values.size == 200
    assert power_map.limits is None


def test_impulses_have_limits_too():
    radar = {
        "waveform": "impulse",
        "carrier_hz": 3.1e9,
        "bandwidth_hz": 2.2e9,
        "prf_hz": 200,
        "profile_m": [1.0, 9.0],
        "profile_samples": 1024,
    }
    signed = {"kind": "signed", "size_px": 64, "range_limits_m": [2.0, 5.0]}
    found = made(config(signed, radar=radar, motion={"range_m": 4.0}), "rtm", "image:rtm")
    assert found["image:rtm"].extent[2:] == (2.0, 5.0)
    assert found["rtm"].real.shape == found["rtm"].power.shape
    beyond = config({"range_limits_m": [0, 20]}, radar=radar, motion={"range_m": 4.0})
    low, high = made(beyond, "image:rtm")["image:rtm"].extent[2:]
    assert (low, high) == pytest.approx((1.0, 9.0), abs=0.01)


@pytest.mark.parametrize("name", ["range_doppler", "range_azimuth"])
def test_frame_maps_of_boards_have_limits_too(name):
    cfg = (RADARS / "iwr1443boost.cfg").read_text()
    board = {"radar": {"cfg": cfg, "device": "IWR1443BOOST"}, "maps": [name]}
    base = {"duration_s": 0.5, "motion": {"range_m": 3.0}}
    whole = Config.model_validate(board | base | {"image": {"range_limits_m": [0, 1e4]}})
    cut = Config.model_validate(board | base | {"image": {"range_limits_m": [1, 5]}})
    everything, part = (made(one, name, f"image:{name}") for one in (whole, cut))
    assert np.array_equal(part[name].power, everything[name].power)  # products have all ranges
    shown = part[name].shown
    rows = shown.rows
    first = int(np.rint(rows.values[0] / everything[name].rows.values[1]))
    kept = slice(first, first + rows.values.size)
    assert np.array_equal(shown.power, everything[name].power[:, kept])
    assert rows.edges[0] <= 1 < 5 <= rows.edges[1]
    assert part[f"image:{name}"].extent[2:] == (1.0, 5.0)


@pytest.mark.parametrize(
    ("limits", "words"),
    [
        ([5, 1], "0 <= near < far"),
        ([-1, 5], "0 <= near < far"),
        ([3, 3.2], "at least 2 range bins"),
        ([80, 90], "the 60 m|the 59.96 m|at least 2 range bins"),
        (7, "should be a list"),
    ],
    ids=str,
)
def test_limits_that_show_nothing_are_refused(limits, words, tmp_path: Path):
    import yaml

    path = tmp_path / "wrong.yaml"
    path.write_text(
        yaml.safe_dump({"radar": RADAR, "maps": ["rtm"], "image": {"range_limits_m": limits}})
    )
    with pytest.raises(ConfigError, match=words) as caught:
        load_config(path)
    assert "image.range_limits_m" in str(caught.value)
