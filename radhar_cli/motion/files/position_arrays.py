"""Arrays of positions in the shapes that people save: which axis is frames, joints, coordinates.

Coordinates are the axis of 3, of 4 with a confidence, or of 5 with MediaPipe's visibility and
presence. Joints are the axis of as many as there are names. Without names an array can often be
read in several ways, of which the one is right that makes a body. Of several people the only one
who is there is taken.
"""

from collections.abc import Collection
from itertools import permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.motion.files.joint_sets import JOINT_SETS
from radhar_cli.motion.files.recording import MAX_FRAMES, MAX_JOINTS, motion_file_error

SIZES = frozenset(len(joint_set.names) for joint_set in JOINT_SETS.values())
WIDTHS = (3, 4, 5)  # x, y, z; a confidence; visibility and presence
MAX_PEOPLE = 20
# What lies in a plane: its depth over its extent in the plane is smaller than that of any body.
FLAT = 0.01


def find_readings(
    positions: NDArray[Any], names: Collection[str] | None, where: str
) -> list[NDArray[Any]]:
    """Positions [frames, J, 3 or 4] in all ways in which an array of a usual shape can be read.

    Args:
        positions: Numbers in any order of frames, joints and coordinates, with joints and
            coordinates in one axis or in two, and with axes of one or of people.
        names: Names of the J joints, or None.
        where: Name of the file in messages.

    Returns:
        At least one reading. Frames are the first axis of the first one, but those with fewer
        frames than joints come last; what is no positions is returned as it is.

    Raises:
        MotionFileError: The array has two coordinates, or several people, or is no positions.
    """
    squeezed = _drop_single_axes(positions)
    if squeezed.ndim == 4:
        squeezed = _choose_person(squeezed, names, where)
    if squeezed.ndim not in (2, 3):
        raise motion_file_error(where, _no_positions(positions))
    readings = (
        _split_columns(squeezed, names) if squeezed.ndim == 2 else _order_axes(squeezed, names)
    )
    if not readings:
        if squeezed.ndim == 2:
            raise motion_file_error(where, _no_positions(positions))
        if 2 in squeezed.shape:
            raise motion_file_error(where, two_dimensional("positions have two coordinates"))
        return [squeezed]
    readings.sort(key=lambda reading: len(reading) < reading.shape[1])
    return [_merge_confidences(reading) for reading in readings]


def two_dimensional(finding: str) -> str:
    """What to say of poses in the plane of an image."""
    return (
        f"{finding}: pixels of an image; a radar needs 3-D positions in m, cm or mm, as "
        "MediaPipe's world landmarks, a depth camera, several cameras or a lifting network give"
    )


def refuse_images(positions: NDArray[Any], where: str) -> None:
    """Refuse positions [frames, J, 3] that lie in a plane: x, y and a confidence, or zeros.

    Raises:
        MotionFileError: One coordinate spans a hundredth of what the others do, in all frames.
    """
    known = np.where((positions == 0).all(axis=2, keepdims=True), np.nan, positions.astype(float))
    known = known[np.isfinite(known).all(axis=2).sum(axis=1) > 2]
    if not len(known) or positions.shape[1] < 5:
        return
    spans = np.sort(np.nanmedian(np.nanmax(known, axis=1) - np.nanmin(known, axis=1), axis=0))
    if spans[0] < FLAT * spans[2]:
        raise motion_file_error(
            where, two_dimensional("positions lie in a plane, as x, y and a confidence do")
        )


def _no_positions(array: NDArray[Any]) -> str:
    shape = f"{array.dtype} {list(array.shape)}"
    return f"positions should be [frames, J, 3] of one person, not {shape}"


def _merge_confidences(positions: NDArray[Any]) -> NDArray[Any]:
    """Positions [frames, J, 3 or 4] of [frames, J, 3, 4 or 5]: the least of two confidences."""
    if positions.shape[2] == 5:
        least = positions[..., 3:].min(2, keepdims=True)
        positions = np.concatenate([positions[..., :3], least], 2)
    if positions.shape[2] == 4 and not positions[..., 3].any():
        positions = positions[..., :3]  # zeros throughout are no confidence
    return positions


def _drop_single_axes(positions: NDArray[Any]) -> NDArray[Any]:
    """Array without axes of one, of which the first of three or fewer may be a single frame."""
    if positions.ndim <= 3:
        return positions
    keep = [n for n in positions.shape if n != 1]
    return positions.reshape(keep) if len(keep) >= 2 else positions


def _split_columns(table: NDArray[Any], names: Collection[str] | None) -> list[NDArray[Any]]:
    """Arrays [frames, J, 3 or 4] of a table whose columns, or rows, are coordinates of joints."""
    readings = []
    for rows in (table, table.T):
        for width in WIDTHS[:2]:
            count, over = divmod(rows.shape[1], width)
            is_of_names = names is None or count == len(names)
            if not over and is_of_names and 0 < count <= MAX_JOINTS and len(rows) <= MAX_FRAMES:
                readings.append(rows.reshape(len(rows), count, width))
    if not readings and table.shape[1] and table.shape[1] % 3 == 0:
        return [table.reshape(len(table), -1, 3)]
    return readings


def _order_axes(positions: NDArray[Any], names: Collection[str] | None) -> list[NDArray[Any]]:
    """Array as [frames, J, coordinates] in all orders of its axes that can be."""
    orders = ((0, 1, 2), (1, 0, 2), (0, 2, 1), (1, 2, 0), (2, 0, 1), (2, 1, 0))
    as_positions = [order for order in orders if positions.shape[order[2]] in WIDTHS]
    # Confidences come last, and an axis of 5 alone may as well be one of joints or frames.
    as_positions = [o for o in as_positions if positions.shape[o[2]] == 3 or o[2] == 2]
    if names is not None:
        as_positions = [o for o in as_positions if positions.shape[o[1]] == len(names)]
    return [np.transpose(positions, order) for order in as_positions]


def _choose_person(
    positions: NDArray[Any], names: Collection[str] | None, where: str
) -> NDArray[Any]:
    """Array of three axes of the only person who is there in one of four axes.

    Raises:
        MotionFileError: Several people are there, or none.
    """
    sizes = SIZES if names is None else {len(names)}
    for frames, people, joints, xyz in permutations(range(4)):
        shape = [positions.shape[axis] for axis in (frames, people, joints, xyz)]
        is_fitting = shape[3] in WIDTHS and shape[2] in sizes and shape[1] <= MAX_PEOPLE
        if not is_fitting or shape[1] > shape[0] or (shape[3] != 3 and xyz != 3):
            continue
        ordered = np.transpose(positions, (people, frames, joints, xyz))
        present = [n for n, body in enumerate(ordered) if _is_there(body[..., :3])]
        if len(present) == 1:
            person: NDArray[Any] = ordered[present[0]]
            return person
        index = ", ".join(
            str(present[0] if present else 0) if n == people else ":" for n in range(4)
        )
        raise motion_file_error(
            where,
            f"has {len(present)} people; should be one: np.savez(OUT, positions=p[{index}], ...) "
            "writes the first, p its array",
        )
    return positions


def _is_there(person: NDArray[Any]) -> bool:
    """Whether a person is in any frame: somewhere else than at the origin."""
    if person.dtype.kind not in "iuf":
        return True
    return bool((np.isfinite(person).all(axis=2) & (person != 0).any(axis=2)).any())
