"""The sum over paths from their knots in two loops, compiled by numba where that is installed.

The same sum as `direct` makes with NumPy of cubic phases, of the same polynomials, within
rounding. It is faster as nothing but the sum is stored, and as sines and cosines are polynomials
too, which a processor computes for eight paths or more at once.
"""

from collections.abc import Callable
from functools import lru_cache
from typing import Any

import numpy as np
from numpy.polynomial import Polynomial

from radhar_cli.echo.half_band_sum import HalfBandTable
from radhar_cli.echo.interpolation import (
    BEFORE,
    NO_STENCIL,
    NODES,
    REACH,
    TAPS,
    lagrange_basis,
    shifted_weights,
)
from radhar_cli.echo.paths import Paths
from radhar_cli.echo.phase_recurrence import nodes, runs
from radhar_cli.numerics.accelerators import installed, machine_code
from radhar_cli.numerics.arrays import Complex, Float, Index

TERMS = 4  # coefficients of a cubic
LANES = 16  # paths per SIMD batch; a remainder would be computed one by one
MIN_TERMS = 2**17  # terms of a sum; with fewer, numba takes longer to load than 300 sums save


def pays(terms: int) -> bool:
    """Whether a sum of that many terms, paths times pulses, is worth compiled code."""
    return terms >= MIN_TERMS and installed("numba") is not None


def interpolated_sum(
    paths: Paths, numbers: Index, unit: float, table: HalfBandTable, shift: Index, step: int
) -> Complex:
    """Sum of A_i G_i exp(-j 2 pi f0 tau_i) over paths, at the pulses between knots.

    Args:
        paths: Paths at the knots.
        numbers: Numbers of the paths that are summed.
        unit: Amplitude in which the result is given.
        table: Table of G.
        shift: Shift of each segment's stencil [segments].
        step: Number of pulses of a segment.

    Returns:
        The sum [segments * step].
    """
    shape, real_type = (paths.delay.shape[1], numbers.size), table.polynomials[0].real.dtype
    cycles, real, imag = np.empty(shape), *np.empty((2, *shape), real_type)
    scale = _scale(table, unit)
    machine_code(_at_knots)(*paths[:2], numbers, scale, table.polynomials, cycles, real, imag)
    total = np.zeros(shift.size * step, dtype=complex)
    to_phase, x = _cubics(step)
    of_envelope = (part.astype(real_type) for part in (to_phase, x))
    series = _series(real_type)
    machine_code(_add)(cycles, real, imag, shift, to_phase, *of_envelope, *series, total)
    return total


def sum_at(paths: Paths, numbers: Index, unit: float, table: HalfBandTable) -> Complex:
    """Sum of A_i G_i exp(-j 2 pi f0 tau_i) over paths at the times of the paths [M].

    Args:
        paths: Paths at M times.
        numbers: Numbers of the paths that are summed.
        unit: Amplitude in which the result is given.
        table: Table of G.
    """
    total = np.zeros(paths.delay.shape[1], dtype=complex)
    series = _series(table.polynomials[0].real.dtype)
    machine_code(_add_at)(
        *paths[:2], numbers, _scale(table, unit), table.polynomials, *series, total
    )
    return total


def _scale(table: HalfBandTable, unit: float) -> tuple[float, float, float, float, bool]:
    """Factors of tau and tau^2 in a phase, of tau in u, of amplitudes; whether G changes sign."""
    w = table.waveform
    square = 0.5 * w.slope if w.residual_video_phase else 0.0
    return w.f0, square, w.slope / w.adc_rate, 1 / unit, bool(w.n0 % 1)


def _series(real_type: np.dtype[Any]) -> tuple[tuple[np.floating, ...], ...]:
    """Coefficients of the sine and of the cosine, in some precision."""
    sine, cosine = (tuple(part.astype(real_type)) for part in (SINE, COSINE))
    return sine, cosine


def _fitted(function: Callable[[Float], Float], power: int) -> Float:
    """Coefficients c_k of function(2 pi r) = sum c_k r^(2 k + power), for |r| <= 1/2."""
    r = np.sqrt(0.126 * (1 - np.cos(np.pi * (np.arange(64) + 0.5) / 64)))
    fit = Polynomial.fit(r * r, function(2 * np.pi * r) / r**power, 6)
    return fit.convert().coef.astype(float)


SINE, COSINE = _fitted(np.sin, 1), _fitted(np.cos, 0)


@lru_cache(maxsize=128)
def _cubics(step: int) -> tuple[Float, Float]:
    """Cubics of the runs of a segment, through Chebyshev points of each.

    Returns:
        Weights from the knots of a stencil with shift -REACH .. REACH to the coefficients of x^k
        [runs, 2 REACH + 1, TERMS, TAPS]; and x at the pulses of a run [length], -1 to 1.
    """
    length, differences = runs(step, TERMS - 1)
    places, x = nodes(TERMS - 1, length), np.linspace(-1, 1, length)
    powers = np.vander(2 * places / (length - 1) - 1, TERMS, increasing=True)
    to_powers = np.zeros((len(differences), 2 * REACH + 1, TERMS, TAPS))
    for run, shift in np.ndindex(to_powers.shape[:2]):
        values = lagrange_basis(NODES, (run * length + places) / step).T
        to_powers[run, shift] = np.linalg.pinv(powers) @ values @ shifted_weights(shift - REACH)
    return to_powers, x


def _at_knots(
    delay: Float,
    amplitude: Float,
    numbers: Index,
    scale: tuple[float, float, float, float, bool],
    table: tuple[Complex, ...],
    cycles: Float,
    real: Float,
    imag: Float,
) -> None:
    """Fill in phases (cycles) and real and imaginary parts of A G at knots [knots, I]."""
    f0, square, turn, per_unit, alternating = scale
    value, slope, curve, cube = table
    for i in range(numbers.size):
        for k in range(delay.shape[1]):
            tau = delay[numbers[i], k]
            cycles[k, i] = f0 * tau - square * tau * tau
            period = np.floor(turn * tau)
            place = (turn * tau - period) * value.size
            cell = min(max(int(place), 0), value.size - 1)
            s = real.dtype.type(place - cell)
            a = real.dtype.type(amplitude[numbers[i], k] * per_unit)
            if alternating and period % 2 != 0:
                a = -a
            g = value[cell] + s * (slope[cell] + s * (curve[cell] + s * cube[cell]))
            real[k, i] = a * g.real
            imag[k, i] = a * g.imag


def _add_at(
    delay: Float,
    amplitude: Float,
    numbers: Index,
    scale: tuple[float, float, float, float, bool],
    table: tuple[Complex, ...],
    sine: tuple[np.floating, ...],
    cosine: tuple[np.floating, ...],
    total: Complex,
) -> None:
    """Add the sum over paths at the times of the paths."""
    f0, square, turn, per_unit, alternating = scale
    value, slope, curve, cube = table
    s0, s1, s2, s3, s4, s5, s6 = sine
    c0, c1, c2, c3, c4, c5, c6 = cosine
    unity = s0 / s0
    for i in range(numbers.size):
        for k in range(delay.shape[1]):
            tau = delay[numbers[i], k]
            cycles = f0 * tau - square * tau * tau
            period = np.floor(turn * tau)
            place = (turn * tau - period) * value.size
            cell = min(max(int(place), 0), value.size - 1)
            t = unity * (place - cell)
            a = amplitude[numbers[i], k] * per_unit
            if alternating and period % 2 != 0:
                a = -a
            g = value[cell] + t * (slope[cell] + t * (curve[cell] + t * cube[cell]))
            r = cycles - np.rint(cycles)
            u = r * r
            s = r * (s0 + u * (s1 + u * (s2 + u * (s3 + u * (s4 + u * (s5 + u * s6))))))
            c = c0 + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * (c5 + u * c6)))))
            total[k] += a * complex(g.real * c + g.imag * s, g.imag * c - g.real * s)


def _add(
    cycles: Float,
    real: Float,
    imag: Float,
    shift: Index,
    to_phase: Float,
    to_envelope: Float,
    x: Float,
    sine: tuple[np.floating, ...],
    cosine: tuple[np.floating, ...],
    total: Complex,
) -> None:
    """Fill in the sum at the pulses of all segments but those with NO_STENCIL."""
    paths, step, length = cycles.shape[1], total.size // shift.size, x.size
    phase, re, im = np.zeros((3, TERMS, -(-paths // LANES) * LANES), x.dtype)
    s0, s1, s2, s3, s4, s5, s6 = sine
    c0, c1, c2, c3, c4, c5, c6 = cosine
    for segment in range(shift.size):
        if shift[segment] == NO_STENCIL:
            continue
        k = segment + BEFORE - REACH + shift[segment]
        for run in range(to_phase.shape[0]):
            for n in range(TERMS):
                w0, w1, w2, w3, w4, w5 = to_phase[run, shift[segment] + REACH, n]
                for i in range(paths):
                    y = cycles[k + 2, i]
                    p = w0 * (cycles[k, i] - y) + w1 * (cycles[k + 1, i] - y)
                    p += w3 * (cycles[k + 3, i] - y) + w4 * (cycles[k + 4, i] - y)
                    p += w5 * (cycles[k + 5, i] - y)
                    if n == 0:
                        p += y - np.rint(p + y)
                    phase[n, i] = p
                w0, w1, w2, w3, w4, w5 = to_envelope[run, shift[segment] + REACH, n]
                for i in range(paths):
                    y = w0 * real[k, i] + w1 * real[k + 1, i] + w2 * real[k + 2, i]
                    y += w3 * real[k + 3, i] + w4 * real[k + 4, i] + w5 * real[k + 5, i]
                    re[n, i] = y
                    y = w0 * imag[k, i] + w1 * imag[k + 1, i] + w2 * imag[k + 2, i]
                    y += w3 * imag[k + 3, i] + w4 * imag[k + 4, i] + w5 * imag[k + 5, i]
                    im[n, i] = y
            start = segment * step + run * length
            for m in range(min(length, step - run * length)):
                t = x[m]
                total_re = total_im = x.dtype.type(0)
                for i in range(re.shape[1]):
                    r = phase[0, i] + t * (phase[1, i] + t * (phase[2, i] + t * phase[3, i]))
                    r -= np.rint(r)
                    u = r * r
                    s = r * (s0 + u * (s1 + u * (s2 + u * (s3 + u * (s4 + u * (s5 + u * s6))))))
                    c = c0 + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * (c5 + u * c6)))))
                    a = re[0, i] + t * (re[1, i] + t * (re[2, i] + t * re[3, i]))
                    b = im[0, i] + t * (im[1, i] + t * (im[2, i] + t * im[3, i]))
                    total_re += a * c + b * s
                    total_im += b * c - a * s
                total[start + m] = complex(total_re, total_im)
