"""A data set in a format that other tools read; the new folder appears when it is whole."""

import hashlib
import os
import shutil
from collections.abc import Callable, Iterator, Mapping
from importlib import import_module
from itertools import islice
from math import prod
from pathlib import Path
from typing import Any, TypeAlias

from radhar_cli.arrays import Levels
from radhar_cli.config.identity import as_yaml
from radhar_cli.dataset.card import card, owner_licence
from radhar_cli.dataset.files import refuse_links
from radhar_cli.dataset.folder import folder_lock
from radhar_cli.dataset.gallery import gallery_png
from radhar_cli.dataset.layout import CARD, CONFIG, GALLERY
from radhar_cli.dataset.png import encode_png
from radhar_cli.dataset.reading import Dataset, open_dataset
from radhar_cli.dataset.table import Entry, entries
from radhar_cli.errors import FolderError, UnfinishedError
from radhar_cli.progress import Progress

# Module and function of each format.
FORMATS = {
    "webdataset": ("webdataset", "write"),
    "parquet": ("parquet", "write"),
    "mars": ("clouds", "write_mars"),
    "ros": ("clouds", "write_ros"),
    "ti": ("clouds", "write_ti"),
}
FILE_BYTES = 2**28  # of pixels per file
Writer: TypeAlias = Callable[[Dataset, Path, Progress], None]


def convert(path: Path, out: Path, to: str, progress: Progress) -> int:
    """Write a data set in another format; return its number of samples.

    Raises:
        FolderError: the data set cannot be read or is damaged, there is something at `out`, or
            another run is making it.
        UnfinishedError: `out` cannot be written.
    """
    if out.exists() or out.is_symlink():
        raise FolderError(f"{out}: already exists; -o should name a new folder")
    module, function = FORMATS[to]
    write: Writer = getattr(import_module(f"radhar_cli.dataset.formats.{module}"), function)
    with open_dataset(path) as data:
        if module == "clouds" and "points" not in data.products:
            raise FolderError(
                f"{path}: has no points; {to} needs a board's data set, maps: [points]"
            )
        owner_licence(data.path.parent)  # refused before anything is written
        scratch = out.absolute().with_name(f".{out.name}.unfinished")
        refuse_links(scratch.parent, scratch)
        unfinished = scratch / "set"
        with folder_lock(scratch):
            shutil.rmtree(unfinished, ignore_errors=True)  # of a run that was killed
            try:
                unfinished.mkdir()
                progress.stage(to, len(data), 0)
                write(data, unfinished, progress)
                unfinished.rename(out)
            except OSError as error:  # its name is one in the scratch folder, or none
                why = os.strerror(error.errno) if error.errno else error
                raise UnfinishedError(f"{out}: {why}; nothing was written") from None
            finally:
                shutil.rmtree(scratch, ignore_errors=True)
        return len(data)


def checked_png(data: Dataset, table: Levels, map_name: str, row: int) -> bytes:
    """The PNG file of a sample with a colour table [256, 3], as `generate` writes it.

    Raises:
        FolderError: its levels are not those that were stored.
    """
    name = f"maps/{map_name}"
    levels, stored = data.large[name][row], data.sha256[name].rows(row, row + 1)[0]
    if hashlib.sha256(levels.tobytes()).hexdigest().encode() != stored:
        raise FolderError(f"{data.path}: /{name}[{row}]: does not match its checksum")
    return encode_png(levels, table, data.config.output.png_level)


def files_of_split(data: Dataset, split: int, maps: int) -> Iterator[tuple[int, Iterator[Entry]]]:
    """The files that a split is cut into: how many there are, and the samples of each.

    Args:
        maps: images of each sample in a file.
    """
    count = int((data.split == split).sum())
    most = max(1, FILE_BYTES // (maps * prod(data.config.image.size_px)))
    here = (entry for entry in entries(data) if entry.split == split)
    files = -(-count // most)
    for _ in range(files):
        yield files, islice(here, most)


def describe(data: Dataset, folder: Path, loading: Mapping[str, Any], reading: str) -> None:
    """Write the card of a converted data set, its picture and the resolved config.

    Args:
        loading: front matter that `load_dataset` reads; none where that cannot read the format.
    """
    front = {**loading, **owner_licence(data.path.parent)}
    (folder / CARD).write_text(card(data, front, reading), encoding="utf-8")
    (folder / GALLERY).write_bytes(gallery_png(data))
    (folder / CONFIG).write_text(as_yaml(data.config), encoding="utf-8")
