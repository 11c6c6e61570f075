"""Joint sets of pose estimation and of depth cameras: their joints in their own order and names.

A new set is an entry of JOINT_SETS. What its names do not tell by themselves stands in `sources`:
NTU's "spine" is between the shoulders, and "Head" of Human3.6M is the top of the head.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from radhar_cli.motion.files.plain_names import canonical_name


@dataclass(frozen=True)
class JointSet:
    """Joints of a pose, as a network or a camera gives them.

    Attributes:
        title: Name of the set in messages and tables.
        names: Names of the joints in the set's own order; "Hip|Pelvis" is called either.
        sources: {joint of ours: the joints whose mean it is} where names alone would mislead.
        is_by_axis: Whether its maker's columns are all x, then all y, then all z.
    """

    title: str
    names: tuple[str, ...]
    sources: Mapping[str, tuple[str, ...]] = field(default_factory=dict)
    is_by_axis: bool = False

    @property
    def spellings(self) -> tuple[frozenset[str], ...]:
        """What each joint may be called, in canonical form."""
        return tuple(frozenset(map(canonical_name, name.split("|"))) for name in self.names)


_FACE = "nose left_eye right_eye left_ear right_ear"
_COCO = (
    f"{_FACE} left_shoulder right_shoulder left_elbow right_elbow left_wrist right_wrist "
    "left_hip right_hip left_knee right_knee left_ankle right_ankle"
)
_OPENPOSE = (
    "Nose Neck RShoulder RElbow RWrist LShoulder LElbow LWrist {}RHip RKnee RAnkle LHip LKnee "
    "LAnkle REye LEye REar LEar"
)
_KINECT = (
    "SpineBase SpineMid Neck Head ShoulderLeft ElbowLeft WristLeft{left} ShoulderRight ElbowRight "
    "WristRight{right} HipLeft KneeLeft AnkleLeft FootLeft HipRight KneeRight AnkleRight FootRight "
    "SpineShoulder"
)
_NTU = (
    "base_spine mid_spine neck head left_shoulder left_elbow left_wrist left_hand right_shoulder "
    "right_elbow right_wrist right_hand left_hip left_knee left_ankle left_foot right_hip "
    "right_knee right_ankle right_foot spine left_hand_tip left_thumb right_hand_tip right_thumb"
)
_SMPL = (
    "pelvis left_hip right_hip spine1 left_knee right_knee spine2 left_ankle right_ankle spine3 "
    "left_foot right_foot neck left_collar right_collar head left_shoulder right_shoulder "
    "left_elbow right_elbow left_wrist right_wrist"
)
_ZED_34 = (
    "PELVIS NAVAL_SPINE CHEST_SPINE NECK LEFT_CLAVICLE LEFT_SHOULDER LEFT_ELBOW LEFT_WRIST "
    "LEFT_HAND LEFT_HANDTIP LEFT_THUMB RIGHT_CLAVICLE RIGHT_SHOULDER RIGHT_ELBOW RIGHT_WRIST "
    "RIGHT_HAND RIGHT_HANDTIP RIGHT_THUMB LEFT_HIP LEFT_KNEE LEFT_ANKLE LEFT_FOOT RIGHT_HIP "
    "RIGHT_KNEE RIGHT_ANKLE RIGHT_FOOT HEAD NOSE LEFT_EYE LEFT_EAR RIGHT_EYE RIGHT_EAR LEFT_HEEL "
    "RIGHT_HEEL"
)
_PAIRS_ZED_38 = (
    "EYE EAR CLAVICLE SHOULDER ELBOW WRIST HIP KNEE ANKLE BIG_TOE SMALL_TOE HEEL HAND_THUMB_4 "
    "HAND_INDEX_1 HAND_MIDDLE_4 HAND_PINKY_1"
)
_ZED_38 = "PELVIS SPINE_1 SPINE_2 SPINE_3 NECK NOSE " + " ".join(
    f"LEFT_{part} RIGHT_{part}" for part in _PAIRS_ZED_38.split()
)
_AZURE = (
    "PELVIS SPINE_NAVEL SPINE_CHEST NECK CLAVICLE_LEFT SHOULDER_LEFT ELBOW_LEFT WRIST_LEFT "
    "HAND_LEFT HANDTIP_LEFT THUMB_LEFT CLAVICLE_RIGHT SHOULDER_RIGHT ELBOW_RIGHT WRIST_RIGHT "
    "HAND_RIGHT HANDTIP_RIGHT THUMB_RIGHT HIP_LEFT KNEE_LEFT ANKLE_LEFT FOOT_LEFT HIP_RIGHT "
    "KNEE_RIGHT ANKLE_RIGHT FOOT_RIGHT HEAD NOSE EYE_LEFT EAR_LEFT EYE_RIGHT EAR_RIGHT"
)
_BLAZEPOSE = (
    "nose left_eye_inner left_eye left_eye_outer right_eye_inner right_eye right_eye_outer "
    "left_ear right_ear mouth_left mouth_right left_shoulder right_shoulder left_elbow right_elbow "
    "left_wrist right_wrist left_pinky right_pinky left_index right_index left_thumb right_thumb "
    "left_hip right_hip left_knee right_knee left_ankle right_ankle left_heel right_heel "
    "left_foot_index right_foot_index"
)
_H36M = (
    "Hip|Pelvis|Root RHip RKnee RFoot|RAnkle LHip LKnee LFoot|LAnkle Spine|Torso|Belly "
    "Thorax|Neck Neck/Nose|Nose|Jaw|neck_base|Head Head|HeadTop|Site LShoulder LElbow LWrist "
    "RShoulder RElbow RWrist"
)
_MPI_INF_3DHP = (
    "spine3 spine4 spine2 spine pelvis neck head head_top left_clavicle left_shoulder left_elbow "
    "left_wrist left_hand right_clavicle right_shoulder right_elbow right_wrist right_hand "
    "left_hip left_knee left_ankle left_foot left_toe right_hip right_knee right_ankle right_foot "
    "right_toe"
)
_KINECT_1 = (
    "HIP_CENTER SPINE SHOULDER_CENTER HEAD SHOULDER_LEFT ELBOW_LEFT WRIST_LEFT HAND_LEFT "
    "SHOULDER_RIGHT ELBOW_RIGHT WRIST_RIGHT HAND_RIGHT HIP_LEFT KNEE_LEFT ANKLE_LEFT FOOT_LEFT "
    "HIP_RIGHT KNEE_RIGHT ANKLE_RIGHT FOOT_RIGHT"
)
_MPII = (
    "r_ankle r_knee r_hip l_hip l_knee l_ankle pelvis thorax upper_neck head_top r_wrist r_elbow "
    "r_shoulder l_shoulder l_elbow l_wrist"
)
_HALPE = (
    f"{_COCO} head neck hip left_big_toe right_big_toe left_small_toe right_small_toe left_heel "
    "right_heel"
)
_MAXINE = (
    "pelvis left_hip right_hip torso left_knee right_knee neck left_ankle right_ankle left_big_toe "
    "right_big_toe left_small_toe right_small_toe left_heel right_heel nose left_eye right_eye "
    "left_ear right_ear left_shoulder right_shoulder left_elbow right_elbow left_wrist right_wrist "
    "left_pinky_knuckle right_pinky_knuckle left_middle_tip right_middle_tip left_index_knuckle "
    "right_index_knuckle left_thumb_tip right_thumb_tip"
)
_WHOLE_BODY = " ".join(
    [
        f"{_COCO} left_big_toe left_small_toe left_heel right_big_toe right_small_toe right_heel",
        *(f"face_{n}" for n in range(68)),
        *(f"{side}_hand_{n}" for side in ("left", "right") for n in range(21)),
    ]
)
_FINGERS = " ".join(
    f"{side}_{finger}{n}"
    for side in ("left", "right")
    for finger in ("index", "middle", "pinky", "ring", "thumb")
    for n in (1, 2, 3)
)
_H36M_32 = (
    "Hips RHip RKnee RFoot RToe right_toe_end LHip LKnee LFoot LToe left_toe_end Spine Thorax "
    "Neck/Nose Head HeadTop LCollar LShoulder LElbow LWrist left_thumb left_thumb_tip left_hand "
    "left_hand_tip RCollar RShoulder RElbow RWrist right_thumb right_thumb_tip right_hand "
    "right_hand_tip"
)
_PANOPTIC = (
    "Neck Nose MidHip|BodyCenter lShoulder lElbow lWrist lHip lKnee lAnkle rShoulder rElbow rWrist "
    "rHip rKnee rAnkle lEye lEar rEye rEar"
)
_MPI_INF_17 = (
    "head_top neck right_shoulder right_elbow right_wrist left_shoulder left_elbow left_wrist "
    "right_hip right_knee right_ankle left_hip left_knee left_ankle pelvis spine head"
)
_HUMANEVA = (
    "pelvis thorax left_shoulder left_elbow left_wrist right_shoulder right_elbow right_wrist "
    "left_hip left_knee left_ankle right_hip right_knee right_ankle head"
)
_LSP = (
    "right_ankle right_knee right_hip left_hip left_knee left_ankle right_wrist right_elbow "
    "right_shoulder left_shoulder left_elbow left_wrist neck head_top"
)
_XSENS = (
    "Pelvis L5 L3 T12 T8 Neck Head RightShoulder RightUpperArm RightForeArm RightHand LeftShoulder "
    "LeftUpperArm LeftForeArm LeftHand RightUpperLeg RightLowerLeg RightFoot RightToe LeftUpperLeg "
    "LeftLowerLeg LeftFoot LeftToe"
)
_KIT = "root BP BT BLN BUN LS LE LW RS RE RW LH LK LA LMrot LF RH RK RA RMrot RF"
_PARTS_OF_KIT = {"S": "shoulder", "E": "elbow", "W": "hand", "H": "hip_joint", "K": "knee"}
# {key that a config or --joints names: the set}; order tells which comes first in messages.
JOINT_SETS: dict[str, JointSet] = {
    "coco17": JointSet("COCO", tuple(_COCO.split())),
    "openpose18": JointSet("OpenPose COCO, ZED BODY_18", tuple(_OPENPOSE.format("").split())),
    "openpose25": JointSet(
        "OpenPose BODY_25",
        (
            *_OPENPOSE.format("MidHip ").split(),
            *["LBigToe", "LSmallToe", "LHeel", "RBigToe", "RSmallToe", "RHeel"],
        ),
    ),
    "blazepose33": JointSet("BlazePose, MediaPipe", tuple(_BLAZEPOSE.split())),
    "halpe26": JointSet("Halpe", tuple(_HALPE.split()), {"head": ("left_ear", "right_ear")}),
    "h36m17": JointSet(
        "Human3.6M", tuple(_H36M.split()), {"head": ("Neck/Nose", "Head"), "hip": ("Hip",)}
    ),
    "mpii16": JointSet("MPII", tuple(_MPII.split()), {"head": ("upper_neck", "head_top")}),
    "mpi_inf_3dhp28": JointSet("MPI-INF-3DHP", tuple(_MPI_INF_3DHP.split())),
    "kinect1_20": JointSet("Kinect v1", tuple(_KINECT_1.split())),
    "kinect2_25": JointSet(
        "Kinect v2",
        (
            *_KINECT.format(left=" HandLeft", right=" HandRight").split(),
            *["HandTipLeft", "ThumbLeft", "HandTipRight", "ThumbRight"],
        ),
    ),
    "ntu25": JointSet("NTU RGB+D", tuple(_NTU.split()), {"hip": ("base_spine",)}),
    "mars19": JointSet("MARS", tuple(_KINECT.format(left="", right="").split()), is_by_axis=True),
    "azure32": JointSet("Azure Kinect", tuple(_AZURE.split())),
    "smpl24": JointSet("SMPL", (*_SMPL.split(), "left_hand", "right_hand")),
    "smpl22": JointSet("SMPL without hands, HumanML3D", tuple(_SMPL.split())),
    "zed34": JointSet("ZED BODY_34", tuple(_ZED_34.split())),
    "zed38": JointSet("ZED BODY_38", tuple(_ZED_38.split())),
    "maxine34": JointSet("NVIDIA Maxine", tuple(_MAXINE.split())),
    "coco133": JointSet("COCO-WholeBody", tuple(_WHOLE_BODY.split())),
    "smplx55": JointSet(
        "SMPL-X", (*_SMPL.split(), "jaw", "left_eye", "right_eye", *_FINGERS.split())
    ),
    "smplh52": JointSet("SMPL-H, AMASS", (*_SMPL.split(), *_FINGERS.split())),
    "h36m32": JointSet(
        "Human3.6M, all", tuple(_H36M_32.split()), {"head": ("Neck/Nose", "Head"), "hip": ("Hips",)}
    ),
    "panoptic19": JointSet("CMU Panoptic", tuple(_PANOPTIC.split()), {"hip": ("MidHip",)}),
    "mpi_inf17": JointSet(
        "MPI-INF-3DHP, tested", tuple(_MPI_INF_17.split()), {"head": ("head", "head_top")}
    ),
    "humaneva15": JointSet("HumanEva", tuple(_HUMANEVA.split())),
    "lsp14": JointSet("LSP, 3DPW", tuple(_LSP.split())),
    "xsens23": JointSet("Xsens MVN", tuple(_XSENS.split())),
    "kit21": JointSet(
        "KIT-ML",
        tuple(_KIT.split()),
        {
            **{f"right_{part}": (f"R{key}",) for key, part in _PARTS_OF_KIT.items()},
            **{f"left_{part}": (f"L{key}",) for key, part in _PARTS_OF_KIT.items()},
            **{"right_ankle": ("RA",), "left_ankle": ("LA",), "hip": ("root",), "head": ("BUN",)},
        },
    ),
}


def find_joint_set(names: Sequence[str]) -> tuple[JointSet, dict[int, int]] | None:
    """Find the set that a file's joints are named by: all of the set are there, or none else.

    Args:
        names: Names of the joints of the file.

    Returns:
        The largest such set, and {number of a joint of the set: number in the file}; None where
        names are of no set.
    """
    numbers = {canonical_name(name): n for n, name in reversed([*enumerate(names)])}
    fitting = []
    for joint_set in JOINT_SETS.values():
        matches = _match_names(joint_set, numbers)
        if len(matches) == len(joint_set.names) or len(matches) == len(names):
            fitting.append((joint_set, matches))
    return max(fitting, key=lambda pair: len(pair[1]), default=None)


def _match_names(joint_set: JointSet, numbers: Mapping[str, int]) -> dict[int, int]:
    """Joints of a set that a file has: {number in the set: number in the file}.

    Args:
        joint_set: The set.
        numbers: {canonical name: number} of the file's joints.
    """
    matches, used = dict[int, int](), set[int]()
    for place, name in enumerate(joint_set.names):
        for spelling in map(canonical_name, name.split("|")):
            number = numbers.get(spelling)
            if number is not None and number not in used:
                matches[place] = number
                used.add(number)
                break
    return matches


def sets_of_size(count: int) -> dict[str, JointSet]:
    """Joint sets of so many joints."""
    return {key: s for key, s in JOINT_SETS.items() if len(s.names) == count}
