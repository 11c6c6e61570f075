"""`radhar eval --shots`: accuracy after learning from a few labelled images of each class.

Twice for every number of labelled images: fine-tuned from a run, and from scratch. Each is a
training run in a folder of its own, so work that was interrupted goes on where it was.
"""

import json
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch

from radhar_cli.arrays import Index
from radhar_cli.config.reading import changed_section
from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.split import TRAIN, VALIDATION
from radhar_cli.errors import FolderError
from radhar_cli.figures.shots import shots_png
from radhar_cli.learning.adaptation import Mixed, adapt_to
from radhar_cli.learning.evaluation import predict, training_images
from radhar_cli.learning.images.classes import unknown_message
from radhar_cli.learning.images.image_set import ImageSet, labels_for
from radhar_cli.learning.images.joined import joined
from radhar_cli.learning.metrics import interval_of_repeats
from radhar_cli.learning.run_folder import Epoch, RunMetadata, load_best
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.single_result import (
    EvalOptions,
    EvalSet,
    open_eval_set,
    open_run,
    seen_in_training,
    seen_message,
)
from radhar_cli.learning.tables import csv_text
from radhar_cli.learning.training import Task, train_on
from radhar_cli.progress import Messages
from radhar_cli.randomness import TRAINING, stream

AS_TRAINED, TUNED, ADAPTED, SCRATCH = "as trained", "fine-tuned", "adapted", "from scratch"
WAYS = (AS_TRAINED, TUNED, ADAPTED, SCRATCH)
SHOWN = 600  # labelled images an epoch, those of a few again and again; as many mixed ones
MAX_SHOWN = 16  # times an epoch that an image is fine-tuned with
NUMBERS, TABLE, FIGURE = "shots.json", "shots.csv", "shots.png"


@dataclass(frozen=True)
class ShotOptions:
    """Options of `radhar eval --shots`.

    Attributes:
        shots: numbers of labelled images of each class.
        repeats: draws of each number.
        mix: data that go on being shown while the run is fine-tuned, the run's own.
        overrides: `key=value` of both ways of learning.
        tuning: `key=value` of fine-tuning alone.
        adapting: epochs of `adaptation.adapt` of the run itself, to all images without their
            labels, with the labelled ones and `mix` shown beside them; 0 for none.
        overwrite: start again in folders that hold other runs.
    """

    shots: tuple[int, ...]
    repeats: int = 5
    mix: tuple[Path, ...] = ()
    overrides: tuple[str, ...] = ()
    tuning: tuple[str, ...] = ()
    adapting: int = 0
    overwrite: bool = False


@dataclass(frozen=True)
class ShotPoint:
    """Accuracy of one way of learning from so many labelled images of each class.

    Attributes:
        shots: labelled images of each class.
        how: AS_TRAINED (0 images), TUNED, ADAPTED (the run itself, no fine-tuning) or SCRATCH.
        tested: images that each repeat was tested on.
        accuracies: of each repeat.
    """

    shots: int
    how: str
    tested: tuple[int, ...]
    accuracies: tuple[float, ...]

    @property
    def accuracy(self) -> float:
        """Mean over the repeats."""
        return sum(self.accuracies) / len(self.accuracies)

    @property
    def interval(self) -> tuple[float, float]:
        """Of the mean, 95 %."""
        return interval_of_repeats(self.accuracies, min(self.tested))


@dataclass
class ShotCurve:
    """What `few_shots` found; `left_out` is {number of labelled images: why}."""

    title: str
    about: dict[str, Any]
    points: list[ShotPoint] = field(default_factory=list)
    left_out: dict[int, str] = field(default_factory=dict)

    def of(self, how: str) -> list[ShotPoint]:
        """The points of one way of learning."""
        return [point for point in self.points if point.how == how]

    def earlier(self, folder: Path) -> list[ShotPoint]:
        """The points of the curve that a folder holds; none where it holds none.

        Raises:
            FolderError: it is of something else, or other settings.
        """
        path = folder / NUMBERS
        if not path.is_file():
            return []
        try:
            there = json.loads(path.read_text())
            points = [
                ShotPoint(p["shots"], p["learned"], tuple(p["tested"]), tuple(p["accuracies"]))
                for p in there["points"]
            ]
        except (ValueError, KeyError, TypeError):
            raise FolderError(f"{path}: is not a curve; --overwrite starts again") from None
        for key, value in json.loads(json.dumps(self.about)).items():
            if there.get(key) != value:
                raise FolderError(
                    f"{path}: is another curve, as {key} differs; --overwrite starts again, -o "
                    "names another folder"
                )
        return points

    def add(self, points: Sequence[ShotPoint]) -> None:
        """Take over points of other numbers of images."""
        own = {point.shots for point in self.points}
        self.points += [point for point in points if point.shots not in own]
        self.points.sort(key=lambda point: (point.shots, WAYS.index(point.how)))

    def shortfalls(self) -> list[str]:
        """A line for each number at which fine-tuning is below what it should at least reach."""
        mixed = "" if self.about["mix"] else "; --mix shows on what the run learned from"
        scratch = {p.shots: p.accuracy for p in self.of(SCRATCH)}
        lines = []
        for how, start in ((TUNED, AS_TRAINED), (ADAPTED, ADAPTED)):
            without = {p.shots: p.accuracy for p in self.of(start)}.get(0)
            for point in self.of(how):
                for than, other in (("no labels", without), (SCRATCH, scratch.get(point.shots))):
                    if other is not None and point.accuracy < other:
                        lines.append(
                            f"{point.shots} a class: {how} is below {than} "
                            f"({100 * point.accuracy:.1f} and {100 * other:.1f} %){mixed}"
                        )
        return lines

    def write(self, folder: Path) -> None:
        """Write NUMBERS, TABLE and FIGURE into a folder."""
        rows = [(p.how, p.shots, p.accuracy, *p.interval, len(p.accuracies)) for p in self.points]
        table = csv_text(("learned", "shots", "accuracy", "low_95", "high_95", "repeats"), rows)
        lines = {
            how: [(p.shots, p.accuracy, *p.interval) for p in self.of(how)]
            for how in WAYS
            if self.of(how)
        }
        numbers = {
            **self.about,
            "left_out": self.left_out,
            "points": [
                {
                    "learned": p.how,
                    "shots": p.shots,
                    "accuracy": p.accuracy,
                    "accuracy_95": p.interval,
                    "tested": p.tested,
                    "accuracies": p.accuracies,
                }
                for p in self.points
            ],
        }
        write_whole(folder, folder / TABLE, table.encode())
        write_whole(
            folder, folder / FIGURE, shots_png(lines, self.title, 1 / len(self.about["classes"]))
        )
        write_whole(folder, folder / NUMBERS, (json.dumps(numbers, indent=2) + "\n").encode())


@dataclass(frozen=True)
class Draw:
    """Rows to learn from, k of each class, and rows to test on."""

    labelled: Index
    tested: Index


class _NoProgress:
    """Of the single runs; `few_shots` says a line for each."""

    def say(self, message: str) -> None:
        pass

    def epoch(self, number: int, epochs: int, steps: int) -> None:
        pass

    def step(self, loss: float, accuracy: float) -> None:
        pass

    def epoch_done(self, row: Epoch, best: bool) -> None:
        pass


def few_shots(
    run: Path,
    data: Path,
    folder: Path,
    shots: ShotOptions,
    options: EvalOptions,
    device: torch.device,
    progress: Messages,
) -> ShotCurve:
    """Fine-tune a run, adapt it, and learn from scratch with a few labelled images; test on others.

    Args:
        run: a trained network.
        data: labelled images of another radar.
        folder: of the runs, `<k>_a_class/<repeat>/<fine_tuned, adapted or from_scratch>`.
        shots: how many labelled images, how often, and how they are learned from.
        options: of `data`: split, map, names of classes.
        device: where to compute.
        progress: receives a line for each training run.

    Raises:
        RunError, FolderError, ConfigError: one of them cannot be used; a folder holds another run.
        TrainingError: a loss is not finite.
    """
    opened = open_run(run.name or str(run), run, device)
    metadata = opened.metadata
    own = TrainConfig.model_validate(metadata.config)
    scratch = changed_section(own.model_copy(update={"device": device.type}), [*shots.overrides])
    tuned = changed_section(shorter(scratch), [f"--tune {text}" for text in shots.tuning])
    measured = open_eval_set(opened, data, options)
    mix = [training_images(metadata, path) for path in shots.mix]
    if message := unknown_message(measured.images, options.names):
        progress.say(f"warning: {message}")
    seen = seen_in_training(opened, measured.images, measured.rows)
    if any(seen.values()):
        numbers = {"seen_in_training": seen, "images": measured.rows.size}
        progress.say(f"warning: {seen_message(numbers)}")
    curve = ShotCurve(
        f"{opened.name} and labelled images of {data.name}",
        {
            "run": str(run),
            "data": str(data),
            "mix": [str(path) for path in shots.mix],
            "split": measured.split,
            "images": int(measured.rows.size),
            "classes": list(measured.images.classes),
            "persons_kept_apart": _persons(measured) is not None,
            "repeats": shots.repeats,
            "adapting": shots.adapting,
            "settings": {
                TUNED: tuned.model_dump(mode="json"),
                SCRATCH: scratch.model_dump(mode="json"),
            },
        },
    )

    earlier = [] if shots.overwrite else curve.earlier(folder)

    def tested(one: Path, draw: Draw) -> float:
        about, model = load_best(one)
        predictions = predict(
            model.to(device), about, measured.images, draw.tested, device, options.batch
        )
        return float((predictions.predicted == predictions.truth).mean())

    def learned(k: int, repeat: int, draw: Draw) -> Iterator[tuple[str, Path]]:
        """What each way of learning makes of a draw: its name, and the folder of the run."""
        here, seed = folder / f"{k}_a_class" / str(repeat + 1), (own.seed + repeat) % 2**63
        tuned_run = here / "fine_tuned" if k else run
        mixed = Mixed(joined(mix)) if mix else None
        if k:
            labelled = measured.images.some(draw.labelled)
            images, weights = _learned_from(metadata, labelled, mix, MAX_SHOWN)
            settings = tuned.model_copy(update={"data_weights": weights, "seed": seed})
            train_on(Task(settings, images, tuned_run, shots.overwrite, run), _NoProgress())
            mixed = Mixed(images, weights)
        yield TUNED if k else AS_TRAINED, tuned_run
        if shots.adapting:
            one, every = here / "adapted", measured.rows
            adapt_to(measured.images, every, run, one, device, True, shots.adapting, mixed)
            yield ADAPTED, one
        if k:
            images, weights = _learned_from(metadata, labelled, [], SHOWN)
            settings = scratch.model_copy(update={"data_weights": weights, "seed": seed})
            train_on(Task(settings, images, here / "from_scratch", shots.overwrite), _NoProgress())
            yield SCRATCH, here / "from_scratch"

    for k in shots.shots:
        draws = [drawn(measured, k, own.seed, repeat) for repeat in range(shots.repeats)]
        if why := next(filter(None, (missing(measured, draw, k) for draw in draws)), None):
            curve.left_out[k] = why
            most = most_shots(measured, own.seed, shots.repeats)
            progress.say(f"{k} a class: left out; {why}; should be at most {most}")
            continue
        if k == 0 and _persons(measured) is None:
            draws = draws[:1]  # every draw is the same
        accuracies: dict[str, list[float]] = {how: [] for how in WAYS}
        for repeat, draw in enumerate(draws):
            for how, one in learned(k, repeat, draw):
                accuracies[how].append(tested(one, draw))
                progress.say(
                    f"{k} a class, {how}, {repeat + 1} of {len(draws)}: "
                    f"{100 * accuracies[how][-1]:.1f} % of {draw.tested.size}"
                )
        sizes = tuple(int(draw.tested.size) for draw in draws)
        curve.points += [
            ShotPoint(k, how, sizes, tuple(shares)) for how, shares in accuracies.items() if shares
        ]
    if not curve.points:
        k, why = next(iter(curve.left_out.items()))
        most = most_shots(measured, own.seed, shots.repeats)
        raise FolderError(f"{data}: --shots {k}: {why}; should be at most {most}")
    curve.add(earlier)
    return curve


def shorter(config: TrainConfig) -> TrainConfig:
    """Settings to fine-tune with: half of the epochs and of the warm-up."""
    epochs, warmup = -(-config.epochs // 2), config.warmup_epochs / 2
    return config.model_copy(update={"epochs": epochs, "warmup_epochs": warmup})


def _persons(measured: EvalSet) -> list[str] | None:
    """Who is there, if several images show the same person or recording."""
    persons = measured.images.persons
    if persons is None:
        return None
    names = sorted({persons[row] for row in measured.rows})
    return names if len(names) < measured.rows.size else None


def drawn(measured: EvalSet, k: int, seed: int, repeat: int) -> Draw:
    """Up to k images of each class to learn from; those of a smaller k are among those of a larger.

    Where images say who is in them, half of the persons are learned from and the others tested,
    the same for every k; else all images are tested that are not learned from.
    """
    images, rng = measured.images, stream(seed, TRAINING, repeat, name="shots")
    order = measured.rows[rng.permutation(measured.rows.size)]
    persons, mine = _persons(measured), np.ones(order.size, bool)
    if persons is not None:
        assert images.persons is not None
        half = set(rng.permutation(persons)[: len(persons) // 2].tolist())
        mine = np.array([images.persons[row] in half for row in order])
    of_class = (order[mine & (images.label[order] == c)] for c in range(len(images.classes)))
    labelled = np.concatenate([rows[:k] for rows in of_class])
    others = measured.rows if persons is None else order[~mine]
    return Draw(labelled, np.sort(np.setdiff1d(others, labelled)))


def most_shots(measured: EvalSet, seed: int, repeats: int) -> int:
    """The largest k that every class can give in all draws, with some left to test."""
    apart, counts = _persons(measured) is not None, []
    for repeat in range(repeats):
        learned, tested = _counts(measured, drawn(measured, len(measured.images), seed, repeat))
        counts.append(learned.min() * tested.all() if apart else learned.min() - 1)
    return max(0, int(min(counts)))


def _counts(measured: EvalSet, draw: Draw) -> tuple[Index, Index]:
    """Images of each class to learn from, and to test on."""
    label, classes = measured.images.label, len(measured.images.classes)
    learned, tested = (
        np.bincount(label[rows], minlength=classes) for rows in (draw.labelled, draw.tested)
    )
    return learned, tested


def missing(measured: EvalSet, draw: Draw, k: int) -> str | None:
    """Which class gives fewer than k images to learn from or none to test on; None if none does."""
    images, apart = measured.images, _persons(measured) is not None
    learned, tested = _counts(measured, draw)
    for number, name in enumerate(images.classes):
        if k and (learned[number] < k or not tested[number]):
            have = int((images.label[measured.rows] == number).sum())
            return f"{name} has {have} images" + (
                f", {learned[number]} of the persons to learn from" if apart else ""
            )
    return None


def _learned_from(
    metadata: RunMetadata, labelled: ImageSet, mix: Sequence[ImageSet], most: int
) -> tuple[ImageSet, tuple[float, ...]]:
    """Images to learn from, and how often an epoch shows those of each set.

    The labelled ones are validated on as well, so that the test says nothing about the epoch.
    """
    count, mass = len(labelled), sum(map(len, mix))
    split = np.repeat(np.array([TRAIN, VALIDATION], np.uint8), count)
    twice = replace(labelled.some(np.tile(np.arange(count), 2)), split=split)
    images = joined([twice, *mix])
    shown = max(SHOWN, count)
    return (
        replace(images, classes=metadata.classes, label=labels_for(images, metadata.classes)),
        (min(shown / count, most), *(shown / mass for _ in mix)),
    )
