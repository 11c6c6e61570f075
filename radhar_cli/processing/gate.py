"""A range gate: STFTs of the bins around the torso, summed incoherently.

Public data sets show such maps; the paper adds up all bins coherently before the transform. The
bins of a frame are fixed, so that no bin's signal is switched on or off within one.
"""

from dataclasses import dataclass
from math import floor

import numpy as np

from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.processing.frames import Frames


@dataclass(frozen=True, eq=False)
class Gate:
    """The range bins that each frame shows: first[l] .. first[l] + count - 1."""

    first: Index  # first bin of each frame [frames], or [1] where all frames show the same
    count: int  # number of bins

    @property
    def bins(self) -> slice:
        """Range bins that any frame shows."""
        return slice(int(self.first.min()), int(self.first.max()) + self.count)

    def needed(self, frames: Frames, pulses: int, margin: int) -> tuple[Index, Index]:
        """Range bins that are needed at each pulse: those of the frames to which it belongs.

        Args:
            frames: Frames of the transform.
            pulses: Number M of pulses.
            margin: Number of pulses beside a frame on which its samples depend.

        Returns:
            First bin [M], and last bin + 1 [M].
        """
        if self.first.size == 1:
            return np.full(pulses, self.bins.start), np.full(pulses, self.bins.stop)
        low, high = np.full(pulses, self.bins.stop), np.full(pulses, self.bins.start)
        for frame, first in enumerate(self.first):
            start = frame * frames.hop
            span = slice(max(start - margin, 0), start + frames.length + margin)
            low[span] = np.minimum(low[span], first)
            high[span] = np.maximum(high[span], first + self.count)
        return low, high

    def spans(self, needed: tuple[Index, Index]) -> list[slice]:
        """Pulses for each of `bins`, from the first to the last that needs it (`needed`)."""
        low, high = needed
        spans = []
        for k in range(self.bins.start, self.bins.stop):
            (pulses,) = np.nonzero((low <= k) & (k < high))
            spans.append(slice(int(pulses[0]), int(pulses[-1]) + 1) if pulses.size else slice(0, 0))
        return spans


def around(torso: Float, within: float, ranges: Float) -> Gate:
    """Gate of the 2 floor(within/step) + 1 bins about the torso, shifted into the axis.

    Args:
        torso: Range of the torso in the middle of every frame [frames], m.
        within: Half width of the gate, m.
        ranges: Evenly spaced ranges of the bins, m.
    """
    step = _step(ranges)
    count = min(2 * floor(within / step) + 1, ranges.size)
    first = np.rint((torso - ranges[0]) / step) - count // 2
    return Gate(np.clip(first, 0, ranges.size - count).astype(np.intp), count)


def interval(low: float, high: float, ranges: Float) -> Gate:
    """Gate of every frame from the bin nearest to `low` to the bin nearest to `high` (m)."""
    bins = np.rint((np.array([low, high]) - ranges[0]) / _step(ranges))
    first, last = np.clip(bins, 0, ranges.size - 1).astype(np.intp)
    return Gate(np.array([first]), int(last - first) + 1)


def _step(ranges: Float) -> float:
    """Spacing of ranges, m; 1 for a single one."""
    return float(ranges[1] - ranges[0]) if ranges.size > 1 else 1.0
