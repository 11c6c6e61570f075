"""S1: people who stand; all that moves are they themselves (idle.py)."""

from dataclasses import dataclass
from math import inf

from radhar_cli.motion.human.minimum_jerk import Course
from radhar_cli.motion.human.part import Phase
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import Planted, resting_channels


@dataclass(frozen=True)
class Stand:
    """Stands for `duration` s."""

    duration: float = inf

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        course = Course.of(resting_channels(person), ())
        return Planted(person, course, begin, begin + self.duration, (Phase(begin, "standing"),))
