"""Receiver noise: its variance and its circularity."""

import numpy as np
import pytest
from radhar_cli.radar.noise import circular_gaussian, noise_variance

COUNT = 400_000
# Five standard errors of a mean of COUNT numbers of variance 1.
FIVE_SIGMA = 5 / np.sqrt(COUNT)


@pytest.mark.parametrize(
    ("snr_db", "variance"), [(0, 2.0), (10, 0.2), (30, 0.002), (-10, 20.0), (3, 1.002374)]
)
def test_the_variance_is_the_signal_power_over_the_snr(snr_db: float, variance: float) -> None:
    assert noise_variance(2.0, snr_db) == pytest.approx(variance, rel=1e-6)


def noise() -> np.ndarray:
    return circular_gaussian(np.random.default_rng(1), (400, COUNT // 400))


def test_noise_has_unit_variance_and_no_mean() -> None:
    v = noise()
    assert v.shape == (400, COUNT // 400)
    assert v.dtype == np.complex128
    assert np.mean(np.abs(v) ** 2) == pytest.approx(1, abs=FIVE_SIGMA)  # |v|^2 has variance 1
    assert abs(np.mean(v)) < FIVE_SIGMA


def test_noise_is_circular() -> None:
    v = noise()
    assert abs(np.mean(v**2)) < 2 * FIVE_SIGMA  # v^2 has variance 2
    assert np.var(v.real) == pytest.approx(0.5, abs=FIVE_SIGMA)
    assert np.var(v.imag) == pytest.approx(0.5, abs=FIVE_SIGMA)


def test_noise_is_gaussian() -> None:
    v = noise()
    # E|v|^4 = 2, with variance 4! - 2^2 = 20; P(|v|^2 > 3) = exp(-3).
    assert np.mean(np.abs(v) ** 4) == pytest.approx(2, abs=np.sqrt(20) * FIVE_SIGMA)
    assert np.mean(np.abs(v) ** 2 > 3) == pytest.approx(np.exp(-3), abs=FIVE_SIGMA)


def test_noise_is_white_along_both_axes() -> None:
    v = noise()
    assert abs(np.mean(v[1:] * v[:-1].conj())) < FIVE_SIGMA
    assert abs(np.mean(v[:, 1:] * v[:, :-1].conj())) < FIVE_SIGMA


def test_the_same_stream_gives_the_same_noise() -> None:
    np.testing.assert_array_equal(noise(), noise())
