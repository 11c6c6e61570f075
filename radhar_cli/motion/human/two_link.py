"""The joint between two links whose ends are known: knees and elbows."""

import numpy as np

from radhar_cli.arrays import Float

AHEAD = np.array([1.0, 0.0, 0.0])[:, None, None]  # to where knees bend


class OutOfReachError(ValueError):
    """A movement that no such body can make."""


def two_link(start: Float, end: Float, first: float, second: float, pole: Float) -> Float:
    """Joint [3, ...] between links of lengths `first` and `second` (m), from `start` to `end`.

    With d = |end - start|, e = (end - start)/d and a = (d^2 + first^2 - second^2)/(2 d) the joint
    is start + a e + sqrt(first^2 - a^2) n, n the unit vector along pole - (pole . e) e.

    Args:
        start, end: [3, ...], m.
        first, second: m.
        pole: direction to which the joint bends [3, ...]; never along e.

    Raises:
        OutOfReachError: the ends are farther apart than both links.
    """
    apart = end - start
    square = np.einsum("i...,i...->...", apart, apart)
    if square.max() > (first + second) ** 2:
        raise OutOfReachError(
            f"a limb of {first + second:.3f} m cannot reach {np.sqrt(square.max()):.3f} m"
        )
    along = 0.5 + (first**2 - second**2) / (2 * square)  # a/d
    across = pole - (np.einsum("i...,i...->...", pole, apart) / square) * apart
    length = np.einsum("i...,i...->...", across, across)
    aside = np.sqrt(np.maximum(first**2 - along * along * square, 0.0) / length)
    joint: Float = start + along * apart + aside * across
    return joint
