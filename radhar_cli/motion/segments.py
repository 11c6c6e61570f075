"""The parts of a body between its joints: limbs, trunk, head, hands and feet as ellipsoids.

They are found by the names of joints (`radhar_cli.motion.skeleton`), so any motion that has some of
these has the parts between them. Sizes are those of a person of 1.75 m and 26 kg/m^2.
"""

from collections.abc import Iterable
from math import sqrt
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.motion.protocol import Motion
from radhar_cli.motion.skeleton import default_weight

REFERENCE_STATURE = 1.75
# A trunk reaches from below the hip to above the shoulders, on both sides of the torso point, and a
# head to both sides of its point, in lengths from hip to shoulders; a hand beyond its point, in
# lengths of the forearm.
TRUNK = 0.486  # from hip to shoulders, m
TRUNK_BELOW, TRUNK_ABOVE, HEAD_HALF = 0.72, 0.52, 0.237
HAND_FROM, HAND_TO = -0.1, 0.5
# Heel and toes behind and ahead of the ankle, m; a foot is flat below the first height of its ankle
# over the floor and at right angles to the shank above the second.
HEEL, TOES = 0.05, 0.20
FLAT_BELOW, BENT_ABOVE = 0.07, 0.17
SOFTNESS = 0.1  # of directions made of others, which fade where these are parallel


@runtime_checkable
class Landmarks(Protocol):
    """A motion that knows more points of the body than those that scatter, such as hip joints.

    Attributes:
        landmarks: names; besides the joints, `right_hip`, `left_hip`, `right_toes` and `left_toes`
            mean something here.
    """

    @property
    def landmarks(self) -> tuple[str, ...]: ...

    def landmark_positions(self, t: Float) -> Float:
        """Positions [3, len(landmarks), M] (m) at times t [M] (s)."""
        ...


class Segment(NamedTuple):
    """One ellipsoid."""

    name: str  # of the part
    # start, end: names of the points between which it lies
    start: str
    end: str
    radius: float  # across, m, the mean of two where it is flat
    joint: str  # which it goes with when joints are seen alone
    # whether it is of an arm: its cross axis comes from the back instead of the side
    arm: bool = False
    occludes: bool = False  # whether it is large enough to hide others
    flatness: float = 1.0  # width over the mean radius, and this over depth


def _side(side: str) -> tuple[Segment, ...]:
    shoulder, elbow, hand, hip, knee, ankle, heel, toes = (
        f"{side}_{point}"
        for point in ("shoulder", "elbow", "hand", "hip", "knee", "ankle", "heel", "toes")
    )
    return (
        Segment(f"{side}_upper_arm", shoulder, elbow, 0.05, elbow, arm=True, flatness=1.07),
        Segment(f"{side}_forearm", elbow, hand, 0.042, hand, arm=True, flatness=1.2),
        Segment(f"{side}_hand", f"{hand}_from", f"{hand}_to", 0.035, hand, arm=True, flatness=1.5),
        Segment(f"{side}_thigh", hip, knee, 0.075, knee, occludes=True, flatness=0.97),
        Segment(f"{side}_shank", knee, ankle, 0.055, ankle, flatness=0.95),
        Segment(f"{side}_foot", heel, toes, 0.04, ankle),
    )


SEGMENTS: tuple[Segment, ...] = (
    Segment("trunk", "trunk_from", "trunk_to", 0.14, "torso", occludes=True, flatness=1.18),
    Segment("head", "head_from", "head_to", 0.085, "head"),
    *_side("right"),
    *_side("left"),
)
_TRUNK = ("torso", "hip", "right_shoulder", "left_shoulder")


def landmarks_of(motion: Motion) -> tuple[str, ...]:
    """Names of all points of the body that a motion knows."""
    return motion.landmarks if isinstance(motion, Landmarks) else motion.names


def found_segments(names: Iterable[str]) -> tuple[Segment, ...]:
    """The segments of a motion with points of these names."""
    have = set(names)
    if have >= set(_TRUNK):
        have |= {"trunk_from", "trunk_to"}
        have |= {"head_from", "head_to"} if "head" in have else set()
    for side in ("right", "left"):
        if {f"{side}_elbow", f"{side}_hand"} <= have:
            have |= {f"{side}_hand_from", f"{side}_hand_to"}
        if "hip" in have:
            have.add(f"{side}_hip")
        if {f"{side}_knee", f"{side}_ankle", *_TRUNK} <= have:
            have |= {f"{side}_heel", f"{side}_toes"}
    return tuple(one for one in SEGMENTS if {one.start, one.end} <= have)


def covered(joint: str, segments: Iterable[Segment]) -> tuple[int, ...]:
    """Which of the segments stand for a joint; hip and shoulders are the trunk's."""
    there, owner = list(segments), "torso" if joint in _TRUNK else joint
    own = tuple(n for n, one in enumerate(there) if one.joint == owner)
    return own or tuple(n for n, one in enumerate(there) if joint in (one.start, one.end))


def thickness(stature: float, weight: float) -> float:
    """Of a person's limbs over those of the reference: volume goes with weight."""
    return stature / REFERENCE_STATURE * sqrt(weight / default_weight(stature))


class Placed(NamedTuple):
    """Segments at M instants, in m."""

    # start, end: of S segments [3, S, M]
    start: Float
    end: Float
    beside: Float  # a unit vector of the body that is not along the segment in most poses [3, S, M]


def place(motion: Motion, segments: tuple[Segment, ...], stature: float, t: Float) -> Placed:
    """Where segments (`found_segments`) of a motion are at times t [M] (s).

    `stature` (m) is for the size of feet.
    """
    p = motion.landmark_positions(t) if isinstance(motion, Landmarks) else motion.positions(t)
    at = dict(zip(landmarks_of(motion), p.swapaxes(0, 1), strict=True))
    left, behind = _add_points(at, stature / REFERENCE_STATURE, t.size)
    start = np.stack([at[one.start] for one in segments], axis=1)
    end = np.stack([at[one.end] for one in segments], axis=1)
    beside = np.stack([behind if one.arm else left for one in segments], axis=1)
    return Placed(start, end, beside)


def _add_points(at: dict[str, Float], scale: float, count: int) -> tuple[Float, Float]:
    """Add the ends that no joint has; return directions to the left and backwards [3, M]."""
    whole = set(_TRUNK) <= at.keys()
    for side in ("right", "left"):
        elbow, hand = at.get(f"{side}_elbow"), at.get(f"{side}_hand")
        if elbow is not None and hand is not None:
            at[f"{side}_hand_from"] = hand + HAND_FROM * (hand - elbow)
            at[f"{side}_hand_to"] = hand + HAND_TO * (hand - elbow)
    if not whole:
        # No body to tell left from right: any fixed directions do.
        fixed = np.broadcast_to(np.array([[0.48], [0.6], [0.64]]), (3, count))
        return fixed, fixed
    up = scale * TRUNK * unit(at["torso"] - at["hip"])
    at["trunk_from"] = at["torso"] - TRUNK_BELOW * up
    at["trunk_to"] = at["torso"] + TRUNK_ABOVE * up
    if "head" in at:
        at["head_from"] = at["head"] - HEAD_HALF * up
        at["head_to"] = at["head"] + HEAD_HALF * up
    left = unit(at["left_shoulder"] - at["right_shoulder"])
    behind = unit(cross(left, up))
    across = left
    if "right_hip" in at and "left_hip" in at:
        across = unit(at["left_hip"] - at["right_hip"])
    for side in ("right", "left"):
        at.setdefault(f"{side}_hip", at["hip"])
        knee, ankle = at.get(f"{side}_knee"), at.get(f"{side}_ankle")
        if knee is not None and ankle is not None:
            toes = at.get(f"{side}_toes")
            foot = _foot(knee, ankle, across, scale) if toes is None else unit(toes - ankle)
            at[f"{side}_heel"] = ankle - HEEL * scale * foot
            at[f"{side}_toes"] = ankle + TOES * scale * foot
    return left, behind


def _foot(knee: Float, ankle: Float, left: Float, scale: float) -> Float:
    """Direction [3, M] from ankle to toes: at right angles to the shank, flat near the floor."""
    foot = soft_unit(cross(unit(ankle - knee), left))
    middle, width = 0.5 * (FLAT_BELOW + BENT_ABOVE) * scale, (BENT_ABOVE - FLAT_BELOW) * scale
    foot[2] *= 0.5 + 0.5 * np.tanh((ankle[2] - middle) / (0.24 * width))
    return soft_unit(foot)


def unit(v: Float) -> Float:
    """v/|v| [3, ...]; 0 where v is."""
    length = np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    one: Float = v / np.maximum(length, np.finfo(float).tiny)
    return one


def soft_unit(v: Float) -> Float:
    """v/sqrt(|v|^2 + SOFTNESS^2) [3, ...]: the direction of v, fading to 0 where that is lost."""
    one: Float = v / np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + SOFTNESS * SOFTNESS)
    return one


def cross(a: Float, b: Float) -> Float:
    """a x b [3, ...]; numpy.cross takes ten times as long."""
    return np.array(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )
