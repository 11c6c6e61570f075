"""One run on one data set: its numbers and figures."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from sklearn.metrics import confusion_matrix
from torch import nn

from radhar_cli.activity import ACTIVITIES
from radhar_cli.arrays import Index
from radhar_cli.figures.evaluation import (
    captioned_png,
    confusion_png,
    embeddings_png,
    reliability_png,
)
from radhar_cli.learning import metrics
from radhar_cli.learning.evaluation import Predictions, open_for_model, predict, rows_of
from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.learning.images.scan import scan
from radhar_cli.learning.labels_result import evaluate_labels
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
from radhar_cli.learning.skeleton_result import evaluate_skeletons, predict_skeletons
from radhar_cli.progress import Progress
from radhar_cli.untrusted import shown as escaped

MIN_EMBEDDED = 2
MAX_MISTAKES, FEW = 12, 4  # images that are shown
GROUPS = ("in place", "moving")


@dataclass(frozen=True)
class EvalOptions:
    """Options of `radhar eval`."""

    split: str = "val"
    map: str | None = None
    tsne: bool = False
    in_place_vs_moving: bool = False
    batch: int = 32
    resize: bool = False
    names: Mapping[str, str | None] = field(default_factory=dict)
    filters: bool = False


@dataclass(frozen=True)
class Run:
    """A training run that is evaluated."""

    name: str  # in tables and figures
    folder: Path  # or the weights' file
    metadata: RunMetadata
    model: nn.Module  # on the device, in evaluation mode
    history: list[Epoch]  # empty where only the weights are there


@dataclass(frozen=True)
class EvalSet:
    """The images of a data set that a run is evaluated on: rows, and the name of the split."""

    images: ImageSet
    rows: Index
    split: str


def open_eval_set(run: Run, path: Path, options: EvalOptions) -> EvalSet:
    """Open a data set for a run."""
    images = open_for_model(
        run.metadata, path, options.map, resize=options.resize, names=options.names
    )
    return EvalSet(images, *rows_of(images, options.split))


def check_options(runs: Sequence[Run], options: EvalOptions) -> None:
    """Refuse figures that cannot be drawn, before anything is computed."""
    ours = {activity.slug for activity in ACTIVITIES}
    for run in runs:
        if options.tsne and run.metadata.input not in ("rgb", "gray"):
            raise RunError(f"--tsne: {run.name} reads {run.metadata.input}; it is of images")
        several = run.metadata.settings.target == "labels"
        if several and (options.tsne or options.in_place_vs_moving):
            raise RunError(f"{run.name} finds several labels at a time; that figure is of classes")
        for name in run.metadata.classes:
            if options.in_place_vs_moving and name not in ours:
                raise RunError(
                    f"--in-place-vs-moving: {name!r} is none of the twelve activities; its group "
                    "is unknown"
                )
    if options.filters and not any(run.metadata.model == NAME for run in runs):
        raise RunError("--filters: none of these networks has global filters; fftnet has six")


def open_run(name: str, path: Path, device: torch.device) -> Run:
    """Open a run for evaluation.

    Args:
        name: name of the run in tables and figures.
        path: folder of the run, or a copy of its weights alone.
        device: device that the network is moved to.

    Raises:
        RunError: it is no run, or is damaged.
    """
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
    progress: Progress,
) -> dict[str, Any]:
    """Numbers of a run on a data set; its figures and tables, named with `stem`, go to `report`."""
    images, rows, split = eval_set.images, eval_set.rows, eval_set.split
    title = f"{run.name} on {data_name}, {split}"
    asked = (run.model, run.metadata, images, rows, device, options.batch, progress)
    progress.stage(title, len(rows), 0, "image" if images.kind in ("rgb", "gray") else "sequence")
    about = {
        "seen_in_training": seen_in_training(run, images, rows),
        "split": split,
        "map": images.map,
        "snr_db": images.snr_db,
        "left_out": dict(images.left_out),
    }
    if run.metadata.finds_joints:
        joints = predict_skeletons(*asked)
        return evaluate_skeletons(report, *joints, images, rows, stem, title) | about
    predictions = predict(*asked)
    names = run.metadata.classes
    if run.metadata.settings.target == "labels":
        return evaluate_labels(report, predictions, names, stem, title) | about
    numbers = metrics.summarise(predictions.truth, predictions.probabilities, names) | about
    shown = _ClassFigures(report, predictions, names, stem, title)
    counts, right = np.array(numbers["confusion"]), 100 * numbers["accuracy"]
    caption = f"Confusion matrix of {shown.title}: counts, and shares of the true class."
    title = f"{shown.title}: {right:.2f} % of {rows.size}"
    shown.confusion("confusion", caption, counts, names, title)
    shown.tables(numbers["classes"])
    numbers["calibration"] = shown.reliability(run.metadata.settings.label_smoothing)
    if images.kind in ("rgb", "gray"):
        shown.hardest()
    if options.in_place_vs_moving:
        numbers["in_place_vs_moving"] = shown.in_place_vs_moving()
    if options.tsne:
        numbers["silhouette"] = shown.tsne()
    return numbers


def seen_in_training(run: Run, images: ImageSet, rows: Index) -> dict[str, int]:
    """How many of the evaluated images, and of the scenes behind them, were trained on."""
    folder = run.folder if run.folder.is_dir() else run.folder.parent
    pixels, scenes = read_trained_on(folder)
    digests = scan(images, rows).digests if pixels else ()
    return {
        "images": sum(p in pixels for p in digests),
        "scenes": sum(images.scenes[row] in scenes for row in rows) if images.scenes else 0,
    }


@dataclass(frozen=True)
class _ClassFigures:
    """Predictions of classes `names`, and the report that shows them under a title."""

    report: Report
    predictions: Predictions
    names: Sequence[str]
    stem: str
    title: str

    def figure(self, name: str, caption: str, png: bytes) -> None:
        self.report.figure(f"{name}{self.stem}.png", caption, png)

    def confusion(
        self, name: str, caption: str, counts: NDArray[np.int64], classes: Sequence[str], title: str
    ) -> None:
        """Counts [true class, predicted class] as a figure and a table, true classes down."""
        self.figure(name, caption, confusion_png(counts, classes, title))
        rows = ([one, *row] for one, row in zip(classes, counts.tolist(), strict=True))
        # Beside its figure the page has no use for the table.
        self.report.table(f"{name}{self.stem}.csv", ["true \\ predicted", *classes], rows)

    def tables(self, classes: Mapping[str, Mapping[str, float]]) -> None:
        """Numbers of each class, and what was predicted of each image."""
        each = [[name, *(float(f"{n:.4g}") for n in one.values())] for name, one in classes.items()]
        head = ("class", "precision", "recall", "f1", "images")
        self.report.table(f"classes{self.stem}.csv", head, each, "Class by class")
        found, names = self.predictions, self.names
        columns = (found.rows, found.truth, found.predicted, found.probabilities.max(1))
        rows = (
            (found.images.names[row], names[true], names[guess], f"{probability:.6f}")
            for row, true, guess, probability in zip(*columns, strict=True)
        )
        of_image = ("image", "true", "predicted", "probability")
        self.report.table(f"predictions{self.stem}.csv", of_image, rows)

    def reliability(self, smoothing: float) -> dict[str, list[float | None] | list[int]]:
        """The reliability diagram, and its bins: mean probability, share that is right, images."""
        bins = metrics.calibration(self.predictions.truth, self.predictions.probabilities)
        comment = ""
        if smoothing:
            sure = 1 - smoothing + smoothing / len(self.names)
            comment = (
                f" Label smoothing of {smoothing:g} asks for a probability of {sure:.2f} where the "
                "network is sure, so points above the line, and an error of up to "
                f"{1 - sure:.2f} with every prediction right, are what it was trained for."
            )
        error = f"calibration error {100 * bins.error:.1f} %"
        caption = (
            f"Reliability, {self.title}: how often a prediction is right, by the probability that "
            f"the network gives it; {error} (mean distance from the line).{comment}"
        )
        png = reliability_png(bins.confidence, bins.accuracy, bins.count, f"{self.title}\n{error}")
        self.figure("reliability", caption, png)
        columns = (bins.confidence, bins.accuracy)
        confidence, accuracy = (
            [None if np.isnan(value) else value for value in column.tolist()] for column in columns
        )
        return {"confidence": confidence, "accuracy": accuracy, "images": bins.count.tolist()}

    def hardest(self) -> None:
        """The most confident mistakes; where there are none, the least confident predictions."""
        found = self.predictions
        confidence, wrong = found.probabilities.max(1), found.predicted != found.truth
        order = np.argsort(-confidence, kind="stable")
        chosen, what = order[wrong[order]][:MAX_MISTAKES], "Most confident mistakes"
        if not chosen.size:
            chosen, what = order[::-1][:FEW], "No mistakes; the least confident predictions"
        plain = [name.replace("_", " ") for name in self.names]
        rows = found.rows[chosen].tolist()
        paths = [found.images.path_of(row) for row in rows]
        lines = [
            (plain[found.truth[i]], plain[found.predicted[i]], f"{100 * confidence[i]:.1f} %")
            for i in chosen
        ]
        names = [found.images.names[row] for row in rows]
        captions = [
            f"{escaped(name)}\ntrue: {true}\nfound: {guess}, {sure}"
            for name, (true, guess, sure) in zip(names, lines, strict=True)
        ]
        pictures = [found.images.pixels.read(row) for row in rows]
        png = captioned_png(pictures, captions, f"{what}: {self.title}")
        self.figure("hardest", f"{what}, {self.title}.", png)
        table = ((path, *line) for path, line in zip(paths, lines, strict=True))
        head = ("image", "true", "predicted", "probability")
        self.report.table(f"hardest{self.stem}.csv", head, table, what)

    def in_place_vs_moving(self) -> list[list[int]]:
        """The paper's two groups: S1 to S7 against S8 to S12; counts [true, predicted]."""
        moving = {activity.slug: activity.walks for activity in ACTIVITIES}
        group = np.array([int(moving[name]) for name in self.names])
        truth, predicted = group[self.predictions.truth], group[self.predictions.predicted]
        counts = confusion_matrix(truth, predicted, labels=[0, 1])
        share = 100 * np.trace(counts) / max(1, counts.sum())
        caption = f"Standing activities (S1 to S7) against moving ones (S8 to S12), {self.title}."
        title = self.title.replace(" on ", "\non ", 1) + f"\n{share:.2f} %"
        self.confusion("in_place_vs_moving", caption, counts, GROUPS, title)
        found: list[list[int]] = counts.tolist()
        return found

    def tsne(self) -> dict[str, float | None]:
        """Silhouettes of maps and of features."""
        from radhar_cli.learning.embedding import embed, select_rows, separation, shrink

        found = self.predictions
        if found.rows.size < MIN_EMBEDDED:
            raise RunError(f"--tsne: needs at least {MIN_EMBEDDED} images; there is one")
        picked = select_rows(found.rows.size)
        maps = np.stack([shrink(found.images.pixels.read(int(row))) for row in found.rows[picked]])
        features, label = found.features[picked], found.truth[picked]
        before, after = separation(maps, label), separation(features, label)
        panels = {"input maps": embed(maps), "features before the last layer": embed(features)}
        silhouettes = " and ".join("unknown" if s is None else f"{s:.2f}" for s in (before, after))
        self.figure(
            "tsne",
            f"t-SNE of {len(picked)} maps and of their features, {self.title}; silhouettes "
            f"{silhouettes}.",
            embeddings_png(panels, label, self.names, self.title),
        )
        return {"maps": before, "features": after}
