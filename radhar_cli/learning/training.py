"""Train a network: the same result for the same config, data and machine, killed or not."""

import copy
import math
import time
from contextlib import nullcontext
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Protocol

import numpy as np
import torch
from torch import Tensor, nn
from torch.nn.functional import cross_entropy

from radhar_cli import __version__
from radhar_cli.arrays import Index
from radhar_cli.config.identity import resolved
from radhar_cli.dataset.folder import locked
from radhar_cli.errors import FolderError, RadharError
from radhar_cli.learning import run_folder as run
from radhar_cli.learning.batches import Normalisation, Reader, epoch_batches
from radhar_cli.learning.images import ImageSet, content_hash, open_images, scan
from radhar_cli.learning.machine import (
    Group,
    autocast,
    choose_device,
    choose_precision,
    convolutions_channels_last,
    joined,
    keep_memory,
    largest_batch,
    repeatable,
)
from radhar_cli.learning.models.build import build_model, check_size
from radhar_cli.learning.run_folder import About, Epoch, best_epoch
from radhar_cli.learning.schedule import rate
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.randomness import TRAINING, stream

# Where the work is done does not decide what is learned.
NOT_IDENTITY = ("device", "workers", "threads")
CUDA_WORKERS = 8


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
class Work:
    """How this machine does the work.

    Attributes:
        device, precision: where and in what.
        micro_batch: images at once in one process; gradients are summed over as many as needed.
        workers: reading processes.
    """

    device: torch.device
    precision: torch.dtype
    micro_batch: int
    workers: int

    def parts(self, images: int) -> int:
        """Parts in which a process does its share of a batch."""
        return -(-images // self.micro_batch)


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
    config: TrainConfig, data: Path, folder: Path, progress: Progress, overwrite: bool = False
) -> Outcome:
    """Train `config` on `data` in `folder`, go on with it, or find it done.

    Under torchrun every process calls this; the first one writes.

    Raises:
        FolderError: data that cannot be used.
        RunError: a folder that holds something else, or a damaged checkpoint.
        ModelError, MachineError: a network or a device that cannot be had.
        TrainingError: the loss is not finite; earlier checkpoints are kept.
    """
    keep_memory()
    if config.threads != "auto":
        torch.set_num_threads(config.threads)
    device = choose_device(config.device)
    repeatable(device)
    with joined(device) as group, locked(folder) if group.leads else nullcontext():
        return _Training.prepared(config, data, folder, device, group, progress, overwrite).run()


def checked_images(config: TrainConfig, path: Path) -> ImageSet:
    """Open a data set and make sure that it can be learned from.

    Raises:
        FolderError: sides that are no multiples of 32, fewer than two classes, a class without
            training images, no validation images.
    """
    images = open_images(path, config.map, config.input)
    images = images.cut(config.validation_share, config.seed)
    check_size(config.model, images.size, path)
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
    about: About
    folder: Path
    work: Work
    group: Group
    progress: Progress
    model: nn.Module
    optimiser: torch.optim.Optimizer
    history: list[Epoch]

    @classmethod
    def prepared(
        cls,
        config: TrainConfig,
        data: Path,
        folder: Path,
        device: torch.device,
        group: Group,
        progress: Progress,
        overwrite: bool,
    ) -> "_Training":
        images = checked_images(config, data)
        if group.leads:
            progress.say(f"reading {len(images)} images of {len(images.classes)} classes")
        about = _about(config, images, data)
        if group.leads:
            run.claim_run(folder, about[0], overwrite)
            _write_trained_on(folder, images, about[1])
        _together(group)
        torch.manual_seed(config.seed)
        model = build_model(config.model, len(images.classes), images.size)
        precision = choose_precision(config.precision, device)
        work = Work(
            device,
            precision,
            _micro_batch(config, model, images.size, device, precision, group),
            _workers(config, device),
        )
        convolutions_channels_last(model.to(device))
        return cls(
            config=config,
            images=images,
            about=about[0],
            folder=folder,
            work=work,
            group=group,
            progress=progress,
            model=model,
            optimiser=_optimiser(config, model),
            history=[],
        )

    def run(self) -> Outcome:
        went_on = self._restore()
        if self.group.leads:
            self._announce(went_on)
        network = self._network()
        reader = Reader(
            self.images, self.images.label, self.work.workers, self.work.device.type == "cuda"
        )
        for epoch in range(went_on, self.config.epochs):
            began = time.perf_counter()
            torch.manual_seed(self._epoch_seed(epoch))
            learned = self._learn(network, reader, epoch)
            seen = self._validate(reader, epoch)
            if self.group.leads:
                self._keep(epoch, learned, seen, time.perf_counter() - began)
            else:
                self.history.append(_row(epoch, 0.0, learned, seen, 0.0))
        already_told = went_on == self.config.epochs and (self.folder / run.METRICS).exists()
        if self.group.leads and not already_told:
            self._finish()
        _together(self.group)
        return Outcome(self.folder, self.history, went_on)

    def _network(self) -> nn.Module:
        if self.group.size == 1:
            return self.model
        from torch.nn.parallel import DistributedDataParallel

        ids = [self.work.device.index] if self.work.device.type == "cuda" else None
        return DistributedDataParallel(self.model, device_ids=ids)

    def _restore(self) -> int:
        found = run.read_last(self.folder)
        if found is None:
            return 0
        try:
            self.model.load_state_dict(found["model"])
            self.optimiser.load_state_dict(found["optimiser"])
            self.history = [Epoch(**row) for row in found["history"]]
        except (RuntimeError, ValueError, KeyError, TypeError) as error:
            raise run.RunError(
                f"{self.folder / run.LAST}: does not fit this run "
                f"({str(error).splitlines()[0]}); --overwrite starts it again"
            ) from None
        return len(self.history)

    def _announce(self, went_on: int) -> None:
        work, say, size = self.work, self.progress.say, self.config.batch_size
        if went_on:
            say(f"going on: {went_on} of {self.config.epochs} epochs are done")
        share = -(-size // self.group.size)
        precision = "bfloat16" if work.precision == torch.bfloat16 else "float32"
        many = f", {self.group.size} processes" if self.group.size > 1 else ""
        say(f"on {work.device.type}{many}, {precision}, {torch.get_num_threads()} threads")
        if work.parts(share) > 1:
            say(
                f"a batch of {size} goes in {work.parts(share)} parts of {work.micro_batch} a "
                f"process: gradients are summed, but batch norm sees {work.micro_batch} images at "
                f"once, so this is not the same as a batch of {size}"
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
        if group.leads:
            self.progress.epoch(epoch + 1, config.epochs, len(batches))
        mine = [rows[batch[group.rank :: group.size]] for batch in batches]
        network.train()
        totals = np.zeros(3)
        for step, (levels, labels) in enumerate(reader(mine)):
            learning_rate = rate(config, epoch, step / len(batches))
            for parameters in self.optimiser.param_groups:
                parameters["lr"] = learning_rate
            loss, right = self._step(network, levels, labels, batches[step].size)
            if not math.isfinite(loss):
                raise TrainingError(self._not_finite(f"epoch {epoch + 1}, step {step + 1}", loss))
            totals += (loss * len(labels), right, len(labels))
            if group.leads:
                self.progress.step(loss, totals[1] / totals[2])
        totals = _summed(totals, group)
        return totals[0] / totals[2], totals[1] / totals[2]

    def _step(
        self, network: nn.Module, levels: Tensor, labels: Tensor, whole: int
    ) -> tuple[float, int]:
        """One update from this process's share of a batch of `whole` images.

        Returns the mean loss of the share, and how many of it were right.
        """
        config, work, group = self.config, self.work, self.group
        self.optimiser.zero_grad(set_to_none=True)
        loss_sum, right = 0.0, 0
        size = work.micro_batch
        cuts = range(0, len(labels), size)
        parts = [(levels[cut : cut + size], labels[cut : cut + size]) for cut in cuts]
        for number, (images, wanted) in enumerate(parts):
            last = number == len(parts) - 1
            waits = nullcontext() if last or group.size == 1 else _no_sync(network)
            with waits:
                wanted = wanted.to(work.device)
                logits = _logits(network, images, self.about.normalisation, work)
                loss = cross_entropy(
                    logits, wanted, label_smoothing=config.label_smoothing, reduction="sum"
                )
                # Processes average their gradients: the sum over all, divided by the whole batch.
                torch.autograd.backward(loss * (group.size / whole))
            loss_sum += float(loss.detach())
            right += int((logits.argmax(1) == wanted).sum())
        if config.gradient_clip_norm is not None:
            nn.utils.clip_grad_norm_(self.model.parameters(), config.gradient_clip_norm)
        self.optimiser.step()
        return loss_sum / len(labels), right

    def _validate(self, reader: Reader, epoch: int) -> tuple[float, float]:
        """Mean loss and accuracy over the validation images, shared by the processes."""
        group = self.group
        if group.size > 1:  # batch norm's averages are the first process's
            import torch.distributed as dist

            for buffer in self.model.buffers():
                dist.broadcast(buffer, 0)
        rows = self.images.rows("val")
        mine = rows[group.rank :: group.size]
        size = min(self.config.batch_size, self.work.micro_batch)
        self.model.eval()
        totals = np.zeros(3)
        with torch.no_grad():
            for levels, labels in reader(_pieces(mine, size)):
                wanted = labels.to(self.work.device)
                logits = _logits(self.model, levels, self.about.normalisation, self.work)
                loss = cross_entropy(
                    logits, wanted, label_smoothing=self.config.label_smoothing, reduction="sum"
                )
                right = int((logits.argmax(1) == wanted).sum())
                totals += (float(loss), right, len(labels))
        totals = _summed(totals, group)
        if not math.isfinite(totals[0]):
            raise TrainingError(self._not_finite(f"validation of epoch {epoch + 1}", totals[0]))
        return totals[0] / totals[2], totals[1] / totals[2]

    def _not_finite(self, where: str, loss: float) -> str:
        kept = (
            f"{run.LAST} and {run.BEST} hold the epochs up to {len(self.history)}"
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
        from radhar_cli.learning.run_summary import write_run_summary

        write_run_summary(self.folder, self.about, self.history, self.model, self.work, self.group)


def _about(config: TrainConfig, images: ImageSet, data: Path) -> tuple[About, dict[int, str]]:
    """What the run is about, and the fingerprint of every image it looked at, by row."""
    rows = np.concatenate([images.rows("train"), images.rows("val")])
    learned, checked = scan(images, images.rows("train")), scan(images, images.rows("val"))
    prints = (*learned.prints, *checked.prints)
    mean, sd = learned.mean, learned.sd
    kept = {k: v for k, v in resolved(config).items() if k not in NOT_IDENTITY}
    about = About(
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
            "hash": content_hash(images, rows, prints),
            "train": len(learned.prints),
            "val": len(checked.prints),
        },
        versions={"radhar": __version__, "torch": torch.__version__, "numpy": np.__version__},
    )
    return about, dict(zip(rows.tolist(), prints, strict=True))


def _write_trained_on(folder: Path, images: ImageSet, prints: dict[int, str]) -> None:
    rows = images.rows("train").tolist()
    run.write_trained_on(
        folder,
        [images.names[row] for row in rows],
        [prints[row] for row in rows],
        [images.scenes[row] if images.scenes else "" for row in rows],
    )


def _optimiser(config: TrainConfig, model: nn.Module) -> torch.optim.Optimizer:
    """L2 regularisation of the weights; biases and batch norms are left free."""
    weights = [p for p in model.parameters() if p.ndim > 1]
    others = [p for p in model.parameters() if p.ndim <= 1]
    groups: list[dict[str, Any]] = [
        {"params": weights, "weight_decay": config.weight_decay},
        {"params": others, "weight_decay": 0.0},
    ]
    groups = [group for group in groups if group["params"]]
    if config.optimiser == "adam":
        return torch.optim.Adam(groups, lr=config.learning_rate)
    if config.optimiser == "adamw":
        return torch.optim.AdamW(groups, lr=config.learning_rate)
    return torch.optim.SGD(groups, lr=config.learning_rate, momentum=0.9)


def _micro_batch(
    config: TrainConfig,
    model: nn.Module,
    size: tuple[int, int],
    device: torch.device,
    precision: torch.dtype,
    group: Group,
) -> int:
    if config.micro_batch != "auto":
        return config.micro_batch
    saved = _saved_bytes(model, size, precision)
    return min(config.batch_size, largest_batch(saved, device, group.local_size))


def _saved_bytes(model: nn.Module, size: tuple[int, int], precision: torch.dtype) -> int:
    """Bytes of one image that a forward pass keeps for the backward pass."""
    kept: dict[int, int] = {}

    def pack(tensor: Tensor) -> Tensor:
        kept[tensor.untyped_storage().data_ptr()] = tensor.untyped_storage().nbytes()
        return tensor

    trial, images = copy.deepcopy(model).train(), torch.zeros(2, 3, *size)
    own = {p.untyped_storage().data_ptr() for p in trial.parameters()}
    with (
        torch.random.fork_rng(devices=[]),
        torch.autograd.graph.saved_tensors_hooks(pack, lambda tensor: tensor),
        autocast(torch.device("cpu"), precision),
    ):
        trial(images)
    return sum(n for pointer, n in kept.items() if pointer not in own) // 2 + 1


def _workers(config: TrainConfig, device: torch.device) -> int:
    """On the CPU the cores are busy with the network, and reading is a few per cent of a step."""
    if config.workers != "auto":
        return config.workers
    from radhar_cli.dataset.workers import cores

    return min(CUDA_WORKERS, cores()) if device.type == "cuda" else 0


def _logits(network: nn.Module, levels: Tensor, prepare: Normalisation, work: Work) -> Tensor:
    """Levels uint8 [B, 3, H, W] to logits float32 [B, classes]."""
    x = prepare(levels.to(work.device, non_blocking=True))
    with autocast(work.device, work.precision):
        logits: Tensor = network(x.contiguous(memory_format=torch.channels_last))
    return logits.float()


def _pieces(rows: Index, size: int) -> list[Index]:
    return [rows[start : start + size] for start in range(0, rows.size, size)]


def _no_sync(network: Any) -> Any:
    return network.no_sync()


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


def _summed(totals: Any, group: Group) -> Any:
    if group.size == 1:
        return totals
    import torch.distributed as dist

    device = "cuda" if dist.get_backend() == "nccl" else "cpu"
    tensor = torch.tensor(totals, dtype=torch.float64, device=device)
    dist.all_reduce(tensor)
    return tensor.cpu().numpy()


def _together(group: Group) -> None:
    if group.size > 1:
        import torch.distributed as dist

        dist.barrier()
