"""A pose: where hip, legs, trunk and arms are; and from it the thirteen joints."""

from dataclasses import dataclass

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.body.skeleton import JOINTS
from radhar_cli.motion.human.person import Person

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
    angles = np.stack([pitch, yaw, roll])
    (cp, cy, cr), (sp, sy, sr) = np.cos(angles), np.sin(angles)
    across = sy * sp
    return Axes(
        ahead=np.stack([cy * cp, sy * cp * cr - sp * sr, -sp * cr - sy * cp * sr]),
        left=np.stack([-sy, cy * cr, -cy * sr]),
        up=np.stack([cy * sp, across * cr + cp * sr, cp * cr - across * sr]),
    )


@dataclass
class Pose:
    """A body at M instants, in m and rad, x ahead, y left, z up.

    Attributes:
        hip: [3, M].
        trunk: its axes.
        hip_joints, knees, ankles: right, left [3, 2, M].
        upper_arms, forearms: unit vectors, right, left [3, 2, M].
        breath: how far the torso is ahead of its place [M] or a number.
    """

    hip: Float
    trunk: Axes
    hip_joints: Float
    knees: Float
    ankles: Float
    upper_arms: Float
    forearms: Float
    breath: Float | float = 0.0

    def joints(self, person: Person) -> Float:
        """Positions [3, 13, M], in the order of `radhar_cli.body.skeleton`."""
        p = np.empty((3, len(JOINTS), self.hip.shape[1]))
        ahead, up = self.trunk.ahead, self.trunk.up
        torso = self.hip + person.trunk * up
        p[:, 0] = torso + self.breath * ahead
        p[:, 1] = torso + person.neck * up
        p[:, 2:6:3] = shoulder_points(person, self.hip, self.trunk)
        p[:, 3:7:3] = p[:, 2:6:3] + person.arm * self.upper_arms
        p[:, 4:8:3] = p[:, 3:7:3] + person.arm * self.forearms
        p[:, 8] = self.hip
        p[:, 9:12:2] = self.knees
        p[:, 10:13:2] = self.ankles
        return p


def shoulder_points(person: Person, hip: Float, trunk: Axes) -> Float:
    """Right and left shoulder [3, 2, M] above a hip [3, M], m."""
    neck = hip + (person.trunk + person.shoulder) * trunk.up
    return neck[:, None] + person.shoulder * (SIDES * trunk.left[:, None])
