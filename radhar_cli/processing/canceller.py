"""Cancellers of what stands still: moving target indication (paper, first equation of "RTM")."""

from dataclasses import dataclass

import numpy as np

from radhar_cli.arrays import Complex


@dataclass(frozen=True)
class Canceller:
    """y[..., m] = sum_k taps[k] s[..., m + k], the last axis being the pulses.

    Attributes:
        taps: earliest pulse first; (-1, 1) is the first difference, (1, -2, 1) the three-pulse
            canceller, (1,) none.
    """

    taps: tuple[float, ...]

    @property
    def lost(self) -> int:
        """Pulses by which the output is shorter than the input."""
        return len(self.taps) - 1

    @property
    def delay(self) -> float:
        """Pulse intervals by which an output lies after its first pulse: the middle of the taps."""
        return self.lost / 2

    def __call__(self, s: Complex) -> Complex:
        """[..., M] -> [..., M - lost]."""
        if self.taps == (1,):
            return s
        if self.taps == (-1, 1):
            return np.diff(s, axis=-1)
        kept = s.shape[-1] - self.lost
        y: Complex = self.taps[0] * s[..., :kept]
        for k, tap in enumerate(self.taps[1:], 1):
            y += tap * s[..., k : k + kept]
        return y


FIRST_DIFFERENCE = Canceller((-1, 1))
NO_CANCELLER = Canceller((1,))
