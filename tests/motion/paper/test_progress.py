"""The raised-cosine progress P and its integral."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.motion.paper.progress import progress, progress_integral

STARTS = st.floats(-5, 5)
DURATIONS = st.one_of(st.just(0.0), st.floats(1e-3, 10))
# Cosines and times of order ten in doubles.
ROUNDING = 1e-14


def quadrature(t: float, start: float, duration: float) -> float:
    """Integral of (1 - cos)/2 up to t: Gauss-Legendre within the ramp, plainly 1 after it."""
    end = min(t, start + duration)
    if end <= start:
        ramp = 0.0
    else:
        nodes, weights = np.polynomial.legendre.leggauss(20)
        at = start + (end - start) * (nodes + 1) / 2
        p = (1 - np.cos(np.pi * (at - start) / duration)) / 2
        ramp = float(weights @ p) * (end - start) / 2
    return ramp + max(t - (start + duration), 0.0)


@given(STARTS, st.floats(1e-3, 10))
@settings(deadline=None, max_examples=50)
def test_progress_is_0_before_and_1_after_and_half_in_the_middle(s: float, d: float) -> None:
    t = s + d * np.array([-1e6, -0.5, 0.0, 0.5, 1.0, 1.5, 1e6])
    # Where a ramp is 1e-3 s long and starts at 5 s, t - s is known to 1e-12 of it.
    np.testing.assert_allclose(progress(t, s, d), [0, 0, 0, 0.5, 1, 1, 1], atol=1e-11)


def test_progress_between() -> None:
    t = np.array([0.25, 1 / 3, 0.75]) * 2 + 1
    expected = [(1 - np.sqrt(0.5)) / 2, 0.25, (1 + np.sqrt(0.5)) / 2]
    np.testing.assert_allclose(progress(t, 1.0, 2.0), expected, atol=ROUNDING)


@given(STARTS, DURATIONS)
@settings(deadline=None, max_examples=50)
def test_progress_never_goes_back(start: float, duration: float) -> None:
    p = progress(np.linspace(-6, 16, 1001), start, duration)
    assert np.all(np.diff(p) >= 0)
    assert p[0] == 0
    assert p[-1] == 1


@given(STARTS)
@settings(deadline=None, max_examples=30)
def test_duration_0_is_a_step(start: float) -> None:
    t = np.array([np.nextafter(start, -np.inf), start, np.nextafter(start, np.inf)])
    np.testing.assert_array_equal(progress(t, start, 0.0), [0, 1, 1])


@given(STARTS, DURATIONS, st.floats(-6, 20))
@settings(deadline=None, max_examples=100)
def test_the_integral_is_that_of_progress(start: float, duration: float, t: float) -> None:
    found = progress_integral(np.array([t]), start, duration)
    assert found[0] == pytest.approx(quadrature(t, start, duration), abs=ROUNDING)


@given(STARTS, DURATIONS, st.floats(0, 10))
@settings(deadline=None, max_examples=30)
def test_a_ramp_costs_half_its_length(start: float, duration: float, later: float) -> None:
    t = np.array([start + duration + later])
    assert progress_integral(t, start, duration)[0] == pytest.approx(
        duration / 2 + later, abs=ROUNDING
    )
