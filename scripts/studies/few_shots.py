"""Accuracy after learning from a few labelled images of each class of another radar.

    python scripts/studies/few_shots.py RUN DATA -o OUT --shots 0,1,5,20
        [--mix SIMULATED] [--adapt EPOCHS]

For every number k of labelled images: RUN fine-tuned on them (k = 0: as trained), RUN adapted to
all images of DATA without their labels with the labelled ones beside (`--adapt`), and a network
from scratch. `--mix` goes on being shown while RUN is fine-tuned. Each repeat draws anew; where the
data say persons, half of them are learned from and the others tested. Each training is a run of its
own, `OUT/<k>_a_class/<repeat>/<way>`, so that the same line goes on where it was stopped. The 95 %
interval is of the mean over the repeats: of the images tested and of those drawn. Ends with
OUT/shots.json.
"""

import argparse
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from statistics import variance
from typing import Any, NamedTuple

import numpy as np
import torch

from radhar_cli.config.reading import with_overrides
from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.split import TRAIN, VALIDATION
from radhar_cli.learning.adaptation import AdaptOptions, Mixed
from radhar_cli.learning.adaptation import adapt as adapt_run
from radhar_cli.learning.evaluated_run import EvalSet, open_eval_set, open_run
from radhar_cli.learning.evaluation import open_training_images, predict_classes
from radhar_cli.learning.images.image_set import ImageSet, labels_for
from radhar_cli.learning.images.joined import joined
from radhar_cli.learning.intervals import wilson
from radhar_cli.learning.run_folder import Epoch, RunMetadata, load_best
from radhar_cli.learning.settings import TrainConfig
from radhar_cli.learning.tasks.categories import require_classifier
from radhar_cli.learning.tasks.predictions import EvalOptions
from radhar_cli.learning.training import TrainOptions, train
from radhar_cli.numerics.arrays import Index
from radhar_cli.numerics.randomness import TRAINING, stream

AS_TRAINED, TUNED, ADAPTED, SCRATCH = "as trained", "fine-tuned", "adapted", "from scratch"
SHOWN = 600  # labelled images an epoch, those of a few again and again; as many mixed ones
MAX_SHOWN = 16  # times an epoch that an image is fine-tuned with


class Draw(NamedTuple):
    """Rows to learn from, up to k of each class, and rows to test on."""

    labelled: Index
    tested: Index


class Silent:
    """Progress of a single run."""

    def say(self, message: str) -> None: ...

    def epoch(self, number: int, epochs: int, steps: int) -> None: ...

    def step(self, loss: float, accuracy: float) -> None: ...

    def epoch_done(self, row: Epoch, best: bool) -> None: ...


def drawn(data: EvalSet, k: int, seed: int, repeat: int) -> Draw:
    """Up to k images of each class; those of a smaller k are among those of a larger one."""
    images, rng = data.images, stream(seed, TRAINING, repeat, name="shots")
    order = data.rows[rng.permutation(data.rows.size)]
    persons, mine = images.samples.person, np.ones(order.size, bool)
    names = sorted({persons[row] for row in data.rows}) if persons is not None else []
    apart = 0 < len(names) < data.rows.size  # several images show the same person or recording
    if apart:
        assert persons is not None
        half = set(rng.permutation(names)[: len(names) // 2].tolist())
        mine = np.array([persons[row] in half for row in order])
    label = images.samples.label[order]
    of_class = (order[mine & (label == c)] for c in range(len(images.classes)))
    labelled = np.concatenate([rows[:k] for rows in of_class])
    others = order[~mine] if apart else data.rows
    return Draw(labelled, np.sort(np.setdiff1d(others, labelled)))


def missing(data: EvalSet, draw: Draw, k: int) -> str | None:
    """The class that gives fewer than k images to learn from or none to test on, if any."""
    label, classes = data.images.samples.label, data.images.classes
    learned, tested = (np.bincount(label[rows], minlength=len(classes)) for rows in draw)
    short = [name for c, name in enumerate(classes) if k and (learned[c] < k or not tested[c])]
    return short[0] if short else None


def learned_from(
    metadata: RunMetadata, labelled: ImageSet, mix: Sequence[ImageSet], most: int
) -> tuple[ImageSet, tuple[float, ...]]:
    """Images to learn from, and how often an epoch shows those of each set.

    The labelled ones are validated on as well, so that the test says nothing about the epoch.
    """
    count, mass = len(labelled), sum(map(len, mix))
    split = np.repeat(np.array([TRAIN, VALIDATION], np.uint8), count)
    twice = labelled.take(np.tile(np.arange(count), 2))
    twice = replace(twice, samples=replace(twice.samples, split=split))
    images, shown = joined([twice, *mix]), max(SHOWN, count)
    label = labels_for(images, metadata.classes)
    return (
        replace(images, classes=metadata.classes, samples=replace(images.samples, label=label)),
        (min(shown / count, most), *(shown / mass for _ in mix)),
    )


def interval_of_repeats(shares: Sequence[float], count: int) -> tuple[float, float]:
    """Interval of 95 % of the mean of some proportions, of `count` images each.

    Wilson's, of as many images as have the variance of `count` images and that of the mean over
    the repeats together: it covers the choice of what was tested and of what was learned from.
    """
    mean = sum(shares) / len(shares)
    one = mean * (1 - mean)
    spread = variance(shares) / len(shares) if len(shares) > 1 else 0.0
    return wilson(mean * (n := one / (one / count + spread) if one else count), n)


def few_shots(
    run: Path,
    data: Path,
    out: Path,
    shots: Sequence[int],
    repeats: int = 5,
    mix: Sequence[Path] = (),
    adapt: int = 0,
    settings: Sequence[str] = (),
) -> list[dict[str, Any]]:
    """The points of the curve; numbers that a class cannot give are left out.

    Args:
        run: a trained network.
        data: labelled images of another radar, all of whose splits are used.
        out: folder of all runs.
        shots: numbers of labelled images of each class.
        repeats: draws of each.
        mix: data that go on being shown while the run is fine-tuned.
        adapt: epochs of adapting the run itself; 0 is none.
        settings: `key=value`, of training from scratch; fine-tuning has half of its epochs.
    """
    device = torch.device("cpu")
    opened = open_run(run.name, run, device)
    require_classifier(run, opened.metadata.task)
    own = TrainConfig.model_validate(opened.metadata.config)
    document = {**own.model_dump(mode="json"), "device": "cpu"}
    scratch = TrainConfig.model_validate(with_overrides(document, settings))
    half = {"epochs": -(-scratch.epochs // 2), "warmup_epochs": scratch.warmup_epochs / 2}
    tuned = scratch.model_copy(update=half)
    measured = open_eval_set(opened, data, EvalOptions("all"))
    mixed = [open_training_images(opened.metadata, path) for path in mix]

    def tested(one: Path, draw: Draw) -> float:
        about, model = load_best(one)
        found = predict_classes(model, about, measured.images, draw.tested, device, 128)
        return float((found.predicted == found.truth).mean())

    def learned(k: int, repeat: int, draw: Draw) -> dict[str, Path]:
        here, seed = out / f"{k}_a_class" / str(repeat + 1), (own.seed + repeat) % 2**63
        ways = {TUNED: here / "fine_tuned"} if k else {AS_TRAINED: run}
        beside = Mixed(joined(mixed)) if mixed else None
        labelled = measured.images.take(draw.labelled)
        if k:
            images, weights = learned_from(opened.metadata, labelled, mixed, MAX_SHOWN)
            chosen = tuned.model_copy(update={"data_weights": weights, "seed": seed})
            train(chosen, images, ways[TUNED], Silent(), TrainOptions(start=run))
            beside = Mixed(images, weights)
        if adapt:
            ways[ADAPTED] = here / "adapted"
            unlabelled, kept = (measured.images, measured.rows), beside or ()
            options = AdaptOptions(overwrite=True, epochs=adapt, mix=kept)
            adapt_run(run, unlabelled, ways[ADAPTED], device, options)
        if k:
            ways[SCRATCH] = here / "from_scratch"
            images, weights = learned_from(opened.metadata, labelled, [], SHOWN)
            chosen = scratch.model_copy(update={"data_weights": weights, "seed": seed})
            train(chosen, images, ways[SCRATCH], Silent())
        return ways

    points = []
    for k in shots:
        draws = [drawn(measured, k, own.seed, repeat) for repeat in range(repeats)]
        short = [name for draw in draws if (name := missing(measured, draw, k))]
        if short:
            print(f"{k} a class: left out; {short[0]} has too few", flush=True)
            continue
        draws = draws if k or measured.images.samples.person is not None else draws[:1]
        accuracies: dict[str, list[float]] = {}
        for repeat, draw in enumerate(draws):
            for way, one in learned(k, repeat, draw).items():
                accuracies.setdefault(way, []).append(tested(one, draw))
        for way, shares in accuracies.items():
            mean = sum(shares) / len(shares)
            low, high = interval_of_repeats(shares, min(draw.tested.size for draw in draws))
            points.append({"shots": k, "learned": way, "accuracy": mean, "accuracies": shares})
            print(
                f"{k} labelled a class, {way}: {mean:.3f} ({low:.3f} to {high:.3f}), "
                f"{len(shares)} repeats",
                flush=True,
            )
    write_whole(out, out / "shots.json", (json.dumps(points, indent=2) + "\n").encode())
    return points


def main() -> None:
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("run", type=Path)
    parser.add_argument("data", type=Path)
    parser.add_argument("-o", "--out", type=Path, required=True)
    parser.add_argument("--shots", default="0,1,5,20", help="labelled images of each class")
    parser.add_argument("--repeats", type=int, default=5, help="draws of each number")
    parser.add_argument("--mix", type=Path, action="append", default=[])
    parser.add_argument("--adapt", type=int, default=0, help="epochs without labels")
    parser.add_argument("--set", action="append", default=[], help="key=value of the training")
    given = parser.parse_args()
    shots = sorted({int(k) for k in given.shots.split(",")})
    few_shots(
        given.run, given.data, given.out, shots, given.repeats, given.mix, given.adapt, given.set
    )


if __name__ == "__main__":
    main()
