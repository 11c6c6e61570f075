"""S5 and S6: sitting down is standing up backwards in time.

Angles lean ahead to bring the body over the feet, then legs and trunk extend. Minimum jerk
through a posture on the way: Yamasaki et al., 2014.
"""

from dataclasses import dataclass, field, replace
from math import acos, cos, inf, radians
from typing import Annotated, Generic

from radhar_cli.motion.human.minimum_jerk import Course, Lags, Step, mirrored
from radhar_cli.motion.human.part import SEATED, STANDING, Phase
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
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.transitions import draw_lags
from radhar_cli.motion.movements.words import OFF_SEATS, ONTO_SEATS, join_words
from radhar_cli.schema.annotations import PERSONAL, ByModel, Paper, People
from radhar_cli.schema.number import ANGLE, NOT_NEGATIVE, RATIO, SECONDS, normal
from radhar_cli.schema.section import B, ByActivity, Section, by_activity, default_draw


class SittingConfig(Section, Generic[B]):
    """Sitting down, sitting, and standing up."""

    seat_height: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(None, 0.24, 0.33)] = (
        default_draw(normal(0.285, 0.015, 0.25, 0.32))
    )
    """Height of the seated hip, relative to the stature."""
    lean_deg: Annotated[B, ByActivity(ANGLE), People(None, 0, 60), PERSONAL] = default_draw(
        normal(42.0, 8.0, 25.0, 58.0)
    )
    """Forward pitch of the trunk while sitting down or rising."""
    recline_deg: Annotated[B, ByActivity(ANGLE), People(None, -10, 45)] = default_draw(0.0)
    """Backward pitch of the trunk in the seat."""
    hands_on_lap: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(None, 0, 1)] = default_draw(
        1.0
    )
    """Place of a seated person's hands: 0 is beside the seat, 1 on the lap."""


class SittingTiming(Section, Generic[B]):
    """Beginnings and durations of sitting down and standing up."""

    seat_start_s: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, SECONDS, null=True),
        People("S5 S6"),
        Paper("S5 S6"),
        ByModel(paper=0.5),
    ] = default_draw(None)
    """Beginning of sitting down or standing up; null of people is by timing.onset."""
    seat_duration_s: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, SECONDS, null=True),
        People("S5 S6", 1, 60),
        Paper("S5 S6"),
        ByModel(
            human=by_activity(normal(2.0, 0.4, 1.3, 3.0), standing_up=normal(1.8, 0.4, 1.2, 3.0)),
            paper=2.0,
        ),
    ] = default_draw(None)
    """Duration of sitting down or standing up."""
    rise_start_s: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, SECONDS, null=True),
        People("S9 S11"),
        Paper("S9 S11"),
        ByModel(paper=0.5),
    ] = default_draw(None)
    """Beginning of standing up or getting up before a walk; null of people is by timing.onset."""
    rise_duration_s: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, SECONDS, null=True),
        People("S9 S11", 1, 60),
        Paper("S9 S11"),
        ByModel(
            human=by_activity(
                normal(1.8, 0.25, 1.2, 3.0), falling_to_walking=normal(3.0, 0.5, 2.2, 4.5)
            ),
            paper=1.5,
        ),
    ] = default_draw(None)
    """Duration of standing up or getting up before a walk."""
    sit_duration_s: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, SECONDS, null=True),
        People("S10", 1, 60),
        Paper("S10"),
        ByModel(human=normal(2.0, 0.25, 1.3, 3.0), paper=1.5),
    ] = default_draw(None)
    """Duration of sitting down after a walk."""


SECTION, TIMING = SittingConfig, SittingTiming
# Keys of a person who sits, and of a person who comes from a seat or goes to it.
SEAT = ("sitting.seat_height", "sitting.recline_deg", "sitting.hands_on_lap")
LEAN = "sitting.lean_deg"


@dataclass(frozen=True)
class Seat:
    """Seated posture: height of the hip over the stature, angles in rad, `recline` backwards."""

    height: float = 0.285
    shank: float = radians(8)
    shoulder: float = radians(35)
    elbow: float = radians(53)
    recline: float = 0.0
    # how far the hands are on the lap, with the flexion above; 0 hangs them beside the seat
    lap: float = 1.0

    def posture(self, person: Physique) -> dict[str, float]:
        """Channels of `planted.posture` on the seat."""
        rise = self.height * person.stature - person.ankle - person.leg * cos(self.shank)
        thigh = -acos(rise / person.leg)
        shoulder, hanging = self.lap * self.shoulder, (1 - self.lap) * person.elbow
        return posture(self.shank, thigh, -self.recline, shoulder, self.lap * self.elbow + hanging)


@dataclass(frozen=True)
class Rise:
    """Way of standing up; angles in rad."""

    lean: float = radians(42)  # lean of the trunk ahead while the body leaves the seat
    swing: float = radians(20)  # swing of the arms ahead
    shin: float = radians(14)  # lean of the shanks ahead, beyond the seated angle

    def steps(self, person: Physique, seat: Seat) -> list[Step]:
        """Steps from the seat to standing, in units of the duration."""
        seated, rest = seat.posture(person), resting_channels(person)

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
            *steps_of_both_sides(SHOULDERS, self.swing, 0.05, 0.45),
            *steps_of_both_sides(SHOULDERS, -self.swing, 0.45, 0.50),
            *(to_rest(channel, 0.4, 0.5) for channel in (*SHOULDERS, *ELBOWS)),
            to_rest("standing", 0.3, 0.7),
        ]


@dataclass(frozen=True)
class Sit:
    """Sits for `duration` s; trunk and arms sway and fidget."""

    duration: float = inf
    seat: Seat = field(default_factory=Seat)

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        course, phases = Course.of(self.seat.posture(person), ()), (Phase(begin, "seated"),)
        return Planted(person, course, begin, begin + self.duration, phases, SEATED, SEATED)


@dataclass(frozen=True)
class StandUp:
    """Stands up from a seat within `duration` s; `lags` has which joints lead."""

    duration: float = 1.8
    seat: Seat = field(default_factory=Seat)
    rise: Rise = field(default_factory=Rise)
    lags: Lags = field(default_factory=Lags)

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        steps = scale_steps(self.lags(self.rise.steps(person, self.seat)), begin, self.duration)
        course = Course.of(self.seat.posture(person), steps)
        end = begin + self.duration
        phases = (Phase(begin, "standing up"), Phase(end, "standing"))
        return Planted(person, course, begin, end, phases, SEATED, STANDING)


@dataclass(frozen=True)
class SitDown:
    """Sits down from standing within `duration` s, then leans back if the seat reclines."""

    duration: float = 2.0
    seat: Seat = field(default_factory=Seat)
    rise: Rise = field(default_factory=Rise)
    # share of the duration after which the trunk leans back, and how long it takes, s
    recline: tuple[float, float] = (0.45, 1.0)
    lags: Lags = field(default_factory=Lags)  # which joints lead and which lag

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        upright = replace(self.seat, recline=0.0)
        steps = self.lags(mirrored(self.rise.steps(person, upright), 1.0))
        steps = scale_steps(steps, begin, self.duration)
        end = begin + self.duration
        if self.seat.recline:
            share, length = self.recline
            leans = begin + share * self.duration
            steps.append(Step("trunk", -self.seat.recline, leans, length))
            end = max(end, leans + length)
        course = Course.of(resting_channels(person), steps)
        phases = (Phase(begin, "sitting down"), Phase(end, "seated"))
        return Planted(person, course, begin, end, phases, STANDING, SEATED)


def make_seat(mover: Mover) -> Seat:
    """Make the seat of a person."""
    sitting = mover.numbers(SittingConfig[float])
    return Seat(
        height=sitting.seat_height, recline=radians(sitting.recline_deg), lap=sitting.hands_on_lap
    )


def make_rise(mover: Mover) -> Rise:
    """Make the way in which a person stands up."""
    return Rise(lean=radians(mover.numbers(SittingConfig[float]).lean_deg))


def make_sitting(mover: Mover) -> Sit:
    """Make a person sit still."""
    return Sit(mover.duration, make_seat(mover))


def make_sitting_down(mover: Mover) -> SitDown:
    """Make a person sit down."""
    lowering, _ = draw_lags(mover)
    return SitDown(mover.duration, make_seat(mover), make_rise(mover), lags=lowering)


def make_standing_up(mover: Mover) -> StandUp:
    """Make a person stand up."""
    _, rising = draw_lags(mover)
    return StandUp(mover.duration, make_seat(mover), make_rise(mover), rising)


MOVEMENTS = (
    MovementKind(
        "sitting_down",
        "sits down on a chair",
        make_sitting_down,
        STANDING,
        SEATED,
        2.0,
        in_place=True,
        uses=(*SEAT, LEAN, "transitions.joint_lag"),
        steps=(0.0, None),  # people feel for the chair
        words="sit sit_down stand_to_sit hinsetzen sitdown",
        manners=ONTO_SEATS,
    ),
    MovementKind(
        "standing_up",
        "stands up from a chair",
        make_standing_up,
        SEATED,
        STANDING,
        1.8,
        in_place=True,
        uses=(*SEAT, LEAN, "transitions.joint_lag"),
        steps=(None, 1.0),  # and leave it
        gestures=(("pitch", -0.05, False, -0.6, 0.5), ("pitch", 0.0, False, -0.1, 0.5)),  # back
        words="stand_up rising stand_up_from_chair sit_to_stand aufstehen standup "
        + join_words("get_up getting_up rise rising stand standing", OFF_SEATS),
        manners=f"{OFF_SEATS} from_sitting",
    ),
    MovementKind(
        "sitting",
        "sits still",
        make_sitting,
        SEATED,
        SEATED,
        in_place=True,
        rests=True,
        uses=SEAT,
        words="seated sitting_still sitzen",
        manners=f"{ONTO_SEATS} still quietly",
    ),
)
