"""Two transmitters that send together (BPM): samples as sent, and what tells them apart."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from helpers.boards import channels, cube_of
from helpers.known import A, P, V

from radhar_cli.config.radar import BoardRadar
from radhar_cli.echo.board_cube import combine_transmitters, exact_cube, fast_cube, mean_power
from radhar_cli.echo.receiver.noise import circular_gaussian
from radhar_cli.processing.best_points import best_points
from radhar_cli.processing.frame_maps import range_angle, range_doppler, spectra
from radhar_cli.radar.board import Board
from radhar_cli.scene.products.board import apply_channel_errors, compute_range_bins
from radhar_cli.scene.radar import board_of

CFG = (Path(__file__).parents[1] / "radar/cfg/people_isk_bpm.cfg").read_text()
# Of a program of other authors; [frame, loop, virtual, sample].
KNOWN = {
    (0, 0, 0, 0): 2.964758863657e-01 + 9.759393838347e-02j,
    (0, 0, 8, 0): 5.945521556642e-01 - 7.751000712011e-02j,
    (0, 20, 5, 50): -6.659643293639e-02 - 1.007451635774e-01j,
    (1, 47, 11, 95): 6.261792870846e-01 - 2.241774084060e-01j,
}
PAIR = board_of(
    BoardRadar[float](cfg=CFG, device="IWR6843ISK", position_m=(0.0, 0.0, 0.0)), 0.11
)  # masks 5, 2, 5
TURNS = replace(PAIR, bpm=None, masks=(1, 2, 4))


def test_samples_are_those_of_the_chirps_as_sent() -> None:
    assert (PAIR.order, PAIR.bpm, PAIR.frames, PAIR.loops) == ((0, 1, 2), (0, 2), 2, 48)
    sources = combine_transmitters(channels(PAIR, P, V, A), PAIR)
    cube, power = exact_cube(sources, PAIR)
    assert cube.shape == (2, 48, 12, 96)
    for index, value in KNOWN.items():
        assert cube[index] == pytest.approx(value, abs=1e-9)
    fast, fast_power, error = fast_cube(sources, PAIR, -80)
    assert np.linalg.norm(fast - cube) <= 1e-4 * np.linalg.norm(cube)
    assert error <= -80
    assert fast_power == pytest.approx(power, rel=1e-6)
    assert mean_power(sources, PAIR) == pytest.approx(power, rel=1e-6)
    alone = exact_cube(channels(TURNS, P, V, A), TURNS)[1]
    assert power == pytest.approx(alone * 5 / 3, rel=0.05)  # two of three chirps have twice of it


def test_what_stands_still_is_as_if_they_took_turns() -> None:
    still = np.zeros((2, 3))
    sources = channels(PAIR, P, still, A)
    sent = exact_cube(combine_transmitters(sources, PAIR), PAIR)[0]
    alone = exact_cube(sources, TURNS)[0]
    assert np.abs(sent[:, :, :4] - alone[:, :, :4] - alone[:, :, 8:]).max() < 1e-12
    (_, pair), (_, turns) = (
        next(spectra(cube, board, False)) for cube, board in ((sent, PAIR), (alone, TURNS))
    )
    assert np.abs(pair[:, 0] - turns[:, 0]).max() < 1e-12  # at Doppler 0, where nothing turns


def test_noise_of_two_that_are_told_apart_is_half() -> None:
    noise = circular_gaussian(np.random.default_rng(3), (16, 48, 12, 96))
    board = replace(PAIR, frames=16)
    power = (np.abs(next(spectra(noise, board, False))[1]) ** 2).mean(axis=(0, 1, 3))
    pair, alone = power[[0, 1, 2, 3, 8, 9, 10, 11]].mean(), power[4:8].mean()
    assert 10 * np.log10(pair / alone) == pytest.approx(-3.01, abs=0.1)


@pytest.mark.parametrize("bins", [0, 3, -9])
def test_maps_and_points_are_as_if_they_took_turns(bins: int) -> None:
    azimuth = np.radians(25.0)
    p, ahead = (3 * np.cos(azimuth), 3 * np.sin(azimuth), 0.3), np.cos(azimuth)
    v = (
        -bins * PAIR.doppler_step_mps() * ahead,
        -bins * PAIR.doppler_step_mps() * np.sin(azimuth),
        0,
    )
    found = []
    for board in (PAIR, TURNS):
        cube, board = cube_of(p, v, board, snr_db=25.0)
        maps = (
            range_doppler(cube, board, False).power[0],
            range_angle(cube, board, False, 0).power[0],
        )
        points = best_points(cube, board, False, 1e-5).points
        strongest = points[points[:, 4].argmax()]
        found.append((*(np.unravel_index(one.argmax(), one.shape) for one in maps), strongest))
        assert strongest[:3] == pytest.approx(p, abs=0.05)
    assert found[0][:2] == found[1][:2]


def test_doppler_maps_have_the_power_of_both() -> None:
    noise = circular_gaussian(np.random.default_rng(4), (2, 48, 12, 96))
    bins = compute_range_bins(noise, PAIR).x
    power = (np.abs(bins) ** 2).mean(axis=(1, 2))
    assert power[:4].mean() / power[4:8].mean() == pytest.approx(0.5, rel=0.05)


def test_errors_of_the_channels_are_those_of_each_transmitter() -> None:
    still, rng = np.zeros((2, 3)), np.random.default_rng(5)
    factors = rng.normal(1, 0.1, 12) * np.exp(1j * rng.normal(0, 0.2, 12))
    sources = channels(PAIR, P, still, A)
    alone = exact_cube(sources, TURNS)[0] * factors[:, None]
    sent = exact_cube(combine_transmitters(sources, PAIR), PAIR)[0]
    wrong = apply_channel_errors(sent, factors, PAIR)
    assert np.abs(wrong[:, :, :4] - alone[:, :, :4] - alone[:, :, 8:]).max() < 1e-12
    assert np.abs(wrong[:, :, 8:] - alone[:, :, :4] + alone[:, :, 8:]).max() < 1e-12
    assert np.array_equal(apply_channel_errors(alone, factors, TURNS), alone * factors[:, None])


def test_feeds_of_transmitters_are_taken_out() -> None:
    """Of transmitters whose feeds are turned, in turns or together."""
    signs, still = (-1.0, 1.0, 1.0), np.zeros((2, 3))
    for board in (PAIR, TURNS):
        turned: Board = replace(board, array=replace(board.array, tx_sign=signs))
        cubes = [
            exact_cube(combine_transmitters(channels(one, P, still, A), one), one)[0]
            for one in (board, turned)
        ]
        assert np.abs(cubes[0] - cubes[1]).max() > 0.1
        (_, plain), (_, fed) = (
            next(spectra(cube, one, False))
            for cube, one in zip(cubes, (board, turned), strict=True)
        )
        assert np.abs(plain[:, 0] - fed[:, 0]).max() < 1e-12
