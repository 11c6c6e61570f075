"""Phasors between knots by multiplication, against the exponential itself."""

import numpy as np
import pytest

from radhar_cli.echo.interpolation import NODES, TAPS
from radhar_cli.echo.phase_recurrence import MAX_RUN, phasors_between_knots, runs

SEGMENTS, PATHS = 3, 4


def polynomials(step: int, sizes: list[float]) -> tuple[np.ndarray, np.ndarray]:
    """Phases (cycles) at knots [TAPS, ...] and at the pulses [step, ...]: random coefficients."""
    c = np.random.default_rng(step).uniform(-1, 1, (len(sizes), SEGMENTS, PATHS))
    c *= np.array(sizes)[:, None, None]
    at = np.arange(step) / step
    return tuple(np.stack([np.polyval(c, x) for x in places]) for places in (NODES, at))


steps = pytest.mark.parametrize("step", [3, 4, 6, 7, 19, 20, 21, 40, 77])


@steps
def test_a_polynomial_of_degree_five_is_exact(step):
    knots, pulses = polynomials(step, [3.0, 3.0, 3.0, 3.0, 3.0, 2000.0])
    found = phasors_between_knots(knots, step, TAPS - 1, np.complex128)
    assert (
        np.abs(found - np.exp(-2j * np.pi * pulses)).max() < 3e-9
    )  # of hundreds of cycles from knot to knot


@steps
def test_a_cubic_in_single_precision(step):
    """Half a cycle of curvature from knot to knot: more than a limb's at 140 GHz. A rounding of
    1e-7 in D2p counts 20 * 19/2 times at the end of a run, one in D3p 20 * 19 * 18/6 times."""
    knots, pulses = polynomials(step, [0.05, 0.5, 20.0, 2000.0])
    found = phasors_between_knots(knots, step, 3, np.complex64)
    assert found.dtype == np.complex64
    assert np.abs(found - np.exp(-2j * np.pi * pulses)).max() < 1e-4


@pytest.mark.parametrize("step", [5, 12, 19, 50])
def test_a_cubic_errs_by_what_chebyshev_leaves(step):
    """Of c s^4 over a run, half its length to either side: c/8, as of T4."""
    c = 0.01
    found = phasors_between_knots((c * NODES**4)[:, None, None], step, 3, np.complex128)
    length, _ = runs(step, 3)
    right = np.exp(-2j * np.pi * c * (np.arange(step) / step) ** 4)
    error = np.abs(found[:, 0, 0] - right).max()
    assert error < 2 * np.pi * c / 8 * ((length - 1) / 2 / step) ** 4 * 1.01
    assert error > 1e-9


@pytest.mark.parametrize("step", range(3, 90))
def test_runs_are_short_and_cover_the_segment(step):
    length, differences = runs(step, 3)
    assert length <= MAX_RUN
    assert len(differences) * length - step < len(differences)
