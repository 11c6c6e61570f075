"""Maps of frames: peaks, levels and noise as formulas have them."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from helpers.boards import MARS, channels, cube_of

from radhar_cli.echo.board_cube import exact_cube, fast_cube
from radhar_cli.echo.receiver.noise import circular_gaussian
from radhar_cli.processing.best_points import best_points
from radhar_cli.processing.frame_maps import (
    FrameMaps,
    doppler_angle,
    doppler_spectrum,
    range_angle,
    range_doppler,
    without_turns,
)
from radhar_cli.processing.points import board_points
from radhar_cli.radar.board import DEVICES, longest_rows
from radhar_cli.radar.detection import CASO, Cfar, Detection
from tests.echo.test_board_cube import A, P, V

STILL = Detection(Cfar(CASO, 8, 4, False, 15.0), remove_mean=True)


def _peak(maps: FrameMaps, frame: int = 0) -> tuple[int, float, float]:
    """Row, place in the columns, and decibels of the largest cell."""
    row, column = np.unravel_index(maps.power[frame].argmax(), maps.power[frame].shape)
    level = 10 * np.log10(maps.power[frame].max())
    return int(row), float(maps.columns.values[column]), float(level)


def test_peaks_of_two_moving_scatterers() -> None:
    cube, _ = exact_cube(channels(MARS, P, V, A), MARS)
    row, speed, level = _peak(range_doppler(cube, MARS, True))
    assert (row, speed) == (69, pytest.approx(1.03657, abs=1e-5))
    assert level == pytest.approx(-12.531, abs=1e-3)
    row, azimuth, level = _peak(range_angle(cube, MARS, True, 0))
    assert (row, azimuth) == (69, 8)
    assert level == pytest.approx(-12.237, abs=1e-3)


def test_a_steady_echo_in_the_middle_of_a_bin_reads_its_power() -> None:
    """Turns taken out of the side bins of a Hann window cost an azimuth map 0.0016 dB."""
    n = np.arange(80)
    beat = 3 * np.exp(-2j * np.pi * 60 * n / MARS.n_fft)
    cube = np.broadcast_to(beat, (2, 32, 12, 80)).astype(complex)
    assert _peak(range_doppler(cube, MARS, False))[2] == pytest.approx(20 * np.log10(3), abs=1e-3)
    row, azimuth, level = _peak(range_angle(cube, MARS, False, 0))
    assert (row, azimuth) == (60, 0)
    assert level == pytest.approx(20 * np.log10(3), abs=3e-3)


def test_noise_of_power_one() -> None:
    noise = circular_gaussian(np.random.default_rng(1), (20, 32, 12, 80))
    mean = float(range_doppler(noise, replace(MARS, frames=20), False).power.mean())
    assert mean == pytest.approx(1.5 / 32 * 1.5 / 80, rel=0.01)


def test_the_mean_removes_what_stands_still() -> None:
    cube, board = cube_of((2, 0, 0), (0, 0, 0), snr_db=None)
    left, whole = (range_doppler(cube, board, mean).power.max() for mean in (True, False))
    assert left < 1e-25 * whole


@pytest.mark.parametrize("device", ["IWR1443BOOST", "IWR6843ISK", "IWR6843ISK-ODS", "IWR6843AOP"])
@pytest.mark.parametrize("degrees", [-40.0, 0.0, 25.0])
def test_azimuth_is_positive_to_the_left(device: str, degrees: float) -> None:
    at = 3 * np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0])
    cube, board = cube_of(at, -0.7 * at / 3, array=DEVICES[device].array)
    assert _peak(range_angle(cube, board, False, 0))[1] == pytest.approx(degrees, abs=2)


@pytest.mark.parametrize("degrees", [-30.0, 0.0, 20.0])
def test_elevation_is_positive_up(degrees: float) -> None:
    at = 3 * np.array([np.cos(np.radians(degrees)), 0, np.sin(np.radians(degrees))])
    cube, board = cube_of(at, -0.7 * at / 3, array=DEVICES["IWR6843ISK-ODS"].array)
    assert _peak(range_angle(cube, board, False, 1))[1] == pytest.approx(degrees, abs=2)


@pytest.mark.parametrize(
    ("device", "rows", "elements"),
    [("IWR1443BOOST", 1, 8), ("IWR6843ISK", 1, 8), ("IWR6843ISK-ODS", 2, 4)],
)
def test_longest_rows(device: str, rows: int, elements: int) -> None:
    found = longest_rows(replace(MARS, array=DEVICES[device].array).places, 0)
    assert [len(row) for row in found] == [elements] * rows


def test_doppler_is_positive_approaching_and_ends_at_the_highest_speed() -> None:
    cube, board = cube_of((2, 0, 0), (-1, 0, 0))
    maps = range_doppler(cube, board, False)
    step = board.doppler_step_mps()
    assert maps.columns.values[[0, -1]] == pytest.approx([-15 * step, 16 * step])
    assert _peak(maps)[1] == pytest.approx(1, abs=step / 2)
    receding, _ = cube_of((2, 0, 0), (1, 0, 0))
    assert _peak(range_doppler(receding, board, False))[1] == pytest.approx(-1, abs=step / 2)


@pytest.mark.parametrize("loops", [2, 7, 32])
def test_of_what_stands_still_a_mean_leaves_nothing_at_all(loops: int) -> None:
    """And not rounding, which maps would show at full brightness."""
    board = replace(MARS, loops=loops, frames=3)
    for cube in (
        exact_cube(channels(board, P, np.zeros((2, 3)), A), board)[0],
        fast_cube(channels(board, P, np.zeros((2, 3)), A), board, -80)[0],
    ):
        assert not range_doppler(cube, board, True).power.any()
        assert not range_angle(cube, board, True, 0).power.any()
        assert not range_angle(cube, board, True, 1).power.any()
        assert range_doppler(cube, board, False).power.any()
        if loops > 2:
            assert not len(best_points(cube, board, True, 1e-4).points)
            assert not len(board_points(cube, board, STILL, quantise=True).points)


def test_frames_of_one_loop_have_angles() -> None:
    cube, board = cube_of((2, 0.5, 0), (0, 0, 0), loops=1)
    maps = range_angle(cube, board, False, 0)
    assert np.isfinite(maps.power).all()
    peak = np.unravel_index(maps.power[0].argmax(), maps.power[0].shape)[1]
    assert maps.columns.values[peak] == pytest.approx(np.degrees(np.arctan2(0.5, 2)), abs=2)


@pytest.mark.parametrize("degrees", [-35.0, 0.0, 20.0])
@pytest.mark.parametrize("speed", [-1.2, 0.7])
def test_doppler_azimuth_has_speed_and_angle_of_who_moves(degrees: float, speed: float) -> None:
    direction = np.array([np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0])
    cube, board = cube_of(3 * direction, -speed * direction, snr_db=None)
    maps = doppler_angle(cube, board, False, 0)
    row, azimuth, _ = _peak(maps)
    assert maps.rows.values[row] == pytest.approx(speed, abs=board.doppler_step_mps())
    assert azimuth == pytest.approx(degrees, abs=2)
    assert (maps.rows.name, maps.columns.name) == ("radial speed", "azimuth")


def test_doppler_elevation_is_positive_up() -> None:
    direction = np.array([np.cos(0.4), 0, np.sin(0.4)])
    array = DEVICES["IWR6843ISK-ODS"].array
    cube, board = cube_of(3 * direction, -0.7 * direction, array=array)
    assert _peak(doppler_angle(cube, board, False, 1))[1] == pytest.approx(np.degrees(0.4), abs=2)


def test_a_steady_echo_reads_its_power_over_doppler_and_angle() -> None:
    n = np.arange(80)
    beat = 3 * np.exp(-2j * np.pi * 60 * n / MARS.n_fft)
    cube = np.broadcast_to(beat, (2, 32, 12, 80)).astype(complex)
    row, azimuth, level = _peak(doppler_angle(cube, MARS, False, 0))
    assert (row, azimuth) == (15, 0)
    assert level == pytest.approx(20 * np.log10(3), abs=3e-3)


UNEVEN = {"burst_s": 900e-6, "chirp_starts_s": (0.0, 60e-6, 800e-6)}
BURSTS = {"burst_s": 900e-6}  # of chirps that follow each other, as boards of xWRL send them


@pytest.mark.parametrize("pauses", [UNEVEN, BURSTS])
@pytest.mark.parametrize(
    ("bpm", "masks"),
    [(None, MARS.masks), ((0, 1), (5, 5, 2)), ((1, 2), (1, 6, 6)), ((2, 0), (3, 4, 3))],
)
def test_pauses_within_a_loop_do_not_turn_what_moves(
    pauses: dict[str, Any], bpm: tuple[int, int] | None, masks: tuple[int, ...]
) -> None:
    """Ahead all elements have one phase, whenever their chirps come and whoever sends together."""
    board = replace(MARS, bpm=bpm, masks=masks, **pauses)
    speed = 12 * board.doppler_step_mps()
    cube, board = cube_of((2.5, 0.0, 0.0), (-speed, 0, 0), board, snr_db=None)
    spectrum = np.fft.fft(cube, board.n_fft, axis=-1)
    separate = without_turns(doppler_spectrum(spectrum, board, np.ones(board.loops)), board)[0]
    near = round(2.5 / board.range_step_m)
    peak = separate[12, :, near]
    np.testing.assert_allclose(np.abs(peak), np.abs(peak).mean(), rtol=0.05)
    assert np.abs(np.angle(peak / peak.mean())).max() < 0.1
