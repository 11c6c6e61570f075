"""A pose: where hip, legs, trunk and arms are; and from it the thirteen joints."""

from dataclasses import dataclass

import numpy as np

from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.segments import REFERENCE_STATURE, foot_direction, unit
from radhar_cli.numerics.arrays import Float

SIDES = np.array([[-1.0], [1.0]])  # right, left: the sign of y


@dataclass(frozen=True)
class Axes:
    """Unit vectors ahead, to the left and up of a part of the body [3, M]."""

    ahead: Float
    left: Float
    up: Float


def axes(pitch: Float, yaw: Float, roll: Float) -> Axes:
    """Axes turned ahead by `pitch`, then to the left by `yaw`, then leaned to the left by `roll`.

    R_x(-roll) R_z(yaw) R_y(pitch), angles [M] in rad; the last turn is about the floor's x axis.
    """
    cp, sp = np.cos(pitch), np.sin(pitch)
    cy, sy = np.cos(yaw), np.sin(yaw)
    cr, sr = np.cos(roll), np.sin(roll)
    ahead, left, up = np.empty((3, 3, pitch.size))
    ahead[0], left[0], up[0] = cy * cp, -sy, cy * sp
    forth, across = sy * cp, sy * sp
    ahead[1], left[1], up[1] = forth * cr - sp * sr, cy * cr, across * cr + cp * sr
    ahead[2], left[2], up[2] = -sp * cr - forth * sr, -cy * sr, cp * cr - across * sr
    return Axes(ahead, left, up)


@dataclass
class Pose:
    """Positions and directions of a body at M instants, in m and rad, x ahead, y left, z up."""

    hip: Float  # [3, M]
    trunk: Axes
    # hip_joints, knees, ankles: right, left [3, 2, M]
    hip_joints: Float
    knees: Float
    ankles: Float
    # upper_arms, forearms: unit vectors, right, left [3, 2, M]
    upper_arms: Float
    forearms: Float
    breath: Float | float = 0.0  # distance of the torso ahead of its place, [M] or a number
    toes: Float | None = None  # unit vectors from the ankles to the toes [3, 2, M], where known

    def at(self, x: Float, y: Float, heading: Float | None) -> "Pose":
        """Turn the pose to a heading [M] (rad), if there is one, and move it by x and y [M] (m)."""
        vectors = vars(self) | vars(self.trunk)
        if heading is not None:
            vectors = {
                name: turned(v, heading) if isinstance(v, np.ndarray) and v.ndim > 1 else v
                for name, v in vectors.items()
            }
        for name in ("hip", "hip_joints", "knees", "ankles"):
            vectors[name][0] += x
            vectors[name][1] += y
        trunk = Axes(*(vectors.pop(name) for name in vars(self.trunk)))
        return Pose(**(vectors | {"trunk": trunk}))

    def torso(self, person: Physique, p: Float) -> None:
        """Fill in positions p [3, M] (m) of the torso."""
        np.multiply(self.trunk.up, person.trunk, out=p)
        p += self.hip
        p += self.breath * self.trunk.ahead

    def joints(self, person: Physique, p: Float) -> None:
        """Fill in positions p [3, 13, M] (m), in the order of `radhar_cli.motion.skeleton`."""
        up = self.trunk.up
        self.torso(person, p[:, 0])
        p[:, 1] = self.hip + (person.trunk + person.neck) * up
        p[:, 2:6:3] = shoulder_points(person, self.hip, self.trunk)
        p[:, 3:7:3] = p[:, 2:6:3] + person.arm * self.upper_arms
        p[:, 4:8:3] = p[:, 3:7:3] + person.arm * self.forearms
        p[:, 8] = self.hip
        p[:, 9:12:2] = self.knees
        p[:, 10:13:2] = self.ankles


def shoulder_points(person: Physique, hip: Float, trunk: Axes) -> Float:
    """Right and left shoulder [3, 2, M] (m) of a trunk above a hip [3, M]."""
    neck = hip + (person.trunk + person.shoulder) * trunk.up
    points: Float = neck[:, None] + person.shoulder * (SIDES * trunk.left[:, None])
    return points


def feet(person: Physique, pose: Pose) -> Float:
    """Directions [3, 2, M] from the ankles to the toes of feet at right angles to the shanks.

    Near the floor they are flat on it, as in `radhar_cli.motion.segments`.
    """
    across = unit(pose.hip_joints[:, 1] - pose.hip_joints[:, 0])
    scale = person.stature / REFERENCE_STATURE
    both = (
        foot_direction(pose.knees[:, side], pose.ankles[:, side], across, scale)
        for side in range(2)
    )
    return np.stack(list(both), axis=1)


def turned(v: Float, angle: Float) -> Float:
    """Vectors [3, ..., M] turned to the left by angles [M], rad."""
    cos, sin = np.cos(angle), np.sin(angle)
    return np.array([cos * v[0] - sin * v[1], sin * v[0] + cos * v[1], v[2]])
