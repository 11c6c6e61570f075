"""Entropy of a power map, in bits."""

from math import log

import numpy as np

from radhar_cli.errors import RadharError
from radhar_cli.numerics.arrays import Float


class EntropySum:
    """Entropy H = log2(S) - sum(P log2 P)/S, S = sum P, of a power map P that comes in blocks.

    P may have any scale at which it and its sums are normal numbers; a map of zeros has entropy 0.
    """

    def __init__(self) -> None:
        self.total = self._dot = 0.0

    def add(self, power: Float) -> None:
        """Add a block of any shape; contiguous ones are not copied."""
        p = power.ravel(order="K")
        self.total += float(p.sum())
        nats = np.maximum(p, np.finfo(p.dtype).tiny)
        np.log(nats, out=nats)  # of the logarithms the one that NumPy has vectorised everywhere
        nats *= p
        self._dot += float(nats.sum()) / log(2)

    @property
    def bits(self) -> float:
        """Entropy H of all blocks together, bits."""
        if self.total == 0:
            return 0.0
        return max(0.0, float(np.log2(self.total)) - self._dot / self.total)


def entropy_bits(power: Float) -> float:
    """Entropy H = -sum p log2 p (bits) of a power map, p = power/sum(power); 0 for a map of zeros.

    Raises:
        RadharError: The map has an infinity or a NaN.
    """
    entropy, largest = EntropySum(), largest_power(power)
    if largest > 0:
        entropy.add(power / largest)
    return entropy.bits


def largest_power(power: Float) -> float:
    """Largest power of a map, 0 for an empty one.

    Raises:
        RadharError: The map has an infinity or a NaN.
    """
    largest = float(power.max(initial=0.0))
    if not np.isfinite(largest):
        raise RadharError(f"the power map should be finite; its largest value is {largest}")
    return largest
