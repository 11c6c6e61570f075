"""Recipe of a published set: its takes, found by the names of files, and facts about the set."""

import os
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import refuse_outside
from radhar_cli.schema.section import Section

DEEPEST = 8  # folders below the one that is given
MAX_FILES = 2_000_000


class NoSettings(Section):
    """Settings of a recipe that asks for nothing."""


class Take(NamedTuple):
    """One recording of a set.

    Attributes:
        name: Its own name, with folders, `campaign/1P36A01R01`.
        sources: Files that it is made of.
        write: Writes it under a path, with its labels and persons; a function that can be pickled.
        split: train, validation or test, if the authors state it.
    """

    name: str
    sources: tuple[Path, ...]
    write: Callable[[Path], object]
    split: str | None = None


@dataclass(frozen=True)
class SetRecipe:
    """Steps from a published set to a data set.

    Attributes:
        source: Publisher and address of the set.
        licence: As the Hugging Face Hub calls it; "" where none is stated.
        holds: Size, classes and persons, in words.
        tested: Data that the recipe was tried on, in words.
        layout: Files that should lie in the folder, as a message shows them.
        config: Keys of the config of its data set that differ from the defaults.
        list_takes: Lists the takes of a folder by its settings.
        find_manifest: Finds what `radhar generate --recordings` takes as it stands, in place of
            `list_takes`.
        settings: Keys that the user has to give, by `--set`.
        count: Number of takes of the whole set; None where it is not known.
    """

    source: str
    licence: str
    holds: str
    tested: str
    layout: str
    config: Mapping[str, Any]
    list_takes: Callable[[Path, Any], Iterable[Take]] | None = None
    find_manifest: Callable[[Path], Path] | None = None
    settings: type[Section] = NoSettings
    count: int | None = None


BY_PERSON = {"by": "subject", "subjects": 1, "train": 0.7, "validation": 0.15, "test": 0.15}
CLOUDS: dict[str, Any] = {
    "maps": ["points"],
    "image": {"size_px": 64},
    "recordings": {"window_s": 2.0, "hop_s": 2.0},
}


class MatchedFile(NamedTuple):
    """A file of a folder, and the match of its path."""

    path: Path
    inner: str  # path from the folder on, with slashes
    match: re.Match[str]


def find_files(folder: Path, pattern: str) -> Iterator[MatchedFile]:
    """Yield the files below a folder whose paths from there on end in a pattern, in their order.

    Case does not matter. No link is followed out of the folder.

    Args:
        pattern: Regular expression of the last parts of a path, with slashes.

    Raises:
        CaptureError: there are too many files.
        FolderError: a file that matches is a link that leads out of the folder.
    """
    expression = re.compile(rf"(?:.*/)?{pattern}", re.IGNORECASE)
    inner_paths, count = list[str](), 0
    for place, folders, names in os.walk(folder):
        depth = len(Path(place).relative_to(folder).parts)
        folders[:] = sorted(folders) if depth < DEEPEST else []
        count += len(names)
        if count > MAX_FILES:
            raise CaptureError(f"{folder}: holds more than {MAX_FILES} files; name a part of it")
        inner_paths += [Path(place, name).relative_to(folder).as_posix() for name in names]
    for inner in sorted(inner_paths):
        if match := expression.fullmatch(inner):
            refuse_outside(folder / inner, folder)
            yield MatchedFile(folder / inner, inner, match)


def as_name(text: str) -> str:
    """Name of a recording, from a path: letters, digits, dots and the like, and slashes."""
    return re.sub(r"[^\w./+-]", "_", text).strip("/.")
