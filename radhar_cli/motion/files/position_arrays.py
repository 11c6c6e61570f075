"""Arrays of positions in the shapes that people save: which axis is frames, joints, coordinates.

Coordinates are the axis of 3, of 4 with a confidence, or of 5 with MediaPipe's visibility and
presence. Joints are the axis of as many as there are names, or as a joint set has; frames the other
one. Of several people the only one who is there is taken.
"""

from collections.abc import Collection
from itertools import permutations
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.motion.files.joint_sets import JOINT_SETS
from radhar_cli.motion.files.recording import motion_file_error

SIZES = frozenset(len(joint_set.names) for joint_set in JOINT_SETS.values())
WIDTHS = (3, 4, 5)  # x, y, z; a confidence; visibility and presence
MAX_PEOPLE = 20
# What lies in a plane: its depth over its extent in the plane is smaller than that of any body.
FLAT = 0.01


def shape_positions(
    positions: NDArray[Any], names: Collection[str] | None, where: str
) -> NDArray[Any]:
    """Positions [frames, J, 3 or 4] of an array that has them in another usual shape.

    Args:
        positions: Numbers in any order of frames, joints and coordinates, with joints and
            coordinates in one axis or in two, and with axes of one or of people.
        names: Names of the J joints, or None.
        where: Name of the file in messages.

    Raises:
        MotionFileError: The array has two coordinates, or several people, or is no positions.
    """
    squeezed = _drop_single_axes(positions)
    if squeezed.ndim == 2:
        squeezed = _split_columns(squeezed, names)
    if squeezed.ndim == 4:
        squeezed = _choose_person(squeezed, names, where)
    if squeezed.ndim != 3:
        problem = f"positions should be [frames, J, 3] of one person, not {_describe(positions)}"
        raise motion_file_error(where, problem)
    ordered = _order_axes(squeezed, names)
    if ordered is None:
        if 2 in squeezed.shape:
            raise motion_file_error(where, two_dimensional("positions have two coordinates"))
        return squeezed
    if ordered.shape[2] == 5:
        ordered = np.concatenate([ordered[..., :3], ordered[..., 3:].min(2, keepdims=True)], 2)
    if ordered.shape[2] == 4 and not ordered[..., 3].any():
        ordered = ordered[..., :3]  # zeros throughout are no confidence
    return ordered


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


def _describe(array: NDArray[Any]) -> str:
    return f"{array.dtype} {list(array.shape)}"


def _drop_single_axes(positions: NDArray[Any]) -> NDArray[Any]:
    """Array without axes of one, of which the first of three or fewer may be a single frame."""
    if positions.ndim <= 3:
        return positions
    keep = [n for n in positions.shape if n != 1]
    return positions.reshape(keep) if len(keep) >= 2 else positions


def _split_columns(positions: NDArray[Any], names: Collection[str] | None) -> NDArray[Any]:
    """Array [frames, J, 3 or 4] of one whose columns, or rows, are the coordinates of joints."""
    for table in (positions, positions.T):
        for width in WIDTHS[:2]:
            count, over = divmod(table.shape[1], width)
            if over or not (count in SIZES if names is None else count == len(names)):
                continue
            split = table.reshape(len(table), count, width)
            is_doubtful = names is None and width == 3 and _may_be_confident(table)
            if not is_doubtful:
                return split
    if positions.shape[1] and positions.shape[1] % 3 == 0:
        return positions.reshape(len(positions), -1, 3)
    return positions


def _may_be_confident(table: NDArray[Any]) -> bool:
    """Whether every fourth column of a table is a confidence of a joint set's joints."""
    if table.shape[1] % 4 or table.shape[1] // 4 not in SIZES or table.dtype.kind not in "iuf":
        return False
    confidence, rest = table[:, 3::4], np.delete(table, np.s_[3::4], axis=1)
    is_share = bool((confidence >= 0).all() and (confidence <= 1).all())
    return is_share and not bool((rest >= 0).all() and (rest <= 1).all())


def _order_axes(positions: NDArray[Any], names: Collection[str] | None) -> NDArray[Any] | None:
    """Array as [frames, J, coordinates]; None where no order of its axes makes one."""
    orders = ((0, 1, 2), (1, 0, 2), (0, 2, 1), (1, 2, 0), (2, 0, 1), (2, 1, 0))
    as_positions = [order for order in orders if positions.shape[order[2]] in WIDTHS]
    # Confidences come last, and an axis of 5 alone may as well be one of joints or frames.
    as_positions = [o for o in as_positions if positions.shape[o[2]] == 3 or o[2] == 2]
    if names is not None:
        fitting = [order for order in as_positions if positions.shape[order[1]] == len(names)]
        as_positions = fitting
    else:
        known = [order for order in as_positions if positions.shape[order[1]] in SIZES]
        as_positions = known or as_positions
    return np.transpose(positions, as_positions[0]) if as_positions else None


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
