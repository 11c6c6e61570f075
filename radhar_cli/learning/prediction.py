"""Predicted classes of images, which need no labels."""

from collections.abc import Iterator, Sequence
from pathlib import Path

import numpy as np
import torch

from radhar_cli.arrays import Index
from radhar_cli.errors import FolderError
from radhar_cli.learning.evaluation import open_for, predict_batches, rows_of
from radhar_cli.learning.images.folder import image_files, is_image, loose_images
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.images.opening import is_tree
from radhar_cli.learning.run_files import is_run
from radhar_cli.learning.run_folder import RunMetadata, load_best

BATCH = 32


def predict(
    run: Path,
    paths: Sequence[Path],
    device: torch.device,
    map_name: str | None,
    split: str,
    resize: bool = False,
) -> Iterator[tuple[str, dict[str, float]]]:
    """Yield (name, probability of every class) for every image.

    Args:
        paths: images, folders of images, or data sets.
        map_name: of a data set, if not the one of the run.
        split: of a data set.

    Raises:
        RunError: no such run.
        FolderError: an image that cannot be read, or of another size.
    """
    metadata, model = load_best(run)
    model.to(device)
    for path in paths:
        images, rows, names = _opened(metadata, path, map_name, split, resize)
        place = 0
        for probabilities, _ in predict_batches(model, metadata, images, rows, device, BATCH):
            for row in probabilities.tolist():
                yield names[place], dict(zip(metadata.classes, row, strict=True))
                place += 1


def _opened(
    metadata: RunMetadata, path: Path, map_name: str | None, split: str, resize: bool
) -> tuple[ImageSet, Index, list[str]]:
    """Images, which of them, and what to call them."""
    if not path.exists():
        raise FolderError(f"{path}: no such file or folder")
    if is_run(path):
        raise FolderError(f"{path}: is a training run; images or data are asked for here")
    files = [p for p in (path,) if is_image(p)]
    if is_tree(path):
        files = image_files(path, path)
    if files:
        return (
            loose_images(files, metadata.size, metadata.input, resize),
            np.arange(len(files)),
            list(map(str, files)),
        )
    images = open_for(metadata, path, map_name, labelled=False, resize=resize)
    rows, _ = rows_of(images, split)
    return images, rows, [f"{path}: {images.names[row]}" for row in rows]
