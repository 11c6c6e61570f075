"""When pulses are: even trains with gaps between them."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.arrays import Float


@dataclass(frozen=True, eq=False)
class PulseTimes:
    """Times of pulses, evenly spaced in stretches with gaps between."""

    start: Float  # time of the first pulse of each stretch, s [S]
    first: NDArray[np.int64]  # number of that pulse [S]
    pulses: int  # of all
    prf: float  # within each, Hz

    @classmethod
    def even(cls, pulses: int, prf: float, start: float = 0.0) -> "PulseTimes":
        """Without a gap, from `start` (s) on."""
        return cls(np.array([start]), np.zeros(1, np.int64), pulses, prf)

    def __len__(self) -> int:
        return self.first.size

    @property
    def lengths(self) -> NDArray[np.int64]:
        """How many pulses each has."""
        return np.diff(self.first, append=self.pulses)

    @property
    def slices(self) -> list[slice]:
        """Pulses of each."""
        return [slice(*edges) for edges in pairwise([*self.first.tolist(), self.pulses])]

    @property
    def duration(self) -> float:
        """From the first pulse to the end of the last, s."""
        return float(self.start[-1] - self.start[0] + self.lengths[-1] / self.prf)

    def times(self, pulses: NDArray[Any]) -> Float:
        """Times (s) of pulse numbers [...]."""
        if len(self) == 1:
            return np.asarray(self.start[0] + pulses / self.prf)
        at = np.searchsorted(self.first, pulses, side="right") - 1
        return np.asarray(self.start[at] + (pulses - self.first[at]) / self.prf)

    def only(self, kept: NDArray[np.bool_]) -> "PulseTimes":
        """Some of the stretches [S]."""
        lengths = self.lengths[kept]
        first = np.cumsum(lengths) - lengths
        return PulseTimes(self.start[kept], first, int(lengths.sum()), self.prf)

    def shortened(self, lost: int, later: float) -> "PulseTimes":
        """Stretches that are shorter by some pulses and begin later by so many intervals, each
        longer than that."""
        lengths = self.lengths - lost
        start, first = self.start + later / self.prf, np.cumsum(lengths) - lengths
        return PulseTimes(start, first, int(lengths.sum()), self.prf)
