"""Proportions of a body: which fifteen joints make one, and which cannot be anybody's."""

from typing import NamedTuple

import numpy as np

from radhar_cli.motion.files.names import WANTED
from radhar_cli.motion.files.recording import motion_file_error
from radhar_cli.numerics.arrays import Float

SIDES = 1.6  # largest ratio of a right and a left bone by which a body is known
WOBBLE = 0.35  # largest spread of a bone's length (10th to 90th percentile) over its median
HEAD = (1.0, 1.9)  # least and largest way from hip to head along the trunk, over the trunk's length
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
    "half of the hip": _BoneRange("hip", "{}_hip_joint", 0.02, 0.3),
    "way between the shoulders": _BoneRange("right_shoulder", "left_shoulder", 0.2, 0.8),
}
_SHORT = "half of the hip"  # noise alone makes it wobble
_RIGHT, _LEFT = (WANTED.index(f"{side}_shoulder") for side in ("right", "left"))


def is_body(p: Float, has_hip_joints: bool) -> bool:
    """Whether joints [frames, 15, 3] have the proportions of a body, and keep them.

    Args:
        p: Positions of WANTED.
        has_hip_joints: Whether hip joints are other points than the hip.
    """
    medians = {}
    for bone in _BONES if has_hip_joints else [bone for bone in _BONES if bone != _SHORT]:
        for side in ("right", "left"):
            length = _lengths(p, bone, side)
            known = length[np.isfinite(length)]
            if not known.size or not np.median(known) > 0:
                return False
            low, medians[bone, side], high = np.percentile(known, [10, 50, 90])
            if bone != _SHORT and high - low > WOBBLE * medians[bone, side]:
                return False
    if _find_odd_bone(medians, SIDES, 1.0):
        return False
    hip = p[:, WANTED.index("hip")]
    trunk = (p[:, _RIGHT] + p[:, _LEFT]) / 2 - hip
    share = ((p[:, WANTED.index("head")] - hip) * trunk).sum(axis=1) / (trunk**2).sum(axis=1)
    return bool(HEAD[0] < np.nanmedian(share) < HEAD[1])


def refuse_impossible_body(p: Float, where: str) -> None:
    """Refuse joints [frames, 15, 3] whose bones are nobody's, whatever a unit is.

    Args:
        p: Positions of WANTED, without NaN.
        where: Name of the file in messages.

    Raises:
        MotionFileError: A right and a left bone differ nearly twofold, or a bone is far too long or
            too short beside the legs.
    """
    bones = [bone for bone in _BONES if bone != _SHORT]
    medians = {
        (bone, side): float(np.median(_lengths(p, bone, side)))
        for bone in bones
        for side in ("right", "left")
    }
    problem = _find_odd_bone(medians, IMPOSSIBLE_SIDES, IMPOSSIBLE)
    if problem:
        raise motion_file_error(
            where,
            f"{problem}, as no body has; are its joints taken in another order than the file's? "
            "joints: SET of its class says in whose order they are, or {right_knee: NAME, ...} "
            "(--joints SET or FILE.yaml)",
        )


def _find_odd_bone(medians: dict[tuple[str, str], float], sides: float, margin: float) -> str:
    """Say which bone is no body's, by its median lengths; "" where none is.

    Args:
        medians: Median length of each bone and side.
        sides: Largest ratio of a right and a left bone.
        margin: Factor by which proportions may be off.
    """
    leg = sum(medians[bone, side] for bone in ("thigh", "shank") for side in ("right", "left")) / 2
    if not leg > 0:
        return ""
    for name in dict.fromkeys(bone for bone, _ in medians):
        bone, right, left = _BONES[name], medians[name, "right"], medians[name, "left"]
        if max(right, left) >= sides * min(right, left):
            return f"its right {name} is {right:.3g} units long and its left {left:.3g}"
        mean = (right + left) / 2
        if not bone.least / margin < mean / leg < bone.largest * margin:
            return f"its {name} is {mean:.3g} units long, and its legs are {leg:.3g}"
    return ""


def _lengths(p: Float, bone: str, side: str) -> Float:
    """Lengths [frames] of a bone of a side."""
    begin, end = (WANTED.index(joint.format(side)) for joint in _BONES[bone][:2])
    lengths: Float = np.linalg.norm(p[:, begin] - p[:, end], axis=1)
    return lengths
