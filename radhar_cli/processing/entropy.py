"""Entropy of a power map."""

import numpy as np

from radhar_cli.arrays import Float


class EntropySum:
    """Entropy of a map that comes in blocks: the sums of `entropy_bits` over what came so far."""

    def __init__(self) -> None:
        self._largest = self._total = self._dot = 0.0

    def add(self, power: Float) -> None:
        """Take in a block of any shape."""
        largest = float(power.max(initial=0.0))
        if largest == 0:
            return
        q = (power / largest).ravel(order="K")
        q = q if q.min() > 0 else q[q > 0]
        sums = float(q.sum()), float(np.dot(q, np.log2(q)))
        highest = max(largest, self._largest)
        own = _referred(*sums, largest / highest)
        before = _referred(self._total, self._dot, self._largest / highest)
        self._total, self._dot = own[0] + before[0], own[1] + before[1]
        self._largest = highest

    @property
    def bits(self) -> float:
        """H of all blocks together."""
        if self._total == 0:
            return 0.0
        return max(0.0, float(np.log2(self._total) - self._dot / self._total))


def _referred(total: float, dot: float, ratio: float) -> tuple[float, float]:
    """sum r q and sum r q log2(r q), from sum q and sum q log2 q."""
    if ratio == 0:
        return 0.0, 0.0
    return ratio * total, ratio * (dot + float(np.log2(ratio)) * total)


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
