"""Joint sets of recordings without names: by their number, and by what makes a body."""

import numpy as np

from radhar_cli.errors import MotionFileError
from radhar_cli.motion.files.joint_sets import sets_of_size
from radhar_cli.motion.files.keypoints import Keypoints
from radhar_cli.motion.files.names import WANTED, JointMean, joint_means
from radhar_cli.motion.files.recording import motion_file_error
from radhar_cli.numerics.arrays import Float

SAMPLED = 2000  # frames at most that are looked at
SIDES = 1.6  # largest ratio of a right and a left bone
WOBBLE = 0.35  # largest spread of a bone's length (10th to 90th percentile) over its median
# Least and largest lengths over the leg's, thigh and shank: of people of all ages, with a margin.
PROPORTIONS = {
    ("hip_joint", "knee"): (0.35, 0.65),
    ("knee", "ankle"): (0.35, 0.65),
    ("shoulder", "elbow"): (0.2, 0.6),
    ("elbow", "hand"): (0.15, 0.6),
    ("hip", "shoulder"): (0.35, 0.95),
    ("hip", "hip_joint"): (0.02, 0.3),
    ("shoulder", "other shoulder"): (0.2, 0.8),
}
SHORT = ("hip", "hip_joint")  # so short that noise alone makes it wobble
HEAD = (1.0, 1.9)  # least and largest way from hip to head along the trunk, over the trunk's length


def find_joint_order(file: Keypoints) -> tuple[str, str]:
    """Find the one joint set in whose order the joints of a recording make a body.

    Args:
        file: Recording without names.

    Returns:
        Key of the set, and a remark that says what was found.

    Raises:
        MotionFileError: No known set does, or more than one.
    """
    count = len(file.names)
    known = sets_of_size(count)
    bodies = {key: _plausible_body(file, key) for key in known}
    fitting = [key for key, body in bodies.items() if body is not None]
    distinct: list[str] = []
    for key in fitting:
        if not any(bodies[key] == bodies[other] for other in distinct):
            distinct.append(key)
    if len(distinct) == 1:
        title = known[distinct[0]].title
        return distinct[0], f"its {count} joints have no names: taken in the order of {title}"
    if known:
        reason = "each makes a body" if distinct else "in none of these orders do they make a body"
        possible = f"{', '.join(distinct or known)} ({reason})"
    else:
        possible = "no set that is known has so many"
    raise motion_file_error(
        file.where,
        f"has {count} joints without names; {possible}: joints: SET of its class says in whose "
        "order they are, or {right_knee: NUMBER, ...} from 0 (--joints SET or FILE.yaml)",
    )


def _plausible_body(file: Keypoints, key: str) -> list[JointMean | None] | None:
    """What joints are taken for which in the order of a set; None where they make no body."""
    try:
        means = joint_means(file, key)
        hip = means[WANTED.index("hip")]
        chosen = [mean or hip for mean in means]
        numbers = sorted({n for mean in chosen if mean for n in mean.numbers})
        step = -(-len(file.values) // SAMPLED)
        sampled = file.positions(numbers)[::step]
    except MotionFileError:
        return None
    body = {
        joint: _weighted_mean(sampled, numbers, mean)
        for joint, mean in zip(WANTED, chosen, strict=True)
        if mean is not None
    }
    return means if _is_body(body) else None


def _weighted_mean(p: Float, numbers: list[int], mean: JointMean) -> Float:
    """Positions [frames, 3] of a mean of joints [frames, joints, 3] of these numbers."""
    columns = [numbers.index(number) for number in mean.numbers]
    blended: Float = np.einsum("j,fja->fa", np.array(mean.weights), p[:, columns])
    return blended


def _is_body(p: dict[str, Float]) -> bool:
    """Whether joints {name: [frames, 3]} have the proportions of a body, and keep them."""
    lengths = {side: _bone_lengths(p, side) for side in ("right", "left")}
    medians = {}
    for side, bones in lengths.items():
        for bone, length in bones.items():
            known = length[np.isfinite(length)]
            if not known.size or not np.median(known) > 0:
                return False
            low, medians[side, bone], high = np.percentile(known, [10, 50, 90])
            if bone != SHORT and high - low > WOBBLE * medians[side, bone]:
                return False
    for bone, (least, largest) in PROPORTIONS.items():
        right, left = medians["right", bone], medians["left", bone]
        leg = sum(medians["right", b] + medians["left", b] for b in list(PROPORTIONS)[:2]) / 2
        if not 1 / SIDES < right / left < SIDES or not least < (right + left) / 2 / leg < largest:
            return False
    trunk = (p["right_shoulder"] + p["left_shoulder"]) / 2 - p["hip"]
    share = ((p["head"] - p["hip"]) * trunk).sum(axis=1) / (trunk**2).sum(axis=1)
    return bool(HEAD[0] < np.nanmedian(share) < HEAD[1])


def _bone_lengths(p: dict[str, Float], side: str) -> dict[tuple[str, str], Float]:
    """Lengths [frames] of the bones of a side."""
    other = "left" if side == "right" else "right"
    places = {
        joint: p[f"{side}_{joint}"]
        for joint in ("hip_joint", "knee", "ankle", "shoulder", "elbow", "hand")
    }
    places |= {"hip": p["hip"], "other shoulder": p[f"{other}_shoulder"]}
    return {bone: np.linalg.norm(places[bone[0]] - places[bone[1]], axis=1) for bone in PROPORTIONS}
