"""Falls off a seat, while sitting or on rising from it: toppling ahead, sliding down, missing it.

Of 306 filmed falls of older people between a seat and standing 64 % began on rising, mostly
backwards (Komisar et al., Arch. Phys. Med. Rehabil. 104 (2023) 533); of 58 out of wheelchairs most
went backwards and 90 % ended on the pelvis (J. Am. Med. Dir. Assoc. 25 (2024) 796). Nobody seems to
have measured how long they take: the durations are guesses below those of falls from standing.
"""

from dataclasses import dataclass, field
from math import radians

from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.part import LYING, SEATED, Phase
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import (
    ELBOWS,
    SHOULDERS,
    Planted,
    scale_steps,
    steps_of_both_sides,
)
from radhar_cli.motion.movements.falling import (
    AGAINST_SEAT,
    DIRECTION,
    ON_FLOOR,
    PRONE,
    SUPINE,
    Prone,
    Supine,
    draw_side,
    fall_direction,
)
from radhar_cli.motion.movements.falling_sideways import FallSideways
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.sitting import SEAT, Seat, make_seat
from radhar_cli.motion.movements.words import OFF_SEATS, join_words

# Steps from the seat to the floor: channel, share of its change, start and length in units of the
# duration, and whether the step is late.
Shares = tuple[tuple[str, float, float, float, bool], ...]
TOPPLE: Shares = (  # the trunk goes over the knees, which go to the floor; then the hips sink
    ("trunk", 1.0, 0.0, 1.0, True),
    ("shank", 1.0, 0.10, 0.80, True),
    ("thigh", 0.48, 0.25, 0.80, True),
    ("thigh", 0.52, 0.80, 0.80, False),
)
SLIDE: Shares = (  # hips and feet slide ahead, then the hips drop over the edge
    ("feet", 1.0, 0.0, 0.90, False),
    ("shank", 1.0, 0.15, 0.80, False),
    ("thigh", 1.0, 0.15, 0.85, True),
    ("trunk", 1.0, 0.10, 0.90, False),
)
MISS: Shares = (  # the hips go down behind the feet, then the trunk
    ("shank", 1.0, 0.0, 0.80, True),
    ("thigh", 1.0, 0.0, 0.80, True),
    ("trunk", 1.0, 0.15, 0.95, True),
)
# Angles of half of standing up, rad; in which part of a fall ahead, and of one backwards, they go
# back.
RISEN = {"thigh": radians(48), "trunk": radians(36), "shank": radians(10)}
UNDONE = (0.35, 0.65), (0.0, 0.75)


@dataclass(frozen=True)
class FallFromSeat:
    """Falls off a seat to the floor within about `duration` s, first rising for `rising` s."""

    duration: float = 1.0
    ahead: bool = True  # or backwards: off the seat's edge, on rising behind the feet
    rising: float = 0.0
    seat: Seat = field(default_factory=Seat)
    arms: float = radians(45)  # flexion of the shoulders as the hands look for the floor

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Planted:
        seated = self.seat.posture(person)
        lying, shares, after = Prone().posture(person), TOPPLE, PRONE
        if not self.ahead:
            lying, shares, after = AGAINST_SEAT.posture(person), SLIDE, ON_FLOOR
            if self.rising:
                lying, shares, after = Supine().posture(person), MISS, SUPINE
        change = {channel: lying[channel] - seated[channel] for channel in seated}
        steps = [
            Step(channel, share * change[channel], start, length, late)
            for channel, share, start, length, late in shares
        ]
        steps += [Step(arm, change[arm], 0.1, 0.8) for arm in (*SHOULDERS, *ELBOWS)]
        steps += steps_of_both_sides(SHOULDERS, self.arms, 0.05, 0.4) + steps_of_both_sides(
            SHOULDERS, -self.arms, 0.5, 0.5
        )
        steps += [Step("upright", -1.0, 0.0, 0.8)]
        if lying["hands"]:  # who topples first puts the hands where the shoulders are then
            near = lying["hands_ahead"] - (0.3 * person.stature if self.ahead else 0.0)
            seated |= {"hands_ahead": near, "hands_beside": lying["hands_beside"]}
            steps += [
                Step("hands", 1.0, 0.25, 0.65),
                Step("hands_ahead", lying["hands_ahead"] - near, 0.8, 0.8),
                Step("splayed", lying["splayed"], 0.25, 0.65),
            ]
        fall_start = begin + 0.75 * self.rising
        risen = RISEN.items() if self.rising else ()
        steps += [Step(channel, -angle, *UNDONE[not self.ahead]) for channel, angle in risen]
        steps = scale_steps(steps, fall_start, self.duration)
        steps += [Step(channel, angle, begin, self.rising) for channel, angle in risen]
        course = Course.of(seated, steps)
        end = max(course.breakpoints)
        rises = (Phase(begin, "standing up"),) if self.rising else ()
        phases = (*rises, Phase(fall_start, "falling"), Phase(end, "lying"))
        return Planted(person, course, begin, end, phases, SEATED, after)


def _make_fall_off_seat(mover: Mover, rising_share: float) -> FallFromSeat | FallSideways:
    """Make a person fall off a seat who has risen for a share of the duration."""
    rising = rising_share * mover.duration
    duration, seat = (1 - 0.75 * rising_share) * mover.duration, make_seat(mover)
    if fall_direction(mover) == "sideways":
        return FallSideways(duration, draw_side(mover), seat=seat, rising=rising)
    return FallFromSeat(duration, fall_direction(mover) == "forward", rising, seat)


def make_fall_off_seat(mover: Mover) -> FallFromSeat | FallSideways:
    """Make a person fall off a seat."""
    return _make_fall_off_seat(mover, 0.0)


def make_fall_on_rising(mover: Mover) -> FallFromSeat | FallSideways:
    """Make a person fall who is about to stand up from a seat."""
    return _make_fall_off_seat(mover, 0.5)


MOVEMENTS = (
    MovementKind(
        "falling_off_seat",
        "falls off a chair",
        make_fall_off_seat,
        SEATED,
        LYING,
        1.0,
        uses=(DIRECTION, *SEAT),
        words=join_words("fall falling fall_down falling_down", OFF_SEATS),
    ),
    MovementKind(
        "falling_on_rising",
        "falls on standing up from a chair",
        make_fall_on_rising,
        SEATED,
        LYING,
        1.7,
        uses=(DIRECTION, *SEAT),
    ),
)
