"""Beats by way of a grid of frequencies, against sums of exponentials."""

import numpy as np
import pytest

from radhar_cli.echo.gridded_sum import POWERS, Chirps, gridded_sum, powers_from_nodes
from radhar_cli.numerics.arrays import Complex, Float

pytest.importorskip("numba")
NODES = np.cos(np.pi * (np.arange(POWERS) + 0.5) / POWERS)
CARRIER = 62e9
PATHS, CHANNELS, LOOPS = 40, 3, 11


def chirps_of(samples: int, rate: float) -> Chirps:
    places = np.linspace(-1, 0.9, LOOPS) + np.array([[0], [0.04], [0.1]])
    return Chirps(places, powers_from_nodes(NODES), CARRIER, rate, samples)


def paths(rng: np.random.Generator, longest_m: float) -> tuple[Float, Float]:
    """Coefficients [I, V, POWERS] of delays and amplitudes of people's limbs within a frame."""
    shape = PATHS, CHANNELS, POWERS
    smaller = 0.2 ** np.arange(POWERS)
    delay = rng.normal(size=shape) * smaller * 1e-10
    delay[..., 0] += rng.uniform(0, 2 * longest_m / 3e8, (PATHS, 1))
    return delay, rng.normal(size=shape) * smaller


def exact(delay: Float, amplitude: Float, chirps: Chirps) -> Complex:
    powers = np.stack([np.vander(of, POWERS, increasing=True) for of in chirps.places])
    tau = np.einsum("ivp,vlp->ivl", delay, powers)[..., None]
    a = np.einsum("ivp,vlp->ivl", amplitude, powers)[..., None]
    n = np.arange(chirps.samples) - chirps.samples // 2
    cycles = chirps.frequency * tau + chirps.rate * tau * n
    summed: Complex = (a * np.exp(-2j * np.pi * cycles)).sum(axis=0)
    return summed


def error_db(samples: int, rate: float, longest_m: float, unit: float = 1.0) -> float:
    delay, amplitude = paths(np.random.default_rng(samples), longest_m)
    chirps = chirps_of(samples, rate)
    at_nodes = np.vander(NODES, POWERS, increasing=True).T
    fast, power = gridded_sum(delay @ at_nodes, unit * amplitude @ at_nodes, chirps)
    truth = unit * exact(delay, amplitude, chirps)
    powers = np.stack([np.vander(of, POWERS, increasing=True) for of in chirps.places])
    squares = np.einsum("ivp,vlp->ivl", amplitude, powers) ** 2
    assert fast.dtype == np.complex64
    assert power == pytest.approx(unit**2 * squares.sum())
    return 20 * float(np.log10(np.linalg.norm(fast - truth) / np.linalg.norm(truth)))


@pytest.mark.parametrize("samples", [1, 2, 3, 64, 99, 128, 255, 256])
def test_sums_are_right_to_single_precision(samples: int) -> None:
    assert error_db(samples, 0.9 / (2 * 9 / 3e8), 9.0) < -125


@pytest.mark.parametrize("longest_m", [0.01, 40.0, 900.0])
def test_beats_of_any_number_of_cycles_a_sample(longest_m: float) -> None:
    """Near 0, and of several cycles a sample, which no sample shows."""
    assert error_db(128, 0.9 / (2 * 9 / 3e8), longest_m) < -125


@pytest.mark.parametrize("unit", [1e-30, 1e-5, 1e30])
def test_whatever_the_power(unit: float) -> None:
    assert error_db(64, 1.5e7, 9.0, unit) < -125


def test_negative_rates() -> None:
    assert error_db(64, -1.5e7, 9.0) < -125


def test_no_power_is_no_signal() -> None:
    delay = np.full((2, CHANNELS, POWERS), 1e-8)
    samples, power = gridded_sum(delay, 0 * delay, chirps_of(32, 1e7))
    assert (power, np.abs(samples).max()) == (0.0, 0.0)


def test_what_stands_still_does_so_to_the_last_digit() -> None:
    delay = np.full((5, CHANNELS, POWERS), 1e-8) * np.arange(1, 6)[:, None, None]
    samples, _ = gridded_sum(delay, np.ones(delay.shape), chirps_of(32, 1e7))
    np.testing.assert_array_equal(samples, np.broadcast_to(samples[:, :1], samples.shape))
