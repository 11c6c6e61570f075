"""A range gate: STFTs of the bins around the torso, summed incoherently.

What public data sets show, where the paper adds up all bins coherently before the transform. The
bins of a frame are fixed, so that no bin's signal is switched on or off within one.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import floor

import numpy as np

from radhar_cli.arrays import Float, Index
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.range_signals import RangeSignals
from radhar_cli.processing.stft import exponent_of, transform


@dataclass(frozen=True, eq=False)
class Gate:
    """The range bins that each frame shows: first[l] .. first[l] + count - 1.

    Attributes:
        first: [frames], or [1] where all frames show the same.
        count: of bins.
    """

    first: Index
    count: int

    @property
    def bins(self) -> slice:
        """All that any frame shows."""
        return slice(int(self.first.min()), int(self.first.max()) + self.count)

    def needed(self, frames: Frames, pulses: int, more: int) -> tuple[Index, Index]:
        """(first [M], last + 1 [M]) of the bins that some frame shows which a pulse belongs to.

        Args:
            frames: of the signal.
            pulses: M.
            more: pulses beside a frame on which its samples depend.
        """
        if self.first.size == 1:
            return np.full(pulses, self.bins.start), np.full(pulses, self.bins.stop)
        low, high = np.full(pulses, self.bins.stop), np.full(pulses, self.bins.start)
        for frame, first in enumerate(self.first):
            start = frame * frames.hop
            span = slice(max(start - more, 0), start + frames.length + more)
            low[span] = np.minimum(low[span], first)
            high[span] = np.maximum(high[span], first + self.count)
        return low, high

    def spans(self, needed: tuple[Index, Index]) -> list[slice]:
        """From the first to the last pulse that needs it, for each of `bins`; from `needed`."""
        low, high = needed
        found = []
        for k in range(self.bins.start, self.bins.stop):
            (pulses,) = np.nonzero((low <= k) & (k < high))
            found.append(slice(int(pulses[0]), int(pulses[-1]) + 1) if pulses.size else slice(0, 0))
        return found


def around(torso: Float, within: float, ranges: Float) -> Gate:
    """The 2 floor(within/step) + 1 bins about the one nearest to the torso, shifted into the axis.

    Args:
        torso: range in the middle of every frame [frames], m.
        within: half the width of the gate, m.
        ranges: of all bins, evenly spaced, m.
    """
    step = _step(ranges)
    count = min(bins_within(within, step), ranges.size)
    first = np.rint((torso - ranges[0]) / step) - count // 2
    return Gate(np.clip(first, 0, ranges.size - count).astype(np.intp), count)


def interval(low: float, high: float, ranges: Float) -> Gate:
    """From the bin nearest to one range (m) to the bin nearest to another, in every frame."""
    bins = np.rint((np.array([low, high]) - ranges[0]) / _step(ranges))
    first, last = np.clip(bins, 0, ranges.size - 1).astype(np.intp)
    return Gate(np.array([first]), int(last - first) + 1)


def bins_within(within: float, step: float) -> int:
    """How many bins a gate has that reaches so far (m) to both sides."""
    return 2 * floor(within / step) + 1


def _step(ranges: Float) -> float:
    return float(ranges[1] - ranges[0]) if ranges.size > 1 else 1.0


@dataclass(frozen=True, eq=False)
class GatedPower:
    """sum_k |X_k|^2 or (sum_k |X_k|)^2 over the gate of every frame, in blocks of frames.

    X_k is the transform of `stft` of bin k. Iterating yields [some frames, N], the lowest frequency
    first; all of it is that of 2^-exponent x, as in `stft.Spectra`.

    Attributes:
        signals: of every bin that the gate shows.
        gate: which a frame shows.
        frames: window length L and hop.
        bins: N, at least L.
        magnitudes: whether magnitudes are summed instead of powers.
        single: whether coefficients are complex64; complex128 otherwise.
    """

    signals: RangeSignals
    gate: Gate
    frames: Frames
    bins: int
    magnitudes: bool = False
    single: bool = False

    @cached_property
    def exponent(self) -> int:
        """Binary exponent of the largest real or imaginary part of any bin."""
        return exponent_of(self.signals.x)

    @property
    def count(self) -> int:
        """Number of frames."""
        return self.frames.count(self.signals.x.shape[1])

    def __iter__(self) -> Iterator[Float]:
        first = np.broadcast_to(self.gate.first - self.signals.first, self.count)
        for block in self.frames.blocks(self.signals.x.shape[1], self.bins):
            real = np.float32 if self.single else np.float64
            total = np.zeros((block.stop - block.start, self.bins), real)
            lowest, highest = first[block].min(), first[block].max() + self.gate.count
            for k in range(lowest, highest):
                shown = (first[block] <= k) & (k < first[block] + self.gate.count)
                self._add(total, k, block.start, np.flatnonzero(shown))
            if self.magnitudes:
                total *= total
            yield np.fft.fftshift(total, axes=1)

    def _add(self, total: Float, k: int, start: int, shown: Index) -> None:
        """Add bin k in some frames, counted from `start`, to their sums."""
        if not shown.size:
            return
        span = self.frames.span(slice(start + int(shown[0]), start + int(shown[-1]) + 1))
        x = self.signals.x[k, span] * 2.0**-self.exponent
        spectrum = transform(x, self.frames, self.frames.window, self.bins, self.single)
        size = np.abs(spectrum)
        if not self.magnitudes:
            size *= size
        if shown.size == len(size):  # the usual case: frames without a gap
            total[shown[0] : shown[-1] + 1] += size
        else:
            total[shown] += size[shown - shown[0]]
