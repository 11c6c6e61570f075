"""The second half of S12: falls from standing, over planted feet while the legs buckle.

Speeds of real falls: Choi, Wakeling and Robinovitch, J. Biomechanics 48 (2015) 911: pelvis
2.1 +- 0.6, head 2.9 +- 0.9, hand 2.9 +- 1.6 m/s; 1.3 +- 0.6 s from the loss of balance to impact.
"""

from dataclasses import dataclass, field, replace
from math import acos, cos, radians, sin
from typing import Annotated, ClassVar, Generic, Literal, TypeAlias

from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.part import LYING, STANDING, Phase
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import (
    ELBOWS,
    SHOULDERS,
    Planted,
    posture,
    resting_channels,
    scale_steps,
    steps_of_both_sides,
)
from radhar_cli.motion.movements.falling_sideways import FallSideways
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.words import ON_FLOOR as FLOOR
from radhar_cli.schema.annotations import UNSTEADY, ByModel, Paper, People
from radhar_cli.schema.number import ANGLE, NOT_NEGATIVE, SECONDS, Choice, Weighted, normal, uniform
from radhar_cli.schema.section import B, ByActivity, Section, default_draw

FallName = Literal["forward", "backward", "sideways"]


FALLS: tuple[FallName, ...] = FallName.__args__  # type: ignore[attr-defined]


class Falls(Weighted, Section):
    """``{choice: [forward, sideways], weights: [2, 1]}``: one of the directions."""

    NUMBERS: ClassVar[tuple[str, ...]] = ()  # weights are not drawn

    choice: tuple[FallName, ...]

    def at_rank(self, u: float) -> FallName:
        """Direction below which a fraction u of the draws lie, in the order of FALLS."""
        places = tuple(float(FALLS.index(name)) for name in self.choice)
        return FALLS[int(Choice(choice=places, weights=self.weights).quantile(u))]


class FallingConfig(Section, Generic[B]):
    """Falling, stumbling and landing."""

    direction: Annotated[FallName | Falls, People(None)] = "forward"
    """Direction of a fall or stumble: forward, backward, sideways, or drawn: {choice: [forward,
    sideways], weights: [2, 1]}."""
    heels_deg: Annotated[B, ByActivity(ANGLE), People("falling", 0, 90), UNSTEADY] = default_draw(
        0.0
    )
    """Angle by which the shanks swing up as people land on their knees in a forward fall."""
    stumble_deg: Annotated[B, ByActivity(ANGLE), People(None, 0, 45)] = default_draw(
        uniform(15.0, 40.0)
    )
    """Angle of the trunk ahead before a stumble is caught; backwards and sideways it is 0.4 of
    that."""


class FallingTiming(Section, Generic[B]):
    """Duration of a fall after a walk."""

    fall_duration_s: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, SECONDS, null=True),
        People("S12", 0.7, 10),
        Paper("S12"),
        ByModel(human=normal(1.1, 0.4, 0.9, 2.0), paper=0.8),
    ] = default_draw(None)
    """Duration of the fall after a walk."""


SECTION, TIMING = FallingConfig, FallingTiming
DIRECTION = "falling.direction"

GIVE = radians(9)  # by how much the trunk goes on over arms that break a fall
LANDED = 0.7  # share of the duration after which the knees are down
SWING = 0.35, 0.45  # durations in which the shanks swing up and down, s
PRONE, SUPINE, ON_FOURS = "lying prone", "lying on the back", "lying on hands and knees"
ON_FLOOR, PROPPED = "lying against the seat", "lying on the hands"


@dataclass(frozen=True)
class Prone:
    """Posture after a fall ahead: height of the knees over the stature, angles in rad."""

    knee_height: float = 0.05
    thigh: float = radians(90)  # or in line with the shank, where that is less
    trunk: float = radians(88)
    # place of the hands ahead of and outside the shoulders, fractions of the stature
    hands: tuple[float, float] = (0.12, 0.07)

    def posture(self, person: Physique) -> dict[str, float]:
        """Channels of `planted.posture` on the floor, hands beside the head, elbows on it."""
        shank = acos((self.knee_height * person.stature - person.ankle) / person.leg)
        thigh = min(self.thigh, shank)
        lying = posture(shank, thigh, self.trunk, 0.0, person.elbow, upright=0.0)
        shoulders = person.leg * (sin(shank) + sin(thigh))
        shoulders += (person.trunk + person.shoulder) * sin(self.trunk)
        lying["hands"] = 1.0
        lying["hands_ahead"] = shoulders + self.hands[0] * person.stature
        lying["hands_beside"] = person.shoulder + self.hands[1] * person.stature
        lying["splayed"] = 1.0
        return lying


@dataclass(frozen=True)
class OnFours(Prone):
    """Posture on hands and knees, of people who broke a fall with the hands."""

    thigh: float = radians(4)
    trunk: float = radians(84)
    reach: float = 0.57  # distance of the hands ahead of the ankles, fraction of the stature

    def posture(self, person: Physique) -> dict[str, float]:
        hands = {"hands_ahead": self.reach * person.stature, "hands_beside": person.shoulder}
        return super().posture(person) | hands | {"splayed": 0.0}


@dataclass(frozen=True)
class FallForward:
    """Falls from standing over the knees, within `duration` s from the loss of balance to impact.

    A person who ends on hands and knees has broken the fall with the hands: the arms give way,
    then push the trunk back.
    """

    duration: float = 1.1
    prone: Prone = field(default_factory=Prone)
    buckle: float = radians(26)  # by how much the thighs give way at first, rad
    arms: float = radians(80)  # flexion of the shoulders as the hands look for the floor, rad
    heels: float = 0.0  # how far the shanks swing up behind the knees on which the body lands, rad

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        rest, prone = resting_channels(person), self.prone.posture(person)
        change = {channel: prone[channel] - rest[channel] for channel in rest}
        rest |= {channel: prone[channel] for channel in ("hands_ahead", "hands_beside")}
        steps = [
            Step("shank", change["shank"], 0.0, 0.78, late=True),
            Step("thigh", change["thigh"], 0.08, 0.92, late=True),
            Step("thigh", -self.buckle, 0.0, 0.50),
            Step("thigh", self.buckle, 0.42, 0.58),
            Step("trunk", change["trunk"], 0.10, 1.0, late=True),
            *steps_of_both_sides(SHOULDERS, self.arms, 0.05, 0.7),
            Step("hands", 1.0, 0.25, 0.65),
            Step("splayed", change["splayed"], 0.30, 0.60),  # after a walk that the fall overlaps
        ]
        if self.heels:
            up, down = (time / self.duration for time in SWING)
            steps += [
                Step("heels", self.heels, LANDED, up),
                Step("heels", -self.heels, LANDED + up, down),
            ]
        if not isinstance(self.prone, OnFours):
            return _fall_from_standing(person, begin, self.duration, rest, steps, PRONE)
        steps += [Step("trunk", GIVE, 0.7, 0.35), Step("trunk", -GIVE, 1.05, 0.6)]
        return _fall_from_standing(person, begin, self.duration, rest, steps, ON_FOURS)


@dataclass(frozen=True)
class Supine:
    """Posture after a fall backwards: height of the hip in m, angles in rad."""

    hip_height: float = 0.10
    shank: float = radians(-55)
    trunk: float = radians(-88)
    shoulder: float = radians(15)
    elbow: float = radians(25)

    def posture(self, person: Physique) -> dict[str, float]:
        """Channels of `planted.posture` on the back, knees up."""
        rise = (self.hip_height - person.ankle) / person.leg - cos(self.shank)
        return posture(self.shank, -acos(rise), self.trunk, self.shoulder, self.elbow, upright=0.0)


@dataclass(frozen=True)
class Sitting:
    """Posture of sitting on the floor, knees up, hands down; lengths are over the stature."""

    hip_height: float = 0.057
    shank: float = radians(-55)
    trunk: float = radians(-40)
    feet: float = 0.0  # how far they slid ahead
    # place of the hands behind the hip, and beside the shoulders
    hands: tuple[float, float] = (0.22, 0.06)

    def posture(self, person: Physique) -> dict[str, float]:
        """Channels of `planted.posture` on the buttocks, hands on the floor behind them."""
        leg, stature = person.leg, person.stature
        rise = (self.hip_height * stature - person.ankle) / leg - cos(self.shank)
        sitting = posture(self.shank, -acos(rise), self.trunk, 0.0, person.elbow, upright=0.0)
        hip = self.feet * stature + leg * (sin(self.shank) - sin(acos(rise)))
        return sitting | {
            "feet": self.feet * stature,
            "hands": 1.0,
            "hands_ahead": hip - self.hands[0] * stature,
            "hands_beside": person.shoulder + self.hands[1] * stature,
        }


AGAINST_SEAT = Sitting(shank=radians(-45), trunk=radians(-18), feet=0.30, hands=(0.0, 0.13))


@dataclass(frozen=True)
class FallBackward:
    """Falls from standing onto the buttocks, then the back, within about `duration` s.

    A person who ends `Sitting` has broken the fall with the hands, which land with the pelvis
    (within 0.04 s: Hsiao and Robinovitch, J. Biomechanics 31 (1998) 1).
    """

    duration: float = 1.1  # to the impact of the trunk, s
    supine: "Supine | Sitting" = field(default_factory=Supine)
    bow: float = radians(28)  # by how much the trunk bends ahead at first, rad
    arms: float = radians(55)  # how far the arms go ahead at first, rad

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        rest, supine = resting_channels(person), self.supine.posture(person)
        change = {channel: supine[channel] - rest[channel] for channel in rest}
        steps = [
            Step("shank", change["shank"], 0.0, 0.90, late=True),
            Step("thigh", change["thigh"], 0.10, 0.75),
            Step("trunk", self.bow, 0.0, 0.55),
            Step("trunk", change["trunk"] - self.bow, 0.20, 0.90, late=True),
            *steps_of_both_sides(SHOULDERS, self.arms, 0.10, 0.50),
            *steps_of_both_sides(SHOULDERS, change["right_shoulder"] - self.arms, 0.55, 0.55),
            *steps_of_both_sides(ELBOWS, change["right_elbow"], 0.10, 0.90),
        ]
        if isinstance(self.supine, Supine):
            return _fall_from_standing(person, begin, self.duration, rest, steps, SUPINE)
        rest |= {channel: supine[channel] for channel in ("hands_ahead", "hands_beside")}
        steps.append(Step("hands", 1.0, 0.40, 0.48))
        return _fall_from_standing(person, begin, self.duration, rest, steps, PROPPED)


def _fall_from_standing(
    person: Physique,
    begin: float,
    duration: float,
    rest: dict[str, float],
    steps: list[Step],
    after: str,
) -> Planted:
    """Part of a fall in which the sway comes to its end.

    Args:
        begin: Time at which the balance is lost, s.
        duration: Unit of the steps, s.
        rest: Channels before the fall.
        steps: Changes of the channels.
        after: State in which the person lies.
    """
    steps += [Step("standing", -1.0, 0.0, 0.5), Step("upright", -1.0, 0.0, 1.0)]
    course = Course.of(rest, scale_steps(steps, begin, duration))
    end = max(course.breakpoints)
    phases = (Phase(begin, "falling"), Phase(end, "lying"))
    return Planted(person, course, begin, end, phases, STANDING, after)


Fall: TypeAlias = FallForward | FallBackward | FallSideways


def fall_direction(mover: Mover) -> FallName:
    """Direction in which a person falls or stumbles."""
    direction = mover.numbers(FallingConfig[float]).direction
    assert not isinstance(direction, Falls)  # drawn with the scene
    return direction


def draw_side(mover: Mover) -> float:
    """Draw the side of a fall: 1 to the left, -1 to the right."""
    return 1.0 if mover.stream("motion.fall/side").random() < 0.5 else -1.0


def make_fall(mover: Mover) -> Fall:
    """Make a person fall from standing."""
    match fall_direction(mover):
        case "forward":
            heels = radians(mover.numbers(FallingConfig[float]).heels_deg)
            return FallForward(mover.duration, Prone(), heels=heels)
        case "backward":
            return FallBackward(mover.duration, supine=Supine())
    return FallSideways(mover.duration, draw_side(mover))


def make_fall_on_hands(mover: Mover) -> Fall:
    """Make a person fall from standing who breaks the fall with the hands."""
    match make_fall(mover):
        case FallForward() as fall:
            return replace(fall, prone=OnFours())
        case FallBackward() as fall:
            return replace(fall, supine=Sitting())
        case fall:
            return replace(fall, caught=radians(36))


MOVEMENTS = (
    MovementKind(
        "falling",
        "falls from standing",
        make_fall,
        STANDING,
        LYING,
        1.1,
        uses=(DIRECTION,),
        words="fall fall_down falling_down collapsing sturz collapse fainting syncope",
        manners=f"{FLOOR} accidental sudden over",
        nearby="fallen fall_forward fall_backward falling_backwards fall_sideways slip slipping "
        "falling_forward falling_backward falling_left falling_right falling_aside",
    ),
    MovementKind(
        "falling_on_hands",
        "falls from standing, on the hands",
        make_fall_on_hands,
        STANDING,
        LYING,
        1.1,
        like="falling",
    ),
)
