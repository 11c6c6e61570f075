"""Losses of balance that are caught: stumbles from standing, and trips on the way."""

from dataclasses import replace
from math import radians

from radhar_cli.motion.human.part import Place
from radhar_cli.motion.human.stepping import STUMBLES, StepTo
from radhar_cli.motion.movements.falling import DIRECTION, FallingConfig, draw_side, fall_direction
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.walking import Walk, make_gait

PITCH = "falling.stumble_deg"


def _pitch(mover: Mover) -> float:
    """Angle by which the trunk goes ahead, rad."""
    return radians(mover.numbers(FallingConfig[float]).stumble_deg)


def make_stumble(mover: Mover) -> StepTo:
    """Make a person stumble in the direction in which they would fall."""
    direction, pitch = fall_direction(mover), _pitch(mover)
    stumble = replace(STUMBLES[direction].for_stature(mover.stature), duration=mover.duration)
    if direction == "forward":
        return replace(stumble, pitch=pitch)
    if direction == "backward":
        return replace(stumble, pitch=-0.4 * pitch)
    side = draw_side(mover)
    return replace(stumble, place=Place(0.0, side * stumble.place.left), lean=side * 0.4 * pitch)


def make_trip(mover: Mover) -> Walk:
    """Make a person trip half way of a walk."""
    return Walk(replace(make_gait(mover), trip=_pitch(mover)), mover.duration)


MOVEMENTS = (
    MovementKind(
        "stumbling",
        "stumbles and does not fall",
        make_stumble,
        seconds=1.3,
        uses=(DIRECTION, PITCH),
        words="stumble stolpern",
        nearby="staggering",
    ),
    MovementKind(
        "tripping",
        "trips on the way",
        make_trip,
        like="walking",
        uses=(PITCH,),
        words="trip",
    ),
)
