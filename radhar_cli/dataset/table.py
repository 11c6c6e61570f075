"""The table of a data set: of every sample its label, its index and the numbers of its scene."""

from collections.abc import Iterator
from typing import NamedTuple

from radhar_cli.config.schema import Config
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.reading import Dataset
from radhar_cli.errors import FolderError

BLOCK = 256  # indices whose numbers are read at once


class Entry(NamedTuple):
    """A line of the table.

    Attributes:
        row: of dataset.h5.
        split: 0 train, 1 validation, 2 test.
        number: of the class, as in /label.
        label: slug of the class.
        place: index within the class; (number, place) is the sample key.
        values: of `number_names`, as in /scene: SI units, NaN where one does not apply.
    """

    row: int
    split: int
    number: int
    label: str
    place: int
    values: tuple[float, ...]


def number_names(config: Config) -> list[str]:
    """Names of the numbers of a scene in the order of `Entry.values`; `subject` holds integers."""
    names = [field.name for field in scene_fields.fields(config)]
    return [*names, "subject"] if config.split.subjects is not None else names


def entries(data: Dataset) -> Iterator[Entry]:
    """Every sample: the first of each class, then the second of each, and so on.

    In this order every piece of the table, or of files written from it, holds every class.

    Raises:
        FolderError: a label that is not that of its row.
    """
    rows, names = Rows.of(data.config), number_names(data.config)
    for first in range(0, max(rows.counts), BLOCK):
        held = []
        for activity, here in rows.classes():
            start, stop = (
                min(here.start + first, here.stop),
                min(here.start + first + BLOCK, here.stop),
            )
            numbers = (data.scene[name].rows(start, stop).tolist() for name in names)
            held.append((activity, start, list(zip(*numbers, strict=True))))
        for place in range(BLOCK):
            for activity, start, values in held:
                if place >= len(values):
                    continue
                row = start + place
                if data.label[row] != activity.index:
                    raise FolderError(
                        f"{data.path}: /label[{row}]: is {data.label[row]}; should be "
                        f"{activity.index}, {activity.slug}"
                    )
                yield Entry(
                    row,
                    int(data.split[row]),
                    activity.index,
                    activity.slug,
                    first + place,
                    values[place],
                )
