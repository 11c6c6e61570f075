"""Labelled images, or sequences, of one size: of a dataset.h5, or a tree of class folders."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Protocol

import numpy as np
from PIL import Image

from radhar_cli.arrays import Float, Index, Levels
from radhar_cli.dataset.layout import SPLITS
from radhar_cli.dataset.split import TRAIN, VALIDATION
from radhar_cli.errors import FolderError, did_you_mean
from radhar_cli.learning.settings import Kind, Target
from radhar_cli.randomness import TRAINING, stream
from radhar_cli.rounding import half_up

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
        rgb = self.pixels.read(row)
        if rgb.shape[:2] == self.size:
            return rgb
        smooth = Image.Resampling.BILINEAR
        return np.asarray(Image.fromarray(rgb).resize(self.size[::-1], smooth))


def resized(images: "ImageSet", size: tuple[int, int]) -> "ImageSet":
    """The same images brought to (H, W)."""
    return replace(images, size=size, pixels=Resized(images.pixels, size))


@dataclass(frozen=True)
class TrueSkeletons:
    """Joints [T, joint, 3] of every row of pixels that have them."""

    pixels: Any

    def __getitem__(self, row: int) -> Float:
        found: Float = self.pixels.joints(row)
        return found


@dataclass(frozen=True)
class Chosen:
    """Rows of one or several `Pixels`: row i is row `rows[i]` of `parts[part[i]]`."""

    parts: tuple[Pixels, ...]
    part: Index
    rows: Index

    def read(self, row: int) -> Levels:
        parts, which = self.parts, int(self.part[row])
        return parts[which].read(int(self.rows[row]))

    def joints(self, row: int) -> Float:
        """As `SequenceReader.joints`."""
        return TrueSkeletons(self.parts[int(self.part[row])])[int(self.rows[row])]


@dataclass(frozen=True)
class ImageSet:
    """Images or sequences of one size, each with a class and a split."""

    where: Path  # the file or folder they came from
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
    snr_db: float | None = None  # of all of them, None where they differ or the source does not say
    # {class: images of it that the source has and this set does not}
    left_out: Mapping[str, int] = field(default_factory=dict)
    # [N] which of several joined sets each came from
    source: Index = field(default_factory=lambda: np.zeros(0, np.intp))
    # [N] who is in each, or the recording that it was cut from; None where the source does not say
    persons: tuple[str, ...] | None = None
    kind: Kind = "rgb"
    channels: int = 3  # colours, columns of a cloud, or frames of a sequence of frames
    joints: tuple[str, ...] = ()  # names of what `pixels.joints` reads
    # [N] class of everybody in each, the sample's main person first; None where there is one person
    everybody: tuple[tuple[str, ...], ...] | None = None
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
        """Of an image, in words."""
        return shape_in_words(self.kind, self.size, self.channels)

    @property
    def frames(self) -> int:
        """Of a sequence; 1 of an image."""
        return {"clouds": self.size[0], "frames": self.channels}.get(self.kind, 1)

    @property
    def done(self) -> tuple[tuple[str, ...], ...]:
        """What everybody does in each [N], of one person the class."""
        return self.everybody or tuple((self.classes[label],) for label in self.label)

    def shows(self, classes: Sequence[str]) -> Levels:
        """What anybody does in each [N, classes], 1 or 0."""
        numbers = {name: number for number, name in enumerate(classes)}
        found = np.zeros((len(self), len(classes)), np.uint8)
        for row, names in zip(found, self.done, strict=True):
            row[[numbers[name] for name in names if name in numbers]] = 1
        return found

    def learned_as(self, target: Target) -> "ImageSet":
        """The same images with the classes of a target: numbers of people, or all that are shown.

        The label of target labels is still that of the sample's main person.
        """
        if target == "labels":
            shown = {name for names in self.done for name in names}
            others = sorted(shown.difference(self.classes))
            return replace(self, classes=(*self.classes, *others))
        if target != "count":
            return self
        counts = np.array([len(names) for names in self.done])
        known, label = np.unique(counts, return_inverse=True)
        classes = tuple(f"{n} {'person' if n == 1 else 'people'}" for n in known)
        return replace(self, classes=classes, label=label, everybody=None)

    @property
    def skeletons(self) -> TrueSkeletons:
        """Joints of the person in each sequence."""
        return TrueSkeletons(self.pixels)

    def rows(self, split: str) -> Index:
        """Rows of a split: train, val, test or all."""
        if split == "all":
            return np.arange(len(self))
        if self.split is None:
            raise FolderError(f"{self.where}: is not split into train and val; --split all")
        numbers = np.flatnonzero(self.split == SPLIT_NAMES[split])
        if not numbers.size:
            counts = np.bincount(self.split, minlength=3)
            has = ", ".join(f"{n} {name}" for n, name in zip(counts, SPLITS, strict=True) if n)
            raise FolderError(f"{self.where}: has no {split} images (it has {has})")
        return numbers

    def renamed(self, names: Mapping[str, str | None]) -> "ImageSet":
        """The same images with some classes under other names; None leaves a class out."""
        new = [names.get(name, name) for name in self.classes]
        classes = tuple(dict.fromkeys(name for name in new if name is not None))
        if not classes:
            raise FolderError(f"{self.where}: --classes leaves no class of it")
        number = np.array([-1 if name is None else classes.index(name) for name in new])
        label = number[self.label]
        rows = np.flatnonzero(label >= 0)
        if self.everybody is not None:
            others = ([names.get(one, one) for one in self.everybody[row]] for row in rows)
            kept = tuple(tuple(one for one in each if one is not None) for each in others)
            return replace(replace(self, everybody=None).renamed(names), everybody=kept)
        if rows.size == label.size:
            return replace(self, classes=classes, label=label)
        lost = np.bincount(self.label[label < 0], minlength=len(new)).tolist()
        left_out = {name: n for name, n in zip(self.classes, lost, strict=True) if n}
        return replace(
            replace(self, classes=classes, label=label).some(rows),
            left_out={**self.left_out, **left_out},
        )

    def some(self, rows: Index) -> "ImageSet":
        """The images of some rows, in their order; a row may come twice."""
        return replace(
            self,
            label=self.label[rows],
            split=None if self.split is None else self.split[rows],
            names=tuple(self.names[row] for row in rows),
            scenes=None if self.scenes is None else tuple(self.scenes[row] for row in rows),
            pixels=Chosen((self.pixels,), np.zeros_like(rows), rows),
            source=self.source[rows],
            persons=None if self.persons is None else tuple(self.persons[row] for row in rows),
            everybody=None if self.everybody is None else tuple(self.everybody[r] for r in rows),
        )

    def cut(self, share: float, seed: int) -> "ImageSet":
        """The same images, split class by class into train and validation if they have no split."""
        if self.split is not None:
            return self
        split = np.full(len(self), TRAIN, dtype=np.uint8)
        for index, name in enumerate(self.classes):
            mine = np.flatnonzero(self.label == index)
            order = stream(seed, TRAINING, name=f"cut {name}").permutation(mine.size)
            if mine.size < 2:
                raise FolderError(
                    f"{self.where}: the class {name!r} has one image; should have two, one to "
                    "learn from and one to validate with"
                )
            held_out = min(max(1, half_up(share, mine.size)), mine.size - 1)
            split[mine[order[:held_out]]] = VALIDATION
        return replace(self, split=split)


def shape_in_words(kind: Kind, size: tuple[int, int], channels: int) -> str:
    """What an image or a sequence measures."""
    height, width = size
    if kind == "clouds":
        return f"{height} frames of {width} points"
    return f"{f'{channels} frames of ' * (kind == 'frames')}{height} x {width} px"


def labels_for(images: ImageSet, known: Sequence[str]) -> Index:
    """Labels [N] in the numbering of another list of classes, which has all of theirs, by name."""
    return np.array([list(known).index(name) for name in images.classes])[images.label]


def repeated(levels: Levels) -> Levels:
    """One channel [...] three times, [..., 3]."""
    return np.repeat(levels[..., None], 3, axis=-1)


def split_named(name: str) -> str:
    """Check the name of a split."""
    known = {**SPLIT_NAMES, "all": -1}
    if name not in known:
        hint = did_you_mean(name, known, "the splits are train, val, test and all")
        raise FolderError(f"--split {name}: is not a split; {hint}")
    return name
