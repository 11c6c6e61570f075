"""Local Lagrange interpolation from knots to pulses."""

import numpy as np
import pytest

from radhar_cli.echo.interpolation import AFTER, BEFORE, upsample

steps = pytest.mark.parametrize("step", [1, 3, 4, 20])


def knot_places(segments: int, step: int) -> np.ndarray:
    """Pulse numbers of the knots, those beyond both ends included."""
    return np.arange(-BEFORE, segments + AFTER) * float(step)


@steps
def test_polynomial_of_degree_five_is_exact(step):
    coefficients = np.random.default_rng(2).standard_normal((3, 6))
    at, pulses = knot_places(7, step), np.arange(7 * step)
    knots = np.stack([np.polyval(c, at / at[-1]) for c in coefficients])
    right = np.stack([np.polyval(c, pulses / at[-1]) for c in coefficients])
    assert upsample(knots, step) == pytest.approx(right, abs=1e-13)


def test_degree_six_is_not():
    """Six taps fix a polynomial of degree five and no more: the remainder is the textbook's."""
    at, pulses = knot_places(7, 10) / 10, np.arange(70) / 10
    part = pulses - np.floor(pulses)
    remainder = np.prod([part - node for node in range(-BEFORE, AFTER + 1)], axis=0)
    assert upsample(at**6, 10) == pytest.approx(pulses**6 - remainder, rel=1e-10)


@steps
def test_knots_are_kept(step):
    knots = np.random.default_rng(3).standard_normal(20)
    assert upsample(knots, step)[::step] == pytest.approx(knots[BEFORE:-AFTER], abs=1e-14)


@pytest.mark.parametrize("cycles_per_knot", [0.01, 0.03, 0.1])
def test_error_of_a_sinusoid(cycles_per_knot):
    """At most 0.005 (2 pi f h)^6 of its amplitude, and not a tenth of it: the bound is sharp."""
    step, segments = 16, 400
    turn = 2 * np.pi * cycles_per_knot
    knots = np.sin(turn * knot_places(segments, step) / step)
    error = np.abs(upsample(knots, step) - np.sin(turn * np.arange(segments * step) / step)).max()
    bound = 0.005 * turn**6
    assert 0.1 * bound < error < bound + 1e-15


@pytest.mark.parametrize("kink", [0.0, 0.37, 5.0, 8.99, 17.5])
def test_a_kink_spoils_only_the_segments_that_reach_across_it(kink):
    """Else its neighbourhood alone could not be replaced by exact values."""
    step, segments = 10, 20
    pulses = np.arange(segments * step)

    def track(at):
        return np.where(at < kink, at**2, kink**2 + 3 * (at - kink))

    error = np.abs(upsample(track(knot_places(segments, step) / step), step) - track(pulses / step))
    segment = pulses // step
    reach = (segment - BEFORE < kink) & (kink < segment + AFTER)
    assert error[~reach].max() < 1e-12
    if kink % 1 > 0:
        assert error[reach].max() > 1e-3


def test_single_precision_is_single():
    knots = np.random.default_rng(4).standard_normal((2, 3, 30))
    single = upsample(knots, 5, np.float32)
    assert single.dtype == np.float32
    assert single == pytest.approx(upsample(knots, 5), abs=1e-5)
    assert single.shape == (2, 3, 25 * 5)
