"""Labelled images, whoever stored them: one dataset.h5, or a tree of class folders."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from radhar_cli.activity import ACTIVITIES
from radhar_cli.arrays import Index, Levels
from radhar_cli.dataset.layout import SPLITS
from radhar_cli.dataset.split import TRAIN, VALIDATION
from radhar_cli.errors import FolderError, did_you_mean
from radhar_cli.randomness import TRAINING, stream

SPLIT_NAMES = {"train": 0, "val": 1, "validation": 1, "valid": 1, "test": 2}


class Pixels(Protocol):
    """Where pixels come from; may be handed to another process."""

    def read(self, row: int) -> Levels:
        """RGB [H, W, 3] of a row.

        Raises:
            FolderError: it cannot be read; the message names the file.
        """


@dataclass(frozen=True)
class ImageSet:
    """Images of one size, each with a class and a split.

    Attributes:
        where: the file or folder they came from.
        map: name of the map, None for a tree that names none.
        classes: names of the classes that are present, in the order of S1 to S12 where they are
            ours, else by the alphabet.
        label: [N] index into `classes`.
        split: [N] 0 train, 1 validation, 2 test; None where the source does not say.
        names: [N] what a reader calls each image.
        scenes: [N] fingerprint of the person and the motion, None where the source does not say.
        size: (H, W) in pixels.
        pixels: reads them.
        snr_db: of all of them, None where they differ or the source does not say.
    """

    where: Path
    map: str | None
    classes: tuple[str, ...]
    label: Index
    split: Levels | None
    names: tuple[str, ...]
    scenes: tuple[str, ...] | None
    size: tuple[int, int]
    pixels: Pixels
    snr_db: float | None = None

    def __len__(self) -> int:
        return len(self.label)

    def rows(self, split: str) -> Index:
        """Rows of a split: train, val, test or all.

        Raises:
            FolderError: there are none.
        """
        if split == "all" or (self.split is None and split != "train"):
            return np.arange(len(self))
        if self.split is None:
            raise FolderError(f"{self.where}: has no train folder")
        found = np.flatnonzero(self.split == SPLIT_NAMES[split])
        if not found.size:
            counts = np.bincount(self.split, minlength=3)
            has = ", ".join(f"{n} {name}" for n, name in zip(counts, SPLITS, strict=True) if n)
            raise FolderError(f"{self.where}: has no {split} images (it has {has})")
        return found

    def cut(self, share: float, seed: int) -> "ImageSet":
        """The same images, cut class by class into train and validation where nobody has cut."""
        if self.split is not None:
            return self
        split = np.full(len(self), TRAIN, dtype=np.uint8)
        for index, name in enumerate(self.classes):
            mine = np.flatnonzero(self.label == index)
            order = stream(seed, TRAINING, name=f"cut {name}").permutation(mine.size)
            held_out = max(1, round(share * mine.size))
            split[mine[order[:held_out]]] = VALIDATION
        return replace(self, split=split)


@dataclass(frozen=True)
class Scan:
    """What one look at every pixel of a set tells.

    Attributes:
        prints: [rows] fingerprint of each image's pixels.
        histogram: [3, 256] how often each level occurs in each channel.
    """

    prints: tuple[str, ...]
    histogram: NDArray[np.int64]

    @property
    def mean(self) -> tuple[float, ...]:
        """Mean of each channel, of levels from 0 to 1."""
        return tuple(_moment(counts, 1) for counts in self.histogram)

    @property
    def sd(self) -> tuple[float, ...]:
        """Standard deviation of each channel, 1 where it is constant."""
        spread = (_moment(c, 2) - _moment(c, 1) ** 2 for c in self.histogram)
        return tuple(float(np.sqrt(s)) if s > 1e-12 else 1.0 for s in spread)


def _moment(counts: NDArray[np.int64], power: int) -> float:
    levels = np.arange(256, dtype=np.int64) ** power
    mean: float = int(counts @ levels) / (int(counts.sum()) * 255**power)
    return mean


def scan(images: ImageSet, rows: Sequence[int] | Index) -> Scan:
    """Read some images once: fingerprints and levels; a damaged one is found here.

    Raises:
        FolderError: an image cannot be read.
    """
    prints, histogram = [], np.zeros((3, 256), dtype=np.int64)
    for row in rows:
        rgb = images.pixels.read(int(row))
        prints.append(hashlib.blake2b(rgb.tobytes(), digest_size=8).hexdigest())
        for channel in range(3):
            histogram[channel] += np.bincount(rgb[..., channel].reshape(-1), minlength=256)
    return Scan(tuple(prints), histogram)


def content_hash(images: ImageSet, rows: Index, prints: Sequence[str]) -> str:
    """SHA-256 of what a training run depends on: classes, labels, splits, pixels."""
    split = None if images.split is None else images.split[rows].tolist()
    text = json.dumps([images.classes, images.label[rows].tolist(), split, list(prints)])
    return hashlib.sha256(text.encode()).hexdigest()


def open_images(path: Path, map_name: str | None, kind: str) -> ImageSet:
    """Open a data set: dataset.h5, a folder that `radhar generate` wrote, or a tree of images.

    Args:
        path: what the user gave.
        map_name: which map; the first one if None.
        kind: "rgb" as the PNGs are coloured, or "gray", one channel three times.

    Raises:
        FolderError: it is none of these, or it is damaged.
    """
    from radhar_cli.dataset.layout import DATASET, WORK
    from radhar_cli.learning.folder_images import folder_images
    from radhar_cli.learning.h5_images import h5_images

    if not path.exists():
        raise FolderError(f"{path}: no such file or folder")
    if path.is_file() or (path / DATASET).exists() or (path / WORK).is_dir():
        return h5_images(path, map_name, kind)
    return folder_images(path, map_name, kind)


def class_order(names: set[str]) -> tuple[str, ...]:
    """Order of class names: S1 to S12 where all are ours, else the alphabet."""
    ours = [activity.slug for activity in ACTIVITIES]
    if names <= set(ours):
        return tuple(slug for slug in ours if slug in names)
    return tuple(sorted(names))


def labels_for(images: ImageSet, known: Sequence[str]) -> Index:
    """Labels [N] in the numbering of another list of classes, matched by name.

    Raises:
        FolderError: a class that is not in the list.
    """
    for name in images.classes:
        if name not in known:
            hint = did_you_mean(name, known, f"the model knows {', '.join(known)}")
            raise FolderError(f"{images.where}: class {name!r} is unknown to the model; {hint}")
    return np.array([list(known).index(name) for name in images.classes])[images.label]


def luminance(rgb: Levels) -> Levels:
    """Brightness [H, W] of RGB [H, W, 3] after ITU-R BT.601."""
    weighted = rgb @ np.array([299, 587, 114])
    brightness: Levels = ((weighted + 500) // 1000).astype(np.uint8)
    return brightness


def repeated(levels: Levels) -> Levels:
    """One channel [H, W] three times, [H, W, 3]."""
    return np.repeat(levels[..., None], 3, axis=2)
