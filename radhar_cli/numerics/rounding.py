"""Rounding of products of decimal numbers, free of binary surprises."""

from fractions import Fraction
from functools import lru_cache
from math import floor


def exact(value: float) -> Fraction:
    """Return the decimal number that a float was written as (0.1 is 1/10)."""
    return Fraction(repr(float(value)))


@lru_cache(maxsize=256)  # the same radar comes with every scene
def half_up(*factors: float) -> int:
    """Return floor(product + 1/2), the product taken of the decimals as written.

    0.145 * 100 is 14.5 and rounds to 15, although the product of the doubles lies below.
    """
    product = Fraction(1)
    for factor in factors:
        product *= exact(factor)
    return floor(product + Fraction(1, 2))
