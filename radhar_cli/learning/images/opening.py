"""Open labelled images by path: dataset.h5, its folder, or a tree; summary of one for `inspect`."""

from collections import Counter
from pathlib import Path
from typing import Any

import numpy as np

from radhar_cli.dataset.image_file import image_size
from radhar_cli.dataset.layout import DATASET, SPLITS, is_incomplete
from radhar_cli.dataset.radar_folders import describe_missing, refuse_several_radars
from radhar_cli.errors import FolderError
from radhar_cli.learning.images.folder import FilePixels, open_tree
from radhar_cli.learning.images.h5 import open_h5_images, open_h5_sequences
from radhar_cli.learning.images.image_set import ImageSet, resized
from radhar_cli.learning.images.windows import cut_windows
from radhar_cli.learning.registry import Kind, sequences_of
from radhar_cli.learning.run_files import is_run
from radhar_cli.learning.settings import TrainConfig


def open_inputs(
    path: Path,
    map_name: str | None,
    config: TrainConfig,
    resize: tuple[int, int] | None = None,
) -> ImageSet:
    """Open the inputs of the network of a config: images, or sequences of a dataset.h5.

    Args:
        path: data set, or tree of images.
        map_name: map or product to open; None takes the first one.
        config: model, kind of input, frames and points.
        resize: (H, W) to bring every image to.

    Raises:
        FolderError: data that cannot be used.
    """
    if sequences_of(config.model) is None:
        images = open_images(path, map_name, config.input, resize)
        return images if config.window is None else cut_windows(images, config.window)
    if resize is not None:
        raise FolderError(f"--resize: {config.model} reads {config.input_kind}, which have no size")
    if not is_h5(path):
        raise FolderError(
            f"{path}: is no data set with {config.input_kind}, which {config.model} reads"
        )
    return open_h5_sequences(path, map_name, config.input_kind, config.frames, config.points)


def open_images(
    path: Path, map_name: str | None, kind: Kind, resize: tuple[int, int] | None = None
) -> ImageSet:
    """Open a data set: dataset.h5, a folder that `radhar generate` wrote, or a tree of images.

    Args:
        path: dataset.h5, or a folder.
        map_name: map to open; None takes the first one.
        kind: "rgb" as the PNGs are coloured, or "gray", the levels as one channel.
        resize: (H, W) to bring every image to; they may then differ in size.

    Raises:
        FolderError: it is no data set, is damaged, or has no such map.
    """
    if not path.exists():
        raise FolderError(f"{path}: {describe_missing(path)}")
    if is_run(path):
        raise FolderError(f"{path}: is a training run; data is asked for here")
    if not path.is_dir() and not is_h5(path):
        raise FolderError(
            f"{path}: is not a data set; should be dataset.h5, a folder that `radhar generate` "
            "wrote, or a folder of class folders with images"
        )
    if is_tree(path):
        images = open_tree(path, map_name, kind, any_size=resize is not None)
    else:
        images = open_h5_images(path, map_name, kind)
    return images if resize is None else resized(images, resize)


def is_tree(path: Path) -> bool:
    """Whether a path is a folder that holds no data set, finished or not: a tree of images.

    Raises:
        FolderError: it holds data sets of several radars.
    """
    refuse_several_radars(path)
    return path.is_dir() and not is_h5(path) and not is_incomplete(path)


def is_h5(path: Path) -> bool:
    """Whether a path is a dataset.h5, or a folder that holds one."""
    if path.is_dir():
        return (path / DATASET).exists()
    return path.suffix.lower() in (".h5", ".hdf5") and path.exists()


def summarise_tree(root: Path) -> dict[str, Any]:
    """Numbers of images of a tree by class, split and size, for `inspect`; pixels are not read."""
    images = open_tree(root, None, "rgb", looks_at_colours=False)
    assert isinstance(images.pixels, FilePixels)
    files = images.pixels.files
    sizes = Counter(map(image_size, files))

    def counts(label: int) -> dict[str, int]:
        in_class = images.samples.label == label
        if images.samples.split is None:
            return {"images": int(in_class.sum())}
        by_split = np.bincount(images.samples.split[in_class], minlength=len(SPLITS))
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
