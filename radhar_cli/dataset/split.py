"""Train, validation and test: a number for every sample."""

import numpy as np

from radhar_cli.config.classes import FilesConfig
from radhar_cli.config.data_set import AnyConfig, MeasuredConfig
from radhar_cli.config.output import SplitConfig
from radhar_cli.dataset.layout import SPLITS, Rows
from radhar_cli.dataset.recorded import windows
from radhar_cli.numerics.arrays import Index, Levels
from radhar_cli.numerics.randomness import SPLIT, stream
from radhar_cli.numerics.rounding import half_up

TRAIN, VALIDATION, TEST = 0, 1, 2


def split_rows(config: AnyConfig) -> Levels:
    """Split the rows of a data set; return the number of each [N]: 0 train, 1 validation, 2 test.

    By sample, each class is shuffled by its own stream and cut at round(share n). By subject the
    persons are shuffled and cut, and every sample goes where its person goes. Recordings go where
    their manifest says, if it does.
    """
    if isinstance(config, MeasuredConfig) and config.recordings.has_split:
        names = [window.part.split for window in windows(config)]
        return np.array([SPLITS.index(str(name)) for name in names], np.uint8)
    rows, split, person = Rows.of(config), config.split, persons(config)
    if person is not None:
        assert split.subjects is not None
        cut = _cut(split, split.subjects, stream(config.seed, SPLIT, name="subjects"))
        return cut[person]
    return np.concatenate(
        [
            _cut(split, count, stream(config.seed, SPLIT, activity.index, name="samples"))
            for activity, count in zip(rows.activities, rows.counts, strict=True)
        ]
    )


def persons(config: AnyConfig) -> Index | None:
    """Number of the person in every row [N]; None if the data set is not split by person.

    Persons of recordings are numbered in the order of the alphabet.
    """
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
        files = config.classes.get(activity.slug)
        if isinstance(files, FilesConfig) and files.file is None and len(files.files) < people:
            warnings.append(
                f"classes.{activity.slug}: {len(files.files)} files for split.subjects = {people}: "
                "persons of training and validation share them"
            )
    for number, part in enumerate(SPLITS):
        share = getattr(config.split, part)
        empty_classes = [
            a.slug for a, class_rows in rows.classes() if not (split[class_rows] == number).any()
        ]
        if share and empty_classes:
            classes = (
                "any class"
                if len(empty_classes) == len(rows.activities)
                else ", ".join(empty_classes)
            )
            key = "samples_per_class" if config.split.subjects is None else "split.subjects"
            warnings.append(
                f"split.{part} = {share:g}, but there is no {part} sample of {classes}: "
                f"{key} is too small"
            )
    return warnings


def _cut(split: SplitConfig, count: int, rng: np.random.Generator) -> Levels:
    """Shuffle `count` things and split them; return the number of the split of each [count]."""
    train = half_up(split.train, count)
    test = min(half_up(split.test, count), count - train)
    if split.validation == 0:
        train, test = (count - test, test) if split.test else (count, 0)
    numbers = np.full(count, VALIDATION, dtype=np.uint8)
    order = rng.permutation(count)
    numbers[order[:train]] = TRAIN
    numbers[order[count - test :]] = TEST
    return numbers
