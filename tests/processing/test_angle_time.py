"""Angle-time maps: angles and powers of points by closed forms, a walker, and what is refused."""

from typing import Any

import numpy as np
import pytest
from helpers.boards import CFG, MARS, cube_of
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.config.data_set import Config
from radhar_cli.dataset.layout import column_axis, large_datasets, row_axis
from radhar_cli.errors import ConfigError
from radhar_cli.numerics.arrays import Complex
from radhar_cli.processing.angle_time import angle_time
from radhar_cli.processing.frame_maps import range_angle
from radhar_cli.radar.board import DEVICES, Board
from radhar_cli.scene.single.request import map_names
from radhar_cli.scene.single.simulate import Simulation, simulate

HALF_BEAM = 0.5 * np.degrees(2 / 8)  # of a row of eight elements, half power, broadside


def steady_echo(amplitude: float, frames: int = 2) -> Complex:
    """Cube of an echo from straight ahead in the middle of range bin 60."""
    beat = amplitude * np.exp(-2j * np.pi * 60 * np.arange(80) / MARS.n_fft)
    return np.broadcast_to(beat, (frames, 32, 12, 80)).astype(complex)


@settings(max_examples=12, deadline=None)
@given(degrees=st.floats(-50, 50), speed=st.sampled_from([-1.2, 0.0, 0.7]))
def test_a_point_is_seen_at_its_angle(degrees: float, speed: float) -> None:
    direction = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0])
    cube, board = cube_of(3 * direction, -speed * direction, snr_db=None)
    azimuth_time = angle_time(cube, board, 0, remove_mean=False)
    seen = azimuth_time.rows.values[azimuth_time.power.argmax(axis=0)]
    assert abs(seen - degrees).max() < HALF_BEAM / 4 / np.cos(np.radians(degrees)) + 0.5


def test_elevation_is_positive_up() -> None:
    direction = np.array([np.cos(0.4), 0, np.sin(0.4)])
    array = DEVICES["IWR6843ISK-ODS"].array
    cube, board = cube_of(3 * direction, -0.7 * direction, array=array)
    elevation_time = angle_time(cube, board, 1, remove_mean=False)
    assert elevation_time.rows.name == "elevation"
    seen = elevation_time.rows.values[elevation_time.power[:, 0].argmax()]
    assert seen == pytest.approx(np.degrees(0.4), abs=2)


@pytest.mark.parametrize("bins", [None, (50, 70)])
def test_a_steady_echo_reads_its_power(bins: tuple[int, int] | None) -> None:
    step = MARS.range_step_m
    limits_m = None if bins is None else (bins[0] * step, bins[1] * step)
    azimuth_time = angle_time(steady_echo(3), MARS, 0, remove_mean=False, limits_m=limits_m)
    assert azimuth_time.power.max() == pytest.approx(9, rel=1e-3)
    assert azimuth_time.power[90] == pytest.approx([9, 9], rel=1e-3)


def test_ranges_beyond_the_limits_are_left_out() -> None:
    step = MARS.range_step_m
    azimuth_time = angle_time(steady_echo(3), MARS, 0, False, (90 * step, 110 * step))
    assert azimuth_time.power.max() < 1e-3


def test_what_stands_still_is_taken_out() -> None:
    assert not angle_time(steady_echo(3), MARS, 0, remove_mean=True).power.any()


def test_sum_of_range_azimuth_over_ranges(random_cube: tuple[Complex, Board]) -> None:
    cube, board = random_cube
    azimuth_time = angle_time(cube, board, 0, remove_mean=True)
    summed = range_angle(cube, board, True, 0).power.sum(axis=1).T
    ratio = azimuth_time.power / summed
    assert ratio == pytest.approx(np.full_like(ratio, ratio[0, 0]), rel=1e-4)
    assert azimuth_time.columns.values == pytest.approx(board.middles)


@pytest.fixture
def random_cube() -> tuple[Complex, Board]:
    return cube_of(np.array([2.0, 0.5, 0]), np.array([1.0, 0, 0]), snr_db=10)


RADARS: dict[str, dict[str, Any]] = {
    "board": {"device": "IWR1443BOOST", "cfg": CFG, "position_m": [0, 0, 1]},
    "chip of 1 x 3": {
        "frame": {"chirps": 64, "interval_s": 250e-6, "period_s": 0.05},
        "carrier_hz": 60e9,
        "bandwidth_hz": 1e9,
        "adc_rate_hz": 2e6,
        "chirp_s": 64e-6,
        "array": {"tx": [[0, 0]], "rx": [[0, 0], [1, 0], [1, 1]]},
        "output": "real",
        "position_m": [0, 0, 1.2],
    },
}


def config_of(radar: dict[str, Any], **keys: Any) -> Config:
    document = {"activities": ["walking"], "duration_s": 4.0, "maps": ["azimuth_time"]}
    return Config.model_validate({"radar": radar, **document, **keys})


def azimuth_of_torso(simulation: Simulation, times: np.ndarray[Any, Any]) -> Any:
    """True azimuth of the torso at times, degrees, of a radar above the origin."""
    x, y = simulation.truth.positions[:, 0, :2].T
    t = simulation.truth.time
    return np.degrees(np.arctan2(np.interp(times, t, y), np.interp(times, t, x)))


@pytest.mark.parametrize(("radar", "largest"), [("board", 4.0), ("chip of 1 x 3", 12.0)])
def test_a_walker_who_crosses_is_followed(radar: str, largest: float) -> None:
    motion = {"range_m": 3.0, "cross_range_m": -2.0, "angle_deg": 90.0}
    config = config_of(RADARS[radar], motion=motion)
    azimuth_time = (simulation := simulate(config, nominal=True)).maps["azimuth_time"]
    true = azimuth_of_torso(simulation, azimuth_time.columns.values)
    assert np.ptp(true) > 40
    seen = azimuth_time.rows.values[azimuth_time.power.argmax(axis=0)]
    assert np.median(abs(seen - true)) < largest


def test_one_frame_has_the_width_of_its_period() -> None:
    config = config_of(RADARS["chip of 1 x 3"], duration_s=0.05)
    azimuth_time = simulate(config, nominal=True).maps["azimuth_time"]
    assert azimuth_time.power.shape == (181, 1)
    assert np.ptp(azimuth_time.columns.edges) == pytest.approx(0.05)


def test_a_data_set_has_images_with_axes_and_a_column_of_labels() -> None:
    config = config_of(RADARS["board"], image={"size_px": [32, 48]})
    assert large_datasets(config) == {"maps/azimuth_time": ("u1", (32, 48))}
    assert row_axis("azimuth_time") == ("azimuth", "degree")
    assert row_axis("elevation_time") == ("elevation", "degree")
    assert column_axis("azimuth_time") == ("slow time", "s")


def test_radars_without_a_row_or_frames_are_refused_in_a_line() -> None:
    with pytest.raises(ValueError, match="elevation_time is of the frames of a board"):
        Config.model_validate({"maps": ["elevation_time"]})
    radar = RADARS["chip of 1 x 3"] | {"array": {"tx": [[0, 0]], "rx": [[0, 0], [1, 0]]}}
    with pytest.raises(ValueError, match="all elements of the array lie in one row"):
        config_of(radar, maps=["elevation_time"])


@pytest.mark.parametrize("word", ["angle_time", "range_angle_time", "doppler_angle"])
def test_other_words_are_answered(word: str) -> None:
    with pytest.raises(ConfigError, match=r"is called (azimuth_time|doppler_azimuth)"):
        map_names([word], Config.model_validate({}))
