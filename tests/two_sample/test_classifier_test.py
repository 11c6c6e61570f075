"""The classifier two-sample test: accuracy of one half for equal distributions; groups held out."""

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.two_sample.classifier_test import held_out, interval

COUNT = 40


def features(rng, shift=0.0):
    """Twice COUNT samples [., 60] that hang together; the second half is shifted in one of 60."""
    mixed = rng.normal(size=(2 * COUNT, 8)) @ rng.normal(size=(8, 60))
    x: Float = mixed + 0.5 * rng.normal(size=mixed.shape)
    x[COUNT:, 0] += shift
    return x


TRUTH = np.repeat([True, False], COUNT)


def test_accuracy_is_half_for_equal_distributions_and_intervals_cover_it():
    found = []
    for seed in range(100):
        rng = np.random.default_rng(seed)
        tested = held_out(features(rng), TRUTH, np.arange(2 * COUNT), rng)
        assert tested is not None
        found.append(interval([tested]))
    accuracy = np.array([one["accuracy"] for one in found])
    assert abs(accuracy.mean() - 0.5) < 0.03
    variance = accuracy.var() * 4 * 2 * COUNT
    assert 1.2 < variance < 2.4, "tests depend on each other; classifier_test.SHARED allows 1.7"
    inside = [one["accuracy_95"][0] <= 0.5 <= one["accuracy_95"][1] for one in found]
    assert np.mean(inside) > 0.88


def test_different_distributions_are_told_apart():
    rng = np.random.default_rng(0)
    tested = held_out(features(rng, 20.0), TRUTH, np.arange(2 * COUNT), rng)
    assert tested is not None
    assert interval([tested])["accuracy_95"][0] > 0.85


def test_features_that_identify_persons_tell_nothing():
    """Four persons a side, each with features of his own: whether they are seen decides."""
    rng = np.random.default_rng(3)
    person = np.tile(np.repeat(np.arange(4), COUNT // 4), 2)
    who = rng.normal(size=(2, 4, 60))
    x = who[np.repeat([0, 1], COUNT), person] + 0.1 * rng.normal(size=(2 * COUNT, 60))
    difference = held_out(x, TRUTH, person, rng)
    mixed = held_out(x, TRUTH, np.arange(2 * COUNT), rng)
    assert difference is not None
    assert mixed is not None
    assert interval([mixed])["accuracy"] == 1
    assert interval([difference])["accuracy"] < 0.9


def test_one_person_cannot_be_held_out():
    rng = np.random.default_rng(0)
    assert held_out(features(rng), TRUTH, np.zeros(2 * COUNT, np.intp), rng) is None


def test_numbers_that_are_missing_or_constant_tell_nothing():
    rng = np.random.default_rng(0)
    x = features(rng, 20.0)
    x = np.hstack([x, np.full((2 * COUNT, 1), np.nan), np.full((2 * COUNT, 1), 7.0)])
    x[3, 5] = np.nan
    tested = held_out(x, TRUTH, np.arange(2 * COUNT), rng)
    assert tested is not None
    assert np.isfinite(tested.score).all()
    assert interval([tested])["accuracy_95"][0] > 0.85
