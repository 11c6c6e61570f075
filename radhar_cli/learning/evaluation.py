"""What a trained network says of a set of images, and how fast."""

import statistics
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import torch
from torch import nn

from radhar_cli.arrays import Float, Index
from radhar_cli.errors import FolderError
from radhar_cli.learning.batches import Reader
from radhar_cli.learning.images import ImageSet, labels_for, open_images
from radhar_cli.learning.models.build import features_and_logits
from radhar_cli.learning.run_folder import About, load_best

WARM_UP, REPEATS = 3, 15


@dataclass(frozen=True)
class Predictions:
    """A network's answers.

    Attributes:
        images: the set.
        rows: [N] rows of the set that were asked.
        truth: [N] class numbers of the model.
        probabilities: [N, classes].
        features: [N, F], what the last layer sees.
    """

    images: ImageSet
    rows: Index
    truth: Index
    probabilities: Float
    features: Float

    @property
    def predicted(self) -> Index:
        """Class numbers [N]."""
        winners: Index = self.probabilities.argmax(1)
        return winners


def open_for(about: About, path: Path, map_name: str | None) -> ImageSet:
    """Open a data set for a trained model; the map it was trained on if none is named.

    Raises:
        FolderError: other classes or another size than the model's.
    """
    images = open_sized(about, path, map_name)
    labels_for(images, about.classes)
    return images


def open_sized(about: About, path: Path, map_name: str | None) -> ImageSet:
    """Open images of a model's size, whatever their classes.

    Raises:
        FolderError: another size than the model's.
    """
    images = open_images(path, map_name or about.map, about.input)
    if images.size != about.size:
        raise FolderError(
            f"{path}: images are {images.size[0]} x {images.size[1]} px; the model was trained on "
            f"{about.size[0]} x {about.size[1]} px"
        )
    return images


def predict(
    model: nn.Module,
    about: About,
    images: ImageSet,
    rows: Index,
    device: torch.device,
    batch: int,
    workers: int = 0,
) -> Predictions:
    """Ask a model (in evaluation mode, on the device) about rows of a set, in float32."""
    labels = labels_for(images, about.classes)
    reader = Reader(images, labels, workers, pin=False)
    pieces = [rows[start : start + batch] for start in range(0, rows.size, batch)]
    probabilities, features = [], []
    with torch.inference_mode():
        for levels, _ in reader(pieces):
            x = about.normalisation(levels.to(device))
            inner, logits = features_and_logits(model, x)
            probabilities.append(logits.softmax(1).cpu().numpy())
            features.append(inner.cpu().numpy())
    return Predictions(
        images, rows, labels[rows], np.concatenate(probabilities), np.concatenate(features)
    )


def speed(
    run: Path, images: ImageSet, row: int, device: torch.device, batch: int
) -> dict[str, float]:
    """Time one image and a batch, from levels in memory to probabilities on the CPU.

    Returns:
        load_s: reading the weights and building the network; image_s: median of one image;
        load_and_image_s: the first answer after loading, as the paper counts it; batch: images at
        once; images_per_s: throughput at that batch.
    """
    one = torch.from_numpy(images.pixels.read(row).transpose(2, 0, 1).copy())[None]
    many = one.expand(batch, -1, -1, -1)
    began = time.perf_counter()
    about, model = load_best(run)
    model.to(device)
    loaded = time.perf_counter()

    def ask(levels: torch.Tensor) -> float:
        start = time.perf_counter()
        model(about.normalisation(levels.to(device))).softmax(1).cpu()
        return time.perf_counter() - start

    with torch.inference_mode():
        ask(one)
        first = time.perf_counter()
        for _ in range(WARM_UP - 1):
            ask(one)
        image = statistics.median(ask(one) for _ in range(REPEATS))
        ask(many)
        batch_time = statistics.median(ask(many) for _ in range(3))
    return {
        "load_s": loaded - began,
        "image_s": image,
        "load_and_image_s": first - began,
        "batch": batch,
        "images_per_s": batch / batch_time,
    }
