"""Left and right that a network exchanges for some frames: found by the jump, and put right."""

import numpy as np

from radhar_cli.motion.recorded.names import WANTED
from radhar_cli.numerics.arrays import Bool, Float

NEARER = 0.5  # largest ratio of the ways to the other side's joint and to the own one
# Joints of each limb, the first of which tells: shoulders and hips are too far apart to change.
LIMBS = (("shoulder", "elbow", "hand"), ("hip_joint", "knee", "ankle"))


def undo_side_swaps(p: Float) -> tuple[Float, int]:
    """Positions whose limbs stay on their side.

    A limb is exchanged between two frames if both shoulders (hips) jump by the way between them to
    where the other one was. What most frames have is taken for right.

    Args:
        p: Positions [frames, 15, 3] of WANTED.

    Returns:
        Positions [frames, 15, 3], and the number of frames in which a limb was exchanged.
    """
    q, is_any = p, np.zeros(len(p), dtype=bool)
    for limb in LIMBS:
        right, left = ([WANTED.index(f"{side}_{part}") for part in limb] for side in _SIDES)
        is_swapped = _swapped_frames(p[:, right[0]], p[:, left[0]])
        if is_swapped.any():
            q = q.copy() if q is p else q
            rows = np.flatnonzero(is_swapped)[:, None]
            q[rows, right], q[rows, left] = p[rows, left], p[rows, right]
            is_any |= is_swapped
    return q, int(is_any.sum())


def describe_side_swaps(exchanged: int) -> tuple[str, ...]:
    """Describe the frames in which limbs were exchanged, by their number; () without any."""
    if not exchanged:
        return ()
    return (f"left and right are exchanged in {exchanged} frames, which are put right",)


_SIDES = ("right", "left")


def _swapped_frames(right: Float, left: Float) -> Bool:
    """Whether joints [frames, 3] are exchanged in each frame [frames]."""
    unchanged = np.linalg.norm(np.diff(right, axis=0), axis=1)
    unchanged += np.linalg.norm(np.diff(left, axis=0), axis=1)
    exchanged = np.linalg.norm(right[1:] - left[:-1], axis=1)
    exchanged += np.linalg.norm(left[1:] - right[:-1], axis=1)
    width = np.median(np.linalg.norm(right - left, axis=1))
    is_jump = (exchanged < NEARER * unchanged) & (unchanged > width) & (width > 0)
    state: Bool = np.concatenate([[0], np.cumsum(is_jump)]) % 2 == 1
    return ~state if state.mean() > 0.5 else state
