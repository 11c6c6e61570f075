"""Losses of balance that are caught: stumbles from standing, and trips on the way."""

from dataclasses import replace
from math import radians

from radhar_cli.motion.human.part import Place
from radhar_cli.motion.human.stepping import StepTo
from radhar_cli.motion.movements.falling import DIRECTION, FallingConfig, draw_side, fall_direction
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.walking import Walk, make_gait

PITCH = "falling.stumble_deg"
# A loss of balance is caught by steps of 15 to 35 % of the stature ahead (Hsiao-Wecksler and
# Robinovitch, Clin. Biomech. 22 (2007) 574); aside 2.3 to 2.7 steps of 0.3 to 0.45 m in all within
# 1.2 to 1.5 s (old people in BMC Geriatrics 20 (2020) 246). Trunk, arms and knees are guesses.
STUMBLES = {
    "forward": StepTo(
        1.3, Place(0.8), 3, 0.06, "stumbling", radians(34), radians(60), drop=0.06, hurry=0.8
    ),
    "backward": StepTo(
        1.3, Place(-0.55), 3, 0.04, "stumbling", radians(-11), radians(75), drop=0.05, hurry=0.8
    ),
    "sideways": StepTo(
        1.3,
        Place(0.0, 0.35),
        2,
        *(0.04, "stumbling", radians(8), radians(40), radians(14)),
        drop=0.04,
        hurry=0.8,
    ),
}


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
        "tripping", "trips on the way", make_trip, like="walking", uses=(PITCH,), words="trip"
    ),
)
