"""Tar files of samples in a row, a folder a map, as the package `webdataset` reads them.

A sample is three members of one key: `walking_00003.png`, `.cls` (the label) and `.json` (class,
numbers, split). Written by `tarfile`: the same data set makes the same bytes.
"""

import io
import json
import tarfile
from collections.abc import Iterator
from contextlib import closing
from pathlib import Path
from typing import Any

from radhar_cli.config.identity import as_yaml
from radhar_cli.dataset.card import compose_card
from radhar_cli.dataset.formats.stored_png import checked_png
from radhar_cli.dataset.layout import CARD, CLASSES, CONFIG, Rows
from radhar_cli.dataset.png import colour_table
from radhar_cli.dataset.reading import Dataset
from radhar_cli.dataset.table import Entry, entries, number_names
from radhar_cli.processes.progress import Progress

SHARD_BYTES, SHARD_SAMPLES = 2**28, 10_000  # most of a tar file
READING = """\
```python
import webdataset as wds

files = "{name}/train-{{000000..{last:06d}}}.tar"  # one folder a map
data = wds.WebDataset(files, shardshuffle=False).decode("pil").to_tuple("png", "cls", "json")
image, label, about = next(iter(data))  # colours; a place in classes.txt; about["class"]: its name
```

`datasets.load_dataset("FOLDER", "{name}")` reads them as well. Samples stand in turn, one of each
class; `json` has class, index, split and the numbers that were drawn."""


def write(data: Dataset, folder: Path, progress: Progress) -> None:
    """Write <map>/<split>-<number>.tar, classes.txt, card and resolved config into a folder."""
    last = 0
    for name in data.config.maps:
        (folder / name).mkdir()
        for split, part in data.present_splits.items():
            with closing(_Shards(folder / name, part)) as shards:
                for key, members in _samples(data, name, split):
                    shards.add(key, members)
                    progress.advance(1 if name == data.config.maps[0] else 0)
            last = shards.number if (split, name) == (0, data.config.maps[0]) else last
    configs = [
        {
            "config_name": name,
            "data_files": [
                {"split": part, "path": f"{name}/{part}-*.tar"}
                for part in data.present_splits.values()
            ],
        }
        for name in data.maps
    ]
    reading = READING.format(name=data.config.maps[0], last=last)
    (folder / CARD).write_text(compose_card(data, {"configs": configs}, reading), encoding="utf-8")
    (folder / CONFIG).write_text(as_yaml(data.config), encoding="utf-8")
    (folder / CLASSES).write_text("".join(f"{name}\n" for name in data.classes), encoding="utf-8")


def _samples(data: Dataset, map_name: str, split: int) -> Iterator[tuple[str, dict[str, bytes]]]:
    """(key, {ending: content}) of each sample of a split."""
    rows, names = Rows.of(data.config), number_names(data.config)
    colours, part = colour_table(data.config.image.colour_map), data.present_splits[split]
    for entry in entries(data):
        if entry.split != split:
            continue
        about = {"class": entry.label, "label": entry.number, "index": entry.place, "split": part}
        members = {
            "png": checked_png(data, colours, map_name, entry.row),
            "cls": str(entry.number).encode(),
            "json": json.dumps(about | _numbers(data, names, entry)).encode(),
        }
        yield f"{entry.label}_{rows.name(entry.row)}", members


def _numbers(data: Dataset, names: list[str], entry: Entry) -> dict[str, Any]:
    """Return the numbers drawn of a sample, by name; null where one does not apply."""
    numbers = {
        name: None if value != value else value
        for name, value in zip(names, entry.values, strict=True)
    }
    return numbers if data.labels is None else {"labels": entry.labels.split(), **numbers}


class _Shards:
    """Tar files of a split, one after the other; a sample never lies in two."""

    def __init__(self, folder: Path, part: str) -> None:
        self._folder, self._part = folder, part
        self.number, self._samples, self._bytes = 0, 0, 0
        self._file = self._open_next_file()

    def _open_next_file(self) -> tarfile.TarFile:
        path = self._folder / f"{self._part}-{self.number:06d}.tar"
        return tarfile.open(path, "w", format=tarfile.USTAR_FORMAT)

    def add(self, key: str, members: dict[str, bytes]) -> None:
        """Write a sample into the open file, or into the next one where it is full."""
        size = sum(map(len, members.values()))
        full = self._samples == SHARD_SAMPLES or self._bytes + size > SHARD_BYTES
        if full and self._samples:
            self._file.close()
            self.number += 1
            self._samples, self._bytes, self._file = 0, 0, self._open_next_file()
        for ending, content in members.items():
            member = tarfile.TarInfo(f"{key}.{ending}")  # of time 0, nobody's
            member.size = len(content)
            self._file.addfile(member, io.BytesIO(content))
        self._samples += 1
        self._bytes += size

    def close(self) -> None:
        """Finish the last file."""
        self._file.close()
