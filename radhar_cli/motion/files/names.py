"""Which of a file's joints are the thirteen: names of CMU, Mixamo, Blender, mocapbank, Kinect, ...

In BVH and npz a joint is where its bone begins (Mixamo's `RightArm` is the shoulder); in ASF it is
where its bone ends (`rclavicle` ends at the shoulder). "RightShoulder" is the clavicle in Mixamo
and the joint in mocapbank: arms come first.
"""

import re
from collections.abc import Mapping, Sequence

from radhar_cli.errors import did_you_mean
from radhar_cli.motion.files.recording import MotionRecording, motion_file_error
from radhar_cli.motion.skeleton import JOINTS

HIP_JOINTS = ("right_hip_joint", "left_hip_joint")
WANTED = (*JOINTS, *HIP_JOINTS)

# Names of each joint, the best first, without side, prefix, case and punctuation.
_BEGINS: dict[str, tuple[str, ...]] = {
    "torso": (
        *("thorax", "spine2", "spine1", "chest2", "upperchest", "chest", "spinechest"),
        *("spinemid", "spine003", "spine002", "spine001"),  # Blender's Rigify
        *("spine04", "spine03", "spine02", "spine01", "spine", "torso"),  # Unreal's mannequins
    ),
    "head": ("head",),
    "hip": ("hips", "hip", "pelvis", "root", "spinebase", "hipcenter", "hipscenter"),
    "shoulder": ("upperarm", "uparm", "humerus", "uarm", "arm", "shldr", "shldrbend", "shoulder"),
    "elbow": ("forearm", "lowerarm", "lowarm", "farm", "forearmbend", "radius", "elbow"),
    "hand": ("wrist", "hand"),
    "hip_joint": ("upleg", "upperleg", "thigh", "thighbend", "femur", "hip", "hipjoint"),
    "knee": ("knee", "shin", "calf", "lowerleg", "lowleg", "tibia", "leg"),
    "ankle": ("ankle", "foot"),
}
_ENDS: dict[str, tuple[str, ...]] = {
    "torso": ("thorax", "upperback"),
    "head": ("head",),
    "hip": ("root",),
    "shoulder": ("clavicle",),
    "elbow": ("humerus",),
    "hand": ("wrist", "radius"),
    "hip_joint": ("hipjoint",),
    "knee": ("femur",),
    "ankle": ("tibia",),
}
_PREFIX = re.compile(r"^(?:.*:|bip\d+|mixamorig\d*)")


def joint_numbers(file: MotionRecording, configured: Mapping[str, str]) -> list[int | None]:
    """Numbers in the file of the thirteen joints, then of the hip joints.

    Args:
        file: Recording whose joints have names of any common kind.
        configured: {our name: the file's} by the config, which goes before the tables.

    Returns:
        A number for each of WANTED; None for a hip joint that the file does not have.

    Raises:
        MotionFileError: One of the thirteen is not there.
    """
    numbers = {_plain(name): n for n, name in reversed([*enumerate(file.names)])}
    table = _ENDS if file.at_bone_ends else _BEGINS
    chosen: dict[str, int | None] = {}
    for joint in WANTED:
        if joint in configured:
            if configured[joint] not in file.names:
                hint = did_you_mean(
                    configured[joint], file.names, f"it has {_list_names(file.names)}"
                )
                raise motion_file_error(
                    file.where, f"has no joint {configured[joint]!r} (joints.{joint}); {hint}"
                )
            chosen[joint] = file.names.index(configured[joint])
            continue
        possible = _possible_names(joint, table)
        chosen[joint] = next((numbers[word] for word in possible if word in numbers), None)
    for side, joint in zip(("right", "left"), HIP_JOINTS, strict=True):
        knee = chosen[f"{side}_knee"]
        parent = None if knee is None or joint in configured else file.parents[knee]
        if parent is not None:
            chosen[joint] = parent
    missing = [joint for joint in JOINTS if chosen[joint] is None]
    if missing:
        raise motion_file_error(
            file.where,
            f"has no joint that is {' or '.join(missing)} by its name; it has "
            f"{_list_names(file.names)}; joints: {{{missing[0]}: NAME, ...}} of its class says "
            "which these are (--joints FILE.yaml)",
        )
    return [chosen[joint] for joint in WANTED]


def _possible_names(joint: str, table: Mapping[str, tuple[str, ...]]) -> list[str]:
    """Every plain name that a joint may have, the best first."""
    side, _, part = joint.partition("_")
    if part not in table:
        return list(table[joint])
    forms = (side + "{}", "{}" + side, side[0] + "{}", "{}" + side[0])
    return [form.format(word) for word in table[part] for form in forms]


def _plain(name: str) -> str:
    """Name in lower case, without prefix and punctuation: `mixamorig:RightArm` is `rightarm`."""
    return re.sub(r"[^a-z0-9]", "", _PREFIX.sub("", name.lower()))


def _list_names(names: Sequence[str]) -> str:
    listed = ", ".join(name[:30] for name in names[:40])
    return f"{listed}, ..." if len(names) > 40 else listed
