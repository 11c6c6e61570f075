"""The classifier two-sample test: accuracy of one half for equal distributions; groups held out."""

import numpy as np

from radhar_cli.numerics.arrays import Float
from radhar_cli.study.two_sample.comparison import correct_predictions, interval

COUNT = 40


def features(rng, shift=0.0):
    """Twice COUNT samples [., 60] that hang together; the second half is shifted in one of 60."""
    mixed = rng.normal(size=(2 * COUNT, 8)) @ rng.normal(size=(8, 60))
    x: Float = mixed + 0.5 * rng.normal(size=mixed.shape)
    x[COUNT:, 0] += shift
    return x


TRUTH = np.repeat([True, False], COUNT)


def held_out(x, group, seed=0):
    right = correct_predictions(x, TRUTH, group, seed)
    assert right is not None
    found = interval([(right, 2 * COUNT)])
    assert found is not None
    return found


def test_accuracy_is_half_for_equal_distributions_and_intervals_cover_it():
    found = []
    for seed in range(100):
        rng = np.random.default_rng(seed)
        found.append(held_out(features(rng), np.arange(2 * COUNT), seed))
    accuracy = np.array([one["accuracy"] for one in found])
    assert abs(accuracy.mean() - 0.5) < 0.03
    variance = accuracy.var() * 4 * 2 * COUNT
    assert 1.2 < variance < 2.4, "tests depend on each other; comparison.SHARED allows 1.7"
    inside = [one["accuracy_95"][0] <= 0.5 <= one["accuracy_95"][1] for one in found]
    assert np.mean(inside) > 0.88


def test_different_distributions_are_told_apart():
    rng = np.random.default_rng(0)
    assert held_out(features(rng, 20.0), np.arange(2 * COUNT))["accuracy_95"][0] > 0.85


def test_features_that_identify_persons_tell_nothing():
    """Four persons a side, each with features of his own: whether they are seen decides."""
    rng = np.random.default_rng(3)
    person = np.tile(np.repeat(np.arange(4), COUNT // 4), 2)
    who = rng.normal(size=(2, 4, 60))
    x = who[np.repeat([0, 1], COUNT), person] + 0.1 * rng.normal(size=(2 * COUNT, 60))
    assert held_out(x, np.arange(2 * COUNT))["accuracy"] == 1
    assert held_out(x, person)["accuracy"] < 0.9


def test_one_person_cannot_be_held_out():
    x = features(np.random.default_rng(0))
    assert correct_predictions(x, TRUTH, np.zeros(2 * COUNT, np.intp), 0) is None


def test_numbers_that_are_missing_or_constant_tell_nothing():
    x = features(np.random.default_rng(0), 20.0)
    x = np.hstack([x, np.full((2 * COUNT, 1), np.nan), np.full((2 * COUNT, 1), 7.0)])
    x[3, 5] = np.nan
    assert held_out(x, np.arange(2 * COUNT))["accuracy_95"][0] > 0.85
