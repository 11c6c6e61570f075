"""One classifier on one data set: confusion, reliability, mistakes and t-SNE."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from sklearn.metrics import confusion_matrix

from radhar_cli.figures.evaluation import (
    captioned_png,
    confusion_png,
    embeddings_png,
    reliability_png,
)
from radhar_cli.files.untrusted import escaped
from radhar_cli.learning import metrics
from radhar_cli.learning.run_files import RunError
from radhar_cli.learning.tasks.predictions import ClassPredictions
from radhar_cli.learning.tasks.task import Evaluation
from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.numerics.arrays import Float, Index, Levels

MIN_EMBEDDED = 2
MAX_MISTAKES, MAX_UNSURE = 12, 4  # images of the figure
GROUPS = ("in place", "moving")


def report_classes(evaluation: Evaluation, label_smoothing: float) -> dict[str, Any]:
    """Report accuracy, F1, calibration and confusion, and the figures that are asked for.

    Args:
        evaluation: probabilities of a classifier, and where they are reported.
        label_smoothing: zeta of the training, for a remark on the calibration.

    Returns:
        Plain numbers by their keys in report.json.
    """
    predictions, options = ClassPredictions(**vars(evaluation.predictions)), evaluation.options
    names, title = predictions.names, evaluation.title
    truth, probabilities = predictions.truth, predictions.probabilities
    numbers = metrics.summarise(truth, probabilities, names, evaluation.groups)
    figures = _ClassFigures(evaluation, predictions)
    caption = f"Confusion matrix of {title}: counts, and shares of the true class."
    accuracy = f"{title}: {100 * numbers['accuracy']:.2f} % of {predictions.rows.size}"
    counts = np.array(numbers["confusion"])
    figures.draw_confusion("confusion", caption, counts, names, accuracy)
    figures.write_tables(numbers["classes"])
    numbers["calibration"] = figures.draw_reliability(label_smoothing)
    if predictions.images.is_pictures:
        figures.draw_hardest()
    if options.in_place_vs_moving:
        numbers["in_place_vs_moving"] = figures.draw_groups()
    if options.tsne:
        numbers["silhouette"] = figures.draw_tsne()
    return numbers


@dataclass(frozen=True)
class _ClassFigures:
    """Figures and tables of predictions of classes."""

    evaluation: Evaluation
    predictions: ClassPredictions

    def draw_confusion(
        self, name: str, caption: str, counts: NDArray[np.int64], classes: Sequence[str], title: str
    ) -> None:
        """Add counts [true class, predicted class] as a figure and a table, true classes down."""
        self.evaluation.figure(name, caption, confusion_png(counts, classes, title))
        rows = (
            [class_name, *row] for class_name, row in zip(classes, counts.tolist(), strict=True)
        )
        # Beside its figure the page has no use for the table.
        self.evaluation.table(name, ["true \\ predicted", *classes], rows)

    def write_tables(self, classes: Mapping[str, Mapping[str, float]]) -> None:
        """Add the tables of the numbers of each class, and of the prediction of each image."""
        class_rows = [
            [name, *(float(f"{n:.4g}") for n in class_numbers.values())]
            for name, class_numbers in classes.items()
        ]
        header = ("class", "precision", "recall", "f1", "images")
        self.evaluation.table("classes", header, class_rows, "Class by class")
        predictions = self.predictions
        image_names, names = predictions.images.samples.name, predictions.names
        columns = (
            predictions.rows,
            predictions.truth,
            predictions.predicted,
            predictions.probabilities.max(1),
        )
        rows = (
            (image_names[row], names[true], names[predicted], f"{probability:.6f}")
            for row, true, predicted, probability in zip(*columns, strict=True)
        )
        self.evaluation.table("predictions", ("image", "true", "predicted", "probability"), rows)

    def draw_reliability(self, smoothing: float) -> dict[str, list[float | None] | list[int]]:
        """Add the reliability diagram; return its bins: mean probability, accuracy, images."""
        predictions, title = self.predictions, self.evaluation.title
        bins = metrics.calibration(predictions.truth, predictions.probabilities)
        remark = ""
        if smoothing:
            target_probability = 1 - smoothing + smoothing / len(predictions.names)
            remark = (
                f" Label smoothing of {smoothing:g} asks for a probability of "
                f"{target_probability:.2f} where the network is sure, so points above the line, "
                f"and an error of up to {1 - target_probability:.2f} with every prediction right, "
                "are what it was trained for."
            )
        error = f"calibration error {100 * bins.error:.1f} %"
        caption = (
            f"Calibration: how often a prediction is right, by the probability that the network "
            f"gives it. {bins.in_words}; {error} (mean distance from the line).{remark}"
        )
        png = reliability_png(bins.confidence, bins.accuracy, bins.count, f"{title}\n{error}")
        self.evaluation.figure("reliability", caption, png)
        confidence, accuracy = (
            [None if np.isnan(value) else value for value in column.tolist()]
            for column in (bins.confidence, bins.accuracy)
        )
        return {"confidence": confidence, "accuracy": accuracy, "images": bins.count.tolist()}

    def draw_hardest(self) -> None:
        """Add the most confident mistakes; without mistakes, the least confident predictions."""
        images, names = self.predictions.images, self.predictions.names
        heading, selected = self._select_hardest()
        truth, predicted = self.predictions.truth, self.predictions.predicted
        confidence = self.predictions.probabilities.max(1)
        rows = self.predictions.rows
        pictures, captions, table = list[Levels](), list[str](), list[tuple[str, ...]]()
        for number in selected.tolist():
            row = int(rows[number])
            true, winner = (names[c[number]].replace("_", " ") for c in (truth, predicted))
            probability = f"{100 * confidence[number]:.1f} %"
            pictures.append(images.pixels.read(row))
            captions.append(
                f"{escaped(images.samples.name[row])}\ntrue: {true}\nfound: {winner}, {probability}"
            )
            table.append((images.path_of(row), true, winner, probability))
        png = captioned_png(pictures, captions, f"{heading}: {self.evaluation.title}")
        self.evaluation.figure("hardest", f"{heading}, {self.evaluation.title}.", png)
        header = ("image", "true", "predicted", "probability")
        self.evaluation.table("hardest", header, table, heading)

    def _select_hardest(self) -> tuple[str, Index]:
        """Heading, and places in the predictions, of the images of `draw_hardest`."""
        order = np.argsort(-self.predictions.probabilities.max(1), kind="stable")
        mistakes = order[(self.predictions.predicted != self.predictions.truth)[order]]
        if mistakes.size:
            return "Most confident mistakes", mistakes[:MAX_MISTAKES]
        return "No mistakes; the least confident predictions", order[::-1][:MAX_UNSURE]

    def draw_groups(self) -> list[list[int]]:
        """Add the confusion matrix of the paper's groups, S1 to S7 against S8 to S12; return it.

        Returns:
            Counts [true group, predicted group].
        """
        moving = {activity.slug: activity.walks for activity in ACTIVITIES}
        group = np.array([int(moving[name]) for name in self.predictions.names])
        truth, predicted = group[self.predictions.truth], group[self.predictions.predicted]
        counts = confusion_matrix(truth, predicted, labels=[0, 1])
        share = 100 * np.trace(counts) / max(1, counts.sum())
        title = self.evaluation.title
        caption = f"Standing activities (S1 to S7) against moving ones (S8 to S12), {title}."
        two_lines = title.replace(" on ", "\non ", 1) + f"\n{share:.2f} %"
        self.draw_confusion("in_place_vs_moving", caption, counts, GROUPS, two_lines)
        group_counts: list[list[int]] = counts.tolist()
        return group_counts

    def draw_tsne(self) -> dict[str, float | None]:
        """Add t-SNE of maps and of features; return the silhouettes of the classes in both.

        Raises:
            RunError: there are fewer than two images.
        """
        from radhar_cli.learning.embedding import embed, select_rows, separation, shrink

        predictions, title = self.predictions, self.evaluation.title
        if predictions.rows.size < MIN_EMBEDDED:
            raise RunError(f"--tsne: needs at least {MIN_EMBEDDED} images; there is one")
        selected = select_rows(predictions.rows.size)
        rows, label = predictions.rows[selected], predictions.truth[selected]
        pixels = predictions.images.pixels
        maps = np.stack([shrink(pixels.read(int(row))) for row in rows])
        features: Float = self.evaluation.features(rows)
        silhouettes = {"maps": separation(maps, label), "features": separation(features, label)}
        panels = {"input maps": embed(maps), "features before the last layer": embed(features)}
        in_words = " and ".join(
            "unknown" if s is None else f"{s:.2f}" for s in silhouettes.values()
        )
        caption = (
            f"t-SNE of {len(selected)} maps and of their features, {title}; silhouettes {in_words}."
        )
        self.evaluation.figure(
            "tsne", caption, embeddings_png(panels, label, predictions.names, title)
        )
        return silhouettes
