"""Upsampling of slow quantities to the pulses by local Lagrange polynomials.

Local, so that a kink spoils the segment it lies in and no other: next to a kink the stencil is
shifted to knots on its own side.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from radhar_cli.arrays import Float, Index

TAPS = 6
REACH = TAPS // 2 - 1
# Knots around the first and the last segment, so that a stencil may be shifted there too.
BEFORE = 2 * REACH
AFTER = 2 * REACH + 1
EXACT = TAPS  # not a shift: the segment cannot be interpolated


def lagrange_basis(nodes: Float, at: Float) -> Float:
    """Weights [nodes, at] of values at the nodes for the polynomial through them at some places."""
    basis = np.ones((nodes.size, at.size))
    for i, node in enumerate(nodes):
        for other in np.delete(nodes, i):
            basis[i] *= (at - other) / (node - other)
    return basis


@lru_cache(maxsize=128)
def lagrange_weights(step: int, shift: int = 0) -> Float:
    """Weights [TAPS, step] of the knots around a segment for each of its `step` pulses.

    The knots are -2 .. 3 from the segment's first, plus `shift` (-2 .. 2).
    """
    nodes = np.arange(-REACH, TAPS - REACH, dtype=float) + shift
    return lagrange_basis(nodes, np.arange(step) / step)


def shifts(times: Float, kinks: tuple[float, ...]) -> Index:
    """Shift of the stencil of each segment, or EXACT where it holds a kink.

    Args:
        times: of the knots [BEFORE + segments + AFTER], s.
        kinks: instants at which what is interpolated is not smooth, s, in order; each belongs to
            what follows it.

    Returns:
        [segments].
    """
    segment = np.arange(BEFORE, times.size - AFTER)
    if not kinks:
        return np.zeros(segment.size, dtype=np.intp)
    piece = np.searchsorted(kinks, times, side="right")
    first = np.searchsorted(piece, piece, side="left")[segment]
    last = np.searchsorted(piece, piece, side="right")[segment] - 1
    shift = np.maximum(first - (segment - REACH), 0) + np.minimum(last - (segment + REACH + 1), 0)
    spoilt = (piece[segment] != piece[segment + 1]) | (last - first < TAPS)
    return np.where(spoilt, EXACT, shift)


def upsample(
    knots: Float, step: int, shift: Index, dtype: type[np.floating] = np.float64
) -> NDArray[np.floating]:
    """Interpolate knots [..., BEFORE + segments + AFTER] to pulses [..., segments * step].

    A component of frequency f errs by at most 5/1024 (2 pi f h)^6 of itself, h the knot interval;
    by 1.4 and 4.2 times that where the stencil is shifted by 1 and 2. Segments marked EXACT are
    left without a meaning.
    """
    usual = np.lib.stride_tricks.sliding_window_view(
        knots[..., BEFORE - REACH : knots.shape[-1] - REACH], TAPS, axis=-1
    )
    taps = np.ascontiguousarray(usual, dtype=dtype).reshape(-1, TAPS)
    dense = (taps @ lagrange_weights(step).astype(dtype)).reshape(*usual.shape[:-1], step)
    for some in np.unique(shift[(shift != 0) & (shift != EXACT)]).tolist():
        here = np.flatnonzero(shift == some)
        place = here[:, None] + (BEFORE - REACH + some) + np.arange(TAPS)
        dense[..., here, :] = knots[..., place] @ lagrange_weights(step, some)
    return dense.reshape(*knots.shape[:-1], -1)


def after_first(knots: Float, step: int) -> Float:
    """Interpolate knots [..., BEFORE + segments + AFTER] to the second pulse of each segment.

    Stencils are not shifted: next to a kink the value is a rough one.
    """
    count = knots.shape[-1] - BEFORE - AFTER
    first = BEFORE - REACH
    total = np.zeros((*knots.shape[:-1], count), dtype=knots.dtype)
    for tap, weight in enumerate(lagrange_weights(step)[:, 1]):
        total += weight * knots[..., first + tap : first + tap + count]
    return total
