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

from radhar_cli.activities.activity import ACTIVITIES
from radhar_cli.figures.evaluation import (
    captioned_png,
    confusion_png,
    embeddings_png,
    reliability_png,
)
from radhar_cli.files.untrusted import escaped
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
from radhar_cli.numerics.arrays import Index
from radhar_cli.processes.progress import Progress

MIN_EMBEDDED = 2
MAX_MISTAKES, FEW = 12, 4  # images that are shown
GROUPS = ("in place", "moving")


@dataclass(frozen=True)
class EvalOptions:
    """Options of `radhar eval`."""

    split: str = "val"  # train, val, test or all
    map: str | None = None  # of a data set; None is the one of the training
    tsne: bool = False  # draw t-SNE of maps and features
    in_place_vs_moving: bool = False  # confusion matrix of the paper's two groups
    batch: int = 32  # images at a time
    resize: bool = False  # bring images to the model's size
    # {class of the data: class of the model, or None to leave it out}
    names: Mapping[str, str | None] = field(default_factory=dict)
    filters: bool = False  # draw the weights of global filters


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
    """Images of a data set on which a run is evaluated."""

    images: ImageSet
    rows: Index  # rows of `images` that count
    split: str  # their split, or all


def open_eval_set(run: Run, path: Path, options: EvalOptions) -> EvalSet:
    """Open the images of a data set on which a run is evaluated.

    Raises:
        FolderError: data do not fit the network.
    """
    images = open_for_model(
        run.metadata, path, options.map, resize=options.resize, names=options.names
    )
    return EvalSet(images, *rows_of(images, options.split))


def check_options(runs: Sequence[Run], options: EvalOptions) -> None:
    """Refuse figures that cannot be drawn, before anything is computed.

    Raises:
        RunError: a figure that an option asks for is not of such a network.
    """
    activity_names = {activity.slug for activity in ACTIVITIES}
    for run in runs:
        if options.tsne and run.metadata.input not in ("rgb", "gray"):
            raise RunError(f"--tsne: {run.name} reads {run.metadata.input}; it is of images")
        finds_labels = run.metadata.settings.target == "labels"
        if finds_labels and (options.tsne or options.in_place_vs_moving):
            raise RunError(f"{run.name} finds several labels at a time; that figure is of classes")
        for name in run.metadata.classes:
            if options.in_place_vs_moving and name not in activity_names:
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
    """Evaluate one run on one data set.

    Args:
        report: report that receives figures and tables.
        run: network.
        data_name: name of the data set, in titles.
        eval_set: images, whose classes the network knows.
        stem: end of the names of files.
        options: which figures are drawn.
        device: where the network is.
        progress: receives the images done.

    Returns:
        Plain numbers by their keys in report.json.
    """
    images, rows, split = eval_set.images, eval_set.rows, eval_set.split
    title = f"{run.name} on {data_name}, {split}"
    prediction_inputs = (run.model, run.metadata, images, rows, device, options.batch, progress)
    progress.stage(title, len(rows), 0, "image" if images.kind in ("rgb", "gray") else "sequence")
    common_numbers = {
        "seen_in_training": seen_in_training(run, images, rows),
        "split": split,
        "map": images.map,
        "snr_db": images.snr_db,
        "left_out": dict(images.left_out),
    }
    if run.metadata.finds_joints:
        joints = predict_skeletons(*prediction_inputs)
        return evaluate_skeletons(report, *joints, images, rows, stem, title) | common_numbers
    predictions = predict(*prediction_inputs)
    names = run.metadata.classes
    if run.metadata.settings.target == "labels":
        return evaluate_labels(report, predictions, names, stem, title) | common_numbers
    numbers = (
        metrics.summarise(predictions.truth, predictions.probabilities, names) | common_numbers
    )
    figures = _ClassFigures(report, predictions, names, stem, title)
    counts, accuracy_percent = np.array(numbers["confusion"]), 100 * numbers["accuracy"]
    caption = f"Confusion matrix of {figures.title}: counts, and shares of the true class."
    title = f"{figures.title}: {accuracy_percent:.2f} % of {rows.size}"
    figures.confusion("confusion", caption, counts, names, title)
    figures.tables(numbers["classes"])
    numbers["calibration"] = figures.reliability(run.metadata.settings.label_smoothing)
    if images.kind in ("rgb", "gray"):
        figures.hardest()
    if options.in_place_vs_moving:
        numbers["in_place_vs_moving"] = figures.in_place_vs_moving()
    if options.tsne:
        numbers["silhouette"] = figures.tsne()
    return numbers


def seen_in_training(run: Run, images: ImageSet, rows: Index) -> dict[str, int]:
    """Numbers of the evaluated images, and of the scenes behind them, that were trained on."""
    folder = run.folder if run.folder.is_dir() else run.folder.parent
    pixels, scenes = read_trained_on(folder)
    digests = scan(images, rows).digests if pixels else ()
    return {
        "images": sum(p in pixels for p in digests),
        "scenes": sum(images.scenes[row] in scenes for row in rows) if images.scenes else 0,
    }


@dataclass(frozen=True)
class _ClassFigures:
    """Figures and tables of predictions of classes, which go to a report under a title."""

    report: Report
    predictions: Predictions
    names: Sequence[str]
    stem: str
    title: str

    def figure(self, name: str, caption: str, png: bytes) -> None:
        """Add a figure to the report, its file named with `stem`."""
        self.report.figure(f"{name}{self.stem}.png", caption, png)

    def confusion(
        self, name: str, caption: str, counts: NDArray[np.int64], classes: Sequence[str], title: str
    ) -> None:
        """Add counts [true class, predicted class] as a figure and a table, true classes down."""
        self.figure(name, caption, confusion_png(counts, classes, title))
        rows = (
            [class_name, *row] for class_name, row in zip(classes, counts.tolist(), strict=True)
        )
        # Beside its figure the page has no use for the table.
        self.report.table(f"{name}{self.stem}.csv", ["true \\ predicted", *classes], rows)

    def tables(self, classes: Mapping[str, Mapping[str, float]]) -> None:
        """Add the tables of the numbers of each class, and of the prediction of each image."""
        class_rows = [
            [name, *(float(f"{n:.4g}") for n in class_numbers.values())]
            for name, class_numbers in classes.items()
        ]
        header = ("class", "precision", "recall", "f1", "images")
        self.report.table(f"classes{self.stem}.csv", header, class_rows, "Class by class")
        predictions, names = self.predictions, self.names
        columns = (
            predictions.rows,
            predictions.truth,
            predictions.predicted,
            predictions.probabilities.max(1),
        )
        rows = (
            (predictions.images.names[row], names[true], names[predicted], f"{probability:.6f}")
            for row, true, predicted, probability in zip(*columns, strict=True)
        )
        prediction_header = ("image", "true", "predicted", "probability")
        self.report.table(f"predictions{self.stem}.csv", prediction_header, rows)

    def reliability(self, smoothing: float) -> dict[str, list[float | None] | list[int]]:
        """Add the reliability diagram; return its bins: mean probability, accuracy, images."""
        bins = metrics.calibration(self.predictions.truth, self.predictions.probabilities)
        comment = ""
        if smoothing:
            target_probability = 1 - smoothing + smoothing / len(self.names)
            comment = (
                f" Label smoothing of {smoothing:g} asks for a probability of "
                f"{target_probability:.2f} where the network is sure, so points above the line, "
                f"and an error of up to {1 - target_probability:.2f} with every prediction right, "
                "are what it was trained for."
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
        """Add the most confident mistakes; without mistakes, the least confident predictions."""
        predictions = self.predictions
        confidence, wrong = (
            predictions.probabilities.max(1),
            predictions.predicted != predictions.truth,
        )
        order = np.argsort(-confidence, kind="stable")
        selected, heading = order[wrong[order]][:MAX_MISTAKES], "Most confident mistakes"
        if not selected.size:
            selected, heading = order[::-1][:FEW], "No mistakes; the least confident predictions"
        class_words = [name.replace("_", " ") for name in self.names]
        rows = predictions.rows[selected].tolist()
        paths = [predictions.images.path_of(row) for row in rows]
        lines = [
            (
                class_words[predictions.truth[i]],
                class_words[predictions.predicted[i]],
                f"{100 * confidence[i]:.1f} %",
            )
            for i in selected
        ]
        names = [predictions.images.names[row] for row in rows]
        captions = [
            f"{escaped(name)}\ntrue: {true}\nfound: {predicted}, {probability}"
            for name, (true, predicted, probability) in zip(names, lines, strict=True)
        ]
        pictures = [predictions.images.pixels.read(row) for row in rows]
        png = captioned_png(pictures, captions, f"{heading}: {self.title}")
        self.figure("hardest", f"{heading}, {self.title}.", png)
        table = ((path, *line) for path, line in zip(paths, lines, strict=True))
        header = ("image", "true", "predicted", "probability")
        self.report.table(f"hardest{self.stem}.csv", header, table, heading)

    def in_place_vs_moving(self) -> list[list[int]]:
        """Add the confusion matrix of the paper's groups, S1 to S7 against S8 to S12; return it.

        Returns:
            Counts [true group, predicted group].
        """
        moving = {activity.slug: activity.walks for activity in ACTIVITIES}
        group = np.array([int(moving[name]) for name in self.names])
        truth, predicted = group[self.predictions.truth], group[self.predictions.predicted]
        counts = confusion_matrix(truth, predicted, labels=[0, 1])
        share = 100 * np.trace(counts) / max(1, counts.sum())
        caption = f"Standing activities (S1 to S7) against moving ones (S8 to S12), {self.title}."
        title = self.title.replace(" on ", "\non ", 1) + f"\n{share:.2f} %"
        self.confusion("in_place_vs_moving", caption, counts, GROUPS, title)
        group_counts: list[list[int]] = counts.tolist()
        return group_counts

    def tsne(self) -> dict[str, float | None]:
        """Add t-SNE of maps and of features; return the silhouettes of the classes in both.

        Raises:
            RunError: there are fewer than two images.
        """
        from radhar_cli.learning.embedding import embed, select_rows, separation, shrink

        predictions = self.predictions
        if predictions.rows.size < MIN_EMBEDDED:
            raise RunError(f"--tsne: needs at least {MIN_EMBEDDED} images; there is one")
        selected = select_rows(predictions.rows.size)
        maps = np.stack(
            [shrink(predictions.images.pixels.read(int(row))) for row in predictions.rows[selected]]
        )
        features, label = predictions.features[selected], predictions.truth[selected]
        map_silhouette, feature_silhouette = separation(maps, label), separation(features, label)
        panels = {"input maps": embed(maps), "features before the last layer": embed(features)}
        silhouettes = " and ".join(
            "unknown" if s is None else f"{s:.2f}" for s in (map_silhouette, feature_silhouette)
        )
        self.figure(
            "tsne",
            f"t-SNE of {len(selected)} maps and of their features, {self.title}; silhouettes "
            f"{silhouettes}.",
            embeddings_png(panels, label, self.names, self.title),
        )
        return {"maps": map_silhouette, "features": feature_silhouette}
