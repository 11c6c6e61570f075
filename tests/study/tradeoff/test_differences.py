"""Differences of signals, pictures and points."""

from math import inf

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.processing.points import COLUMNS, Cloud
from radhar_cli.study.tradeoff.differences import (
    MapDifference,
    PointDifference,
    compare_pictures,
    compare_points,
    relative_db,
)
from radhar_cli.study.tradeoff.samples import ShownMap


def rng():
    """The same numbers for every test, whatever ran before it."""
    return np.random.default_rng(3)


def picture(levels, *limits):
    """ShownMap whose axes go from edge to edge, as extents do."""
    levels = np.asarray(levels, np.uint8)
    limits = limits or [(0, side) for side in levels.shape]
    axes = tuple(
        low + (np.arange(side) + 0.5) * (high - low) / side
        for side, (low, high) in zip(levels.shape, limits, strict=True)
    )
    return ShownMap(levels, axes)


class TestSignals:
    @given(st.floats(-150, 20))
    def test_error_is_relative_to_the_right_one(self, db):
        real, imaginary, error = rng().standard_normal((3, 200))
        right, error = real + 1j * imaginary, 1j * error
        error *= 10 ** (db / 20) * np.linalg.norm(right) / np.linalg.norm(error)
        assert relative_db(right + error, right) == pytest.approx(db, abs=0.01)

    def test_the_same_and_nothing(self):
        right = np.ones(4, dtype=complex)
        assert relative_db(right, right) == -inf
        assert relative_db(np.zeros(4, complex), np.zeros(4, complex)) is None

    def test_only_what_is_shown_counts(self):
        right = np.ones(4, dtype=complex)
        wrong = right + np.array([0, 0, 0, 5])
        assert relative_db(wrong, right, np.array([True, True, True, False])) == -inf


class TestPictures:
    levels = rng().integers(0, 256, (32, 40)).astype(np.uint8)

    def test_the_same(self):
        same = compare_pictures(picture(self.levels), picture(self.levels))
        assert same == MapDifference(0, 0, pytest.approx(1), 0)

    def test_one_level_everywhere(self):
        other = np.where(self.levels < 255, self.levels + 1, 254).astype(np.uint8)
        difference = compare_pictures(picture(other), picture(self.levels))
        assert (difference.changed, difference.over_one, difference.rms_levels) == (1, 0, 1)
        assert 0.99 < difference.ssim < 1

    def test_noise_is_nothing_like_it(self):
        other = np.random.default_rng(8).integers(0, 256, self.levels.shape)
        assert abs(compare_pictures(picture(other), picture(self.levels)).ssim) < 0.1

    @pytest.mark.parametrize(
        ("size", "ssim"), [((7, 9), 1.0), ((6, 6), 1.0), ((3, 100), 1.0), ((2, 9), None)]
    )
    def test_small_pictures(self, size, ssim):
        small = picture(rng().integers(0, 256, size))
        assert compare_pictures(small, small).ssim == pytest.approx(ssim)

    def test_a_ramp_of_half_the_pixels_is_the_same_ramp(self):
        """Pictures of another size are compared at the same places, linear in between."""
        ramp = np.arange(64)[:, None] + np.zeros(64)
        half = ramp.reshape(32, 2, 32, 2).mean(axis=(1, 3))
        whole = picture(ramp, (0, 1), (0, 1))
        difference = compare_pictures(picture(half, (0, 1), (0, 1)), whole)
        assert difference.over_one == 0

    def test_only_the_part_that_both_show_is_compared(self):
        """Half the PRF shows half the speeds."""
        wide = picture(self.levels, (-2, 2), (0, 1))
        narrow = picture(self.levels[8:24], (-1, 1), (0, 1))
        assert compare_pictures(narrow, wide) == MapDifference(0, 0, None, 0)


def cloud(*frames):
    points = [np.pad(np.reshape(f, (-1, 3)), ((0, 0), (0, len(COLUMNS) - 3))) for f in frames]
    return Cloud.of(points)


class TestPoints:
    def test_the_same(self):
        same = cloud([[1, 0, 0], [2, 0, 0]], [])
        assert compare_points(same, same) == PointDifference(0, None, 1, 1)

    def test_how_many_move_and_how_far(self):
        before = cloud([[1, 0, 0], [2, 0, 0]])
        after = cloud([[1, 0, 0.05], [2, 0, 0]])
        assert compare_points(after, before) == PointDifference(0.5, pytest.approx(0.05), 2, 2)

    def test_one_that_is_lost_has_moved_without_a_way(self):
        difference = compare_points(cloud([]), cloud([[1, 0, 0]]))
        assert (difference.moved, difference.distance_m) == (1, None)
        assert (difference.per_frame, difference.base_per_frame) == (0, 1)

    def test_frames_of_half_the_rate_are_compared_with_the_nearest(self):
        slow = cloud([[1, 0, 0]], [[2, 0, 0]])
        fast = cloud([[1, 0, 0]], [[1, 0, 0]], [[2, 0, 0]], [[2, 0, 0]])
        assert compare_points(slow, fast).moved == 0
