"""The closed form: y[m] = sum_i A_i exp(-j 2 pi f0 tau_i) G(K tau_i/fs), without a beat matrix.

Paths are computed at knots and interpolated to the pulses, G is read from a table, phasors may be
single precision, as the tolerance has it (accuracy.py, docs/engines.md). Paths that do not move
are left out where the canceller removes them.
"""

from dataclasses import dataclass
from functools import cached_property
from math import frexp
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from radhar_cli.arrays import Bool, Complex, Float, Index
from radhar_cli.echo.accuracy import (
    FINEST_DB,
    MARGIN_DB,
    SPARE_DB,
    AccuracyError,
    Settings,
    measured_db,
    settings,
)
from radhar_cli.echo.beat import start_phase
from radhar_cli.echo.half_band_sum import half_band_table
from radhar_cli.echo.interpolation import (
    AFTER,
    BEFORE,
    REACH,
    TAPS,
    lagrange_weights,
    stencils,
)
from radhar_cli.echo.knots import Knots, Motion, resolve
from radhar_cli.echo.paths import Paths, PathSource
from radhar_cli.radar.waveform import Waveform

BLOCK = 2**16  # values at work at once: they stay in the cache
BLOCK_SEGMENTS = 2048

Real = NDArray[np.floating]


class Accuracy(NamedTuple):
    """How a slow-time signal was made, and its error.

    Attributes:
        step: pulses from knot to knot; 1 where paths are taken at every pulse.
        table_oversampling: points of the table of G per fast-time sample.
        single: whether sines and cosines are single precision.
        error_db: measured relative L2 error after the canceller.
    """

    step: int
    table_oversampling: int
    single: bool
    error_db: float


@dataclass(frozen=True)
class DirectEcho:
    """The slow-time signal of a source of paths, without noise.

    Attributes:
        source: the paths.
        waveform: the radar.
        tolerance_db: largest relative L2 error after the canceller.
        double: keep to double precision whatever the tolerance.
        canceller: c of x[m] = sum_j c[j] y[m + j], in which the signal will be seen.
    """

    source: PathSource
    waveform: Waveform
    tolerance_db: float
    double: bool = False
    canceller: tuple[float, ...] = (-1.0, 1.0)

    def signal_power(self) -> float:
        """P_s = mean over the pulses of sum_i A_i^2."""
        return self._motion.power

    def slow_time(self) -> tuple[Complex, Accuracy]:
        """y[m] [M] before the canceller, less what that removes exactly; and its accuracy.

        Raises:
            AccuracyError: the tolerance is below what float64 leaves of this signal.
        """
        aim, best = self._aim, 0.0
        chosen, motion = self._settings(aim), self._motion
        while True:
            unit = 2.0 ** frexp(motion.largest)[1]
            y = self._sum(chosen, motion, unit)
            error = measured_db(y, self.source, self.waveform, self.canceller, unit)
            best = min(best, error)
            if error <= self.tolerance_db - SPARE_DB:
                y *= unit
                return y, Accuracy(motion.step, *chosen[1:], error)
            if chosen.single:
                chosen = chosen._replace(single=False)
                continue
            if aim == FINEST_DB:
                raise AccuracyError(best + SPARE_DB)
            aim = max(aim - max(2 * MARGIN_DB, error - self.tolerance_db), FINEST_DB)
            chosen = self._settings(aim)._replace(single=False)
            motion = resolve(self.source, self.waveform, chosen.spacing)

    @property
    def _aim(self) -> float:
        return max(self.tolerance_db - MARGIN_DB, FINEST_DB)

    @cached_property
    def _motion(self) -> Motion:
        return resolve(self.source, self.waveform, self._settings(self._aim).spacing)

    def _settings(self, aim_db: float) -> Settings:
        chosen = settings(aim_db, self.waveform, self.source.highest_frequency)
        return chosen._replace(single=chosen.single and not self.double)

    def _sum(self, chosen: Settings, motion: Motion, unit: float) -> Complex:
        y = np.zeros(self.waveform.n_pulses, dtype=complex)
        kept: Bool = motion.moving | (sum(self.canceller) != 0)
        if kept.any():
            for knots in motion.knots(self.source, self.waveform):
                first, last = knots.pulses
                self._sum_knots(chosen, knots, kept, unit, y[first:last])
        return y

    def _sum_knots(
        self, chosen: Settings, knots: Knots, kept: Bool, unit: float, y: Complex
    ) -> None:
        """Fill y with the sum of the paths at the pulses of these knots."""
        real = np.float32 if chosen.single else np.float64
        terms = self._terms(knots.paths, kept, unit, chosen.table_oversampling)
        if knots.step == 1:
            size = max(1, BLOCK // terms.shape[1])
            for start in range(0, y.size, size):
                part = terms[..., start : start + size]
                y[start : start + size] = _phasor_sum(*part.astype(real))
            return
        dense = np.empty((knots.step, knots.shift.size), dtype=complex)
        for start in range(0, knots.shift.size, BLOCK_SEGMENTS):
            shift = knots.shift[start : start + BLOCK_SEGMENTS]
            part = terms[..., start : start + shift.size + BEFORE + AFTER]
            dense[:, start : start + shift.size] = _interpolated_sum(part, shift, knots.step, real)
        y[:] = dense.T.reshape(-1)[: y.size]
        if knots.exact_pulses.size:
            exact = self._terms(knots.exact, kept, unit, chosen.table_oversampling)
            y[knots.exact_pulses - knots.pulses[0]] = _phasor_sum(*exact)

    def _terms(self, paths: Paths, kept: Bool, unit: float, oversampling: int) -> Float:
        """Phase f0 tau (cycles), Re and Im of A G over the unit: [3, I, M] of the kept paths."""
        w = self.waveform
        delay, amplitude = paths if kept.all() else (part[kept] for part in paths)
        g = half_band_table(w, oversampling)(w.slope / w.adc_rate * delay)
        amplitude = amplitude / unit
        terms = np.empty((3, *delay.shape))
        terms[0] = start_phase(delay, w, w.f0)
        np.multiply(g.real, amplitude, out=terms[1])
        np.multiply(g.imag, amplitude, out=terms[2])
        return terms


def _interpolated_sum(terms: Float, shift: Index, step: int, real: type[np.floating]) -> Complex:
    """sum_i (re + j im) exp(-j 2 pi phase) at the pulses of some segments [step, segments].

    Phases are interpolated as differences from the segment's first knot: they keep their digits
    in float32.

    Args:
        terms: phase, re, im at the knots [3, I, BEFORE + segments + AFTER].
        shift: of the stencils [segments].
        step: pulses from knot to knot.
        real: precision of the phasors.
    """
    weights = lagrange_weights(step).T.astype(real)  # [step, TAPS]
    to_phase = weights.copy()
    to_phase[:, REACH] = 1
    total = np.zeros((step, shift.size), dtype=complex)
    count = max(1, BLOCK // total.size)
    for path in range(0, terms.shape[1], count):
        values = stencils(terms[:, path : path + count], shift)  # [TAPS, 3, i, segments]
        anchor = values[REACH, 0].copy()
        values[:, 0] -= anchor
        values[REACH, 0] = anchor - np.rint(anchor)
        dense = np.empty((step, *values.shape[1:]), dtype=real)
        rounded = values.astype(real)
        for w, some in ((to_phase, slice(0, 1)), (weights, slice(1, 3))):
            part = (w @ rounded[:, some].reshape(TAPS, -1)).reshape(step, -1, *values.shape[2:])
            dense[:, some] = part
        total += _phasor_sum(dense[:, 0], dense[:, 1], dense[:, 2])
    return total


def _phasor_sum(cycles: Real, re: Real, im: Real) -> Complex:
    """sum_i (re + j im) exp(-j 2 pi cycles) over the last axis but one."""
    angle = cycles - np.rint(cycles)
    angle *= angle.dtype.type(2 * np.pi)
    cos, sin = np.cos(angle), np.sin(angle)
    total = np.empty(angle.shape[:-2] + angle.shape[-1:], dtype=complex)
    total.real = np.einsum("...im,...im->...m", re, cos) + np.einsum("...im,...im->...m", im, sin)
    total.imag = np.einsum("...im,...im->...m", im, cos) - np.einsum("...im,...im->...m", re, sin)
    return total
