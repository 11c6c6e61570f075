"""Proportions of a body: which fifteen joints cannot be anybody's."""

from typing import NamedTuple

import numpy as np

from radhar_cli.motion.recorded.names import WANTED
from radhar_cli.motion.recorded.recording import motion_file_error
from radhar_cli.numerics.arrays import Float

# So much the bones of two sides never differ, and so far off no proportion is.
IMPOSSIBLE_SIDES, IMPOSSIBLE = 1.8, 1.5


class _BoneRange(NamedTuple):
    """Two joints of a side; least and largest distance over the leg's length, thigh and shank."""

    begin: str
    end: str
    least: float
    largest: float


# Limits of the bones of people of all ages, with a margin.
_BONES = {
    "thigh": _BoneRange("{}_hip_joint", "{}_knee", 0.35, 0.65),
    "shank": _BoneRange("{}_knee", "{}_ankle", 0.35, 0.65),
    "upper arm": _BoneRange("{}_shoulder", "{}_elbow", 0.2, 0.6),
    "forearm": _BoneRange("{}_elbow", "{}_hand", 0.15, 0.6),
    "way from hip to shoulder": _BoneRange("hip", "{}_shoulder", 0.35, 0.95),
    "way between the shoulders": _BoneRange("right_shoulder", "left_shoulder", 0.2, 0.8),
}


def refuse_impossible_body(p: Float, where: str) -> None:
    """Refuse joints [frames, 15, 3] whose bones are nobody's, whatever a unit is.

    Args:
        p: Positions of WANTED, without NaN.
        where: Name of the file in messages.

    Raises:
        MotionFileError: A right and a left bone differ nearly twofold, or a bone is far too long or
            too short beside the legs.
    """
    medians = {
        (bone, side): float(np.median(_lengths(p, bone, side)))
        for bone in _BONES
        for side in ("right", "left")
    }
    problem = _find_odd_bone(medians)
    if problem:
        raise motion_file_error(
            where,
            f"{problem}, as no body has; are its joints taken in another order than the file's? "
            "joints: SET of its class says in whose order they are, or {right_knee: NAME, ...} "
            "(--joints SET or FILE.yaml)",
        )


def _find_odd_bone(medians: dict[tuple[str, str], float]) -> str:
    """Describe a bone that is no body's, by median lengths of each bone and side; or return ""."""
    leg = sum(medians[bone, side] for bone in ("thigh", "shank") for side in ("right", "left")) / 2
    if not leg > 0:
        return ""
    for name in dict.fromkeys(bone for bone, _ in medians):
        bone, right, left = _BONES[name], medians[name, "right"], medians[name, "left"]
        if max(right, left) >= IMPOSSIBLE_SIDES * min(right, left):
            return f"its right {name} is {right:.3g} units long and its left {left:.3g}"
        mean = (right + left) / 2
        if not bone.least / IMPOSSIBLE < mean / leg < bone.largest * IMPOSSIBLE:
            return f"its {name} is {mean:.3g} units long, and its legs are {leg:.3g}"
    return ""


def _lengths(p: Float, bone: str, side: str) -> Float:
    """Lengths [frames] of a bone of a side."""
    begin, end = (WANTED.index(joint.format(side)) for joint in _BONES[bone][:2])
    lengths: Float = np.linalg.norm(p[:, begin] - p[:, end], axis=1)
    return lengths
