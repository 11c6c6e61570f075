"""Read what radhar wrote with `datasets` and torchvision; print what they saw.

A program of its own: the two take seconds to import.
"""

import hashlib
import json
import sys
from pathlib import Path

import datasets
import numpy as np

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


def tree(folder):
    """(file, class) of what ImageFolder reads."""
    found = ImageFolder(str(folder))
    return [(str(Path(p).relative_to(folder)), found.classes[n]) for p, n in found.samples]


if __name__ == "__main__":
    datasets.disable_progress_bars()
    place = Path(sys.argv[1])
    print(
        json.dumps(
            {
                "parquet": {name: hub(place / "parquet", name) for name in ("rtm", "stft")},
                "tree": tree(place / "set/png/stft/train"),
            }
        )
    )
