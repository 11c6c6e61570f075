"""S4: people who bend to pick something up from the floor."""

from dataclasses import dataclass
from math import radians

from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.part import Phase
from radhar_cli.motion.human.person import Person
from radhar_cli.motion.human.planted import Planted, at_rest


@dataclass(frozen=True)
class Grab:
    """Down, a dwell, and up, s; angles at the floor in rad.

    Attributes:
        reach: of the right arm ahead of the vertical.
        other_arm: what the left arm does of what the right one does.
    """

    down: float = 1.2
    dwell: float = 0.4
    up: float = 1.3
    shank: float = radians(20)
    thigh: float = radians(-62)
    trunk: float = radians(72)
    reach: float = radians(12)
    other_arm: float = 0.55

    def part(self, person: Person, begin: float, horizon: float = 0.0) -> Planted:
        """The movement from `begin` (s) on."""
        rest = at_rest(person)
        arm = self.trunk + self.reach  # flexion is relative to the trunk
        bent = {
            "shank": self.shank,
            "thigh": self.thigh,
            "trunk": self.trunk,
            "right_shoulder": arm,
            "left_shoulder": self.other_arm * arm,
        }
        rising = begin + self.down + self.dwell
        steps = [
            step
            for channel, angle in bent.items()
            for step in (
                Step(channel, angle - rest[channel], begin, self.down),
                Step(channel, rest[channel] - angle, rising, self.up),
            )
        ]
        end = rising + self.up
        phases = (Phase(begin, "picking up"), Phase(end, "standing"))
        return Planted(person, Course.of(rest, steps), begin, end, phases)
