"""Joints of recordings without names: those of the joint set that a config says."""

from dataclasses import replace

from radhar_cli.motion.recorded.image_landmarks import refuse_images
from radhar_cli.motion.recorded.joint_sets import JOINT_SETS, sets_of_size
from radhar_cli.motion.recorded.keypoints import Keypoints
from radhar_cli.motion.recorded.names import JointNames
from radhar_cli.motion.recorded.recording import motion_file_error

BY_AXIS = "its columns are all x, then all y, then all z"


def arrange_joints(file: Keypoints, joints: JointNames | None) -> Keypoints:
    """Take columns in the order of the maker of the set whose joints a config says they are.

    Args:
        file: Recording, whose numbers are taken for x, y, z of each joint.
        joints: Joints as a config says them, or None.

    Raises:
        MotionFileError: Joints have no names, and no config says whose they are.
    """
    if not file.is_named and not joints:
        keys = {key: joint_set.title for key, joint_set in sets_of_size(len(file.names)).items()}
        titles = " and ".join(f"{key} ({title})" for key, title in keys.items())
        possible = f"sets of so many are {titles}" if keys else "no set that is known has so many"
        raise motion_file_error(
            file.where,
            f"has {len(file.names)} joints without names; {possible}: joints: SET of its class "
            "says in whose order they are, or {right_knee: NUMBER, ...} from 0 "
            f"(--joints {next(iter(keys), 'SET')}, or --joints FILE.yaml)",
        )
    is_by_axis = isinstance(joints, str) and JOINT_SETS[joints].is_by_axis
    if is_by_axis and file.are_columns:
        frames, count, _ = file.values.shape
        values = file.values.reshape(frames, 3, count).swapaxes(1, 2)
        refuse_images(values, file.where)
        return replace(file, values=values, remarks=(BY_AXIS, *file.remarks))
    return file
