"""Forward kinematics: angles -> positions of the 13 scatterers (paper, equations 1 and 2)."""

from dataclasses import dataclass, field

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.body import skeleton
from radhar_cli.body.activities import (
    LYING_HEIGHT,
    Gait,
    Posture,
    Timing,
    highest_frequency,
    kinks,
    posture,
)
from radhar_cli.body.skeleton import JOINTS, PARENTS, TORSO


@dataclass(frozen=True)
class Body:
    """A person performing one activity: scatterer positions at any time.

    Attributes:
        number: the activity, 1 to 12.
        height: stature, m.
        weight: kg.
        start: where the torso stands, (range, cross-range), m.
        angle: motion angle, rad; 0 walks away from the radar.
        gait, timing: how and when the limbs move.
    """

    number: int
    height: float
    weight: float
    start: tuple[float, float]
    angle: float
    gait: Gait
    timing: Timing
    links: Float = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "links", skeleton.links(self.height))

    @property
    def cross_sections(self) -> Float:
        """RCS [13], m^2."""
        return skeleton.cross_sections(self.height, self.weight)

    @property
    def kinks(self) -> tuple[float, ...]:
        """Instants (s) at which a position is not smooth."""
        return kinks(self.number, self.timing)

    @property
    def highest_frequency(self) -> float:
        """Fundamental of the fastest motion, Hz."""
        return highest_frequency(self.number, self.gait, self.timing)

    def torso(self, t: Float) -> Float:
        """Positions [3, 1, M] (m) of the torso alone at times t [M] (s)."""
        return self._torso(posture(self.number, t, self.gait, self.timing), t.size)[:, None]

    def positions(self, t: Float) -> Float:
        """Positions [3, 13, M] (m) of all scatterers at times t [M] (s)."""
        now = posture(self.number, t, self.gait, self.timing)
        if np.any(now.seated):
            bend = np.pi / 2 * np.asarray(now.seated)
            for side in ("right", "left"):
                now.angles[f"{side}_knee"] = np.asarray(now.angles.get(f"{side}_knee", 0.0)) - bend
                now.angles[f"{side}_ankle"] = (
                    np.asarray(now.angles.get(f"{side}_ankle", 0.0)) + bend
                )
        p = np.empty((3, len(JOINTS), t.size))
        p[:, TORSO] = self._torso(now, t.size)
        forward, sideways = self._relative(now, p)
        yaw = self.angle + now.twist
        cos, sin = np.cos(yaw), np.sin(yaw)
        p[0] = p[0, TORSO] + cos * forward - sin * sideways
        p[1] = p[1, TORSO] + sin * forward + cos * sideways
        return p

    def _torso(self, now: Posture, count: int) -> Float:
        """Torso track [3, M]: travel and seat along the heading, seat and fall in height."""
        thigh = skeleton.thigh_length(self.height)
        bend = np.pi / 2 * now.seated
        along = now.travelled - thigh * np.sin(bend)
        standing = skeleton.standing_height(self.height)
        track = np.empty((3, count))
        track[0] = self.start[0] + np.cos(self.angle) * along
        track[1] = self.start[1] + np.sin(self.angle) * along
        track[2] = standing + (LYING_HEIGHT - standing) * now.lying - thigh * (1 - np.cos(bend))
        return track

    def _relative(self, now: Posture, p: Float) -> tuple[Float, Float]:
        """Fill the heights p[2]; return offsets from the torso ahead [13, M] and aside [13, 1]."""
        count = p.shape[2]
        ahead = np.zeros((len(JOINTS), count))
        aside = np.zeros((len(JOINTS), 1))
        turned: list[Float | float] = [now.pitch + now.angles.get(JOINTS[TORSO], 0.0)]
        for joint, parent in enumerate(PARENTS):
            if parent is None:
                continue
            x, y, z = self.links[joint]
            angle = turned[parent]
            own = now.angles.get(JOINTS[joint])
            turned.append(angle if own is None else angle + own)
            cos, sin = np.cos(turned[joint]), np.sin(turned[joint])
            ahead[joint] = ahead[parent] + (x * cos + z * sin)
            aside[joint] = aside[parent] + y
            p[2, joint] = p[2, parent] + (z * cos - x * sin)
        return ahead, aside
