"""Intervals of samples that vary together cover what is true, where single images would not."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.stats import binomtest

from radhar_cli.learning.images.sample_table import SampleTable, objects
from radhar_cli.learning.intervals import (
    Groups,
    interval_in_words,
    mean_interval,
    numbers_of_rate,
    numbers_of_share,
    rate_interval,
    share_interval,
    wilson,
)

SETS = 200


@given(count=st.integers(1, 5000), share=st.floats(0, 1))
@settings(max_examples=50, deadline=None)
def test_wilson_is_that_of_scipy(count, share):
    right = round(share * count)
    low, high = wilson(right, count)
    known = binomtest(right, count).proportion_ci(0.95, method="wilson")
    assert (low, high) == pytest.approx((known.low, known.high), abs=1e-9)
    assert 0 <= low <= right / count <= high <= 1


def test_wilson_of_no_images_is_the_whole_interval():
    assert wilson(0, 0) == (0.0, 1.0)


def drawn_groups(seed, count, size):
    """Samples of persons, right or not: each person has a share of their own, 0.7 on average."""
    rng = np.random.default_rng(seed)
    share = rng.beta(2.1, 0.9, count)
    group = np.repeat(np.arange(count), size)
    return (rng.random(group.size) < share[group]).astype(float), group


def coverage(interval):
    return np.mean([low <= 0.7 <= high for low, high in map(interval, range(SETS))])


@pytest.mark.parametrize("count", [6, 12, 30])
def test_intervals_over_persons_cover_the_share_of_others(count):
    def over_persons(seed):
        return share_interval(*drawn_groups(seed, count, 40))

    def over_images(seed):
        right, _ = drawn_groups(seed, count, 40)
        return wilson(right.sum(), right.size)

    assert coverage(over_persons) > 0.9
    assert coverage(over_images) < 0.6


def test_means_of_persons_are_covered():
    def drawn(seed):
        rng = np.random.default_rng(seed)
        group = np.repeat(np.arange(8), 30)
        return mean_interval(5 + rng.normal(size=8)[group] + rng.normal(size=240), group)

    assert np.mean([low <= 5 <= high for low, high in map(drawn, range(SETS))]) > 0.9


def test_single_samples_have_wilsons_interval():
    right = (np.arange(40) < 30).astype(float)
    assert share_interval(right, np.arange(40)) == wilson(30, 40)


def test_copies_of_an_image_say_no_more_than_it_does():
    right = np.random.default_rng(0).integers(0, 2, 40).astype(float)
    low, high = share_interval(np.repeat(right, 50), np.repeat(np.arange(40), 50))
    once = wilson(right.sum(), 40)
    assert (low, high) == pytest.approx(once, abs=0.03)


def test_persons_who_are_all_right_are_as_many_as_persons():
    low, high = share_interval(np.ones(600), np.repeat(np.arange(6), 100))
    assert high == 1
    assert low < wilson(6, 6)[0]


def test_a_seed_decides():
    right, group = drawn_groups(3, 12, 40)
    assert share_interval(right, group, seed=2) == share_interval(right, group, seed=2)


@pytest.mark.parametrize(("persons", "is_given"), [(1, False), (4, False), (5, True)])
def test_too_few_persons_are_said(persons, is_given):
    group = Groups(np.arange(60) % persons, "person")
    numbers = numbers_of_share("accuracy", (np.arange(60) % 7 > 0).astype(float), group)
    assert (numbers["accuracy_95"] is not None) == is_given
    words = interval_in_words(numbers["accuracy_95"], numbers["interval_over"])
    assert words.endswith(f"over {persons} persons)" if is_given else "too few)")
    assert str(persons) in words


def table(**columns):
    name = objects(f"walking/{n}" for n in range(6))
    return SampleTable(np.zeros(6, np.intp), name, np.zeros(6, np.intp), **columns)


@pytest.mark.parametrize(
    ("columns", "kind", "count"),
    [
        ({}, "sample", 6),
        ({"scene": objects("abcdef")}, "sample", 6),
        ({"scene": objects("aabbcc")}, "scene", 3),
        ({"scene": objects(["a", "a", "", "", "", ""])}, "sample", 6),
        ({"recording": objects("aabbcc"), "scene": objects("aaabbb")}, "recording", 3),
        ({"recording": objects("aabbcc"), "person": objects("aabbcc")}, "recording", 3),
        ({"recording": objects("aabbcc"), "person": objects("PPPPQQ")}, "person", 2),
        ({"person": objects("PPPPQQ")}, "person", 2),
    ],
)
def test_what_varies_together_follows_from_what_is_known(columns, kind, count):
    groups = table(**columns).groups(np.arange(6))
    assert (groups.kind, groups.count) == (kind, count)


def test_where_persons_are_the_classes_recordings_vary():
    groups = table(recording=objects("aabbcc"), person=objects("PPPPQQ")).groups(
        np.arange(6), by_person=False
    )
    assert (groups.kind, groups.count) == ("recording", 3)


def test_a_rate_without_events_has_the_upper_end_of_garwood():
    """3.69 in all where hours are independent, more where they are of few persons."""
    none, hours = np.zeros(1000), np.full(1000, 0.01)
    low, high = rate_interval(none, hours, np.arange(1000))
    assert low == 0
    assert high == pytest.approx(3.689 / 10, rel=0.01)
    assert rate_interval(none, hours, np.arange(1000) % 5)[1] > 1.5 * high


@pytest.mark.parametrize("persons", [6, 12, 30])
def test_intervals_of_rates_over_persons_cover_the_rate_of_others(persons):
    """Persons have rates of their own, 2 an hour on average; each seen twice for half an hour."""
    covered = 0
    for seed in range(SETS):
        rng = np.random.default_rng(seed)
        rate = np.repeat(rng.gamma(2.0, 1.0, persons), 2)
        hours = np.full(rate.size, 0.5)
        low, high = rate_interval(
            rng.poisson(rate * hours), hours, np.repeat(np.arange(persons), 2)
        )
        covered += low <= 2 <= high
    assert covered > 0.9 * SETS


def test_a_rate_of_few_persons_has_no_interval():
    numbers = numbers_of_rate("an_hour", np.ones(8), np.ones(8), Groups(np.arange(8) % 4, "person"))
    assert numbers == {"an_hour_95": None, "interval_over": {"kind": "person", "count": 4}}
