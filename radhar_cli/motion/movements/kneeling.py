"""Kneeling on both knees, upright or back on the heels, or on hands and knees; and getting up.

The knees lie as high as their joints are above the skin, the hip of a person who sits back as high
as the buttocks on the heels: guesses. The trunk is upright on the knees, and slightly ahead on the
heels.
"""

from dataclasses import dataclass
from math import acos, inf, radians
from typing import Annotated, Generic

from radhar_cli.motion.human.minimum_jerk import Course, Step, mirrored
from radhar_cli.motion.human.part import KNEELING, ON_FOURS, STANDING, Phase
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import Planted, posture, resting_channels, scale_steps
from radhar_cli.motion.movements.falling import OnFours
from radhar_cli.motion.movements.getting_up import GetUp, standing_up_steps
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.words import ON_FLOOR
from radhar_cli.schema.annotations import People
from radhar_cli.schema.number import NOT_NEGATIVE, RATIO, Choice
from radhar_cli.schema.section import B, ByActivity, Section, default_draw


class KneelingConfig(Section, Generic[B]):
    """Kneeling on the floor."""

    sit_back: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("kneeling kneeling_down", 0, 1)
    ] = default_draw(Choice(choice=(0.0, 1.0)))
    """Distance by which a kneeling person sits back: 0 is upright on the knees, 1 on the heels."""


SECTION = KneelingConfig


KNEE, ON_HEELS = 0.034, 0.115  # heights of knee and hip over the stature
PITCH = radians(2), radians(6)  # of the trunk, upright and on the heels
SHOULDER, ELBOW = radians(38), radians(45)  # of hands on the thighs


@dataclass(frozen=True)
class Kneel:
    """Kneels for `duration` s."""

    back: float = 0.0  # 0 on the knees, 1 on the heels
    duration: float = inf

    def posture(self, person: Physique) -> dict[str, float]:
        """Channels of `planted.posture` on the knees."""
        leg, stature = person.leg, person.stature
        shank = acos((KNEE * stature - person.ankle) / leg)
        heels = acos((ON_HEELS - KNEE) * stature / leg)
        pitch = PITCH[0] + self.back * (PITCH[1] - PITCH[0])
        elbow = person.elbow + self.back * (ELBOW - person.elbow)
        return posture(shank, -self.back * heels, pitch, self.back * SHOULDER, elbow)

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        course = Course.of(self.posture(person), ())
        phases = (Phase(begin, KNEELING),)
        end = begin + self.duration
        return Planted(person, course, begin, end, phases, KNEELING, KNEELING)


# Posture on hands and knees of a person who is about to crawl, on nearly straight arms.
CRAWLING = OnFours(knee_height=KNEE, trunk=radians(79))
HANDS = "hands_ahead", "hands_beside"
TO_FOURS = 0.3  # share of getting up from the knees in which the hands go to the floor


def _rising(person: Physique, kneel: Kneel | None) -> tuple[dict[str, float], list[Step]]:
    """Channels on the knees, or on hands and knees, and steps to standing in a unit of time."""
    fours, rest = CRAWLING.posture(person), resting_channels(person)
    first, initial, share = list[Step](), fours, 0.0
    if kneel is not None:
        share = TO_FOURS
        initial = kneel.posture(person)
        initial |= {channel: fours[channel] for channel in HANDS}
        changes = {channel: fours[channel] - initial[channel] for channel in fours}
        first = [Step(channel, by, 0.0, share) for channel, by in changes.items() if by]
    steps = [*GetUp().over_knees(person, fours, rest), *standing_up_steps(fours)]
    later = [
        step._replace(start=share + (1 - share) * step.start, length=(1 - share) * step.length)
        for step in steps
    ]
    return initial, [*first, *later]


@dataclass(frozen=True)
class RiseFromKnees:
    """Gets up from hands and knees, or from the knees over these, within `duration` s."""

    kneel: Kneel | None = None  # None is on hands and knees
    duration: float = 3.0

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        initial, steps = _rising(person, self.kneel)
        course = Course.of(initial, scale_steps(steps, begin, self.duration))
        end = begin + self.duration
        phases = (Phase(begin, "getting up"), Phase(end, STANDING))
        before = ON_FOURS if self.kneel is None else KNEELING
        return Planted(person, course, begin, end, phases, before, STANDING)


@dataclass(frozen=True)
class GetDown:
    """Goes down from standing onto the knees, or hands and knees: getting up, reversed."""

    kneel: Kneel | None = None  # None is on hands and knees
    duration: float = 3.0

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        initial, steps = _rising(person, self.kneel)
        for step in steps:
            initial[step.channel] += step.change
        course = Course.of(initial, scale_steps(mirrored(steps, 1.0), begin, self.duration))
        end = begin + self.duration
        phases = (Phase(begin, "getting down"), Phase(end, KNEELING))
        after = ON_FOURS if self.kneel is None else KNEELING
        return Planted(person, course, begin, end, phases, STANDING, after)


def make_kneeling(mover: Mover) -> Kneel:
    """Make a person kneel still."""
    return Kneel(mover.numbers(KneelingConfig[float]).sit_back, mover.duration)


def make_kneeling_down(mover: Mover) -> GetDown:
    """Make a person kneel down."""
    return GetDown(Kneel(mover.numbers(KneelingConfig[float]).sit_back), mover.duration)


MOVEMENTS = (
    MovementKind(
        "kneeling",
        "kneels still",
        make_kneeling,
        "kneeling",
        "kneeling",
        in_place=True,
        rests=True,
        words="kneel on_knees knien",
        manners=f"{ON_FLOOR} on_knees",
    ),
    MovementKind(
        "kneeling_down",
        "kneels down",
        make_kneeling_down,
        STANDING,
        "kneeling",
        3.0,
        words="kneel_down go_on_knees",
        manners=f"{ON_FLOOR} on_knees",
    ),
    MovementKind(
        "getting_on_fours",
        "gets on hands and knees",
        lambda mover: GetDown(None, mover.duration),
        STANDING,
        "on_fours",
        3.0,
        words="get_on_all_fours getting_on_all_fours go_on_all_fours going_on_all_fours",
    ),
)
