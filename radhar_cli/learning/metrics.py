"""Quality of predictions: confusion, precision and recall, calibration."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import sqrt
from typing import Any

import numpy as np

from radhar_cli.learning.intervals import Groups, numbers_of_share
from radhar_cli.numerics.arrays import Float, Index

CALIBRATION_BINS = 15
NEAR_M = 0.15  # joints that are nearer to the true ones count as right


@dataclass(frozen=True)
class Calibration:
    """Predictions in 15 equal bins of the probability of the winning class; nan in empty ones."""

    confidence: Float  # [15] mean probability
    accuracy: Float  # [15] share that is right
    count: Index  # [15]

    @property
    def error(self) -> float:
        """Expected calibration error: sum of share |accuracy - confidence| (Guo et al., 2017)."""
        gaps = np.nan_to_num(np.abs(self.accuracy - self.confidence)) * self.count
        return float(gaps.sum() / max(1, self.count.sum()))

    @property
    def in_words(self) -> str:
        """Mean probability beside the share that is right, as a sentence."""
        total = max(1, int(self.count.sum()))
        sure, right = (
            float(np.nansum(column * self.count) / total)
            for column in (self.confidence, self.accuracy)
        )
        chance = max(0.02, 2 * sqrt(right * (1 - right) / total))
        verdict = "too sure of itself" if sure > right else "right more often than it says"
        if abs(sure - right) <= chance:
            verdict = "as often right as it says"
        return (
            f"The network gives its predictions {100 * sure:.0f} % on average, and "
            f"{100 * right:.0f} % of them are right: it is {verdict}"
        )


def calibration(truth: Index, probabilities: Float) -> Calibration:
    """Reliability of the winning class by its probability, in equal bins.

    Args:
        truth: [N] numbers of the true classes.
        probabilities: [N, classes].
    """
    confidence, correct = probabilities.max(1), probabilities.argmax(1) == truth
    bins = np.clip(np.ceil(confidence * CALIBRATION_BINS).astype(int) - 1, 0, CALIBRATION_BINS - 1)
    count = np.bincount(bins, minlength=CALIBRATION_BINS)
    sums = [np.bincount(bins, values, CALIBRATION_BINS) for values in (confidence, correct)]
    mean, accuracy = (np.where(count, total / np.maximum(count, 1), np.nan) for total in sums)
    return Calibration(mean, accuracy, count)


def calibration_error(truth: Index, probabilities: Float) -> float:
    """Expected calibration error (Guo et al., 2017) of probabilities [N, classes], truth [N]."""
    return calibration(truth, probabilities).error


def summarise(
    truth: Index, probabilities: Float, classes: Sequence[str], groups: Groups
) -> dict[str, Any]:
    """Numbers of report.json: accuracy, macro F1, calibration, numbers by class, confusion matrix.

    Args:
        truth: [N] numbers of the true classes.
        probabilities: [N, classes].
        classes: names of the classes.
        groups: persons, recordings or samples, over which the interval is.

    Returns:
        Plain numbers by their keys in report.json. `confusion` is counts [true class,
        predicted class]. Precision, recall and F1 are 0 where they are 0/0; macro F1 is the mean
        over classes that occur as truth or as prediction.
    """
    from sklearn.metrics import confusion_matrix, precision_recall_fscore_support

    predicted, labels = probabilities.argmax(1), np.arange(len(classes))
    counts = confusion_matrix(truth, predicted, labels=labels)
    precision, recall, f1, images = precision_recall_fscore_support(
        truth, predicted, labels=labels, zero_division=0
    )
    correct, occurs = int(np.trace(counts)), counts.sum(0) + counts.sum(1) > 0
    return {
        "images": int(truth.size),
        "right": correct,
        "accuracy": correct / truth.size,
        **numbers_of_share("accuracy", (predicted == truth).astype(float), groups),
        "macro_f1": float(f1[occurs].mean()),
        "calibration_error": calibration_error(truth, probabilities),
        "classes": {
            name: {
                "precision": float(precision[i]),
                "recall": float(recall[i]),
                "f1": float(f1[i]),
                "images": int(images[i]),
            }
            for i, name in enumerate(classes)
            if occurs[i]
        },
        "confusion": counts.tolist(),
    }
