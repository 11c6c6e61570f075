"""Errors of radhar's joints as read from other joint sets, of a walker whose joints are known.

A walker of the human model is written in each joint set, with the offsets that joints of real
skeletons have (eyes ahead of the head, collars beside the neck, toes ahead of the ankle), and read
as any file. One scale and one turn about the vertical are free. Run `python
scripts/joint_set_errors.py` for the table of docs/guide/poses.md.
"""

from collections.abc import Mapping

import numpy as np

from radhar_cli.config import Config
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.motion.recorded.clip import make_clip
from radhar_cli.motion.recorded.joint_sets import JOINT_SETS, JointSet
from radhar_cli.motion.recorded.keypoints import make_keypoints
from radhar_cli.motion.recorded.names import WANTED
from radhar_cli.motion.recorded.plain_names import canonical_name
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Float
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.scene import nominal_scene
from radhar_cli.scene.single.motion_file import sample_joints

RATE, SECONDS, HEIGHT_M = 30.0, 4.0, 1.75
# {canonical name: (joint of ours, m ahead, m to the own side or left, m up)}, along the trunk.
OFFSETS: dict[str, tuple[str, float, float, float]] = {
    "nose": ("head", 0.11, 0.0, -0.01),
    "necknose": ("head", 0.07, 0.0, -0.08),
    "head": ("head", 0.0, 0.0, 0.0),
    "headtop": ("head", 0.0, 0.0, 0.12),
    "jaw": ("head", 0.07, 0.0, -0.06),
    "lefteye": ("head", 0.09, 0.033, 0.03),
    "lefteyeinner": ("head", 0.09, 0.02, 0.03),
    "lefteyeouter": ("head", 0.08, 0.045, 0.03),
    "leftear": ("head", 0.0, 0.075, 0.0),
    "mouthleft": ("head", 0.09, 0.025, -0.05),
    "leftshoulder": ("left_shoulder", 0.0, 0.0, 0.0),
    "leftelbow": ("left_elbow", 0.0, 0.0, 0.0),
    "leftwrist": ("left_hand", 0.0, 0.0, 0.0),
    "lefthip": ("left_hip_joint", 0.0, 0.0, 0.0),
    "leftknee": ("left_knee", 0.0, 0.0, 0.0),
    "leftankle": ("left_ankle", 0.0, 0.0, 0.0),
    "leftheel": ("left_ankle", -0.05, 0.0, -0.04),
    "leftfoot": ("left_ankle", 0.12, 0.0, -0.04),
    "leftbigtoe": ("left_ankle", 0.18, -0.02, -0.05),
    "leftsmalltoe": ("left_ankle", 0.15, 0.04, -0.05),
}
HIPS = {"hip", "hips", "pelvis", "midhip", "spinebase", "basespine", "hipcenter", "root"}
NECKS = {"neck", "thorax", "upperneck", "spineshoulder", "shouldercenter", "throat", "spine4"}
# Joints that are elsewhere than their names say: Human3.6M's feet are its ankles.
MISNAMED = {
    "h36m17": {"head": "headtop", "rightfoot": "rightankle", "leftfoot": "leftankle"},
    "h36m32": {"head": "headtop", "rightfoot": "rightankle", "leftfoot": "leftankle"},
    "mpi_inf17": {"head": "necknose"},  # as Human3.6M's, whose names it has
    "xsens23": {
        **{"l5": "spine1", "l3": "spine1", "t12": "spine2", "t8": "spine3"},
        **{
            f"{side}{theirs}": f"{side}{part}"
            for side in ("right", "left")
            for theirs, part in {
                **{"shoulder": "collar", "upperarm": "shoulder", "forearm": "elbow"},
                **{"hand": "wrist", "upperleg": "hip", "lowerleg": "knee", "foot": "ankle"},
            }.items()
        },
    },
    "kit21": {
        **{"bp": "spine1", "bt": "spine3", "bln": "neck", "bun": "head"},
        **{
            f"{side[0]}{theirs}": f"{side}{part}"
            for side in ("right", "left")
            for theirs, part in {
                **{"s": "shoulder", "e": "elbow", "w": "wrist", "h": "hip", "k": "knee"},
                **{"a": "ankle", "mrot": "heel", "f": "toe"},
            }.items()
        },
    },
}
# Share of the way from hip to shoulders of points of the spine, which are behind the trunk's axis.
SPINES = {
    **dict.fromkeys(("spine1", "navalspine", "spinenavel"), 0.25),
    **dict.fromkeys(("spinemid", "midspine", "spine2", "spine"), 0.5),
    **dict.fromkeys(("spine3", "chestspine", "spinechest", "torso"), 0.7),
}


def walker(seconds: float = SECONDS, rate: float = RATE) -> Float:
    """Positions [frames, 15, 3] (m) of a walker of the human model; z is up."""
    config = Config.model_validate(
        {
            "duration_s": seconds,
            "subject": {"height_m": HEIGHT_M},
            "motion": {"range_m": 2, "angle_deg": 20},
        }
    )
    motion = motion_of(nominal_scene(config, activity_named("walking")).people[0])
    return sample_joints(motion, np.arange(round(seconds * rate) + 1) / rate)


def poses_of(joint_set: JointSet, p: Float) -> Float:
    """Positions [frames, J, 3] of the joints of a set, of a body p [frames, 15, 3]."""
    joints = {name: p[:, number] for number, name in enumerate(WANTED)}
    middle = (joints["right_shoulder"] + joints["left_shoulder"]) / 2
    up = _unit(middle - joints["hip"])
    left = joints["left_shoulder"] - joints["right_shoulder"]
    left = _unit(left - (left * up).sum(axis=1, keepdims=True) * up)
    axes = np.cross(left, up), left, up
    names = [canonical_name(name.split("|")[0]) for name in joint_set.names]
    key = next(key for key, other in JOINT_SETS.items() if other is joint_set)
    names = [MISNAMED.get(key, {}).get(name, name) for name in names]
    own_torso = "torso" in names
    return np.stack([_joint(name, joints, axes, own_torso) for name in names], axis=1)


def joint_errors(p: Float, found: Float) -> Float:
    """Rms errors [13] (m) of joints [frames, 13, 3] after one scale and one turn about z."""
    ankles = [JOINTS.index("right_ankle"), JOINTS.index("left_ankle")]
    true, other = (
        q - np.append(q[0, ankles].mean(axis=0)[:2], q[:, ankles, 2].min()) for q in (p, found)
    )
    dot = (other[..., :2] * true[..., :2]).sum()
    cross = (true[..., 0] * other[..., 1] - true[..., 1] * other[..., 0]).sum()
    angle = np.arctan2(cross, dot)
    turn = np.array(
        [[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]]
    )
    turned = true @ turn.T
    scale = (turned * other).sum() / (turned**2).sum()
    errors: Float = np.sqrt(((scale * turned - other) ** 2).sum(axis=2).mean(axis=0)) / scale
    return errors


def errors_of_sets(keys: tuple[str, ...] = tuple(JOINT_SETS)) -> dict[str, Float]:
    """Rms errors [13] (m) of each joint set by its key."""
    p = walker()
    errors = {}
    for key in keys:
        joint_set = JOINT_SETS[key]
        names = [name.split("|")[0] for name in joint_set.names]
        clip = make_clip(make_keypoints(key, names, poses_of(joint_set, p), RATE), up="z")
        errors[key] = joint_errors(p[:, : len(JOINTS)], clip.positions[:, : len(JOINTS)])
    return errors


def _joint(
    name: str, joints: Mapping[str, Float], axes: tuple[Float, Float, Float], own_torso: bool
) -> Float:
    """Positions [frames, 3] of a joint by its canonical name, of joints of ours."""
    hip = joints["hip"]
    middle = (joints["right_shoulder"] + joints["left_shoulder"]) / 2
    ahead, _, up = axes
    if name in HIPS:
        return hip
    if name.startswith("face"):
        name = "nose"
    if name == "torso" and own_torso:
        return joints["torso"]
    if name in NECKS:
        return middle + 0.03 * up
    if name in SPINES:
        return hip + SPINES[name] * (middle - hip) - 0.04 * ahead
    side = "right" if name.startswith("right") or name.endswith("right") else "left"
    as_left = name.replace("right", "left")
    if as_left in OFFSETS:
        part, *offset = OFFSETS[as_left]
        return _shift(joints[part.replace("left", side)], offset, axes, side)
    if as_left in ("leftcollar", "leftclavicle"):
        return (middle + joints[f"{side}_shoulder"]) / 2
    if as_left in ("leftfootindex", "lefttoe"):
        return _shift(joints[f"{side}_ankle"], [0.18, 0.0, -0.05], axes, side)
    if as_left.startswith("left"):  # fingers and the hand, beyond the wrist
        beyond = _unit(joints[f"{side}_hand"] - joints[f"{side}_elbow"])
        return joints[f"{side}_hand"] + (0.16 if "tip" in name else 0.08) * beyond
    raise ValueError(f"no place for {name}")


def _shift(start: Float, offset: list[float], axes: tuple[Float, Float, Float], side: str) -> Float:
    """Points beside a joint: ahead, to its own side, up."""
    signs = (1, 1 if side == "left" else -1, 1)
    shifted: Float = start + sum(
        sign * metres * axis for sign, metres, axis in zip(signs, offset, axes, strict=True)
    )
    return shifted


def _unit(vectors: Float) -> Float:
    unit: Float = vectors / np.linalg.norm(vectors, axis=1, keepdims=True)
    return unit


def main() -> None:
    """Print the table."""
    print("| set | key | joints | mean, cm | largest, cm |")
    print("| --- | --- | ---: | ---: | --- |")
    for key, errors in errors_of_sets().items():
        worst = f"{100 * errors.max():.1f} ({JOINTS[int(errors.argmax())].replace('_', ' ')})"
        joint_set = JOINT_SETS[key]
        mean = 100 * errors.mean()
        print(f"| {joint_set.title} | `{key}` | {len(joint_set.names)} | {mean:.1f} | {worst} |")


if __name__ == "__main__":
    main()
