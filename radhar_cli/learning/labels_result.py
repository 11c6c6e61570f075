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
    """Average precision of every label that is there, and shares of inputs with all labels right.

    Labels that every image has are left out of the mean.

    Figures and tables go to `report`. A label is found where its probability is above 1/2.
    """
    images, rows = predictions.images, predictions.rows
    shown = images.multi_hot(names)[rows] > 0
    found = predictions.probabilities > 0.5
    exact, there = (found == shown).all(axis=1), np.flatnonzero(shown.any(axis=0)).tolist()
    precision = [
        float(average_precision_score(shown[:, n], predictions.probabilities[:, n])) for n in there
    ]
    present = [names[n] for n in there]
    counts = [int(shown[:, n].sum()) for n in there]
    done = images.activities
    people = np.array([len(done[row]) for row in rows])
    # A label that every image has says nothing: any network has all of its precision.
    told_apart = [p for p, count in zip(precision, counts, strict=True) if count < rows.size]
    numbers = {
        "images": int(rows.size),
        "mean_average_precision": float(np.mean(told_apart or precision)),
        "exact_match": float(exact.mean()),
        "classes": {
            name: {"images": count, "average_precision": value}
            for name, count, value in zip(present, counts, precision, strict=True)
        },
        "people": {
            str(n): {"images": int(mine.sum()), "exact_match": float(exact[mine].mean())}
            for n in np.unique(people).tolist()
            if (mine := people == n).any()
        },
    }
    head = ("class", "images", "average_precision")
    lines = zip(present, counts, (f"{value:.4f}" for value in precision), strict=True)
    report.table(f"labels{stem}.csv", head, lines, "Label by label")
    told = (
        (images.names[row], *(" ".join(np.array(names)[one]) for one in pair))
        for row, *pair in zip(rows.tolist(), shown, found, strict=True)
    )
    report.table(f"predictions{stem}.csv", ("image", "true", "found"), told)
    caption = f"Average precision of each label, {title}."
    png = bars_png(present, [100 * value for value in precision], "average precision (%)", title)
    report.figure(f"labels{stem}.png", caption, png)
    return numbers
