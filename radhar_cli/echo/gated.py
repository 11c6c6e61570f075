"""Range bins without a beat matrix, for a gate.

y_k[m] = sum_n exp(j 2 pi k (n - n0)/N_FFT) s_b[n, m], n0 = N_ADC/2. All that moves lies within a
few metres: seen from their middle, s_b turns so slowly in fast time that a few samples show all of
it. Between breakpoints the paths are interpolated from knots, as in `direct`; the beat is made at P
nodes instead of N_ADC samples, and a small matrix takes those to the bins; docs/physics/engines.md.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from functools import lru_cache
from math import ceil, inf, isqrt
from typing import NamedTuple

import numpy as np
import scipy.fft

from radhar_cli.arrays import Complex, Float, Index
from radhar_cli.echo.accuracy import Settings, probed_pulses, relative_db
from radhar_cli.echo.beat import powers, start_phase
from radhar_cli.echo.direct import Accuracy, DirectEcho
from radhar_cli.echo.exact import beat_at
from radhar_cli.echo.interpolation import AFTER, BEFORE, upsample
from radhar_cli.echo.knots import Knots, Motion
from radhar_cli.echo.paths import Paths
from radhar_cli.phasor import unit_phasor
from radhar_cli.processing.canceller import NO_CANCELLER, Fir
from radhar_cli.processing.look import Look, RangeBins
from radhar_cli.processing.range_compression import range_compression
from radhar_cli.radar.waveform import Waveform

SEGMENTS = 32  # knot intervals per block, in which the body hardly moves
PULSES = 512  # pulses per block where paths are evaluated at every pulse
VALUES, NODES = 2**20, 10  # phasors per block, and about how many a path and pulse takes
MAX_NODES = 400  # designing that many takes a second; beyond, all samples are nodes
WIDTHS = 8  # bins to which extents are rounded up, so that few designs are needed


class Nodes(NamedTuple):
    """Nodes in fast time for echoes within some bins of the middle."""

    size: int  # P
    spacing: float  # samples; they lie symmetrically about the middle of the chirp
    # takes the beat at the nodes to that at the samples [N_ADC, P]; None where these are the nodes
    to_samples: Complex | None


@lru_cache(maxsize=8)
def nodes(samples: int, width: int, single: bool) -> Nodes:
    """Nodes from which exp(-j 2 pi d n) follows for every |d| <= width/(2 samples).

    A weighted sum by least squares over such d, cut off where rounding would count for more: the
    nodes are `over` times as dense as the sampling theorem asks, and reach beyond the chirp.
    """
    over, beyond, cut = (1.25, 8, 1e-7) if single else (1.5, 12, 1e-14)
    spacing = samples / (over * width)
    count = ceil((samples - 1) / spacing) + 1 + 2 * beyond
    if count >= min(0.7 * samples, MAX_NODES):
        return Nodes(samples, 1.0, None)
    d = -np.cos(np.pi * (np.arange(2 * count) + 0.5) / (2 * count)) * width / (2 * samples)
    at_nodes = unit_phasor(np.outer(d, _about_zero(count) * spacing))
    at_samples = unit_phasor(np.outer(d, _about_zero(samples)))
    to_samples = np.linalg.lstsq(at_nodes, at_samples, rcond=cut)[0].T
    return Nodes(count, spacing, np.asarray(to_samples, dtype=complex))


@lru_cache(maxsize=32)
def to_bins(waveform: Waveform, width: int, single: bool, first: int, count: int) -> Complex:
    """From the beat at the nodes to bins first .. first + count - 1 from the middle one [P, K]."""
    n = np.arange(waveform.n_adc) - waveform.n_adc / 2
    kernel = unit_phasor(np.outer(n, -np.arange(first, first + count)) / waveform.n_fft)
    to_samples = nodes(waveform.n_adc, width, single).to_samples
    assert to_samples is not None
    taken: Complex = to_samples.T @ kernel
    return taken.astype(np.complex64) if single else taken


def _about_zero(count: int) -> Float:
    return np.arange(count) - (count - 1) / 2


@dataclass(frozen=True)
class GatedEcho(DirectEcho):
    """Range bins of a source of paths, without noise, referred to mid-chirp."""

    bins: slice = field(default_factory=lambda: slice(0, 0))  # those that are made
    # (first [M], last + 1 [M]): which of them count, pulse by pulse; others may be zero. None is
    # all
    needed: tuple[Index, Index] | None = None
    spans: list[slice] | None = None  # the pulses of each bin that count; None is all

    @property
    def look(self) -> Look:
        """What of the echo this is."""
        spans = self.spans or [slice(0, self.waveform.n_pulses)] * (
            self.bins.stop - self.bins.start
        )
        bins = RangeBins(replace(self.waveform, centred=True), self.bins)
        return Look.of_all("range_signals", bins, spans=spans)

    def rows(self) -> tuple[Complex, Accuracy]:
        """y_k[m] [K, M] before the canceller, less what that removes exactly; and its accuracy.

        The error is that of all bins that count, together.

        Raises:
            AccuracyError: the tolerance is below what float64 leaves of these bins.
        """
        return self.slow_time()

    def _settings(self, aim_db: float) -> Settings:
        chosen = super()._settings(aim_db)
        # There is no envelope to interpolate that turns with the ends of the chirp.
        return chosen._replace(spacing=chosen.spacing._replace(phase_change=inf))

    def _needed(self) -> tuple[Index, Index]:
        if self.needed is not None:
            return self.needed
        every = np.ones(self.waveform.n_pulses, np.intp)
        return self.bins.start * every, self.bins.stop * every

    def _sum(self, chosen: Settings, motion: Motion, unit: float) -> Complex:
        kept, w = np.flatnonzero(self._kept(motion)), self.waveform
        y = np.zeros((self.bins.stop - self.bins.start, w.n_pulses), dtype=complex)
        if not kept.size:
            return y
        low, high = self._needed()
        for knots in motion.knots(self.source, w):
            for pulses, paths in _at_pulses(knots, kept):
                first, stop = int(low[pulses].min()), int(high[pulses].max())
                if stop > first:
                    rows = slice(first - self.bins.start, stop - self.bins.start)
                    paths = paths._replace(amplitude=paths.amplitude / unit)
                    y[rows, pulses] = _bins(paths, w, chosen.single, first, stop - first).T
        return y

    def _error(self, y: Complex, exact: Callable[[Float], Paths], unit: float) -> float:
        """Relative L2 error (dB) of the bins that count after the canceller; see `measured_db`."""
        w = self.waveform
        shown = self.canceller if isinstance(self.canceller, Fir) else NO_CANCELLER
        low, high = self._needed()
        lags = np.lib.stride_tricks.sliding_window_view
        low = lags(low, shown.lost + 1).max(axis=1)
        high = lags(high, shown.lost + 1).min(axis=1)
        k = np.arange(self.bins.start, self.bins.stop)[:, None]
        power = np.zeros(low.size)
        whole = y if isinstance(self.canceller, Fir) else self.canceller(y)
        for start in range(0, power.size, PULSES):
            part = slice(start, min(start + PULSES, power.size))
            rows = slice(
                low[part].min() - k[0, 0], max(high[part].max(), low[part].min()) - k[0, 0]
            )
            x = whole[rows, start : part.stop + shown.lost]
            x = self.canceller(x) if isinstance(self.canceller, Fir) else x
            inside = _between(low[part], k[rows], high[part])
            power[part] = np.einsum("km,km->m", x.real**2 + x.imag**2, inside)
        probes, density, total = probed_pulses(power)
        if total == 0:
            return -inf
        centred = replace(w, centred=True)
        right = range_compression(beat_at(exact, w, probes, shown.taps), centred, self.bins) / unit
        for lag, c in enumerate(shown.taps):
            right -= c * y[:, probes + lag]
        right *= _between(low[probes], k, high[probes])
        return relative_db((right.real**2 + right.imag**2).sum(axis=0), density, total)


def _between(low: Index, k: Index, high: Index) -> Float:
    return ((low <= k) & (k < high)).astype(float)


def _at_pulses(knots: Knots, kept: Index) -> Iterator[tuple[slice, Paths]]:
    """The kept paths at consecutive blocks of pulses."""
    first, last = knots.pulses
    length = min(SEGMENTS * knots.step, PULSES) if knots.step > 1 else PULSES
    segments = max(1, min(length, VALUES // (2 * NODES * kept.size)) // knots.step)
    for start in range(0, -(-(last - first) // knots.step), segments):
        pulses = slice(
            first + start * knots.step, min(first + (start + segments) * knots.step, last)
        )
        if knots.step == 1:
            yield pulses, knots.paths.only(kept, slice(start, start + segments))
            continue
        shift = knots.shift[start : start + segments]
        reach = slice(start, start + shift.size + BEFORE + AFTER)
        here = (pulses.start <= knots.exact_pulses) & (knots.exact_pulses < pulses.stop)
        found = []
        for part, exact in zip(knots.paths[:2], knots.exact[:2], strict=True):
            dense = upsample(part[kept, reach].T, knots.step, shift)
            dense[knots.exact_pulses[here] - pulses.start] = exact[kept][:, here].T
            found.append(dense[: pulses.stop - pulses.start].T)
        yield pulses, Paths(found[0], found[1])


def _bins(paths: Paths, w: Waveform, single: bool, first: int, count: int) -> Complex:
    """Bins first .. first + count - 1 of paths at some pulses [M, count]."""
    delay, amplitude = paths.delay.T, paths.amplitude.T
    turn = w.slope / w.adc_rate * delay  # cycles a sample
    low, high = float(turn.min()), float(turn.max())
    middle = round((low + high) / 2 * w.n_fft)
    width = ceil(((high - low) * w.n_adc + 2) / WIDTHS) * WIDTHS
    at = nodes(w.n_adc, width, single)
    cycles = start_phase(delay, w, w.fc + w.slope * w.n_adc / 2 / w.adc_rate)
    turn -= middle / w.n_fft
    beat = _at_nodes(cycles, turn, amplitude, at, single)
    if at.to_samples is not None:
        # From a multiple of 16 on, so that few matrices are needed.
        skipped = (first - middle) % 16
        whole = -(-(skipped + count) // 16) * 16
        matrix = to_bins(w, width, single, first - middle - skipped, whole)
        return beat @ matrix[:, skipped : skipped + count]
    k = np.arange(first, first + count) - middle
    bins = scipy.fft.ifft(beat, w.n_fft, axis=1, norm="forward")[:, k % w.n_fft]
    found: Complex = bins * unit_phasor(k * (w.n_adc / 2 / w.n_fft))
    return found


def _at_nodes(cycles: Float, turn: Float, amplitude: Float, nodes: Nodes, single: bool) -> Complex:
    """sum_i A exp(-j 2 pi (cycles + turn (n_p - n0))) [M, P] at nodes n_p, of [M, I].

    As in `beat_matrix`, with the phase taken in the middle, from which float32 errs least.
    """
    (count, spacing, _), dtype = nodes, np.complex64 if single else np.complex128
    coarse = isqrt(count - 1) + 1
    fine = -(-count // coarse)
    origin = coarse // 2 * fine
    first = unit_phasor(cycles + turn * ((origin - (count - 1) / 2) * spacing - 0.5), dtype)
    first *= amplitude
    slow = powers(unit_phasor(turn * (fine * spacing), dtype), coarse)  # [coarse, M, I]
    first *= slow[coarse // 2].conj()
    slow *= first
    fast = powers(unit_phasor(turn * spacing, dtype), fine)
    beat: Complex = slow.transpose(1, 0, 2) @ fast.transpose(1, 2, 0)  # [M, coarse, fine]
    return beat.reshape(len(cycles), coarse * fine)[:, :count]
