"""Walks of somebody who spares a leg."""

from dataclasses import replace
from math import radians, sqrt
from typing import Annotated, Generic, NamedTuple

from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.walking import MAX_LIMP, Gait, Walk, make_gait
from radhar_cli.schema.annotations import PERSONAL, People
from radhar_cli.schema.number import ANGLE, NOT_NEGATIVE, RATIO, normal, uniform
from radhar_cli.schema.section import B, ByActivity, Section, default_draw


class LimpingConfig(Section, Generic[B]):
    """Limping, to spare a leg whose side is drawn; a stick goes with it."""

    pace: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("limping", 0.3, 1), PERSONAL] = (
        default_draw(normal(0.72, 0.08, 0.5, 0.95))
    )
    """Speed of a limper, relative to motion.walking.speed_mps."""
    asymmetry: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("limping", 0, 0.25), PERSONAL
    ] = default_draw(uniform(0.05, 0.2))
    """Share by which the painful leg stands shorter on the floor, and the other one longer; less
    of a fast walker: 0.25 at most at 1.3 m/s of a person of 1.75 m, and none from 2 m/s on."""
    lean_deg: Annotated[B, ByActivity(ANGLE), People("limping", 0, 15), PERSONAL] = default_draw(
        uniform(1.0, 8.0)
    )
    """Lean of a limper's trunk over the painful leg."""


SECTION = LimpingConfig
SLOWEST = 0.15  # speed of a walk, m/s
# Speeds over sqrt(g l), l the length of the leg: up to which a leg is spared as much as can be, and
# from which on it is not. Beyond, the foot of the leg would dip into the floor.
SPARED, NOT_SPARED = 0.45, 0.70
G = 9.81  # m/s^2


def largest_limp(speed: float, stature: float) -> float:
    """Share of its time on the floor by which a leg can be spared: less of a fast walker.

    Args:
        speed: m/s.
        stature: m.
    """
    relative = speed / sqrt(G * 2 * Physique(stature).leg)
    return MAX_LIMP * min(max((NOT_SPARED - relative) / (NOT_SPARED - SPARED), 0.0), 1.0)


def limping(gait: Gait, share: float, side: float, lean: float) -> Gait:
    """Gait that spares one leg.

    It stands for a shorter time, the other one for longer and steps less far, and the trunk leans
    over it (Perry and Burnfield, Gait Analysis (2010), antalgic gait); how much is a guess.

    Args:
        gait: Gait without the limp.
        share: By which share of its time on the floor the leg stands shorter, 0 to 0.25.
        side: Side of the leg, 1 for the left and -1 for the right.
        lean: Lean of the trunk over the leg, rad.
    """
    return replace(gait, limp=share, limp_side=side, limp_lean=lean, name="limping")


class Sides(NamedTuple):
    """Ranks, 0 to 1, that say which leg hurts, which hand holds a stick, and which a bag."""

    leg: float
    stick: float
    bag: float


def draw_sides(mover: Mover) -> Sides:
    """Draw the sides of a walk at its place in a sequence."""
    return Sides(*mover.stream(f"motion.limping/sides/{mover.place}").random(3).tolist())


def slow_down(gait: Gait, pace: float) -> Gait:
    """Multiply the speed of a gait by `pace`; the slowest walk is one of SLOWEST."""
    return replace(gait, speed=max(pace * gait.speed, min(SLOWEST, gait.speed)))


def make_limp(mover: Mover, pace: float) -> Gait:
    """Make the gait of a limper whose speed is `pace` times that of the usual gait."""
    numbers, slowed = mover.numbers(LimpingConfig[float]), slow_down(make_gait(mover), pace)
    return limping(
        slowed,
        min(numbers.asymmetry, largest_limp(slowed.speed, mover.stature)),
        1.0 if draw_sides(mover).leg < 0.5 else -1.0,
        radians(numbers.lean_deg),
    )


def make_limping_walk(mover: Mover) -> Walk:
    """Make a walk of a limper, from rest."""
    return Walk(make_limp(mover, mover.numbers(LimpingConfig[float]).pace), mover.duration)


MOVEMENTS = (
    MovementKind(
        "limping",
        "walks with a limp",
        make_limping_walk,
        like="walking",
        words="limp antalgic_gait hobbling limping_leg humpeln hinken",
        manners="leg gait",
    ),
)
