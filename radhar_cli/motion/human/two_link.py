"""The joint between two links whose ends are known: knees and elbows."""

import numpy as np

from radhar_cli.numerics.arrays import Float

AHEAD = np.array([1.0, 0.0, 0.0])[:, None, None]  # direction in which knees bend


class OutOfReachError(ValueError):
    """A movement asks a limb to reach farther than it is long."""


def two_link(start: Float, end: Float, first: float, second: float, pole: Float) -> Float:
    """Joint [3, ...] (m) between two links whose ends are known.

    With d = |end - start|, e = (end - start)/d and a = (d^2 + first^2 - second^2)/(2 d) the joint
    is start + a e + sqrt(first^2 - a^2) n, n the unit vector along pole - (pole . e) e.

    Args:
        start: Beginning of the first link [3, ...], m.
        end: End of the second link [3, ...], m.
        first: Length of the first link, m.
        second: Length of the second link, m.
        pole: Direction to which the joint bends [3, ...]; never along e.

    Raises:
        OutOfReachError: The ends are farther apart than both links are long.
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
