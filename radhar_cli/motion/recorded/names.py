"""The thirteen joints among those of a file: names of CMU, Mixamo, Blender, mocapbank, Kinect, ...

In BVH and npz a joint is where its bone begins (Mixamo's `RightArm` is the shoulder); in ASF it is
where its bone ends (`rclavicle` ends at the shoulder). "RightShoulder" is the clavicle in Mixamo
and the joint in mocapbank: arms come first. Poses have no bones, and often neither a hip nor a
torso nor a head: these are means of joints that they have.
"""

from collections.abc import Mapping, Sequence
from typing import NamedTuple, TypeAlias

from radhar_cli.errors import did_you_mean
from radhar_cli.motion.recorded.joint_sets import JOINT_SETS, JointSet, find_joint_set
from radhar_cli.motion.recorded.keypoints import Keypoints
from radhar_cli.motion.recorded.plain_names import canonical_name, own_names, plain_name
from radhar_cli.motion.recorded.recording import MotionRecording, motion_file_error
from radhar_cli.motion.skeleton import JOINTS, SKELETON, TORSO
from radhar_cli.numerics.arrays import Float

HIP_JOINTS = ("right_hip_joint", "left_hip_joint")
WANTED = (*JOINTS, *HIP_JOINTS)
# {joint of ours: the file's joint, or several whose mean it is}; or the key of a joint set.
JointNames: TypeAlias = Mapping[str, str | Sequence[str]] | str

# Names of each joint, the best first, without side, prefix, case and punctuation.
_BEGINS: dict[str, tuple[str, ...]] = {
    "torso": (
        *("thorax", "spine2", "spine1", "chest2", "upperchest", "chest", "spinechest"),
        *("spinemid", "spine003", "spine002", "spine001"),  # Blender's Rigify
        *("spine04", "spine03", "spine02", "spine01", "spine", "torso"),  # Unreal's mannequins
    ),
    "head": ("head",),
    "hip": ("hips", "hip", "pelvis", "root", "spinebase", "hipcenter", "hipscenter"),
    "shoulder": (
        "upperarm",
        "armupper",
        "uparm",
        "humerus",
        "uarm",
        "arm",
        "shldr",
        "shldrbend",
        "shoulder",
    ),
    "elbow": (
        "forearm",
        "lowerarm",
        "armlower",
        "lowarm",
        "farm",
        "forearmbend",
        "radius",
        "elbow",
    ),
    "hand": ("wrist", "handwrist", "hand"),
    "hip_joint": ("upleg", "upperleg", "thigh", "thighbend", "femur", "hip", "hipjoint"),
    "knee": ("knee", "shin", "calf", "lowerleg", "lowleg", "tibia", "leg"),
    "ankle": ("ankle", "footankle", "foot"),
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
# In poses "spine" may be anywhere from the navel (Kinect v1) to the shoulders (NTU).
_OF_POSES: dict[str, tuple[str, ...]] = {
    **_BEGINS,
    "torso": ("torso",),
    "hip": (*_BEGINS["hip"], "midhip", "basespine"),
}
# Joints whose mean a missing one is, the best first. The ears are beside the middle of the head;
# neck and top of the head are below and above it.
_MEANS: dict[str, tuple[tuple[str, ...], ...]] = {
    "head": (
        ("leftear", "rightear"),
        ("neck", "headtop"),
        ("upperneck", "headtop"),
        ("nose",),
        ("lefteye", "righteye"),
    ),
}
_LINKS = {joint.name: joint.link[2] for joint in SKELETON}
# Share of the way from the hip to the middle of the shoulders at which the torso of radhar is.
TORSO_SHARE = -_LINKS["hip"] / (_LINKS["right_shoulder"] - _LINKS["hip"])

# The same of the head, for poses that have no joint at the head at all.
HEAD_SHARE = (_LINKS["head"] - _LINKS["hip"]) / (_LINKS["right_shoulder"] - _LINKS["hip"])
EAR_SHARE = 0.19  # half the distance of the ears over that of the shoulders
WELL_SEEN = 0.9  # share of the frames of the best joint in which a joint of the head should be seen


class JointMean(NamedTuple):
    """A joint of ours as a weighted mean of a file's joints, given by their numbers."""

    numbers: tuple[int, ...]
    weights: tuple[float, ...]

    @property
    def is_of_trunk(self) -> bool:
        """Whether a head is a point on the line of the trunk: beyond the hip, which it is off."""
        return self.weights[0] < 0

    @classmethod
    def of(cls, numbers: Sequence[int]) -> "JointMean":
        """Plain mean of joints."""
        return cls(tuple(numbers), (1 / len(numbers),) * len(numbers))


def joint_means(file: MotionRecording, configured: JointNames) -> list[JointMean | None]:
    """Means of the file's joints that the thirteen joints are, then the hip joints.

    Args:
        file: Recording whose joints have names of any common kind.
        configured: {our name: the file's, or a list of them} by the config, which goes before the
            tables; or the key of the joint set in whose order the file's joints are.

    Returns:
        A mean for each of WANTED; None for a hip joint that the file does not have.

    Raises:
        MotionFileError: One of the thirteen is not there.
    """
    names, joint_set, numbers = own_names(file.names), None, dict[int, int]()
    if isinstance(configured, str):
        joint_set = JOINT_SETS[configured]
        _require_size(file, configured, joint_set)
        names = tuple(name.split("|")[0] for name in joint_set.names)
        numbers, configured = {n: n for n in range(len(names))}, {}
    elif isinstance(file, Keypoints):
        joint_set, numbers = find_joint_set(names) or (None, {})
    means: dict[str, JointMean | None] = {
        joint: _configured_mean(file, joint, configured[joint])
        for joint in WANTED
        if joint in configured
    }
    for joint, sources in joint_set.sources.items() if joint_set else ():
        places = [_place_in_set(joint_set, name) for name in sources if joint_set]
        if all(place in numbers for place in places):
            means.setdefault(joint, JointMean.of([numbers[place] for place in places]))
    _name_joints(means, names, _table_of(file))
    _hang_hip_joints(means, file, configured)
    if isinstance(file, Keypoints):
        _add_means(means, names, file.seen_shares())
    _add_torso(means)
    missing = [joint for joint in JOINTS if means[joint] is None]
    if missing:
        raise motion_file_error(
            file.where,
            f"has no joint that is {' or '.join(missing)} by its name; it has "
            f"{_list_names(file.names)}; joints: {{{missing[0]}: NAME, ...}} of its class says "
            "which these are (--joints FILE.yaml)",
        )
    return [means[joint] for joint in WANTED]


def _require_size(file: MotionRecording, key: str, joint_set: JointSet) -> None:
    """Refuse a file that has another number of joints than the set it should have."""
    if len(file.names) != len(joint_set.names):
        raise motion_file_error(
            file.where,
            f"has {len(file.names)} joints; {key} ({joint_set.title}) has {len(joint_set.names)}",
        )


def _place_in_set(joint_set: JointSet, name: str) -> int:
    """Number in a set of the joint of a name, or of a name that it is also called by."""
    exact = [n for n, spelled in enumerate(joint_set.names) if spelled.split("|")[0] == name]
    return exact[0]


def _configured_mean(
    file: MotionRecording, joint: str, configured: str | Sequence[str]
) -> JointMean:
    """Mean of the joints that a config names for one of ours."""
    named = [configured] if isinstance(configured, str) else configured
    for name in named:
        if name not in file.names:
            hint = did_you_mean(name, file.names, f"it has {_list_names(file.names)}")
            raise motion_file_error(file.where, f"has no joint {name!r} (joints.{joint}); {hint}")
    return JointMean.of([file.names.index(name) for name in named])


def _table_of(file: MotionRecording) -> Mapping[str, tuple[str, ...]]:
    """Names by which joints of a file are recognised."""
    if isinstance(file, Keypoints):
        return _OF_POSES
    return _ENDS if file.at_bone_ends else _BEGINS


def _name_joints(
    means: dict[str, JointMean | None],
    names: Sequence[str],
    table: Mapping[str, tuple[str, ...]],
) -> None:
    """Find by their names those of ours that are not known yet, None where there is none."""
    numbers = {plain_name(name): n for n, name in reversed([*enumerate(names)])}
    for joint in WANTED:
        if joint in means:
            continue
        possible = _possible_names(joint, table)
        number = next((numbers[word] for word in possible if word in numbers), None)
        means[joint] = None if number is None else JointMean.of([number])


def _hang_hip_joints(
    means: dict[str, JointMean | None], file: MotionRecording, configured: Mapping[str, object]
) -> None:
    """Take what the knees hang on as hip joints, where the file has a tree of bones."""
    for side, joint in zip(("right", "left"), HIP_JOINTS, strict=True):
        knee = means[f"{side}_knee"]
        known = knee is None or len(knee.numbers) != 1 or joint in configured
        parent = None if known or knee is None else file.parents[knee.numbers[0]]
        if parent is not None:
            means[joint] = JointMean.of([parent])


def _add_torso(means: dict[str, JointMean | None]) -> None:
    """Make hip and torso of hip joints and shoulders where a file has none of their own."""
    hips = [means[joint] for joint in HIP_JOINTS]
    known = [hip for hip in hips if hip is not None]
    if means["hip"] is None and len(known) == len(hips):
        means["hip"] = _weigh(known, [1 / len(known)] * len(known))
    hip, shoulders, torso = means["hip"], _shoulders_of(means), JOINTS[TORSO]
    if means[torso] is None and hip is not None and None not in shoulders:
        means[torso] = _along_trunk(hip, shoulders, TORSO_SHARE)


def _shoulders_of(means: Mapping[str, JointMean | None]) -> list[JointMean | None]:
    """Right and left shoulder."""
    return [means[f"{side}_shoulder"] for side in ("right", "left")]


def _add_means(means: dict[str, JointMean | None], names: Sequence[str], shares: Float) -> None:
    """Make hip, head and torso of other joints of a pose where it has none of their own.

    Args:
        means: Means of the joints that are known; completed in place.
        names: Names of the file's joints.
        shares: Shares [J] of the frames in which they are seen: an ear that is not seen for long
            is left out, and so is a head that is never seen.
    """
    well_seen = shares >= WELL_SEEN * shares.max()
    head = means["head"]
    if head is not None and not shares[list(head.numbers)].all():
        means["head"] = None
    names = [
        name if seen or name in WANTED else "" for name, seen in zip(names, well_seen, strict=True)
    ]
    numbers = {canonical_name(name): n for n, name in reversed([*enumerate(names)])}
    for joint, choices in _MEANS.items():
        for sources in choices:
            if means[joint] is not None:
                break
            parts = [
                means[name] if name in means else _mean_of_number(numbers.get(name))
                for name in sources
            ]
            known = [part for part in parts if part is not None]
            if len(known) == len(parts):
                means[joint] = _weigh(known, [1 / len(known)] * len(known))
    if means["head"] is None or means["head"].numbers == (numbers.get("nose"),):
        means["head"] = _beside_ear(means, numbers) or means["head"]
    _add_torso(means)
    hip, shoulders = means["hip"], _shoulders_of(means)
    if means["head"] is None and hip is not None and None not in shoulders:
        means["head"] = _along_trunk(hip, shoulders, HEAD_SHARE)


def _beside_ear(
    means: Mapping[str, JointMean | None], numbers: Mapping[str, int]
) -> JointMean | None:
    """Middle of the head beside the only ear that is seen, along the line of the shoulders."""
    for side, other in (("right", "left"), ("left", "right")):
        ear = numbers.get(f"{side}ear")
        shoulder, far = means[f"{side}_shoulder"], means[f"{other}_shoulder"]
        if ear is not None and shoulder is not None and far is not None:
            parts = [JointMean.of([ear]), far, shoulder]
            return _weigh(parts, [1.0, EAR_SHARE, -EAR_SHARE])
    return None


def _along_trunk(hip: JointMean, shoulders: Sequence[JointMean | None], share: float) -> JointMean:
    """Point on the line from the hip to the middle of the shoulders, at a share of its length."""
    known = [hip, *(shoulder for shoulder in shoulders if shoulder is not None)]
    return _weigh(known, [1 - share, share / 2, share / 2])


def _mean_of_number(number: int | None) -> JointMean | None:
    """Mean of one joint of a file."""
    return None if number is None else JointMean.of([number])


def _weigh(parts: Sequence[JointMean], weights: Sequence[float]) -> JointMean:
    """Weighted mean of means."""
    numbers = tuple(number for part in parts for number in part.numbers)
    products = tuple(
        weight * inner
        for part, weight in zip(parts, weights, strict=True)
        for inner in part.weights
    )
    return JointMean(numbers, products)


def _possible_names(joint: str, table: Mapping[str, tuple[str, ...]]) -> list[str]:
    """Every plain name that a joint may have, the best first."""
    side, _, part = joint.partition("_")
    if part not in table:
        return list(table[joint])
    forms = (side + "{}", "{}" + side, side[0] + "{}", "{}" + side[0])
    return [form.format(word) for word in table[part] for form in forms]


def _list_names(names: Sequence[str]) -> str:
    listed = ", ".join(name[:30] for name in names[:40])
    return f"{listed}, ..." if len(names) > 40 else listed
