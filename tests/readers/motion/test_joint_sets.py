"""Joint sets of pose estimation: found by name or order, and where the true joints are."""

from collections.abc import Mapping

import joint_set_errors
import numpy as np
import pytest
from helpers.poses import answered_clip

from radhar_cli.errors import MotionFileError
from radhar_cli.motion.recorded.clip import make_clip
from radhar_cli.motion.recorded.joint_sets import JOINT_SETS
from radhar_cli.motion.recorded.keypoints import make_keypoints
from radhar_cli.motion.recorded.names import TORSO_SHARE
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Float

MEAN_M, LARGEST_M = 0.03, 0.07
SHARED = ("panoptic19", "humaneva15")  # whose names another set has, too, so that they tell no axes


@pytest.fixture(scope="module")
def walker() -> Float:
    return joint_set_errors.walker()


def named(key: str) -> list[str]:
    return [name.split("|")[0] for name in JOINT_SETS[key].names]


@pytest.fixture(scope="module")
def errors() -> Mapping[str, Float]:
    return joint_set_errors.errors_of_sets()


@pytest.mark.parametrize("key", JOINT_SETS)
def test_joints_are_where_the_true_ones_are(key: str, errors: Mapping[str, Float]) -> None:
    assert errors[key].max() < LARGEST_M, JOINTS[int(errors[key].argmax())]
    assert errors[key].mean() < MEAN_M


def test_the_torso_of_radhar_is_three_fifths_up() -> None:
    """0.6 of the way from the hip to the middle of the shoulders, as the paper's links say."""
    p = joint_set_errors.walker()
    right, left, hip = (JOINTS.index(n) for n in ("right_shoulder", "left_shoulder", "hip"))
    trunk = (p[:, right] + p[:, left]) / 2 - p[:, hip]
    torso = p[:, JOINTS.index("torso")] - p[:, hip]
    share = (torso * trunk).sum(axis=1) / (trunk**2).sum(axis=1)
    assert share == pytest.approx(TORSO_SHARE, abs=1e-3)
    assert pytest.approx(0.6) == TORSO_SHARE


@pytest.mark.every(3)
@pytest.mark.parametrize("key", JOINT_SETS)
def test_axes_are_asked_for_and_units_are_found(key: str, walker: Float) -> None:
    """y down as a camera's (m), y up (mm) and z up (cm), with a camera's mirror image."""
    p = joint_set_errors.poses_of(JOINT_SETS[key], walker)
    x, y, z = np.moveaxis(p, 2, 0)
    for up, unit, axes, left_handed in (
        ("-y", 1.0, (-y, -z, x), False),
        ("y", 0.001, (-y, z, -x), False),
        ("z", 0.01, (x, y, z), False),
        ("-y", 1.0, (y, -z, x), True),
    ):
        values = np.stack(axes, axis=2) / unit + 3.7 / unit
        file = make_keypoints("x", named(key), values, 30.0)
        clip = answered_clip(file, left_handed=left_handed)
        assert (clip.up, clip.unit) == (up, unit)
        with pytest.raises(MotionFileError, match=r"knees that bend backwards.*--left-handed"):
            answered_clip(file, left_handed=not left_handed)
        documented = None if key in SHARED else JOINT_SETS[key].up
        if documented != up:
            said = "" if documented is None else f"has {documented} up by its kind.*"
            with pytest.raises(MotionFileError, match=rf"{said}\(--up {up}\)"):
                make_clip(file, left_handed=left_handed)
        assert 1.6 < clip.stature < 1.85
        found = joint_set_errors.joint_errors(walker[:, :13], clip.positions[:, :13])
        assert found.max() < LARGEST_M


@pytest.mark.parametrize("key", JOINT_SETS)
def test_a_set_is_asked_for_where_joints_have_no_names(key: str, walker: Float) -> None:
    """A number of joints tells no order; of a set that is said they are as by their names."""
    p = joint_set_errors.poses_of(JOINT_SETS[key], walker)
    p = p + np.random.default_rng(1).normal(0, 0.01, p.shape)
    by_name = answered_clip(make_keypoints("x", named(key), p, 30.0))
    of_set = answered_clip(make_keypoints("x", None, p, 30.0), key)
    assert np.array_equal(by_name.positions, of_set.positions)
    assert not of_set.remarks
    with pytest.raises(MotionFileError, match=rf"without names; sets of so many are .*{key}"):
        answered_clip(make_keypoints("x", None, p, 30.0))


def test_joints_of_no_set_are_asked_for(walker: Float) -> None:
    p = joint_set_errors.poses_of(JOINT_SETS["coco17"], walker)
    with pytest.raises(
        MotionFileError,
        match=r"17 joints without names; sets of so many are coco17 \(COCO\) and h36m17",
    ):
        answered_clip(make_keypoints("x", None, p, 30.0))
    with pytest.raises(MotionFileError, match=r"13 joints without names; no set .*--joints SET"):
        answered_clip(make_keypoints("x", None, p[:, :13], 30.0))
    shuffled = p[:, np.random.default_rng(0).permutation(17)]
    with pytest.raises(MotionFileError, match=r"as no body has; .*--joints SET"):
        answered_clip(make_keypoints("x", None, shuffled, 30.0), "coco17")
    with pytest.raises(MotionFileError, match=r"has 17 joints; smpl24 \(SMPL\) has 24"):
        answered_clip(make_keypoints("x", None, p, 30.0), "smpl24")


def test_a_joint_may_be_the_mean_of_a_list(walker: Float) -> None:
    p = joint_set_errors.poses_of(JOINT_SETS["coco17"], walker)
    names = [f"k{n}" for n in range(17)]
    of_ours = {"right_hip_joint": "k12", "left_hip_joint": "k11", "head": ["k3", "k4"]}
    order = ("left_shoulder", "right_shoulder", "left_elbow", "right_elbow", "left_hand")
    of_ours |= {joint: f"k{5 + n}" for n, joint in enumerate((*order, "right_hand"))}
    legs = ("left_knee", "right_knee", "left_ankle", "right_ankle")
    of_ours |= {joint: f"k{13 + n}" for n, joint in enumerate(legs)}
    with_hip = {**of_ours, "hip": ["k11", "k12"]}
    own = answered_clip(make_keypoints("x", named("coco17"), p, 30.0)).positions
    for joints in (of_ours, with_hip):
        clip = answered_clip(make_keypoints("x", names, p, 30.0), joints)
        assert np.abs(clip.positions - own).max() < 1e-12
    with pytest.raises(MotionFileError, match=r"no joint 'k99' \(joints\.head\)"):
        answered_clip(make_keypoints("x", names, p, 30.0), {**of_ours, "head": ["k3", "k99"]})


def test_other_spellings_of_a_set(walker: Float) -> None:
    """SMPL as L_Hip, Human3.6M with pelvis and ankles, Kinect in capitals."""
    h36m = "Pelvis RHip RKnee RAnkle LHip LKnee LAnkle Spine Thorax Nose Head LShoulder LElbow"
    h36m_2 = "pelvis right_hip right_knee right_ankle left_hip left_knee left_ankle spine neck head"
    smpl = [n.replace("left_", "L_").replace("right_", "R_") for n in JOINT_SETS["smpl24"].names]
    arms = " left_shoulder left_elbow left_wrist right_shoulder right_elbow right_wrist"
    for key, names in (
        ("h36m17", (h36m + " LWrist RShoulder RElbow RWrist").split()),
        ("h36m17", (h36m_2 + " head_top" + arms).split()),
        ("smpl24", smpl),
        ("kinect2_25", [name.upper() for name in JOINT_SETS["kinect2_25"].names]),
    ):
        p = joint_set_errors.poses_of(JOINT_SETS[key], walker)
        clip = answered_clip(make_keypoints("x", names, p, 30.0))
        assert joint_set_errors.joint_errors(walker[:, :13], clip.positions[:, :13]).max() < 0.05


@pytest.mark.parametrize("unit", [None, 0.3, 1.0, 2.0])
@pytest.mark.parametrize(
    ("joints", "bone"),
    [
        ({"left_knee": "left_ankle", "left_ankle": "left_knee"}, "right thigh is .* its left"),
        ({"right_elbow": "right_knee"}, "right upper arm is .* its left"),
        ({"right_hip_joint": "left_ear"}, "right thigh is"),
        ({"right_knee": "right_wrist", "left_knee": "left_wrist"}, "thigh is"),
        ({"right_shoulder": "right_ankle", "left_shoulder": "left_ankle"}, "upper arm is"),
    ],
)
def test_bones_of_nobody_are_refused_whatever_the_unit(
    joints: dict[str, str], bone: str, unit: float | None, walker: Float
) -> None:
    p = joint_set_errors.poses_of(JOINT_SETS["coco17"], walker)
    with pytest.raises(MotionFileError, match=rf"^x: its ({bone}).*--joints SET or FILE\.yaml"):
        answered_clip(make_keypoints("x", named("coco17"), p, 30.0), joints, "z", unit)
