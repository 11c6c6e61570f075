"""Labelled images, or sequences, of one size: of a dataset.h5, or a tree of class folders."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from PIL import Image

from radhar_cli.dataset.layout import SPLITS
from radhar_cli.dataset.split import TRAIN, VALIDATION
from radhar_cli.errors import ConfigError, FolderError, did_you_mean
from radhar_cli.learning.images.sample_table import Objects, SampleTable, objects
from radhar_cli.learning.registry import Kind
from radhar_cli.numerics.arrays import Float, Index, Levels
from radhar_cli.numerics.randomness import TRAINING, stream
from radhar_cli.numerics.rounding import half_up

SPLIT_NAMES = {"train": 0, "val": 1, "validation": 1, "valid": 1, "test": 2}


class Pixels(Protocol):
    """Reads images by row; can be pickled for worker processes."""

    def read(self, row: int) -> Levels:
        """RGB [H, W, 3] or levels [H, W, 1] of a row, or a sequence (`SequenceReader.read`)."""


@dataclass(frozen=True)
class Resized:
    """Pixels of any size brought to one (H, W): bilinear, smoothed where it shrinks."""

    pixels: Pixels
    size: tuple[int, int]

    def read(self, row: int) -> Levels:
        """RGB or levels [size[0], size[1], C] of a row."""
        levels = self.pixels.read(row)
        if levels.shape[:2] == self.size:
            return levels
        is_gray = levels.shape[2] == 1
        picture = Image.fromarray(levels[..., 0] if is_gray else levels)
        resized = np.array(picture.resize(self.size[::-1], Image.Resampling.BILINEAR))
        return resized[..., None] if is_gray else resized


def resized(images: "ImageSet", size: tuple[int, int]) -> "ImageSet":
    """Images of any size brought to (H, W) when they are read."""
    return replace(images, size=size, pixels=Resized(images.pixels, size))


@dataclass(frozen=True)
class TrueSkeletons:
    """Joints [T, joint, 3] (m, radar's axes) of every row of pixels that have them."""

    pixels: Any

    def __getitem__(self, row: int) -> Float:
        joints: Float = self.pixels.joints(row)
        return joints


@dataclass(frozen=True)
class Chosen:
    """Rows of one or several `Pixels`: row i is row `rows[i]` of `parts[part[i]]`."""

    parts: tuple[Pixels, ...]
    part: Index
    rows: Index

    def read(self, row: int) -> Levels:
        """Image [H, W, C] of a row, or a sequence, as its part reads it."""
        return self.parts[int(self.part[row])].read(int(self.rows[row]))

    def joints(self, row: int) -> Float:
        """Joints [T, joint, 3] of a row of sequences, m; NaN after the end of a sample."""
        return TrueSkeletons(self.parts[int(self.part[row])])[int(self.rows[row])]


@dataclass(frozen=True)
class ImageSet:
    """Images or sequences of one size, and a table of them; N is their number."""

    where: Path  # file or folder that the images came from
    map: str | None  # name of the map, None for a tree that names none
    # name of every label: the data set's, of a tree without classes.txt by the alphabet
    classes: tuple[str, ...]
    samples: SampleTable  # [N] label, split, name and so on of each image
    size: tuple[int, int]  # (H, W) in pixels
    pixels: Pixels
    snr_db: float | None = None  # of all images; None where it differs or is not known
    # {class: images of it that the source has and this set does not}
    left_out: Mapping[str, int] = field(default_factory=dict)
    kind: Kind = "rgb"
    channels: int = 3  # colours (1 of gray), columns of a cloud, or frames of a sequence of frames
    joints: tuple[str, ...] = ()  # names of what `pixels.joints` reads
    frame_classes: tuple[str, ...] = ()  # names of the labels of columns, of streams
    column_s: float | None = None  # time from one column to the next, of streams
    # quantity and unit of the rows of streams, and the edges of the lowest and the highest
    row_axis: tuple[str, float, float] = ("share of the rows", 0.0, 1.0)
    colours: str | None = None  # colour map of RGB pictures, where it is known
    notes: tuple[str, ...] = ()  # what was done to make the images fit, to be said

    def __len__(self) -> int:
        return len(self.samples)

    def path_of(self, row: int) -> str:
        """File of an image in a tree; else the data set and the name of the row."""
        files = getattr(self.pixels, "files", None)
        return str(files[row]) if files else f"{self.where}: {self.samples.name[row]}"

    @property
    def shape(self) -> str:
        """Size of an image or a sequence, in words."""
        return shape_in_words(self.kind, self.size, self.channels)

    @property
    def is_pictures(self) -> bool:
        """Whether it holds images, not sequences."""
        return self.kind in ("rgb", "gray")

    @property
    def frames(self) -> int:
        """Number of frames of a sequence; 1 of an image."""
        return {"clouds": self.size[0], "frames": self.channels}.get(self.kind, 1)

    @property
    def activities(self) -> Objects:
        """Tuples of the activities of everybody in each image [N], the main person's first."""
        if self.samples.activities is not None:
            return self.samples.activities
        return objects((self.classes[label],) for label in self.samples.label)

    def multi_hot(self, classes: Sequence[str]) -> Levels:
        """Multi-hot labels [N, classes]: 1 for an activity that anybody does in the image, else 0.

        Args:
            classes: names of the columns; activities of no such name are left out.
        """
        numbers = {name: number for number, name in enumerate(classes)}
        labels = np.zeros((len(self), len(classes)), np.uint8)
        for row, names in zip(labels, self.activities, strict=True):
            row[[numbers[name] for name in names if name in numbers]] = 1
        return labels

    @property
    def skeletons(self) -> TrueSkeletons:
        """Joints of the person in each sequence."""
        return TrueSkeletons(self.pixels)

    def rows(self, split: str) -> Index:
        """Rows of a split: train, val, test or all.

        Raises:
            FolderError: there are no such images, or no splits.
        """
        if split == "all":
            return np.arange(len(self))
        if self.samples.split is None:
            why = "is not split into train and val; should be read whole, split = all"
            raise FolderError(f"{self.where}: {why}")
        numbers = np.flatnonzero(self.samples.split == SPLIT_NAMES[split])
        if not numbers.size:
            counts = np.bincount(self.samples.split, minlength=3)
            available = ", ".join(
                f"{n} {name}" for n, name in zip(counts, SPLITS, strict=True) if n
            )
            raise FolderError(
                f"{self.where}: has no {split} images (it has {available}); `split` of the config, "
                "or folders of images, would make them"
            )
        return numbers

    def renamed(self, names: Mapping[str, str | None]) -> "ImageSet":
        """Images with some classes under other names; images of a class left out are counted.

        Args:
            names: {class: new name, or None to leave it out}; others stay. Two classes of one new
                name become one.

        Raises:
            FolderError: no class is left.
        """
        new = [names.get(name, name) for name in self.classes]
        classes = tuple(dict.fromkeys(name for name in new if name is not None))
        if not classes:
            raise FolderError(f"{self.where}: --classes leaves no class of it")
        new_number = np.array([-1 if name is None else classes.index(name) for name in new])
        label = new_number[self.samples.label]
        rows = np.flatnonzero(label >= 0)
        samples = replace(self.samples, label=label, activities=self._renamed_activities(names))
        images = replace(self, classes=classes, samples=samples)
        if rows.size == label.size:
            return images
        counts = np.bincount(self.samples.label[label < 0], minlength=len(new)).tolist()
        left_out = {name: n for name, n in zip(self.classes, counts, strict=True) if n}
        return replace(images.take(rows), left_out={**self.left_out, **left_out})

    def _renamed_activities(self, names: Mapping[str, str | None]) -> Objects | None:
        """Activities of all persons in each image under new names, without those left out."""
        if self.samples.activities is None:
            return None
        return objects(
            tuple(new for name in activities if (new := names.get(name, name)) is not None)
            for activities in self.samples.activities
        )

    def take(self, rows: Index) -> "ImageSet":
        """Set of the images of some rows, in their order; a row may come twice."""
        pixels = Chosen((self.pixels,), np.zeros_like(rows), rows)
        return replace(self, samples=self.samples.take(rows), pixels=pixels)

    def cut(self, share: float, seed: int) -> "ImageSet":
        """Set with a split: its own, or each class cut at random into train and validation.

        Args:
            share: share of each class that validates, at least one image and not all.
            seed: seed of the cut.

        Raises:
            FolderError: a class has a single image.
        """
        if self.samples.split is not None:
            return self
        split = np.full(len(self), TRAIN, dtype=np.uint8)
        for index, name in enumerate(self.classes):
            class_rows = np.flatnonzero(self.samples.label == index)
            order = stream(seed, TRAINING, name=f"cut {name}").permutation(class_rows.size)
            if class_rows.size < 2:
                raise FolderError(
                    f"{self.where}: the class {name!r} has one image; should have two, one to "
                    "learn from and one to validate with"
                )
            held_out = min(max(1, half_up(share, class_rows.size)), class_rows.size - 1)
            split[class_rows[order[:held_out]]] = VALIDATION
        return replace(self, samples=replace(self.samples, split=split))


def shape_in_words(kind: Kind, size: tuple[int, int], channels: int) -> str:
    """Size of an image or a sequence, in words.

    Args:
        kind: kind of the inputs.
        size: (H, W) of an image or a frame; (frames, points) of clouds.
        channels: number of frames of a sequence of frames.
    """
    height, width = size
    if kind == "clouds":
        return f"{height} frames of {width} points"
    return f"{f'{channels} frames of ' * (kind == 'frames')}{height} x {width} px"


def labels_for(images: ImageSet, known: Sequence[str]) -> Index:
    """Labels [N] in the numbering of `known`, a list that has every class of the images."""
    return np.array([list(known).index(name) for name in images.classes])[images.samples.label]


def check_split_name(name: str) -> str:
    """Name of a split: train, val (or validation, valid), test or all.

    Raises:
        ConfigError: there is no such split.
    """
    known = {**SPLIT_NAMES, "all": -1}
    if name not in known:
        hint = did_you_mean(name, known, "the splits are train, val (validation), test and all")
        raise ConfigError(f"split = {name!r}: is not a split; {hint}")
    return name
