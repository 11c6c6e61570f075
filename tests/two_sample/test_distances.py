"""Distances of samples whose distance is known."""

import numpy as np
import pytest

from radhar_cli.two_sample.distances import difference, uncovered

RNG = np.random.default_rng(0)


def test_a_shift_of_a_standard_deviation_is_a_distance_of_one():
    x = RNG.normal(5, 2, 500)
    found = difference(x + 2, x)
    assert found.distance == pytest.approx(1, abs=0.08)
    assert found.p < 1e-6
    assert found.measured.mean == pytest.approx(5, abs=0.3)
    same = difference(x, x)
    assert (same.distance, same.ks) == (0, 0)


def test_missing_statistics_are_left_out():
    found = difference(np.array([1.0, np.nan, 3.0] * 4), np.array([1.0, 3.0]))
    assert (found.simulated.known, found.measured.known, found.distance) == (8, 2, 0)
    nothing = difference(np.array([np.nan]), np.array([1.0]))
    assert np.isnan(nothing.distance)
    few = difference(np.arange(40.0), np.where(np.arange(40) < 4, 100.0, np.nan))
    assert np.isnan([few.distance, few.ks, few.p]).all(), "4 of 40 do not tell"
    assert few.measured.known == 4


def test_constants():
    assert difference(np.ones(3), np.ones(4)).distance == 0
    assert difference(np.zeros(4), np.ones(4)).distance == pytest.approx(2)
    rounded = np.array([4.0, 4.0, np.nextafter(4.0, 5.0)])
    assert difference(rounded, np.full(3, 3.0)).distance == pytest.approx(2)


def test_coverage():
    x, y = RNG.normal(size=(200, 5)), RNG.normal(size=(200, 5))
    assert np.mean(uncovered(x, y) <= 1) > 0.93
    assert np.mean(uncovered(x[:50], y) <= 1) > 0.93
    assert np.mean(uncovered(x + 10, y) <= 1) == 0
    half = np.where(np.arange(200)[:, None] < 100, y, y + 50)
    assert np.mean(uncovered(x, half) <= 1) == pytest.approx(0.5, abs=0.05)
