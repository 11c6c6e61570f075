"""Samples of a data set for the writers of other formats; a damaged sample is refused."""

import hashlib
from collections.abc import Iterator, Mapping
from itertools import islice
from math import prod
from pathlib import Path
from typing import Any

from numpy.typing import NDArray

from radhar_cli.config.identity import as_yaml
from radhar_cli.dataset.card import card, owner_licence
from radhar_cli.dataset.gallery import gallery_png
from radhar_cli.dataset.layout import CARD, CONFIG, GALLERY
from radhar_cli.dataset.png import colour_table, encode_png
from radhar_cli.dataset.reading import Dataset
from radhar_cli.dataset.table import Entry, entries
from radhar_cli.errors import FolderError

FILE_BYTES = 2**28  # of pixels per file


class Samples:
    """The large arrays of a data set, each compared with its checksum, and their PNGs."""

    def __init__(self, data: Dataset) -> None:
        self._data = data
        self._table = colour_table(data.config.image.colour_map)

    def array(self, name: str, row: int) -> NDArray[Any]:
        """A sample of a large dataset, such as maps/stft.

        Raises:
            FolderError: it is not what was stored.
        """
        values = self._data.large[name][row]
        stored = self._data.sha256[name].rows(row, row + 1)[0]
        if hashlib.sha256(values.tobytes()).hexdigest().encode() != stored:
            raise FolderError(f"{self._data.path}: /{name}[{row}]: does not match its checksum")
        return values

    def png(self, map_name: str, row: int) -> bytes:
        """The PNG file of a sample, as `generate` writes it."""
        levels = self.array(f"maps/{map_name}", row)
        return encode_png(levels, self._table, self._data.config.output.png_level)


def files_of_split(data: Dataset, split: int, maps: int) -> Iterator[tuple[int, Iterator[Entry]]]:
    """The files that a split is cut into: how many there are, and the samples of each.

    Args:
        data: the data set.
        split: number of it.
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
        data: the data set; its own card says the licence.
        folder: to write to.
        loading: front matter that `load_dataset` reads; none where that cannot read the format.
        reading: Markdown, how to read the files next to the card.
    """
    front = {**loading, **owner_licence(data.path.parent)}
    (folder / CARD).write_text(card(data, front, reading), encoding="utf-8")
    (folder / GALLERY).write_bytes(gallery_png(data))
    (folder / CONFIG).write_text(as_yaml(data.config), encoding="utf-8")
