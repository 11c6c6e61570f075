"""Train a network: the same result for the same config, data and machine, killed or not."""

import math
import time
from collections.abc import Mapping
from contextlib import nullcontext
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Protocol

import numpy as np
import torch
from torch import nn

from radhar_cli import __version__
from radhar_cli.arrays import Float
from radhar_cli.config.identity import resolved
from radhar_cli.dataset.folder import locked
from radhar_cli.errors import ConfigError, FolderError, RadharError
from radhar_cli.learning import run_files
from radhar_cli.learning import run_folder as run
from radhar_cli.learning.batches import MIN_PER_PROCESS, Reader, epoch_batches, pieces
from radhar_cli.learning.execution_plan import ExecutionPlan, choose_execution_plan
from radhar_cli.learning.gradient_step import TrainStep, check_state, optimiser_for
from radhar_cli.learning.images.classes import renamed
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.images.opening import open_images
from radhar_cli.learning.images.scan import content_hash, scan
from radhar_cli.learning.machine import choose_device, out_of_memory, repeatable
from radhar_cli.learning.models.build import build_model
from radhar_cli.learning.process_group import (
    Group,
    all_reduce_sum,
    barrier,
    broadcast_buffers,
    distributed,
    on_rank_zero,
    process_group,
)
from radhar_cli.learning.run_folder import Epoch, RunMetadata, best_epoch
from radhar_cli.learning.run_summary import write_run_summary
from radhar_cli.learning.schedule import rate
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.randomness import TRAINING, stream

# Where the work is done does not decide what is learned; precision and micro batch do, as chosen.
NOT_IDENTITY = ("device", "workers", "threads", "precision", "micro_batch")


class TrainingError(RadharError):
    """A run that cannot go on; what the last epoch left is kept."""


class Progress(Protocol):
    """Who is told how far a training run is."""

    def say(self, message: str) -> None:
        """Something the user should read."""

    def epoch(self, number: int, epochs: int, steps: int) -> None:
        """An epoch begins."""

    def step(self, loss: float, accuracy: float) -> None:
        """A step is done: its loss, and the accuracy of the epoch so far."""

    def epoch_done(self, row: Epoch, best: bool) -> None:
        """An epoch is done and on disk."""


@dataclass(frozen=True)
class Outcome:
    """What a run left.

    Attributes:
        folder: of the run.
        history: its epochs.
        went_on: epochs that were there before.
    """

    folder: Path
    history: list[Epoch]
    went_on: int

    @property
    def best(self) -> Epoch:
        """The epoch whose weights are kept."""
        return best_epoch(self.history)


def train(
    config: TrainConfig,
    data: Path,
    folder: Path,
    progress: Progress,
    overwrite: bool = False,
    names: Mapping[str, str | None] | None = None,
) -> Outcome:
    """Train `config` on `data` in `folder`, go on with it, or find it done.

    Under torchrun every process calls this; the first one writes. `names` are those that the
    classes get, None to leave one out.

    Raises:
        FolderError: data that cannot be used.
        RunError: a folder that holds something else, or a damaged checkpoint.
        ModelError, MachineError: a network or a device that cannot be had.
        TrainingError: the loss is not finite; earlier checkpoints are kept.
    """
    if config.threads != "auto":
        torch.set_num_threads(config.threads)
    device = choose_device(config.device)
    repeatable(device)
    images = checked_images(config, data, names)
    with process_group(device) as group, locked(folder) if group.is_main else nullcontext():
        return _Training.prepared(
            config, images, data, folder, device, group, progress, overwrite
        ).run()


def checked_images(
    config: TrainConfig, path: Path, names: Mapping[str, str | None] | None = None
) -> ImageSet:
    """Open a data set and make sure that it can be learned from.

    Raises:
        FolderError: fewer than two classes, a class without training images, no validation images.
    """
    images = renamed(open_images(path, config.map, config.input), names or {})
    images = images.cut(config.validation_share, config.seed)
    if len(images.classes) < 2:
        raise FolderError(f"{path}: has the class {images.classes[0]!r} alone; should have two")
    learned = set(images.label[images.rows("train")].tolist())
    for index, name in enumerate(images.classes):
        if index not in learned:
            raise FolderError(f"{path}: the class {name!r} has no training image")
    images.rows("val")
    return images


@dataclass
class _Training:
    config: TrainConfig
    images: ImageSet
    about: RunMetadata
    folder: Path
    plan: ExecutionPlan
    group: Group
    progress: Progress
    model: nn.Module
    optimiser: torch.optim.Optimizer
    history: list[Epoch]

    @classmethod
    def prepared(
        cls,
        config: TrainConfig,
        images: ImageSet,
        data: Path,
        folder: Path,
        device: torch.device,
        group: Group,
        progress: Progress,
        overwrite: bool,
    ) -> "_Training":
        least = MIN_PER_PROCESS * group.size
        if config.batch_size < least:
            raise ConfigError(
                f"batch_size = {config.batch_size}: should be at least {least} for {group.size} "
                "processes; batch norm needs two images in each"
            )
        torch.manual_seed(config.seed)
        model = build_model(config.model, len(images.classes), images.size)
        plan = choose_execution_plan(config, device)
        if group.is_main:
            progress.say(f"reading {len(images)} images of {len(images.classes)} classes")
            for warning in _unbalanced(images):
                progress.say(f"warning: {warning}")
        about, digests = _metadata(config, images, data, plan, group)

        def claim() -> None:
            run.claim_run(folder, about, overwrite)
            _write_trained_on(folder, images, digests)

        on_rank_zero(group, claim)
        model.to(device)
        return cls(
            config=config,
            images=images,
            about=about,
            folder=folder,
            plan=plan,
            group=group,
            progress=progress,
            model=model,
            optimiser=optimiser_for(config, model),
            history=[],
        )

    def run(self) -> Outcome:
        try:
            return self._run()
        except RuntimeError as error:
            if not out_of_memory(error):
                raise
            share = -(-self.config.batch_size // self.group.size)
            micro_batch = min(self.plan.micro_batch, share)
            raise TrainingError(
                f"micro_batch = {micro_batch}: out of memory on {self.plan.device.type}; "
                f"--set micro_batch={max(2, micro_batch // 2)} needs about half "
                f"({run.first_line(error)})"
            ) from None

    def _run(self) -> Outcome:
        went_on = self._restore()
        if self.group.is_main:
            self._announce(went_on)
        network = distributed(self.model, self.plan.device, self.group)
        reader = Reader(
            self.images, self.images.label, self.plan.workers, self.plan.device.type == "cuda"
        )
        for epoch in range(went_on, self.config.epochs):
            began = time.perf_counter()
            torch.manual_seed(self._epoch_seed(epoch))
            learned = self._learn(network, reader, epoch)
            seen = self._validate(reader, epoch)
            if self.group.is_main:
                self._keep(epoch, learned, seen, time.perf_counter() - began)
            else:
                self.history.append(_row(epoch, 0.0, learned, seen, 0.0))
        if self.group.is_main:
            run.write_history(self.folder, self.history)
            if went_on < self.config.epochs or not (self.folder / run_files.METRICS).exists():
                self._finish()
        barrier(self.group)
        return Outcome(self.folder, self.history, went_on)

    @property
    def _train_step(self) -> TrainStep:
        return TrainStep(self.config, self.about.normalisation, self.plan, self.group)

    def _restore(self) -> int:
        found = run.read_last(self.folder)
        if found is None:
            return 0
        path = self.folder / run_files.LAST
        try:
            other = run.differences(RunMetadata.model_validate_json(found["about"]), self.about)
            if other:
                raise run.RunError(f"{path}: is another run's; it differs in {other[0]}")
            self.history = run.checked_history([Epoch(**row) for row in found["history"]])
            if not self.history:
                raise ValueError("it holds no epoch")
            self.model.load_state_dict(found["model"])
            check_state(self.optimiser, found["optimiser"])
            self.optimiser.load_state_dict(found["optimiser"])
            torch.set_rng_state(found["random"])
        except (
            AttributeError,
            IndexError,
            KeyError,
            RuntimeError,
            TypeError,
            ValueError,
        ) as error:
            raise run.RunError(
                f"{path}: does not fit this run ({run.first_line(error)}); --overwrite starts it "
                "again"
            ) from None
        on_rank_zero(self.group, self._look_after_best)
        return len(self.history)

    def _look_after_best(self) -> None:
        """Make sure that the best weights are there; write them again if they are the last ones.

        Raises:
            RunError: they are gone, or damaged.
        """
        best = best_epoch(self.history)
        try:
            run.load_best(self.folder)
        except run.RunError as error:
            if best is not self.history[-1]:
                raise run.RunError(
                    f"{error}; the weights of epoch {best.epoch} cannot be had again; --overwrite "
                    "starts the run again"
                ) from None
            run.write_best(self.folder, self.about, best, self.model.state_dict())

    def _announce(self, went_on: int) -> None:
        plan, say, size = self.plan, self.progress.say, self.config.batch_size
        if went_on:
            say(f"going on: {went_on} of {self.config.epochs} epochs are done")
        share = -(-size // self.group.size)
        precision = plan.precision_name
        many = f", {self.group.size} processes" if self.group.size > 1 else ""
        say(f"on {plan.device.type}{many}, {precision}, {torch.get_num_threads()} threads")
        parts = len(plan.parts(share))
        if parts > 1:
            say(
                f"a batch of {size} goes in {parts} parts a process, of at most "
                f"{plan.micro_batch}: gradients are summed, but batch norm sees one part at a "
                f"time, so this is not the same as a batch of {size}"
            )

    def _epoch_seed(self, epoch: int) -> int:
        """Seeds dropout and its like anew in every epoch and process, so that a run can go on."""
        rng = stream(self.config.seed, TRAINING, epoch, self.group.rank, name="layers")
        return int(rng.integers(2**63))

    def _learn(self, network: nn.Module, reader: Reader, epoch: int) -> tuple[float, float]:
        """One epoch of steps; returns mean loss and accuracy of what was seen on the way."""
        rows = self.images.rows("train")
        config, group = self.config, self.group
        batches = epoch_batches(rows.size, config.batch_size, config.seed, epoch, group.size)
        if group.is_main:
            self.progress.epoch(epoch + 1, config.epochs, len(batches))
        mine = [rows[batch[group.rank :: group.size]] for batch in batches]
        network.train()
        learner = self._train_step
        totals: Float = np.zeros(3)
        for step, (levels, labels) in enumerate(reader(mine)):
            learning_rate = rate(config, epoch, step, len(batches))
            for parameters in self.optimiser.param_groups:
                parameters["lr"] = learning_rate
            loss, right = learner.step(network, self.optimiser, levels, labels, batches[step].size)
            # The sum: where one process fails, all should say so.
            if not math.isfinite(all_reduce_sum(np.array([loss]), group)[0]):
                raise TrainingError(self._not_finite(f"epoch {epoch + 1}, step {step + 1}", loss))
            totals += (loss * len(labels), right, len(labels))
            if group.is_main:
                self.progress.step(loss, totals[1] / totals[2])
        totals = all_reduce_sum(totals, group)
        return totals[0] / totals[2], totals[1] / totals[2]

    def _validate(self, reader: Reader, epoch: int) -> tuple[float, float]:
        """Mean loss and accuracy over the validation images, shared by the processes."""
        group = self.group
        broadcast_buffers(self.model, group)
        rows = self.images.rows("val")
        mine = rows[group.rank :: group.size]
        size = min(self.config.batch_size, self.plan.micro_batch)
        self.model.eval()
        totals: Float = np.zeros(3)
        with torch.no_grad():
            for levels, labels in reader(pieces(mine, size)):
                loss, right = self._train_step.loss_and_correct(self.model, levels, labels)
                totals += (float(loss), right, len(labels))
        totals = all_reduce_sum(totals, group)
        if not math.isfinite(totals[0]):
            raise TrainingError(self._not_finite(f"validation of epoch {epoch + 1}", totals[0]))
        return totals[0] / totals[2], totals[1] / totals[2]

    def _not_finite(self, where: str, loss: float) -> str:
        kept = (
            f"{run_files.LAST} and {run_files.BEST} hold the epochs up to {len(self.history)}"
            if self.history
            else "no epoch was finished"
        )
        return (
            f"{where}: the loss is {loss}; a lower learning_rate (now "
            f"{self.config.learning_rate:g}), gradient_clip_norm or warmup_epochs may help; {kept}"
        )

    def _keep(
        self, epoch: int, learned: tuple[float, float], seen: tuple[float, float], seconds: float
    ) -> None:
        """Put an epoch on disk: the best weights first, then what the next epoch starts from."""
        row = _row(epoch, self.optimiser.param_groups[0]["lr"], learned, seen, seconds)
        self.history.append(row)
        best = best_epoch(self.history) is row
        weights = self.model.state_dict()
        if best:
            run.write_best(self.folder, self.about, row, weights)
        run.write_last(
            self.folder,
            {
                "about": self.about.model_dump_json(),
                "model": weights,
                "optimiser": self.optimiser.state_dict(),
                "history": [asdict(r) for r in self.history],
                "random": torch.get_rng_state(),
            },
        )
        run.write_history(self.folder, self.history)
        self.progress.epoch_done(row, best)

    def _finish(self) -> None:
        write_run_summary(self.folder, self.about, self.history, self.model, self.plan, self.group)


def _metadata(
    config: TrainConfig, images: ImageSet, data: Path, plan: ExecutionPlan, group: Group
) -> tuple[RunMetadata, dict[int, str]]:
    """What the run is about, and the fingerprint of every image it looked at, by row."""
    rows = np.concatenate([images.rows("train"), images.rows("val")])
    learned, checked = scan(images, images.rows("train")), scan(images, images.rows("val"))
    digests = (*learned.digests, *checked.digests)
    mean, sd = learned.mean, learned.sd
    kept = {k: v for k, v in resolved(config).items() if k not in NOT_IDENTITY}
    about = RunMetadata(
        model=config.model,
        classes=images.classes,
        size=images.size,
        map=images.map,
        input=config.input,
        mean=(mean[0], mean[1], mean[2]),
        sd=(sd[0], sd[1], sd[2]),
        config=kept,
        data={
            "path": str(data),
            "hash": content_hash(images, rows, digests),
            "train": len(learned.digests),
            "val": len(checked.digests),
        },
        work={
            "precision": plan.precision_name,
            "micro_batch": plan.micro_batch,
            "processes": group.size,
        },
        versions={"radhar": __version__, "torch": torch.__version__, "numpy": np.__version__},
    )
    return about, dict(zip(rows.tolist(), digests, strict=True))


def _write_trained_on(folder: Path, images: ImageSet, digests: dict[int, str]) -> None:
    rows = images.rows("train").tolist()
    run.write_trained_on(
        folder,
        [images.names[row] for row in rows],
        [digests[row] for row in rows],
        [images.scenes[row] if images.scenes else "" for row in rows],
    )


def _unbalanced(images: ImageSet) -> list[str]:
    """What is odd about a data set but no error."""
    checked = set(images.label[images.rows("val")].tolist())
    return [
        f"the class {name!r} has no validation image; the best epoch is chosen without it"
        for index, name in enumerate(images.classes)
        if index not in checked
    ]


def _row(
    epoch: int,
    learning_rate: float,
    learned: tuple[float, float],
    seen: tuple[float, float],
    seconds: float,
) -> Epoch:
    return Epoch(
        epoch=epoch + 1,
        learning_rate=learning_rate,
        train_loss=float(learned[0]),
        train_accuracy=float(learned[1]),
        val_loss=float(seen[0]),
        val_accuracy=float(seen[1]),
        seconds=round(seconds, 3),
    )
