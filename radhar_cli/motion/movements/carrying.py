"""Walks with something in the hands."""

from dataclasses import replace
from math import radians
from typing import Annotated, Generic

from radhar_cli.motion.human.aids import HeldLoad
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.limping import draw_sides, slow_down
from radhar_cli.motion.movements.walking import Gait, Walk, make_gait
from radhar_cli.schema.annotations import People
from radhar_cli.schema.number import NOT_NEGATIVE, RATIO, Choice, normal
from radhar_cli.schema.section import B, ByActivity, Section, default_draw


class CarryingConfig(Section, Generic[B]):
    """Carrying something, which itself does not scatter."""

    pace: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("carrying", 0.4, 1)] = default_draw(
        normal(0.9, 0.06, 0.7, 1.0)
    )
    """Speed with a load, relative to motion.walking.speed_mps."""
    bag: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("carrying", 0, 1)] = default_draw(
        Choice(choice=(0, 1))
    )
    """Load that is carried: 0 is a box in both hands before the trunk, 1 a bag in one hand."""


SECTION = CarryingConfig
RIGHT, LEFT = 0, 1
# Both hands below a box, and one beside the thigh with a bag, in lengths of the stretched arm.
BOX = HeldLoad((RIGHT, LEFT), (0.48, -0.12, -0.62))
BAG = (0.02, 0.05, -0.98)
LEAN_BACK = radians(4)  # of a person who carries a box


def carrying(gait: Gait, bag_side: int | None) -> Gait:
    """Gait with a box before the trunk, or a bag in the right (0) or left (1) hand."""
    if bag_side is not None:
        return replace(gait, held=HeldLoad((bag_side,), BAG), name="carrying")
    return replace(gait, trunk_pitch=gait.trunk_pitch - LEAN_BACK, held=BOX, name="carrying")


def make_carrying_walk(mover: Mover) -> Walk:
    """Make a walk with a box or a bag, from rest."""
    load = mover.numbers(CarryingConfig[float])
    bag_side = int(draw_sides(mover).bag < 0.5) if load.bag > 0.5 else None
    return Walk(carrying(slow_down(make_gait(mover), load.pace), bag_side), mover.duration)


MOVEMENTS = (
    MovementKind(
        "carrying",
        "walks and carries something",
        make_carrying_walk,
        like="walking",
        words="carry carrying_box carrying_bag carry_box",
    ),
)
