"""What people tracking makes of single scatterers: bias, fans of points, false alarms."""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from helpers.scatterers import ISK, ISK_CFG, ODS, ODS_GEOMETRY, echo_of, repeatable_noise

from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.processing.people_tracking.chain import track_people
from radhar_cli.processing.points import Cloud
from radhar_cli.radar.board import Board
from radhar_cli.radar.people_tracking import PeopleTracking
from radhar_cli.readers.ti.ti_commands import split_lines
from radhar_cli.readers.ti.ti_people import last_lines, read_people_tracking

BPM = (0, 2)
BPM_MASKS = (5, 2, 5)


def settings_of(board: Board, more: str = "") -> PeopleTracking:
    """Settings of TI's file for an ISK, with other lines behind it that hold."""
    return read_people_tracking(last_lines(split_lines(ISK_CFG + more, "isk")), 12, board.n_fft)


def scatterer(
    right_deg: float = 0.0, up_deg: float = 0.0, r: float = 3.0, a: float = 1.0, v: float = 0.0
) -> Mapping[str, Any]:
    """A scatterer in a direction, whose speed v is away from the radar."""
    right, up = np.radians(right_deg), np.radians(up_deg)
    ahead = np.cos(up) * np.cos(right), -np.cos(up) * np.sin(right), np.sin(up)
    return {
        "position_m": r * np.array(ahead),
        "velocity_mps": v * np.array(ahead),
        "amplitude": a,
    }


def cloud_of(board: Board, *scatterers: Any, more: str = "", noise: float = 1.0) -> Cloud:
    """Cloud of a frame of scatterers, with noise of a power."""
    masks = (1, 2, 4) if board.bpm is None else BPM_MASKS
    cube: Complex = echo_of(board, scatterers, masks, board.bpm)
    cube = cube + repeatable_noise(cube.shape, noise, 5)
    return track_people(cube[None], board, settings_of(board, more))


def middle(cloud: Cloud) -> Float:
    """Mean of the direction cosines (right, up) of points, by their power over the noise."""
    x, y, z = cloud.points[:, :3].T
    r = np.sqrt(x * x + y * y + z * z)
    weight = 10 ** (cloud.points[:, 5] / 10)
    mean: Float = (np.stack([-y, z]) / r) @ weight / weight.sum()
    return mean


@pytest.mark.parametrize(
    ("board", "more", "per_speed"),
    [
        (replace(ISK, loops=48), "", (0.0285, 0.0)),
        (replace(ISK, loops=48, bpm=BPM, masks=BPM_MASKS), "", (0.0, -0.075)),
        (replace(ODS, loops=48), ODS_GEOMETRY, (0.030, 0.035)),
    ],
    ids=["ISK", "ISK with bpmCfg", "ODS"],
)
def test_motion_shifts_directions_as_nothing_compensates_for_it(
    board: Board, more: str, per_speed: tuple[float, float]
) -> None:
    receding, approaching = (
        middle(cloud_of(board, scatterer(v=speed), more=more)) for speed in (1.2, -1.2)
    )
    assert (receding - approaching) / 2.4 == pytest.approx(per_speed, abs=0.004)


def test_a_strong_scatterer_is_a_fan_of_points() -> None:
    points = cloud_of(ISK, scatterer(v=0.8)).points
    assert 37 <= len(points) <= 43
    azimuth = np.degrees(np.arctan2(-points[:, 1], points[:, 0]))
    assert np.ptp(azimuth) == pytest.approx(4.8, abs=1.5)
    assert 5 <= np.ptp(points[:, 6]) + 1 <= 6
    assert np.ptp(points[:, 3]) < 0.1
    assert points[:, 3].mean() == pytest.approx(-0.8, abs=0.05)


def test_two_on_both_sides_in_a_bin_are_apart_with_their_speeds() -> None:
    cloud = cloud_of(ISK, *(scatterer(side * 15.0, r=2.8, v=0.4 * side, a=0.2) for side in (1, -1)))
    right = -cloud.points[:, 1]
    speed = -cloud.points[:, 3]
    assert 12 <= len(right) <= 40
    assert min((right > 0).sum(), (right < 0).sum()) >= 5
    assert (np.sign(speed) == np.sign(right)).all()
    assert np.abs(speed) == pytest.approx(0.4, abs=0.1)


def test_noise_alone_gives_no_moving_points_and_many_resting_ones() -> None:
    assert not sum(
        len(cloud_of(replace(ISK, loops=48, start_hz=start)).points) for start in (60.75e9, 60.8e9)
    )
    static = "staticRangeAngleCfg -1 1 8 8\n"
    assert 50 <= len(cloud_of(replace(ISK, loops=48), more=static).points) <= 150


def test_bpm_lowers_the_noise_of_the_map_by_three_decibels() -> None:
    from radhar_cli.processing.people_tracking.chain import PeopleTracker
    from radhar_cli.processing.people_tracking.spectrum import decode_bpm, range_bins

    levels = []
    for board in (replace(ISK, loops=48), replace(ISK, loops=48, bpm=BPM, masks=BPM_MASKS)):
        cube = repeatable_noise((48, 12, 96), 1.0, 7)
        tracker = PeopleTracker.of(settings_of(board))
        frame = decode_bpm(cube, board.sums, board.differences)
        _, power = tracker.map_of(range_bins(frame, np.blackman(96), tracker.turned).moving)
        levels.append(10 * np.log10(power[:, 4:-4].mean()))
    assert levels[1] - levels[0] == pytest.approx(-3.0, abs=0.1)


def test_more_loops_give_no_more_signal_over_noise() -> None:
    snr = [
        cloud_of(replace(ISK, loops=loops), scatterer(v=0.4, a=0.5)).points[:, 5].max()
        for loops in (48, 96)
    ]
    assert snr[1] == pytest.approx(snr[0], abs=1.5)


def test_slow_breath_is_seen_over_several_frames() -> None:
    board = replace(ISK, loops=48, frames=40)
    breath = 2 * np.pi * 0.3 * np.arange(40) * board.period_s
    frames = [echo_of(board, [scatterer(r=2.5 + 0.003 * np.sin(phase), a=0.3)]) for phase in breath]
    cube = np.stack(frames)
    cube = cube + repeatable_noise(cube.shape, 1.0, 3)
    fine = "fineMotionCfg -1 1 1.0 10 2\n"
    counts = np.diff(track_people(cube, board, settings_of(board, fine)).start)
    plain = np.diff(track_people(cube, board, settings_of(board)).start)
    assert counts[[20, 30]].min() >= 5
    assert not plain[[20, 30]].any()
    others = [n for n in range(40) if n not in (20, 30)]
    assert counts[others].tolist() == plain[others].tolist()
    rows = track_people(cube[:21], board, settings_of(board, fine)).points
    assert not rows[:, 3].any()
