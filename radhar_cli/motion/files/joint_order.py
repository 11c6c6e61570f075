"""Joint sets of recordings without names: by their number, and by what makes a body."""

from dataclasses import replace
from itertools import chain

import numpy as np

from radhar_cli.errors import MotionFileError
from radhar_cli.motion.files.joint_frames import blend
from radhar_cli.motion.files.joint_sets import sets_of_size
from radhar_cli.motion.files.keypoints import Keypoints
from radhar_cli.motion.files.names import HIP_JOINTS, WANTED, JointMean, JointNames, joint_means
from radhar_cli.motion.files.position_arrays import refuse_images
from radhar_cli.motion.files.proportions import is_body
from radhar_cli.motion.files.recording import motion_file_error

SAMPLED = 2000  # frames at most that are looked at
BY_AXIS = "its columns are all x, then all y, then all z"


def arrange_joints(
    file: Keypoints, joints: JointNames | None
) -> tuple[Keypoints, JointNames | None]:
    """Arrange the joints of a recording as they make a body.

    Args:
        file: Recording, whose numbers are taken for x, y, z of each joint.
        joints: Joints as a config says them, or None.

    Returns:
        The recording, with what there is to say of it among its remarks: of its readings the
        first that makes a body, with x, y, z of each joint or, as MARS's labels have them, all x,
        then all y, then all z. Where none does, the first that has the joints of a config.
        The joints, or the key of the one set in whose order they make a body where a file has no
        names and a config says none.

    Raises:
        MotionFileError: No known set does, or more than one.
    """
    readings = (file, *file.others)
    orders = (order for reading in readings for order in (reading, _take_by_axis(reading)))
    if file.is_named or joints:
        said = joints or {}
        bodies = (order for order in orders if _plausible_body(order, said) is not None)
        having = (reading for reading in readings if _find_means(reading, said) is not None)
        chosen = next(chain(bodies, having), file)
    else:
        fitting = ((order, keys) for order in orders if (keys := _fitting_sets(order)))
        chosen, keys = next(fitting, (file, []))
        joints = _only_set(chosen, keys)
        count = len(chosen.names)
        remark = f"its {count} joints have no names: taken in the order of "
        remark += sets_of_size(count)[joints].title
        chosen = replace(chosen, remarks=(*chosen.remarks, remark))
    if chosen is not file:
        refuse_images(chosen.values, chosen.where)
    return chosen, joints


def _take_by_axis(file: Keypoints) -> Keypoints:
    """Recording whose numbers of a frame are taken for all x, then all y, then all z."""
    frames, count, _ = file.values.shape
    values = file.values.reshape(frames, 3, count).swapaxes(1, 2)
    return replace(file, values=values, remarks=(*file.remarks, BY_AXIS))


def _fitting_sets(file: Keypoints) -> list[str]:
    """Joint sets in whose order the joints of a recording make a body, each another one."""
    bodies: dict[str, list[JointMean | None]] = {}
    for key in sets_of_size(len(file.names)):
        body = _plausible_body(file, key)
        if body is not None and body not in bodies.values():
            bodies[key] = body
    return [*bodies]


def _only_set(file: Keypoints, keys: list[str]) -> str:
    """Key of the only set that fits.

    Raises:
        MotionFileError: None fits, or several do.
    """
    if len(keys) == 1:
        return keys[0]
    count, known = len(file.names), sets_of_size(len(file.names))
    if known:
        reason = "each makes a body" if keys else "in none of these orders do they make a body"
        possible = f"{', '.join(keys or known)} ({reason})"
    else:
        possible = "no set that is known has so many"
    raise motion_file_error(
        file.where,
        f"has {count} joints without names; {possible}: joints: SET of its class says in whose "
        "order they are, or {right_knee: NUMBER, ...} from 0 (--joints SET or FILE.yaml)",
    )


def _plausible_body(file: Keypoints, joints: JointNames) -> list[JointMean | None] | None:
    """What joints are taken for which, by a set's order or by name; None if they make no body."""
    means = _find_means(file, joints)
    if means is None:
        return None
    hip = means[WANTED.index("hip")]
    chosen = [mean for mean in (mean or hip for mean in means) if mean is not None]
    numbers = sorted({n for mean in chosen for n in mean.numbers})
    step = -(-len(file.values) // SAMPLED)
    try:
        sampled = file.positions(numbers)[::step]
    except MotionFileError:
        return None
    has_hip_joints = all(means[WANTED.index(joint)] for joint in HIP_JOINTS)
    with np.errstate(invalid="ignore"):
        return means if is_body(blend(sampled, numbers, chosen), has_hip_joints) else None


def _find_means(file: Keypoints, joints: JointNames) -> list[JointMean | None] | None:
    """What joints are taken for which, by a set's order or by name; None if one is not there."""
    try:
        return joint_means(file, joints)
    except MotionFileError:
        return None
