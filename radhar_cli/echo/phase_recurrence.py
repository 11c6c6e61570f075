"""exp(-j 2 pi phase) at the pulses between knots, where phases are polynomials of low degree.

A polynomial of degree d follows from its differences by additions alone: p(m + 1) = p(m) + Dp(m),
Dp(m + 1) = Dp(m) + D2p(m), and so on up to D^d p, which is constant. Phasors multiply where phases
add, so that every further pulse takes d complex multiplications instead of a sine and a cosine.
"""

from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from radhar_cli.echo.interpolation import NODES, REACH, TAPS, lagrange_basis
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.numerics.phasor import unit_phasor

# A rounding of D2p, 1e-7 in single precision, grows with the square of the pulses since the start.
MAX_RUN = 20


def nodes(degree: int, length: int) -> Float:
    """Nodes of a polynomial of `degree` over pulses 0 .. length - 1.

    They are Chebyshev points, or all pulses where these are as few.
    """
    count = min(degree + 1, length)
    if count == length:
        return np.arange(float(length))
    middle = (length - 1) / 2
    places: Float = middle - middle * np.cos(np.pi * (np.arange(count) + 0.5) / count)
    return places


def run_length(step: int) -> int:
    """Pulses of each of the equal runs that a segment of `step` pulses is divided into."""
    return -(-step // -(-step // MAX_RUN))


class Runs(NamedTuple):
    """A segment in equal runs of pulses, each with a polynomial of its own."""

    length: int  # pulses of a run; the last may go beyond the segment
    # p, Dp, ... D^d p at the first pulse of each run, of the phases at the knots -2 .. 3 of the
    # segment [runs, d + 1, TAPS]
    differences: Float


@lru_cache(maxsize=128)
def runs(step: int, degree: int) -> Runs:
    """Runs of a segment of `step` pulses; polynomials through d + 1 Chebyshev points of each.

    Of degree TAPS - 1 they are the polynomial through the knots itself.
    """
    length = run_length(step)
    count = -(-step // length)
    places = nodes(degree, length)
    order = np.arange(places.size)
    to_pulses = lagrange_basis(places, order.astype(float)).T
    first = length * np.arange(count)[:, None]
    to_points = lagrange_basis(NODES, ((first + places) / step).ravel()).T
    to_points = to_points.reshape(count, order.size, TAPS)
    values = to_pulses @ to_points
    return Runs(
        length, np.stack([np.diff(values, k, axis=1)[:, 0] for k in range(order.size)], axis=1)
    )


def phasors_between_knots(cycles: Float, step: int, degree: int, dtype: Any) -> Complex:
    """Phasors exp(-j 2 pi phase) at the pulses of all segments [step, segments, I].

    Args:
        cycles: Phases at the knots -2 .. 3 of every segment [TAPS, segments, I], cycles.
        step: Number of pulses of a segment.
        degree: Degree d of the polynomials.
        dtype: Complex type of the result.
    """
    length, differences = runs(step, degree)
    shape = (*differences.shape[:2], *cycles.shape[1:])
    anchor = cycles[REACH]
    turns = differences.reshape(-1, TAPS) @ (cycles - anchor).reshape(TAPS, -1)
    turns = turns.reshape(shape)
    turns[:, 0] += anchor
    factors = unit_phasor(turns, dtype)
    phasors = np.empty((len(factors), length, *shape[2:]), dtype)
    phasors[:, 0] = factors[:, 0]
    for pulse in range(1, length):
        np.multiply(phasors[:, pulse - 1], factors[:, 1], out=phasors[:, pulse])
        for order in range(1, shape[1] - 1):
            np.multiply(factors[:, order], factors[:, order + 1], out=factors[:, order])
    return phasors.reshape(-1, *shape[2:])[:step]
