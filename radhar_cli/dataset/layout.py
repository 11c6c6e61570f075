"""Which sample stands in which row, and what its files are called."""

from bisect import bisect_right
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import accumulate, pairwise
from math import prod
from pathlib import Path
from typing import TypeAlias

import numpy as np

from radhar_cli.config.data_set import AnyConfig
from radhar_cli.motion.activities.activity import Activity
from radhar_cli.numerics.arrays import Index
from radhar_cli.numerics.rounding import half_up
from radhar_cli.processing.angle_time import ANGLE_TIME_KINDS
from radhar_cli.processing.frame_maps import ANGLES, FRAME_MAP_KINDS
from radhar_cli.processing.map_kind import CADENCE_KINDS, MAP_KINDS, kind_of
from radhar_cli.schema.number import support

# Of dataset.h5; 3: labels are 0 to C - 1 in the order of the config.
SCHEMA_VERSION = 3
DATASET = "dataset.h5"
CONFIG = "config.yaml"
SCENES = "scenes.csv"
SEGMENTS_TABLE = "segments.csv"  # of streams
PNG = "png"
CLASSES, METADATA = "classes.txt", "metadata.csv"  # beside the PNGs
CARD = "README.md"
GALLERY = "gallery.png"
WORK = ".radhar"
RECORDINGS = "recordings"  # of `radhar prepare`, which a data set was made of
IDENTITY = "identity.json"
BUILT = "built"  # marks the work folder of a data set, or of a part, that was whole once
PARTS = "parts"
COLUMN_LABEL = "column_label"
FRAME_LABEL = "frame_label"  # of streams: what each person does at the time of each column
SEGMENTS = "segments"  # the product of the same by start and stop
# Of scenes with `people`: which classes anybody shows, and the class of each person.
LABELS, PERSON_LABEL = "labels", "person_label"
PNGS_A_FOLDER = 10_000
SPLITS = ("train", "validation", "test")
# Type and shape of a sample's part of a dataset.
Parts: TypeAlias = dict[str, tuple[str, tuple[int, ...]]]
SPLIT_FOLDERS = ("train", "val", "test")


def large_datasets(config: AnyConfig) -> Parts:
    """Type and shape of a sample's part of each large dataset of dataset.h5, one sample a chunk.

    The checksums of each lie at `checksum_of` its name.
    """
    size = config.image.size_px
    parts: Parts = {f"maps/{name}": ("u1", size) for name in config.maps}
    if config.output.power is not None:
        parts |= {f"power/{name}": ("<f2", size) for name in config.maps}
    if config.output.slow_time:
        parts["slow_time"] = ("<c8", (_most_samples(config),))
    return parts


def _most_samples(config: AnyConfig) -> int:
    """Length of the longest slow-time signal after the canceller that a config draws."""
    pulses = half_up(support(config.duration_s)[1], support(config.radar.prf_hz)[1])
    return pulses - 1 if config.processing.clutter == "difference" else pulses


def checksum_of(name: str) -> str:
    """Name of the dataset that holds the checksums of a large dataset."""
    return f"sha256/{name.removeprefix('maps/')}"


def count_of(name: str) -> str:
    """Name of the dataset that holds how many rows of /products/<name> each sample has."""
    return f"products/{name}_count"


def small_datasets(config: AnyConfig) -> Parts:
    """Type and shape of a sample's part of each small dataset, beside the large ones and /scene."""
    parts: Parts = {checksum_of(name): ("S64", ()) for name in large_datasets(config)}
    parts |= {count_of(name): ("i8", ()) for name in config.stored}
    if config.people:
        parts |= {LABELS: ("u1", (len(config.every_class),))}
        parts |= {PERSON_LABEL: ("<i2", (1 + len(config.people),))}
    for name in config.maps:
        parts |= {f"entropy/{name}": ("f4", ()), f"extent/{name}": ("f8", (4,))}
        if config.output.power is not None:
            parts[f"largest_db/{name}"] = ("f8", ())
        if config.output.column_labels:
            parts[f"{COLUMN_LABEL}/{name}"] = ("u1", (config.image.size_px[1],))
        if config.stream is not None and column_axis(name) == TIME:
            parts[f"{FRAME_LABEL}/{name}"] = (
                "<i2",
                (1 + len(config.people), config.image.size_px[1]),
            )
    return parts


TIME = ("slow time", "s")
POINTS_AXES = (("up", "m"), ("right", "m"))  # of the front views of points


def row_axis(name: str) -> tuple[str, str]:
    """Quantity and unit of the rows of a map; generic words for a map of the user's own."""
    if name == "points":
        return POINTS_AXES[0]
    if name in FRAME_MAP_KINDS:
        rows = FRAME_MAP_KINDS[name].rows
        return rows.quantity, rows.unit
    if name in ANGLE_TIME_KINDS:
        angle = ANGLES[ANGLE_TIME_KINDS[name].array_axis]
        return angle.quantity, angle.unit
    kind = kind_of(name)
    if kind is None:
        return "rows of the product", "1"
    return ("Doppler frequency", "Hz") if kind.is_doppler_time else ("range", "m")


def column_axis(name: str) -> tuple[str, str]:
    """Quantity and unit of the columns of a map; generic words for a map of the user's own."""
    if name == "points":
        return POINTS_AXES[1]
    if name in FRAME_MAP_KINDS:
        columns = FRAME_MAP_KINDS[name].columns
        return columns.quantity, columns.unit
    if name in CADENCE_KINDS:
        return "cadence", "Hz"
    is_over_time = name in MAP_KINDS or name in ANGLE_TIME_KINDS
    return TIME if is_over_time else ("columns of the product", "1")


def row_bytes(config: AnyConfig) -> int:
    """Bytes of the large datasets of one sample, before compression."""
    return sum(np.dtype(t).itemsize * prod(shape) for t, shape in large_datasets(config).values())


def is_incomplete(folder: Path) -> bool:
    """Whether a build in this folder is unfinished."""
    return any((folder / WORK / name).exists() for name in (IDENTITY, "shards"))


@dataclass(frozen=True)
class Rows:
    """The fixed, class-major order of a data set's samples.

    Attributes:
        activities: the classes, in the order of the config.
        counts: number of samples of each.
    """

    activities: tuple[Activity, ...]
    counts: tuple[int, ...]

    @classmethod
    def of(cls, config: AnyConfig) -> "Rows":
        """Rows of the data set that a config describes."""
        activities = config.chosen_activities
        return cls(activities, tuple(map(config.samples_of, activities)))

    @cached_property
    def starts(self) -> tuple[int, ...]:
        """First row of each class, and last the number of all rows."""
        return (0, *accumulate(self.counts))

    def __len__(self) -> int:
        return self.starts[-1]

    @property
    def label(self) -> Index:
        """Label of each row [N]: the place of its class in the config's `activities`, from 0."""
        return np.repeat(np.arange(len(self.activities)), self.counts)

    @property
    def names(self) -> tuple[str, ...]:
        """Name of each label [C]: the slugs of the classes."""
        return tuple(activity.slug for activity in self.activities)

    def __getitem__(self, row: int) -> tuple[Activity, int]:
        """(activity, index within its class) of a row."""
        label = bisect_right(self.starts, row) - 1
        return self.activities[label], row - self.starts[label]

    def spread(self, count: int) -> list[int]:
        """Choose `count` rows, or all, spread evenly over the classes, in ascending order."""
        count = min(count, len(self))
        return [(2 * place + 1) * len(self) // (2 * count) for place in range(count)]

    def spread_progressively(self, count: int) -> list[int]:
        """Choose the rows of `spread`, in an order whose first few are spread, too."""
        rows = self.spread(count)
        bits = len(rows).bit_length()  # places by their bits from right to left: each step halves
        order = sorted(range(len(rows)), key=lambda place: int(f"{place:0{bits}b}"[::-1], 2))
        return [rows[place] for place in order]

    def name(self, row: int) -> str:
        """Index of a row within its class, in the same number of digits in all of the class."""
        activity, index = self[row]
        count = self.counts[self.activities.index(activity)]
        return f"{index:0{max(5, len(str(count - 1)))}d}"

    def png_path(self, map_name: str, split: int, row: int) -> Path:
        """Path of a PNG inside the output folder, the layout that ImageFolder reads."""
        return Path(PNG, map_name, SPLIT_FOLDERS[split], self.file_name(row))

    def file_name(self, row: int) -> str:
        """Path of a row's PNG below the folder of its map and split.

        Large classes have a folder for every PNGS_A_FOLDER indices.
        """
        activity, index = self[row]
        count = self.counts[self.activities.index(activity)]
        inner = f"{index // PNGS_A_FOLDER:04d}/" if count > PNGS_A_FOLDER else ""
        return f"{activity.slug}/{inner}{self.name(row)}.png"

    def classes(self) -> Iterator[tuple[Activity, slice]]:
        """Yield each class and the slice of its rows."""
        for activity, rows in zip(self.activities, pairwise(self.starts), strict=True):
            yield activity, slice(*rows)

    @property
    def counts_text(self) -> str:
        """Numbers of classes and samples in words, such as `12 classes x 100`."""
        slugs: dict[int, list[str]] = {count: [] for count in self.counts}
        for activity, count in zip(self.activities, self.counts, strict=True):
            slugs[count].append(activity.slug)
        usual, *others = sorted(slugs, key=lambda count: -len(slugs[count]))
        more = "".join(f", {', '.join(slugs[count])} x {count}" for count in others)
        same = slugs[usual]
        return f"{f'{len(same)} classes' if len(same) > 1 else same[0]} x {usual}{more}"
