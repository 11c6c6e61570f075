"""Slow-time signals of channels and range bins, simulated or recorded."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float, Index
from radhar_cli.processing.canceller import Canceller
from radhar_cli.radar.pulse_times import PulseTimes


def shown_pulses(count: int, width: int) -> Index:
    """Numbers m_j = floor((j + 1/2) count/width) of the pulses that a range-time map shows.

    They are all pulses if count < width.
    """
    if count <= width:
        return np.arange(count)
    return (2 * np.arange(width) + 1) * count // (2 * width)


def nearest(values: Float, targets: Float) -> Index:
    """Numbers [...] of the rising values [n] that are nearest to targets [...]."""
    middles = (values[1:] + values[:-1]) / 2
    return np.searchsorted(middles, targets)


@dataclass(frozen=True)
class Signal:
    """Complex samples of receive channels and range bins, pulse by pulse."""

    x: Complex  # [channel, row, pulse]; rows are range bins, or one coherent sum over them
    times: PulseTimes  # times of the pulses
    f0: float  # frequency at which the Doppler is read, Hz
    ranges: Float | None = None  # ranges of the rows, m; None for a sum over range
    first: int = 0  # number of the first row's range bin, as a `Gate` counts them
    range_step: float = 0.0  # from one range bin to the next, m; only a single one needs it said

    @property
    def pulses(self) -> int:
        """Number M of pulses."""
        return int(self.x.shape[-1])

    @property
    def prf(self) -> float:
        """Pulses per second between gaps, Hz."""
        return self.times.prf

    @cached_property
    def t(self) -> Float:
        """Times of the pulses [M], s."""
        return self.times.times(np.arange(self.pulses))

    def with_samples(self, x: Complex) -> "Signal":
        """Signal of other samples [channel, row, pulse] at the same times and ranges."""
        return replace(self, x=x)

    def at(self, pulses: Index, t: Float | None = None) -> "Signal":
        """Signal at some of the pulses, under their own times or others (s)."""
        t = self.times.times(pulses) if t is None else t
        each = PulseTimes(t, np.arange(pulses.size), pulses.size, self.prf)
        return replace(self, x=self.x[..., pulses], times=each)

    def summed(self) -> "Signal":
        """Signal of one row, the coherent sum over all."""
        return replace(self, x=self.x.sum(axis=1, keepdims=True), ranges=None, first=0)

    def columns(self, width: int) -> "Signal":
        """Signal at the pulses that a range-time map of a width shows.

        They are `shown_pulses`, or with gaps those nearest to even times, under these.
        """
        if len(self.times) == 1:
            return self.at(shown_pulses(self.pulses, width))
        first, last = self.times.times(np.array([0, self.pulses - 1]))
        even = first + (np.arange(width) + 0.5) / width * (last - first)
        return self.at(nearest(self.t, even), even)

    def stretches(self, least: int) -> "Signal":
        """Signal of the stretches that have at least so many pulses."""
        is_long = self.times.lengths >= least
        if is_long.all():
            return self
        parts = [
            self.x[..., part] for part, long in zip(self.times.slices, is_long, strict=True) if long
        ]
        return replace(self, x=np.concatenate(parts, axis=-1), times=self.times.only(is_long))

    def cancelled(self, canceller: Canceller, spans: Sequence[slice] | None = None) -> "Signal":
        """Signal after a canceller, stretch by stretch; those too short for it are left out.

        Args:
            spans: Pulses of each row that count, of a signal without gaps; others become 0.
        """
        long = self.stretches(canceller.lost + 1)
        times = long.times.shortened(canceller.lost, canceller.delay)
        if spans is not None:
            x = np.zeros((*self.x.shape[:-1], times.pulses), self.x.dtype)
            for row, span in enumerate(spans):
                if span.stop - span.start > canceller.lost:
                    pulses = slice(span.start, span.stop - canceller.lost)
                    x[:, row, pulses] = canceller(self.x[:, row, span])
        else:
            parts = [canceller(long.x[..., part]) for part in long.times.slices]
            x = parts[0] if len(parts) == 1 else np.concatenate(parts, axis=-1)
        return replace(self, x=x, times=times)
