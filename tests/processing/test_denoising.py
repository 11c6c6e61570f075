"""Savitzky-Golay smoothing of a complex signal."""

import numpy as np
import pytest
from scipy.signal import savgol_filter

from radhar_cli.processing.denoising import savgol


def random_signal(length: int) -> np.ndarray:
    return np.random.default_rng(0).standard_normal((length, 2)).view(complex)[:, 0]


@pytest.mark.parametrize(("order", "frame"), [(5, 11), (0, 1), (2, 7), (3, 61)])
def test_real_and_imaginary_part_alike(order, frame):
    x = random_signal(61)
    found = savgol(x, order, frame)
    for mine, part in ((found.real, x.real), (found.imag, x.imag)):
        right = savgol_filter(part, frame, order, mode="interp")
        assert mine == pytest.approx(right, rel=1e-12, abs=1e-12)


def test_a_polynomial_of_its_order_passes_ends_included():
    """The edge mode `interp` continues the fit of the last frame."""
    t = np.linspace(-1, 1, 100)
    x = t**5 - 2j * t**4 + 3 * t
    assert savgol(x, 5, 11) == pytest.approx(x, abs=1e-12)


@pytest.mark.parametrize(("fraction", "least_db", "most_db"), [(0.0, 0, 0), (0.32, -3.2, -2.8)])
def test_order_5_frame_11_is_a_low_pass_at_a_third_of_the_band(fraction, least_db, most_db):
    tone = np.exp(1j * np.pi * fraction * np.arange(400))
    gain = np.abs(savgol(tone, 5, 11)[200])
    assert least_db - 1e-9 <= 20 * np.log10(gain) <= most_db + 1e-9


def test_it_does_not_shift_the_signal():
    """Symmetric coefficients: a pulse stays where it is, signs of Doppler are treated equally."""
    pulse = np.zeros(41, complex)
    pulse[20] = 1 + 2j
    out = savgol(pulse, 5, 11)
    assert np.abs(out).argmax() == 20
    assert out == pytest.approx(out[::-1], abs=1e-14)
    assert np.count_nonzero(np.abs(out) > 1e-12) == 11
