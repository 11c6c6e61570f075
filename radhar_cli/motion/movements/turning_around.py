"""Turning on the spot to face another way."""

from dataclasses import replace
from math import pi

from radhar_cli.motion.human.part import Place
from radhar_cli.motion.human.stepping import StepTo
from radhar_cli.motion.movements.kind import MovementKind, Mover

AROUND = StepTo(1.8, Place(turn=pi), steps=5, name="turning around")


def make_half_turn(mover: Mover) -> StepTo:
    """Make a person turn around."""
    return replace(AROUND, duration=mover.duration)


def make_turn(angle: float) -> StepTo:
    """Make a turn on the spot through an angle, rad, at the pace of turning around."""
    share = abs(angle) / pi
    steps = max(2, round(share * AROUND.steps))
    return replace(
        AROUND, duration=max(0.8, share * AROUND.duration), place=Place(turn=angle), steps=steps
    )


MOVEMENTS = (
    MovementKind(
        "turning_around",
        "turns to face the other way",
        make_half_turn,
        seconds=AROUND.duration,
        words="turn_around",
    ),
)
