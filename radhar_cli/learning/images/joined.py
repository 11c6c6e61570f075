"""Several sets of images as one."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from radhar_cli.errors import FolderError
from radhar_cli.learning.images.colours import recolour
from radhar_cli.learning.images.image_set import Chosen, ImageSet, labels_for
from radhar_cli.learning.images.sample_table import SampleTable, objects
from radhar_cli.numerics.arrays import Float, Index


def joined(sets: Sequence[ImageSet]) -> ImageSet:
    """Set of all images, classes matched by name, colours brought to those of the first set.

    Raises:
        FolderError: they differ in map, kind, size or joints. A tree of images that does not say
            which map it shows goes with any.
    """
    if len(sets) == 1:
        return sets[0]
    _refuse_unlike(sets)
    colours = next((images.colours for images in sets if images.colours is not None), None)
    sets = [recolour(images, colours) for images in sets]
    classes = tuple(dict.fromkeys(name for images in sets for name in images.classes))
    source = np.repeat(np.arange(len(sets)), [len(images) for images in sets])
    rows = np.concatenate([np.arange(len(images)) for images in sets])
    left_out = Counter[str]()
    for images in sets:
        left_out.update(images.left_out)
    return replace(
        sets[0],
        where=Path(" and ".join(str(images.where) for images in sets)),
        map=next((images.map for images in sets if images.map is not None), None),
        colours=colours,
        notes=tuple(dict.fromkeys(note for images in sets for note in images.notes)),
        classes=classes,
        samples=_join_samples(sets, classes, source),
        pixels=Chosen(tuple(images.pixels for images in sets), source, rows),
        snr_db=sets[0].snr_db if len({images.snr_db for images in sets}) == 1 else None,
        left_out=dict(left_out),
    )


def _join_samples(sets: Sequence[ImageSet], classes: tuple[str, ...], source: Index) -> SampleTable:
    """Table of the samples of several sets, one after the other; persons go by their names.

    Args:
        classes: classes of all of them, in which labels are numbered.
        source: number of the set of each sample [N].
    """
    tables = [images.samples for images in sets]
    splits = [table.split for table in tables if table.split is not None]
    scenes = [
        objects([""] * len(table)) if table.scene is None else table.scene for table in tables
    ]
    labels = [table.frame_labels for table in tables]
    starts = [table.first_column for table in tables]
    has_several_people = any(table.activities is not None for table in tables)
    return SampleTable(
        label=np.concatenate([labels_for(images, classes) for images in sets]),
        name=np.concatenate([table.name for table in tables]),
        source=source,
        split=np.concatenate(splits),
        scene=np.concatenate(scenes),
        person=_join_columns([table.person for table in tables]),
        recording=np.concatenate(
            [
                objects(f"{number}: {name}" for name in table.name)
                if table.recording is None
                else table.recording
                for number, table in enumerate(tables)
            ]
        ),
        activities=np.concatenate([images.activities for images in sets])
        if has_several_people
        else None,
        frame_labels=_join_columns(labels),
        first_column=_join_columns(starts),
    )


def _join_columns(columns: Sequence[Any]) -> Any:
    """Columns of several tables one after the other; None where one lacks it."""
    known = [column for column in columns if column is not None]
    return np.concatenate(known) if len(known) == len(columns) else None


def _refuse_unlike(sets: Sequence[ImageSet]) -> None:
    """Refuse sets that no network can read as one."""
    first = sets[0]
    mapped = next((other for other in sets if other.map is not None), first)
    for other in sets:
        if other.kind != first.kind:
            raise FolderError(
                f"{other.where}: has {other.kind}, {first.where} {first.kind}; should be of one "
                "kind"
            )
        if other.map not in (None, mapped.map):
            raise FolderError(
                f"{other.where}: its map is {other.map}, that of {mapped.where} {mapped.map}; "
                "--map should name one that all data sets have"
            )
        if (other.size, other.channels) != (first.size, first.channels):
            cure = "; --set frames=N makes sequences of one length" if first.frames > 1 else ""
            raise FolderError(
                f"{other.where}: images are {other.shape}, those of {first.where} {first.shape}; "
                f"should be of one size{cure}"
            )
        if other.frame_classes != first.frame_classes:
            raise FolderError(
                f"{other.where}: its columns have other labels than those of {first.where}: should "
                "be streams of the same activities, or none"
            )
        if other.joints != first.joints:
            raise FolderError(
                f"{other.where}: its skeletons have {len(other.joints)} joints, those of "
                f"{first.where} {len(first.joints)}; should be the same"
            )


def sampling_weights(
    images: ImageSet, rows: Index, set_weights: Sequence[float] | None, balanced: bool
) -> Float:
    """Mean number of times that an epoch shows each row [len(rows)].

    Args:
        images: joined sets.
        rows: rows of `images` that an epoch is made of.
        set_weights: weight of every joined set; None is 1 each.
        balanced: every class as often as the others, the epoch's length unchanged.
    """
    weights = np.ones(rows.size)
    if set_weights is not None:
        weights = np.array(set_weights, dtype=float)[images.samples.source[rows]]
    if balanced:
        label = images.samples.label[rows]
        mass = np.bincount(label, weights, len(images.classes))
        weights = weights * (mass.sum() / np.count_nonzero(mass) / np.maximum(mass, 1e-9))[label]
    return weights
