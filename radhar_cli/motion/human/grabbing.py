"""S4: people who bend to pick something up from the floor."""

from dataclasses import dataclass, field
from math import radians

from radhar_cli.motion.human.minimum_jerk import Course, Lags, Step
from radhar_cli.motion.human.part import Phase
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import Planted, resting_channels


@dataclass(frozen=True)
class Grab:
    """Bends down within `down` s, dwells, and rises within `up` s; angles at the floor in rad.

    A negative dwell lets the rise begin before the descent ends, by at most 0.6 of it.
    """

    down: float = 1.2
    dwell: float = 0.4
    up: float = 1.3
    shank: float = radians(20)
    thigh: float = radians(-62)
    trunk: float = radians(72)
    reach: float = radians(12)  # angle of the right arm ahead of the vertical
    other_arm: float = 0.55  # flexion of the left shoulder over that of the right one
    # lowering, rising: which joints lead and which lag
    lowering: Lags = field(default_factory=Lags)
    rising: Lags = field(default_factory=Lags)

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        rest = resting_channels(person)
        arm = self.trunk + self.reach  # flexion is relative to the trunk
        bent = {
            "shank": self.shank,
            "thigh": self.thigh,
            "trunk": self.trunk,
            "right_shoulder": arm,
            "left_shoulder": self.other_arm * arm,
        }
        rises = begin + self.down + max(self.dwell, -0.6 * self.down)
        steps = self.lowering(
            Step(channel, angle - rest[channel], begin, self.down)
            for channel, angle in bent.items()
        )
        steps += self.rising(
            Step(channel, rest[channel] - angle, rises, self.up) for channel, angle in bent.items()
        )
        end = rises + self.up
        phases = (Phase(begin, "picking up"), Phase(end, "standing"))
        return Planted(person, Course.of(rest, steps), begin, end, phases)
