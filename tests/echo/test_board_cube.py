"""The cube of a board: numbers of an independent reference, and the fast against the exact sum."""

from contextlib import nullcontext
from dataclasses import replace
from functools import partial
from typing import Any

import numpy as np
import pytest
from helpers.boards import CFG, MARS, Straight, channels
from helpers.known import A, P, V
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.config.radar import BoardRadar
from radhar_cli.echo import board_cube
from radhar_cli.echo.accuracy import LOOSEST_DB, SPARE_DB, AccuracyError
from radhar_cli.echo.board_cube import exact_cube, fast_cube, mean_power, measured_db
from radhar_cli.echo.paths import Paths
from radhar_cli.numerics.arrays import Float
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.radar.board import DEVICES
from radhar_cli.scene.radar import board_of

# Of a program of other authors; [frame, loop, virtual, sample].
KNOWN = {
    (0, 0, 0, 0): -2.338012084294e-01 + 3.160266437939e-01j,
    (0, 31, 11, 79): 2.792382471605e-01 - 7.927925464462e-02j,
    (1, 0, 0, 0): 1.970900983800e-01 + 1.441892804927e-02j,
    (1, 16, 5, 40): 2.919467935763e-02 + 1.950559592754e-01j,
    (1, 31, 8, 79): 1.215679391962e-01 + 3.624585790791e-01j,
}


def test_samples_of_two_moving_scatterers() -> None:
    cube, power = exact_cube(channels(MARS, P, V, A), MARS)
    for index, value in KNOWN.items():
        assert cube[index] == pytest.approx(value, abs=1e-9)
    assert power == pytest.approx(0.0966, abs=1e-4)


REPEATED = """
channelCfg 15 7 0
adcCfg 2 1
profileCfg 0 77 7 3 39 0 0 100 1 256 7200 0 0 30
chirpCfg 0 2 0 0 0 0 0 1
frameCfg 0 2 64 0 50 1 0
"""
KNOWN_OF_REPEATED = {
    (0, 0, 0, 0): 5.259613961295e-02 - 4.057877298482e-01j,
    (0, 191, 3, 255): -1.586279610705e-01 - 1.204895151171e-01j,
    (2, 100, 1, 128): -8.212600474530e-02 - 1.193057826180e-01j,
}


def test_a_mask_that_repeats_adds_loops() -> None:
    """One transmitter in three chirps of a loop: 192 loops, 46 us apart, not 64."""
    radar = BoardRadar[float](cfg=REPEATED, device="IWR1443BOOST", position_m=(0, 0, 0))
    board = board_of(radar, 0.15)
    assert (board.loops, board.channels, board.frames) == (192, 4, 3)
    cube, _ = exact_cube(channels(board, P, V, A), board)
    for index, value in KNOWN_OF_REPEATED.items():
        assert cube[index] == pytest.approx(value, abs=1e-9)


def test_a_transmitter_with_less_power_has_a_weaker_echo() -> None:
    """6 and 20 dB less of the first and third transmitter of three (masks 1, 4, 2)."""
    radar = BoardRadar[float](
        cfg=CFG.replace("7 40 0 0 100", "7 40 0x140006 0 100"), device="IWR1443BOOST"
    )
    less = board_of(radar)
    full = replace(less, backoff_db=())
    gains = [less.antennas(k, 0).gain / full.antennas(k, 0).gain for k in range(3)]
    assert gains == pytest.approx([10 ** (-6 / 20), 0.1, 1.0])


@pytest.mark.parametrize("tolerance", [-20.0, -60.0, -80.0, -99.0, -140.0, -180.0])
@pytest.mark.parametrize("speed", [0.0, 1.0, 30.0])
def test_the_fast_sum_keeps_its_tolerance_or_says_so(tolerance: float, speed: float) -> None:
    rng = np.random.default_rng(1)
    p, v = rng.normal((3, 0, 0), 0.3, (20, 3)), speed * rng.normal(size=(20, 3))
    sources = channels(MARS, p, v, np.ones(20))
    exact, power = exact_cube(sources, MARS)
    refused = speed == 30  # by 16 cm a frame, past the antennas
    with pytest.raises(AccuracyError) if refused else nullcontext():
        cube, fast_power, measured = fast_cube(sources, MARS, tolerance)
    if refused:
        return
    error = 20 * np.log10(np.linalg.norm(cube - exact) / np.linalg.norm(exact))
    assert error <= tolerance
    assert error <= measured < error + 14 or measured < -180
    assert fast_power == pytest.approx(power, rel=1e-6)


@pytest.mark.parametrize("device", ["IWR1443BOOST", "IWR6843ISK-ODS", "IWR1642BOOST"])
@pytest.mark.parametrize("tolerance", [-80.0, -94.0, -97.0, -100.0, -150.0])
@pytest.mark.parametrize("nodes", [2, board_cube.NODES])
def test_the_stated_error_has_the_rounding_of_the_samples_in_it(
    device: str, tolerance: float, nodes: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two nodes do not suffice: samples are made in double precision then, and rounded."""
    monkeypatch.setattr(board_cube, "NODES", nodes)
    rng, speed = np.random.default_rng(4), 1.0
    array = DEVICES[device].array
    masks = MARS.masks if len(array.tx) == 3 else (1, 2)
    board = replace(MARS, array=array, masks=masks, frames=2)
    p, v = rng.normal((3, 0, 0), 0.3, (20, 3)), speed * rng.normal(size=(20, 3))
    sources = channels(board, p, v, np.ones(20))
    cube, _, stated = fast_cube(sources, board, tolerance)
    exact, _ = exact_cube(sources, board)
    assert cube.dtype == (np.complex128 if tolerance < -100 else np.complex64)
    assert 20 * np.log10(np.linalg.norm(cube - exact) / np.linalg.norm(exact)) <= stated


@pytest.mark.parametrize("tolerance", [-6.0, -60.0])
def test_a_looser_tolerance_runs_as_the_default(tolerance: float) -> None:
    sources = channels(MARS, P, V, A)
    usual, _, usual_db = fast_cube(sources, MARS, LOOSEST_DB)
    loose, _, loose_db = fast_cube(sources, MARS, tolerance)
    assert loose.tobytes() == usual.tobytes()
    assert loose_db == usual_db


@given(
    samples=st.integers(2, 200),
    loops=st.integers(1, 9),
    frames=st.integers(1, 20),
    distance=st.floats(0.05, 500),
)
def test_any_shape_of_frames(samples: int, loops: int, frames: int, distance: float) -> None:
    board = replace(MARS, samples=samples, loops=loops, frames=frames)
    sources = channels(board, [(distance, 0, 0)], [(-1, 0.1, 0)], [distance**2])
    exact, _ = exact_cube(sources, board)
    cube, _, measured = fast_cube(sources, board, -60)
    assert cube.shape == (frames, loops, 12, samples)
    assert measured <= -60
    assert np.abs(cube - exact).max() <= 2e-2 * np.abs(exact).max()


@pytest.mark.parametrize("samples", [99, 100])
def test_beats_that_turn_by_more_than_a_cycle_a_sample(samples: int) -> None:
    board = replace(MARS, samples=samples)
    far = SPEED_OF_LIGHT * board.adc_rate_hz / (2 * board.slope_hz)  # a cycle a sample
    p = [(2, 0, 0), (2 + 0.4 * far, 1, 0), (2 + 1.3 * far, 0, 1), (2 + 3.7 * far, 0, 0)]
    sources = channels(board, p, [(1, 0, 0)] * 4, np.linalg.norm(p, axis=1) ** 2)
    _, _, measured = fast_cube(sources, board, -80)
    assert measured <= -80


@pytest.mark.parametrize("samples", [80, 256, 512])
@pytest.mark.parametrize("tolerance", [-80.0, -140.0])
def test_scatterers_far_apart_need_no_exact_sum(samples: int, tolerance: float) -> None:
    board = replace(MARS, samples=samples, loops=8)
    p = np.array([(1 + i, 0.1 * i, 0) for i in range(7)])
    sources = channels(board, p, [(1, 0, 0)] * 7, (p**2).sum(axis=1))
    assert fast_cube(sources, board, tolerance)[2] <= tolerance - SPARE_DB


def test_what_jumps_within_a_frame_is_not_taken_for_right() -> None:
    p = np.random.default_rng(1).normal((5, 0, 0), 0.3, (20, 3))
    sources = channels(MARS, p, [(3000, 0, 0)] * 20, np.ones(20))
    with pytest.raises(AccuracyError) as refusal:
        fast_cube(sources, MARS, -80)
    assert refusal.value.limit_db > -80


class Kinked(Straight):
    """Paths whose amplitudes change their slope in the middle of the first frame."""

    def __call__(self, t: Float) -> Paths:
        paths = super().__call__(t)
        middle = MARS.loops * MARS.loop_s / 2
        return paths._replace(amplitude=paths.amplitude * (1 + np.maximum(t - middle, 0)))


def test_what_six_nodes_cannot_show_is_made_again_from_more() -> None:
    """So that nobody pays for exact sums, or is refused, over a kink."""
    sources = [Kinked(*vars(one).values()) for one in channels(MARS, P, V, A)]
    exact, _ = exact_cube(sources, MARS)
    cube, _, measured = fast_cube(sources, MARS, -80)
    assert measured <= -80 - SPARE_DB
    assert 20 * np.log10(np.linalg.norm(cube - exact) / np.linalg.norm(exact)) <= -80


@pytest.mark.parametrize("sums", [exact_cube, partial(fast_cube, tolerance_db=-80)])
def test_what_stands_still_is_the_same_in_every_loop_to_the_last_digit(sums: Any) -> None:
    """A canceller then leaves nothing, and not the rounding of sums."""
    for loops in (5, 32):
        board = replace(MARS, loops=loops, frames=3)
        cube = sums(channels(board, P, np.zeros((2, 3)), A), board)[0]
        assert (cube == cube[:, :1]).all()
        assert cube.any()


def test_power_of_paths_whose_echo_is_not_made() -> None:
    sources = channels(MARS, P, V, A)
    assert mean_power(sources, MARS) == pytest.approx(exact_cube(sources, MARS)[1], rel=1e-9)


def test_receivers_fed_the_other_way_round_change_their_sign() -> None:
    board = replace(MARS, array=DEVICES["IWR6843ISK-ODS"].array)
    same = replace(board, array=replace(board.array, rx_sign=(1.0,) * 4))
    sources = channels(board, P, V, A)
    signed, plain = exact_cube(sources, board)[0], exact_cube(sources, same)[0]
    np.testing.assert_allclose(signed[:, :, 1::4], -plain[:, :, 1::4])
    np.testing.assert_allclose(signed[:, :, 3::4], plain[:, :, 3::4])


def test_an_echo_of_nothing_has_no_error() -> None:
    sources = channels(MARS, P, V, [0, 0])
    cube, power, measured = fast_cube(sources, MARS, -80)
    assert not cube.any()
    assert power == 0
    assert measured == measured_db(cube, sources, MARS) == -np.inf
