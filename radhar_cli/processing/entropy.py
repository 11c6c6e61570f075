"""Entropy of a power map."""

import numpy as np

from radhar_cli.arrays import Float


def entropy_bits(power: Float) -> float:
    """H = -sum p log2 p in bits, p = power/sum(power); 0 for an all-zero map.

    Written as log2(S) - sum(q log2 q)/S with q = power/max, S = sum q, which needs no second array
    of p and neither overflows nor loses denormal maps.

    Raises:
        ValueError: the map has an infinity or a NaN.
    """
    largest = float(power.max(initial=0.0))
    if largest == 0:
        return 0.0
    if not np.isfinite(largest):
        raise ValueError(f"the power map should be finite; its largest value is {largest}")
    q = power / largest
    total = float(q.sum())
    q = q.ravel() if q.min() > 0 else q[q > 0]
    return max(0.0, float(np.log2(total) - np.dot(q, np.log2(q)) / total))
