"""Predictions of a trained network on labelled sets and on any images, and their latency."""

import statistics
import time
from collections.abc import Iterable, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import torch
from torch import nn

from radhar_cli.config.reading import Overrides
from radhar_cli.dataset.radar_folders import describe_missing
from radhar_cli.dataset.reading import open_dataset
from radhar_cli.dataset.split import TEST, TRAIN
from radhar_cli.errors import ConfigError, FolderError
from radhar_cli.learning.batches import Reader, batches_in_order
from radhar_cli.learning.images.cloud_files import (
    CloudFilePixels,
    is_cloud_file,
    open_cloud_file,
)
from radhar_cli.learning.images.colours import recolour
from radhar_cli.learning.images.folder import image_files, is_image, open_pictures
from radhar_cli.learning.images.image_set import ImageSet, Pixels, resized
from radhar_cli.learning.images.opening import is_h5, is_tree, open_inputs
from radhar_cli.learning.images.scan import content_hash
from radhar_cli.learning.images.sequences import SequenceReader
from radhar_cli.learning.models.build import compute_features_and_logits
from radhar_cli.learning.run_files import RunError, is_run
from radhar_cli.learning.run_folder import RunMetadata, load_best
from radhar_cli.learning.tasks.predictions import ClassPredictions, Predictions
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.processes.progress import NO_PROGRESS, Progress

WARM_UP, REPEATS, BATCH_REPEATS = 3, 15, 5
PREDICT_BATCH = 32
SPEEDS = (
    *("load_s", "image_s", "load_and_image_s"),
    *("batch", "images_per_s", "images_per_s_with_loading"),
)


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
        metadata: description of the model.
        path: data set, or tree of images.
        map_name: map or product to open; None takes the one of the training.
        labelled: bring classes to those that the model knows, as its task matches them.
        resize: bring images to the model's size.
        names: {class of the data: class of the model, or None to leave it out}.

    Raises:
        FolderError: data that cannot be used, of another size, or without a known class.
        ConfigError: `names` leads to an unknown class.
    """
    images = open_inputs(
        path,
        map_name or _map_to_open(metadata, path),
        metadata.settings,
        metadata.size if resize else None,
    )
    if (images.size, images.channels) != (metadata.size, metadata.channels):
        cure = "; --resize brings them to that" if metadata.reads_pictures else ""
        raise FolderError(
            f"{path}: images are {images.shape}; the model was trained on {metadata.shape}{cure}"
        )
    images = recolour(images, metadata.colours)
    if not labelled:
        return metadata.task.split_as_learned(images)
    images = metadata.task.match(images, metadata, names or {})
    return _with_split_of_training(images, metadata)


def _with_split_of_training(images: ImageSet, metadata: RunMetadata) -> ImageSet:
    """Images with the split that a run has cut, where they are those; else as they are."""
    if images.samples.split is not None:
        return images
    with suppress(FolderError):
        cut = images.cut(metadata.settings.validation_share, metadata.settings.seed)
        rows = np.concatenate([cut.rows("train"), cut.rows("val")])
        if content_hash(cut, rows) == metadata.data["hash"]:
            return cut
    return images


def _map_to_open(metadata: RunMetadata, path: Path) -> str | None:
    """Name of the model's map where a data set has several; None for a tree, which has its own."""
    if not is_h5(path):
        inside = metadata.map is not None and (path / metadata.map).is_dir()
        return metadata.map if inside else None
    if metadata.map is None:
        with open_dataset(path) as data:
            if len(data.maps) > 1:
                raise FolderError(
                    f"{path}: has the maps {', '.join(data.maps)}, and the model was trained on "
                    "images that did not say which they were; name one with --map"
                )
    return metadata.map


def open_training_images(metadata: RunMetadata, path: Path) -> ImageSet:
    """Training images of a data set, of the classes that a run knows; all have the split train."""
    config = metadata.settings
    images = open_for_model(metadata, path, None).cut(config.validation_share, config.seed)
    images = images.take(images.rows("train"))
    split = np.full(len(images), TRAIN, np.uint8)
    return replace(images, samples=replace(images.samples, split=split))


def rows_of(images: ImageSet, split: str | None) -> tuple[Index, str]:
    """Rows of a split, and its name; all rows, and "all", where images come without a split.

    Args:
        split: train, val, test or all; None is test where there are such images, else val.
    """
    if images.samples.split is None:
        split = "all"
    elif split is None:
        split = "test" if (images.samples.split == TEST).any() else "val"
    return images.rows(split), split


def predict_batches(
    model: nn.Module,
    metadata: RunMetadata,
    pixels: Pixels,
    rows: Index,
    device: torch.device,
    batch: int,
) -> Iterator[Float]:
    """Yield predictions [B, ...] of some rows, batch by batch: probabilities, or joints in m.

    Everything is computed in float32, whatever the model was trained in.

    Args:
        model: network in evaluation mode, on the device.
        metadata: description of the model.
        pixels: images or sequences by row.
        rows: rows that are read.
        batch: rows at a time.

    Raises:
        RunError: an output is not finite.
    """
    with torch.inference_mode():
        for levels, _ in Reader(pixels, None)(batches_in_order(rows, batch)):
            outputs = model(metadata.normalisation(levels.to(device)))
            if not outputs.isfinite().all():
                raise RunError(
                    f"the network {metadata.model} trained on {metadata.data['path']}: its "
                    f"{metadata.task.outputs_name} are not finite; its weights or its mean and sd "
                    "are damaged"
                )
            yield metadata.task.predict(outputs).cpu().numpy()


def predict(
    model: nn.Module,
    metadata: RunMetadata,
    images: ImageSet,
    rows: Index,
    device: torch.device,
    batch: int,
    progress: Progress = NO_PROGRESS,
) -> Predictions:
    """Predictions of a model for rows of a labelled set.

    Args:
        model: network in evaluation mode, on the device.
        metadata: description of the model.
        images: labelled images, whose classes the model knows.
        rows: rows that are predicted.
        batch: rows at a time.
        progress: receives the number of rows done.
    """
    batches = []
    for values in predict_batches(model, metadata, images.pixels, rows, device, batch):
        batches.append(values)
        progress.advance(len(values))
    return Predictions(images, rows, metadata.task.names(metadata), np.concatenate(batches))


def predict_classes(
    model: nn.Module,
    metadata: RunMetadata,
    images: ImageSet,
    rows: Index,
    device: torch.device,
    batch: int,
) -> ClassPredictions:
    """Predictions, as of `predict`, of a model whose outputs are classes."""
    predictions = predict(model, metadata, images, rows, device, batch)
    return ClassPredictions(**vars(predictions))


def last_features(
    model: nn.Module, metadata: RunMetadata, images: ImageSet, rows: Index, device: torch.device
) -> Float:
    """Input [len(rows), F] of a network's last layer, in float32.

    Args:
        model: network in evaluation mode, on the device.
        metadata: description of the model.
        images: images by row.
        rows: rows that are read.
    """
    reader = Reader(images.pixels, None)
    batches = list[Float]()
    with torch.inference_mode():
        for levels, _ in reader(batches_in_order(rows, PREDICT_BATCH)):
            inputs = metadata.normalisation(levels.to(device))
            batches.append(compute_features_and_logits(model, inputs)[0].cpu().numpy())
    return np.concatenate(batches)


@dataclass(frozen=True)
class Inputs:
    """Images or sequences that a network is asked about, without regard to their classes."""

    pixels: Pixels
    rows: Index
    names: tuple[str, ...]  # [len(rows)]
    notes: tuple[str, ...]  # what was done to make them fit
    first: Index  # [len(rows)] first column of a window of a stream, first frame of a sequence
    lengths: Index  # [len(rows)] number of frames of a sequence that its sample has; 1 of an image
    colours: str | None = None  # colour map of gray levels, or of pictures, where it is known


def open_unlabelled(
    metadata: RunMetadata,
    path: Path,
    map_name: str | None = None,
    split: str = "all",
    resize: bool = False,
    settings: Overrides = (),
) -> Inputs:
    """Open an image, a folder of images, a table of points or a data set for a network.

    Args:
        metadata: description of the model.
        path: image, folder of images or data set.
        map_name: map of a data set; None is the one of the training.
        split: split of a data set.
        resize: bring images to the model's size.
        settings: what a table of points does not say (`PointTableSettings`).

    Raises:
        RadharError: no such data, images of another size, or a file that the network does not read.
    """
    if not path.exists():
        raise FolderError(f"{path}: {describe_missing(path)}")
    if is_run(path):
        raise FolderError(f"{path}: is a training run; images or data are asked for here")
    if metadata.input == "clouds" and is_cloud_file(path):
        pixels = open_cloud_file(path, metadata.size, settings)
        first, lengths = _spans(pixels, range(len(pixels.places)))
        names = tuple(f"{path}: frame {number}" for number in first.tolist())
        return Inputs(pixels, np.arange(len(names)), names, (), first, lengths)
    if settings:
        raise ConfigError(f"{path}: is no table of points, which axes and columns are said of")
    if not metadata.reads_pictures and not is_h5(path):
        right = "should be a data set"
        if metadata.input == "clouds":
            right += ", a recording of points, or a table with frame, x, y, z and Doppler"
        raise RunError(f"{path}: {metadata.model} reads {metadata.input}; {right}")
    files = image_files(path, path) if is_tree(path) else [p for p in (path,) if is_image(p)]
    if files:
        size = None if resize else metadata.size
        images = recolour(open_pictures(path, files, metadata.input, size), metadata.colours)
        if resize:
            images = resized(images, metadata.size)
        names, rows = tuple(images.samples.name), np.arange(len(files))
    else:
        images = open_for_model(metadata, path, map_name, labelled=False, resize=resize)
        rows, _ = rows_of(images, split)
        names = tuple(f"{path}: {images.samples.name[row]}" for row in rows)
    first, lengths = images.samples.first_columns[rows], np.ones(rows.size, np.intp)
    if isinstance(images.pixels, SequenceReader):
        first, lengths = _spans(images.pixels, rows.tolist())
    return Inputs(images.pixels, rows, names, images.notes, first, lengths, images.colours)


def _spans(pixels: SequenceReader | CloudFilePixels, rows: Iterable[int]) -> tuple[Index, Index]:
    """First frame of each sequence in its sample [N], and the number of its frames there [N]."""
    spans = np.array([pixels.span(row) for row in rows], np.intp).reshape(-1, 2)
    return spans[:, 0], spans[:, 1]


def measure_speed(
    run: Path, images: ImageSet, row: int, device: torch.device, batch: int
) -> dict[str, float]:
    """Time one image and a batch, from levels in memory to the network's answer on the CPU.

    The libraries are loaded and the weights' file is in the system's cache, as it would be in a
    program that is already running.

    Args:
        run: folder of the run.
        images: images of the model's size.
        row: row of the image that is timed.
        batch: images of the batch that is timed.

    Returns:
        {key of SPEEDS: value}: seconds to read the weights and build the network; median seconds of
        one image; seconds until the first answer, loading included; images of the batch; images per
        second in batches; the same of a single batch with loading.
    """
    single = torch.from_numpy(images.pixels.read(row).transpose(2, 0, 1).copy())[None]
    repeated_image = single.expand(batch, -1, -1, -1)
    load_start = time.perf_counter()
    metadata, model = load_best(run)
    model.to(device)
    load_end = time.perf_counter()

    def time_answer(levels: torch.Tensor) -> float:
        start = time.perf_counter()
        model(metadata.normalisation(levels.to(device))).cpu()
        return time.perf_counter() - start

    with torch.inference_mode():
        time_answer(single)
        first_answer_end = time.perf_counter()
        for _ in range(WARM_UP - 1):
            time_answer(single)
        image_time = statistics.median(time_answer(single) for _ in range(REPEATS))
        time_answer(repeated_image)
        batch_time = statistics.median(time_answer(repeated_image) for _ in range(BATCH_REPEATS))
    throughput_with_loading = batch / (load_end - load_start + batch_time)
    values = (
        load_end - load_start,
        image_time,
        first_answer_end - load_start,
        batch,
        batch / batch_time,
        throughput_with_loading,
    )
    return dict(zip(SPEEDS, values, strict=True))
