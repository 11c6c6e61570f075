"""Range bins in closed form, for a gate.

    y_k[m] = exp(-j pi k/N_FFT) sum_i A_i exp(-j 2 pi phi_i) D(k/N_FFT - u_i),
    D(x) = sum_n w[n] cos(2 pi x (n - (N - 1)/2)),  u = K tau/fs,  phi the phase in mid-chirp,

of the bins referred to mid-chirp, sum_n exp(j 2 pi k (n - N/2)/N_FFT) s_b[n, m]. Over the ranges of
a body D is a sum of few Chebyshev polynomials T_p, whose sums over the paths are made instead of
the bins'. As in `direct`, phasors follow from one another, and the envelopes A T_p, which are
real, are interpolated from knots; docs/physics/engines.md.
"""

from dataclasses import dataclass, field, replace
from itertools import pairwise
from math import ceil, inf
from typing import Any, ClassVar

import numpy as np

from radhar_cli.echo.accuracy import Settings, choose_probes
from radhar_cli.echo.beat import start_phase
from radhar_cli.echo.chebyshev import coefficients
from radhar_cli.echo.direct import CUBIC, DirectEcho
from radhar_cli.echo.exact import beat_at
from radhar_cli.echo.interpolation import (
    AFTER,
    BEFORE,
    NO_STENCIL,
    REACH,
    TAPS,
    lagrange_weights,
    stencils,
)
from radhar_cli.echo.knots import Knots, PathsAtKnots
from radhar_cli.echo.paths import Paths
from radhar_cli.echo.phase_recurrence import phasors_between_knots
from radhar_cli.numerics.arrays import Bool, Complex, Float, Index
from radhar_cli.numerics.phasor import unit_phasor
from radhar_cli.processing.canceller import NO_CANCELLER, Fir
from radhar_cli.processing.look import Look, RangeBins
from radhar_cli.processing.range_compression import range_compression
from radhar_cli.radar.fmcw import Waveform

VALUES = 2**20  # envelopes at knots per block
AT_PEAK = 1e-9  # sine of the denominator below which D is N
MAX_POLYNOMIALS = 128  # of which combinations are looked for, at a cost of the cube of them
MORE_NODES = 24, 48  # than D has half waves, in single and in double precision
SMALLEST = 3e-7, 1e-15  # coefficient over N that is kept, and singular value, likewise


def kernel(u: Float, k: Index, samples: int, n_fft: int) -> Float:
    """D(k/N_FFT - u) = sin(pi N x)/sin(pi x) [..., K] at beat frequencies u [...], per sample."""
    bin_angle, beat_angle = np.pi / n_fft * k, np.pi * u[..., None]
    sines: Float = np.sin(samples * bin_angle) * np.cos(samples * beat_angle)
    sines -= np.cos(samples * bin_angle) * np.sin(samples * beat_angle)
    below = np.sin(bin_angle) * np.cos(beat_angle)
    below -= np.cos(bin_angle) * np.sin(beat_angle)
    peak = np.abs(below) < AT_PEAK
    if peak.any():  # x is a whole number
        period = np.rint(np.broadcast_to(k / n_fft - u[..., None], peak.shape)[peak])
        sines[peak] = samples * (1 - 2 * (period * (samples - 1) % 2))
        below[peak] = 1
    sines /= below
    return sines


def windowed_kernel(u: Float, k: Index, weights: Float, n_fft: int) -> Float:
    """D(k/N_FFT - u) of a window w, symmetric about the middle of its samples.

    The cosine of a difference makes two matrix products of the sum over the samples.

    Args:
        u: Beat frequencies [P], cycles per sample.
        k: Range bins [K].
        weights: Window w[n] [N].
        n_fft: Length of the transform.

    Returns:
        D [P, K].
    """
    n = np.arange(weights.size) - (weights.size - 1) / 2
    beat, bins = 2 * np.pi * np.outer(u, n), 2 * np.pi / n_fft * np.outer(n, k)
    d: Float = (np.cos(beat) * weights) @ np.cos(bins)
    d += (np.sin(beat) * weights) @ np.sin(bins)
    return d


@dataclass(frozen=True)
class GatedEcho(DirectEcho):
    """Range bins of a source of paths, without noise, referred to mid-chirp."""

    bins: slice = field(default_factory=lambda: slice(0, 0))  # range bins that are made
    # first [M] and last + 1 [M] of the bins that count at each pulse; others may be zero. None for
    # all
    needed: tuple[Index, Index] | None = None
    spans: list[slice] | None = None  # the pulses of each bin that count; None is all
    min_step: ClassVar[int] = 6  # envelopes from fewer cost more than at every pulse

    @property
    def look(self) -> Look:
        """Look at the echo that is made: the range bins."""
        spans = self.spans or [slice(0, self.waveform.n_pulses)] * (
            self.bins.stop - self.bins.start
        )
        bins = RangeBins(replace(self.waveform, centred=True), self.bins)
        return Look.of_all("range_signals", bins, spans=spans)

    def _single_will_do(self, motion: PathsAtKnots) -> bool:
        """At every pulse, too: envelopes cost more than the paths."""
        return motion.step == 1 or super()._single_will_do(motion)

    def _needed(self) -> tuple[Index, Index]:
        """First [M] and last + 1 [M] of the bins that count at each pulse."""
        if self.needed is not None:
            return self.needed
        every = np.ones(self.waveform.n_pulses, np.intp)
        return self.bins.start * every, self.bins.stop * every

    def counted_bins(self) -> Bool:
        """Which bins count at which pulses [bins, M - lost] after the canceller.

        A bin counts there if it counts at all pulses that the canceller combines.
        """
        low, high = self._needed()
        window = self.canceller.lost + 1
        combined = np.lib.stride_tricks.sliding_window_view
        k = np.arange(self.bins.start, self.bins.stop)[:, None]
        counted: Bool = combined(low, window).max(axis=1) <= k
        counted &= k < combined(high, window).min(axis=1)
        return counted

    def _sum(self, chosen: Settings, motion: PathsAtKnots, unit: float) -> Complex:
        numbers, w = np.flatnonzero(self._summed(motion)), self.waveform
        y = np.zeros((self.bins.stop - self.bins.start, w.n_pulses), dtype=complex)
        if not numbers.size:
            return y
        low, high = self._needed()
        for knots in motion.knots(self.source, w):
            (first, last), step = knots.pulses, knots.step
            knots = knots._replace(paths=knots.paths.only(numbers), exact=knots.exact.only(numbers))
            extent = w.slope / w.adc_rate * np.ptp(knots.paths.delay) * w.n_adc  # in bins
            wide = max(int((high - low)[first:last].max(initial=1)), int(np.pi / 2 * extent))
            count = max(1, VALUES // (numbers.size * wide))
            for start in range(0, -(-(last - first) // step), count):
                pulses = slice(first + start * step, min(first + (start + count) * step, last))
                k = np.arange(low[pulses].min(), high[pulses].max())
                if k.size:
                    part = self._block(chosen, knots, slice(start, start + count), k, unit)
                    y[k - self.bins.start, pulses] = part[:, : pulses.stop - pulses.start]
        return y

    def _block(
        self, chosen: Settings, knots: Knots, segments: slice, k: Index, unit: float
    ) -> Complex:
        """Bins k of the paths at some of the segments of knots [K, segments * step]."""
        if knots.step == 1:
            return self.at_pulses(chosen, knots.paths.at_times(segments), k, unit)
        step, shift = knots.step, knots.shift[segments]
        reach = slice(segments.start, segments.start + shift.size + BEFORE + AFTER)
        terms = self._envelopes(chosen, knots.paths.at_times(reach), k, unit)
        real, imag = _interpolated_sum(*terms, shift, step)
        x = _referred(real, imag, k, self.waveform)
        first = knots.pulses[0] + segments.start * step
        inside = np.searchsorted(knots.exact_pulses, [first, first + shift.size * step])
        if inside[1] > inside[0]:
            exact = knots.exact.at_times(slice(*inside))
            x[:, knots.exact_pulses[slice(*inside)] - first] = self.at_pulses(
                chosen, exact, k, unit
            )
        return x

    def at_pulses(self, chosen: Settings, paths: Paths, k: Index, unit: float) -> Complex:
        """Bins k of paths at M instants [K, M], each of which is computed."""
        cycles, envelope, coefficients = self._envelopes(chosen, paths, k, unit)
        turning = unit_phasor(cycles, complex_of(envelope))
        both = np.stack([turning.real, turning.imag], axis=1)  # [M, 2, I]
        x = (both @ envelope.transpose(1, 2, 0)).reshape(-1, len(coefficients)) @ coefficients
        return _referred(x[::2].T, x[1::2].T, k, self.waveform)

    def _envelopes(
        self, chosen: Settings, paths: Paths, k: Index, unit: float
    ) -> tuple[Float, Float, Float]:
        """Phases phi (cycles) [M, I], A T_p over the unit [P, M, I], D's coefficients [P, K]."""
        w, real = self.waveform, np.dtype(np.float32 if chosen.single else np.float64)
        delay, amplitude = (np.ascontiguousarray(part.T) for part in paths[:2])
        u = w.slope / w.adc_rate * delay
        middle, half = (u.max() + u.min()) / 2, max((u.max() - u.min()) / 2, 1e-12)
        coefficients = chebyshev(middle, half, k, w, real)
        x = ((u - middle) / half).astype(real)
        envelope = np.empty((len(coefficients), *x.shape), real)
        envelope[0] = amplitude / unit
        np.multiply(x, envelope[0], out=envelope[1])
        x *= 2
        for p in range(2, len(envelope)):
            np.multiply(x, envelope[p - 1], out=envelope[p])
            envelope[p] -= envelope[p - 2]
        in_middle = w.fc + w.slope / w.adc_rate * (w.n_adc - 1) / 2
        return start_phase(delay, w, in_middle), envelope, coefficients

    def _error(self, y: Complex, motion: PathsAtKnots, unit: float) -> float:
        """Relative L2 error (dB) of all bins that count, together, after the canceller."""
        w = self.waveform
        fir = self.canceller if isinstance(self.canceller, Fir) else NO_CANCELLER
        counted = self.counted_bins()
        pairs = np.where(counted, self.canceller(y), 0).view(float)
        power = np.einsum("km,km->m", pairs, pairs).reshape(-1, 2).sum(axis=1)
        step = motion.roughness.step
        powers = np.add.reduceat(power, np.arange(0, power.size, step))
        probes = choose_probes(powers, power.size, motion.roughness, fir.lost)
        if probes.total == 0:
            return -inf
        centred = replace(w, centred=True)
        right = (
            range_compression(
                beat_at(self._exact(motion), w, probes.pulses, fir.taps), centred, self.bins
            )
            / unit
        )
        for lag, c in enumerate(fir.taps):
            right -= c * y[:, probes.pulses + lag]
        right *= counted[:, probes.pulses]
        return probes.bound_db((right.real**2 + right.imag**2).sum(axis=0))


def chebyshev(middle: float, half: float, k: Index, w: Waveform, real: np.dtype[Any]) -> Float:
    """Coefficients [P, K] of D(k/N_FFT - u) = sum_p c_p T_p((u - middle)/half), P at least 2."""
    double = real == np.float64
    count = ceil((np.pi * w.n_adc * half + MORE_NODES[double]) / 8) * 8
    if w.window.is_rectangular:
        c = coefficients(lambda x: kernel(middle + half * x, k, w.n_adc, w.n_fft), count)
    else:
        weights = w.window.weights(w.n_adc)
        c = coefficients(lambda x: windowed_kernel(middle + half * x, k, weights, w.n_fft), count)
    significant = np.flatnonzero(np.abs(c).max(axis=1) > SMALLEST[double] * w.n_adc)
    return c[: max(2, int(significant.max(initial=0)) + 1)].astype(real)


def _referred(real: Float, imag: Float, k: Index, w: Waveform) -> Complex:
    """Bins k [K, ...] times exp(-j pi k/N_FFT).

    The middle of the samples lies half a sample before n = N/2.
    """
    x: Complex = np.empty(real.shape, complex_of(real))
    x.real, x.imag = real, imag
    x *= unit_phasor(k[:, None] / (2 * w.n_fft), x.dtype)
    return x


def complex_of(x: Float) -> np.dtype[Any]:
    """Complex type of the precision of x."""
    return np.result_type(x.dtype, np.complex64)


def _interpolated_sum(
    cycles: Float, envelope: Float, coefficients: Float, shift: Index, step: int
) -> Float:
    """Bins, real and imaginary [2, K, segments * step], at the pulses of segments.

    At the knots [BEFORE + segments + AFTER, I] are phases, in cycles, and A T_p over the unit
    [P, ...]; coefficients are c_p of the bins [P, K].
    """
    dtype = complex_of(envelope)
    degree = CUBIC if dtype == np.complex64 else TAPS - 1
    turning = phasors_between_knots(stencils(cycles, shift), step, degree, dtype)
    both = np.concatenate([turning.real, turning.imag]).transpose(1, 2, 0)  # [segments, I, 2 step]
    knots = envelope.transpose(1, 0, 2)
    if len(coefficients) <= MAX_POLYNOMIALS:
        few, coefficients = _fewer(coefficients)
        knots = few @ knots  # [knots, R, I]
    around = np.lib.stride_tricks.sliding_window_view(knots, TAPS, axis=0)
    around = around.transpose(0, 3, 1, 2).reshape(-1, TAPS * len(coefficients), knots.shape[2])
    z = np.empty((len(coefficients), 2, shift.size, step), both.dtype)
    shift = np.where(shift == NO_STENCIL, 0, shift)  # which are overwritten
    changes = np.flatnonzero(np.diff(shift, prepend=-NO_STENCIL, append=-NO_STENCIL)).tolist()
    for start, stop in pairwise(changes):
        moved = int(shift[start])
        first = BEFORE - REACH + start + moved
        taps = around[first : first + stop - start] @ both[start:stop]
        taps = taps.reshape(-1, TAPS, len(coefficients), 2, step)
        weights = lagrange_weights(step, moved).astype(z.dtype)
        z[:, :, start:stop] = np.einsum("strcm,tm->rcsm", taps, weights)
    x = coefficients.T @ z.reshape(len(coefficients), -1)
    return x.reshape(-1, 2, shift.size * step).swapaxes(0, 1)


def _fewer(coefficients: Float) -> tuple[Float, Float]:
    """Q [R, P] and Q c [R, K] of coefficients c [P, K] that are nearly Q^T Q c, R a third less."""
    double = coefficients.dtype == np.float64
    u, s, v = np.linalg.svd(coefficients, full_matrices=False)
    significant = s > SMALLEST[double] * s[0]
    return np.ascontiguousarray(u[:, significant].T), s[significant, None] * v[significant]
