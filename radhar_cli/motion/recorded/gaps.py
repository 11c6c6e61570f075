"""Gaps of joints that a camera lost: short ones are bridged by monotone cubics, long ones stay.

Frames at uneven instants are brought to an even rate by the same curves (PCHIP: Fritsch & Carlson,
SIAM J. Numer. Anal. 17 (1980) 238), which do not overshoot as splines would across a gap.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from radhar_cli.numerics.arrays import Bool, Float

BRIDGED_S = 0.5  # longest gap that is bridged
UNEVEN = 0.02  # share of a frame by which an instant may be off an even rate


class Bridged(NamedTuple):
    """Positions of joints at an even rate, and the gaps of each."""

    positions: Float  # [frames, joints, 3]; NaN in gaps that are too long, and before and after
    missing: NDArray[np.int64]  # frames that are bridged, of each joint [joints]
    gaps: NDArray[np.int64]  # gaps that are bridged, of each joint [joints]


def bridge_gaps(p: Float, t: Float, rate: float) -> Bridged:
    """Bring positions to an even rate, and bridge gaps of up to BRIDGED_S.

    Args:
        p: Positions [frames, joints, 3]; a joint of which a number is no finite one is lost there.
        t: Instants of the frames [frames], s, rising from 0.
        rate: Frames per second of the result.
    """
    count = round(float(t[-1]) * rate) + 1
    grid = np.arange(count) / rate
    is_even = count == len(t) and bool(np.abs(t - grid).max() * rate < UNEVEN)
    joints = p.shape[1]
    bridged = np.full((count, joints, 3), np.nan)
    missing, gaps = np.zeros(joints, dtype=np.int64), np.zeros(joints, dtype=np.int64)
    for joint in range(joints):
        known: Bool = np.asarray(np.isfinite(p[:, joint]).all(axis=1))
        if is_even and known.all():
            bridged[:, joint] = p[:, joint]
        elif known.sum() > 1:
            reachable, between, runs = _reach(t, known, grid, rate)
            bridged[reachable, joint] = _curve(t[known], p[known, joint], grid[reachable])
            missing[joint], gaps[joint] = between, runs
            if is_even:
                bridged[known, joint] = p[known, joint]
    return Bridged(bridged, missing, gaps)


def _reach(t: Float, known: Bool, grid: Float, rate: float) -> tuple[Bool, int, int]:
    """Instants of a grid [N] that lie between known frames that are near enough.

    Returns:
        Whether each instant is reachable [N]; number of lost frames that are bridged, and of gaps.
    """
    instants = t[known]
    spacing = np.diff(instants)
    is_short = spacing <= BRIDGED_S + 1.5 / rate  # what is lost lies between, less a frame
    right = np.clip(np.searchsorted(instants, grid, side="left"), 1, len(instants) - 1)
    margin = UNEVEN / rate
    reachable = is_short[right - 1] & (grid > instants[0] - margin) & (grid < instants[-1] + margin)
    reachable |= np.abs(grid - instants[right]) < margin
    reachable |= np.abs(grid - instants[right - 1]) < margin
    lost = np.rint(spacing * rate).astype(int) - 1  # also frames that are not in the file at all
    is_bridged = is_short & (lost > 0)
    return reachable, int(lost[is_bridged].sum()), int(is_bridged.sum())


def _curve(t: Float, p: Float, grid: Float) -> Float:
    """Monotone cubics through positions p [frames, 3] at t, at the instants of a grid [N]."""
    from scipy.interpolate import PchipInterpolator

    curve: Float = PchipInterpolator(t, p, axis=0)(np.clip(grid, t[0], t[-1]))
    return curve


def true_runs(mask: Bool) -> list[tuple[int, int]]:
    """Runs [first, last] of true values in a mask."""
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(int)))
    return [(int(a), int(b) - 1) for a, b in zip(edges[::2], edges[1::2], strict=True)]
