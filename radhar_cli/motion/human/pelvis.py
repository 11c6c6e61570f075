"""Hip joints, and a height of the pelvis at which no leg is over-stretched."""

from math import log
from typing import NamedTuple

import numpy as np

from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.pose import SIDES
from radhar_cli.numerics.arrays import Float

# Longest reach of a moving leg over thigh and shank together, and k of the soft
# minimum over the stature.
BENT, SOFTNESS = 0.9965, 280.0


class LegBound(NamedTuple):
    """Bound on the reach of legs: D (m) and k (1/m) of `hip_height`, numbers or [M]."""

    reach: Float | float
    softness: Float | float

    @classmethod
    def at_rest(cls, person: Physique) -> "LegBound":
        """Bound on the legs of people who stand."""
        return cls(person.reach, person.sharpness)

    @classmethod
    def under_way(cls, person: Physique) -> "LegBound":
        """Bound on the legs of people who step, or stand ready to move."""
        return cls(BENT * 2 * person.leg, SOFTNESS / person.stature)

    def towards(self, other: "LegBound", share: Float) -> "LegBound":
        """Bound between this one (share 0) and another (1); both D and 1/k go in proportion."""
        sag = (1 - share) / self.softness + share / other.softness
        return LegBound(self.reach + share * (other.reach - self.reach), 1 / sag)


def hip_joints(person: Physique, yaw: Float, roll: Float) -> Float:
    """Right and left hip joint [3, 2, M] relative to the hip point, m.

    Args:
        yaw: Turn of the pelvis, right hip ahead [M], rad.
        roll: Turn of the pelvis, left hip down [M], rad.
    """
    angles = np.array([yaw, roll])
    (cy, cr), (sy, sr) = np.cos(angles), np.sin(angles)
    beside = person.hip * SIDES
    return np.array([beside * (-cr * sy), beside * (cr * cy), beside * -sr])


def hip_height(
    person: Physique,
    standing: Float | float,
    hip: Float,
    joint_offsets: Float,
    ankles: Float,
    bound: "LegBound",
) -> Float:
    """Height of the hip point [M] (m) that no leg is too short for.

    It is softmin(z_stand, z_right, z_left), z_i = z_ankle + sqrt(D^2 - rho^2) - z of the hip joint,
    rho the horizontal distance from hip joint to ankle; softmin = -ln(sum exp(-k z))/k is below the
    least, so the reach D holds exactly.

    Args:
        standing: z_stand, the height on standing legs, m.
        hip: x and y of the hip point [2, M], m.
        joint_offsets: Hip joints relative to the hip point [3, 2, M], m.
        ankles: Right and left ankle [3, 2, M], m.
        bound: D and k.
    """
    softness = bound.softness
    dx = hip[0] + joint_offsets[0] - ankles[0]
    dy = hip[1] + joint_offsets[1] - ankles[1]
    square = np.maximum(bound.reach**2 - dx * dx - dy * dy, 0.0)
    limits = ankles[2] + np.sqrt(square) - joint_offsets[2]
    least = np.minimum(limits.min(axis=0), standing)
    total = np.exp(softness * (least - limits)).sum(axis=0)
    total += np.exp(softness * (least - standing))
    height: Float = least - np.log(total) / softness
    return height


def sway_displacement(height: Float | float, lean: Float, roll: Float) -> Float:
    """Displacement [3, M] (m) of a hip that a swaying body carries along.

    Args:
        height: Height of the hip above the ankles, a number or [M], m.
        lean: Angle of the legs ahead [M], rad.
        roll: Angle of the legs to the left [M], rad.
    """
    ahead, rise = np.sin(lean), np.cos(lean)
    return height * np.array([ahead, rise * np.sin(roll), rise * np.cos(roll) - 1])


def hip_point_with_sway(
    person: Physique,
    standing: Float | float,
    hip: Float,
    joint_offsets: Float,
    ankles: Float,
    sway: Float,
    bound: "LegBound | None" = None,
) -> Float:
    """Hip point [3, M] (m) of a body that sways over its ankles, at a height its legs can reach.

    At rest the body turns about its ankles as a whole; the soft minimum is not quite the circle on
    which the hip is then, so the difference between the two is added.

    Args:
        person: Person; all arguments but `sway` are those of `hip_height`.
        standing: m.
        hip: x and y without sway [2, M], m.
        joint_offsets: [3, 2, M], m.
        ankles: [3, 2, M], m.
        sway: `sway_displacement` of a hip at its height at rest [3, M], m.
        bound: Bound on the legs; None for that of people at rest.
    """
    at_rest = LegBound.at_rest(person)
    x, y = hip[0] + sway[0], hip[1] + sway[1]
    z = hip_height(person, standing, np.array([x, y]), joint_offsets, ankles, bound or at_rest)
    limit = person.ankle + np.sqrt(np.maximum(person.reach**2 - sway[0] ** 2 - sway[1] ** 2, 0.0))
    k = at_rest.softness
    soft = person.tallest - np.logaddexp(0.0, log(2) + k * (person.tallest - limit)) / k
    return np.array([x, y, z + (person.rest_height + sway[2] - soft)])
