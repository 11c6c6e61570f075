"""Table of the samples: label, index and numbers, in the order of files that others read."""

from collections.abc import Iterator
from typing import Any, NamedTuple

import numpy as np

from radhar_cli.config.data_set import AnyConfig, Config
from radhar_cli.config.motion import FALL
from radhar_cli.config.paths import numbers
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.reading import Dataset
from radhar_cli.errors import FolderError
from radhar_cli.schema.number import support
from radhar_cli.schema.section import for_activity

BLOCK = 256  # indices whose numbers are read at once


class Entry(NamedTuple):
    """One sample in the table."""

    row: int  # of dataset.h5
    split: int  # 0 train, 1 validation, 2 test
    number: int  # of the class, as in /label: the label
    label: str  # slug of the class
    place: int  # index within the class; (number, place) is the sample key
    # of `number_names`, as in /scene: SI units, NaN where one does not apply
    values: tuple[float, ...]
    # slugs of what anybody in the scene does, a space between; of scenes with `people`
    labels: str = ""


def number_names(config: AnyConfig) -> list[str]:
    """Names of the numbers that differ from sample to sample, in the order of `Entry.values`.

    `subject` holds integers.
    """
    same = {scene_fields.ERROR.key}  # which is measured, not drawn
    if isinstance(config, Config):
        same |= {key for key, number in numbers(config) if _is_same(config, key, number)}
        same |= {FALL} if isinstance(config.motion.falling.direction, str) else set()
    names = [field.name for field in scene_fields.fields(config) if field.key not in same]
    return [*names, "subject"] if config.split.subjects is not None else names


def _is_same(config: Config, key: str, number: Any) -> bool:
    """Whether a number is the same in all samples that it applies to."""
    ends = {
        end
        for activity in config.chosen_activities
        if config.depends_on(activity, key)
        for end in support(for_activity(number, activity))
    }
    return len(ends) == 1


def entries(data: Dataset) -> Iterator[Entry]:
    """Yield every sample: the first of each class, then the second of each, and so on.

    In this order every piece of the table, or of files written from it, holds every class.

    Raises:
        FolderError: a label is not that of its row.
    """
    rows, names = Rows.of(data.config), number_names(data.config)
    for first in range(0, max(rows.counts), BLOCK):
        blocks = []
        for activity, class_rows in rows.classes():
            start, stop = (
                min(class_rows.start + n, class_rows.stop) for n in (first, first + BLOCK)
            )
            numbers = (data.scene[name].rows(start, stop).tolist() for name in names)
            blocks.append((activity, start, list(zip(*numbers, strict=True))))
        for place in range(BLOCK):
            for label, (activity, start, values) in enumerate(blocks):
                if place >= len(values):
                    continue
                row = start + place
                if data.label[row] != label:
                    raise FolderError(
                        f"{data.path}: /label[{row}]: is {data.label[row]}; should be "
                        f"{label}, {activity.slug}"
                    )
                yield Entry(
                    row,
                    int(data.split[row]),
                    label,
                    activity.slug,
                    first + place,
                    values[place],
                    "" if data.labels is None else _slugs(data, row),
                )


def _slugs(data: Dataset, row: int) -> str:
    """Slugs of the activities of anybody in the scene of a row, separated by spaces."""
    assert data.labels is not None
    return " ".join(data.class_slugs[label] for label in np.flatnonzero(data.labels[row]))
