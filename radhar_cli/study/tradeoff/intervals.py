"""Mean of a few seeds and how far chance may have moved it: intervals by Student's t."""

from collections.abc import Sequence
from math import nan, sqrt
from statistics import mean, stdev
from typing import NamedTuple


class Interval(NamedTuple):
    """Mean with the ends of its interval of 95 %, which are NaN where a single value gives none."""

    mean: float
    low: float
    high: float


def mean_interval(values: Sequence[float]) -> Interval:
    """Interval of the mean of values that are independent and normal.

    Raises:
        ValueError: there is no value.
    """
    if not values:
        raise ValueError("there should be a value or more")
    middle, count = mean(values), len(values)
    if count == 1:
        return Interval(middle, nan, nan)
    from scipy.special import stdtrit

    half = float(stdtrit(count - 1, 0.975)) * stdev(values) / sqrt(count)
    return Interval(middle, middle - half, middle + half)


def paired_difference(values: Sequence[float], baseline: Sequence[float]) -> Interval:
    """Interval of the mean of value - baseline over the seeds that both have, the first ones.

    What a seed draws, scenes and first weights, is the same in both and is not counted as chance.

    Raises:
        ValueError: one of them is empty.
    """
    return mean_interval([value - base for value, base in zip(values, baseline, strict=False)])
