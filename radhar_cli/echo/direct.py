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
    REFINE_DB,
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
    lagrange_weights,
    stencils,
)
from radhar_cli.echo.knots import Knots, Motion, resolve
from radhar_cli.echo.paths import Paths, PathSource
from radhar_cli.radar.waveform import Waveform

BLOCK = 2**16  # values at work at once: they stay in the cache
BLOCK_SEGMENTS = 256

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
            # Paths at every pulse cost so much that single precision saves nothing.
            chosen = chosen._replace(single=chosen.single and motion.step > 1)
            unit = 2.0 ** frexp(motion.largest)[1]
            y = self._sum(chosen, motion, unit)
            exact = motion.at_pulses(self.source, self.waveform)
            error = measured_db(y, exact, self.waveform, self.canceller, unit)
            best = min(best, error)
            if error <= self.tolerance_db - SPARE_DB:
                y *= unit
                return y, Accuracy(motion.step, *chosen[1:], error)
            if aim == FINEST_DB:
                raise AccuracyError(best + SPARE_DB)
            aim = max(aim - max(REFINE_DB, error - self.tolerance_db), FINEST_DB)
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
        """Add the sum of the paths at the pulses of these knots to y, some paths at a time."""
        real = np.float32 if chosen.single else np.float64
        parts = y.view(float).reshape(-1, 2).T  # Re and Im of y
        moving = np.flatnonzero(kept)
        count = max(1, BLOCK // knots.paths.delay.shape[1])
        for start in range(0, moving.size, count):
            some = moving[start : start + count]
            terms = self._terms(knots.paths, some, unit, chosen.table_oversampling)
            if knots.step == 1:
                parts += _phasor_sum(terms[0], *terms[1:])
                continue
            dense = _interpolated_sum(terms, knots.shift, knots.step, real)
            if knots.exact_pulses.size:
                exact = self._terms(knots.exact, some, unit, chosen.table_oversampling)
                dense[:, knots.exact_pulses - knots.pulses[0]] = _phasor_sum(exact[0], *exact[1:])
            parts += dense[:, : y.size]

    def _terms(self, paths: Paths, some: Index, unit: float, oversampling: int) -> Float:
        """Phase 2 pi f0 tau, Re and Im of A G over the unit: [3, I, M] of some paths."""
        w = self.waveform
        delay, amplitude = (part[some] for part in paths)
        g = half_band_table(w, oversampling)(w.slope / w.adc_rate * delay)
        amplitude /= unit
        terms = np.empty((3, *delay.shape))
        np.multiply(start_phase(delay, w, w.f0), 2 * np.pi, out=terms[0])
        np.multiply(g.real, amplitude, out=terms[1])
        np.multiply(g.imag, amplitude, out=terms[2])
        return terms


def _interpolated_sum(terms: Float, shift: Index, step: int, real: type[np.floating]) -> Float:
    """Re and Im of sum_i (re + j im) exp(-j phase) at the pulses [2, segments * step].

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
    total = np.zeros((2, step, shift.size))
    envelope = terms[1:].astype(real)
    for start in range(0, shift.size, BLOCK_SEGMENTS):
        within = shift[start : start + BLOCK_SEGMENTS]
        reach = slice(start, start + within.size + BEFORE + AFTER)
        count = max(1, BLOCK // (step * within.size))
        for path in range(0, terms.shape[1], count):
            some = slice(path, path + count)
            phase = stencils(terms[0, some, reach], within)  # [i, TAPS, segments]
            anchor = phase[:, REACH].copy()
            phase -= anchor[:, None]
            phase[:, REACH] = np.mod(anchor, 2 * np.pi)
            angle = to_phase @ phase.astype(real)  # [i, step, segments]
            re, im = weights @ stencils(envelope[:, some, reach], within)
            total[..., start : start + within.size] += _phasor_sum(angle, re, im)
    return total.swapaxes(1, 2).reshape(2, -1)


def _phasor_sum(angle: Real, re: Real, im: Real) -> Real:
    """Re and Im of sum_i (re + j im) exp(-j angle) [2, ...], of [I, ...]; angles are spent."""
    shape = (len(angle), -1)
    cos, sin = np.cos(angle).reshape(shape), np.sin(angle, out=angle).reshape(shape)
    a, b = re.reshape(shape), im.reshape(shape)
    total = np.empty((2, *angle.shape[1:]), dtype=angle.dtype)
    x, y = total.reshape(2, -1)
    np.add(np.einsum("im,im->m", a, cos), np.einsum("im,im->m", b, sin), out=x)
    np.subtract(np.einsum("im,im->m", b, cos), np.einsum("im,im->m", a, sin), out=y)
    return total
