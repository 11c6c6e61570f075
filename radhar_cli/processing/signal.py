"""Slow-time signals of channels and range bins, simulated or recorded."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np

from radhar_cli.arrays import Complex, Float, Index
from radhar_cli.processing.canceller import Canceller


def shown_pulses(count: int, width: int) -> Index:
    """Columns of a range-time map: m_j = floor((j + 1/2) count/width), all if count < width."""
    if count <= width:
        return np.arange(count)
    return (2 * np.arange(width) + 1) * count // (2 * width)


def nearest(values: Float, wanted: Float) -> Index:
    """Numbers of the rising values nearest to those wanted."""
    middles = (values[1:] + values[:-1]) / 2
    return np.searchsorted(middles, wanted)


@dataclass(frozen=True)
class Signal:
    """Complex samples of receive channels and range bins, pulse by pulse.

    Attributes:
        x: [channel, row, pulse]; rows are range bins, or one coherent sum over them.
        t: times of the pulses [M], s; rising, 1/PRF apart but for gaps.
        prf: pulses per second between gaps, Hz.
        f0: frequency at which the Doppler is read, Hz.
        ranges: of the rows, m; None of a sum over range.
        first: number of the first row's range bin, as a `Gate` counts them.
    """

    x: Complex
    t: Float
    prf: float
    f0: float
    ranges: Float | None = None
    first: int = 0

    @property
    def pulses(self) -> int:
        """M."""
        return self.t.size

    @cached_property
    def stretches(self) -> list[slice]:
        """Consecutive pulses without a gap between them."""
        gaps = np.flatnonzero(np.diff(self.t) > 1.5 / self.prf) + 1
        edges = [0, *gaps.tolist(), self.pulses]
        return [slice(*pair) for pair in pairwise(edges)]

    def with_samples(self, x: Complex) -> "Signal":
        """The same with other samples."""
        return replace(self, x=x)

    def at(self, pulses: Index) -> "Signal":
        """Some of the pulses."""
        return replace(self, x=self.x[..., pulses], t=self.t[pulses])

    def summed(self) -> "Signal":
        """The coherent sum over the rows."""
        return replace(self, x=self.x.sum(axis=1, keepdims=True), ranges=None, first=0)

    def columns(self, width: int) -> "Signal":
        """The pulses that a range-time map shows: `shown_pulses`, or over gaps nearest to even
        times, which they are given."""
        if len(self.stretches) == 1:
            return self.at(shown_pulses(self.pulses, width))
        even = self.t[0] + (np.arange(width) + 0.5) / width * (self.t[-1] - self.t[0])
        return replace(self.at(nearest(self.t, even)), t=even)

    def cancelled(self, canceller: Canceller, spans: Sequence[slice] | None = None) -> "Signal":
        """The same after a canceller, stretch by stretch; those too short for it are left out.

        Args:
            canceller: along the pulses.
            spans: pulses of each row that count, of a signal without gaps; the others become 0.
        """
        if spans is not None:
            x = np.zeros((*self.x.shape[:-1], self.pulses - canceller.lost), self.x.dtype)
            for row, span in enumerate(spans):
                if span.stop - span.start > canceller.lost:
                    some = slice(span.start, span.stop - canceller.lost)
                    x[:, row, some] = canceller(self.x[:, row, span])
            kept = [slice(self.pulses)]
        else:
            kept = [part for part in self.stretches if part.stop - part.start > canceller.lost]
            parts = [canceller(self.x[..., part]) for part in kept]
            x = parts[0] if len(parts) == 1 else np.concatenate(parts, axis=-1)
        t = np.concatenate([self.t[part.start : part.stop - canceller.lost] for part in kept])
        return replace(self, x=x, t=t + canceller.delay / self.prf)
