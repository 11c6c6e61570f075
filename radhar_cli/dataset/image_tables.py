"""Files beside the PNGs: names of the labels, and a table of the images of each split.

`classes.txt` has the names of the labels, a line each in their order. A `metadata.csv` for each map
and split makes the folder one that `datasets.load_dataset` opens as it is (format `imagefolder`).
"""

import csv
import io
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from radhar_cli.config.data_set import AnyConfig
from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.layout import CLASSES, METADATA, PNG, SPLIT_FOLDERS, SPLITS, Rows
from radhar_cli.files.replacing import refuse_links
from radhar_cli.numerics.arrays import Levels

COLUMNS = ("file_name", "label", "class", "index")


def image_tables(config: AnyConfig, split: Levels) -> Iterator[tuple[Path, bytes]]:
    """Yield (path inside the output folder, text) of every file that belongs beside the PNGs.

    Args:
        config: that of the data set.
        split: number of the split of each row [N].
    """
    rows = Rows.of(config)
    names = "".join(f"{name}\n" for name in rows.names).encode()
    tables = {number: _table(rows, split, number) for number in np.unique(split).tolist()}
    for name in config.maps:
        yield Path(PNG, name, CLASSES), names
        for number, text in tables.items():
            yield Path(PNG, name, SPLIT_FOLDERS[number], METADATA), text


def write_missing_tables(config: AnyConfig, folder: Path, split: Levels) -> None:
    """Write the files that are missing beside the PNGs of an output folder."""
    for path, text in image_tables(config, split):
        refuse_links(folder, folder / path)
        if not (folder / path).exists():
            write_whole(folder, folder / path, text)


def hub_configs(config: AnyConfig, split: Levels) -> list[dict[str, Any]]:
    """Front matter of the data card, in which `load_dataset` finds maps, splits and labels."""
    label = {
        "class_label": {"names": {str(n): name for n, name in enumerate(Rows.of(config).names)}}
    }
    kinds: dict[str, Any] = {"image": "image", "label": label, "class": "string", "index": "int64"}
    features = [{"name": name, "dtype": kind} for name, kind in kinds.items()]
    numbers = np.unique(split).tolist()
    return [
        {
            "config_name": name,
            "data_files": [
                {"split": SPLITS[number], "path": f"{PNG}/{name}/{SPLIT_FOLDERS[number]}/**"}
                for number in numbers
            ],
            "features": features,
        }
        for name in config.maps
    ]


def _table(rows: Rows, split: Levels, number: int) -> bytes:
    """Text of metadata.csv for the split of that number."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(COLUMNS)
    label = rows.label
    for row in np.flatnonzero(split == number).tolist():
        activity, index = rows[row]
        writer.writerow((rows.file_name(row), label[row], activity.slug, index))
    return text.getvalue().encode()
