"""A board that is turned about its boresight: its left side goes up, angles stay the room's."""

from dataclasses import replace

import numpy as np
import pytest
from helpers.boards import CFG, MARS, cube_of
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.config import Config
from radhar_cli.config.radar import BoardRadar
from radhar_cli.processing.frame_maps import range_angle
from radhar_cli.radar.board import DEVICES
from radhar_cli.radar.propagation import boresight_axes
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import Scene, nominal_scene

BOARD_1843 = replace(MARS, array=DEVICES["IWR1843BOOST"].array)


def _direction(azimuth_deg: float, elevation_deg: float) -> np.ndarray:
    azimuth, elevation = np.radians([azimuth_deg, elevation_deg])
    return np.array(
        [
            np.cos(azimuth) * np.cos(elevation),
            np.sin(azimuth) * np.cos(elevation),
            np.sin(elevation),
        ]
    )


def test_the_left_side_goes_up() -> None:
    ahead, left, up = boresight_axes(0.0, 0.0, np.pi / 2)
    np.testing.assert_allclose(ahead, [1, 0, 0], atol=1e-15)
    np.testing.assert_allclose(left, [0, 0, 1], atol=1e-15)
    np.testing.assert_allclose(up, [0, -1, 0], atol=1e-15)


@given(st.floats(-3, 3), st.floats(-1.5, 1.5), st.floats(-3.2, 3.2))
def test_axes_are_a_rotation_about_boresight(yaw: float, tilt: float, roll: float) -> None:
    axes, upright = np.array(boresight_axes(yaw, tilt, roll)), np.array(boresight_axes(yaw, tilt))
    np.testing.assert_allclose(axes @ axes.T, np.eye(3), atol=1e-12)
    assert np.linalg.det(axes) == pytest.approx(1)
    np.testing.assert_array_equal(axes[0], upright[0])
    turn = np.array([[np.cos(roll), np.sin(roll)], [-np.sin(roll), np.cos(roll)]])
    np.testing.assert_allclose(axes[1:], turn @ upright[1:], atol=1e-12)


@given(st.floats(-3.2, 3.2), st.floats(-1, 1), st.floats(-1, 1))
def test_points_keep_their_places_in_the_room(roll: float, left: float, up: float) -> None:
    board = replace(BOARD_1843, roll=roll, position=(0.5, 1.0, 1.5), yaw=0.3, tilt=0.2)
    point = np.zeros((1, 8))
    point[0, :3] = 3.0, left, up
    before = point[0, :3] @ np.array(board.aim.axes)
    after = board.without_roll(point[:, :3])[0] @ np.array(board.upright.axes)
    np.testing.assert_allclose(before, after, atol=1e-12)


@pytest.mark.parametrize("degrees", [-40.0, -12.0, 25.0])
def test_the_long_row_measures_elevation(degrees: float) -> None:
    """What range_azimuth sees at roll 0, range_elevation sees at roll 90, to the left as up."""
    across, upwards = _direction(degrees, 0), _direction(0, degrees)
    cube, board = cube_of(3 * across, -0.7 * across, BOARD_1843, None)
    rolled_cube, rolled = cube_of(3 * upwards, -0.7 * upwards, BOARD_1843, None, roll=np.pi / 2)
    np.testing.assert_allclose(rolled_cube, cube, atol=1e-9 * np.abs(cube).max())
    one, other = range_angle(cube, board, True, 0), range_angle(rolled_cube, rolled, True, 1)
    np.testing.assert_allclose(other.power, one.power, rtol=1e-4, atol=1e-8 * one.power.max())
    assert (one.columns.name, other.columns.name) == ("azimuth", "elevation")
    peak = np.unravel_index(other.power[0].argmax(), other.power[0].shape)
    assert other.columns.values[peak[1]] == pytest.approx(degrees, abs=2)


def test_turned_the_other_way_the_row_still_counts_upwards() -> None:
    direction = _direction(0, 20)
    cube, board = cube_of(3 * direction, -0.7 * direction, BOARD_1843, None, roll=-np.pi / 2)
    maps = range_angle(cube, board, True, 1)
    peak = np.unravel_index(maps.power[0].argmax(), maps.power[0].shape)
    assert maps.columns.values[peak[1]] == pytest.approx(20, abs=2)


@pytest.mark.parametrize("roll_deg", [7.0, -60.0, 180.0])
def test_any_roll_has_azimuths(roll_deg: float) -> None:
    direction = _direction(15, 0)
    roll = np.radians(roll_deg)
    cube, board = cube_of(3 * direction, -0.7 * direction, BOARD_1843, None, roll=roll)
    maps = range_angle(cube, board, True, 0)
    peak = np.unravel_index(maps.power[0].argmax(), maps.power[0].shape)
    assert maps.columns.values[peak[1]] == pytest.approx(15, abs=5)


def test_the_beam_rolls_with_the_board() -> None:
    """28 degrees to the left at half power are 28 degrees up of a board that is rolled."""
    p = _direction(0, 28)[:, None]
    rolled = replace(BOARD_1843, roll=np.pi / 2)
    assert rolled.aim.two_way(p)[0] == pytest.approx(0.5)
    assert BOARD_1843.aim.two_way(p)[0] < 0.1


def test_roll_deg_of_a_config_turns_elements_and_leaves_skeletons() -> None:
    upright, rolled = (_scene(roll_deg) for roll_deg in (0, 90))
    names = ("board", "skeleton", "range_azimuth", "range_elevation")
    stands, lies = record(upright, names).products, record(rolled, names).products
    np.testing.assert_array_equal(lies["skeleton"], stands["skeleton"])
    assert lies["board"].roll == pytest.approx(np.pi / 2)
    widths = [np.ptp(made["board"].rows_along(1)[1]) for made in (stands, lies)]
    assert widths == pytest.approx([1, 7])


def _scene(roll_deg: float) -> Scene:
    radar = {"device": "IWR1443BOOST", "cfg": CFG, "roll_deg": roll_deg}
    keys = {"radar": radar, "maps": ["range_elevation"], "duration_s": 0.2}
    config = Config.model_validate(keys | {"motion": {"range_m": 3}})
    return nominal_scene(config, config.chosen_activities[0])


def test_a_row_alone_has_no_elevation_until_it_is_rolled() -> None:
    kind = _row(0.0), _row(90.0)
    assert kind[0].why_no_frames("range_azimuth") is None
    assert kind[0].why_no_frames("range_elevation") == "all elements of the array lie in one row"
    assert kind[1].why_no_frames("range_elevation") is None
    why = kind[1].why_no_frames("range_azimuth")
    assert str(why).endswith("in one row of the board that is rolled (radar.roll_deg)")


def _row(roll_deg: float) -> BoardRadar:
    array = {"tx": [[0, 0], [0, 0], [0, 0]], "rx": [[0, 0], [1, 0], [2, 0], [3, 0]]}
    return BoardRadar.model_validate({"cfg": CFG, "array": array, "roll_deg": roll_deg})


NINE = {"tx": [[0, 0]], "rx": [[left, up] for up in range(3) for left in range(3)]}
SQUARE = {
    **{"carrier_hz": 60e9, "bandwidth_hz": 2e9, "adc_rate_hz": 4e6, "chirp_s": 32e-6},
    **{"frame": {"chirps": 32, "interval_s": 1e-4, "period_s": 0.05}, "array": NINE},
}


@pytest.mark.parametrize("roll_deg", [0, 90, 180, -90, 37])
@pytest.mark.parametrize(("tilt_deg", "yaw_deg"), [(0, 0), (15, 25), (-20, 25)])
def test_a_reflector_is_seen_where_it_stands(roll_deg: int, tilt_deg: int, yaw_deg: int) -> None:
    target, place = np.array([3.0, 0.6, 1.5]), np.array([0.0, 0.2, 1.0])
    turned = {"roll_deg": roll_deg, "tilt_deg": tilt_deg, "yaw_deg": yaw_deg}
    config = Config.model_validate(
        {
            "radar": SQUARE | turned | {"position_m": place.tolist()},
            "maps": ["points"],
            "activities": ["nobody"],
            "duration_s": 0.2,
            "snr_db": None,
            "processing": {"clutter": "none"},
            "room": {"reflectors": [{"position_m": target.tolist()}]},
        }
    )
    scene = nominal_scene(config, config.chosen_activities[0])
    points = record(scene, ["points"])["points"]
    yaw, tilt = np.radians([yaw_deg, tilt_deg])
    ahead = _direction(yaw_deg, -tilt_deg)
    left = np.array([-np.sin(yaw), np.cos(yaw), 0.0])
    axes = np.array([ahead, left, np.cross(ahead, left)])
    assert axes[2, 2] == pytest.approx(np.cos(tilt))
    np.testing.assert_allclose(
        points[:, :3], np.tile(axes @ (target - place), (len(points), 1)), atol=0.02
    )
    assert len(points) == 4  # a point in every frame
