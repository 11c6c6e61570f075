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
from torch.nn.functional import cross_entropy
from torch.nn.modules.batchnorm import _BatchNorm

from radhar_cli.dataset.files import read_bytes, write_whole
from radhar_cli.dataset.folder import folder_lock
from radhar_cli.errors import ConfigError
from radhar_cli.learning import run_folder
from radhar_cli.learning.augmentation import Augmentation
from radhar_cli.learning.batches import Reader, batches_in_order
from radhar_cli.learning.evaluation import open_for_model, rows_of, training_images
from radhar_cli.learning.images.image_set import ImageSet, labels_for
from radhar_cli.learning.images.joined import joined, sampling_weights
from radhar_cli.learning.images.scan import content_hash
from radhar_cli.learning.machine import use_deterministic_algorithms
from radhar_cli.learning.run_files import TRAINED_ON
from radhar_cli.learning.run_folder import MAX_TABLE, RunMetadata, load_best
from radhar_cli.learning.starting_point import is_of_last_layer
from radhar_cli.numerics.arrays import Index
from radhar_cli.numerics.randomness import TRAINING, stream
from radhar_cli.processes.progress import Messages
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
        """Yield `count` batches (uint8 [MIXED, 3, H, W], labels [MIXED]), augmented as in training.

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


def adapt(
    run: Path,
    data: Path | tuple[ImageSet, Index],
    folder: Path,
    device: torch.device,
    map_name: str | None = None,
    split: str = "all",
    resize: bool = False,
    overwrite: bool = False,
    epochs: int | None = None,
    mix: Sequence[Path] | Mixed = (),
    progress: Messages | None = None,
) -> RunMetadata:
    """Write a copy of a run whose network has learned from unlabelled images.

    Classes of `data` are not looked at, and may be others than the model's. Learning takes every
    class to be there about equally often. Without epochs only the statistics of batch norm change;
    the images should show the classes about as often as those that will be predicted.

    Args:
        run: folder of the run.
        data: a data set, or some rows of images that are open already.
        folder: folder of the copy.
        device: where the network runs.
        map_name: map of a data set; None is the one of the training.
        split: split of `data`, where it has any.
        resize: bring images to the model's size.
        overwrite: replace another run in `folder`.
        epochs: passes over the images in which the network learns; None is none where there is
            batch norm and nothing to mix, else EPOCHS.
        mix: labelled data sets that are shown as well, those that the run learned from.
        progress: receives messages.

    Returns:
        Metadata of the copy.

    Raises:
        ConfigError: fewer than MIN_IMAGES images, a network of another target, or nothing to adapt.
        RunError: `run` is no folder of a run, `folder` holds something else, or a loss is not
            finite.
        FolderError: data that cannot be used.
    """
    metadata, model = load_best(run)
    epochs = _epochs(run, metadata, model, epochs, bool(mix))
    if isinstance(data, Path):
        images = open_for_model(metadata, data, map_name, labelled=False, resize=resize)
        rows, _ = rows_of(images, split)
    else:
        images, rows = data
    labelled_images: Mixed | None = None
    if isinstance(mix, Mixed):
        labelled_images = mix
    elif mix:
        labelled_images = Mixed(joined([training_images(metadata, path) for path in mix]))
    if not run.is_dir():
        raise run_folder.RunError(f"{run}: should be the folder of a run")
    if run.resolve() == folder.resolve():
        raise run_folder.RunError(f"{folder}: is the run itself; -o should name another folder")
    if progress is not None:
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
    learner = _Learner(model.to(device), metadata, images, rows, device)
    learner.adapt_batch_norm()
    if epochs:
        learner.maximise_information(epochs, labelled_images, progress)
        learner.adapt_batch_norm()
    digest = content_hash(images, rows)
    work = {**metadata.work, "adapted_to": digest, "adapted_epochs": epochs}
    if labelled_images is not None:
        work["adapted_with"] = content_hash(
            labelled_images.images, labelled_images.images.rows("train")
        )
    metadata = metadata.model_copy(update={"work": work})
    with folder_lock(folder):
        run_folder.reserve_run(folder, metadata, overwrite)
        best = run_folder.best_epoch(history)
        run_folder.write_best(folder, metadata, best, model.state_dict())
        run_folder.write_history(folder, history)
        if (run / TRAINED_ON).exists():
            write_whole(folder, folder / TRAINED_ON, read_bytes(run / TRAINED_ON, MAX_TABLE))
    return metadata


def _epochs(
    run: Path,
    metadata: RunMetadata,
    model: nn.Module,
    epochs: int | None,
    has_labelled_images: bool,
) -> int:
    """Number of passes over the images, for a network that can be adapted.

    Raises:
        ConfigError: the network does not tell classes apart, one for each image; or would stay as
            it is, having no batch norm.
    """
    run_folder.refuse_other_targets(run, metadata)
    has_batch_norm = any(isinstance(layer, _BatchNorm) for layer in model.modules())
    if epochs == 0 and not has_batch_norm:
        raise ConfigError(
            f"epochs = 0: should be at least 1 for {metadata.model}, which has no batch norm"
        )
    if epochs is None:
        return 0 if has_batch_norm and not has_labelled_images else EPOCHS
    return epochs


@dataclass(frozen=True)
class _Learner:
    """A network on its device, and the rows of an image set that it is fitted to."""

    model: nn.Module
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
            for levels in self._levels(self._batches(0)):
                self.model(levels)
        self.model.eval()

    def maximise_information(
        self, epochs: int, mixed: Mixed | None, progress: Messages | None
    ) -> None:
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
        model, metadata = self.model, self.metadata
        parameters = [
            p for name, p in model.named_parameters() if not is_of_last_layer(name, model)
        ]
        optimiser = torch.optim.Adam(parameters)
        smoothing = metadata.settings.label_smoothing
        for epoch in range(1, epochs + 1):
            for layer in self.norms:
                layer.train()
            batches = self._batches(epoch)
            labelled = mixed.batches(metadata, epoch, len(batches)) if mixed else None
            for step, levels in enumerate(self._levels(batches)):
                share_done = (epoch - 1 + step / len(batches)) / epochs
                optimiser.param_groups[0]["lr"] = RATE * (1 + cos(pi * share_done)) / 2
                probabilities = model(levels).softmax(1)
                entropy, entropy_of_mean = (
                    _entropy(probabilities).mean(),
                    _entropy(probabilities.mean(0)),
                )
                loss = entropy - entropy_of_mean
                if labelled is not None:
                    labelled_levels, label = (part.to(self.device) for part in next(labelled))
                    logits = model(metadata.normalisation(labelled_levels))
                    loss = loss + cross_entropy(logits, label, label_smoothing=smoothing)
                if not loss.isfinite():
                    raise run_folder.RunError(
                        f"epoch {epoch} of --epochs: the loss is {loss.item()}"
                    )
                optimiser.zero_grad()
                loss.backward()  # type: ignore[no-untyped-call]
                optimiser.step()
            if progress is not None:
                progress.say(
                    f"epoch {epoch}/{epochs}  entropy of a prediction {entropy:.3f}, of their mean "
                    f"{entropy_of_mean:.3f}"
                )
        model.eval()

    def _batches(self, epoch: int) -> list[Index]:
        """Rows in nearly equal batches, in the order of an epoch."""
        seed = int(self.metadata.config.get("seed", 0))
        rng = stream(seed, TRAINING, epoch, name="adaptation")
        order = self.rows[rng.permutation(self.rows.size)]
        return batches_in_order(order, -(-order.size // max(1, order.size // BATCH)))

    def _levels(self, batches: list[Index]) -> Iterator[Tensor]:
        """Yield the network's input [B, 3, H, W] of each batch."""
        for levels, _ in Reader(self.images.pixels, None)(batches):
            yield self.metadata.normalisation(levels.to(self.device))


def _entropy(probabilities: Tensor) -> Tensor:
    """Entropy [...] of probabilities [..., classes], nats."""
    return -(probabilities * probabilities.clamp_min(1e-12).log()).sum(-1)
