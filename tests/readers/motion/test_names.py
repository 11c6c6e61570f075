"""The thirteen joints in the names of the usual rigs."""

from dataclasses import dataclass

import pytest

from radhar_cli.errors import MotionFileError
from radhar_cli.motion.recorded.names import TORSO_SHARE, WANTED, JointNames, joint_means
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Float


@dataclass
class Rig:
    """A `Recording` of names alone."""

    names: tuple[str, ...]
    parents: tuple[int | None, ...]
    at_bone_ends: bool = False
    where: str = "x"
    rest: Float | None = None
    rate: float | None = 30.0
    unit: float | None = None

    def positions(self, joints: object) -> Float:
        raise NotImplementedError

    def place(self, frame: int) -> str:
        raise NotImplementedError


def joint_numbers(rig: Rig, configured: JointNames) -> list[int | None]:
    """Number of each joint of ours, which is one of the rig's."""
    means = joint_means(rig, configured)
    assert all(mean is None or len(mean.numbers) == 1 for mean in means)
    return [mean and mean.numbers[0] for mean in means]


def both(*names: str) -> list[str]:
    return [name.format(S=s, s=s.lower(), L=s[0], l=s[0].lower()) for s in ("Left", "Right")
            for name in names]  # fmt: skip


# ruff: noqa: RUF005
# {rig: (its names, its names for torso, head, hip, then right shoulder to ankle)}
RIGS = {
    "cgspeed's CMU": (
        ["Hips", "LHipJoint", "LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase", "RHipJoint"]
        + ["RightUpLeg", "RightLeg", "RightFoot", "LowerBack", "Spine", "Spine1", "Neck", "Head"]
        + both("{S}Shoulder", "{S}Arm", "{S}ForeArm", "{S}Hand", "{S}HandThumb"),
        [
            "Spine1",
            "Head",
            "Hips",
            "RightArm",
            "RightForeArm",
            "RightHand",
            "RightLeg",
            "RightFoot",
        ],
    ),
    "Mixamo": (
        [f"mixamorig:{name}" for name in ["Hips", "Spine", "Spine1", "Spine2", "Neck", "Head"]]
        + [f"mixamorig:{name}" for name in both("{S}Shoulder", "{S}Arm", "{S}ForeArm", "{S}Hand")]
        + [f"mixamorig:{name}" for name in both("{S}UpLeg", "{S}Leg", "{S}Foot", "{S}HandIndex1")],
        ["mixamorig:" + name for name in ["Spine2", "Head", "Hips", "RightArm", "RightForeArm"]]
        + ["mixamorig:" + name for name in ["RightHand", "RightLeg", "RightFoot"]],
    ),
    "Blender": (
        ["pelvis", "spine", "chest", "neck", "head"]
        + both("shoulder.{L}", "upper_arm.{L}", "forearm.{L}", "hand.{L}")
        + both("thigh.{L}", "shin.{L}", "foot.{L}", "toe.{L}"),
        ["chest", "head", "pelvis", "upper_arm.R", "forearm.R", "hand.R", "shin.R", "foot.R"],
    ),
    "mocapbank": (
        ["Hips", "Chest", "Chest2", "Neck", "Head"]
        + both("{S}Collar", "{S}Shoulder", "{S}Elbow", "{S}Wrist")
        + both("{S}Hip", "{S}Knee", "{S}Ankle"),
        ["Chest2", "Head", "Hips", "RightShoulder", "RightElbow", "RightWrist"]
        + ["RightKnee", "RightAnkle"],
    ),
    "Kinect": (
        ["SpineBase", "SpineMid", "Neck", "Head", "SpineShoulder"]
        + both("Shoulder{S}", "Elbow{S}", "Wrist{S}", "Hand{S}", "HandTip{S}", "Thumb{S}")
        + both("Hip{S}", "Knee{S}", "Ankle{S}", "Foot{S}"),
        ["SpineMid", "Head", "SpineBase", "ShoulderRight", "ElbowRight", "WristRight"]
        + ["KneeRight", "AnkleRight"],
    ),
    "Azure Kinect": (
        ["PELVIS", "SPINE_NAVEL", "SPINE_CHEST", "NECK", "HEAD"]
        + [n.upper() for n in both("clavicle_{S}", "shoulder_{S}", "elbow_{S}", "wrist_{S}")]
        + [n.upper() for n in both("hand_{S}", "hip_{S}", "knee_{S}", "ankle_{S}", "foot_{S}")],
        ["SPINE_CHEST", "HEAD", "PELVIS", "SHOULDER_RIGHT", "ELBOW_RIGHT", "WRIST_RIGHT"]
        + ["KNEE_RIGHT", "ANKLE_RIGHT"],
    ),
    "SMPL": (
        ["pelvis", "spine1", "spine2", "spine3", "neck", "head"]
        + both("{s}_collar", "{s}_shoulder", "{s}_elbow", "{s}_wrist", "{s}_hand")
        + both("{s}_hip", "{s}_knee", "{s}_ankle", "{s}_foot"),
        ["spine2", "head", "pelvis", "right_shoulder", "right_elbow", "right_wrist"]
        + ["right_knee", "right_ankle"],
    ),
    "3ds Max": (
        ["Bip01 Pelvis", "Bip01 Spine", "Bip01 Spine1", "Bip01 Neck", "Bip01 Head"]
        + both("Bip01 {L} Clavicle", "Bip01 {L} UpperArm", "Bip01 {L} Forearm", "Bip01 {L} Hand")
        + both("Bip01 {L} Thigh", "Bip01 {L} Calf", "Bip01 {L} Foot"),
        ["Bip01 Spine1", "Bip01 Head", "Bip01 Pelvis", "Bip01 R UpperArm", "Bip01 R Forearm"]
        + ["Bip01 R Hand", "Bip01 R Calf", "Bip01 R Foot"],
    ),
    "Unreal": (
        ["root", "pelvis", "spine_01", "spine_02", "spine_03", "neck_01", "head"]
        + both("clavicle_{l}", "upperarm_{l}", "lowerarm_{l}", "hand_{l}")
        + both("thigh_{l}", "calf_{l}", "foot_{l}", "ball_{l}"),
        ["spine_03", "head", "pelvis", "upperarm_r", "lowerarm_r", "hand_r", "calf_r", "foot_r"],
    ),
    "Second Life": (
        ["hip", "abdomen", "chest", "neck", "head"]
        + both("{l}Collar", "{l}Shldr", "{l}ForeArm", "{l}Hand", "{l}Thigh", "{l}Shin", "{l}Foot"),
        ["chest", "head", "hip", "rShldr", "rForeArm", "rHand", "rShin", "rFoot"],
    ),
}
ASKED = ["torso", "head", "hip", *(f"right_{p}" for p in ("shoulder", "elbow", "hand"))]
ASKED += ["right_knee", "right_ankle"]


@pytest.mark.parametrize("rig", RIGS)
def test_the_usual_rigs(rig: str) -> None:
    names, right = RIGS[rig]
    found = joint_numbers(Rig(tuple(names), (None,) * len(names)), {})
    mine = dict(zip(WANTED, found, strict=True))
    assert [names[mine[joint] or 0] for joint in ASKED] == right
    assert all("ight" in names[n] or "R" in names[n] or "r" in names[n]
               for joint, n in mine.items() if n and joint.startswith("right"))  # fmt: skip
    lefts = {n for joint, n in mine.items() if joint.startswith("left")}
    assert lefts.isdisjoint({n for joint, n in mine.items() if not joint.startswith("left")})
    hips = [n for joint, n in mine.items() if joint.endswith("hip_joint")]
    assert all(n is not None for n in hips)


TRUNKS = {
    "Xsens": (
        ["Pelvis", "L5", "L3", "T12", "T8", "Neck", "Head"]
        + both("{S}Shoulder", "{S}UpperArm", "{S}ForeArm", "{S}Hand")
        + both("{S}UpperLeg", "{S}LowerLeg", "{S}Foot", "{S}Toe"),
        ["Pelvis", "RightUpperArm", "LeftUpperArm"],
    ),
    "AIST": (
        ["root", "torso_1", "torso_2", "torso_3", "neck_1", "head"]
        + both("{l}_shoulder", "{l}_elbow", "{l}_wrist", "{l}_hip", "{l}_knee", "{l}_ankle"),
        ["root", "r_shoulder", "l_shoulder"],
    ),
}


@pytest.mark.parametrize("rig", TRUNKS)
def test_a_rig_without_a_known_torso_has_it_between_hip_and_shoulders(rig: str) -> None:
    names, trunk = TRUNKS[rig]
    means = joint_means(Rig(tuple(names), (None,) * len(names)), {})
    torso = means[WANTED.index("torso")]
    assert torso is not None
    assert sorted(names[n] for n in torso.numbers) == sorted(trunk)
    assert sum(torso.weights) == pytest.approx(1)
    share = torso.weights[torso.numbers.index(names.index(trunk[0]))]
    assert share == pytest.approx(1 - TORSO_SHARE)


def test_vroid_joints_have_a_prefix_before_their_side() -> None:
    parts = ["Hips", "Spine", "Chest", "UpperChest", "Neck", "Head"]
    limbs = ["UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot"]
    names = [f"J_Bip_C_{part}" for part in parts]
    names += [f"J_Bip_{side}_{limb}" for side in "LR" for limb in limbs]
    numbers = joint_numbers(Rig(tuple(names), (None,) * len(names)), {})
    mine = {joint: names[n or 0] for joint, n in zip(WANTED, numbers, strict=True)}
    assert mine["torso"] == "J_Bip_C_UpperChest"
    assert mine["right_elbow"] == "J_Bip_R_LowerArm"
    assert mine["left_hip_joint"] == "J_Bip_L_UpperLeg"


def test_cmu_bones_are_named_by_their_ends() -> None:
    names = ["root", "lhipjoint", "lfemur", "ltibia", "lfoot", "ltoes", "rhipjoint", "rfemur"]
    names += ["rtibia", "rfoot", "rtoes", "lowerback", "upperback", "thorax", "lowerneck", "head"]
    names += both("{l}clavicle", "{l}humerus", "{l}radius", "{l}wrist", "{l}hand")
    parents = [
        None,
        0,
        1,
        2,
        3,
        4,
        0,
        6,
        7,
        8,
        9,
        0,
        11,
        12,
        13,
        14,
        13,
        16,
        17,
        18,
        19,
        13,
        21,
        22,
    ]
    found = joint_numbers(Rig(tuple(names), (*parents, 23, 24), at_bone_ends=True), {})
    mine = {joint: names[n] for joint, n in zip(WANTED, found, strict=True) if n is not None}
    assert [mine[joint] for joint in ASKED] == [
        *("thorax", "head", "root", "rclavicle", "rhumerus", "rwrist", "rfemur", "rtibia")
    ]
    assert mine["left_hip_joint"] == "lhipjoint"


def test_other_names_need_a_table() -> None:
    names, _ = RIGS["mocapbank"]
    foreign = tuple("Knie_rechts" if name == "RightKnee" else name for name in names)
    rig = Rig(foreign, (None,) * len(names))
    with pytest.raises(MotionFileError, match="no joint that is right_knee by its name"):
        joint_numbers(rig, {})
    with pytest.raises(MotionFileError) as refused:
        joint_numbers(Rig(tuple("abcdefghijklm"), (None,) * 13), {})
    assert "no joint that is " + " or ".join(JOINTS) + " by its name" in str(refused.value)
    assert "it has a, b, c, d" in str(refused.value)
    assert "joints: {torso: NAME, ...}" in str(refused.value)
    found = joint_numbers(rig, {"right_knee": "Knie_rechts"})
    assert foreign[found[WANTED.index("right_knee")] or 0] == "Knie_rechts"
    with pytest.raises(MotionFileError, match=r"no joint 'Knie_rechs' .*mean 'Knie_rechts'"):
        joint_numbers(rig, {"right_knee": "Knie_rechs"})
