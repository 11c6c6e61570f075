"""Entropy of a power map."""

import numpy as np

from radhar_cli.arrays import Float


class EntropySum:
    """Entropy of a map that comes in blocks: the sums of `entropy_bits`, with q = power/2^e.

    A reference that is a power of two merges without rounding: q' = 2^d q, log2 q' = d + log2 q.
    """

    def __init__(self) -> None:
        self._exponent: int | None = None
        self._total = self._dot = 0.0

    def add(self, power: Float) -> None:
        """Take in a block of any shape."""
        largest = float(power.max(initial=0.0))
        if largest == 0:
            return
        exponent = int(np.frexp(largest)[1])
        q = np.ldexp(power, -exponent).ravel(order="K")
        q = q if q.min() > 0 else q[q > 0]
        total, dot = float(q.sum()), float(np.dot(q, np.log2(q)))
        highest = exponent if self._exponent is None else max(exponent, self._exponent)
        if self._exponent is not None:
            self._rescale(self._exponent - highest)
        part, down = np.ldexp(total, exponent - highest), exponent - highest
        self._dot += float(np.ldexp(dot, down) + down * part)
        self._total += float(part)
        self._exponent = highest

    def _rescale(self, up: int) -> None:
        self._total = float(np.ldexp(self._total, up))
        self._dot = float(np.ldexp(self._dot, up)) + up * self._total

    @property
    def bits(self) -> float:
        """H of all blocks together."""
        if self._total == 0:
            return 0.0
        return max(0.0, float(np.log2(self._total) - self._dot / self._total))


def entropy_bits(power: Float) -> float:
    """H = -sum p log2 p in bits, p = power/sum(power); 0 for an all-zero map.

    Written as log2(S) - sum(q log2 q)/S with q = power/max, S = sum q, which needs no second array
    of p and neither overflows nor loses denormal maps.
    """
    largest = float(power.max(initial=0.0))
    if largest == 0:
        return 0.0
    q = power / largest
    total = float(q.sum())
    q = q.ravel() if q.min() > 0 else q[q > 0]
    return max(0.0, float(np.log2(total) - np.dot(q, np.log2(q)) / total))
