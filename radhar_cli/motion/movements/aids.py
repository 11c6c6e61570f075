"""Walks with a stick, a rollator, or a frame that is lifted."""

from dataclasses import replace
from math import radians
from typing import Annotated, Generic

from radhar_cli.motion.human.aids import Aid
from radhar_cli.motion.human.physique import froude_scale
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.limping import draw_sides, make_limp, slow_down
from radhar_cli.motion.movements.walking import STANCE, Gait, Walk, make_gait
from radhar_cli.schema.annotations import PERSONAL, People
from radhar_cli.schema.number import ANGLE, NOT_NEGATIVE, RATIO, Choice, normal
from radhar_cli.schema.section import B, ByActivity, Section, default_draw


class AidsConfig(Section, Generic[B]):
    """Walking with a stick or a walker, which itself does not scatter."""

    stick_pace: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("walking_with_stick", 0.3, 1), PERSONAL
    ] = default_draw(normal(0.62, 0.1, 0.4, 0.9))
    """Speed with a stick, relative to motion.walking.speed_mps."""
    walker_pace: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("walking_with_walker", 0.2, 1), PERSONAL
    ] = default_draw(normal(0.45, 0.08, 0.25, 0.7))
    """Speed with a rollator, relative to motion.walking.speed_mps; that with a frame is half as
    high, and at most 0.45 m/s of a person of 1.7 m."""
    walker_pitch_deg: Annotated[
        B, ByActivity(ANGLE), People("walking_with_walker", 0, 35), PERSONAL
    ] = default_draw(normal(16.0, 5.0, 5.0, 28.0))
    """Forward pitch of the trunk behind a walker."""
    rollator: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("walking_with_walker", 0, 1), PERSONAL
    ] = default_draw(Choice(choice=(0, 1)))
    """Kind of walker: 1 is a rollator, 0 a frame that is lifted once a stride."""


SECTION = AidsConfig
RIGHT, LEFT = 0, 1
OTHER_HAND = 0.8  # share of people who hold a stick in the hand of the other side
ROLLATOR = Aid((RIGHT, LEFT), ahead=0.17, beside=0.15, height=0.53)
FRAME = Aid((RIGHT, LEFT), ahead=0.20, beside=0.15, height=0.52, down=0.95, up=0.5)
# Time of a stride behind a rollator, and with a frame, over that of others who are as slow.
SHORT_STEPS, SHORTER_STEPS = 0.85, 0.7
# Speed of who lifts a frame over that behind a rollator, and at most, m/s of a person of 1.7 m, so
# that it is put ahead by 0.3 to 0.5 m; a guess.
FRAME_PACE, FRAME_FASTEST = 0.5, 0.45


def walking_with_stick(gait: Gait, other_hand: bool) -> Gait:
    """Gait of a limper with a stick, in the hand of the other side or of the painful leg.

    Either way the stick is set down with the painful leg.
    """
    leg = LEFT if gait.limp_side > 0 else RIGHT
    down = 0.5 + STANCE * gait.limp if leg == LEFT else 0.0
    hand = 1 - leg if other_hand else leg
    stick = Aid((hand,), ahead=0.10, beside=0.17, height=0.53, down=down, tilts=True)
    return replace(gait, held=stick, name="walking with a stick")


def walking_with_walker(gait: Gait, rolled: bool, pitch: float, stature: float) -> Gait:
    """Gait behind a rollator, or a frame that is lifted once a stride.

    Args:
        gait: Gait of somebody as slow behind a rollator; a lifted frame is slower.
        rolled: Whether it is a rollator.
        stature: m.
        pitch: Lean of the trunk ahead, rad.
    """
    fastest = FRAME_FASTEST * froude_scale(stature)
    return replace(
        gait,
        speed=gait.speed if rolled else min(FRAME_PACE * gait.speed, fastest),
        period_scale=(SHORT_STEPS if rolled else SHORTER_STEPS) * gait.period_scale,
        trunk_pitch=pitch,
        held=ROLLATOR if rolled else FRAME,
        name="walking with a walker",
    )


def make_walk_with_stick(mover: Mover) -> Walk:
    """Make a walk with a stick, from rest."""
    limp = make_limp(mover, mover.numbers(AidsConfig[float]).stick_pace)
    other_hand = draw_sides(mover).stick < OTHER_HAND
    return Walk(walking_with_stick(limp, other_hand), mover.duration)


def make_walk_with_walker(mover: Mover) -> Walk:
    """Make a walk behind a rollator or with a frame, from rest."""
    aids = mover.numbers(AidsConfig[float])
    gait = walking_with_walker(
        slow_down(make_gait(mover), aids.walker_pace),
        aids.rollator > 0.5,
        radians(aids.walker_pitch_deg),
        mover.stature,
    )
    return Walk(gait, mover.duration)


MOVEMENTS = (
    MovementKind(
        "walking_with_stick",
        "walks with a stick",
        make_walk_with_stick,
        like="walking",
        uses=("limping.asymmetry", "limping.lean_deg"),
        words="walking_with_cane walking_with_crutch",
        nearby="crutches walking_on_crutches cane crutch",
    ),
    MovementKind(
        "walking_with_walker",
        "walks with a walker",
        make_walk_with_walker,
        like="walking",
        with_key={
            "motion.aids.rollator: 1, one that is rolled": "walking_with_rollator rollator "
            "wheeled_walker rolling_walker walking_behind_rollator",
            "motion.aids.rollator: 0, a frame that is lifted": "walking_with_frame walking_frame "
            "zimmer_frame zimmer pickup_walker",
        },
    ),
)
