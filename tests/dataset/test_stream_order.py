"""The order of a stream: every sample once, in the ratio of the data set, its split held back."""

from collections import Counter
from typing import Any

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.config.schema import Config
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.split import TRAIN, split_rows
from radhar_cli.dataset.stream_order import StreamOrder
from radhar_cli.errors import ConfigError

UNEVEN = {"per_activity": {"default": 6, "walking": 12, "S12": 3}}
FOUR = ["punching", "kicking", "walking", "S12"]


def config(**more: Any) -> Config:
    document = {"seed": 5, "samples_per_class": 10, "activities": FOUR, **more}
    return Config.model_validate(document)


def first(order: StreamOrder, count: int) -> list[tuple[str, int]]:
    return [(activity.slug, index) for activity, index in map(order.__getitem__, range(count))]


@pytest.mark.parametrize("samples", [10, UNEVEN])
def test_a_stream_begins_with_the_data_set_and_goes_on(samples: Any) -> None:
    made = config(samples_per_class=samples)
    rows, order = Rows.of(made), StreamOrder(made)
    count = len(rows)
    seen = first(order, 3 * count)
    assert {*seen[:count]} == {(rows[row][0].slug, rows[row][1]) for row in range(count)}
    assert len({*seen}) == 3 * count
    assert max(index for _, index in seen) == 3 * max(rows.counts) - 1


def test_a_round_has_the_classes_in_the_ratio_of_the_data_set() -> None:
    seen = first(StreamOrder(config(samples_per_class=UNEVEN)), 90)
    ratio = {"punching": 2, "kicking": 2, "walking": 4, "walking_to_falling": 1}
    for start in range(0, 90, 9):
        assert Counter(slug for slug, _ in seen[start : start + 9]) == ratio
    even = first(StreamOrder(config(samples_per_class=UNEVEN), balanced=True), 40)
    assert set(Counter(slug for slug, _ in even).values()) == {10}


def test_classes_are_shuffled_by_the_seed() -> None:
    one, other = (first(StreamOrder(config(seed=seed)), 40) for seed in (5, 6))
    assert one != other
    assert len({tuple(slug for slug, _ in one[at : at + 4]) for at in range(0, 40, 4)}) > 3


def test_training_leaves_out_what_the_split_holds_back() -> None:
    made = config(samples_per_class=UNEVEN, split={"train": 0.6, "validation": 0.2, "test": 0.2})
    rows, split, order = Rows.of(made), split_rows(made), StreamOrder(made, "train")
    held_back = {
        (rows[row][0].slug, rows[row][1]) for row in range(len(rows)) if split[row] != TRAIN
    }
    seen = first(order, 4 * len(rows))
    assert held_back
    assert not held_back & {*seen}
    assert len({*seen}) == len(seen)
    whole = {(rows[row][0].slug, rows[row][1]) for row in range(len(rows))}
    assert whole - held_back <= {*seen}, "the training samples of the data set come first"


def test_training_leaves_out_persons_and_nobody_else() -> None:
    split = {"train": 0.5, "validation": 0.5, "by": "subject", "subjects": 4}
    made = config(samples_per_class=8, split=split)
    rows, numbers = Rows.of(made), split_rows(made)
    trained = {rows[row][1] % 4 for row in range(len(rows)) if numbers[row] == TRAIN}
    assert len(trained) == 2
    seen = first(StreamOrder(made, "train"), 160)
    assert {index % 4 for _, index in seen} == trained
    assert len({*seen}) == 160
    assert max(index for _, index in seen) < 2 * 160 / 4 + 4, "no index is skipped but theirs"


def test_a_split_without_training_persons_is_refused() -> None:
    split = {"train": 0.0, "validation": 1.0, "by": "subject", "subjects": 2}
    with pytest.raises(ConfigError, match=r"split.train: leaves no person"):
        StreamOrder(config(split=split), "train")


@settings(max_examples=20, deadline=None)
@given(
    number=st.integers(0, 10**12),
    persons=st.booleans(),
    split=st.sampled_from(["all", "train"]),
    balanced=st.booleans(),
)
def test_number_and_sample_are_inverse(
    number: int, persons: bool, split: Any, balanced: bool
) -> None:
    shares: dict[str, Any] = {"train": 0.5, "validation": 0.5}
    if persons:
        shares |= {"by": "subject", "subjects": 3}
    order = StreamOrder(config(samples_per_class=UNEVEN, split=shares), split, balanced)
    activity, index = order[number]
    assert order.number(activity, index) == number


@pytest.mark.parametrize("persons", [False, True])
def test_held_back_samples_have_no_number(persons: bool) -> None:
    shares: dict[str, Any] = {"train": 0.5, "validation": 0.5}
    if persons:
        shares |= {"by": "subject", "subjects": 4}
    made = config(split=shares)
    rows, split, order = Rows.of(made), split_rows(made), StreamOrder(made, "train")
    for row in range(len(rows)):
        assert (order.number(*rows[row]) is None) == (split[row] != TRAIN)
