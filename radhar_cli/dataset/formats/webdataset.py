"""WebDataset: tar files of samples, each with a PNG a map, its class and what was drawn."""

import io
import json
import tarfile
from pathlib import Path
from typing import Any

from radhar_cli.config.schema import Config
from radhar_cli.dataset.card import data_files, number_features
from radhar_cli.dataset.formats.convert import checked_png, describe, files_of_split
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.png import colour_table
from radhar_cli.dataset.reading import Dataset
from radhar_cli.dataset.table import number_names
from radhar_cli.progress import Progress


def write(data: Dataset, folder: Path, progress: Progress) -> None:
    """Write <split>-<number>.tar with <class>-<index>.<map>.png, .cls and .json of each sample."""
    rows, names = Rows.of(data.config), number_names(data.config)
    table = colour_table(data.config.image.colour_map)
    for split, part in data.present_splits.items():
        for number, (_, here) in enumerate(files_of_split(data, split, len(data.maps))):
            path = folder / f"{part}-{number:06d}.tar"
            with tarfile.open(path, "w", format=tarfile.USTAR_FORMAT) as tar:
                for entry in here:
                    key = f"{entry.label}-{rows.name(entry.row)}"
                    values = (None if value != value else value for value in entry.values)
                    about = {"label": entry.label, "index": entry.place}
                    about |= {"labels": entry.labels} if data.config.people else {}
                    about |= dict(zip(names, values, strict=True))
                    for name in data.config.maps:
                        _add(tar, f"{key}.{name}.png", checked_png(data, table, name, entry.row))
                    _add(tar, f"{key}.cls", str(entry.number).encode())
                    _add(tar, f"{key}.json", json.dumps(about).encode())
                    progress.advance(1)
    files = {"default": {part: f"{part}-*.tar" for _, part in data.present_splits.items()}}
    loading = {
        "configs": data_files(files),
        "dataset_info": {"config_name": "default", "features": members(data.config)},
    }
    describe(data, folder, loading, _reading(data))


def members(config: Config) -> list[dict[str, Any]]:
    """Columns for `load_dataset`, which otherwise infers them from the first values."""
    return [
        *({"name": f"{name}.png", "dtype": "image"} for name in config.maps),
        {"name": "cls", "dtype": "int64"},
        {
            "name": "json",
            "struct": [{"name": "label", "dtype": "string"}, *number_features(config)],
        },
        {"name": "__key__", "dtype": "string"},
        {"name": "__url__", "dtype": "string"},
    ]


def _add(tar: tarfile.TarFile, name: str, data: bytes) -> None:
    """Add a file without owner and time: the same data set makes the same bytes."""
    info = tarfile.TarInfo(name)
    info.size = len(data)
    tar.addfile(info, io.BytesIO(data))


def _reading(data: Dataset) -> str:
    name = data.config.maps[0]
    return f"""\
```python
import io

import webdataset
from PIL import Image

train = webdataset.WebDataset("train-000000.tar", shardshuffle=False).decode()
sample = next(iter(train))    # "{name}.png" and other maps, "cls", "json"
image = Image.open(io.BytesIO(sample["{name}.png"]))
# numpy.asarray(image): grey levels; image.convert("RGB"): colours, as .decode("pil") gives them
```

`cls` is the label, a number; `json` has the name of the class as `label`, the index and the numbers
of the sample. Samples stand in turn, one of each class.
`datasets.load_dataset("FOLDER OR NAME ON THE HUB")` reads the same files."""
