"""The labelled images of a data set for PyTorch."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import torch
from torch import Tensor
from torch.utils.data import Dataset

from radhar_cli.errors import ConfigError
from radhar_cli.learning.images.image_set import ImageSet, check_split_name
from radhar_cli.learning.images.opening import open_images
from radhar_cli.learning.registry import Kind


@dataclass(frozen=True, repr=False)
class LabelledImages(Dataset[tuple[Any, int]]):
    """Pairs (image, label) of one map: float32 [C, H, W] from 0 to 1, and a place in `classes`."""

    images: ImageSet
    transform: Callable[[Tensor], Any] | None

    @property
    def classes(self) -> tuple[str, ...]:
        """Names of the labels, the same in every split."""
        return self.images.classes

    def __len__(self) -> int:
        return len(self.images)

    def __getitem__(self, row: int) -> tuple[Any, int]:
        row = range(len(self))[row]  # of a negative number, and an IndexError beyond the end
        levels = self.images.pixels.read(row)
        image = torch.from_numpy(np.ascontiguousarray(levels.transpose(2, 0, 1))).float() / 255
        transformed = image if self.transform is None else self.transform(image)
        return transformed, int(self.images.samples.label[row])

    def __repr__(self) -> str:
        images = self.images
        shape = f"float32 {[images.channels, *images.size]}"
        of_map = "" if images.map is None else f" of map {images.map}"
        classes = ", ".join(self.classes)
        return f"<LabelledImages {images.where}: {len(self)} x {shape}{of_map}; classes {classes}>"


def torch_dataset(
    path: str | Path,
    map: str | None = None,
    split: str = "all",
    transform: Callable[[Tensor], Any] | None = None,
    *,
    input: Kind = "rgb",
) -> LabelledImages:
    """Labelled images of a data set, for a DataLoader with any number of workers.

    Every worker opens the file for itself.

    Args:
        path: folder that `radhar generate` wrote, dataset.h5, or a tree of class folders.
        map: map to read; None is the first one.
        split: train, val, test or all.
        transform: function of each image, float32 [C, H, W] from 0 to 1.
        input: rgb, 3 channels as the PNGs are coloured; or gray, the levels as 1 channel.

    Raises:
        ConfigError: no such split or input.
        FolderError: it is no data set, or has no such map or no image of that split; the message
            says what it has.
    """
    check_split_name(split)
    if input not in ("rgb", "gray"):
        raise ConfigError(f"input = {input!r}: should be rgb or gray")
    images = open_images(Path(path), map, input)
    images = images.take(images.rows(split))
    return LabelledImages(images, transform)
