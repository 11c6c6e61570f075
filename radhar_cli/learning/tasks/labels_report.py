"""One network that finds what everybody does, on one data set: how good each label is."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from sklearn.metrics import average_precision_score

from radhar_cli.figures.evaluation import bars_png, captioned_png, reliability_png
from radhar_cli.files.untrusted import escaped
from radhar_cli.learning import metrics
from radhar_cli.learning.intervals import numbers_of_share
from radhar_cli.learning.tasks.predictions import Predictions
from radhar_cli.learning.tasks.task import Evaluation
from radhar_cli.numerics.arrays import Bool

THRESHOLD = 0.5  # probability above which a label is found
MAX_MISTAKES = 8  # images of the figure


@dataclass(frozen=True)
class LabelResult:
    """Score of the detection of one label."""

    name: str
    images: int  # that have it
    average_precision: float


def report_labels(evaluation: Evaluation) -> dict[str, Any]:
    """Report the average precision of each label, and shares of inputs with all labels right.

    Only labels that occur have a precision; those that every image has are left out of the mean.

    Returns:
        Plain numbers by their keys in report.json.
    """
    predictions = evaluation.predictions
    images, rows = predictions.images, predictions.rows
    is_true = images.multi_hot(predictions.names)[rows] > 0  # [N, classes]
    is_found = predictions.values > THRESHOLD
    results = list(_measure_labels(predictions, is_true))
    precision = [result.average_precision for result in results]
    header = ("class", "images", "average_precision")
    label_rows = ((r.name, r.images, round(r.average_precision, 4)) for r in results)
    evaluation.table("labels", header, label_rows, "Label by label")
    names = np.array(predictions.names)
    prediction_rows = (
        (images.samples.name[row], " ".join(names[true]), " ".join(names[found]))
        for row, true, found in zip(rows.tolist(), is_true, is_found, strict=True)
    )
    evaluation.table("predictions", ("image", "true", "found"), prediction_rows)
    percent = [100 * value for value in precision]
    quantity = "average precision (%)"
    png = bars_png([result.name for result in results], percent, quantity, evaluation.title)
    evaluation.figure("labels", f"Average precision of each label, {evaluation.title}.", png)
    _draw_reliability(evaluation, is_true)
    if images.is_pictures:
        _draw_mistakes(evaluation, is_true)
    # A label that every image has says nothing: any network has all of its precision.
    informative = [r.average_precision for r in results if r.images < rows.size]
    is_exact = (is_found == is_true).all(axis=1)
    return {
        "images": int(rows.size),
        "mean_average_precision": float(np.mean(informative or precision)),
        "exact_match": float(is_exact.mean()),
        **numbers_of_share("exact_match", is_exact.astype(float), evaluation.groups),
        "classes": {
            r.name: {"images": r.images, "average_precision": r.average_precision} for r in results
        },
        "people": _exact_match_by_people(predictions, is_exact),
    }


def _draw_reliability(evaluation: Evaluation, is_true: Bool) -> None:
    """Add the reliability diagram of all labels, found or not, by is_true [N, classes]."""
    probability = evaluation.predictions.values.ravel()
    both = np.stack([1 - probability, probability], axis=1)
    bins = metrics.calibration(is_true.ravel().astype(np.intp), both)
    error = f"calibration error {100 * bins.error:.1f} %"
    caption = (
        f"Calibration: how often a label that is found or not is right, by its probability. "
        f"{bins.in_words}; {error} (mean distance from the line)."
    )
    title = f"{evaluation.title}\n{error}"
    png = reliability_png(bins.confidence, bins.accuracy, bins.count, title)
    evaluation.figure("reliability", caption, png)


def _draw_mistakes(evaluation: Evaluation, is_true: Bool) -> None:
    """Add the images with the surest wrong label, found or not, by is_true [N, classes]."""
    predictions = evaluation.predictions
    images, wrong = predictions.images, np.abs(predictions.values - is_true)  # [N, classes]
    worst = np.argsort(-wrong.max(axis=1), kind="stable")[:MAX_MISTAKES]
    worst = worst[wrong[worst].max(axis=1) > THRESHOLD]
    if not worst.size:
        return
    pictures, captions = [], []
    for number in worst.tolist():
        label = int(wrong[number].argmax())
        name, probability = predictions.names[label], predictions.values[number, label]
        row = int(predictions.rows[number])
        presence = "is there" if is_true[number, label] else "is not there"
        verdict = f"{name.replace('_', ' ')}: {100 * probability:.0f} %, {presence}"
        pictures.append(images.pixels.read(row))
        captions.append(f"{escaped(images.samples.name[row])}\n{verdict}")
    heading = "Most confident mistakes"
    png = captioned_png(pictures, captions, f"{heading}: {evaluation.title}")
    evaluation.figure("hardest", f"{heading}, {evaluation.title}.", png)


def _measure_labels(predictions: Predictions, is_true: Bool) -> Iterator[LabelResult]:
    """Yield the result of each label that occurs, by is_true [N, classes]."""
    for number in np.flatnonzero(is_true.any(axis=0)).tolist():
        truth, probability = is_true[:, number], predictions.values[:, number]
        precision = float(average_precision_score(truth, probability))
        yield LabelResult(predictions.names[number], int(truth.sum()), precision)


def _exact_match_by_people(predictions: Predictions, is_exact: Bool) -> dict[str, dict[str, float]]:
    """Images, and share with all labels right, by the number of people: {number: numbers}."""
    activities = predictions.images.activities
    people = np.array([len(activities[row]) for row in predictions.rows])
    numbers = {}
    for count in np.unique(people).tolist():
        is_exact_there = is_exact[people == count]
        numbers[str(count)] = {
            "images": int(is_exact_there.size),
            "exact_match": float(is_exact_there.mean()),
        }
    return numbers
