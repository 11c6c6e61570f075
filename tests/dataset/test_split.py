"""Splits: exact counts, shuffled by class, and no person on two sides."""

from fractions import Fraction
from math import floor
from pathlib import Path

import numpy as np
import pytest
from helpers.command_line import ok
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.config import Config, load_config, load_radars
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.split import TEST, TRAIN, VALIDATION, persons, split_rows, split_warnings
from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.scene.scene import subject_of


def split_of(count, seed=1, activities="all", **split):
    """Split numbers [class, index]."""
    config = Config(samples_per_class=count, seed=seed, activities=activities, split=split)
    return split_rows(config).reshape(-1, count)


def half_up(share, count):
    return floor(Fraction(share) * count + Fraction(1, 2))


@given(st.integers(1, 400))
@settings(deadline=None, max_examples=40)
def test_every_class_is_split_at_80_percent(count):
    found = split_of(count)
    train = half_up("0.8", count)
    assert found.shape == (12, count)
    np.testing.assert_array_equal((found == TRAIN).sum(axis=1), train)
    np.testing.assert_array_equal((found == VALIDATION).sum(axis=1), count - train)


# Train and test; the rest validates. Halves round up on both sides, and train comes first.
SHARES = [("0.7", "0.15"), ("0.5", "0.25"), ("0.35", "0.05"), ("0.5", "0.5"), ("0.25", "0.75")]


@given(st.integers(1, 200), st.sampled_from(SHARES))
@settings(deadline=None, max_examples=40)
def test_three_splits(count, shares):
    train, test = shares
    validation = float(1 - Fraction(train) - Fraction(test))
    found = split_of(
        count, train=float(train), validation=validation, test=float(test), activities=("S1", "S8")
    )
    in_train = half_up(train, count)
    in_test = min(half_up(test, count), count - in_train)
    assert np.all((found == TRAIN).sum(axis=1) == in_train)
    assert np.all((found == TEST).sum(axis=1) == in_test)
    assert np.all((found == VALIDATION).sum(axis=1) == count - in_train - in_test)


@given(st.integers(1, 100), st.integers(0, 100))
@settings(deadline=None, max_examples=40)
def test_a_split_of_share_0_gets_no_sample(count, percent):
    share = percent / 100
    without = split_of(count, train=share, validation=0.0, test=round(1 - share, 2))
    assert not np.any(without == VALIDATION)
    if percent == 100:
        assert np.all(without == TRAIN)
    assert not np.any(split_of(count, train=share, validation=round(1 - share, 2)) == TEST)


def test_rounding_of_shares_gives_no_sample_to_a_split_of_share_0():
    found = split_of(1, train=0.4999999996, validation=0.0, test=0.4999999996)
    assert not np.any(found == VALIDATION)


def test_every_sample_may_go_anywhere():
    """Over 300 seeds each sample trains in 80 %: standard error 2.3 %."""
    trains = [split_of(10, seed=seed, activities=("S1",))[0] == TRAIN for seed in range(300)]
    np.testing.assert_allclose(np.mean(trains, axis=0), 0.8, atol=5 * 0.023)


def test_classes_are_shuffled_apart_and_alone():
    found = split_of(50)
    assert len({row.tobytes() for row in found}) == 12
    assert not np.array_equal(found, split_of(50, seed=2))
    np.testing.assert_array_equal(split_of(50, activities=("S2", "S8")), found[[1, 7]])


@given(st.integers(1, 40), st.integers(0, 80), st.integers(0, 100))
@settings(deadline=None, max_examples=40)
def test_by_subject_no_person_is_in_two_splits(subjects, more, seed):
    count = subjects + more
    config = Config(
        samples_per_class=count,
        seed=seed,
        split={"by": "subject", "subjects": subjects, "train": 0.6, "validation": 0.2, "test": 0.2},
    )
    found = split_rows(config)
    rows = Rows.of(config)
    sides: dict[int | None, set[int]] = {}
    for row, split in enumerate(found):
        sides.setdefault(subject_of(config, rows[row][1]), set()).add(int(split))
    assert len(sides) == subjects
    assert all(len(side) == 1 for side in sides.values())
    persons = [side.pop() for side in sides.values()]
    assert persons.count(TRAIN) == half_up("0.6", subjects)
    in_test = min(half_up("0.2", subjects), subjects - half_up("0.6", subjects))
    assert persons.count(TEST) == in_test


COUNTS = {"per_activity": {"default": 4, "walking": 10, "home": 1}}
HOME = {"home": {"sequence": ["walking"]}}


def test_classes_of_different_sizes_are_split_one_by_one():
    config = Config(samples_per_class=COUNTS, classes=HOME, activities=["S1", "S8", "home"])
    rows, split = Rows.of(config), split_rows(config)
    assert rows.counts == (4, 10, 1)
    assert [rows[row][1] for row in range(15)] == [*range(4), *range(10), 0]
    cut = [np.bincount(split[here], minlength=3).tolist() for _, here in rows.classes()]
    assert cut == [[3, 1, 0], [8, 2, 0], [1, 0, 0]]
    np.testing.assert_array_equal(split[4:14], split_of(10, activities=("S8",))[0])
    (warning,) = split_warnings(config, split)
    assert warning == (
        "split.validation = 0.2, but there is no validation sample of home: "
        "samples_per_class is too small"
    )


def test_persons_keep_their_split_in_classes_of_different_sizes():
    persons = {"by": "subject", "subjects": 4, "train": 0.5, "validation": 0.5}
    counts = {"per_activity": {"default": 4, "walking": 10}}
    config = Config(samples_per_class=counts, activities=["S1", "S8"], split=persons)
    split = split_rows(config)
    sides = [{int(split[4 + index]) for index in range(person, 10, 4)} for person in range(4)]
    assert sides == [{int(side)} for side in split[:4]]


def test_an_empty_split_is_warned_of():
    config = Config(samples_per_class=2)
    (warning,) = split_warnings(config, split_rows(config))
    assert "no validation sample of any class" in warning
    for whole in (Config(samples_per_class=5), Config(split={"train": 1.0, "validation": 0.0})):
        assert split_warnings(whole, split_rows(whole)) == []


@pytest.mark.parametrize(
    ("counts", "said"),
    [
        ((4, 4, 4), "3 classes x 4"),
        ((4,), "stationary x 4"),
        ((4, 4, 9), "2 classes x 4, kicking x 9"),
        ((22, 3), "stationary x 22, punching x 3"),
    ],
)
def test_samples_of_classes_in_words(counts, said):
    assert Rows(tuple(ACTIVITIES[: len(counts)]), counts).counts_text == said


SHIPPED = [
    path
    for path in sorted((Path(__file__).parents[2] / "configs").rglob("*.yaml"))
    if path.parent.name not in ("train", "paper")  # the paper has two parts
]


@pytest.mark.every(4)
@pytest.mark.parametrize("path", SHIPPED, ids=lambda path: f"{path.parent.name}/{path.stem}")
def test_a_shipped_config_has_a_part_that_chooses_no_epoch(path):
    """Of every class, and of four persons or more where persons are split."""
    for name, config in load_radars(path).items():
        split, label = split_rows(config), Rows.of(config).label
        assert set(label[split == TEST]) == set(label), name
        assert set(label[split == VALIDATION]) == set(label)
        assert np.mean(split == TRAIN) >= 0.5
        person = persons(config)
        assert person is None or len(set(person[split == TEST])) >= 4


@pytest.mark.parametrize(
    "option", [("--minimal",), ("--radar", "iwr1443boost"), ("--radar", "p440")]
)
def test_so_has_a_config_that_is_written_to_start_from(tmp_path, option):
    ok("config", "init", tmp_path / "mine.yaml", *option)
    assert (split_rows(load_config(tmp_path / "mine.yaml")) == TEST).any()
