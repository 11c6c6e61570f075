"""What `radhar inspect` and `radhar preview` show of a tree of images."""

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from radhar_cli.arrays import Levels
from radhar_cli.dataset.image_file import image_size
from radhar_cli.dataset.layout import SPLITS
from radhar_cli.learning.images.folder import FilePixels
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.images.opening import open_images


def summarise_tree(root: Path) -> dict[str, Any]:
    """Count the images of a tree by class, split and size; pixels are not read.

    Raises:
        FolderError: it is no such tree, or a file is not an image.
    """
    images = open_images(root, None, "rgb")
    assert isinstance(images.pixels, FilePixels)
    files = images.pixels.files
    sizes = Counter(map(image_size, files))

    def counts(label: int) -> dict[str, int]:
        mine = images.label == label
        if images.split is None:
            return {"images": int(mine.sum())}
        by_split = np.bincount(images.split[mine], minlength=len(SPLITS))
        return dict(zip(SPLITS, by_split.tolist(), strict=True))

    return {
        "kind": "tree of images",
        "path": str(root),
        "samples": len(images),
        "bytes": sum(file.stat().st_size for file in files),
        "map": images.map,
        "sizes": [{"size": list(size), "images": n} for size, n in sizes.most_common()],
        "classes": {name: counts(number) for number, name in enumerate(images.classes)},
    }


def first_of_each(images: ImageSet, per_class: int, classes: int) -> dict[str, list[Levels]]:
    """The first RGB images of the first classes."""
    return {
        name: [
            images.pixels.read(int(row))
            for row in np.flatnonzero(images.label == label)[:per_class]
        ]
        for label, name in enumerate(images.classes[:classes])
    }
