"""S4: people who bend to pick something up from the floor."""

from dataclasses import dataclass, field
from math import radians

from radhar_cli.motion.human.minimum_jerk import Course, Lags, Step
from radhar_cli.motion.human.part import Phase
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import Planted, at_rest

# Further angles of shanks, thighs, trunk and reach of who squats, and of who stoops, over the
# trunk's.
SQUAT = 0.19, -0.25, -0.30, 0.35
STOOP = -0.33, 0.66, 0.25, 0.0


@dataclass(frozen=True)
class Grab:
    """Down, a dwell, and up, s; angles at the floor in rad."""

    down: float = 1.2
    dwell: float = 0.4
    up: float = 1.3
    shank: float = radians(20)
    thigh: float = radians(-62)
    trunk: float = radians(72)
    reach: float = radians(12)  # of the right arm ahead of the vertical
    other_arm: float = 0.55  # what the left arm does of what the right one does
    squat: float = 0.0  # from -1, over straight legs, to 1, deep in the knees
    haste: float = 0.0  # people come up before they are all the way down, by that share of `down`
    # lowering, rising: which joints lead and which lag
    lowering: Lags = field(default_factory=Lags)
    rising: Lags = field(default_factory=Lags)

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        rest = at_rest(person)
        shank, thigh, trunk, reach = (
            abs(self.squat) * further * self.trunk
            for further in (SQUAT if self.squat > 0 else STOOP)
        )
        trunk += self.trunk
        arm = trunk + self.reach + reach  # flexion is relative to the trunk
        bent = {
            "shank": self.shank + shank,
            "thigh": self.thigh + thigh,
            "trunk": trunk,
            "right_shoulder": arm,
            "left_shoulder": self.other_arm * arm + 0.5 * reach,
        }
        rises = begin + (1 - self.haste) * self.down + self.dwell
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
