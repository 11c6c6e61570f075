"""How often a forest tells the class: chance where there is nothing, its interval, persons."""

import numpy as np
import pytest

from radhar_cli.study.audit.held_out import Effort, class_share, holm

FAST = Effort(trees=9, folds=3, permutations=200)


def labels(classes, count):
    return np.repeat(np.arange(classes), count)


def share(x, label, group=None, seed=1, name="x"):
    group = np.arange(label.size) if group is None else group
    effort = Effort(FAST.trees, FAST.folds, FAST.permutations, seed)
    return class_share(np.asarray(x, float).reshape(label.size, -1), label, group, effort, name)


@pytest.mark.parametrize(("classes", "count"), [(2, 20), (5, 12)])
def test_of_nothing_the_share_is_chance_and_intervals_cover_it(classes, count):
    found = []
    for seed in range(30):
        rng = np.random.default_rng(seed)
        label = labels(classes, count)
        found.append(share(rng.normal(size=(label.size, 3)), label, seed=seed))
    inside = [one.low <= one.chance <= one.high for one in found]
    assert np.mean(inside) > 0.83
    assert np.mean([one.p < 0.05 for one in found]) < 0.17
    assert np.mean([one.share for one in found]) == pytest.approx(1 / classes, abs=0.06)


def test_a_number_that_gives_the_class_away():
    label = labels(3, 20)
    found = share(label + 0.1 * np.random.default_rng(0).normal(size=60), label)
    assert found.share > 0.95
    assert found.low > 0.8
    assert found.p == pytest.approx(1 / 201)
    assert found.chance == pytest.approx(1 / 3)


def test_it_is_the_mean_over_classes():
    """Whoever always says the frequent class is no better than chance."""
    label = np.repeat([0, 1], [90, 10])
    found = share(np.zeros(100), label)
    assert found.share == pytest.approx(0.5, abs=0.2)
    assert found.majority == 0.9
    assert found.low <= 0.5 <= found.high


def test_habits_of_persons_tell_nothing_of_others():
    rng = np.random.default_rng(0)
    person = np.tile(np.repeat(np.arange(6), 10), 2)
    label = labels(2, 60)
    x = rng.normal(size=(2, 6, 4))[label, person] * 10 + 0.1 * rng.normal(size=(120, 4))
    assert share(x, label).share > 0.9
    found = share(x, label, person)
    assert found.share < 0.8
    assert found.groups == 6
    assert found.low < 0.5, "six persons decide little"


def test_groups_of_one_class_each_change_labels_as_a_whole():
    """Ten recordings of one class each: what tells recordings apart is no proof."""
    rng = np.random.default_rng(0)
    group = np.repeat(np.arange(10), 12)
    label = group % 2
    x = rng.normal(size=10)[group] + 0.01 * rng.normal(size=120)
    assert share(x, label, group).p > 0.05


def test_missing_numbers_may_tell_the_class():
    label = labels(2, 20)
    x = np.random.default_rng(0).normal(size=40)
    x[label == 1] = np.nan
    assert share(x, label).share == 1


def test_numbers_of_any_size_and_infinite_ones():
    label = labels(2, 20)
    x = np.where(label == 1, 1e300, 1.0)
    assert share(x, label).share == 1
    x[3] = np.inf
    assert share(x, label).share > 0.9


@pytest.mark.parametrize(
    ("label", "group"),
    [([0, 0, 1], None), ([0, 0, 0], None), ([0, 0, 1, 1], [0, 0, 1, 1]), ([0], None)],
)
def test_what_cannot_be_held_out_is_not_tested(label, group):
    label = np.array(label)
    group = None if group is None else np.array(group)
    assert share(np.arange(label.size), label, group) is None


def test_a_class_with_one_sample_is_left_out():
    found = share(np.arange(9.0), np.array([0, 0, 0, 0, 1, 1, 1, 1, 2]))
    assert found.classes == 2
    assert found.samples == 8


def test_two_samples_of_two_classes_are_enough():
    found = share([0, 0, 9, 9], np.array([0, 0, 1, 1]))
    assert 0 <= found.low <= found.share <= found.high <= 1


def test_a_seed_decides():
    label = labels(3, 15)
    x = np.random.default_rng(5).normal(size=(45, 4))
    assert share(x, label, seed=3) == share(x, label, seed=3)
    assert share(x, label, seed=3) != share(x, label, seed=4)


def test_holm():
    found = holm(np.array([0.01, 0.04, 0.03, 0.5]))
    assert found == pytest.approx([0.04, 0.09, 0.09, 0.5])
