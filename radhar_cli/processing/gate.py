"""A range gate: STFTs of the bins around the torso, summed incoherently.

What public data sets show, where the paper adds up all bins coherently before the transform. The
bins of a frame are fixed, so that no bin's signal is switched on or off within one.
"""

from dataclasses import dataclass
from math import floor

import numpy as np

from radhar_cli.arrays import Float, Index
from radhar_cli.processing.frames import Frames


@dataclass(frozen=True, eq=False)
class Gate:
    """The range bins that each frame shows: first[l] .. first[l] + count - 1."""

    first: Index  # [frames], or [1] where all frames show the same
    count: int  # of bins

    @property
    def bins(self) -> slice:
        """All that any frame shows."""
        return slice(int(self.first.min()), int(self.first.max()) + self.count)

    def needed(self, frames: Frames, pulses: int, more: int) -> tuple[Index, Index]:
        """(first [M], last + 1 [M]) of the bins that some frame shows which a pulse belongs to.

        Samples depend on `more` pulses beside a frame.
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

    Of the torso's range in the middle of every frame [frames], and evenly spaced ranges, m.
    """
    step = _step(ranges)
    count = min(2 * floor(within / step) + 1, ranges.size)
    first = np.rint((torso - ranges[0]) / step) - count // 2
    return Gate(np.clip(first, 0, ranges.size - count).astype(np.intp), count)


def interval(low: float, high: float, ranges: Float) -> Gate:
    """From the bin nearest to one range (m) to the bin nearest to another, in every frame."""
    bins = np.rint((np.array([low, high]) - ranges[0]) / _step(ranges))
    first, last = np.clip(bins, 0, ranges.size - 1).astype(np.intp)
    return Gate(np.array([first]), int(last - first) + 1)


def _step(ranges: Float) -> float:
    return float(ranges[1] - ranges[0]) if ranges.size > 1 else 1.0
