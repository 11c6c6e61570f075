"""The closed form: y[m] = sum_i A_i exp(-j 2 pi f0 tau_i) G(K tau_i/fs), without a beat matrix.

What it neglects, and what bounds the error, is in docs/engines.md: paths are computed at knots and
interpolated to the pulses, G is read from a table, phasors may be single precision. Paths that do
not move cancel in the MTI and are left out of it.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from radhar_cli.arrays import Complex, Float, Index
from radhar_cli.echo.beat import start_phase
from radhar_cli.echo.half_band_sum import HalfBandTable, half_band_table, noise_gain
from radhar_cli.echo.interpolation import AFTER, BEFORE, TAPS, upsample
from radhar_cli.echo.paths import Paths, PathSource
from radhar_cli.radar.noise import circular_gaussian
from radhar_cli.radar.waveform import Waveform

KNOTS_PER_CYCLE = 100
FOLD_PER_KNOT = 0.2
# G turns by up to half the bandwidth about f0, where its weight D[n] is; referred to the start of
# the chirp its weight is at both ends, so that interpolation meets the whole of the turning.
G_CYCLES_PER_KNOT = {True: 0.2, False: 0.02}
LEAST_STEP = 3
BLOCK_PULSES = 4096
EXACT_CHUNK = 32768
SINGLE_ROUNDING = 1e-7
SINGLE_LIMIT_DB = -70.0


@dataclass(frozen=True)
class DirectSettings:
    """How much accuracy is bought.

    Attributes:
        kinematics_hz: least rate of the knots, Hz.
        table_oversampling: points of the table of G per fast-time sample.
        single: single-precision phasors, unless the MTI cancels too much for them.
    """

    kinematics_hz: float = 250.0
    table_oversampling: int = 16
    single: bool = True


class _Knots(NamedTuple):
    """Paths every `step` pulses (1: at every pulse), and exact ones where that is not enough."""

    step: int
    paths: Paths
    exact_pulses: Index
    exact: Paths


class _Delayed(NamedTuple):
    """Knots and A G [I, knots] and [I, exact pulses] there."""

    knots: _Knots
    envelope: Complex
    exact_envelope: Complex


class _Block(NamedTuple):
    """Some consecutive pulses: delays [I, block] and A G as (real, imaginary) [2, I, block]."""

    pulses: slice
    delay: Float
    envelope: NDArray[np.floating]


@dataclass(frozen=True)
class DirectEcho:
    """The slow-time signal of a source of paths, before MTI and without noise."""

    source: PathSource
    waveform: Waveform
    settings: DirectSettings

    def slow_time(self, mti: bool = True) -> Complex:
        """y[m] [M]; with mti, less the paths that do not move (a constant)."""
        chosen = self._moving if mti else np.arange(len(self._delayed.envelope))
        if not self.settings.single:
            return self._sum(chosen, np.float64)
        y = self._sum(chosen, np.float32)
        return self._sum(chosen, np.float64) if mti and self._cancels(y, chosen) else y

    def signal_power(self) -> float:
        """P_s = mean over the pulses of the power that the SNR refers to."""
        step, paths, exact_pulses, exact = self._knots
        if step == 1:
            return float(paths.power.mean())
        power = upsample(paths.power, step)[: self.waveform.n_pulses]
        power[exact_pulses] = exact.power
        return float(power.mean())

    @cached_property
    def _knots(self) -> _Knots:
        """Knots as dense as the settings, the motion and the nearest passage ask for."""
        rate = max(self.settings.kinematics_hz, KNOTS_PER_CYCLE * self.source.highest_frequency)
        step = int(self.waveform.prf // rate) if self.source.smooth else 1
        while step >= LEAST_STEP:
            paths = self._paths_every(step)
            excess = _fold(paths.amplitude) / FOLD_PER_KNOT
            if excess <= 1:
                return self._with_kinks(step, paths)
            step = min(step - 1, int(step / excess))
        return self._everywhere()

    @cached_property
    def _delayed(self) -> _Delayed:
        """Knots dense enough for G too, and the envelopes A G there."""
        knots = self._knots
        while True:
            envelope = self._envelope(knots.paths)
            excess = self._turning(knots.paths, envelope) if knots.step > 1 else 0.0
            if excess <= 1:
                return _Delayed(knots, envelope, self._envelope(knots.exact))
            step = min(knots.step - 1, int(knots.step / excess))
            if step < LEAST_STEP:
                knots = self._everywhere()
            else:
                knots = self._with_kinks(step, self._paths_every(step))

    def _paths_every(self, step: int) -> Paths:
        count = -(-self.waveform.n_pulses // step) + BEFORE + AFTER
        return self._paths((np.arange(count) - BEFORE) * step)

    def _with_kinks(self, step: int, paths: Paths) -> _Knots:
        pulses = self._pulses_near_kinks(step)
        return _Knots(step, paths, pulses, self._paths(pulses))

    def _everywhere(self) -> _Knots:
        nothing = np.empty(0, dtype=np.intp)
        return _Knots(
            1, self._paths(np.arange(self.waveform.n_pulses)), nothing, self._paths(nothing)
        )

    def _turning(self, paths: Paths, envelope: Complex) -> float:
        """How many times too long the knot interval is for the turning of G.

        Beyond the half-band G is small and all ripple: its error counts against a smaller signal,
        and falls with the power TAPS of the interval.
        """
        a, waveform = paths.amplitude, self.waveform
        cycles = 0.5 * waveform.bandwidth * np.abs(np.diff(paths.delay, axis=1)).max()
        whole = float(np.sum(a * a)) * waveform.n_bins**2
        kept = float(np.sum(envelope.real**2 + envelope.imag**2))
        share = min(kept / whole, 1.0) if whole > 0 and kept > 0 else 1.0
        return float(cycles / (G_CYCLES_PER_KNOT[waveform.centred] * share ** (0.5 / TAPS)))

    @cached_property
    def _table(self) -> HalfBandTable:
        return half_band_table(self.waveform, self.settings.table_oversampling)

    def _envelope(self, paths: Paths) -> Complex:
        """A G [I, M]."""
        g = self._table(self.waveform.slope / self.waveform.adc_rate * paths.delay)
        g *= paths.amplitude
        return g

    def _paths(self, pulses: Index) -> Paths:
        """Exact paths at some pulses, in chunks that bound the memory."""
        parts = [
            self.source(self.waveform.times(pulses[i : i + EXACT_CHUNK].astype(float)))
            for i in range(0, max(pulses.size, 1), EXACT_CHUNK)
        ]
        if len(parts) == 1:
            return parts[0]
        return Paths(*(np.concatenate(arrays, axis=-1) for arrays in zip(*parts, strict=True)))

    def _pulses_near_kinks(self, step: int) -> Index:
        """Pulses of the segments whose interpolation would reach across a kink."""
        near = np.zeros(-(-self.waveform.n_pulses // step), dtype=bool)
        for kink in self.source.kinks:
            at = kink * self.waveform.prf / step
            near[max(int(np.floor(at)) - AFTER, 0) : max(int(np.ceil(at)) + AFTER, 0)] = True
        return np.flatnonzero(np.repeat(near, step)[: self.waveform.n_pulses])

    @cached_property
    def _moving(self) -> Index:
        """Numbers of the paths that change at all during the recording."""
        first, knots = self._knots.paths, self._delayed.knots
        changes = np.zeros(len(first.delay), dtype=bool)
        for paths in (knots.paths, knots.exact):
            changes |= (paths.delay != first.delay[:, :1]).any(axis=1)
            changes |= (paths.amplitude != first.amplitude[:, :1]).any(axis=1)
        return np.flatnonzero(changes)

    def _cancels(self, y: Complex, chosen: Index) -> bool:
        """Whether the MTI leaves too little of y for single precision to be enough."""
        left = float(np.sum(np.abs(np.diff(y)) ** 2))
        envelope = self._delayed.envelope[chosen]
        whole = float(np.sum(envelope.real**2 + envelope.imag**2)) / envelope.shape[1] * y.size
        return bool(whole * SINGLE_ROUNDING**2 > left * 10 ** (SINGLE_LIMIT_DB / 10))

    def _sum(self, chosen: Index, real: type[np.floating]) -> Complex:
        y = np.zeros(self.waveform.n_pulses, dtype=complex)
        for block in self._blocks(chosen, real) if chosen.size else ():
            cycles = start_phase(block.delay, self.waveform, self.waveform.f0)
            cycles -= np.rint(cycles)
            angle = cycles.astype(real)
            angle *= real(2 * np.pi)
            cos, sin = np.cos(angle), np.sin(angle)
            re, im = block.envelope
            part = y[block.pulses]
            part.real = np.einsum("im,im->m", re, cos) + np.einsum("im,im->m", im, sin)
            part.imag = np.einsum("im,im->m", im, cos) - np.einsum("im,im->m", re, sin)
        return y

    def _blocks(self, chosen: Index, real: type[np.floating]) -> Iterator[_Block]:
        (step, paths, exact_pulses, exact), whole, corrections = self._delayed
        knots = np.stack([whole.real[chosen], whole.imag[chosen]])
        delay, count = paths.delay[chosen], self.waveform.n_pulses
        segments = max(1, BLOCK_PULSES // step)
        for first in range(0, -(-count // step), segments):
            pulses = slice(first * step, min((first + segments) * step, count))
            if step == 1:
                yield _Block(pulses, delay[:, pulses], knots[..., pulses].astype(real))
                continue
            reach = slice(first, first + segments + BEFORE + AFTER)
            length = pulses.stop - pulses.start
            tau = upsample(delay[:, reach], step)[:, :length]
            envelope = upsample(knots[..., reach], step, real)[..., :length]
            here = np.flatnonzero((exact_pulses >= pulses.start) & (exact_pulses < pulses.stop))
            if here.size:
                at, place = exact_pulses[here] - pulses.start, np.ix_(chosen, here)
                tau[:, at] = exact.delay[place]
                envelope[0][:, at] = corrections.real[place]
                envelope[1][:, at] = corrections.imag[place]
            yield _Block(pulses, tau, envelope)


def _fold(amplitude: Float) -> float:
    """Largest relative change of an amplitude [I, M] from one knot to the next."""
    least = np.minimum(amplitude[:, 1:], amplitude[:, :-1])
    change = np.abs(np.diff(amplitude, axis=1)) / np.where(least > 0, least, np.inf)
    return float(change.max(initial=0.0))


def slow_time_noise(rng: np.random.Generator, waveform: Waveform) -> Complex:
    """v[m] [M] for unit raw noise: white, circular, of variance sum_n |D[n]|^2."""
    v: Complex = circular_gaussian(rng, (waveform.n_pulses,)) * np.sqrt(noise_gain(waveform))
    return v
