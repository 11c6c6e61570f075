"""Functions of -1 to 1 as sums of Chebyshev polynomials."""

from collections.abc import Callable
from typing import TypeVar

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float

Values = TypeVar("Values", Float, Complex)


def coefficients(function: Callable[[Float], Values], count: int) -> Values:
    """Coefficients c_p [P, ...] of function(x) = sum_p c_p T_p(x), -1 <= x <= 1.

    Args:
        function: Values [P, ...] at x [P].
        count: Number P of nodes and of coefficients.
    """
    import scipy.fft  # slow to import

    angle = np.pi * (np.arange(count) + 0.5) / count
    c: Values = scipy.fft.dct(function(np.cos(angle)), axis=0) / count
    c[0] /= 2
    return c
