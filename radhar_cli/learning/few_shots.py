"""Accuracy after learning from a few labelled images of each class of another radar.

For every number k of labelled images: a run fine-tuned on them (k = 0: as trained), the run adapted
to all images without their labels with the labelled ones beside, where that is asked for, and a
network from scratch. Each repeat draws anew; where the data say persons, half of them are learned
from and the others tested. Each training is a run of its own, `OUT/<k>_a_class/<repeat>/<way>`, so
that the same call goes on where it was stopped. The 95 % interval is of the mean over the repeats:
of the images tested and of those drawn.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from statistics import variance
from typing import NamedTuple

import numpy as np
import torch

from radhar_cli.config.reading import with_overrides
from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.split import TRAIN, VALIDATION
from radhar_cli.errors import FolderError
from radhar_cli.files.table_text import csv_text
from radhar_cli.learning.adaptation import AdaptOptions, Mixed
from radhar_cli.learning.adaptation import adapt as adapt_run
from radhar_cli.learning.evaluated_run import EvalSet, Run, open_eval_set, open_run
from radhar_cli.learning.evaluation import open_training_images, predict_classes
from radhar_cli.learning.images.image_set import ImageSet, labels_for
from radhar_cli.learning.images.joined import joined
from radhar_cli.learning.intervals import wilson
from radhar_cli.learning.machine import choose_device
from radhar_cli.learning.run_folder import RunMetadata, load_best
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.tasks.categories import require_classifier
from radhar_cli.learning.tasks.predictions import EvalOptions
from radhar_cli.learning.training import NoTrainingProgress, TrainOptions, train
from radhar_cli.numerics.arrays import Index
from radhar_cli.numerics.randomness import TRAINING, stream
from radhar_cli.processes.progress import NO_PROGRESS, Messages

AS_TRAINED, TUNED, ADAPTED, SCRATCH = "as trained", "fine-tuned", "adapted", "from scratch"
SHOWN = 600  # labelled images an epoch, those of a few again and again; as many mixed ones
MAX_SHOWN = 16  # times an epoch that an image is fine-tuned with
BATCH = 128
TABLE = "shots.csv"


class ShotDraw(NamedTuple):
    """Rows to learn from, up to k of each class, and rows to test on."""

    labelled: Index
    tested: Index


@dataclass(frozen=True)
class ShotAccuracy:
    """Accuracy after learning from `shots` labelled images a class in one way."""

    shots: int
    learned: str  # as trained, fine-tuned, adapted or from scratch
    accuracy: float  # mean over the repeats
    interval_95: tuple[float, float]
    accuracies: list[float]  # of the repeats

    def __str__(self) -> str:
        low, high = self.interval_95
        return (
            f"{self.shots:>4} a class, {self.learned:<12} {100 * self.accuracy:5.1f} % "
            f"({100 * low:.1f} to {100 * high:.1f} %), repeats: {len(self.accuracies)}"
        )


@dataclass(frozen=True)
class ShotOptions:
    """Settings of a curve of few shots, beside its run and data."""

    shots: Sequence[int]  # numbers of labelled images of each class
    repeats: int = 5  # draws of each
    mix: Sequence[Path] = ()  # data that go on being shown while the run is fine-tuned
    adapt: int = 0  # epochs of adapting the run itself; 0 is none
    # `key=value`, of training from scratch; fine-tuning has half of its epochs
    settings: Sequence[str] = ()
    reading: EvalOptions = field(default_factory=lambda: EvalOptions("all"))  # of the data


def measure_few_shots(
    run: Path, data: Path, out: Path, options: ShotOptions, progress: Messages = NO_PROGRESS
) -> list[ShotAccuracy]:
    """Accuracy of each number of shots and way of learning; writes OUT/shots.json and shots.csv.

    Args:
        run: a trained network of classes.
        data: labelled images of another radar, all of whose splits are used.
        out: folder of all runs.
        options: shots, repeats, and how it is learned.
        progress: is told each result, and which numbers a class cannot give.

    Raises:
        ConfigError: the run finds something else than classes.
        FolderError: no number can be given.
    """
    curve = _Curve(run, data, out, options)
    results = list[ShotAccuracy]()
    for k in options.shots:
        draws = [
            draw_shots(curve.measured, k, curve.seed, repeat) for repeat in range(options.repeats)
        ]
        short = [name for draw in draws if (name := find_short_class(curve.measured, draw, k))]
        if short:
            progress.say(f"{k} a class: left out; {short[0]} has too few")
            continue
        for result in curve.measure(k, draws):
            progress.say(str(result))
            results.append(result)
    if not results:
        raise FolderError(f"{data}: has too few images of {short[0]} for any of --shots")
    write_whole(
        out, out / "shots.json", (json.dumps([*map(asdict, results)], indent=2) + "\n").encode()
    )
    header = ("shots", "learned", "accuracy", "low_95", "high_95", "repeats")
    rows = (
        (r.shots, r.learned, *(f"{x:.4f}" for x in (r.accuracy, *r.interval_95)), len(r.accuracies))
        for r in results
    )
    write_whole(out, out / TABLE, csv_text(header, rows).encode())
    return results


class _Curve:
    """Runs that learn from a few images, and their tests."""

    def __init__(self, run: Path, data: Path, out: Path, options: ShotOptions) -> None:
        self.run, self.out, self.options = run, out, options
        opened: Run = open_run(run.name, run, torch.device("cpu"))
        require_classifier(run, opened.metadata.task)
        document = opened.metadata.settings.model_dump(mode="json")
        self.scratch = TrainConfig.model_validate(with_overrides(document, options.settings))
        half = {
            "epochs": -(-self.scratch.epochs // 2),
            "warmup_epochs": self.scratch.warmup_epochs / 2,
        }
        self.tuned = self.scratch.model_copy(update=half)
        self.device = choose_device(self.scratch.device)
        self.metadata, self.seed = opened.metadata, opened.metadata.settings.seed
        self.measured = open_eval_set(opened, data, options.reading)
        self.mixed = [open_training_images(opened.metadata, path) for path in options.mix]

    def measure(self, k: int, draws: Sequence[ShotDraw]) -> list[ShotAccuracy]:
        """Accuracy of every way of learning from k images a class, drawn anew for each repeat."""
        if not k and self.measured.images.samples.person is None:
            draws = draws[:1]  # all are tested, whatever the draw
        accuracies: dict[str, list[float]] = {}
        for repeat, draw in enumerate(draws):
            for name, folder in self._learn(k, repeat, draw).items():
                accuracies.setdefault(name, []).append(self._test(folder, draw))
        tested = min(draw.tested.size for draw in draws)
        return [
            ShotAccuracy(
                k, name, sum(shares) / len(shares), interval_of_repeats(shares, tested), shares
            )
            for name, shares in accuracies.items()
        ]

    def _learn(self, k: int, repeat: int, draw: ShotDraw) -> dict[str, Path]:
        """Train in every way; {way: folder of the run}."""
        folder, seed = self.out / f"{k}_a_class" / str(repeat + 1), (self.seed + repeat) % 2**63
        ways = {TUNED: folder / "fine_tuned"} if k else {AS_TRAINED: self.run}
        beside = Mixed(joined(self.mixed)) if self.mixed else None
        labelled = self.measured.images.take(draw.labelled)
        if k:
            images, weights = join_labelled(self.metadata, labelled, self.mixed, MAX_SHOWN)
            chosen = self.tuned.model_copy(update={"data_weights": weights, "seed": seed})
            options = TrainOptions(start=self.run)
            train(chosen, images, ways[TUNED], NoTrainingProgress(), options)
            beside = Mixed(images, weights)
        if self.options.adapt:
            ways[ADAPTED] = folder / "adapted"
            unlabelled = (self.measured.images, self.measured.rows)
            epochs = self.options.adapt
            adapting = AdaptOptions(overwrite=True, epochs=epochs, mix=beside or ())
            adapt_run(self.run, unlabelled, ways[ADAPTED], self.device, adapting)
        if k:
            ways[SCRATCH] = folder / "from_scratch"
            images, weights = join_labelled(self.metadata, labelled, [], SHOWN)
            chosen = self.scratch.model_copy(update={"data_weights": weights, "seed": seed})
            train(chosen, images, ways[SCRATCH], NoTrainingProgress())
        return ways

    def _test(self, folder: Path, draw: ShotDraw) -> float:
        """Accuracy of a run on the images that are tested."""
        about, model = load_best(folder)
        model.to(self.device)
        rows = draw.tested
        predictions = predict_classes(model, about, self.measured.images, rows, self.device, BATCH)
        return float((predictions.predicted == predictions.truth).mean())


def draw_shots(data: EvalSet, k: int, seed: int, repeat: int) -> ShotDraw:
    """Draw up to k images of each class; those of a smaller k are among those of a larger one."""
    images, rng = data.images, stream(seed, TRAINING, repeat, name="shots")
    order = data.rows[rng.permutation(data.rows.size)]
    persons, may_learn = images.samples.person, np.ones(order.size, bool)
    names = sorted({persons[row] for row in data.rows}) if persons is not None else []
    apart = 1 < len(names) < data.rows.size  # several images show the same person or recording
    if apart:
        assert persons is not None
        half = set(rng.permutation(names)[: len(names) // 2].tolist())
        may_learn = np.array([persons[row] in half for row in order])
    label = images.samples.label[order]
    of_class = (order[may_learn & (label == c)] for c in range(len(images.classes)))
    labelled = np.concatenate([rows[:k] for rows in of_class])
    candidates = order[~may_learn] if apart else data.rows
    return ShotDraw(labelled, np.sort(np.setdiff1d(candidates, labelled)))


def find_short_class(data: EvalSet, draw: ShotDraw, k: int) -> str | None:
    """Find a class that gives fewer than k images to learn from, or none to test on."""
    label, classes = data.images.samples.label, data.images.classes
    learned, tested = (np.bincount(label[rows], minlength=len(classes)) for rows in draw)
    short = [name for c, name in enumerate(classes) if k and (learned[c] < k or not tested[c])]
    return short[0] if short else None


def join_labelled(
    metadata: RunMetadata, labelled: ImageSet, mix: Sequence[ImageSet], max_shown: int
) -> tuple[ImageSet, tuple[float, ...]]:
    """Images to learn from, and how often an epoch shows those of each set.

    The labelled ones are validated on as well, so that the test says nothing about the epoch.

    Args:
        metadata: description of the run, whose classes are learned.
        labelled: the few images.
        mix: images that are shown beside them.
        max_shown: times an epoch that one of the few is shown.
    """
    count, mass = len(labelled), sum(map(len, mix))
    split = np.repeat(np.array([TRAIN, VALIDATION], np.uint8), count)
    twice = labelled.take(np.tile(np.arange(count), 2))
    twice = replace(twice, samples=replace(twice.samples, split=split))
    images, epoch_size = joined([twice, *mix]), max(SHOWN, count)
    label = labels_for(images, metadata.classes)
    return (
        replace(images, classes=metadata.classes, samples=replace(images.samples, label=label)),
        (min(epoch_size / count, max_shown), *(epoch_size / mass for _ in mix)),
    )


def interval_of_repeats(shares: Sequence[float], count: int) -> tuple[float, float]:
    """Interval of 95 % of the mean of some proportions, of `count` images each.

    Wilson's, of as many images as have the variance of `count` images and that of the mean over
    the repeats together: it covers the choice of what was tested and of what was learned from.
    """
    mean = sum(shares) / len(shares)
    of_single = mean * (1 - mean)
    spread = variance(shares) / len(shares) if len(shares) > 1 else 0.0
    return wilson(mean * (n := of_single / (of_single / count + spread) if of_single else count), n)
