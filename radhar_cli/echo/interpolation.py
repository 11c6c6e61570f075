"""Upsampling of slow quantities to the pulses by local Lagrange polynomials.

Local, so that a kink spoils the pulses around it and no others; those are then computed exactly.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray

from radhar_cli.arrays import Float

TAPS = 6
BEFORE = TAPS // 2 - 1
AFTER = TAPS // 2


@lru_cache(maxsize=32)
def lagrange_weights(step: int) -> Float:
    """Weights [TAPS, step] of the knots around a segment for each of its `step` pulses."""
    nodes = np.arange(-BEFORE, AFTER + 1, dtype=float)
    at = np.arange(step) / step
    columns = np.ones((TAPS, step))
    for i, node in enumerate(nodes):
        for other in np.delete(nodes, i):
            columns[i] *= (at - other) / (node - other)
    return columns


def upsample(
    knots: Float, step: int, dtype: type[np.floating] = np.float64
) -> NDArray[np.floating]:
    """Interpolate knots [..., segments + TAPS - 1] to pulses [..., segments * step].

    Segment s runs from knot s + BEFORE to the next. The error of a component of frequency f is at
    most about 0.005 (2 pi f h)^6 of it, h the knot interval.
    """
    windows = np.lib.stride_tricks.sliding_window_view(knots, TAPS, axis=-1)
    taps = np.ascontiguousarray(windows, dtype=dtype)
    dense = taps @ lagrange_weights(step).astype(dtype)
    return dense.reshape(*knots.shape[:-1], -1)
