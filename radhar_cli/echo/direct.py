"""The closed form: y[m] = sum_i A_i exp(-j 2 pi f0 tau_i) G(K tau_i/fs), without a beat matrix.

Paths are computed at knots and interpolated to the pulses, G is read from a table, phasors may be
single precision: as far as the error budget allows (error_budget.py, docs/engines.md). Paths that
do not move cancel in the MTI and are left out of it.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from radhar_cli.arrays import Complex, Float
from radhar_cli.echo.beat import start_phase
from radhar_cli.echo.coarse_knots import CoarseKnots, coarse_knots
from radhar_cli.echo.error_bounds import envelope
from radhar_cli.echo.error_budget import BudgetError, Choice, DirectSettings, Envelope, choose
from radhar_cli.echo.half_band_sum import half_band_table
from radhar_cli.echo.interpolation import AFTER, BEFORE, upsample
from radhar_cli.echo.knots import Knots, all_knots
from radhar_cli.echo.paths import Paths, PathSource
from radhar_cli.radar.waveform import Waveform

BLOCK_PULSES = 4096


class _Block(NamedTuple):
    """Some consecutive pulses: delays [I, block] and A G as (real, imaginary) [2, I, block]."""

    pulses: slice
    delay: Float
    envelope: NDArray[np.floating]


@dataclass(frozen=True)
class DirectEcho:
    """The slow-time signal of a source of paths, before MTI and without noise.

    Attributes:
        source: the paths.
        waveform: the radar.
        tolerance_db: bound of the relative L2 error, after MTI where there is one.
        double: keep to double precision whatever the budget.
        mti: whether only differences from pulse to pulse will be looked at.
    """

    source: PathSource
    waveform: Waveform
    tolerance_db: float
    double: bool = False
    mti: bool = True

    def slow_time(self) -> Complex:
        """y[m] [M]; with mti, less the paths that do not move (a constant).

        Raises:
            BudgetError: the budget is below what float64 leaves of this signal.
        """
        y = np.zeros(self.waveform.n_pulses, dtype=complex)
        for knots, b in self._envelopes():
            if self.settings.moving:
                first, last = knots.pulses
                self._sum(knots, b, list(self.settings.moving), y[first:last])
        y *= self.settings.scale
        return y

    def signal_power(self) -> float:
        """P_s = mean over the pulses of the power that the SNR refers to."""
        return self._coarse.mean_power()

    @cached_property
    def beyond_reach(self) -> BudgetError | None:
        """Why the budget cannot be kept; None where it can."""
        try:
            self._chosen  # noqa: B018
        except BudgetError as error:
            return error
        return None

    @property
    def settings(self) -> DirectSettings:
        """What is done to keep the budget."""
        return self._chosen.settings

    @cached_property
    def _chosen(self) -> Choice:
        return choose(self._coarse, self.tolerance_db, self.double, self.mti)

    @cached_property
    def _coarse(self) -> CoarseKnots:
        return coarse_knots(self.source, self.waveform)

    def _envelopes(self) -> Iterator[Envelope]:
        """Knots and envelopes: those already looked at, where they are all there are."""
        settings, kept = self._chosen
        if kept is not None:
            yield kept
            return
        for knots in all_knots(self.source, self.waveform, settings.step):
            yield Envelope(knots, self._envelope(knots.paths))

    def _envelope(self, paths: Paths) -> Complex:
        table = half_band_table(self.waveform, self.settings.table_oversampling)
        return envelope(paths, table, self.settings.scale)

    def _sum(self, knots: Knots, b: Complex, chosen: list[int], y: Complex) -> None:
        """Fill y with the sum of the chosen paths at the pulses of these knots."""
        real = np.float32 if self.settings.single else np.float64
        for pulses, delay, (re, im) in self._blocks(knots, b, chosen, real):
            cycles = start_phase(delay, self.waveform, self.waveform.f0)
            cycles -= np.rint(cycles)
            angle: Float = cycles.astype(real)
            angle *= real(2 * np.pi)
            cos, sin = np.cos(angle), np.sin(angle)
            y[pulses].real = np.einsum("im,im->m", re, cos) + np.einsum("im,im->m", im, sin)
            y[pulses].imag = np.einsum("im,im->m", im, cos) - np.einsum("im,im->m", re, sin)

    def _blocks(
        self, knots: Knots, b: Complex, chosen: list[int], real: type[np.floating]
    ) -> Iterator[_Block]:
        """Delays and envelopes of the chosen paths at every pulse, a few thousand at a time."""
        delay, at_knots = knots.paths.delay[chosen], np.stack([b.real[chosen], b.imag[chosen]])
        exact_delay, exact = knots.exact.delay[chosen], self._envelope(knots.exact)[chosen]
        (first, last), step = knots.pulses, knots.step
        exact_at = knots.exact_pulses - first
        segments = max(1, BLOCK_PULSES // step)
        for start in range(0, -(-(last - first) // step), segments):
            pulses = slice(start * step, min((start + segments) * step, last - first))
            if step == 1:
                yield _Block(pulses, delay[:, pulses], at_knots[..., pulses].astype(real))
                continue
            reach = slice(start, start + segments + BEFORE + AFTER)
            length = pulses.stop - pulses.start
            shift = knots.shift[start : start + segments]
            tau = upsample(delay[:, reach], step, shift)[:, :length]
            envelopes = upsample(at_knots[..., reach], step, shift, real)[..., :length]
            here = np.flatnonzero((exact_at >= pulses.start) & (exact_at < pulses.stop))
            place = exact_at[here] - pulses.start
            tau[:, place] = exact_delay[:, here]
            envelopes[0][:, place] = exact.real[:, here]
            envelopes[1][:, place] = exact.imag[:, here]
            yield _Block(pulses, tau, envelopes)
