"""Points to draw, and how well they separate."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.learning.embedding import MAX_POINTS, embed, select_rows, separation, shrink


@given(st.integers(1, 10_000))
def test_chosen_rows_are_distinct_spread_and_few(count):
    rows = select_rows(count)
    assert rows[0] == 0
    assert rows[-1] == count - 1
    assert rows.size == min(count, MAX_POINTS) or count == 1
    assert (np.diff(rows) > 0).all()


def test_shrunk_averages_blocks():
    image = np.zeros((128, 96, 3), np.uint8)
    image[:2, :2] = [[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [0, 0, 0]]]
    vector = shrink(image)
    assert vector.shape == (64 * 48,)
    assert vector[0] == pytest.approx(0.25)
    assert vector[1:].max() == 0
    assert shrink(np.zeros((32, 32, 3), np.uint8)).shape == (1024,)


def test_separate_clouds_stay_separate():
    rng = np.random.default_rng(0)
    label = np.repeat([0, 1], 12)
    vectors = rng.normal(0, 0.1, (24, 60)) + 5 * label[:, None]
    assert separation(vectors, label) > 0.9
    points = embed(vectors)
    assert points.shape == (24, 2)
    assert separation(points, label) > 0.5
    assert np.array_equal(points, embed(vectors))


def test_separation_of_one_class_is_unknown():
    assert separation(np.zeros((4, 2)), np.zeros(4, int)) is None
    assert separation(np.zeros((2, 2)), np.array([0, 1])) is None
