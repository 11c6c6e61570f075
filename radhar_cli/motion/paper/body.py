"""Forward kinematics: angles -> positions of the 13 scatterers (paper, equations 1 and 2)."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from radhar_cli.motion import skeleton
from radhar_cli.motion.paper.activities import (
    LYING_HEIGHT,
    PAPER_ACTIVITIES,
    PaperActivity,
    PaperGait,
    Posture,
    Timing,
)
from radhar_cli.motion.skeleton import JOINTS, PARENTS, TORSO
from radhar_cli.numerics.arrays import Float


@dataclass(frozen=True)
class PaperBody:
    """A `Motion` of a person who performs one activity as the paper has it."""

    activity: str  # slug of the activity
    height: float  # stature, m
    weight: float  # kg
    start: tuple[float, float]  # where the torso stands, (range, cross-range), m
    angle: float  # motion angle, rad; 0 walks away from the radar
    gait: PaperGait
    timing: Timing

    names = JOINTS
    parents = PARENTS

    @cached_property
    def links(self) -> Float:
        """Vectors [13, 3] (m) to each joint from the one that it hangs on."""
        return skeleton.links(self.height)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Instants (s) at which an acceleration jumps."""
        return self._record.breakpoints(self.timing)

    @property
    def highest_frequency(self) -> float:
        """Fundamental of the fastest motion, Hz."""
        return self._record.highest_frequency(self.gait, self.timing)

    @property
    def phases(self) -> tuple[tuple[float, str], ...]:
        """(start in s, name) of the activity's movements."""
        return self._record.phases(self.timing)

    @property
    def _record(self) -> PaperActivity:
        return PAPER_ACTIVITIES[self.activity]

    def _posture(self, t: Float) -> Posture:
        return self._record.posture(t, self.gait, self.timing)

    def cross_sections(self, t: Float) -> Float:
        """RCS of the joints [13, 1] (m^2): the same from everywhere, at all times."""
        return skeleton.cross_sections(self.height, self.weight)[:, None]

    def torso(self, t: Float) -> Float:
        """Positions [3, 1, M] (m) of the torso alone at times t [M] (s)."""
        return self._torso(self._posture(t), t.size)[:, None]

    def positions(self, t: Float) -> Float:
        """Positions [3, 13, M] (m) of all scatterers at times t [M] (s)."""
        posture = self._posture(t)
        if np.any(posture.seated):
            bend = np.pi / 2 * np.asarray(posture.seated)
            for side in ("right", "left"):
                for joint, sign in ((f"{side}_knee", -1), (f"{side}_ankle", 1)):
                    posture.angles[joint] = np.asarray(posture.angles.get(joint, 0.0)) + sign * bend
        p = np.empty((3, len(JOINTS), t.size))
        p[:, TORSO] = self._torso(posture, t.size)
        forward, sideways = self._relative(posture, p)
        yaw = self.angle + posture.twist
        cos, sin = np.cos(yaw), np.sin(yaw)
        p[0] = p[0, TORSO] + cos * forward - sin * sideways
        p[1] = p[1, TORSO] + sin * forward + cos * sideways
        return p

    def _torso(self, posture: Posture, count: int) -> Float:
        """Torso track [3, count] (m): travel and seat along the heading, seat and fall in z."""
        thigh = skeleton.thigh_length(self.height)
        bend = np.pi / 2 * posture.seated
        along = posture.travelled - thigh * np.sin(bend)
        standing = skeleton.standing_height(self.height)
        track = np.empty((3, count))
        track[0] = self.start[0] + np.cos(self.angle) * along
        track[1] = self.start[1] + np.sin(self.angle) * along
        track[2] = standing + (LYING_HEIGHT - standing) * posture.lying - thigh * (1 - np.cos(bend))
        return track

    def _relative(self, posture: Posture, p: Float) -> tuple[Float, Float]:
        """Fill in the heights p[2] of all joints.

        Returns:
            Offsets from the torso ahead [13, M] and aside [13, 1], m.
        """
        count = p.shape[2]
        ahead = np.zeros((len(JOINTS), count))
        aside = np.zeros((len(JOINTS), 1))
        angle = posture.pitch + posture.angles.get(JOINTS[TORSO], 0.0)
        turned = [(angle, np.cos(angle), np.sin(angle))]
        for joint, parent in enumerate(PARENTS):
            if parent is None:
                continue
            x, y, z = self.links[joint]
            angle, cos, sin = turned[parent]
            joint_angle = posture.angles.get(JOINTS[joint])
            if joint_angle is not None:
                angle = angle + joint_angle
                cos, sin = np.cos(angle), np.sin(angle)
            turned.append((angle, cos, sin))
            ahead[joint] = ahead[parent] + (x * cos + z * sin)
            aside[joint] = aside[parent] + y
            p[2, joint] = p[2, parent] + (z * cos - x * sin)
        return ahead, aside
