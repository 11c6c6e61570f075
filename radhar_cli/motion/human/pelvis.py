"""Hip joints, and a height of the pelvis at which no leg is over-stretched."""

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.pose import SIDES


def hip_joints(person: Physique, yaw: Float, roll: Float) -> Float:
    """Hip joints, right and left, relative to the hip point [3, 2, M].

    Of a pelvis turned by `yaw` (right hip ahead) and `roll` (left hip down) [M], rad.
    """
    angles = np.array([yaw, roll])
    (cy, cr), (sy, sr) = np.cos(angles), np.sin(angles)
    beside = person.hip * SIDES
    return np.array([beside * (-cr * sy), beside * (cr * cy), beside * -sr])


def hip_height(
    person: Physique,
    standing: Float | float,
    hip: Float,
    aside: Float,
    ankles: Float,
    softness: Float | float,
) -> Float:
    """Height of the hip point [M], m: softmin(z_stand, z_right, z_left).

    z_i = z_ankle + sqrt(D^2 - rho^2) - z of the hip joint, rho the horizontal distance from hip
    joint to ankle; softmin = -ln(sum exp(-k z))/k is below the least, so the reach D holds exactly.
    Given are z_stand (m), x and y of the hip point [2, M], hip joints relative to it and ankles
    [3, 2, M] (m), and k (1/m).
    """
    dx = hip[0] + aside[0] - ankles[0]
    dy = hip[1] + aside[1] - ankles[1]
    square = np.maximum(person.reach**2 - dx * dx - dy * dy, 0.0)
    limits = ankles[2] + np.sqrt(square) - aside[2]
    k = softness
    total = np.exp(k * (person.tallest - limits)).sum(axis=0)
    total += np.exp(k * (person.tallest - standing))
    height: Float = person.tallest - np.log(total) / k
    return height


def swayed(height: Float | float, lean: Float, roll: Float) -> Float:
    """By how much a hip at a height above the ankles [M] goes with the sway [3, M]."""
    ahead, rise = np.sin(lean), np.cos(lean)
    return height * np.array([ahead, rise * np.sin(roll), rise * np.cos(roll) - 1])


def swayed_hip(
    person: Physique,
    standing: Float | float,
    hip: Float,
    aside: Float,
    ankles: Float,
    softness: Float | float,
    sway: Float,
) -> Float:
    """The hip point [3, M] of a body that sways over its ankles, at a height its legs can reach.

    At rest the body turns about its ankles as a whole; the soft minimum is not quite the circle
    on which the hip is then, so the difference between the two is added. `sway` is of a hip at
    its height at rest [3, M], from `swayed`; all else as for `hip_height`.
    """
    x, y = hip[0] + sway[0], hip[1] + sway[1]
    z = hip_height(person, standing, np.array([x, y]), aside, ankles, softness)
    limit = person.ankle + np.sqrt(np.maximum(person.reach**2 - sway[0] ** 2 - sway[1] ** 2, 0.0))
    k = person.softness
    soft = person.tallest - np.log1p(2 * np.exp(k * (person.tallest - limit))) / k
    return np.array([x, y, z + (person.rest_height + sway[2] - soft)])
