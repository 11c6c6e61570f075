"""Rounding of products of decimal numbers, free of binary surprises."""

from fractions import Fraction
from functools import lru_cache
from math import floor

MAX_DIGITS = 17  # with which any two doubles differ


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


def show_beside(number: float, *others: float, digits: int = 6) -> str:
    """Write a number with so many digits, or as many more as it takes to differ from others.

    A number that is refused for a bound must not read like that bound: 0.001 beside
    0.0010000001 is "0.001", and 0.0010000001 beside 0.001 is "0.0010000001".

    Args:
        others: Numbers beside which it is read; equal ones do not count.
        digits: Significant digits that are enough where nothing is alike.
    """
    unequal = [other for other in others if other != number]
    for count in range(digits, MAX_DIGITS):
        text = f"{number:.{count}g}"
        if all(
            text != f"{other:.{count}g}" and (float(text) < other) == (number < other)
            for other in unequal
        ):
            return text
    return f"{number:.{MAX_DIGITS}g}"
