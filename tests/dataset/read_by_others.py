"""Read what radhar wrote with `datasets`, torchvision and `webdataset`; print what they saw.

A program of its own: they take seconds to import.
"""

import hashlib
import json
import sys
from io import BytesIO
from pathlib import Path

import datasets
import numpy as np
import webdataset
from PIL import Image

from radhar_cli.learning.models.timm_networks import load_timm

load_timm()  # torchvision's operators may be of another PyTorch
from torchvision.datasets import ImageFolder  # noqa: E402


def digest(levels):
    return hashlib.sha256(np.asarray(levels).tobytes()).hexdigest()


def hub(folder, name, columns=("image", "label", "index")):
    """What load_dataset makes of a folder."""
    found = datasets.load_dataset(str(folder), name)
    parts = {}
    for split, rows in found.items():
        assert list(rows.features)[: len(columns)] == list(columns)
        parts[split] = [
            {
                **row,
                "image": digest(row["image"]),
                "number": row["label"],
                "label": rows.features["label"].int2str(row["label"]),
            }
            for row in rows
        ]
    return {"parts": parts, "labels": rows.features["label"].names}


def image_folder(folder, name):
    """(label, class, index) of a map's folder, which `datasets` knows by metadata.csv."""
    found = datasets.load_dataset("imagefolder", data_dir=str(folder / "png" / name))
    return {
        split: [(row["label"], row["class"], row["index"], digest(row["image"])) for row in rows]
        for split, rows in found.items()
    }


def tree(folder):
    """(file, class, label by the line of the data card) of what ImageFolder reads."""
    found = ImageFolder(str(folder))
    names = (folder.parent / "classes.txt").read_text().split()
    found.target_transform = [names.index(name) for name in found.classes].__getitem__
    labels = [found[row][1] for row in range(len(found))]
    return [
        (str(Path(path).relative_to(folder)), found.classes[number], label)
        for (path, number), label in zip(found.samples, labels, strict=True)
    ]


def tars(folder, part):
    """What `webdataset` makes of the tar files of a split, in order."""
    files = sorted(map(str, folder.glob(f"{part}-*.tar")))
    read = webdataset.WebDataset(files, shardshuffle=False).decode()
    return [
        {
            **one["json"],
            "key": one["__key__"],
            "cls": one["cls"],
            "image": digest(Image.open(BytesIO(one["png"]))),
        }
        for one in read
    ]


if __name__ == "__main__":
    datasets.disable_progress_bars()
    place = Path(sys.argv[1])
    maps = ("rtm", "stft")
    of_set = ("image", "label", "class", "index")
    print(
        json.dumps(
            {
                "parquet": {name: hub(place / "parquet", name) for name in maps},
                "set": {name: hub(place / "set", name, of_set) for name in maps},
                "imagefolder": image_folder(place / "set", "stft"),
                "tree": tree(place / "set/png/stft/train"),
                "tars": {
                    part: tars(place / "tars/stft", part)
                    for part in ("train", "validation", "test")
                },
                "tars_by_hub": len(datasets.load_dataset(str(place / "tars"), "rtm")["train"]),
            }
        )
    )
