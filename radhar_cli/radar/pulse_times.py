"""Times of pulses: even trains with gaps between them."""

from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.numerics.arrays import Float


@dataclass(frozen=True, eq=False)
class PulseTimes:
    """Times of pulses, evenly spaced in stretches with gaps between.

    Attributes:
        start: Time of the first pulse of each stretch [S], s.
        first: Number of the first pulse of each stretch [S].
        pulses: Number of all pulses.
        prf: Pulses per second within a stretch, Hz.
    """

    start: Float
    first: NDArray[np.int64]
    pulses: int
    prf: float

    @classmethod
    def even(cls, pulses: int, prf: float, start: float = 0.0) -> "PulseTimes":
        """Pulses without a gap, from `start` (s) on."""
        return cls(np.array([start]), np.zeros(1, np.int64), pulses, prf)

    def __len__(self) -> int:
        return self.first.size

    @property
    def lengths(self) -> NDArray[np.int64]:
        """Number of pulses of each stretch [S]."""
        return np.diff(self.first, append=self.pulses)

    @property
    def slices(self) -> list[slice]:
        """Slice of the pulses of each stretch [S]."""
        return [slice(*edges) for edges in pairwise([*self.first.tolist(), self.pulses])]

    @property
    def duration(self) -> float:
        """Time from the first pulse to the end of the last, s."""
        return float(self.start[-1] - self.start[0] + self.lengths[-1] / self.prf)

    def times(self, pulses: NDArray[Any]) -> Float:
        """Times (s) of pulse numbers [...]."""
        if len(self) == 1:
            return np.asarray(self.start[0] + pulses / self.prf)
        stretch = np.searchsorted(self.first, pulses, side="right") - 1
        return np.asarray(self.start[stretch] + (pulses - self.first[stretch]) / self.prf)

    def only(self, chosen: NDArray[np.bool_]) -> "PulseTimes":
        """The chosen stretches [S], with their pulses numbered anew."""
        lengths = self.lengths[chosen]
        first = np.cumsum(lengths) - lengths
        return PulseTimes(self.start[chosen], first, int(lengths.sum()), self.prf)

    def shortened(self, lost: int, later: float) -> "PulseTimes":
        """Stretches as a filter along them leaves them.

        Args:
            lost: Number of pulses that each loses; all are longer.
            later: Number of pulse intervals by which each begins later.
        """
        lengths = self.lengths - lost
        start, first = self.start + later / self.prf, np.cumsum(lengths) - lengths
        return PulseTimes(start, first, int(lengths.sum()), self.prf)
