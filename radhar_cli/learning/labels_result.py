"""One run that finds what everybody does, on one data set: how good each label is."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from sklearn.metrics import average_precision_score

from radhar_cli.figures.evaluation import bars_png
from radhar_cli.learning.evaluation import Predictions
from radhar_cli.learning.report_files import Report


def evaluate_labels(
    report: Report, predictions: Predictions, names: Sequence[str], stem: str, title: str
) -> dict[str, Any]:
    """Numbers of a network of labels: average precisions, and shares of inputs with all right.

    Only labels that occur have a precision; those that every image has are left out of the mean. A
    label is found where its probability is above 1/2.

    Args:
        report: report that receives figures and tables.
        predictions: probabilities of every label.
        names: names of the labels, in the order of the outputs.
        stem: end of the names of files.
        title: title of the figures.

    Returns:
        Plain numbers by their keys in report.json.
    """
    images, rows = predictions.images, predictions.rows
    is_true = images.multi_hot(names)[rows] > 0
    is_found = predictions.probabilities > 0.5
    is_exact, occurring = (
        (is_found == is_true).all(axis=1),
        np.flatnonzero(is_true.any(axis=0)).tolist(),
    )
    precision = [
        float(average_precision_score(is_true[:, n], predictions.probabilities[:, n]))
        for n in occurring
    ]
    occurring_names = [names[n] for n in occurring]
    counts = [int(is_true[:, n].sum()) for n in occurring]
    activities = images.activities
    people = np.array([len(activities[row]) for row in rows])
    # A label that every image has says nothing: any network has all of its precision.
    informative = [p for p, count in zip(precision, counts, strict=True) if count < rows.size]
    numbers = {
        "images": int(rows.size),
        "mean_average_precision": float(np.mean(informative or precision)),
        "exact_match": float(is_exact.mean()),
        "classes": {
            name: {"images": count, "average_precision": value}
            for name, count, value in zip(occurring_names, counts, precision, strict=True)
        },
        "people": {
            str(n): {
                "images": int(has_that_many.sum()),
                "exact_match": float(is_exact[has_that_many].mean()),
            }
            for n in np.unique(people).tolist()
            if (has_that_many := people == n).any()
        },
    }
    header = ("class", "images", "average_precision")
    label_rows = zip(occurring_names, counts, (f"{value:.4f}" for value in precision), strict=True)
    report.table(f"labels{stem}.csv", header, label_rows, "Label by label")
    prediction_rows = (
        (
            images.names[row],
            *(" ".join(np.array(names)[has_label]) for has_label in truth_and_finding),
        )
        for row, *truth_and_finding in zip(rows.tolist(), is_true, is_found, strict=True)
    )
    report.table(f"predictions{stem}.csv", ("image", "true", "found"), prediction_rows)
    caption = f"Average precision of each label, {title}."
    png = bars_png(
        occurring_names, [100 * value for value in precision], "average precision (%)", title
    )
    report.figure(f"labels{stem}.png", caption, png)
    return numbers
