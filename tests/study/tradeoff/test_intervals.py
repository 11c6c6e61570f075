"""Intervals over a few seeds."""

from math import isnan

import numpy as np
import pytest

from radhar_cli.study.tradeoff.sweep import AccuracyNumbers, Interval


def test_interval_of_three_values():
    """t(2, 0.975) = 4.3027, standard deviation 1, n = 3."""
    half = 4.302652729911275 / 3**0.5
    assert Interval.of([1.0, 2.0, 3.0]) == pytest.approx((2, 2 - half, 2 + half))


def test_one_value_has_no_interval():
    middle, low, high = Interval.of([0.5])
    assert middle == 0.5
    assert isnan(low)
    assert isnan(high)


def test_it_holds_the_mean_as_often_as_it_says():
    draws = np.random.default_rng(4).normal(3.0, 2.0, (2000, 5))
    intervals = [Interval.of(row.tolist()) for row in draws]
    share = np.mean([each.low < 3.0 < each.high for each in intervals])
    assert 0.935 < share < 0.965


def test_what_a_seed_shares_is_no_chance():
    """A seed that is lucky is so with and without; those that only one has do not count."""
    default, other = (
        AccuracyNumbers(by_seed, 0, 0, 0) for by_seed in ((0.5, 0.7, 0.9), (0.4, 0.6, 0.8, 0.1))
    )
    assert default.loss_of(other) == pytest.approx((0.1, 0.1, 0.1))
