"""Poses of an image that look like poses in space: told by where and how large they are.

MediaPipe's image landmarks, and networks alike, have x and y of the picture, from 0 to 1 or in
pixels, and a depth about the hips in the same scale: a body of a height that may be anybody's.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.motion.recorded.recording import motion_file_error
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Float

IN_PICTURE = 0.98  # least share of joints that lie in the picture
BEYOND = 0.05  # of the picture, by which a joint may lie outside of it
MIN_JOINTS = 50  # in all frames, by which a file is judged
DEEP = 0.05  # most depth of hips that are the origin of depth alone, statures
OFF = 0.3  # least way of such hips to the corner of the picture, statures
# What lies in a plane: its depth over its extent in the plane is smaller than that of any body.
FLAT = 0.01
GROWS = 1.3  # least ratio of lengths of one body that people do not have

_HIP_JOINTS = [len(JOINTS), len(JOINTS) + 1]
_KNEES = [JOINTS.index(f"{s}_knee") for s in ("right", "left")]
_ANKLES = [JOINTS.index(f"{s}_ankle") for s in ("right", "left")]
_SHOULDERS = [JOINTS.index(f"{s}_shoulder") for s in ("right", "left")]
ADVICE = (
    "a radar needs positions in space: write world landmarks (pose_world_landmarks, in m) of the "
    "same frames; if these are metres, unit_m of its class says so (--unit 1)"
)


def two_dimensional(finding: str) -> str:
    """Words for poses in the plane of an image."""
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


def share_in_picture(values: NDArray[Any]) -> float:
    """Share of the joints [frames, J, 3 or more] that are known whose x and y are from 0 to 1."""
    plane = values[np.isfinite(values).all(axis=2)][:, :2]
    is_inside = ((plane > -BEYOND) & (plane < 1 + BEYOND)).all(axis=1)
    return float(is_inside.mean()) if len(plane) else 0.0


def refuse_landmarks(values: NDArray[Any], where: str) -> None:
    """Refuse positions whose x and y all lie from 0 to 1: landmarks of an image.

    Args:
        values: Positions [frames, J, 3 or more] as a file has them; zeros and NaN are lost.
        where: Name of the file in messages.

    Raises:
        MotionFileError: They do, are not all near the origin, and extend less in depth.
    """
    is_known = np.isfinite(values).all(axis=2) & (values != 0).any(axis=2)
    plane = values[is_known][:, :2]
    if len(plane) < MIN_JOINTS or not (is_known.sum(axis=1) > 2).any():
        return
    is_spread = bool((np.ptp(plane, axis=0) > BEYOND).all())
    is_in_middle = bool((np.median(plane, axis=0) > BEYOND).all())
    frames = np.where(is_known[..., None], values, np.nan)[is_known.sum(axis=1) > 2][..., :3]
    extents = np.median(np.nanmax(frames, axis=1) - np.nanmin(frames, axis=1), axis=0)
    is_upright = bool(extents[:2].max() > extents[2])
    is_inside = share_in_picture(values[is_known][None]) >= IN_PICTURE
    if is_inside and is_in_middle and is_spread and is_upright:
        raise motion_file_error(
            where, f"has x and y from 0 to 1, as landmarks of an image have; {ADVICE}"
        )


def refuse_landmarks_in_depth(p: Float, units: float, where: str) -> None:
    """Refuse positions, y down, whose depth is about the hips while x and y are of a picture.

    Args:
        p: Positions [frames, 15, 3] in axes of the file.
        units: Stature in their unit.
        where: Name of the file in messages.

    Raises:
        MotionFileError: The hips have no depth in any frame, but are not the origin, and x and y
            are beside and below a corner.
    """
    hips = p[:, _HIP_JOINTS].mean(axis=1) / units
    is_off = np.linalg.norm(hips[:, :2], axis=1) > OFF
    is_in_picture = (hips[:, :2] > 0).all(axis=1).mean() >= IN_PICTURE
    has_no_depth = np.percentile(np.abs(hips[:, 2]), 95) < DEEP
    if has_no_depth and is_in_picture and is_off.mean() >= IN_PICTURE:
        raise motion_file_error(
            where,
            "has hips without depth at other places than the origin, as pixels and landmarks of "
            f"an image have; {ADVICE}",
        )


def describe_growth(p: Float) -> tuple[str, ...]:
    """Describe bones that grow or shrink, as in pixels of a person who comes nearer.

    Args:
        p: Positions [frames, 15, 3] in any unit.
    """
    ends = ((_HIP_JOINTS, _KNEES), (_KNEES, _ANKLES), (_SHOULDERS, _HIP_JOINTS))
    lengths = [np.linalg.norm(p[:, a] - p[:, b], axis=2).sum(axis=1) for a, b in ends]
    low, high = np.percentile(np.sum(lengths, axis=0), [5, 95])
    if not high > GROWS * low > 0:
        return ()
    return (
        f"the same bones are up to {high / low:.2g} times as long as in other frames: are these "
        "pixels, or poses of another scale in each frame? A radar needs one unit throughout",
    )
