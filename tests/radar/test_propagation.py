"""Bistatic delay and amplitude of a path against the radar equation by hand."""

from math import pi, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.radar.propagation import amplitude, bistatic_delay, leg

# A few products and one root in doubles.
ROUNDING = 1e-14
C = 299_792_458.0


def test_legs_are_distances_and_leave_positions_alone() -> None:
    p = np.array([[4.0, 0.4], [-0.1, -0.1], [1.5, 3.5]])[:, :, None]
    before = p.copy()
    np.testing.assert_allclose(leg(p, (0.4, -0.1, 1.5)), [[3.6], [2.0]], rtol=ROUNDING)
    np.testing.assert_allclose(leg(p, (1.0, 3.9, 1.5)), [[5.0], [sqrt(20.36)]], rtol=ROUNDING)
    np.testing.assert_array_equal(p, before)


def test_delay_is_both_legs_at_the_speed_of_light() -> None:
    r_tx, r_rx = np.array([[3.0]]), np.array([[5.0]])
    assert bistatic_delay(r_tx, r_rx)[0, 0] == pytest.approx(8 / C, rel=ROUNDING, abs=0)
    assert bistatic_delay(r_tx, r_rx)[0, 0] == pytest.approx(26.6851e-9, rel=1e-5, abs=0)


def test_amplitude_of_the_papers_torso_by_hand() -> None:
    """At 77 GHz, 6 dBi, 1 m^2 and 2 m: P = G^2 lambda^2 sigma/((4 pi)^3 R^4)."""
    wavelength, gain = C / 77e9, 10**0.6
    power = gain**2 * wavelength**2 * 1.0 / ((4 * pi) ** 3 * 2.0**4)
    assert power == pytest.approx(7.567e-9, rel=1e-3, abs=0)
    r = np.array([[2.0]])
    found = amplitude(r, r, np.array([1.0]), gain, wavelength)
    assert found[0, 0] ** 2 == pytest.approx(power, rel=ROUNDING, abs=0)


@given(
    st.floats(0.05, 100),
    st.floats(0.05, 100),
    st.floats(0.01, 10),
    st.floats(0.01, 100),
    st.floats(1e-3, 1),
)
@settings(deadline=None, max_examples=60)
def test_amplitude_is_the_bistatic_radar_equation(
    r_tx: float, r_rx: float, sigma: float, gain: float, wavelength: float
) -> None:
    expected = sqrt(gain * gain * wavelength**2 * sigma / (4 * pi) ** 3) / (r_tx * r_rx)
    found = amplitude(np.array([[r_tx]]), np.array([[r_rx]]), np.array([sigma]), gain, wavelength)
    assert found[0, 0] == pytest.approx(expected, rel=ROUNDING, abs=0)


def test_every_scatterer_keeps_its_own_rcs_over_time() -> None:
    r = np.array([[1.0, 2.0, 3.0], [1.0, 2.0, 3.0]])
    a = amplitude(r, r, np.array([[1.0], [4.0]]), 1.0, 1.0)
    assert a.shape == (2, 3)
    np.testing.assert_allclose(a[1], 2 * a[0], rtol=ROUNDING)
    np.testing.assert_allclose(a[0] * r[0] ** 2, a[0, 0], rtol=ROUNDING)
