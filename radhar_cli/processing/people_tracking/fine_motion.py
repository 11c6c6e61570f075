"""Slow movements: loops of several frames, seen as one frame."""

from math import ceil

import numpy as np

from radhar_cli.numerics.arrays import Complex
from radhar_cli.radar.people_tracking import FineMotion

_ROUNDING = 1e-9  # of a number of frames


def frames_together(fine: FineMotion, loops: int, period: float) -> int:
    """Number F of frames that are seen together: a divisor of the loops of a frame.

    Args:
        fine: Settings.
        loops: Number of loops of a frame.
        period: Time from frame to frame, s.
    """
    longest = max(ceil(fine.seconds / period - _ROUNDING), 1)
    return max(count for count in range(1, loops + 1) if loops % count == 0 and count <= longest)


def is_fine_frame(frame: int, fine: FineMotion, together: int) -> bool:
    """Whether a frame, counted from 0, is one of slow movements."""
    return frame >= together and frame % fine.cycle == 0


def join_frames(frames: Complex) -> Complex:
    """Make a frame of F frames: every F-th loop of each, as many loops as one has.

    Args:
        frames: Samples [F, loop, ...].
    """
    joined: Complex = np.concatenate(frames[:, :: len(frames)], axis=0)
    return joined
