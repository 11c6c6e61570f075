"""Parquet files with the images in them, a folder a map, as the Hugging Face Hub keeps them."""

from collections.abc import Iterator
from itertools import islice
from math import prod
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from radhar_cli.config.data_set import AnyConfig
from radhar_cli.config.identity import as_yaml
from radhar_cli.dataset.card import compose_card
from radhar_cli.dataset.formats.stored_png import checked_png
from radhar_cli.dataset.layout import CARD, CONFIG, Rows
from radhar_cli.dataset.png import colour_table
from radhar_cli.dataset.reading import Dataset
from radhar_cli.dataset.table import Entry, entries, number_names
from radhar_cli.processes.progress import Progress

FILE_BYTES = 2**28  # of pixels per file
GROUP, GROUP_BYTES = 256, 2**26  # samples and bytes of pixels per row group
READING = """\
```python
from datasets import load_dataset

data = load_dataset("FOLDER OR NAME ON THE HUB", "{}")  # one configuration a map
sample = data["train"][0]
sample["image"]  # numpy.asarray(...): grey levels; .convert("RGB"): colours
```

Samples stand in turn, one of each class. `image.bytes` of a row is a PNG file."""


def write(data: Dataset, folder: Path, progress: Progress) -> None:
    """Write <map>/<split>-<number>-of-<files>.parquet, card and resolved config into a folder."""
    schema = schema_of(data.config)
    group = max(1, min(GROUP, GROUP_BYTES // prod(data.config.image.size_px)))
    for name in data.config.maps:
        (folder / name).mkdir()
        for split, part in data.present_splits.items():
            for number, (files, samples) in enumerate(_files_of_split(data, split)):
                path = folder / name / f"{part}-{number:05d}-of-{files:05d}.parquet"
                with pq.ParquetWriter(path, schema, use_dictionary=False) as file:
                    while rows := list(islice(samples, group)):
                        file.write_table(_table(data, name, rows, schema))
                        progress.advance(len(rows) if name == data.config.maps[0] else 0)
    parts = data.present_splits.values()
    names = {str(label): name for label, name in enumerate(data.classes)}
    label = {"name": "label", "dtype": {"class_label": {"names": names}}}
    features = [{"name": "image", "dtype": "image"}, label, *_number_features(data.config)]
    configs = [
        {
            "config_name": name,
            "data_files": [{"split": part, "path": f"{name}/{part}-*.parquet"} for part in parts],
            "features": features,
        }
        for name in data.maps
    ]
    reading = READING.format(data.config.maps[0])
    (folder / CARD).write_text(compose_card(data, {"configs": configs}, reading), encoding="utf-8")
    (folder / CONFIG).write_text(as_yaml(data.config), encoding="utf-8")


def _files_of_split(data: Dataset, split: int) -> Iterator[tuple[int, Iterator[Entry]]]:
    """The files that a split is cut into: how many there are, and the samples of each."""
    file_samples = max(1, FILE_BYTES // prod(data.config.image.size_px))
    samples = (entry for entry in entries(data) if entry.split == split)
    files = -(-int((data.split == split).sum()) // file_samples)
    for _ in range(files):
        yield files, islice(samples, file_samples)


def _number_features(config: AnyConfig) -> list[dict[str, str]]:
    """Columns of numbers, as `datasets` writes them down: index, and drawn numbers."""
    kinds = {"index": "int64"} | ({"labels": "string"} if config.people else {})
    kinds |= {n: "int64" if n == "subject" else "float64" for n in number_names(config)}
    return [{"name": name, "dtype": kind} for name, kind in kinds.items()]


def schema_of(config: AnyConfig) -> pa.Schema:
    """Columns of the Parquet files; the card says what `datasets` makes of them."""
    kinds = {feature["name"]: feature["dtype"] for feature in _number_features(config)}
    image = pa.struct([("bytes", pa.binary()), ("path", pa.string())])
    columns = [("image", image), ("label", pa.int64())]
    return pa.schema([*columns, *((name, pa.type_for_alias(kind)) for name, kind in kinds.items())])


def _table(data: Dataset, name: str, samples: list[Entry], schema: pa.Schema) -> pa.Table:
    """Table of samples with their images of a map, a row group of a file."""
    rows, numbers = Rows.of(data.config), zip(*(entry.values for entry in samples), strict=True)
    colours = colour_table(data.config.image.colour_map)
    images = [
        {"bytes": checked_png(data, colours, name, entry.row), "path": rows.file_name(entry.row)}
        for entry in samples
    ]
    columns = [
        images,
        [entry.number for entry in samples],
        [entry.place for entry in samples],
        *([[entry.labels for entry in samples]] if data.config.people else []),
        *([None if v != v else v for v in values] for values in numbers),
    ]
    arrays = [pa.array(column, field.type) for column, field in zip(columns, schema, strict=True)]
    return pa.Table.from_arrays(arrays, schema=schema)
