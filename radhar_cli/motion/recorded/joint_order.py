"""Joints of recordings without names: the only joint set of so many, or that of a config."""

from dataclasses import replace

from radhar_cli.motion.recorded.image_landmarks import refuse_images
from radhar_cli.motion.recorded.joint_sets import JOINT_SETS, sets_of_size
from radhar_cli.motion.recorded.keypoints import Keypoints
from radhar_cli.motion.recorded.names import JointMean, JointNames, joint_means
from radhar_cli.motion.recorded.recording import motion_file_error

BY_AXIS = "its columns are all x, then all y, then all z"


def arrange_joints(
    file: Keypoints, joints: JointNames | None
) -> tuple[Keypoints, JointNames | None]:
    """Find whose joints a recording has, and take columns in the order of that set's maker.

    Args:
        file: Recording, whose numbers are taken for x, y, z of each joint.
        joints: Joints as a config says them, or None.

    Returns:
        The recording, with what there is to say of it among its remarks.
        The joints, or the key of the only set of so many where a file has no names and a config
        says none.

    Raises:
        MotionFileError: No known set has so many joints, or several have.
    """
    remarks = file.remarks
    if not file.is_named and not joints:
        joints = _only_set(file)
        title = JOINT_SETS[joints].title
        remarks += (f"its {len(file.names)} joints have no names: taken in the order of {title}",)
    is_by_axis = isinstance(joints, str) and JOINT_SETS[joints].is_by_axis
    if is_by_axis and file.are_columns:
        frames, count, _ = file.values.shape
        values = file.values.reshape(frames, 3, count).swapaxes(1, 2)
        refuse_images(values, file.where)
        return replace(file, values=values, remarks=(BY_AXIS, *remarks)), joints
    return replace(file, remarks=remarks), joints


def _only_set(file: Keypoints) -> str:
    """Key of the only set, or of sets that are alike, that has as many joints as a recording.

    Raises:
        MotionFileError: None has, or several have.
    """
    count = len(file.names)
    keys = dict[str, list[JointMean | None]]()
    for key in sets_of_size(count):
        means = joint_means(file, key)
        if means not in keys.values():
            keys[key] = means
    if len(keys) == 1:
        return next(iter(keys))
    possible = "no set that is known has so many"
    if keys:
        titles = (f"{key} ({JOINT_SETS[key].title})" for key in keys)
        possible = f"sets of so many are {' and '.join(titles)}"
    raise motion_file_error(
        file.where,
        f"has {count} joints without names; {possible}: joints: SET of its class says in whose "
        "order they are, or {right_knee: NUMBER, ...} from 0 "
        f"(--joints {next(iter(keys), 'SET')}, or --joints FILE.yaml)",
    )
