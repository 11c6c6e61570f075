"""The parts of a body between its joints: limbs, trunk, head, hands and feet as ellipsoids.

They are known by the names of joints (`radhar_cli.motion.skeleton`), so any motion that has some of
these has the parts between them. Sizes are those of a person of 1.75 m and 26 kg/m^2.
"""

from collections.abc import Iterable
from math import sqrt
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np

from radhar_cli.motion.protocol import Motion
from radhar_cli.motion.skeleton import BODY_MASS_INDEX
from radhar_cli.numerics.arrays import Float

REFERENCE_STATURE = 1.75
# A trunk reaches from below the hip to above the shoulders, on both sides of the torso point, and a
# head to both sides of its point, in lengths from hip to shoulders; a hand beyond its point, in
# lengths of the forearm.
TRUNK = 0.486  # from hip to shoulders, m
TRUNK_BELOW = 0.72
TRUNK_ABOVE = 0.52
HEAD_HALF = 0.237
HAND_FROM = -0.1
HAND_TO = 0.5
# Heel and toes behind and ahead of the ankle, m; a foot is flat below the first height of its ankle
# over the floor and at right angles to the shank above the second.
HEEL = 0.05
TOES = 0.20
FLAT_BELOW = 0.07
BENT_ABOVE = 0.17
SOFTNESS = 0.1  # length of a cross product of directions below which its direction fades


@runtime_checkable
class Landmarks(Protocol):
    """A motion that knows more points of the body than those that scatter, such as hip joints.

    Attributes:
        landmarks: Names of the points; besides the joints, `right_hip`, `left_hip`, `right_toes`
            and `left_toes` mean something here.
    """

    @property
    def landmarks(self) -> tuple[str, ...]: ...

    def landmark_positions(self, t: Float) -> Float:
        """Positions [3, len(landmarks), M] (m) at times t [M] (s)."""
        ...


class Segment(NamedTuple):
    """One ellipsoid of a body, between two points."""

    name: str  # name of the part of the body
    # start, end: names of the points between which it lies
    start: str
    end: str
    radius: float  # across, m, the mean of two where it is flat
    joint: str  # joint that it stands for when joints are seen alone
    # whether it belongs to an arm: its cross axis comes from the back instead of the side
    arm: bool = False
    occludes: bool = False  # whether it is large enough to hide others
    flatness: float = 1.0  # width over the mean radius, and this over depth


def _side(side: str) -> tuple[Segment, ...]:
    """Segments of the arm and the leg of one side."""
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


def landmark_names(motion: Motion) -> tuple[str, ...]:
    """Names of all points of the body that a motion knows, scatterers or not."""
    return motion.landmarks if isinstance(motion, Landmarks) else motion.names


def segments_between(names: Iterable[str]) -> tuple[Segment, ...]:
    """Segments of a motion that has points of these names.

    Args:
        names: Joints and further landmarks; ends of trunk, head, hands and feet follow from them.

    Returns:
        Those of SEGMENTS whose two ends are known, in that order.
    """
    known = set(names)
    if known >= set(_TRUNK):
        known |= {"trunk_from", "trunk_to"}
        known |= {"head_from", "head_to"} if "head" in known else set()
    for side in ("right", "left"):
        if {f"{side}_elbow", f"{side}_hand"} <= known:
            known |= {f"{side}_hand_from", f"{side}_hand_to"}
        if "hip" in known:
            known.add(f"{side}_hip")
        if {f"{side}_knee", f"{side}_ankle", *_TRUNK} <= known:
            known |= {f"{side}_heel", f"{side}_toes"}
    return tuple(segment for segment in SEGMENTS if {segment.start, segment.end} <= known)


def segments_of_joint(joint: str, segments: Iterable[Segment]) -> tuple[int, ...]:
    """Numbers of the segments that stand for a joint; hip and shoulders belong to the trunk."""
    listed = list(segments)
    owner = "torso" if joint in _TRUNK else joint
    numbers = tuple(n for n, segment in enumerate(listed) if segment.joint == owner)
    return numbers or tuple(
        n for n, segment in enumerate(listed) if joint in (segment.start, segment.end)
    )


def thickness(stature: float, weight: float) -> float:
    """Factor of the radii of a person's limbs over those of the reference: volume goes with weight.

    Args:
        stature: m.
        weight: kg.
    """
    return stature / REFERENCE_STATURE * sqrt(weight / BODY_MASS_INDEX) / stature


class SegmentPositions(NamedTuple):
    """Ends and orientation of S segments at M instants, in m."""

    # start, end: both ends of the segments [3, S, M]
    start: Float
    end: Float
    beside: Float  # a unit vector of the body, not along the segment in most poses [3, S, M]


def segment_positions(
    motion: Motion, segments: tuple[Segment, ...], stature: float, t: Float
) -> SegmentPositions:
    """Ends and orientation of segments of a motion at some times.

    Args:
        motion: Has the points between which the segments lie.
        segments: Chosen by `segments_between`.
        stature: Stature of the person, which sets the size of trunk and feet, m.
        t: Times [M], s.
    """
    p = motion.landmark_positions(t) if isinstance(motion, Landmarks) else motion.positions(t)
    points = dict(zip(landmark_names(motion), p.swapaxes(0, 1), strict=True))
    left, behind = _add_points(points, stature / REFERENCE_STATURE, t.size)
    start = np.stack([points[segment.start] for segment in segments], axis=1)
    end = np.stack([points[segment.end] for segment in segments], axis=1)
    beside = np.stack([behind if segment.arm else left for segment in segments], axis=1)
    return SegmentPositions(start, end, beside)


def _add_points(points: dict[str, Float], scale: float, count: int) -> tuple[Float, Float]:
    """Add to {name: point [3, M]} the ends that no joint has.

    Returns:
        Directions to the left and backwards [3, M].
    """
    has_trunk = set(_TRUNK) <= points.keys()
    for side in ("right", "left"):
        elbow, hand = points.get(f"{side}_elbow"), points.get(f"{side}_hand")
        if elbow is not None and hand is not None:
            points[f"{side}_hand_from"] = hand + HAND_FROM * (hand - elbow)
            points[f"{side}_hand_to"] = hand + HAND_TO * (hand - elbow)
    if not has_trunk:
        # No body to tell left from right: any fixed directions do.
        direction = np.broadcast_to(np.array([[0.48], [0.6], [0.64]]), (3, count))
        return direction, direction
    up = scale * TRUNK * unit(points["torso"] - points["hip"])
    points["trunk_from"] = points["torso"] - TRUNK_BELOW * up
    points["trunk_to"] = points["torso"] + TRUNK_ABOVE * up
    if "head" in points:
        points["head_from"] = points["head"] - HEAD_HALF * up
        points["head_to"] = points["head"] + HEAD_HALF * up
    left = unit(points["left_shoulder"] - points["right_shoulder"])
    behind = unit(cross(left, up))
    across = left
    if "right_hip" in points and "left_hip" in points:
        across = unit(points["left_hip"] - points["right_hip"])
    for side in ("right", "left"):
        points.setdefault(f"{side}_hip", points["hip"])
        knee, ankle = points.get(f"{side}_knee"), points.get(f"{side}_ankle")
        if knee is not None and ankle is not None:
            toes = points.get(f"{side}_toes")
            foot = (
                foot_direction(knee, ankle, across, scale) if toes is None else unit(toes - ankle)
            )
            points[f"{side}_heel"] = ankle - HEEL * scale * foot
            points[f"{side}_toes"] = ankle + TOES * scale * foot
    return left, behind


def foot_direction(knee: Float, ankle: Float, left: Float, scale: float) -> Float:
    """Direction [3, M] from ankle to toes: at right angles to the shank, flat near the floor.

    Args:
        knee: Knee [3, M], m.
        ankle: Ankle [3, M], m.
        left: Unit vector from the right to the left hip joint [3, M].
        scale: Stature over that of the reference.
    """
    foot = soft_unit(cross(unit(ankle - knee), left))
    middle, width = 0.5 * (FLAT_BELOW + BENT_ABOVE) * scale, (BENT_ABOVE - FLAT_BELOW) * scale
    foot[2] *= 0.5 + 0.5 * np.tanh((ankle[2] - middle) / (0.24 * width))
    return soft_unit(foot)


def unit(v: Float) -> Float:
    """Unit vectors v/|v| [3, ...]; 0 where v is 0."""
    length = np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2])
    direction: Float = v / np.maximum(length, np.finfo(float).tiny)
    return direction


def soft_unit(v: Float) -> Float:
    """Directions v/sqrt(|v|^2 + SOFTNESS^2) [3, ...], which fade to 0 where v does."""
    direction: Float = v / np.sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2] + SOFTNESS * SOFTNESS)
    return direction


def cross(a: Float, b: Float) -> Float:
    """Cross products a x b [3, ...]; numpy.cross takes ten times as long."""
    return np.array(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )
