"""Train a network: the same result for the same config, data and machine, killed or not."""

import math
import time
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Protocol

import numpy as np
import torch
from torch import nn
from torch.optim.swa_utils import AveragedModel, update_bn

from radhar_cli import __version__
from radhar_cli.arrays import Index
from radhar_cli.config.identity import resolved
from radhar_cli.dataset.folder import folder_lock
from radhar_cli.errors import ConfigError, FolderError, RadharError
from radhar_cli.learning import run_files
from radhar_cli.learning import run_folder as run
from radhar_cli.learning.augmentation import Augmentation
from radhar_cli.learning.batches import Labels, Reader, epoch_batches, epoch_order, pieces
from radhar_cli.learning.gradient_step import TrainStep, check_state, optimiser_for, rate
from radhar_cli.learning.images.classes import renamed
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.images.joined import joined, sampling_weights
from radhar_cli.learning.images.opening import open_inputs
from radhar_cli.learning.images.scan import content_hash, scan
from radhar_cli.learning.machine import (
    ExecutionPlan,
    choose_device,
    choose_execution_plan,
    repeatable,
)
from radhar_cli.learning.models.build import build_model
from radhar_cli.learning.run_folder import Epoch, LearnedFrom, RunMetadata, best_epoch
from radhar_cli.learning.run_summary import write_run_summary
from radhar_cli.learning.settings import AugmentConfig, TrainConfig
from radhar_cli.learning.starting_point import StartingPoint, start_from
from radhar_cli.learning.targets import SCORES
from radhar_cli.progress import Messages
from radhar_cli.randomness import TRAINING, stream
from radhar_cli.worker_process import keep_memory

STATISTICS_IMAGES = 2048  # from which batch norm of averaged weights has its statistics
FEW_STEPS = 10  # an epoch; fewer are warned of
# Not part of the identity of a run; precision enters as chosen (RunMetadata.work).
NOT_IDENTITY = ("device", "workers", "threads", "precision")


class TrainingError(RadharError):
    """A run that had to stop; the checkpoints of finished epochs are kept."""


class TrainingProgress(Messages, Protocol):
    """Receives messages, and how far a training run is."""

    def epoch(self, number: int, epochs: int, steps: int) -> None:
        """An epoch begins."""

    def step(self, loss: float, accuracy: float) -> None:
        """A step is done: its loss, and the accuracy (or other score) of the epoch so far."""

    def epoch_done(self, row: Epoch, best: bool) -> None:
        """An epoch is done and on disk."""


@dataclass(frozen=True)
class Outcome:
    """What a run left."""

    folder: Path  # of the run
    history: list[Epoch]
    resumed: int  # epochs that were finished before
    score: str  # what its accuracies are

    @property
    def best(self) -> Epoch:
        """The epoch whose weights are kept."""
        return best_epoch(self.history)


def train(
    config: TrainConfig,
    data: Path | Sequence[Path],
    folder: Path,
    progress: TrainingProgress,
    overwrite: bool = False,
    names: Mapping[str, str | None] | None = None,
    start: Path | None = None,
) -> Outcome:
    """Train `config` on `data` in `folder`, or resume; nothing to do where it is complete.

    Args:
        data: a data set, or several that are combined.
        overwrite: start over in a folder that holds a run.
        names: {class of the data: class here, or None to leave it out}.
        start: a run whose best weights and normalisation are the initial ones; those of the last
            layer too if the classes are the same.

    Raises:
        FolderError: data that cannot be used.
        RunError: a folder that holds something else, or a damaged checkpoint.
        ModelError: a network that cannot be built.
        MachineError: a device that is not available.
        TrainingError: a step too large for memory, or a loss that is not finite; earlier
            checkpoints are kept.
    """
    images = checked_images(config, data, names)
    return train_on(Task(config, images, folder, overwrite, start), progress)


@dataclass(frozen=True)
class Task:
    """Arguments of `train` with the images opened."""

    config: TrainConfig
    images: ImageSet
    folder: Path
    overwrite: bool = False
    start: Path | None = None


def train_on(task: Task, progress: TrainingProgress) -> Outcome:
    """As `train`, on images that are open already."""
    images, folder = task.images, task.folder
    config = task.config.for_images(images.rows("train").size, images.frames)
    task = replace(task, config=config)
    if config.threads != "auto":
        torch.set_num_threads(config.threads)
    device = choose_device(config.device)
    repeatable(device)
    with folder_lock(folder):
        plan = choose_execution_plan(config, device)
        if device.type == "cpu":
            keep_memory()
        try:
            return _Training.prepared(task, plan, progress).run()
        except RuntimeError as error:
            # On the CPU only the message says that memory was short.
            if not isinstance(error, torch.OutOfMemoryError) and "CPUAllocator" not in str(error):
                raise
            size = config.images_a_step
            raise TrainingError(
                f"out of memory on {device.type} in a step of {size} images of {images.shape}; "
                f"should be {f'fewer: --set batch_size={size // 2}' if size > 3 else 'smaller'}"
            ) from None


def checked_images(
    config: TrainConfig, data: Path | Sequence[Path], names: Mapping[str, str | None] | None = None
) -> ImageSet:
    """Open a data set, or several as one, and make sure that it can be learned from.

    Raises:
        FolderError: fewer than two classes, a class without training images, no validation images.
    """
    paths = [data] if isinstance(data, Path) else list(data)
    if config.data_weights is not None and len(config.data_weights) != len(paths):
        raise ConfigError(
            f"data_weights = {list(config.data_weights)}: should have a weight for each of the "
            f"{len(paths)} data sets"
        )
    sets = [
        renamed(open_inputs(path, config.map, config), names or {}).cut(
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
    learned = set(images.label[rows].tolist())
    if config.target == "labels":
        learned = set(np.flatnonzero(images.shows(images.classes)[rows].any(0)).tolist())
    for index, name in enumerate(images.classes):
        if index not in learned:
            raise FolderError(f"{path}: the class {name!r} has no training image")
    images.rows("val")
    return images


@dataclass
class _Training:
    task: Task
    metadata: RunMetadata
    plan: ExecutionPlan
    progress: TrainingProgress
    model: nn.Module
    optimiser: torch.optim.Optimizer
    average: AveragedModel | None
    history: list[Epoch] = field(default_factory=list)

    @classmethod
    def prepared(cls, task: Task, plan: ExecutionPlan, progress: TrainingProgress) -> "_Training":
        config, images = task.config, task.images
        torch.manual_seed(config.seed)
        joints = config.target == "skeleton"
        outputs = 3 * len(images.joints) if joints else len(images.classes)
        model = build_model(config.model, outputs, images.size, joints)
        started = None if task.start is None else start_from(task.start, model, config, images)
        many = f"{len(images)} images of {len(images.classes)} classes"
        progress.say(f"reading {many}, {images.shape}")
        for message in (*_warnings(task), *(started.notes if started else ())):
            progress.say(message)
        metadata, digests = _metadata(task, plan, started)
        scenes = images.scenes or ("",) * len(images)
        learned = [(images.names[row], pixels, scenes[row]) for row, pixels in digests.items()]
        run.reserve_run(task.folder, metadata, task.overwrite)
        run.write_trained_on(task.folder, learned)
        model.to(plan.device)
        average = AveragedModel(model) if config.average_last else None
        optimiser = optimiser_for(config, model)
        return cls(task, metadata, plan, progress, model, optimiser, average)

    def run(self) -> Outcome:
        resumed = self._restore()
        self._announce(resumed)
        task, plan = self.task, self.plan
        augmentation = None
        if task.config.augment != AugmentConfig():
            augmentation = Augmentation(task.config.augment, task.config.seed)
        pin, label = plan.device.type == "cuda", _wanted(task)
        reader = Reader(task.images.pixels, label, plan.workers, pin, augmentation)
        for epoch in range(resumed, task.config.epochs):
            began = time.perf_counter()
            # Of dropout and the like, for this epoch alone, so that a run can resume.
            layers = stream(task.config.seed, TRAINING, epoch, name="layers")
            torch.manual_seed(int(layers.integers(2**63)))
            training = self._train_epoch(reader, epoch)
            self._statistics_of_average(reader, epoch)
            validation = self._validate(reader, epoch)
            learning_rate = self.optimiser.param_groups[0]["lr"]
            seconds = round(time.perf_counter() - began, 3)
            row = Epoch(epoch + 1, learning_rate, *training, *validation, seconds)
            self.history.append(row)
            self._keep(row)
        run.write_history(task.folder, self.history)
        if resumed < task.config.epochs or not (task.folder / run_files.METRICS).exists():
            write_run_summary(task.folder, self.metadata, self.history, self.model, plan)
        return Outcome(task.folder, self.history, resumed, SCORES[task.config.target])

    @property
    def _train_step(self) -> TrainStep:
        return TrainStep(self.task.config, self.metadata.normalisation, self.plan)

    def _restore(self) -> int:
        checkpoint = run.read_last(self.task.folder)
        if checkpoint is None:
            return 0
        path = self.task.folder / run_files.LAST
        try:
            other = run.differences(
                RunMetadata.model_validate_json(checkpoint["metadata"]), self.metadata
            )
            if other:
                raise run.RunError(f"{path}: is another run's; it differs in {other[0]}")
            self.history = run.checked_history([Epoch(**row) for row in checkpoint["history"]])
            if not self.history:
                raise ValueError("it holds no epoch")
            self.model.load_state_dict(checkpoint["model"])
            check_state(self.optimiser, checkpoint["optimiser"])
            self.optimiser.load_state_dict(checkpoint["optimiser"])
            if self.average is not None:
                self.average.load_state_dict(checkpoint["average"])
            torch.set_rng_state(checkpoint["random"])
        except (MemoryError, run.RunError):
            raise
        except Exception as error:  # whatever a foreign checkpoint leads to
            raise run.RunError(
                f"{path}: does not fit this run ({run.first_line(error)}); --overwrite starts over"
            ) from None
        self._ensure_best()
        return len(self.history)

    def _ensure_best(self) -> None:
        """Make sure that the best weights are there; write them again if they are the last ones.

        Raises:
            RunError: they are gone, or damaged.
        """
        best = best_epoch(self.history)
        try:
            run.load_best(self.task.folder)
        except run.RunError as error:
            if best is not self.history[-1]:
                raise run.RunError(
                    f"{error}; the weights of epoch {best.epoch} cannot be recovered; --overwrite "
                    "starts the run over"
                ) from None
            run.write_best(self.task.folder, self.metadata, best, self._kept.state_dict())

    @property
    def _kept(self) -> nn.Module:
        """The network that is validated and kept: the average, as soon as there is one."""
        if self.average is None or not self.average.n_averaged:
            return self.model
        return self.average.module

    def _announce(self, resumed: int) -> None:
        plan, say = self.plan, self.progress.say
        if resumed:
            say(f"resuming: {resumed} of {self.task.config.epochs} epochs are done")
        say(f"on {plan.device.type}, {plan.precision_name}, {torch.get_num_threads()} threads")

    def _epoch_rows(self, epoch: int) -> Index:
        """Rows of the training images of an epoch, in the order in which they are shown."""
        rows, config = self.task.images.rows("train"), self.task.config
        balanced = config.sampling == "balanced"
        weights = sampling_weights(self.task.images, rows, config.data_weights, balanced)
        return rows[epoch_order(weights, config.seed, epoch)]

    def _train_epoch(self, reader: Reader, epoch: int) -> tuple[float, float]:
        """One epoch of steps; returns mean loss and accuracy of its batches."""
        config = self.task.config
        batches = epoch_batches(self._epoch_rows(epoch), config.images_a_step)
        self.progress.epoch(epoch + 1, config.epochs, len(batches))
        self.model.train()
        train_step = self._train_step
        loss_sum, right, count = 0.0, 0.0, 0
        for step, (levels, labels) in enumerate(reader(batches, epoch)):
            learning_rate = rate(config, epoch, step, len(batches))
            for parameters in self.optimiser.param_groups:
                parameters["lr"] = learning_rate
            loss, correct = train_step.step(self.model, self.optimiser, levels, labels)
            done = (epoch + (step + 1) / len(batches)) / config.epochs
            if self.average is not None and done > 1 - config.average_last:
                self.average.update_parameters(self.model)
            if not math.isfinite(loss):
                raise TrainingError(self._not_finite(f"epoch {epoch + 1}, step {step + 1}", loss))
            loss_sum += loss * len(labels)
            right += correct
            count += len(labels)
            self.progress.step(loss, right / count)
        return loss_sum / count, right / count

    def _statistics_of_average(self, reader: Reader, epoch: int) -> None:
        """Take the batch-norm statistics of averaged weights from images as they are stored.

        Those met in training are of other weights, and of augmented images.
        """
        if self._kept is self.model:
            return
        rows = self._epoch_rows(epoch)[:STATISTICS_IMAGES]
        size = self.task.config.images_a_step
        device, normalise = self.plan.device, self.metadata.normalisation
        clean = (normalise(levels.to(device)) for levels, _ in reader(epoch_batches(rows, size)))
        update_bn(clean, self._kept)

    def _validate(self, reader: Reader, epoch: int) -> tuple[float, float]:
        """Mean loss and accuracy over the validation images."""
        model, rows = self._kept, self.task.images.rows("val")
        model.eval()
        loss_sum, right = 0.0, 0.0
        with torch.no_grad():
            for levels, labels in reader(pieces(rows, self.task.config.images_a_step)):
                loss, correct = self._train_step.loss_and_correct(model, levels, labels)
                loss_sum += float(loss)
                right += correct
        if not math.isfinite(loss_sum):
            raise TrainingError(self._not_finite(f"validation of epoch {epoch + 1}", loss_sum))
        return loss_sum / rows.size, right / rows.size

    def _not_finite(self, where: str, loss: float) -> str:
        rate_now = self.task.config.learning_rate
        kept = (
            f"{run_files.LAST} and {run_files.BEST} hold the epochs up to {len(self.history)}"
            if self.history
            else "no epoch was finished"
        )
        return (
            f"{where}: the loss is {loss}; a lower learning_rate (now {rate_now:g}), "
            f"gradient_clip_norm or warmup_epochs may help; {kept}"
        )

    def _keep(self, row: Epoch) -> None:
        """Put an epoch on disk: the best weights first, then what the next epoch starts from."""
        best = best_epoch(self.history) is row
        if best:
            run.write_best(self.task.folder, self.metadata, row, self._kept.state_dict())
        run.write_last(
            self.task.folder,
            {
                "metadata": self.metadata.model_dump_json(),
                "model": self.model.state_dict(),
                "average": None if self.average is None else self.average.state_dict(),
                "optimiser": self.optimiser.state_dict(),
                "history": [asdict(r) for r in self.history],
                "random": torch.get_rng_state(),
            },
        )
        run.write_history(self.task.folder, self.history)
        self.progress.epoch_done(row, best)


def _wanted(task: Task) -> Labels:
    """What is to be learned of each row."""
    images = task.images
    match task.config.target:
        case "skeleton":
            return images.skeletons
        case "labels":
            return images.shows(images.classes)
    return images.label


def _metadata(
    task: Task, plan: ExecutionPlan, started: StartingPoint | None
) -> tuple[RunMetadata, dict[int, str]]:
    """Metadata of the run, and the digest of every training image by row."""
    config, images = task.config, task.images
    rows, validating = images.rows("train"), images.rows("val")
    learned, checked = scan(images, rows), scan(images, validating)
    seen = np.concatenate([rows, validating])
    data: LearnedFrom = {
        "path": str(images.where),
        "hash": content_hash(images, seen, (*learned.digests, *checked.digests)),
        "train": rows.size,
        "val": validating.size,
    }
    mean, sd = learned.mean, learned.sd
    if started is not None:
        mean, sd = started.normalisation.mean, started.normalisation.sd
    kept = {k: v for k, v in resolved(config).items() if k not in NOT_IDENTITY}
    metadata = RunMetadata(
        model=config.model,
        classes=images.classes,
        size=images.size,
        map=images.map,
        channels=images.channels,
        input=config.reads,
        joints=images.joints,
        mean=mean,
        sd=sd,
        config=kept,
        data=data,
        work={
            "precision": plan.precision_name,
            **({"start": started.sha256} if started else {}),
        },
        versions={"radhar": __version__, "torch": torch.__version__, "numpy": np.__version__},
    )
    return metadata, dict(zip(rows.tolist(), learned.digests, strict=True))


def _warnings(task: Task) -> list[str]:
    """Of classes that are not validated, and of epochs too short to learn much in."""
    images = task.images
    checked = set(images.label[images.rows("val")].tolist())
    warnings = [
        f"warning: the class {name!r} has no validation image; the best epoch is chosen without it"
        for index, name in enumerate(images.classes)
        if index not in checked
    ]
    count, size = images.rows("train").size, task.config.images_a_step
    steps = len(epoch_batches(np.arange(count), size))
    if steps < FEW_STEPS:
        warnings.append(
            f"warning: batch_size = {size}: {count} images make {steps} steps an epoch; should be "
            f"{FEW_STEPS} or more, by a smaller batch, or else many more epochs"
        )
    return warnings
