"""Every sample's label, index and numbers, in the order of files that others read: metadata.csv.

metadata.csv lies beside the images of a map and split: what `load_dataset` reads of each image.
"""

import hashlib
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from radhar_cli.config.number import support
from radhar_cli.config.schema import Config, for_activity
from radhar_cli.dataset import scene_fields
from radhar_cli.dataset.files import digest_of, refuse_links, unfinished_path
from radhar_cli.dataset.layout import METADATA, SPLITS, Rows, png_folder
from radhar_cli.dataset.reading import Dataset
from radhar_cli.errors import FolderError
from radhar_cli.replacing import replacing
from radhar_cli.scene import FALL, numbers

BLOCK = 256  # indices whose numbers are read at once


class Entry(NamedTuple):
    """A line of the table."""

    row: int  # of dataset.h5
    split: int  # 0 train, 1 validation, 2 test
    number: int  # of the class, as in /label
    label: str  # slug of the class
    place: int  # index within the class; (number, place) is the sample key
    # of `number_names`, as in /scene: SI units, NaN where one does not apply
    values: tuple[float, ...]
    # slugs of what anybody in the scene does, a space between; of scenes with `people`
    labels: str = ""


def number_names(config: Config) -> list[str]:
    """Names of the numbers that are drawn, not the same in all samples, as in `Entry.values`.

    `subject` holds integers.
    """
    same = {scene_fields.ERROR.key}  # which is measured, not drawn
    same |= {key for key, number in numbers(config) if _is_same(config, key, number)}
    if isinstance(config.motion.fall, str):
        same.add(FALL)
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
    """Every sample: the first of each class, then the second of each, and so on.

    In this order every piece of the table, or of files written from it, holds every class.

    Raises:
        FolderError: a label that is not that of its row.
    """
    rows, names = Rows.of(data.config), number_names(data.config)
    for first in range(0, max(rows.counts), BLOCK):
        held = []
        for activity, here in rows.classes():
            start, stop = (min(here.start + n, here.stop) for n in (first, first + BLOCK))
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
                    "" if data.labels is None else _slugs(data, row),
                )


def _slugs(data: Dataset, row: int) -> str:
    assert data.labels is not None
    return " ".join(data.class_slugs[label] for label in np.flatnonzero(data.labels[row]))


def lines(data: Dataset) -> Iterator[tuple[int | None, bytes]]:
    """(split, line) of the files of all splits; the first line belongs to each of them."""
    rows = Rows.of(data.config)
    several = ["labels"] if data.config.people else []
    yield None, _line(["file_name", "label", "index", *several, *number_names(data.config)])
    for entry in entries(data):
        numbers = ("" if value != value else repr(value) for value in entry.values)
        known = [rows.file_name(entry.row), entry.label, str(entry.place)]
        cells = [*known, *([entry.labels] if several else []), *numbers]
        yield entry.split, _line(cells)


def _line(cells: Sequence[str]) -> bytes:
    return (",".join(cells) + "\n").encode()


def paths(data: Dataset) -> list[tuple[int, Path]]:
    """(split, path inside the output folder) of every file that there should be."""
    return [
        (n, png_folder(name, n) / METADATA)
        for name in data.config.maps
        for n in data.present_splits
    ]


def write_metadata(data: Dataset, folder: Path) -> None:
    """Write the files that are not there, all of them line by line."""
    missing = [(split, path) for split, path in paths(data) if not (folder / path).exists()]
    if not missing:
        return
    unfinished_path(folder).parent.mkdir(parents=True, exist_ok=True)
    with ExitStack() as stack:
        files = []
        for wanted, path in missing:
            refuse_links(folder, (folder / path).parent)
            (folder / path).parent.mkdir(parents=True, exist_ok=True)
            other = stack.enter_context(replacing(folder / path, unfinished_path(folder)))
            files.append((wanted, stack.enter_context(other.open("wb"))))
        for split, line in lines(data):
            for wanted, file in files:
                if split in (None, wanted):
                    file.write(line)


def wrong_metadata(data: Dataset, folder: Path) -> list[str]:
    """What is wrong with the files, a line each, but for maps that have no folder."""
    right = [hashlib.sha256() for _ in SPLITS]
    for whose, line in lines(data):
        for digest in right if whose is None else (right[whose],):
            digest.update(line)
    problems = []
    for split, path in paths(data):
        if (folder / path).parent.parent.is_dir():
            try:
                if digest_of(folder / path) != right[split].hexdigest():
                    problems.append(f"{path}: does not say what dataset.h5 does")
            except OSError as error:
                problems.append(f"{path}: cannot be read ({error.strerror})")
    return problems
