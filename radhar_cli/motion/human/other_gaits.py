"""Walks that differ: limping, with a stick, with a walker, with something in the hands."""

from dataclasses import replace
from math import radians, sqrt

from radhar_cli.motion.human.aids import Aid, Load
from radhar_cli.motion.human.physique import Physique, froude_scale
from radhar_cli.motion.human.walking import MAX_LIMP, STANCE, Gait

RIGHT, LEFT = 0, 1
OTHER_GAITS = ("limping", "walking_with_stick", "walking_with_walker", "carrying")
# Both hands below a box, and one beside the thigh with a bag, in lengths of the stretched arm.
BOX = Load((RIGHT, LEFT), (0.48, -0.12, -0.62))
BAG = (0.02, 0.05, -0.98)
ROLLATOR = Aid((RIGHT, LEFT), ahead=0.17, beside=0.15, height=0.53)
FRAME = Aid((RIGHT, LEFT), ahead=0.20, beside=0.15, height=0.52, down=0.95, up=0.5)
# Time of a stride behind a rollator, and with a frame, over that of others who are as slow.
SHORT_STEPS, SHORTER_STEPS = 0.85, 0.7
# Speed of who lifts a frame over that behind a rollator, and at most, m/s of a person of 1.7 m, so
# that it is put ahead by 0.3 to 0.5 m; a guess.
FRAME_PACE, FRAME_FASTEST = 0.5, 0.45
LEAN_BACK = radians(4)  # of who carries a box
# Speeds over sqrt(g l), l the length of the leg: up to which a leg is spared as much as can be, and
# from which on it is not. Beyond, the foot of the leg would dip into the floor.
SPARED, NOT_SPARED = 0.45, 0.70
G = 9.81  # m/s^2


def largest_limp(speed: float, stature: float) -> float:
    """Share of its time on the floor by which a leg can be spared: less of who goes fast.

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
        gait: Gait of somebody as slow behind a rollator; who lifts a frame is slower.
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


def carrying(gait: Gait, bag_side: int | None) -> Gait:
    """Gait with a box before the trunk, or a bag in the right (0) or left (1) hand."""
    if bag_side is not None:
        return replace(gait, held=Load((bag_side,), BAG), name="carrying")
    return replace(gait, trunk_pitch=gait.trunk_pitch - LEAN_BACK, held=BOX, name="carrying")


def usual_gaits() -> dict[str, Gait]:
    """Gaits of OTHER_GAITS of somebody in the middle of what people do, by name."""
    slow = Gait(0.9)
    limp = limping(slow, 0.12, -1.0, radians(5))
    return {
        "limping": limp,
        "walking_with_stick": walking_with_stick(limp, other_hand=True),
        "walking_with_walker": walking_with_walker(Gait(0.6), True, radians(16), 1.7),
        "carrying": carrying(Gait(1.15), None),
    }
