"""Distances of samples whose distance is known."""

import numpy as np
import pytest

from radhar_cli.study.two_sample.comparison import difference

RNG = np.random.default_rng(0)


def test_a_shift_of_a_standard_deviation_is_a_distance_of_one():
    x = RNG.normal(5, 2, 500)
    found = difference(x + 2, x)
    assert found.distance == pytest.approx(1, abs=0.08)
    assert found.p < 1e-6
    assert found.measured.mean == pytest.approx(5, abs=0.3)
    same = difference(x, x)
    assert (same.distance, same.p) == (0, 1)


def test_missing_statistics_are_left_out():
    found = difference(np.array([1.0, np.nan, 3.0] * 4), np.array([1.0, 3.0]))
    assert (found.simulated.known, found.measured.known, found.distance) == (8, 2, 0)
    nothing = difference(np.array([np.nan]), np.array([1.0]))
    assert np.isnan(nothing.distance)
    few = difference(np.arange(40.0), np.where(np.arange(40) < 4, 100.0, np.nan))
    assert np.isnan([few.distance, few.p]).all(), "4 of 40 do not tell"
    assert few.measured.known == 4


def test_constants():
    assert difference(np.ones(3), np.ones(4)).distance == 0
    assert difference(np.zeros(4), np.ones(4)).distance == pytest.approx(2)
    rounded = np.array([4.0, 4.0, np.nextafter(4.0, 5.0)])
    assert difference(rounded, np.full(3, 3.0)).distance == pytest.approx(2)
