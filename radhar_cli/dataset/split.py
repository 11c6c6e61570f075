"""Train, validation and test: a number for every sample."""

import numpy as np

from radhar_cli.arrays import Levels
from radhar_cli.config.schema import Config, SplitConfig
from radhar_cli.dataset.layout import Rows
from radhar_cli.randomness import SPLIT, stream
from radhar_cli.rounding import half_up
from radhar_cli.scene import subject_of

TRAIN, VALIDATION, TEST = 0, 1, 2


def split_rows(config: Config) -> Levels:
    """Split numbers [N]: 0 train, 1 validation, 2 test.

    By sample, each class is shuffled by its own stream and cut at round(share n). By subject the
    persons are shuffled and cut, and every sample goes where its person goes.
    """
    rows = Rows.of(config)
    split = config.split
    if split.subjects is not None:
        rng = stream(config.seed, SPLIT, name="subjects")
        by_person = _cut(split, split.subjects, rng)
        persons = [subject_of(config, index) for index in range(config.samples_per_class)]
        one_class = by_person[np.array(persons, dtype=int)]
        return np.tile(one_class, len(rows.activities))
    return np.concatenate(
        [
            _cut(split, rows.per_class, stream(config.seed, SPLIT, a.index, name="samples"))
            for a in rows.activities
        ]
    )


def _cut(split: SplitConfig, count: int, rng: np.random.Generator) -> Levels:
    train = half_up(split.train, count)
    test = min(half_up(split.test, count), count - train)
    if split.validation == 0:
        train, test = (count - test, test) if split.test else (count, 0)
    numbers = np.full(count, VALIDATION, dtype=np.uint8)
    order = rng.permutation(count)
    numbers[order[:train]] = TRAIN
    numbers[order[count - test :]] = TEST
    return numbers
