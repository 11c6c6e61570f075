"""Train, validation and test: a number for every sample."""

import numpy as np

from radhar_cli.arrays import Index, Levels
from radhar_cli.config.schema import AnyConfig, FilesConfig, MeasuredConfig, SplitConfig
from radhar_cli.dataset.layout import SPLITS, Rows
from radhar_cli.dataset.recorded import windows
from radhar_cli.randomness import SPLIT, stream
from radhar_cli.rounding import half_up

TRAIN, VALIDATION, TEST = 0, 1, 2


def split_rows(config: AnyConfig) -> Levels:
    """Split numbers [N]: 0 train, 1 validation, 2 test.

    By sample, each class is shuffled by its own stream and cut at round(share n). By subject the
    persons are shuffled and cut, and every sample goes where its person goes.
    """
    rows, split, everyone = Rows.of(config), config.split, persons(config)
    if everyone is not None:
        assert split.subjects is not None
        cut = _cut(split, split.subjects, stream(config.seed, SPLIT, name="subjects"))
        return cut[everyone]
    return np.concatenate(
        [
            _cut(split, count, stream(config.seed, SPLIT, activity.index, name="samples"))
            for activity, count in zip(rows.activities, rows.counts, strict=True)
        ]
    )


def persons(config: AnyConfig) -> Index | None:
    """Number of the person in every row, or None; of recordings by the alphabet."""
    subjects = config.split.subjects
    if subjects is None:
        return None
    if isinstance(config, MeasuredConfig):
        names = [str(window.part.person) for window in windows(config)]
        return np.searchsorted(config.recordings.persons, names)
    return np.concatenate([np.arange(count) % subjects for count in Rows.of(config).counts])


def split_warnings(config: AnyConfig, split: Levels) -> list[str]:
    """Warn of parts without samples of a class, and of persons that share motion files."""
    rows, warnings = Rows.of(config), []
    people = config.split.subjects or 0
    for activity in rows.activities:
        one = config.classes.get(activity.slug)
        if isinstance(one, FilesConfig) and one.file is None and len(one.files) < people:
            warnings.append(
                f"classes.{activity.slug}: {len(one.files)} files for split.subjects = {people}: "
                "persons of training and validation share them"
            )
    for number, part in enumerate(SPLITS):
        share = getattr(config.split, part)
        without = [a.slug for a, here in rows.classes() if not (split[here] == number).any()]
        if share and without:
            whose = "any class" if len(without) == len(rows.activities) else ", ".join(without)
            key = "samples_per_class" if config.split.subjects is None else "split.subjects"
            warnings.append(
                f"split.{part} = {share:g}, but there is no {part} sample of {whose}: "
                f"{key} is too small"
            )
    return warnings


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
