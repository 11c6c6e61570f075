"""Boards with real samples, or with the image band: numbers of a reference, levels, noise."""

from dataclasses import replace

import numpy as np
import pytest
from helpers.boards import channels, cube_of
from helpers.known import A, P, V

from radhar_cli.config.radar import BoardRadar
from radhar_cli.echo.board_cube import exact_cube
from radhar_cli.echo.receiver.noise import circular_gaussian
from radhar_cli.processing.best_points import best_points
from radhar_cli.processing.frame_maps import range_doppler
from radhar_cli.radar.board import Board
from radhar_cli.radar.frame_timing import Sampling
from radhar_cli.scene.products.board import compute_range_bins
from radhar_cli.scene.radar import board_of

REAL = """
channelCfg 15 1 0
adcCfg 2 0
profileCfg 0 77 220 6 132 0 0 4 0 3072 25000 0 0 30
chirpCfg 0 0 0 0 0 0 0 1
frameCfg 0 0 128 0 3072 500 1 0
"""
LOW_POWER = """
channelCfg 7 3 0
chirpComnCfg 15 5 0 128 1 34 3
chirpTimingCfg 6 26 1 47.95 60
frameCfg 2 0 600 64 200 0
"""
# Of a program of other authors; [frame, loop, virtual, sample].
KNOWN_2944 = {
    (0, 0, 0, 0): -1.983637716001e-01,
    (0, 127, 3, 3071): 1.722324073399e-01,
    (1, 64, 2, 1000): 3.327605779405e-02,
}
KNOWN_6432 = {
    (0, 0, 0, 0): 2.183477704510e-01,
    (0, 0, 4, 127): -1.453187673511e-01,
    (0, 63, 5, 60): -4.239953359106e-01,
    (1, 32, 1, 10): -5.298117403723e-02,
}


def board(cfg: str, device: str, seconds: float = 1.0) -> Board:
    radar = BoardRadar[float].model_validate(
        {"cfg": cfg, "device": device, "position_m": (0.0, 0.0, 0.0)}
    )
    return board_of(radar, seconds)


LOW = board(LOW_POWER, "IWRL6432BOOST", 0.4)


@pytest.mark.parametrize(
    ("cfg", "device", "known"),
    [(REAL, "AWR2944EVM", KNOWN_2944), (LOW_POWER, "IWRL6432BOOST", KNOWN_6432)],
)
def test_samples_are_real_parts(cfg: str, device: str, known: dict[tuple[int, ...], float]) -> None:
    radar = board(cfg, device)
    radar = replace(radar, frames=2)
    assert radar.is_real
    cube, _ = exact_cube(channels(radar, P, V, A), radar)
    for index, value in known.items():
        assert cube[index].real == pytest.approx(value, abs=1e-9)


def test_chirps_of_bursts() -> None:
    times = LOW.chirp_times()
    assert times.shape == (2, 64, 2)
    assert times[1, 3, 1] == pytest.approx(0.2 + 3 * 600e-6 + 40e-6, abs=1e-12)
    pulses = np.arange(2 * 64 * 2)
    np.testing.assert_allclose(LOW.waveform.times(pulses), times.ravel(), atol=1e-12)


def test_a_steady_echo_reads_as_of_complex_samples() -> None:
    """And noise twice: half of it is in the other half band, which is left out."""
    r = 20 * LOW.range_step_m
    whole, still = cube_of((r, 0, 0), (0, 0, 0), LOW, snr_db=None, a=3.0)
    maps = range_doppler(np.ascontiguousarray(whole.real), still, False)
    assert maps.power.shape == (1, 64, 64)
    assert 10 * np.log10(maps.power.max() / 9) == pytest.approx(0, abs=0.05)
    noise = circular_gaussian(np.random.default_rng(1), (8, 64, 6, 128))
    complex_board = replace(LOW, sampling=Sampling.COMPLEX_2X, frames=8)
    real_board = replace(LOW, frames=8)
    pairs = (noise, complex_board), (np.ascontiguousarray(noise.real), real_board)
    levels = [range_doppler(cube, one, False).power[:, 3:-3].mean() for cube, one in pairs]
    assert levels[1] / levels[0] == pytest.approx(2, rel=0.03)
    bins = [compute_range_bins(cube, one).x for cube, one in pairs]
    assert bins[1].shape == bins[0].shape == (6, 64, 8 * 64)
    assert np.iscomplexobj(bins[1])


def test_points_of_real_samples_lie_where_the_target_is() -> None:
    azimuth, r = np.radians(20.0), 4.0
    p = (r * np.cos(azimuth), r * np.sin(azimuth), 0.0)
    v = tuple(-0.5 * x / r for x in p)
    cube, radar = cube_of(p, v, LOW, snr_db=20.0)
    points = best_points(np.ascontiguousarray(cube.real), radar, True, 1e-5).points
    strongest = points[points[:, 4].argmax()]
    assert strongest[:2] == pytest.approx(p[:2], abs=0.15)
    assert strongest[3] == pytest.approx(0.5, abs=0.03)


def test_a_mean_of_chirps_has_less_noise() -> None:
    several = LOW_POWER.replace("frameCfg 2 0 600", "frameCfg 2 4 600")
    mean = board(several, "IWRL6432BOOST")
    assert mean.waveform.sample_rate == pytest.approx(LOW.waveform.sample_rate / 4)
    assert mean.slot_s == pytest.approx(4 * LOW.slot_s)


def test_the_image_band_is_left_out() -> None:
    twice = board(REAL.replace("adcCfg 2 0", "adcCfg 2 2"), "AWR2944EVM")
    assert (twice.n_bins, twice.is_real) == (2048, False)
