"""Axis of a file that points up: that of its maker's document, of its config, or asked for."""

import numpy as np

from radhar_cli.motion.recorded.joint_sets import JOINT_SETS, find_joint_set
from radhar_cli.motion.recorded.keypoints import Keypoints
from radhar_cli.motion.recorded.names import JointNames
from radhar_cli.motion.recorded.plain_names import own_names
from radhar_cli.motion.recorded.recording import MotionRecording, motion_file_error
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Float

UPRIGHT = 0.8  # least cosine of the line from feet to head to an axis along which somebody stands
MAJORITY = 0.5  # least share of the frames in which somebody stands along another axis
AXES = ("z", "y", "-y", "x", "-x", "-z")

_HEAD, _ANKLES = JOINTS.index("head"), [JOINTS.index(f"{s}_ankle") for s in ("right", "left")]


def documented_up_axis(file: MotionRecording, joints: JointNames) -> str | None:
    """Axis that points up by a format, or by the joint set whose joints a file has, if they say it.

    Args:
        file: Recording.
        joints: Joints as a config says them; the key of a joint set is that of its maker.
    """
    if file.up or not isinstance(file, Keypoints):
        return file.up
    if isinstance(joints, str):
        return JOINT_SETS[joints].up
    joint_set, numbers = find_joint_set(own_names(file.names)) or (None, {})
    is_whole = joint_set is not None and len(numbers) == len(joint_set.names)
    return joint_set.up if joint_set and is_whole else None


def check_up_axis(documented: str | None, p: Float, where: str) -> str:
    """Axis that points up by a document, which the body does not contradict.

    Who lies straight looks as somebody who stands along another axis, so that the body alone tells
    no axis.

    Args:
        documented: The axis, such as "y" or "-y"; None where no document says it.
        p: Positions [frames, 15, 3] of the thirteen joints and the hip joints.
        where: Name of the file in messages.

    Raises:
        MotionFileError: No document says it; or nobody stands along it in any frame, but along
            another one in most.
    """
    body = p[:, _HEAD] - p[:, _ANKLES].mean(axis=1)
    body = body / np.maximum(np.linalg.norm(body, axis=1, keepdims=True), 1e-9)
    signs = {name: (-1 if name[0] == "-" else 1) for name in AXES}
    shares = {
        name: float((sign * body[:, "xyz".index(name[-1])] > UPRIGHT).mean())
        for name, sign in signs.items()
    }
    likely = max(shares, key=lambda name: shares[name])
    stands = f"the head is above the feet along {likely} in {shares[likely]:.0%} of the frames"
    if documented is None:
        if not shares[likely]:
            likely, stands = "y", "nobody stands in it"
        raise motion_file_error(
            where,
            f"does not say which axis points up ({stands}); up: {likely} of its class would say so "
            f"(--up {likely})",
        )
    if not shares[documented] and shares[likely] > MAJORITY:
        raise motion_file_error(
            where,
            f"has {documented} up by its kind, but {stands}: up: {likely} of its class says that "
            f"they stand (--up {likely}), up: {documented} that they lie (--up {documented})",
        )
    return documented
