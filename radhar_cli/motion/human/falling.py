"""The second half of S12: a fall over planted feet while the legs buckle.

Speeds of real falls: Choi, Wakeling and Robinovitch, J. Biomechanics 48 (2015) 911: pelvis
2.1 +- 0.6, head 2.9 +- 0.9 m/s.
"""

from dataclasses import dataclass, field
from math import acos, radians

from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.part import LYING, STANDING, Phase
from radhar_cli.motion.human.person import Person
from radhar_cli.motion.human.planted import (
    ELBOWS,
    SHOULDERS,
    Planted,
    at_rest,
    both,
    posture,
    timed,
)


@dataclass(frozen=True)
class Prone:
    """How people lie after a fall ahead: height of the knees in m, angles in rad."""

    knee_height: float = 0.10
    thigh: float = radians(90)
    trunk: float = radians(88)
    shoulder: float = radians(165)

    def posture(self, person: Person) -> dict[str, float]:
        """The posture on the floor."""
        shank = acos((self.knee_height - person.ankle) / person.leg)
        return posture(
            shank, self.thigh, self.trunk, self.shoulder, person.elbow, standing=0.0, upright=0.0
        )


@dataclass(frozen=True)
class FallForward:
    """From standing over the knees to lying; `duration` (s) from the loss of balance to impact.

    Attributes:
        buckle: by how much the thighs give way at first, rad.
        catch: flexion of the elbows on the way, rad.
    """

    duration: float = 1.1
    prone: Prone = field(default_factory=Prone)
    buckle: float = radians(26)
    catch: float = radians(30)

    def part(self, person: Person, begin: float, horizon: float = 0.0) -> Planted:
        """The movement from `begin` (s) on."""
        rest, prone = at_rest(person), self.prone.posture(person)
        change = {channel: prone[channel] - rest[channel] for channel in rest}
        steps = [
            Step("shank", change["shank"], 0.0, 0.78, late=True),
            Step("thigh", change["thigh"], 0.08, 0.92, late=True),
            Step("thigh", -self.buckle, 0.0, 0.50),
            Step("thigh", self.buckle, 0.42, 0.58),
            Step("trunk", change["trunk"], 0.10, 1.0, late=True),
            *both(SHOULDERS, change["right_shoulder"], 0.05, 1.0),
            *both(ELBOWS, self.catch, 0.1, 0.4),
            *both(ELBOWS, -self.catch, 0.6, 0.4),
            Step("standing", -1.0, 0.0, 0.5),
            Step("upright", -1.0, 0.0, 1.0),
        ]
        course = Course.of(rest, timed(steps, begin, self.duration))
        end = begin + 1.1 * self.duration
        phases = (Phase(begin, "falling"), Phase(end, "lying"))
        return Planted(person, course, begin, end, phases, STANDING, LYING)
