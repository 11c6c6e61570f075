"""Train a network: the same result for the same config, data and machine, killed or not."""

import math
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Protocol

import torch

from radhar_cli.dataset.folder import folder_lock
from radhar_cli.errors import ConfigError, RadharError
from radhar_cli.learning import machine, run_files
from radhar_cli.learning import run_folder as run
from radhar_cli.learning.augmentation import Augmentation
from radhar_cli.learning.batches import Reader, batches_in_order, epoch_batches, epoch_order
from radhar_cli.learning.images.colours import recolour
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.images.joined import sampling_weights
from radhar_cli.learning.intervals import interval_in_words
from radhar_cli.learning.learner import Learner, Totals
from radhar_cli.learning.models.build import build_model
from radhar_cli.learning.optimiser import learning_rate_of_step
from radhar_cli.learning.run_folder import Epoch, RunMetadata, best_epoch
from radhar_cli.learning.run_summary import write_run_summary
from radhar_cli.learning.settings import AugmentConfig, TrainConfig
from radhar_cli.learning.starting_point import start_from
from radhar_cli.learning.tasks.task import create_task
from radhar_cli.learning.training_set import describe_run, open_training_set, training_warnings
from radhar_cli.numerics.arrays import Index
from radhar_cli.numerics.randomness import TRAINING, stream
from radhar_cli.processes.progress import Messages, NoProgress, Progress
from radhar_cli.processes.worker_process import keep_memory

STATISTICS_IMAGES = 2048  # from which batch norm of averaged weights has its statistics


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


class NoTrainingProgress(NoProgress):
    """Progress of a training run that nobody watches."""

    def epoch(self, number: int, epochs: int, steps: int) -> None:
        """Nobody sees it."""

    def step(self, loss: float, accuracy: float) -> None:
        """Nobody sees it."""

    def epoch_done(self, row: Epoch, best: bool) -> None:
        """Nobody sees it."""


class QuietTraining(NoTrainingProgress):
    """Progress of a training that is part of a study: silent, but it can be interrupted."""

    def __init__(self, progress: Progress) -> None:
        self._progress = progress

    def advance(self, count: int) -> None:
        """Give the user's interrupt its turn."""
        self._progress.advance(0)

    def step(self, loss: float, accuracy: float) -> None:
        """Give the user's interrupt its turn."""
        self._progress.advance(0)


@dataclass(frozen=True)
class TrainOptions:
    """Options of a training run beside its config and data."""

    # {class of the data: class here, or None to leave it out}
    names: Mapping[str, str | None] = field(default_factory=dict)
    # a run whose best weights and normalisation are the initial ones; those of the last layer too
    # if the classes are the same. Pictures are brought to its colours.
    start: Path | None = None
    resize: bool = False  # bring images to the size of those that `start` learned from
    overwrite: bool = False  # start over in a folder that holds a run
    tensorboard: bool = False  # write the curves for TensorBoard, too


@dataclass(frozen=True)
class Outcome:
    """Result of a training run."""

    folder: Path  # folder of the run
    history: list[Epoch]
    resumed: int  # epochs that were finished before
    score: str  # name of what its accuracies are
    interval: str  # of 95 % of the best one, in words

    @property
    def best(self) -> Epoch:
        """Epoch whose weights are kept."""
        return best_epoch(self.history)


def train(
    config: TrainConfig,
    data: Path | Sequence[Path] | ImageSet,
    folder: Path,
    progress: TrainingProgress,
    options: TrainOptions | None = None,
) -> Outcome:
    """Train a network, or resume its training; a complete run stays as it is.

    Args:
        config: model and settings.
        data: a data set, several that are combined, or images that are open already.
        folder: folder of the run.
        progress: receives messages, steps and epochs.
        options: further options; None takes the defaults.

    Raises:
        FolderError: data that cannot be used.
        RunError: a folder that holds something else, or a damaged checkpoint.
        ModelError: a network that cannot be built.
        MachineError: a device that is not available.
        TrainingError: a step too large for memory, or a loss that is not finite; earlier
            checkpoints are kept.
    """
    options = options or TrainOptions()
    images = _open_images(config, data, options)
    config = config.with_batch_size_for(images.rows("train").size, images.frames)
    if config.threads != "auto":
        torch.set_num_threads(config.threads)
    device = machine.choose_device(config.device)
    machine.use_deterministic_algorithms(device)
    if device.type == "cpu":
        keep_memory()
    with folder_lock(folder), _memory_errors_explained(config, images, device):
        return _Training(config, images, folder, progress, device, options).run(options.tensorboard)


def _open_images(
    config: TrainConfig, data: Path | Sequence[Path] | ImageSet, options: TrainOptions
) -> ImageSet:
    """Open the images of a run, in the size and the colours of the run that it starts from."""
    initial_run = None if options.start is None else run.load_best(options.start)[0]
    if options.resize and initial_run is None:
        raise ConfigError("--resize: needs --init, a run whose image size is taken")
    if isinstance(data, ImageSet):
        images = data
    else:
        size = initial_run.size if initial_run and options.resize else None
        images = open_training_set(config, data, options.names, size)
    return images if initial_run is None else recolour(images, initial_run.colours)


@contextmanager
def _memory_errors_explained(
    config: TrainConfig, images: ImageSet, device: torch.device
) -> Iterator[None]:
    """Raise TrainingError, with advice, for a step that is too large for memory."""
    try:
        yield
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


class _Training:
    """Training run in its folder: the learner, and the epochs so far."""

    def __init__(
        self,
        config: TrainConfig,
        images: ImageSet,
        folder: Path,
        progress: TrainingProgress,
        device: torch.device,
        options: TrainOptions,
    ) -> None:
        self.config, self.images = config, images
        self.folder, self.progress = folder, progress
        self.history: list[Epoch] = []
        task = create_task(config).weighted_for(images)
        torch.manual_seed(config.seed)
        model = build_model(config.model, task.outputs(images), images.size)
        start = None if options.start is None else start_from(options.start, model, config, images)
        inputs = "images" if images.is_pictures else "sequences"
        contents = f"{len(images)} {inputs} of {len(images.classes)} classes"
        progress.say(f"reading {contents}, {images.shape}")
        notes = start.notes if start else ()
        for message in (*images.notes, *training_warnings(config, task, images), *notes):
            progress.say(message)
        precision = machine.choose_precision(config.precision, device)
        self.metadata, trained_on = describe_run(config, images, precision, start)
        run.reserve_run(folder, self.metadata, options.overwrite)
        run.write_trained_on(folder, trained_on)
        self.learner = Learner(model, task, self.metadata.normalisation, device, precision)

    def run(self, tensorboard: bool = False) -> Outcome:
        """Train the epochs that are not done, and write the files of a finished run."""
        config, learner = self.config, self.learner
        resumed, device = self._restore(), learner.device
        curves = None
        if tensorboard:
            from radhar_cli.learning.tensorboard import TensorBoardCurves

            curves = TensorBoardCurves(self.folder, self.metadata, learner.task.score_name)
            curves.write(self.history)
        if resumed:
            self.progress.say(f"resuming: {resumed} of {config.epochs} epochs are done")
        precision_in_words = f"{self.metadata.work['precision']}, {torch.get_num_threads()} threads"
        self.progress.say(f"on {device.type}, {precision_in_words}")
        reader = self._reader()
        for epoch in range(resumed, config.epochs):
            self._run_epoch(reader, epoch)
            if curves is not None:
                curves.write(self.history[-1:])
        if curves is not None:
            curves.close()
        run.write_history(self.folder, self.history)
        numbers = self._validation_numbers(reader)
        if resumed < config.epochs or not (self.folder / run_files.METRICS).exists():
            write_run_summary(self.folder, self.metadata, self.history, numbers, device)
        ends, over = numbers[f"{learner.task.score_key}_95"], numbers["interval_over"]
        interval = interval_in_words(ends, over)
        return Outcome(self.folder, self.history, resumed, learner.task.score_name, interval)

    def _reader(self) -> Reader:
        """Reader of the images and their targets, which augments those of training."""
        config, images, device = self.config, self.images, self.learner.device
        augmentation = None
        if config.augment != AugmentConfig():
            augmentation = Augmentation(config.augment, config.seed)
        targets = self.learner.task.targets(images)
        workers = machine.reading_workers(config.workers, device)
        return Reader(images.pixels, targets, augmentation, workers, pin=device.type == "cuda")

    def _run_epoch(self, reader: Reader, epoch: int) -> None:
        """Train and validate an epoch, and write it."""
        learner, start_s = self.learner, time.perf_counter()
        # Of dropout and the like, for this epoch alone, so that a run can resume.
        layers = stream(self.config.seed, TRAINING, epoch, name="layers")
        torch.manual_seed(int(layers.integers(2**63)))
        training = self._train_epoch(reader, epoch)
        if learner.kept_network is not learner.model:
            rows = self._epoch_rows(epoch)[:STATISTICS_IMAGES]
            batches = epoch_batches(rows, self.config.images_a_step)
            learner.update_average_statistics(reader(batches))
        validation = self._validate(reader, epoch)
        self.history.append(
            Epoch(
                epoch=epoch + 1,
                learning_rate=learner.optimiser.param_groups[0]["lr"],
                train_loss=training.loss,
                train_accuracy=training.score,
                val_loss=validation.loss,
                val_accuracy=validation.score,
                seconds=round(time.perf_counter() - start_s, 3),
            )
        )
        self._save_epoch()

    def _validation_numbers(self, reader: Reader) -> dict[str, Any]:
        """Score of the network that is kept and its interval, by their keys in metrics.json."""
        network, task = run.load_best(self.folder)[1], self.learner.task
        scores = self.learner.scores(network, reader(self._validation_batches()))
        return task.validation_numbers(scores, task.groups(self.images, self.images.rows("val")))

    def _validation_batches(self) -> list[Index]:
        """Rows of the validation images, batch by batch."""
        return batches_in_order(self.images.rows("val"), self.config.images_a_step)

    def _epoch_rows(self, epoch: int) -> Index:
        """Rows of the training images of an epoch, in the order in which they are shown."""
        rows, config = self.images.rows("train"), self.config
        balanced = config.sampling == "balanced"
        weights = sampling_weights(self.images, rows, config.data_weights, balanced)
        return rows[epoch_order(weights, config.seed, epoch)]

    def _train_epoch(self, reader: Reader, epoch: int) -> Totals:
        """Train one epoch; return the loss and score of its images."""
        config, learner, totals = self.config, self.learner, Totals()
        batches = epoch_batches(self._epoch_rows(epoch), config.images_a_step)
        self.progress.epoch(epoch + 1, config.epochs, len(batches))
        learner.model.train()
        for step, (levels, targets) in enumerate(reader(batches, epoch)):
            learner.set_learning_rate(learning_rate_of_step(config, epoch, step, len(batches)))
            loss, score_sum = learner.train_step(levels, targets)
            self._require_finite(loss, f"epoch {epoch + 1}, step {step + 1}")
            learner.update_average((epoch + (step + 1) / len(batches)) / config.epochs)
            totals.add(loss * len(targets), score_sum, len(targets))
            self.progress.step(loss, totals.score)
        return totals

    def _validate(self, reader: Reader, epoch: int) -> Totals:
        """Loss and score of the validation images."""
        totals = self.learner.validate(reader(self._validation_batches()))
        self._require_finite(totals.loss_sum, f"validation of epoch {epoch + 1}")
        return totals

    def _require_finite(self, loss: float, where: str) -> None:
        """Raise TrainingError for a loss that is not finite."""
        if math.isfinite(loss):
            return
        rate_now = self.config.learning_rate
        epochs_in_words = (
            f"{run_files.LAST} and {run_files.BEST} hold the epochs up to {len(self.history)}"
            if self.history
            else "no epoch was finished"
        )
        raise TrainingError(
            f"{where}: the loss is {loss}; a lower learning_rate (now {rate_now:g}), "
            f"gradient_clip_norm or warmup_epochs may help; {epochs_in_words}"
        )

    def _save_epoch(self) -> None:
        """Write the last epoch: the best weights first, then the state of the next epoch."""
        row = self.history[-1]
        is_best = best_epoch(self.history) is row
        if is_best:
            self._write_best(row)
        run.write_last(
            self.folder,
            {
                "metadata": self.metadata.model_dump_json(),
                **self.learner.state(),
                "history": [asdict(epoch) for epoch in self.history],
            },
        )
        run.write_history(self.folder, self.history)
        self.progress.epoch_done(row, is_best)

    def _write_best(self, epoch: Epoch) -> None:
        """Write the weights of the last epoch as the best ones."""
        weights = self.learner.kept_network.state_dict()
        run.write_best(self.folder, self.metadata, epoch, weights)

    def _restore(self) -> int:
        """Go on from the last epoch that is on disk; return the number of epochs that are done."""
        checkpoint = run.read_last(self.folder)
        if checkpoint is None:
            return 0
        path = self.folder / run_files.LAST
        try:
            stored_metadata = RunMetadata.model_validate_json(checkpoint["metadata"])
            differing = run.differences(stored_metadata, self.metadata)
            if differing:
                raise run_files.RunError(f"{path}: is another run's; it differs in {differing[0]}")
            self.history = run.require_valid_history(
                [Epoch(**row) for row in checkpoint["history"]]
            )
            if not self.history:
                raise ValueError("it holds no epoch")
            self.learner.restore(checkpoint)
        except (MemoryError, run_files.RunError):
            raise
        except Exception as error:  # whatever a foreign checkpoint leads to
            raise run_files.RunError(
                f"{path}: does not fit this run ({run.first_line(error)}); --overwrite starts over"
            ) from None
        self._ensure_best()
        return len(self.history)

    def _ensure_best(self) -> None:
        """Make sure that the best weights are there; write them again if they are the last ones."""
        best = best_epoch(self.history)
        try:
            run.load_best(self.folder)
        except run_files.RunError as error:
            if best is not self.history[-1]:
                raise run_files.RunError(
                    f"{error}; the weights of epoch {best.epoch} cannot be recovered; --overwrite "
                    "starts the run over"
                ) from None
            self._write_best(best)
