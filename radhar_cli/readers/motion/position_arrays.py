"""Arrays of positions: [frames, J, 3] of one person, or a table with columns x, y, z of each joint.

A fourth number of a joint is its confidence, a fifth MediaPipe's presence; axes of one are dropped.
An array in another order is refused with the line of NumPy that turns it.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.motion.recorded.image_landmarks import two_dimensional
from radhar_cli.motion.recorded.recording import MAX_JOINTS, motion_file_error

WIDTHS = (3, 4, 5)  # x, y, z; a confidence; visibility and presence


def arrange_positions(array: NDArray[Any], names: Sequence[str] | None, where: str) -> NDArray[Any]:
    """Arrange an array of positions as [frames, J, 3 or 4].

    Args:
        array: Numbers [frames, J, 3], or columns [frames, 3 J]; with confidences 4 for 3.
        names: Names of the J joints, or None.
        where: Name of the file in messages.

    Raises:
        MotionFileError: The axes are others; a line of NumPy says how to turn them.
    """
    shape = [size for size in array.shape if size != 1] if array.ndim > 3 else [*array.shape]
    positions = array.reshape(shape)
    if positions.ndim == 2:
        count, over = divmod(shape[1], 3)
        width = 4 if names is not None and shape[1] == 4 * len(names) else 3
        if (over and width == 3) or not 0 < count <= 2 * MAX_JOINTS:
            raise motion_file_error(where, _describe_other_axes(array, names))
        return positions.reshape(len(positions), shape[1] // width, width)
    is_of_names = positions.ndim == 3 and (names is None or shape[1] == len(names))
    if not is_of_names or shape[2] not in WIDTHS:
        if 2 in shape and 3 not in shape:
            raise motion_file_error(where, two_dimensional("positions have two coordinates"))
        raise motion_file_error(where, _describe_other_axes(array, names))
    if shape[2] == 5:
        least = positions[..., 3:].min(2, keepdims=True)
        positions = np.concatenate([positions[..., :3], least], 2)
    if positions.shape[2] == 4 and not positions[..., 3].any():
        positions = positions[..., :3]  # zeros throughout are no confidence
    return positions


def _describe_other_axes(array: NDArray[Any], names: Sequence[str] | None) -> str:
    """Describe the axes that are read, and the line of NumPy that turns others to them."""
    joints = "J" if names is None else str(len(names))
    shape, turned = [*array.shape], ""
    if array.ndim == 2 and shape[0] % 3 == 0:
        turned = "p.T"
    elif array.ndim == 3 and shape.count(3) == 1 and shape[2] != 3:
        xyz = shape.index(3)
        first, second = (axis for axis in range(3) if axis != xyz)
        is_joint_first = names is not None and shape[first] == len(names)
        order = (second, first, xyz) if is_joint_first else (first, second, xyz)
        turned = f"p.transpose{order}"
    elif array.ndim == 3 and names is not None and shape[0] == len(names):
        turned = "p.transpose(1, 0, 2)"
    elif array.ndim == 4:
        turned = "p[0]" if shape[0] < shape[-1] or shape[-1] == 3 else "p[..., 0]"
    problem = f"positions should be [frames, {joints}, 3] of one person, not {array.dtype} {shape}"
    if not turned:
        return problem
    return f"{problem}; with p the array, np.savez('clip.npz', ..., positions={turned}) writes them"
