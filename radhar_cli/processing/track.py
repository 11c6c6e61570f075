"""Tracks of a torso: its delay as a function of time, whoever knows it.

A simulation knows the delay at every pulse, a tracker at the middles of its frames. Bulk
compensation and gate ask for the times that they need, so that nothing is interpolated twice.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np

from radhar_cli.numerics.arrays import Float
from radhar_cli.numerics.constants import SPEED_OF_LIGHT


class Track(ABC):
    """Two-way delay of a torso as a function of time."""

    @abstractmethod
    def delay_at(self, t: Float) -> Float:
        """Two-way delay tau (s) at times t (s), in the shape of t."""

    def range_at(self, t: Float) -> Float:
        """Range c tau/2 (m) at times t (s), in the shape of t."""
        return self.delay_at(t) * (SPEED_OF_LIGHT / 2)


@dataclass(frozen=True, eq=False)
class PulseTrack(Track):
    """Track that is known at every pulse; between two pulses it is that of the nearer one."""

    time: Float  # times of the pulses [M], s, rising
    delay: Float  # two-way delays at these times [M], s

    def delay_at(self, t: Float) -> Float:
        pulse = np.interp(t, self.time, range(self.time.size))
        return self.delay[np.rint(np.round(pulse, 6)).astype(np.intp)]


@dataclass(frozen=True)
class StandingTrack(Track):
    """Track of a torso that stays at one range, m."""

    range: float

    def delay_at(self, t: Float) -> Float:
        return np.full(t.shape, self.range * 2 / SPEED_OF_LIGHT)
