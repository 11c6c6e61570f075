"""Predictions of a trained network on labelled sets and on any images, and their latency."""

import statistics
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch
from torch import nn

from radhar_cli.arrays import Float, Index
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.dataset.split import TRAIN
from radhar_cli.errors import FolderError
from radhar_cli.learning.batches import Reader, batches_in_order
from radhar_cli.learning.images.classes import keep_known_classes, refuse_mistyped
from radhar_cli.learning.images.colours import recolour
from radhar_cli.learning.images.folder import image_files, is_image, open_pictures
from radhar_cli.learning.images.image_set import ImageSet, Pixels, labels_for, resized
from radhar_cli.learning.images.opening import is_h5, is_tree, open_inputs
from radhar_cli.learning.images.scan import content_hash
from radhar_cli.learning.models.build import features_and_logits
from radhar_cli.learning.run_files import is_run
from radhar_cli.learning.run_folder import RunError, RunMetadata, load_best
from radhar_cli.progress import NO_PROGRESS, Progress

WARM_UP, REPEATS, BATCH_REPEATS = 3, 15, 5
PREDICT_BATCH = 32
SPEEDS = (
    *("load_s", "image_s", "load_and_image_s"),
    *("batch", "images_per_s", "images_per_s_with_loading"),
)


@dataclass(frozen=True)
class Predictions:
    """Predictions for rows of an image set."""

    images: ImageSet
    rows: Index  # [N] rows of the set
    truth: Index  # [N] true classes, in the model's numbering
    probabilities: Float  # [N, classes]
    features: Float  # [N, F], input of the last layer

    @property
    def predicted(self) -> Index:
        """Class numbers [N]."""
        winners: Index = self.probabilities.argmax(1)
        return winners


def open_for_model(
    metadata: RunMetadata,
    path: Path,
    map_name: str | None,
    labelled: bool = True,
    resize: bool = False,
    names: Mapping[str, str | None] | None = None,
) -> ImageSet:
    """Open a data set for a trained model.

    The map is the one it was trained on if none is named. Images that come without a split are
    given the run's own where they are those that the run has cut. Pictures are brought to the
    colours that the run learned from.

    Args:
        labelled: keep the classes that the model knows, and no other; of a model that finds joints,
            all are kept.
        resize: bring images to the model's size.
        names: {class there: class here, or None to leave it out}.
    """
    images = open_inputs(
        path,
        map_name or _map_to_open(metadata, path),
        metadata.settings,
        metadata.size if resize else None,
    )
    if (images.size, images.channels) != (metadata.size, metadata.channels):
        cure = "; --resize brings them to that" if metadata.input in ("rgb", "gray") else ""
        raise FolderError(
            f"{path}: images are {images.shape}; the model was trained on {metadata.shape}{cure}"
        )
    images = recolour(images, metadata.colours)
    if metadata.finds_joints:
        return images.renamed(names or {})
    if labelled:
        refuse_mistyped(names or {}, metadata.classes)
        images = images.renamed(names or {}).learned_as(metadata.settings.target)
        images = keep_known_classes(images, metadata.classes)
        if images.split is None:
            with suppress(FolderError):
                cut = images.cut(metadata.settings.validation_share, metadata.settings.seed)
                rows = np.concatenate([cut.rows("train"), cut.rows("val")])
                if content_hash(cut, rows) == metadata.data["hash"]:
                    return cut
    return images


def _map_to_open(metadata: RunMetadata, path: Path) -> str | None:
    """The model's map if a data set has several; a tree of images has its own and no other."""
    if not is_h5(path):
        inside = metadata.map is not None and (path / metadata.map).is_dir()
        return metadata.map if inside else None
    with open_dataset(path) as data:
        if metadata.map is None and len(data.maps) > 1:
            raise FolderError(
                f"{path}: has the maps {', '.join(data.maps)}, and the model was trained on images "
                "that did not say which they were; name one with --map"
            )
        return metadata.map


def training_images(metadata: RunMetadata, path: Path) -> ImageSet:
    """Training images of a data set, of the classes that a run knows."""
    config = metadata.settings
    images = open_for_model(metadata, path, None).cut(config.validation_share, config.seed)
    images = images.take(images.rows("train"))
    return replace(images, split=np.full(len(images), TRAIN, np.uint8))


def rows_of(images: ImageSet, split: str) -> tuple[Index, str]:
    """Rows of a split and its name; all of them where images come without a split."""
    split = "all" if images.split is None else split
    return images.rows(split), split


def predict_batches(
    model: nn.Module,
    metadata: RunMetadata,
    pixels: Pixels,
    rows: Index,
    device: torch.device,
    batch: int,
) -> Iterator[tuple[Float, Float]]:
    """Yield (probabilities [B, classes], features [B, F]) of some rows, batch by batch.

    The model is in evaluation mode and on the device; float32, whatever it was trained in.
    """
    reader = Reader(pixels, None)
    with torch.inference_mode():
        for levels, _ in reader(batches_in_order(rows, batch)):
            features, logits = features_and_logits(model, metadata.normalisation(levels.to(device)))
            if not logits.isfinite().all():
                raise RunError(
                    f"the network {metadata.model} trained on {metadata.data['path']}: its logits "
                    "are not finite; its weights or its mean and sd are damaged"
                )
            each = logits.sigmoid() if metadata.settings.target == "labels" else logits.softmax(1)
            yield each.cpu().numpy(), features.cpu().numpy()


def predict(
    model: nn.Module,
    metadata: RunMetadata,
    images: ImageSet,
    rows: Index,
    device: torch.device,
    batch: int,
    progress: Progress = NO_PROGRESS,
) -> Predictions:
    """Predictions of a model for rows of a labelled set."""
    batches = []
    for found in predict_batches(model, metadata, images.pixels, rows, device, batch):
        batches.append(found)
        progress.advance(len(found[0]))
    return Predictions(
        images=images,
        rows=rows,
        truth=labels_for(images, metadata.classes)[rows],
        probabilities=np.concatenate([batch_probabilities for batch_probabilities, _ in batches]),
        features=np.concatenate([features for _, features in batches]),
    )


@dataclass(frozen=True)
class Inputs:
    """What a network is asked about: images or sequences without regard to their classes."""

    pixels: Pixels
    rows: Index
    names: tuple[str, ...]  # [len(rows)]
    notes: tuple[str, ...]  # what was done to make them fit


def predict_paths(
    run: Path,
    paths: Sequence[Path],
    device: torch.device,
    map_name: str | None,
    split: str,
    resize: bool = False,
    say: Callable[[str], None] | None = None,
) -> Iterator[tuple[str, dict[str, float]]]:
    """Yield (name, probability of every class) for every image.

    Args:
        paths: images, folders of images, or data sets.
        map_name: of a data set, if not the one of the run.
        split: of a data set.
        say: is told what was done to make the images fit.
    """
    metadata, model = load_best(run)
    if metadata.finds_joints:
        raise RunError(f"{run}: finds joints, no classes; `-o joints.npz` writes them to a file")
    model.to(device)
    for path in paths:
        inputs = open_unlabelled(metadata, path, map_name, split, resize)
        if say is not None:
            for note in inputs.notes:
                say(note)
        each = iter(inputs.names)
        found = predict_batches(model, metadata, inputs.pixels, inputs.rows, device, PREDICT_BATCH)
        for probabilities, _ in found:
            for row in probabilities.tolist():
                yield next(each), dict(zip(metadata.classes, row, strict=True))


def open_unlabelled(
    metadata: RunMetadata, path: Path, map_name: str | None, split: str, resize: bool
) -> Inputs:
    """Open an image, a folder of images or a data set for a network that is asked about it."""
    if not path.exists():
        raise FolderError(f"{path}: no such file or folder")
    if is_run(path):
        raise FolderError(f"{path}: is a training run; images or data are asked for here")
    if metadata.input not in ("rgb", "gray") and not is_h5(path):
        raise RunError(f"{path}: {metadata.model} reads {metadata.input}; should be a data set")
    files = image_files(path, path) if is_tree(path) else [p for p in (path,) if is_image(p)]
    if files:
        size = None if resize else metadata.size
        images = recolour(open_pictures(path, files, metadata.input, size), metadata.colours)
        if resize:
            images = resized(images, metadata.size)
        return Inputs(images.pixels, np.arange(len(files)), images.names, images.notes)
    images = open_for_model(metadata, path, map_name, labelled=False, resize=resize)
    rows, _ = rows_of(images, split)
    names = tuple(f"{path}: {images.names[row]}" for row in rows)
    return Inputs(images.pixels, rows, names, images.notes)


def measure_speed(
    run: Path, images: ImageSet, row: int, device: torch.device, batch: int
) -> dict[str, float]:
    """Time one image and a batch, from levels in memory to the network's answer on the CPU.

    The libraries are loaded and the weights' file is in the system's cache, as it would be in a
    program that is already running.

    Returns:
        SPEEDS: reading the weights and building the network; the median of one image; until the
        first answer, loading included; images at once; throughput at that batch; of a single one.
    """
    one = torch.from_numpy(images.pixels.read(row).transpose(2, 0, 1).copy())[None]
    many = one.expand(batch, -1, -1, -1)
    began = time.perf_counter()
    metadata, model = load_best(run)
    model.to(device)
    loaded = time.perf_counter()

    def ask(levels: torch.Tensor) -> float:
        start = time.perf_counter()
        model(metadata.normalisation(levels.to(device))).cpu()
        return time.perf_counter() - start

    with torch.inference_mode():
        ask(one)
        first = time.perf_counter()
        for _ in range(WARM_UP - 1):
            ask(one)
        image = statistics.median(ask(one) for _ in range(REPEATS))
        ask(many)
        batch_time = statistics.median(ask(many) for _ in range(BATCH_REPEATS))
    with_loading = batch / (loaded - began + batch_time)
    found = (loaded - began, image, first - began, batch, batch / batch_time, with_loading)
    return dict(zip(SPEEDS, found, strict=True))
