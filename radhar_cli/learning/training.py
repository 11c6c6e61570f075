"""Train a network: the same result for the same config, data and machine, killed or not."""

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
import torch
from torch import Tensor, nn
from torch.optim.swa_utils import AveragedModel, update_bn

from radhar_cli import __version__
from radhar_cli.config.identity import resolved
from radhar_cli.dataset.folder import folder_lock
from radhar_cli.errors import ConfigError, FolderError, RadharError
from radhar_cli.learning import machine, run_files
from radhar_cli.learning import run_folder as run
from radhar_cli.learning.augmentation import Augmentation
from radhar_cli.learning.batches import Labels, Reader, batches_in_order, epoch_batches, epoch_order
from radhar_cli.learning.images.classes import renamed
from radhar_cli.learning.images.colours import recolour
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.images.joined import joined, sampling_weights
from radhar_cli.learning.images.opening import open_inputs
from radhar_cli.learning.images.scan import content_hash, scan
from radhar_cli.learning.models.build import build_model
from radhar_cli.learning.optimiser import check_state, learning_rate_of_step, optimiser_for
from radhar_cli.learning.run_folder import Epoch, RunMetadata, best_epoch
from radhar_cli.learning.run_summary import write_run_summary
from radhar_cli.learning.settings import AugmentConfig, TrainConfig
from radhar_cli.learning.starting_point import StartingPoint, start_from
from radhar_cli.learning.targets import SCORES, loss_and_score
from radhar_cli.numerics.arrays import Index
from radhar_cli.numerics.randomness import TRAINING, stream
from radhar_cli.processes.progress import Messages
from radhar_cli.processes.worker_process import keep_memory

STATISTICS_IMAGES = 2048  # from which batch norm of averaged weights has its statistics
FEW_STEPS = 10  # an epoch; fewer are warned of
# Not part of the identity of a run; precision enters as chosen (RunMetadata.work).
NOT_IDENTITY = ("device", "workers", "threads", "precision")


class TrainingError(RadharError):
    """A run that had to stop; the checkpoints of finished epochs are kept."""


class TrainingProgress(Messages, Protocol):
    """Receiver of messages, and of how far a training run is."""

    def epoch(self, number: int, epochs: int, steps: int) -> None:
        """Begin an epoch (from 1) of so many steps."""

    def step(self, loss: float, accuracy: float) -> None:
        """Finish a step: its loss, and the accuracy (or other score) of the epoch so far."""

    def epoch_done(self, row: Epoch, best: bool) -> None:
        """Finish an epoch, which is on disk; `best` where its weights are the best so far."""


@dataclass(frozen=True)
class Outcome:
    """Result of a training run."""

    folder: Path  # folder of the run
    history: list[Epoch]
    resumed: int  # epochs that were finished before
    score: str  # name of what its accuracies are

    @property
    def best(self) -> Epoch:
        """Epoch whose weights are kept."""
        return best_epoch(self.history)


def train(
    config: TrainConfig,
    data: Path | Sequence[Path] | ImageSet,
    folder: Path,
    progress: TrainingProgress,
    overwrite: bool = False,
    names: Mapping[str, str | None] | None = None,
    start: Path | None = None,
    resize: bool = False,
    tensorboard: bool = False,
) -> Outcome:
    """Train a network, or resume its training; a complete run stays as it is.

    Args:
        config: model and settings.
        data: a data set, several that are combined, or images that are open already.
        folder: folder of the run.
        progress: receives messages, steps and epochs.
        overwrite: start over in a folder that holds a run.
        names: {class of the data: class here, or None to leave it out}.
        start: a run whose best weights and normalisation are the initial ones; those of the last
            layer too if the classes are the same. Pictures are brought to its colours.
        resize: bring images to the size of those that `start` learned from.
        tensorboard: write the curves for TensorBoard, too.

    Raises:
        FolderError: data that cannot be used.
        RunError: a folder that holds something else, or a damaged checkpoint.
        ModelError: a network that cannot be built.
        MachineError: a device that is not available.
        TrainingError: a step too large for memory, or a loss that is not finite; earlier
            checkpoints are kept.
    """
    initial_run = None if start is None else run.load_best(start)[0]
    if resize and initial_run is None:
        raise ConfigError("--resize: needs --init, a run whose image size is taken")
    if isinstance(data, ImageSet):
        images = data
    else:
        images = checked_images(
            config, data, names, initial_run.size if initial_run and resize else None
        )
    if initial_run is not None:
        images = recolour(images, initial_run.colours)
    config = config.with_batch_size_for(images.rows("train").size, images.frames)
    if config.threads != "auto":
        torch.set_num_threads(config.threads)
    device = machine.choose_device(config.device)
    machine.use_deterministic_algorithms(device)
    if device.type == "cpu":
        keep_memory()
    with folder_lock(folder):
        try:
            training = _Training(config, images, folder, progress, device, overwrite, start)
            return training.run(tensorboard)
        except RuntimeError as error:
            # On the CPU only the message says that memory was short.
            if not isinstance(error, torch.OutOfMemoryError) and "CPUAllocator" not in str(error):
                raise
            size = config.images_a_step
            hint = f"fewer: --set batch_size={size // 2}" if size > 3 else "smaller"
            raise TrainingError(
                f"out of memory on {device.type} in a step of {size} images of {images.shape}; "
                f"should be {hint}"
            ) from None


def checked_images(
    config: TrainConfig,
    data: Path | Sequence[Path],
    names: Mapping[str, str | None] | None = None,
    resize: tuple[int, int] | None = None,
) -> ImageSet:
    """Open a data set, or several as one, and make sure that it can be learned from.

    Args:
        config: model, target and settings.
        data: one or several data sets, or trees of images.
        names: {class of the data: class here, or None to leave it out}.
        resize: (H, W) to bring images to; None refuses those of several sizes.

    Raises:
        FolderError: data that cannot be used together, or a class without training images.
        ConfigError: `data_weights` does not have a weight for each data set.
    """
    paths = [data] if isinstance(data, Path) else list(data)
    if config.data_weights is not None and len(config.data_weights) != len(paths):
        raise ConfigError(
            f"data_weights = {list(config.data_weights)}: should have a weight for each of the "
            f"{len(paths)} data sets"
        )
    sets = [
        renamed(open_inputs(path, config.map, config, resize), names or {}).cut(
            config.validation_share, config.seed
        )
        for path in paths
    ]
    images, path = joined(sets).learned_as(config.target), " and ".join(map(str, paths))
    if config.target == "skeleton":
        images.rows("val"), images.rows("train")
        return images
    if len(images.classes) < 2:
        raise FolderError(f"{path}: has the class {images.classes[0]!r} alone; should have two")
    rows = images.rows("train")
    occurring = _occurring_classes(config, images, rows)
    for index, name in enumerate(images.classes):
        if index not in occurring:
            raise FolderError(f"{path}: the class {name!r} has no training image")
    images.rows("val")
    return images


class _Training:
    """Training run: its network, and the epochs so far."""

    def __init__(
        self,
        config: TrainConfig,
        images: ImageSet,
        folder: Path,
        progress: TrainingProgress,
        device: torch.device,
        overwrite: bool = False,
        start: Path | None = None,
    ) -> None:
        self.config, self.images, self.folder = config, images, folder
        self.progress, self.device = progress, device
        self.precision = machine.choose_precision(config.precision, device)
        self.history: list[Epoch] = []
        torch.manual_seed(config.seed)
        joints = config.target == "skeleton"
        outputs = 3 * len(images.joints) if joints else len(images.classes)
        self.model = build_model(config.model, outputs, images.size, joints)
        starting_point = None if start is None else start_from(start, self.model, config, images)
        kind_in_words = "images" if images.kind in ("rgb", "gray") else "sequences"
        images_in_words = f"{len(images)} {kind_in_words} of {len(images.classes)} classes"
        progress.say(f"reading {images_in_words}, {images.shape}")
        notes = starting_point.notes if starting_point else ()
        for message in (*images.notes, *_warnings(config, images), *notes):
            progress.say(message)
        self.metadata, training_images = _describe(config, images, self.precision, starting_point)
        run.reserve_run(folder, self.metadata, overwrite)
        run.write_trained_on(folder, training_images)
        self.model.to(device)
        self.average = AveragedModel(self.model) if config.average_last else None
        self.optimiser = optimiser_for(config, self.model)

    def run(self, tensorboard: bool = False) -> Outcome:
        """Train the epochs that are not done, and write what a finished run leaves."""
        config, images, device = self.config, self.images, self.device
        resumed = self._restore()
        curves = None
        if tensorboard:
            from radhar_cli.learning.tensorboard import TensorBoardCurves

            curves = TensorBoardCurves(self.folder, self.metadata, SCORES[config.target])
            curves.write(self.history)
        if resumed:
            self.progress.say(f"resuming: {resumed} of {config.epochs} epochs are done")
        precision_in_words = f"{self.metadata.work['precision']}, {torch.get_num_threads()} threads"
        self.progress.say(f"on {device.type}, {precision_in_words}")
        augmentation = None
        if config.augment != AugmentConfig():
            augmentation = Augmentation(config.augment, config.seed)
        targets, workers = (
            _training_targets(config, images),
            machine.reading_workers(config.workers, device),
        )
        pin = device.type == "cuda"
        reader = Reader(images.pixels, targets, augmentation, workers, pin)
        for epoch in range(resumed, config.epochs):
            start_s = time.perf_counter()
            # Of dropout and the like, for this epoch alone, so that a run can resume.
            layers = stream(config.seed, TRAINING, epoch, name="layers")
            torch.manual_seed(int(layers.integers(2**63)))
            training = self._train_epoch(reader, epoch)
            self._statistics_of_average(reader, epoch)
            validation = self._validate(reader, epoch)
            learning_rate = self.optimiser.param_groups[0]["lr"]
            seconds = round(time.perf_counter() - start_s, 3)
            self.history.append(Epoch(epoch + 1, learning_rate, *training, *validation, seconds))
            self._save_epoch()
            if curves is not None:
                curves.write(self.history[-1:])
        if curves is not None:
            curves.close()
        run.write_history(self.folder, self.history)
        if resumed < config.epochs or not (self.folder / run_files.METRICS).exists():
            write_run_summary(self.folder, self.metadata, self.history, device)
        return Outcome(self.folder, self.history, resumed, SCORES[config.target])

    def _restore(self) -> int:
        checkpoint = run.read_last(self.folder)
        if checkpoint is None:
            return 0
        path = self.folder / run_files.LAST
        try:
            differing = run.differences(
                RunMetadata.model_validate_json(checkpoint["metadata"]), self.metadata
            )
            if differing:
                raise run.RunError(f"{path}: is another run's; it differs in {differing[0]}")
            self.history = run.checked_history([Epoch(**row) for row in checkpoint["history"]])
            if not self.history:
                raise ValueError("it holds no epoch")
            self.model.load_state_dict(checkpoint["model"])
            check_state(self.optimiser, checkpoint["optimiser"])
            self.optimiser.load_state_dict(checkpoint["optimiser"])
            if self.average is not None:
                self.average.load_state_dict(checkpoint["average"])
        except (MemoryError, run.RunError):
            raise
        except Exception as error:  # whatever a foreign checkpoint leads to
            raise run.RunError(
                f"{path}: does not fit this run ({run.first_line(error)}); --overwrite starts over"
            ) from None
        self._ensure_best()
        return len(self.history)

    def _ensure_best(self) -> None:
        """Make sure that the best weights are there; write them again if they are the last ones."""
        best = best_epoch(self.history)
        try:
            run.load_best(self.folder)
        except run.RunError as error:
            if best is not self.history[-1]:
                raise run.RunError(
                    f"{error}; the weights of epoch {best.epoch} cannot be recovered; --overwrite "
                    "starts the run over"
                ) from None
            run.write_best(self.folder, self.metadata, best, self._kept_network.state_dict())

    @property
    def _kept_network(self) -> nn.Module:
        """Network that is validated and kept: the average, as soon as there is one."""
        if self.average is None or not self.average.n_averaged:
            return self.model
        return self.average.module

    def _epoch_rows(self, epoch: int) -> Index:
        """Rows of the training images of an epoch, in the order in which they are shown."""
        rows, config = self.images.rows("train"), self.config
        balanced = config.sampling == "balanced"
        weights = sampling_weights(self.images, rows, config.data_weights, balanced)
        return rows[epoch_order(weights, config.seed, epoch)]

    def _train_epoch(self, reader: Reader, epoch: int) -> tuple[float, float]:
        """Train one epoch; return the mean loss and score of its images."""
        config = self.config
        batches = epoch_batches(self._epoch_rows(epoch), config.images_a_step)
        self.progress.epoch(epoch + 1, config.epochs, len(batches))
        self.model.train()
        loss_sum, score_sum, count = 0.0, 0.0, 0
        for step, (levels, labels) in enumerate(reader(batches, epoch)):
            learning_rate = learning_rate_of_step(config, epoch, step, len(batches))
            for parameters in self.optimiser.param_groups:
                parameters["lr"] = learning_rate
            loss, score = self._step(levels, labels)
            share_done = (epoch + (step + 1) / len(batches)) / config.epochs
            if self.average is not None and share_done > 1 - config.average_last:
                self.average.update_parameters(self.model)
            if not math.isfinite(loss):
                raise TrainingError(self._not_finite(f"epoch {epoch + 1}, step {step + 1}", loss))
            loss_sum += loss * len(labels)
            score_sum += score
            count += len(labels)
            self.progress.step(loss, score_sum / count)
        return loss_sum / count, score_sum / count

    def _step(self, levels: Tensor, labels: Tensor) -> tuple[float, float]:
        """Update the network by a batch [B, C, H, W]; return its mean loss and sum of scores."""
        self.optimiser.zero_grad(set_to_none=True)
        loss_sum, score_sum = self._loss(self.model, levels, labels)
        mean_loss = loss_sum / len(labels)
        torch.autograd.backward(mean_loss)
        if self.config.gradient_clip_norm is not None:
            nn.utils.clip_grad_norm_(self.model.parameters(), self.config.gradient_clip_norm)
        self.optimiser.step()
        return float(mean_loss.detach()), score_sum

    def _loss(self, network: nn.Module, levels: Tensor, labels: Tensor) -> tuple[Tensor, float]:
        """Sums over a batch of the loss, and of the score: right classes, or shares of joints."""
        inputs = self.metadata.normalisation(levels.to(self.device, non_blocking=True))
        with machine.autocast(self.device, self.precision):
            outputs: Tensor = network(inputs)
        targets, smoothing = labels.to(self.device), self.config.label_smoothing
        return loss_and_score(self.config.target, outputs.float(), targets, smoothing)

    def _statistics_of_average(self, reader: Reader, epoch: int) -> None:
        """Take the batch-norm statistics of averaged weights from images as they are stored.

        Those met in training are of other weights, and of augmented images.
        """
        if self._kept_network is self.model:
            return
        rows = self._epoch_rows(epoch)[:STATISTICS_IMAGES]
        batches = reader(epoch_batches(rows, self.config.images_a_step))
        device, normalise = self.device, self.metadata.normalisation
        update_bn((normalise(levels.to(device)) for levels, _ in batches), self._kept_network)

    def _validate(self, reader: Reader, epoch: int) -> tuple[float, float]:
        """Mean loss and score of the validation images."""
        model, rows = self._kept_network, self.images.rows("val")
        model.eval()
        loss_sum, score_sum = 0.0, 0.0
        with torch.no_grad():
            for levels, labels in reader(batches_in_order(rows, self.config.images_a_step)):
                loss, score = self._loss(model, levels, labels)
                loss_sum += float(loss)
                score_sum += score
        if not math.isfinite(loss_sum):
            raise TrainingError(self._not_finite(f"validation of epoch {epoch + 1}", loss_sum))
        return loss_sum / rows.size, score_sum / rows.size

    def _not_finite(self, where: str, loss: float) -> str:
        rate_now = self.config.learning_rate
        epochs_in_words = (
            f"{run_files.LAST} and {run_files.BEST} hold the epochs up to {len(self.history)}"
            if self.history
            else "no epoch was finished"
        )
        return (
            f"{where}: the loss is {loss}; a lower learning_rate (now {rate_now:g}), "
            f"gradient_clip_norm or warmup_epochs may help; {epochs_in_words}"
        )

    def _save_epoch(self) -> None:
        """Write the last epoch: the best weights first, then what the next epoch starts from."""
        row = self.history[-1]
        best = best_epoch(self.history) is row
        if best:
            run.write_best(self.folder, self.metadata, row, self._kept_network.state_dict())
        run.write_last(
            self.folder,
            {
                "metadata": self.metadata.model_dump_json(),
                "model": self.model.state_dict(),
                "average": None if self.average is None else self.average.state_dict(),
                "optimiser": self.optimiser.state_dict(),
                "history": [asdict(r) for r in self.history],
            },
        )
        run.write_history(self.folder, self.history)
        self.progress.epoch_done(row, best)


def _occurring_classes(config: TrainConfig, images: ImageSet, rows: Index) -> set[int]:
    """Numbers of the classes that occur in some rows; of labels, whoever does them."""
    if config.target == "labels":
        return set(np.flatnonzero(images.multi_hot(images.classes)[rows].any(0)).tolist())
    return set(images.label[rows].tolist())


def _training_targets(config: TrainConfig, images: ImageSet) -> Labels:
    """Target of each row: joints, multi-hot labels, or the number of the class."""
    match config.target:
        case "skeleton":
            return images.skeletons
        case "labels":
            return images.multi_hot(images.classes)
    return images.label


def _describe(
    config: TrainConfig,
    images: ImageSet,
    precision: torch.dtype,
    starting_point: StartingPoint | None,
) -> tuple[RunMetadata, list[tuple[str, str, str]]]:
    """Metadata of the run, and (name, fingerprint, scene's fingerprint) of its training images."""
    rows, validation_rows = images.rows("train"), images.rows("val")
    training_scan, validation_scan = scan(images, rows), scan(images, validation_rows)
    all_rows = np.concatenate([rows, validation_rows])
    statistics = training_scan if starting_point is None else starting_point.normalisation
    metadata = RunMetadata(
        model=config.model,
        classes=images.classes,
        size=images.size,
        map=images.map,
        channels=images.channels,
        input=config.input_kind,
        joints=images.joints,
        colours=images.colours,
        mean=statistics.mean,
        sd=statistics.sd,
        config={k: v for k, v in resolved(config).items() if k not in NOT_IDENTITY},
        data={
            "path": str(images.where),
            "hash": content_hash(
                images, all_rows, (*training_scan.digests, *validation_scan.digests)
            ),
            "train": rows.size,
            "val": validation_rows.size,
        },
        work={
            "precision": str(precision).removeprefix("torch."),
            **({"start": starting_point.sha256} if starting_point else {}),
        },
        versions={"radhar": __version__, "torch": torch.__version__, "numpy": np.__version__},
    )
    scenes = images.scenes or ("",) * len(images)
    row_digests = zip(rows.tolist(), training_scan.digests, strict=True)
    return metadata, [(images.names[row], pixels, scenes[row]) for row, pixels in row_digests]


def _warnings(config: TrainConfig, images: ImageSet) -> list[str]:
    """Warnings of classes that are not validated, and of epochs too short to learn much in."""
    validated = _occurring_classes(config, images, images.rows("val"))
    warnings = [
        f"warning: the class {name!r} has no validation image; the best epoch is chosen without it"
        for index, name in enumerate(images.classes)
        if index not in validated and config.target != "skeleton"
    ]
    count, size = images.rows("train").size, config.images_a_step
    steps = len(epoch_batches(np.arange(count), size))
    if steps < FEW_STEPS:
        warnings.append(
            f"warning: batch_size = {size}: {count} images make {steps} steps an epoch; should be "
            f"{FEW_STEPS} or more, by a smaller batch, or else many more epochs"
        )
    return warnings
