"""People counting: azimuths in steps of degrees, order of the points, speed."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from helpers.scatterers import echo_of, repeatable_noise

from radhar_cli.numerics.arrays import Float
from radhar_cli.processing.people_tracking.counting import count_people, order_of_angles
from radhar_cli.radar.board import DEVICES, Board
from radhar_cli.radar.people_tracking import PeopleCounting
from radhar_cli.readers.ti.ti_commands import split_lines
from radhar_cli.readers.ti.ti_people import last_lines, read_people_counting

IWR1642 = Board(
    array=DEVICES["IWR1642BOOST"].array,
    start_hz=77e9,
    carrier_hz=77e9 + 60e12 * 7e-6,
    slope_hz=60e12,
    adc_rate_hz=2.5e6,
    samples=128,
    slot_s=92e-6,
    masks=(1, 2),
    receivers=(0, 1, 2, 3),
    loops=128,
    frames=1,
    period_s=0.05,
)
LINES = "cfarCfg 6 4 4 0 0 16 16 4 4 50 62 0\ndoaCfg 600 1875 30 1\n"
SETTINGS: PeopleCounting = read_people_counting(last_lines(split_lines(LINES, "cfg")), 8, 128)


def points_of(*scatterers: Mapping[str, Any], settings: PeopleCounting = SETTINGS) -> Float:
    cube = echo_of(IWR1642, scatterers, (1, 2))
    cube = cube + repeatable_noise(cube.shape, 1.0, 4)
    return count_people(cube[None], IWR1642, settings, remove_mean=True).points


def scatterer(right_deg: float, speed: float, r: float = 3.0) -> Mapping[str, Any]:
    way = np.array([np.cos(np.radians(right_deg)), -np.sin(np.radians(right_deg)), 0])
    return {"position_m": r * way, "velocity_mps": speed * way, "amplitude": 0.5}


def test_settings_are_those_of_the_two_lines() -> None:
    assert (SETTINGS.half_view_deg, SETTINGS.step_deg, SETTINGS.gamma) == (60, 1.875, 0.03)
    assert SETTINGS.cfar.threshold == (5.0, 6.2)
    assert SETTINGS.angles_deg[[0, 1, -1]].tolist() == [-60, -58.125, 58.125]
    assert len(SETTINGS.angles_deg) == 64


@pytest.mark.parametrize("right_deg", [-35.0, 0.0, 20.0])
def test_a_scatterer_is_where_it_is(right_deg: float) -> None:
    points = points_of(scatterer(right_deg, 0.5))
    assert len(points) >= 3
    x, y, z, speed = points[:, :4].T
    assert not z.any()
    assert np.median(np.hypot(x, y)) == pytest.approx(3.02, abs=0.06)
    azimuth = np.degrees(np.arctan2(-y, x))
    # Nothing compensates for the turns of the transmitters.
    assert np.median(azimuth) == pytest.approx(right_deg, abs=4)
    assert np.abs(speed + 0.5).max() < 0.05
    steps = (azimuth + 60) / 1.875
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-3)


def test_angles_come_from_both_ends_in_turns() -> None:
    assert order_of_angles(5).argsort().tolist() == [0, 4, 1, 3, 2]
    points = points_of(scatterer(-40, 0.5), scatterer(38, -0.5))
    number = np.round((np.degrees(np.arctan2(-points[:, 1], points[:, 0])) + 60) / 1.875)
    turns = order_of_angles(64)[number.astype(int)]
    assert (np.diff(turns) >= 0).all()
    assert {*np.sign(points[:, 1])} == {-1.0, 1.0}


def test_noise_alone_has_no_point_and_a_resting_scatterer_only_without_mean_removal() -> None:
    assert not len(points_of())
    resting = [scatterer(10, 0)]
    assert not len(points_of(*resting))
    cube = echo_of(IWR1642, resting, (1, 2))
    cube = cube + repeatable_noise(cube.shape, 1.0, 4)
    points = count_people(cube[None], IWR1642, SETTINGS, remove_mean=False).points
    assert len(points) >= 3
    assert not points[:, 3].any()


def test_no_frame_has_more_than_300_points() -> None:
    low = replace(SETTINGS, cfar=replace(SETTINGS.cfar, threshold=(0.5, 0.5)))
    assert len(points_of(settings=low)) == 300
