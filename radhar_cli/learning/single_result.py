"""One run on one data set: its numbers and figures."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch
from sklearn.metrics import confusion_matrix
from torch import nn

from radhar_cli.activity import ACTIVITIES
from radhar_cli.arrays import Index
from radhar_cli.figures.confusion import confusion_png
from radhar_cli.figures.embedding import embeddings_png
from radhar_cli.figures.mistakes import captioned_png
from radhar_cli.figures.reliability import reliability_png
from radhar_cli.learning import metrics
from radhar_cli.learning.evaluation import Predictions, open_for, predict, rows_of
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.images.scan import scan
from radhar_cli.learning.models.fftnet import NAME
from radhar_cli.learning.report_files import Report
from radhar_cli.learning.run_folder import (
    Epoch,
    RunError,
    RunMetadata,
    load_best,
    read_history,
    read_trained_on,
)
from radhar_cli.learning.tables import confusion_csv, csv_text

MAX_MISTAKES = 12
MIN_EMBEDDED = 2
GROUPS = ("in place", "moving")


@dataclass(frozen=True)
class EvalOptions:
    """Options of `radhar eval`."""

    split: str = "val"
    map: str | None = None
    tsne: bool = False
    filters: bool = False
    in_place_vs_moving: bool = False
    batch: int = 32
    resize: bool = False
    names: Mapping[str, str | None] = field(default_factory=dict)


@dataclass(frozen=True)
class Run:
    name: str
    folder: Path
    metadata: RunMetadata
    model: nn.Module
    history: list[Epoch]


@dataclass(frozen=True)
class EvalSet:
    """The images of a data set that a run is evaluated on: rows, and the name of the split."""

    images: ImageSet
    rows: Index
    split: str


def open_eval_set(run: Run, path: Path, options: EvalOptions) -> EvalSet:
    """Open a data set for a run.

    Raises:
        FolderError: it does not fit the run.
    """
    images = open_for(run.metadata, path, options.map, resize=options.resize, names=options.names)
    return EvalSet(images, *rows_of(images, options.split))


def check_options(runs: Sequence[Run], options: EvalOptions) -> None:
    """Refuse figures that cannot be drawn, before anything is computed.

    Raises:
        RunError: classes whose group is unknown, or no filters to draw.
    """
    ours = {activity.slug for activity in ACTIVITIES}
    for run in runs:
        for name in run.metadata.classes:
            if options.in_place_vs_moving and name not in ours:
                raise RunError(
                    f"--in-place-vs-moving: {name!r} is none of the twelve activities; its group "
                    "is unknown"
                )
    if options.filters and not any(run.metadata.model == NAME for run in runs):
        raise RunError("--filters: none of these networks has global filters; fftnet has six")


def open_run(name: str, path: Path, device: torch.device) -> Run:
    metadata, model = load_best(path)
    folder = path if path.is_dir() else path.parent
    try:
        history = read_history(folder)
    except RunError:
        history = []  # weights alone, copied from elsewhere
    return Run(name, path, metadata, model.to(device), history)


def evaluate_one(
    report: Report,
    run: Run,
    data_name: str,
    eval_set: EvalSet,
    stem: str,
    options: EvalOptions,
    device: torch.device,
) -> tuple[Predictions, dict[str, Any]]:
    images, rows, split = eval_set.images, eval_set.rows, eval_set.split
    predictions = predict(run.model, run.metadata, images, rows, device, options.batch)
    names, title = run.metadata.classes, f"{run.name} on {data_name}, {split}"
    numbers = metrics.summary(predictions.truth, predictions.probabilities, names)
    numbers["seen_in_training"] = seen_in_training(run, images, rows)
    numbers |= {"split": split, "map": images.map, "snr_db": images.snr_db}
    numbers |= {"left_out": dict(images.left_out)}
    counts = np.array(numbers["confusion"])
    right = 100 * numbers["accuracy"]
    report.figure(
        f"confusion{stem}.png",
        f"Confusion matrix of {title}: counts, and shares of the true class.",
        confusion_png(counts, names, f"{title}: {right:.2f} % of {rows.size}"),
    )
    report.tables.append((f"confusion{stem}.csv", confusion_csv(counts, names)))
    report.tables.append((f"predictions{stem}.csv", _predictions_csv(predictions, names)))
    if options.in_place_vs_moving:
        _in_place_vs_moving(report, predictions, names, stem, title, numbers)
    bins = metrics.calibration(predictions.truth, predictions.probabilities)
    report.figure(
        f"reliability{stem}.png",
        f"Reliability: accuracy by confidence, {title}.",
        reliability_png(
            bins.confidence,
            bins.accuracy,
            bins.count.astype(float),
            f"{_narrow(title)}\ncalibration error {100 * bins.error:.2f} %",
        ),
    )
    _mistakes(report, predictions, names, stem, title)
    if options.tsne:
        _tsne(report, predictions, names, stem, title, numbers)
    return predictions, numbers


def seen_in_training(run: Run, images: ImageSet, rows: Index) -> dict[str, int]:
    """How many of the evaluated images, and of the scenes behind them, were trained on."""
    folder = run.folder if run.folder.is_dir() else run.folder.parent
    pixels, scenes = read_trained_on(folder)
    digests = scan(images, rows).digests if pixels else ()
    return {
        "images": sum(p in pixels for p in digests),
        "scenes": sum(images.scenes[row] in scenes for row in rows) if images.scenes else 0,
    }


def seen_message(numbers: Mapping[str, Any]) -> str:
    seen = numbers["seen_in_training"]
    return (
        f"{seen['images']} of these {numbers['images']} images, and the person and motion of "
        f"{seen['scenes']}, were trained on: this does not test on unseen data"
    )


def _predictions_csv(predictions: Predictions, names: Sequence[str]) -> str:
    sure = predictions.probabilities.max(1)
    return csv_text(
        ("image", "true", "predicted", "probability"),
        (
            (predictions.images.names[row], names[true], names[guess], f"{probability:.6f}")
            for row, true, guess, probability in zip(
                predictions.rows, predictions.truth, predictions.predicted, sure, strict=True
            )
        ),
    )


def _in_place_vs_moving(
    report: Report,
    predictions: Predictions,
    names: Sequence[str],
    stem: str,
    title: str,
    numbers: dict[str, Any],
) -> None:
    """The paper's two groups: S1 to S7 against S8 to S12."""
    moving = {activity.slug: activity.walks for activity in ACTIVITIES}
    group = np.array([int(moving[name]) for name in names])
    counts = confusion_matrix(group[predictions.truth], group[predictions.predicted], labels=[0, 1])
    numbers["in_place_vs_moving"] = counts.tolist()
    share = 100 * np.trace(counts) / max(1, counts.sum())
    report.figure(
        f"in_place_vs_moving{stem}.png",
        f"Standing activities (S1 to S7) against moving ones (S8 to S12), {title}.",
        confusion_png(counts, GROUPS, f"{_narrow(title)}\n{share:.2f} %"),
    )
    report.tables.append((f"in_place_vs_moving{stem}.csv", confusion_csv(counts, GROUPS)))


def _mistakes(
    report: Report, predictions: Predictions, names: Sequence[str], stem: str, title: str
) -> None:
    """The most confident mistakes; where there are none, the least confident predictions."""
    sure, wrong = predictions.probabilities.max(1), predictions.predicted != predictions.truth
    order = np.argsort(-sure, kind="stable")
    chosen = order[wrong[order]][:MAX_MISTAKES]
    what = "Most confident mistakes"
    if not chosen.size:
        chosen, what = order[::-1][: MAX_MISTAKES // 3], "No mistakes; the least sure predictions"
    images = [predictions.images.pixels.read(int(predictions.rows[i])) for i in chosen]
    captions = [
        f"{_plain(names[int(predictions.truth[i])])}\n-> "
        f"{_plain(names[int(predictions.predicted[i])])}, {100 * sure[i]:.0f} %"
        for i in chosen
    ]
    report.figure(
        f"hardest{stem}.png",
        f"{what}, {title}.",
        captioned_png(images, captions, f"{what}: {title}"),
    )


def _narrow(title: str) -> str:
    """A title in two lines, for a small figure."""
    return title.replace(" on ", "\non ", 1)


def _plain(name: str) -> str:
    return name.replace("_", " ")


def _tsne(
    report: Report,
    predictions: Predictions,
    names: Sequence[str],
    stem: str,
    title: str,
    numbers: dict[str, Any],
) -> None:
    from radhar_cli.learning.embedding import chosen, embed, separation, shrunk

    if predictions.rows.size < MIN_EMBEDDED:
        raise RunError(f"--tsne: needs at least {MIN_EMBEDDED} images; there is one")
    picked = chosen(predictions.rows.size)
    maps = np.stack(
        [shrunk(predictions.images.pixels.read(int(predictions.rows[i]))) for i in picked]
    )
    features, label = predictions.features[picked], predictions.truth[picked]
    before, after = separation(maps, label), separation(features, label)
    numbers["silhouette"] = {"maps": before, "features": after}
    panels = {"input maps": embed(maps), "features before the last layer": embed(features)}
    silhouettes = " and ".join("unknown" if s is None else f"{s:.2f}" for s in (before, after))
    report.figure(
        f"tsne{stem}.png",
        f"t-SNE of {len(picked)} maps and of their features, {title}; silhouettes {silhouettes}.",
        embeddings_png(panels, label, names, title),
    )
