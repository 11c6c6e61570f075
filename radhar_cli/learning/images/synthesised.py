"""Images that are synthesised when they are read: what `radhar train --stream` learns from."""

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from radhar_cli.activity import Activity
from radhar_cli.arrays import Index, Levels
from radhar_cli.config.identity import resolved
from radhar_cli.config.schema import Config
from radhar_cli.dataset.identity import identity, identity_hash
from radhar_cli.dataset.layout import Rows
from radhar_cli.dataset.on_demand import Recipe
from radhar_cli.dataset.png import colour_table
from radhar_cli.dataset.split import TRAIN, VALIDATION, split_rows
from radhar_cli.dataset.stream_order import StreamOrder
from radhar_cli.errors import ConfigError, FolderError, did_you_mean
from radhar_cli.learning.batches import Reader, pieces
from radhar_cli.learning.images.classes import renamed
from radhar_cli.learning.images.image_set import ImageSet, class_order, labels_for, repeated
from radhar_cli.learning.images.joined import joined
from radhar_cli.learning.images.opening import open_images
from radhar_cli.learning.images.scan import Scan, scan
from radhar_cli.learning.run_folder import LearnedFrom
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.stream import prepare_worker

NORMALISED_BY = 256  # first images of a stream, whose mean and deviation all are normalised by
PIECE = 8
GREY = repeated(np.arange(256, dtype=np.uint8))


@dataclass(frozen=True)
class SynthesisedPixels:
    """A map of one sample a row, through a table [256, 3]."""

    recipe: Recipe  # of the map alone
    where: StreamOrder | Rows  # row -> (activity, index)
    table: Levels  # colours of the levels

    def read(self, row: int) -> Levels:
        """RGB [H, W, 3] of a row.

        Raises:
            SceneError: a scene outside the model.
        """
        prepare_worker()
        made = self.recipe(*self.where[row])
        rgb: Levels = self.table[made[self.recipe.fields[0]]]
        return rgb


@dataclass(frozen=True)
class StoredPixels:
    """Levels [N, H, W] in memory, through a table [256, 3]."""

    levels: Levels
    table: Levels

    def read(self, row: int) -> Levels:
        rgb: Levels = self.table[self.levels[row]]
        return rgb


@dataclass(frozen=True)
class TrainingStream:
    """An endless series of training images; no two epochs share any."""

    order: StreamOrder  # which sample stands in which row
    pixels: SynthesisedPixels  # of every row
    classes: tuple[str, ...]  # that the labels number; `stream[row]` is the label of a row
    per_epoch: int  # rows of an epoch
    first: Scan

    def __getitem__(self, row: int) -> int:
        return self.classes.index(self.order[row][0].slug)

    def rows(self, epoch: int) -> Index:
        """Rows of an epoch, which no other has."""
        return np.arange(epoch * self.per_epoch, (epoch + 1) * self.per_epoch)


def stream_and_validation(
    config: TrainConfig,
    stream: Config,
    data: Sequence[Path],
    names: Mapping[str, str | None],
    workers: int,
) -> tuple[TrainingStream, ImageSet]:
    """The training images of a stream, and the images to validate with.

    Those are the validation images of `data`, or all where they come without a split; without
    `data` the first of each class that the split of the stream's own data set holds back.

    Args:
        data: data sets to validate on, or none.
        names: those that classes of `data` get.
        workers: processes that synthesise.

    Raises:
        ConfigError: a map that the stream does not have, nothing to train or to validate with.
        FolderError: `data` of other classes, maps or sizes than the stream.
        SceneError: a scene outside the model.
    """
    name = config.map or stream.maps[0]
    if name not in stream.maps:
        hint = did_you_mean(name, stream.maps, f"it has {', '.join(stream.maps)}")
        raise ConfigError(f"map = {name!r}: is not in the config of --stream; {hint}")
    if config.data_weights is not None:
        raise ConfigError("data_weights: are of data sets; a stream has one config and no weights")
    recipe = Recipe.of(stream, [f"maps/{name}"])
    classes = class_order({activity.slug for activity in stream.chosen_activities})
    if len(classes) < 2:
        raise ConfigError(f"activities: is {classes[0]!r} alone in --stream; should have two")
    table = colour_table(stream.image.colour_map) if config.input == "rgb" else GREY
    order = StreamOrder(stream, "train")
    split = split_rows(stream)
    per_epoch = config.stream.samples_per_epoch or int(np.count_nonzero(split == TRAIN))
    if per_epoch < 2:
        raise ConfigError(
            "stream.samples_per_epoch: is needed, as split.train leaves no sample of "
            "samples_per_class to train with"
        )
    if data:
        images = _given(config, data, names, name, stream.image.size_px)
        images = replace(images, label=labels_for(images, classes), classes=classes)
    else:
        images = _held_back(config, recipe, classes, split, table, workers)
    count = np.arange(min(NORMALISED_BY, per_epoch * config.epochs))
    first = StoredPixels(synthesised_levels(recipe, order, count, workers), table)
    return (
        TrainingStream(
            order,
            SynthesisedPixels(recipe, order, table),
            classes,
            per_epoch,
            scan(replace(images, pixels=first), count),
        ),
        replace(images, map=name),
    )


def stream_data(stream: TrainingStream, validation: LearnedFrom, epochs: int) -> LearnedFrom:
    """Description of the data of a run on a stream, stored with the run."""
    order, count = stream.order, stream.per_epoch * epochs
    own = [identity_hash(identity(order.config)), validation["hash"]]
    return {
        "path": f"a stream, validated on {validation['path']}",
        "hash": hashlib.sha256(json.dumps(own).encode()).hexdigest(),
        "train": count,
        "val": validation["val"],
        "stream": {"config": resolved(order.config), "samples": count},
    }


def _given(
    config: TrainConfig,
    data: Sequence[Path],
    names: Mapping[str, str | None],
    map_name: str,
    size: tuple[int, int],
) -> ImageSet:
    sets = []
    for path in data:
        images = renamed(open_images(path, config.map, config.input), names)
        if images.map not in (None, map_name):
            raise FolderError(
                f"{path}: shows {images.map}, the stream {map_name}; --map names one for both"
            )
        if images.size != size:
            raise FolderError(
                f"{path}: images are {images.size[0]} x {images.size[1]} px, those of the stream "
                f"{size[0]} x {size[1]} px"
            )
        if images.split is None:
            images = replace(images, split=np.full(len(images), VALIDATION, np.uint8))
        images.rows("val")
        sets.append(images)
    return joined(sets)


def _held_back(
    config: TrainConfig,
    recipe: Recipe,
    classes: tuple[str, ...],
    split: Levels,
    table: Levels,
    workers: int,
) -> ImageSet:
    rows = Rows.of(recipe.config)
    most = config.stream.validation_per_class
    chosen = np.concatenate(
        [
            here.start + np.flatnonzero(split[here] == VALIDATION)[:most]
            for _, here in rows.classes()
        ]
    )
    if not chosen.size:
        raise ConfigError(
            "split.validation: leaves no sample to validate with; should be larger, or name a data "
            "set to validate on"
        )
    keys: list[tuple[Activity, int]] = [rows[int(row)] for row in chosen]
    return ImageSet(
        where=Path("the stream's own split"),
        map=None,
        classes=classes,
        label=np.array([classes.index(activity.slug) for activity, _ in keys], np.intp),
        split=np.full(chosen.size, VALIDATION, np.uint8),
        names=tuple(f"{rows[int(row)][0].slug}/{rows.name(int(row))}" for row in chosen),
        scenes=None,
        size=recipe.config.image.size_px,
        pixels=StoredPixels(synthesised_levels(recipe, rows, chosen, workers), table),
    )


def synthesised_levels(
    recipe: Recipe, where: StreamOrder | Rows, rows: Index, workers: int
) -> Levels:
    """Levels [rows, H, W] of some rows, made by worker processes if there are any."""
    pixels = SynthesisedPixels(recipe, where, GREY)
    reader = Reader(pixels, None, workers, pin=False)
    return np.concatenate([rgb[:, 0].numpy() for rgb, _ in reader(pieces(rows, PIECE))])
