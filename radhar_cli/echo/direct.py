"""The closed form: y[m] = sum_i A_i exp(-j 2 pi f0 tau_i) G(K tau_i/fs), without a beat matrix.

Paths are computed at knots and interpolated to the pulses, G is read from a table, phasors follow
from one another by multiplication, maybe in single precision, as the tolerance has it (accuracy.py,
docs/physics/engines.md). Paths that do not move are left out where the canceller removes them.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from functools import cached_property, lru_cache
from math import frexp
from typing import ClassVar, NamedTuple

import numpy as np

from radhar_cli.echo import compiled
from radhar_cli.echo.accuracy import (
    MIN_AIM_DB,
    REFINE_DB,
    SINGLE_DB,
    SPARE_DB,
    AccuracyError,
    Settings,
    first_aim,
    measured_db,
    settings,
    target_error_db,
)
from radhar_cli.echo.beat import start_phase
from radhar_cli.echo.half_band_sum import half_band_table
from radhar_cli.echo.interpolation import AFTER, BEFORE, NODES, TAPS, lagrange_basis, stencils
from radhar_cli.echo.knots import MIN_STEP, Knots, PathsAtKnots, Spacing, resolve, select_paths
from radhar_cli.echo.paths import Paths, PathSource
from radhar_cli.echo.phase_recurrence import nodes, phasors_between_knots
from radhar_cli.numerics.arrays import Bool, Complex, Float, Index
from radhar_cli.numerics.phasor import unit_phasor
from radhar_cli.processing.canceller import FIRST_DIFFERENCE, Canceller, Fir
from radhar_cli.processing.look import Look, RangeSum
from radhar_cli.radar.fmcw import Waveform

# Values at work at once, which stay in the cache: at knots and at pulses; of phasors, of which some
# twenty follow from each; and at knots from which those follow.
BLOCK, PHASORS, CHUNK = 2**15, 2**13, 2**20
CUBIC = 3  # degree of phases between knots
# Rounding of slowly turning phasors in float32, and by how much it must stay below the tolerance.
SINGLE_ROUNDING_DB, ROUNDING_SPARE_DB = -132.0, 10.0
SAMPLED = 64
# Largest amplitude at the knots from which float32 holds any amplitude between them in its units.
FAINTEST_SINGLE = 1e-30


class Accuracy(NamedTuple):
    """Settings by which a slow-time signal was made, and its error."""

    step: int  # pulses from knot to knot; 1 where paths are taken at every pulse
    table_oversampling: int  # points of the table of G per fast-time sample
    single: bool  # whether phasors between knots are single precision
    error_db: float  # measured relative L2 error after the canceller


@dataclass(frozen=True)
class DirectEcho:
    """The slow-time signal of a source of paths, without noise."""

    source: PathSource  # the paths
    waveform: Waveform  # the radar
    tolerance_db: float  # largest relative L2 error after the canceller
    double: bool = False  # keep to double precision whatever the tolerance
    canceller: Canceller = FIRST_DIFFERENCE  # after which the signal will be seen
    min_step: ClassVar[int] = MIN_STEP  # fewest pulses from knot to knot

    def signal_power(self) -> float:
        """Mean P_s over the pulses of sum_i A_i^2."""
        return self._motion.power

    @property
    def look(self) -> Look:
        """Look at the echo that is made: the coherent sum over range."""
        return Look.of_all("slow_time", RangeSum(self.waveform))

    def rows(self) -> tuple[Complex, Accuracy]:
        """Signal of `slow_time` with the rows of `look` [K, M], and its accuracy."""
        y, accuracy = self.slow_time()
        return np.atleast_2d(y), accuracy

    def slow_time(self) -> tuple[Complex, Accuracy]:
        """Signal y [M] before the canceller, less what that removes exactly; and its accuracy.

        Raises:
            AccuracyError: The tolerance is below what float64 leaves of this signal.
        """
        y, accuracy = min(self._attempts(), key=lambda attempt: attempt[1].error_db)
        if accuracy.error_db > self.tolerance_db - SPARE_DB:
            raise AccuracyError(min(accuracy.error_db, 0.0) + SPARE_DB)
        return y, accuracy

    def _attempts(self) -> Iterator[tuple[Complex, Accuracy]]:
        """Signals of ever finer settings and their accuracies, until one will do.

        It is within the tolerance or, where that is looser, the default.
        """
        target_db = target_error_db(self.tolerance_db)
        aim = first_aim(self.tolerance_db)
        chosen, motion = self._settings(aim), self._motion
        while True:
            is_faint = 0 < motion.largest < FAINTEST_SINGLE
            chosen = chosen._replace(
                single=chosen.single and not is_faint and self._single_will_do(motion)
            )
            unit = 2.0 ** frexp(motion.largest)[1]
            y = self._sum(chosen, motion, unit)
            error = self._error(y, motion, unit)
            y *= unit
            yield y, Accuracy(motion.step, chosen.table_oversampling, chosen.single, error)
            # NaN is that of a signal that is no number
            if not error > target_db - SPARE_DB or aim == MIN_AIM_DB:
                return
            aim = max(aim - max(REFINE_DB, error - target_db), MIN_AIM_DB)
            chosen = self._settings(aim)._replace(single=False)
            motion = self._resolved(chosen.spacing)

    @cached_property
    def _motion(self) -> PathsAtKnots:
        return self._resolved(self._settings(first_aim(self.tolerance_db)).spacing)

    def _resolved(self, spacing: Spacing) -> PathsAtKnots:
        return resolve(self.source, self.waveform, spacing, self.min_step)

    def _settings(self, aim_db: float) -> Settings:
        chosen = settings(aim_db, self.waveform, self.source.highest_frequency)
        if self.double:
            return chosen._replace(single=False, cubic=False)
        return chosen._replace(single=chosen.single and first_aim(self.tolerance_db) >= SINGLE_DB)

    def _error(self, y: Complex, motion: PathsAtKnots, unit: float) -> float:
        """Measured relative L2 error (dB) of y, in units of `unit`, after the canceller."""
        exact = self._exact(motion)
        return measured_db(y, exact, self.waveform, self.canceller, unit, motion.roughness)

    def _exact(self, motion: PathsAtKnots) -> Callable[[Float], Paths]:
        """The paths that are summed, at times of pulses."""
        return select_paths(motion.at_pulses(self.source, self.waveform), self._summed(motion))

    def _summed(self, motion: PathsAtKnots) -> Bool:
        """Whether paths [I] are summed: all that move, or all where the canceller leaves others."""
        summed: Bool = motion.moving | (not self.canceller.removes_static)
        return summed

    def _single_will_do(self, motion: PathsAtKnots) -> bool:
        """Whether rounding leaves enough of what the canceller leaves of paths that hardly turn."""
        if motion.step == 1:
            return False  # paths at every pulse cost so much that it would save nothing
        if motion.chunk is None or not isinstance(self.canceller, Fir):
            return True
        paths, summed = motion.chunk.paths, self._summed(motion)
        sampled = np.arange(0, paths.delay.shape[1] - 1, max(1, paths.delay.shape[1] // SAMPLED))
        turn = (
            self.waveform.f0 / motion.step * (paths.delay[:, sampled + 1] - paths.delay[:, sampled])
        )
        amplitude = paths.amplitude[:, sampled] * summed[:, None]
        taps = enumerate(self.canceller.taps)
        left = sum(c * unit_phasor(k * turn, np.complex64) for k, c in taps)
        rounding_db = SINGLE_ROUNDING_DB + ROUNDING_SPARE_DB - target_error_db(self.tolerance_db)
        least = 10 ** (rounding_db / 10) * np.sum(amplitude**2)
        return bool(np.sum(np.abs(left * amplitude) ** 2) > least)

    def _sum(self, chosen: Settings, motion: PathsAtKnots, unit: float) -> Complex:
        """Signal y [M], in units of `unit`, by some settings."""
        y = np.zeros(self.waveform.n_pulses, dtype=complex)
        summed = self._summed(motion)
        if summed.any():
            for knots in motion.knots(self.source, self.waveform):
                first, last = knots.pulses
                self._sum_knots(chosen, knots, summed, unit, y[first:last])
        return y

    def _sum_knots(
        self, chosen: Settings, knots: Knots, summed: Bool, unit: float, y: Complex
    ) -> None:
        """Add the sum of the paths at the pulses of these knots to y, some paths at a time."""
        moving, w = np.flatnonzero(summed), self.waveform
        fast = chosen.cubic and compiled.pays(moving.size * w.n_pulses)
        count = max(1, (BLOCK if knots.step == 1 else CHUNK) // knots.paths.delay.shape[1])
        for start in range(0, moving.size, count):
            numbers = moving[start : start + count]
            if knots.step == 1:
                y += _phasor_sum(*self._terms(knots.paths, numbers, unit, chosen))
                continue
            if fast:
                table = half_band_table(w, chosen.table_oversampling, chosen.single)
                dense = compiled.interpolated_sum(
                    knots.paths, numbers, unit, table, knots.shift, knots.step
                )
                exact = compiled.sum_at(knots.exact, numbers, unit, table)
            else:
                terms = self._terms(knots.paths, numbers, unit, chosen)
                dense = _interpolated_sum(*terms, knots.shift, knots.step, chosen.cubic)
                exact = _phasor_sum(*self._terms(knots.exact, numbers, unit, chosen))
            dense[knots.exact_pulses - knots.pulses[0]] = exact
            y += dense[: y.size]

    def _terms(
        self, paths: Paths, numbers: Index, unit: float, chosen: Settings
    ) -> tuple[Float, Complex]:
        """Phases f0 tau (cycles) and A G over the unit, [M, I] of some paths."""
        w, shape = self.waveform, (paths.delay.shape[1], numbers.size)
        table = half_band_table(w, chosen.table_oversampling, chosen.single)
        cycles = np.empty(shape)
        envelope = np.empty(shape, np.complex64 if chosen.single else np.complex128)
        rows = max(1, BLOCK // numbers.size)
        for start in range(0, shape[0], rows):
            block = slice(start, start + rows)
            delay, amplitude = (np.ascontiguousarray(part[numbers, block].T) for part in paths[:2])
            cycles[block] = start_phase(delay, w, w.f0)
            g = table(w.slope / w.adc_rate * delay)
            np.multiply(g, (amplitude / unit).astype(g.real.dtype), out=envelope[block])
        return cycles, envelope


def _interpolated_sum(
    cycles: Float, envelope: Complex, shift: Index, step: int, cubic: bool
) -> Complex:
    """Sum over paths of envelope exp(-j 2 pi cycles) at the pulses [segments * step].

    It has the precision of the envelope. Phases and envelope are given at the knots
    [BEFORE + segments + AFTER, I].
    """
    degree = CUBIC if cubic else TAPS - 1
    to_nodes, to_pulses = _weights(step, degree)
    to_nodes, weights = to_nodes.astype(envelope.real.dtype), to_pulses.astype(envelope.dtype)
    total = np.empty((shift.size, step), dtype=complex)
    count = max(1, PHASORS // cycles.shape[1])
    for start in range(0, shift.size, count):
        within = shift[start : start + count]
        reach = slice(start, start + within.size + BEFORE + AFTER)
        phases, taps = stencils(cycles[reach], within), stencils(envelope[reach], within)
        turning = phasors_between_knots(phases, step, degree, envelope.dtype)
        parts = to_nodes @ taps.reshape(TAPS, -1).view(to_nodes.dtype)
        at_nodes = parts.view(taps.dtype).reshape(-1, *taps.shape[1:])
        sums = turning.transpose(1, 0, 2) @ at_nodes.transpose(1, 2, 0)  # [segments, step, nodes]
        total[start : start + count] = (sums.transpose(1, 0, 2) @ weights)[..., 0].T
    return total.ravel()


@lru_cache(maxsize=128)
def _weights(step: int, degree: int) -> tuple[Float, Float]:
    """Weights of interpolation within a segment of `step` pulses.

    Returns:
        Weights from the knots -2 .. 3 of a segment to nodes [nodes, TAPS], and from these to its
        pulses [step, nodes, 1].
    """
    places = nodes(degree, step)
    to_pulses = lagrange_basis(places, np.arange(float(step))).T[:, :, None]
    return lagrange_basis(NODES, places / step).T, to_pulses


def _phasor_sum(cycles: Float, envelope: Complex) -> Complex:
    """Sum over paths of envelope exp(-j 2 pi cycles) [M], in the precision of the envelope."""
    total: Complex = np.einsum("mi,mi->m", unit_phasor(cycles, envelope.dtype), envelope)
    return total
