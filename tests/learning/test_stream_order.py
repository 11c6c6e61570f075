"""The order of a stream: every sample once, in the ratio of the data set, its split held back."""

import pytest

from radhar_cli.config.schema import Config
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.split import TRAIN, split_rows
from radhar_cli.errors import ConfigError
from radhar_cli.learning.stream import Stream

UNEVEN = {"per_activity": {"default": 6, "walking": 12, "S12": 3}}
FOUR = ["punching", "kicking", "walking", "S12"]


def config(**more):
    document = {"seed": 5, "samples_per_class": 10, "activities": FOUR, **more}
    return Config.model_validate(document)


def first(stream, count):
    return [(activity.slug, index) for activity, index in map(stream._key, range(count))]


def test_classes_come_in_turn_and_every_sample_once():
    seen = first(Stream(config(samples_per_class=UNEVEN)), 40)
    assert {slug for slug, _ in seen[:4]} == {slug for slug, _ in seen[4:8]}
    assert [index for _, index in seen] == [n // 4 for n in range(40)]
    assert len({*seen}) == 40


def test_training_leaves_out_what_the_split_holds_back():
    made = config(samples_per_class=UNEVEN, split={"train": 0.6, "validation": 0.2, "test": 0.2})
    rows, split = Rows.of(made), split_rows(made)
    held_back = {
        (rows[row][0].slug, rows[row][1]) for row in range(len(rows)) if split[row] != TRAIN
    }
    seen = first(Stream(made, split="train"), 4 * len(rows))
    assert held_back
    assert not held_back & {*seen}
    assert len({*seen}) == len(seen)


def test_training_leaves_out_persons_and_nobody_else():
    split = {"train": 0.5, "validation": 0.5, "by": "subject", "subjects": 4}
    made = config(samples_per_class=8, split=split)
    rows, numbers = Rows.of(made), split_rows(made)
    trained = {rows[row][1] % 4 for row in range(len(rows)) if numbers[row] == TRAIN}
    assert len(trained) == 2
    seen = first(Stream(made, split="train"), 160)
    assert {index % 4 for _, index in seen} == trained
    assert len({*seen}) == 160
    assert max(index for _, index in seen) < 2 * 160 / 4 + 4, "no index is skipped but theirs"


def test_a_split_without_training_persons_is_refused():
    split = {"train": 0.0, "validation": 1.0, "by": "subject", "subjects": 2}
    with pytest.raises(ConfigError, match=r"split.train: leaves no person"):
        Stream(config(split=split), split="train")
