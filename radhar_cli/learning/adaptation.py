"""Fit a trained network to images of another radar whose labels nobody knows.

All layers but the last learn from the images: to be sure of each, and of every class equally often
(Liang, Hu and Feng, Do we really need to access the source data?, ICML 2020). Labelled images of
the first source, shown at the same time, keep the classes what they were. Where a network has
batch norm, it takes mean and variance from the new images (Li et al., Adaptive batch normalization
for practical domain adaptation, Pattern Recognition 80, 2018), even without learning.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import cos, pi
from pathlib import Path

import torch
from torch import Tensor, nn
from torch.nn.modules.batchnorm import _BatchNorm

from radhar_cli.dataset.files import read_bytes, write_whole
from radhar_cli.dataset.folder import folder_lock
from radhar_cli.errors import ConfigError
from radhar_cli.learning import run_folder
from radhar_cli.learning.augmentation import Augmentation
from radhar_cli.learning.batches import Reader, batches_in_order
from radhar_cli.learning.evaluation import open_for_model, open_training_images, rows_of
from radhar_cli.learning.images.image_set import ImageSet, labels_for
from radhar_cli.learning.images.joined import joined, sampling_weights
from radhar_cli.learning.images.scan import content_hash
from radhar_cli.learning.machine import use_deterministic_algorithms
from radhar_cli.learning.run_files import TRAINED_ON, RunError
from radhar_cli.learning.run_folder import MAX_TABLE, RunMetadata, load_best
from radhar_cli.learning.starting_point import is_of_last_layer
from radhar_cli.learning.tasks.categories import Classifier, require_classifier
from radhar_cli.numerics.arrays import Index
from radhar_cli.numerics.randomness import TRAINING, stream
from radhar_cli.processes.progress import NO_PROGRESS, Messages
from radhar_cli.processes.worker_process import keep_memory

MIN_IMAGES, BATCH = 16, 96
EPOCHS = 20  # where none are asked for and batch norm alone would not do
MIXED = 32  # labelled images a step
RATE = 5e-4  # of Adam, falls to zero by a cosine


@dataclass(frozen=True)
class Mixed:
    """Labelled images that are shown while a network learns from unlabelled ones."""

    images: ImageSet
    weights: tuple[float, ...] | None = None  # of the images of each joined set; None is 1 each

    def batches(
        self, metadata: RunMetadata, epoch: int, count: int
    ) -> Iterator[tuple[Tensor, Tensor]]:
        """Yield `count` batches (uint8 [MIXED, C, H, W], labels [MIXED]), augmented as in training.

        Args:
            metadata: description of the network, with its augmentation and classes.
            epoch: number of the epoch; each draws other images.
            count: number of batches.
        """
        config, rows = metadata.settings, self.images.rows("train")
        weights = sampling_weights(self.images, rows, self.weights, balanced=False)
        rng = stream(config.seed, TRAINING, epoch, name="adaptation mixed")
        batch_rows = rng.choice(rows, (count, MIXED), p=weights / weights.sum())
        labels = labels_for(self.images, metadata.classes)
        augmentation = (
            Augmentation(config.augment, config.seed) if config.input_kind == "gray" else None
        )
        yield from Reader(self.images.pixels, labels, augmentation)(list(batch_rows), epoch)


@dataclass(frozen=True)
class AdaptOptions:
    """Options of the adaptation of a run."""

    map: str | None = None  # of a data set; None is the one of the training
    split: str = "all"  # of the images, where they have any
    resize: bool = False  # bring images to the model's size
    overwrite: bool = False  # replace another run in the folder of the copy
    # passes over the images in which the network learns; None is none where there is batch norm
    # and nothing to mix, else EPOCHS
    epochs: int | None = None
    # labelled data sets that are shown as well, those that the run learned from
    mix: Sequence[Path] | Mixed = ()


def adapt(
    run: Path,
    data: Path | tuple[ImageSet, Index],
    folder: Path,
    device: torch.device,
    options: AdaptOptions | None = None,
    progress: Messages = NO_PROGRESS,
) -> RunMetadata:
    """Write a copy of a run whose network has learned from unlabelled images.

    Classes of `data` are not looked at, and may be others than the model's. Learning takes every
    class to be there about equally often. Without epochs only the statistics of batch norm change;
    the images should show the classes about as often as those that will be predicted.

    Args:
        run: folder of the run.
        data: a data set, or some rows of images that are open already.
        folder: folder of the copy.
        options: options of the adaptation; None takes the defaults.
        progress: receives messages.

    Returns:
        Metadata of the copy.

    Raises:
        ConfigError: fewer than MIN_IMAGES images, a network of another task, or nothing to adapt.
        RunError: `run` is no folder of a run, `folder` holds something else, or a loss is not
            finite.
        FolderError: data that cannot be used.
    """
    options = options or AdaptOptions()
    metadata, model = load_best(run)
    classifier = require_classifier(run, metadata.task)
    epochs = _choose_epochs(metadata, model, options)
    images, rows = _open_unlabelled(metadata, data, options)
    mixed = _open_mixed(metadata, options.mix)
    if not run.is_dir():
        raise RunError(f"{run}: should be the folder of a run")
    if run.resolve() == folder.resolve():
        raise RunError(f"{folder}: is the run itself; -o should name another folder")
    for note in images.notes:
        progress.say(note)
    history = run_folder.read_history(run)
    if rows.size < MIN_IMAGES:
        raise ConfigError(
            f"{images.where}: has {rows.size} images; should have at least {MIN_IMAGES}"
        )
    use_deterministic_algorithms(device)
    if device.type == "cpu":
        keep_memory()
    learner = _Learner(model.to(device), classifier, metadata, images, rows, device)
    learner.adapt_batch_norm()
    if epochs:
        learner.maximise_information(epochs, mixed, progress)
        learner.adapt_batch_norm()
    adapted = _describe_copy(metadata, images, rows, epochs, mixed)
    with folder_lock(folder):
        run_folder.reserve_run(folder, adapted, options.overwrite)
        best = run_folder.best_epoch(history)
        run_folder.write_best(folder, adapted, best, model.state_dict())
        run_folder.write_history(folder, history)
        if (run / TRAINED_ON).exists():
            write_whole(folder, folder / TRAINED_ON, read_bytes(run / TRAINED_ON, MAX_TABLE))
    return adapted


def _choose_epochs(metadata: RunMetadata, model: nn.Module, options: AdaptOptions) -> int:
    """Number of passes over the images.

    Raises:
        ConfigError: the network would stay as it is, having no batch norm.
    """
    has_batch_norm = any(isinstance(layer, _BatchNorm) for layer in model.modules())
    if options.epochs == 0 and not has_batch_norm:
        raise ConfigError(
            f"epochs = 0: should be at least 1 for {metadata.model}, which has no batch norm"
        )
    if options.epochs is None:
        return 0 if has_batch_norm and not options.mix else EPOCHS
    return options.epochs


def _open_unlabelled(
    metadata: RunMetadata, data: Path | tuple[ImageSet, Index], options: AdaptOptions
) -> tuple[ImageSet, Index]:
    """Images whose labels are not looked at, and the rows of them that are learned from."""
    if not isinstance(data, Path):
        return data
    images = open_for_model(metadata, data, options.map, labelled=False, resize=options.resize)
    return images, rows_of(images, options.split)[0]


def _open_mixed(metadata: RunMetadata, mix: Sequence[Path] | Mixed) -> Mixed | None:
    """Labelled images that are shown as well; None where there are none."""
    if isinstance(mix, Mixed):
        return mix
    if not mix:
        return None
    return Mixed(joined([open_training_images(metadata, path) for path in mix]))


def _describe_copy(
    metadata: RunMetadata, images: ImageSet, rows: Index, epochs: int, mixed: Mixed | None
) -> RunMetadata:
    """Metadata of a run that was adapted to some rows of images."""
    work = {
        **metadata.work,
        "adapted_to": content_hash(images, rows),
        "adapted_epochs": epochs,
    }
    if mixed is not None:
        work["adapted_with"] = content_hash(mixed.images, mixed.images.rows("train"))
    return metadata.model_copy(update={"work": work})


@dataclass(frozen=True)
class _Information:
    """Entropies of a batch of predictions, nats; their difference is the mutual information."""

    entropy: Tensor  # mean entropy of a prediction
    entropy_of_mean: Tensor  # entropy of the mean prediction

    @property
    def loss(self) -> Tensor:
        """Mutual information of images and predictions, negated."""
        return self.entropy - self.entropy_of_mean


@dataclass(frozen=True)
class _Learner:
    """A network on its device, and the rows of an image set that it is fitted to."""

    model: nn.Module
    classifier: Classifier
    metadata: RunMetadata
    images: ImageSet
    rows: Index
    device: torch.device

    @property
    def norms(self) -> list[_BatchNorm]:
        """Layers of batch norm."""
        return [layer for layer in self.model.modules() if isinstance(layer, _BatchNorm)]

    def adapt_batch_norm(self) -> None:
        """Replace the statistics of every batch norm by their average over the rows.

        The rows are shuffled, as stored ones may be sorted by class, and batches are nearly equal.
        """
        if not self.norms:
            self.model.eval()
            return
        for layer in self.norms:
            layer.train()
            layer.reset_running_stats()
            layer.momentum = None  # the plain average over all batches
        with torch.inference_mode():
            for inputs in self._inputs(self._batches(0)):
                self.model(inputs)
        self.model.eval()

    def maximise_information(self, epochs: int, mixed: Mixed | None, progress: Messages) -> None:
        """Train all layers but the last to raise the mutual information of images and predictions.

        The loss is the mean entropy of the predictions less the entropy of their mean. Batch norm
        works as in training, in the batches of `adapt_batch_norm`. Labelled images, in batches of
        their own, add their cross-entropy, smoothed as in training.

        Args:
            epochs: number of passes over the images.
            mixed: labelled images that are shown as well.
            progress: receives a line for each epoch.

        Raises:
            RunError: a loss is not finite.
        """
        parameters = [
            p for name, p in self.model.named_parameters() if not is_of_last_layer(name, self.model)
        ]
        optimiser = torch.optim.Adam(parameters)
        for epoch in range(1, epochs + 1):
            for layer in self.norms:
                layer.train()
            batches = self._batches(epoch)
            labelled = mixed.batches(self.metadata, epoch, len(batches)) if mixed else None
            for step, inputs in enumerate(self._inputs(batches)):
                share_done = (epoch - 1 + step / len(batches)) / epochs
                optimiser.param_groups[0]["lr"] = RATE * (1 + cos(pi * share_done)) / 2
                information = self._information(inputs)
                loss = information.loss
                if labelled is not None:
                    loss = loss + self._labelled_loss(*next(labelled))
                if not loss.isfinite():
                    raise RunError(f"epoch {epoch} of --epochs: the loss is {loss.item()}")
                optimiser.zero_grad()
                loss.backward()  # type: ignore[no-untyped-call]
                optimiser.step()
            progress.say(
                f"epoch {epoch}/{epochs}  entropy of a prediction {information.entropy:.3f}, "
                f"of their mean {information.entropy_of_mean:.3f}"
            )
        self.model.eval()

    def _information(self, inputs: Tensor) -> "_Information":
        """Entropies of the predictions of inputs [B, C, H, W]."""
        probabilities = self.classifier.predict(self.model(inputs))  # [B, classes]
        return _Information(_entropy(probabilities).mean(), _entropy(probabilities.mean(0)))

    def _labelled_loss(self, levels: Tensor, labels: Tensor) -> Tensor:
        """Mean loss of labelled images [B, C, H, W], as in training."""
        logits = self.model(self.metadata.normalisation(levels.to(self.device)))
        return self.classifier.loss(logits, labels.to(self.device)).mean()

    def _batches(self, epoch: int) -> list[Index]:
        """Rows in nearly equal batches, in the order of an epoch."""
        seed = int(self.metadata.config.get("seed", 0))
        rng = stream(seed, TRAINING, epoch, name="adaptation")
        order = self.rows[rng.permutation(self.rows.size)]
        return batches_in_order(order, -(-order.size // max(1, order.size // BATCH)))

    def _inputs(self, batches: list[Index]) -> Iterator[Tensor]:
        """Yield the network's input [B, C, H, W] of each batch."""
        for levels, _ in Reader(self.images.pixels, None)(batches):
            yield self.metadata.normalisation(levels.to(self.device))


def _entropy(probabilities: Tensor) -> Tensor:
    """Entropy [...] of probabilities [..., classes], nats."""
    return -(probabilities * probabilities.clamp_min(1e-12).log()).sum(-1)
