"""Parquet files with the images in them, a folder a map, as the Hugging Face Hub keeps them."""

import json
from itertools import islice
from math import prod
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq

from radhar_cli.config.schema import Config
from radhar_cli.dataset.card import configurations, number_features
from radhar_cli.dataset.formats.convert import checked_png, describe, files_of_split
from radhar_cli.dataset.hub import loading
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.png import colour_table
from radhar_cli.dataset.reading import Dataset
from radhar_cli.dataset.table import Entry
from radhar_cli.progress import Progress

GROUP, GROUP_BYTES = 256, 2**26  # samples and bytes of pixels per row group


def write(data: Dataset, folder: Path, progress: Progress) -> None:
    """Write <map>/<split>-<number>-of-<files>.parquet."""
    schema = schema_of(data.config)
    group = max(1, min(GROUP, GROUP_BYTES // prod(data.config.image.size_px)))
    for name in data.config.maps:
        (folder / name).mkdir()
        for split, part in data.present_splits.items():
            for number, (files, here) in enumerate(files_of_split(data, split, 1)):
                path = folder / name / f"{part}-{number:05d}-of-{files:05d}.parquet"
                with pq.ParquetWriter(path, schema, use_dictionary=False) as file:
                    while some := list(islice(here, group)):
                        file.write_table(_table(data, name, some, schema))
                        progress.advance(len(some) if name == data.config.maps[0] else 0)
    parts = data.present_splits.values()
    files_of = {n: {part: f"{n}/{part}-*.parquet" for part in parts} for n in data.maps}
    configs = configurations(data.config, files_of)
    reading = "Samples stand in turn, one of each class. `image.bytes` of a row is a PNG file."
    reading = f"{loading(data.config.maps[0])}\n\n{reading}"
    describe(data, folder, {"configs": configs}, reading)


def schema_of(config: Config) -> pa.Schema:
    """Columns, and what `datasets` makes of them."""
    kinds = {one["name"]: one["dtype"] for one in number_features(config)}
    image = pa.struct([("bytes", pa.binary()), ("path", pa.string())])
    columns = [("image", image), ("label", pa.int64())]
    features = {
        "image": {"_type": "Image"},
        "label": {"names": [a.slug for a in config.every_class], "_type": "ClassLabel"},
        **{name: {"dtype": kind, "_type": "Value"} for name, kind in kinds.items()},
    }
    metadata = json.dumps({"info": {"features": features}})
    numbers = [(name, pa.type_for_alias(kind)) for name, kind in kinds.items()]
    return pa.schema([*columns, *numbers], metadata={"huggingface": metadata})


def _table(data: Dataset, name: str, here: list[Entry], schema: pa.Schema) -> pa.Table:
    rows, numbers = Rows.of(data.config), zip(*(entry.values for entry in here), strict=True)
    colours = colour_table(data.config.image.colour_map)
    images = [
        {"bytes": checked_png(data, colours, name, one.row), "path": rows.file_name(one.row)}
        for one in here
    ]
    columns = [
        images,
        [entry.number for entry in here],
        [entry.place for entry in here],
        *([[entry.labels for entry in here]] if data.config.people else []),
        *([None if v != v else v for v in values] for values in numbers),
    ]
    arrays = [pa.array(c, f.type) for c, f in zip(columns, schema, strict=True)]
    return pa.Table.from_arrays(arrays, schema=schema)
