"""S5 and S6: sitting down is standing up backwards in time.

Angles lean ahead to bring the body over the feet, then legs and trunk extend. Minimum jerk
through a posture on the way: Yamasaki et al., 2014.
"""

from dataclasses import dataclass, field, replace
from math import acos, cos, radians

from radhar_cli.motion.human.minimum_jerk import Course, Lags, Step, mirrored
from radhar_cli.motion.human.part import SEATED, STANDING, Phase
from radhar_cli.motion.human.physique import Physique
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
class Seat:
    """How people sit: height of the hip over stature, angles in rad, `recline` backwards."""

    height: float = 0.285
    shank: float = radians(8)
    shoulder: float = radians(35)
    elbow: float = radians(53)
    recline: float = 0.0
    # how far the hands are on the lap, where shoulders and elbows are flexed as given; 0 is hanging
    # beside the seat
    lap: float = 1.0

    def posture(self, person: Physique) -> dict[str, float]:
        rise = self.height * person.stature - person.ankle - person.leg * cos(self.shank)
        thigh = -acos(rise / person.leg)
        shoulder, hanging = self.lap * self.shoulder, (1 - self.lap) * person.elbow
        return posture(self.shank, thigh, -self.recline, shoulder, self.lap * self.elbow + hanging)


@dataclass(frozen=True)
class Rise:
    """How people stand up: angles in rad, seat to standing in 1 unit of time."""

    lean: float = radians(42)  # of the trunk ahead while the body leaves the seat
    swing: float = radians(20)  # of the arms ahead
    shin: float = radians(14)  # of the shanks ahead, beyond the seated angle

    def steps(self, person: Physique, seat: Seat) -> list[Step]:
        """From seat to standing, in units of the duration."""
        seated, rest = seat.posture(person), at_rest(person)

        def to_rest(channel: str, start: float, length: float) -> Step:
            return Step(channel, rest[channel] - seated[channel], start, length)

        return [
            Step("shank", self.shin, 0.18, 0.34),
            Step("shank", -self.shin, 0.50, 0.50),
            to_rest("shank", 0.45, 0.55),
            to_rest("thigh", 0.30, 0.70),
            to_rest("trunk", 0.0, 0.45),
            Step("trunk", self.lean, 0.0, 0.50),
            Step("trunk", -self.lean, 0.38, 0.62),
            *both(SHOULDERS, self.swing, 0.05, 0.45),
            *both(SHOULDERS, -self.swing, 0.45, 0.50),
            *(to_rest(channel, 0.4, 0.5) for channel in (*SHOULDERS, *ELBOWS)),
            to_rest("standing", 0.3, 0.7),
        ]


@dataclass(frozen=True)
class StandUp:
    """From a seat to standing within `duration` s; `lags` has which joints lead."""

    duration: float = 1.8
    seat: Seat = field(default_factory=Seat)
    rise: Rise = field(default_factory=Rise)
    lags: Lags = field(default_factory=Lags)

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        steps = timed(self.lags(self.rise.steps(person, self.seat)), begin, self.duration)
        course = Course.of(self.seat.posture(person), steps)
        end = begin + self.duration
        phases = (Phase(begin, "standing up"), Phase(end, "standing"))
        return Planted(person, course, begin, end, phases, SEATED, STANDING)


@dataclass(frozen=True)
class SitDown:
    """From standing to a seat within `duration` s, then back against the chair if it reclines."""

    duration: float = 2.0
    seat: Seat = field(default_factory=Seat)
    rise: Rise = field(default_factory=Rise)
    # the trunk leans back from that share of the duration on, for so long in s
    recline: tuple[float, float] = (0.45, 1.0)
    lags: Lags = field(default_factory=Lags)  # which joints lead and which lag

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        upright = replace(self.seat, recline=0.0)
        steps = self.lags(mirrored(self.rise.steps(person, upright), 1.0))
        backwards = timed(steps, begin, self.duration)
        end = begin + self.duration
        if self.seat.recline:
            share, length = self.recline
            leans = begin + share * self.duration
            backwards.append(Step("trunk", -self.seat.recline, leans, length))
            end = max(end, leans + length)
        course = Course.of(at_rest(person), backwards)
        phases = (Phase(begin, "sitting down"), Phase(end, "seated"))
        return Planted(person, course, begin, end, phases, STANDING, SEATED)
