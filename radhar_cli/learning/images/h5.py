"""Images of a dataset.h5, its levels or their colours in the PNGs, and its sequences."""

import hashlib
from contextlib import ExitStack
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from radhar_cli.config.data_set import MeasuredConfig
from radhar_cli.dataset.layout import Rows, row_axis
from radhar_cli.dataset.png import colour_table
from radhar_cli.dataset.reading import Dataset, open_dataset
from radhar_cli.dataset.recorded import windows
from radhar_cli.learning.images.image_set import ImageSet, Pixels
from radhar_cli.learning.images.sample_table import Objects, SampleTable, objects
from radhar_cli.learning.images.sequences import (
    COLUMNS,
    POINTS,
    Opened,
    SequenceReader,
    joint_names,
    longest_sequence,
    sequence_product,
)
from radhar_cli.learning.registry import Kind
from radhar_cli.learning.settings import Auto
from radhar_cli.numerics.arrays import Levels

_WHO_AND_HOW = (
    *("subject.", "motion.", "timing.", "classes.", "people."),
    *("recordings.part", "recordings.start_s"),
)


@dataclass
class H5Levels(Opened):
    """Rows of one map of a dataset.h5, as levels of one channel."""

    map: str

    def read(self, row: int) -> Levels:
        """Levels [H, W, 1] of a row."""
        levels: Levels = self.data.maps[self.map][row]
        return levels[..., None]


@dataclass
class H5Pixels(Opened):
    """Rows of one map of a dataset.h5, whose levels become colours of a table [256, 3]."""

    map: str
    table: Levels

    def read(self, row: int) -> Levels:
        """RGB [H, W, 3] of a row."""
        rgb: Levels = self.table[self.data.maps[self.map][row]]
        return rgb


def open_h5_images(path: Path, map_name: str | None, kind: Kind) -> ImageSet:
    """Open one map of a dataset.h5, or of the folder it lies in, as images.

    Args:
        path: dataset.h5, or the folder it lies in.
        map_name: map to open; None takes the first one.
        kind: "rgb" as the PNGs are coloured, or "gray", the levels as one channel.

    Raises:
        FolderError: it is no data set, or has no such map.
    """
    with ExitStack() as on_error:
        data = on_error.enter_context(open_dataset(path))
        name = data.map_name(map_name)
        image = data.config.image
        pixels: H5Levels | H5Pixels = H5Levels(data.path, name)
        if kind == "rgb":
            pixels = H5Pixels(data.path, name, colour_table(image.colour_map))
        images = _image_set(data, path, name, pixels, image.size_px)
        pixels.keep_open(data)
        on_error.pop_all()  # `pixels` has the file from here on
    if kind == "gray":
        return replace(images, kind="gray", channels=1)
    return replace(images, colours=image.colour_map)


def open_h5_sequences(
    path: Path, product: str | None, kind: Kind, frames: Auto = "auto", points: int = POINTS
) -> ImageSet:
    """Open the frames or clouds of a dataset.h5, or of the folder it lies in.

    Args:
        path: dataset.h5, or the folder it lies in.
        product: product to open; None takes the first of that kind.
        kind: frames or clouds.
        frames: number of frames of a sequence; auto is that of the longest sample.
        points: largest number of points of a frame.

    Raises:
        FolderError: it is no data set, or has no such product.
    """
    with ExitStack() as on_error:
        data = on_error.enter_context(open_dataset(path))
        name = sequence_product(data, kind, product)
        count = longest_sequence(data, name) if frames == "auto" else frames
        pixels = SequenceReader(data.path, name, count, points)
        size, channels = data.products[name].shape[1:], count
        if kind == "clouds":
            size, channels = (count, points), len(COLUMNS)
        images = _image_set(data, path, name, pixels, (size[0], size[1]))
        joints = joint_names(data)
        pixels.keep_open(data)
        on_error.pop_all()  # `pixels` has the file from here on
    return replace(images, kind=kind, channels=channels, joints=joints)


def _image_set(
    data: Dataset, where: Path, name: str, pixels: Pixels, size: tuple[int, int]
) -> ImageSet:
    """Image set of the rows of a data set, which `pixels` reads."""
    rows, snr_db = Rows.of(data.config), data.config.snr_db
    slugs = np.array(data.classes)[data.label]
    samples = SampleTable(
        label=data.label.astype(np.intp),
        name=objects(f"{s}/{rows.name(row)}" for row, s in enumerate(slugs)),
        source=np.zeros(len(slugs), np.intp),
        split=data.split,
        scene=objects(_scenes(data, slugs.tolist())),
        person=_persons(data),
        recording=_recordings(data),
        activities=_activities(data),
        frame_labels=data.frame_label[name][:][:, 0] if name in data.frame_label else None,
    )
    stream = data.config.stream
    return ImageSet(
        where=where,
        map=name,
        classes=data.classes,
        samples=samples,
        size=size,
        pixels=pixels,
        frame_classes=data.frame_classes,
        column_s=None if stream is None else stream.column_s,
        row_axis=_axis_of_rows(data, name),
        snr_db=float(snr_db) if isinstance(snr_db, (int, float)) else None,
    )


def _axis_of_rows(data: Dataset, name: str) -> tuple[str, float, float]:
    """Quantity and edges of the rows of streams; shares of the height of what has no edges."""
    edges = data.extent(name) if name in data.frame_label else None
    if edges is None:
        return "share of the rows", 0.0, 1.0
    return "{} ({})".format(*row_axis(name)), edges[2], edges[3]


def _activities(data: Dataset) -> Objects | None:
    """Classes of all persons in each row [N], the main person's first; None without `people`."""
    if data.person_label is None:
        return None
    labels = zip(data.label, data.person_label[:, 1:], strict=True)
    return objects(
        (data.classes[label], *(data.class_slugs[n] for n in others if n >= 0))
        for label, others in labels
    )


def _persons(data: Dataset) -> Objects | None:
    """Person of each row [N], or its recording where that names none; None if neither is known.

    The name of a person who was drawn has the seed of the data set: another draws other persons.
    """
    if isinstance(data.config, MeasuredConfig):
        parts = (window.part for window in windows(data.config))
        return objects(f"file {p.file}" if p.person is None else p.person for p in parts)
    if data.config.split.subjects is None:
        return None
    seed = data.config.seed
    return objects(f"person {n} (seed {seed})" for n in data.scene["subject"][:].tolist())


def _recordings(data: Dataset) -> Objects | None:
    """Recording that each row [N] is cut from; None where each is a recording of its own."""
    if not isinstance(data.config, MeasuredConfig):
        return None
    return objects(f"file {window.part.file}" for window in windows(data.config))


def _scenes(data: Dataset, slugs: list[str]) -> list[str]:
    """A fingerprint of a person who moved and how, in SI units; radar, wall and noise do not enter.

    Numbers enter with their dotted keys where they apply, so that a scene has the same fingerprint
    in a data set that has further classes or people in other scenes, or another radar, whose keys
    may change names of columns.
    """
    fields = [field for field in data.fields if field.key.startswith(_WHO_AND_HOW)]
    fields.sort(key=lambda field: field.key)
    columns = [data.scene[field.name][:] for field in fields]
    table = np.stack(columns, axis=1) if columns else np.zeros((len(slugs), 0))
    known = ~np.isnan(table)
    patterns, pattern = np.unique(known, axis=0, return_inverse=True)
    names = [
        " ".join(np.array([f.key for f in fields])[is_known].tolist()) for is_known in patterns
    ]
    fingerprints = []
    for row, slug in enumerate(slugs):
        further_persons = () if data.person_label is None else tuple(data.person_label[row, 1:])
        activities = [slug, *(data.class_slugs[n] for n in further_persons if n >= 0)]
        text = f"{' '.join(activities)}\n{names[pattern.flat[row]]}\n"
        content = text.encode() + table[row, known[row]].tobytes()
        fingerprints.append(hashlib.blake2b(content, digest_size=8).hexdigest())
    return fingerprints
