"""The boxes that throw a person's shadow, from joints: one about the trunk, one about the legs."""

from collections.abc import Mapping

import numpy as np

from radhar_cli.motion.skeleton import ANKLE_HEIGHT
from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.person_shadow import BodyBox, box_about

TRUNK_RADIUS_M, LEGS_RADIUS_M = 0.165, 0.12  # of a person of usual thickness
BEYOND_HIP = 0.7  # radii by which lines of trunk and thighs go on beyond the hip
HEAD_TOP = 0.134  # from the head's joint to its top, over the stature
SHORT_M = 0.02  # length of a line below which its direction fades
JOINTS = ("head", "torso", "hip", "right_knee", "left_knee", "right_ankle", "left_ankle")


def boxes_of_body(
    points: Mapping[str, Float], stature: float, thickness: float
) -> tuple[BodyBox, ...]:
    """Boxes of the trunk and of the legs of a body.

    Args:
        points: Positions [3, M] of JOINTS, m.
        stature: Stature of the person, m.
        thickness: Factor of the radii over those of a person of usual thickness.
    """
    radius, leg_radius = TRUNK_RADIUS_M * thickness, LEGS_RADIUS_M * thickness
    hip, head = points["hip"], points["head"]
    top = head + HEAD_TOP * stature * _direction(head - points["torso"])
    trunk = [(top, hip + BEYOND_HIP * radius * _direction(hip - top))]
    legs = list[tuple[Float, Float]]()
    for side in ("right", "left"):
        knee, ankle = points[f"{side}_knee"], points[f"{side}_ankle"]
        sole = ankle + ANKLE_HEIGHT * stature * _direction(ankle - knee)
        legs.append((hip + BEYOND_HIP * leg_radius * _direction(hip - knee), knee))
        legs.append((knee, sole))
    return box_about(trunk, radius), box_about(legs, leg_radius)


def box_of_stature(torso: Float, stature: float, thickness: float) -> BodyBox:
    """Box of a standing person of whom only the torso [3, M] (m) is known."""
    top, foot = torso.copy(), torso.copy()
    top[2], foot[2] = stature, 0.0
    return box_about([(top, foot)], TRUNK_RADIUS_M * thickness)


def _direction(line: Float) -> Float:
    """Directions [3, M] of lines [3, M] (m), which fade where a line has no length."""
    direction: Float = line / np.sqrt((line * line).sum(axis=0) + SHORT_M**2)
    return direction
