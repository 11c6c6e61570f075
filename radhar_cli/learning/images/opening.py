"""Open labelled images by path: dataset.h5, its folder, or a tree of class folders."""

from dataclasses import replace
from pathlib import Path

from radhar_cli.dataset.layout import DATASET, is_incomplete
from radhar_cli.errors import FolderError
from radhar_cli.learning.images.folder import folder_images
from radhar_cli.learning.images.h5 import h5_images
from radhar_cli.learning.images.image_set import ImageSet, Resized
from radhar_cli.learning.run_files import is_run


def open_images(
    path: Path, map_name: str | None, kind: str, resize: tuple[int, int] | None = None
) -> ImageSet:
    """Open a data set: dataset.h5, a folder that `radhar generate` wrote, or a tree of images.

    Args:
        map_name: which map; the first one if None.
        kind: "rgb" as the PNGs are coloured, or "gray", one channel three times.
        resize: (H, W) to bring every image to; they may then differ in size.

    Raises:
        FolderError: it is none of these, or it is damaged.
    """
    if not path.exists():
        raise FolderError(f"{path}: no such file or folder")
    if is_run(path):
        raise FolderError(f"{path}: is a training run; data is asked for here")
    if not path.is_dir() and not is_h5(path):
        raise FolderError(
            f"{path}: is not a data set; should be dataset.h5, a folder that `radhar generate` "
            "wrote, or a folder of class folders with images"
        )
    if is_tree(path):
        images = folder_images(path, map_name, kind, any_size=resize is not None)
    else:
        images = h5_images(path, map_name, kind)
    if resize is None:
        return images
    return replace(images, size=resize, pixels=Resized(images.pixels, resize))


def is_tree(path: Path) -> bool:
    """Whether a path is a folder that holds no data set, finished or not: a tree of images."""
    return path.is_dir() and not is_h5(path) and not is_incomplete(path)


def is_h5(path: Path) -> bool:
    """Whether a path is a dataset.h5, or a folder that holds one."""
    if path.is_dir():
        return (path / DATASET).exists()
    return path.suffix.lower() in (".h5", ".hdf5") and path.exists()
