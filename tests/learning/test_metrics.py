"""Metrics against numbers worked out by hand."""

import numpy as np
import pytest

from radhar_cli.learning import metrics
from radhar_cli.learning.intervals import Groups, wilson


def test_calibration_error_by_hand():
    """Three at 0.9, two of them right; one at 0.55, wrong: gaps 0.7/3 and 0.55."""
    sure = np.array([0.9, 0.9, 0.9, 0.55])
    probabilities = np.stack([sure, 1 - sure], axis=1)
    found = metrics.calibration_error(np.array([0, 0, 1, 1]), probabilities)
    assert found == pytest.approx(3 / 4 * abs(2 / 3 - 0.9) + 1 / 4 * 0.55)


def test_calibration_bins_hold_their_upper_edge() -> None:
    """0.6 = 9/15 belongs to the bin that ends there, and shares it with 0.59."""
    probabilities = np.array([[0.59, 0.41], [0.6, 0.4]])
    found = metrics.calibration_error(np.array([0, 1]), probabilities)
    assert found == pytest.approx(abs(0.5 - 0.595))


def test_calibration_bins_are_equal_parts_of_the_probability() -> None:
    """0.51 lies in the eighth of fifteen bins, 0.99 and 1 in the last."""
    found = metrics.calibration(
        np.array([0, 0, 0]), np.array([[0.51, 0.49], [0.99, 0.01], [1.0, 0.0]])
    )
    assert np.flatnonzero(found.count).tolist() == [7, 14]
    assert found.confidence[14] == pytest.approx(0.995)


def test_summary_of_a_planted_confusion():
    """Everything of class 1 is taken for class 2; class 3 does not occur."""
    truth = np.array([0, 0, 1, 1, 1, 2, 2])
    predicted = np.array([0, 0, 2, 2, 2, 2, 2])
    groups = Groups(np.arange(7), "sample")
    numbers = metrics.summarise(truth, np.eye(4)[predicted], ["a", "b", "c", "d"], groups)
    assert numbers["confusion"] == [[2, 0, 0, 0], [0, 0, 3, 0], [0, 0, 2, 0], [0, 0, 0, 0]]
    assert (numbers["images"], numbers["right"]) == (7, 4)
    assert numbers["accuracy"] == pytest.approx(4 / 7)
    assert numbers["accuracy_95"] == pytest.approx(list(wilson(4, 7)))
    assert numbers["macro_f1"] == pytest.approx((1 + 0 + 4 / 7) / 3)
    assert list(numbers["classes"]) == ["a", "b", "c"]
    assert numbers["classes"]["b"] == {"precision": 0.0, "recall": 0.0, "f1": 0.0, "images": 3}
    assert numbers["classes"]["c"]["precision"] == pytest.approx(2 / 5)
    assert numbers["classes"]["c"]["recall"] == 1.0
