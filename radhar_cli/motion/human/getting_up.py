"""The first half of S11: from lying prone over hands and knees to standing.

Young people take 3 to 4 s, those of 50 to 90 years 4.1 +- 1.1 s (Bohannon and Lusardi, 2004).
"""

from dataclasses import dataclass, field
from math import radians

from radhar_cli.motion.human.falling import PRONE, Prone
from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.part import STANDING, Phase
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import Planted, at_rest, timed


@dataclass(frozen=True)
class GetUp:
    """From lying prone to standing within `duration` s; angles in rad."""

    duration: float = 3.0
    prone: Prone = field(default_factory=Prone)
    hands: float = 0.57  # where they push, ahead of the ankles, fraction of the stature
    on_knees: float = radians(84)  # pitch of the trunk on hands and knees
    # shank, thigh, trunk: in the crouch that follows
    shank: float = radians(38)
    thigh: float = radians(-70)
    trunk: float = radians(50)

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        """The movement from `begin` (s) on."""
        prone, rest = self.prone.posture(person), at_rest(person)
        push = self.hands * person.stature
        steps = [
            Step("shank", self.shank - prone["shank"], 0.28, 0.34),
            Step("shank", rest["shank"] - self.shank, 0.56, 0.44),
            Step("thigh", self.thigh - prone["thigh"], 0.05, 0.55),
            Step("thigh", rest["thigh"] - self.thigh, 0.55, 0.45),
            Step("trunk", self.on_knees - prone["trunk"], 0.05, 0.30),
            Step("trunk", self.trunk - self.on_knees, 0.34, 0.28),
            Step("trunk", rest["trunk"] - self.trunk, 0.56, 0.44),
            Step("hands_ahead", push - prone["hands_ahead"], 0.0, 0.30),
            Step("hands_beside", person.shoulder - prone["hands_beside"], 0.0, 0.25),
            Step("hands", -1.0, 0.48, 0.42),
            Step("standing", 1.0, 0.5, 0.5),
            Step("upright", 1.0, 0.2, 0.8),
        ]
        course = Course.of(prone, timed(steps, begin, self.duration))
        end = begin + self.duration
        phases = (Phase(begin, "getting up"), Phase(end, "standing"))
        return Planted(person, course, begin, end, phases, PRONE, STANDING)
