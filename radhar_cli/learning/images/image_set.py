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
from radhar_cli.learning.choices import Kind
from radhar_cli.numerics.arrays import Float, Index, Levels
from radhar_cli.numerics.randomness import TRAINING, stream
from radhar_cli.numerics.rounding import half_up

SPLIT_NAMES = {"train": 0, "val": 1, "validation": 1, "valid": 1, "test": 2}


class Pixels(Protocol):
    """Reads images by row; can be pickled for worker processes."""

    def read(self, row: int) -> Levels:
        """RGB [H, W, 3] of a row, or a sequence (`SequenceReader.read`)."""


@dataclass(frozen=True)
class Resized:
    """Pixels of any size brought to one (H, W): bilinear, smoothed where it shrinks."""

    pixels: Pixels
    size: tuple[int, int]

    def read(self, row: int) -> Levels:
        """RGB [size[0], size[1], 3] of a row."""
        rgb = self.pixels.read(row)
        if rgb.shape[:2] == self.size:
            return rgb
        smooth = Image.Resampling.BILINEAR
        return np.asarray(Image.fromarray(rgb).resize(self.size[::-1], smooth))


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
        """RGB [H, W, 3] of a row, or a sequence, as its part reads it."""
        return self.parts[int(self.part[row])].read(int(self.rows[row]))

    def joints(self, row: int) -> Float:
        """Joints [T, joint, 3] of a row of sequences, m; NaN after the end of a sample."""
        return TrueSkeletons(self.parts[int(self.part[row])])[int(self.rows[row])]


@dataclass(frozen=True)
class ImageSet:
    """Images or sequences of one size, each with a class and a split; N is their number."""

    where: Path  # file or folder that the images came from
    map: str | None  # name of the map, None for a tree that names none
    # name of every label: the data set's, of a tree without classes.txt by the alphabet
    classes: tuple[str, ...]
    label: Index  # [N] index into `classes`
    split: Levels | None  # [N] 0 train, 1 validation, 2 test; None where the source does not say
    names: tuple[str, ...]  # [N] name of each image, for messages and tables
    # [N] fingerprint of the person and the motion, None where the source does not say
    scenes: tuple[str, ...] | None
    size: tuple[int, int]  # (H, W) in pixels
    pixels: Pixels
    snr_db: float | None = None  # of all images; None where it differs or is not known
    # {class: images of it that the source has and this set does not}
    left_out: Mapping[str, int] = field(default_factory=dict)
    # [N] which of several joined sets each came from
    source: Index = field(default_factory=lambda: np.zeros(0, np.intp))
    # [N] who is in each, or the recording that it was cut from; None where the source does not say
    persons: tuple[str, ...] | None = None
    kind: Kind = "rgb"
    channels: int = 3  # colours, columns of a cloud, or frames of a sequence of frames
    joints: tuple[str, ...] = ()  # names of what `pixels.joints` reads
    # [N] classes of all persons in each, the main person's first; None where there is one person
    person_classes: tuple[tuple[str, ...], ...] | None = None
    colours: str | None = None  # colour map of RGB pictures, where it is known
    notes: tuple[str, ...] = ()  # what was done to make the images fit, to be said

    def __post_init__(self) -> None:
        if not self.source.size:
            object.__setattr__(self, "source", np.zeros(len(self.label), np.intp))

    def __len__(self) -> int:
        return len(self.label)

    def path_of(self, row: int) -> str:
        """File of an image in a tree; else the data set and the name of the row."""
        files = getattr(self.pixels, "files", None)
        return str(files[row]) if files else f"{self.where}: {self.names[row]}"

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
    def activities(self) -> tuple[tuple[str, ...], ...]:
        """Activities of everybody in each image [N], the main person's first."""
        return self.person_classes or tuple((self.classes[label],) for label in self.label)

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
        if self.split is None:
            why = "is not split into train and val; should be read whole, split = all"
            raise FolderError(f"{self.where}: {why}")
        numbers = np.flatnonzero(self.split == SPLIT_NAMES[split])
        if not numbers.size:
            counts = np.bincount(self.split, minlength=3)
            available = ", ".join(
                f"{n} {name}" for n, name in zip(counts, SPLITS, strict=True) if n
            )
            raise FolderError(f"{self.where}: has no {split} images (it has {available})")
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
        label = new_number[self.label]
        rows = np.flatnonzero(label >= 0)
        if self.person_classes is not None:
            new_names = (
                [names.get(name, name) for name in self.person_classes[row]] for row in rows
            )
            activities = tuple(
                tuple(name for name in person_names if name is not None)
                for person_names in new_names
            )
            return replace(
                replace(self, person_classes=None).renamed(names), person_classes=activities
            )
        if rows.size == label.size:
            return replace(self, classes=classes, label=label)
        image_counts = np.bincount(self.label[label < 0], minlength=len(new)).tolist()
        left_out = {name: n for name, n in zip(self.classes, image_counts, strict=True) if n}
        return replace(
            replace(self, classes=classes, label=label).take(rows),
            left_out={**self.left_out, **left_out},
        )

    def take(self, rows: Index) -> "ImageSet":
        """Set of the images of some rows, in their order; a row may come twice."""
        return replace(
            self,
            label=self.label[rows],
            split=None if self.split is None else self.split[rows],
            names=tuple(self.names[row] for row in rows),
            scenes=None if self.scenes is None else tuple(self.scenes[row] for row in rows),
            pixels=Chosen((self.pixels,), np.zeros_like(rows), rows),
            source=self.source[rows],
            persons=None if self.persons is None else tuple(self.persons[row] for row in rows),
            person_classes=None
            if self.person_classes is None
            else tuple(self.person_classes[r] for r in rows),
        )

    def cut(self, share: float, seed: int) -> "ImageSet":
        """Set with a split: its own, or each class cut at random into train and validation.

        Args:
            share: share of each class that validates, at least one image and not all.
            seed: seed of the cut.

        Raises:
            FolderError: a class has a single image.
        """
        if self.split is not None:
            return self
        split = np.full(len(self), TRAIN, dtype=np.uint8)
        for index, name in enumerate(self.classes):
            class_rows = np.flatnonzero(self.label == index)
            order = stream(seed, TRAINING, name=f"cut {name}").permutation(class_rows.size)
            if class_rows.size < 2:
                raise FolderError(
                    f"{self.where}: the class {name!r} has one image; should have two, one to "
                    "learn from and one to validate with"
                )
            held_out = min(max(1, half_up(share, class_rows.size)), class_rows.size - 1)
            split[class_rows[order[:held_out]]] = VALIDATION
        return replace(self, split=split)


def shape_in_words(kind: Kind, size: tuple[int, int], channels: int) -> str:
    """Size of an image or a sequence, in words.

    Args:
        size: (H, W) of an image or a frame; (frames, points) of clouds.
        channels: number of frames of a sequence of frames.
    """
    height, width = size
    if kind == "clouds":
        return f"{height} frames of {width} points"
    return f"{f'{channels} frames of ' * (kind == 'frames')}{height} x {width} px"


def labels_for(images: ImageSet, known: Sequence[str]) -> Index:
    """Labels [N] in the numbering of `known`, a list that has every class of the images."""
    return np.array([list(known).index(name) for name in images.classes])[images.label]


def repeated(levels: Levels) -> Levels:
    """Levels [...] in three equal channels, [..., 3]."""
    return np.repeat(levels[..., None], 3, axis=-1)


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
