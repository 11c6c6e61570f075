"""Read what radhar wrote with `datasets`, `webdataset` and torchvision; print what they saw.

A program of its own: the three take seconds to import.
"""

import contextlib
import hashlib
import json
import sys
from pathlib import Path
from typing import Any

import datasets
import numpy as np
import webdataset

from radhar_cli.learning.models.zoo import load_timm

load_timm()  # torchvision's operators may be of another PyTorch
from torchvision.datasets import ImageFolder  # noqa: E402


def digest(levels):
    return hashlib.sha256(np.asarray(levels).tobytes()).hexdigest()


def hub(folder, name):
    """What load_dataset makes of a folder."""
    found = datasets.load_dataset(str(folder), name)
    parts = {}
    for split, rows in found.items():
        assert list(rows.features)[:3] == ["image", "label", "index"]
        parts[split] = [
            {
                **row,
                "image": digest(row["image"]),
                "label": rows.features["label"].int2str(row["label"]),
            }
            for row in rows
        ]
    return {"parts": parts, "labels": rows.features["label"].names}


def tars(folder):
    """What webdataset reads."""
    parts = {}
    for split in ("train", "validation", "test"):
        files = sorted(map(str, folder.glob(f"{split}-*.tar")))
        made = webdataset.WebDataset(files, shardshuffle=False, empty_check=False).decode()
        parts[split] = [
            {
                "key": one["__key__"],
                "cls": one["cls"],
                "json": one["json"],
                "stft": hashlib.sha256(one["stft.png"]).hexdigest(),
            }
            for one in made
        ]
    return parts


def snippet(folder):
    """Key and image of the sample that the Python of a card reads."""
    _, code, _ = (folder / "README.md").read_text().replace("```python", "```").split("```", 2)
    held: dict[str, Any] = {}
    with contextlib.chdir(folder):
        exec(code, held)
    return [held["sample"]["__key__"], digest(held["image"])]


def tree(folder):
    """(file, class) of what ImageFolder reads."""
    found = ImageFolder(str(folder))
    return [(str(Path(p).relative_to(folder)), found.classes[n]) for p, n in found.samples]


if __name__ == "__main__":
    datasets.disable_progress_bars()
    place = Path(sys.argv[1])
    in_tars = datasets.load_dataset(str(place / "webdataset"))
    print(
        json.dumps(
            {
                "folder": {name: hub(place / "set", name) for name in ("rtm", "stft")},
                "parquet": {name: hub(place / "parquet", name) for name in ("rtm", "stft")},
                "tars": tars(place / "webdataset"),
                "hub_tars": {
                    split: [[row["cls"], row["json"], digest(row["stft.png"])] for row in rows]
                    for split, rows in in_tars.items()
                },
                "snippet": snippet(place / "webdataset"),
                "tree": tree(place / "set/png/stft/train"),
            }
        )
    )
