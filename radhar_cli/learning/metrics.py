"""How good predictions are: intervals, confusion, precision and recall, calibration."""

import math
from collections.abc import Sequence
from statistics import NormalDist
from typing import Any

import numpy as np

from radhar_cli.arrays import Float, Index

CALIBRATION_BINS = 15


def wilson(correct: float, count: float) -> tuple[float, float]:
    """Wilson's interval of 95 % of the proportion correct/count; (0, 1) where count is 0."""
    if count == 0:
        return 0.0, 1.0
    z2 = NormalDist().inv_cdf(0.975) ** 2
    share = correct / count
    middle = share + z2 / (2 * count)
    half = math.sqrt(z2 * (share * (1 - share) + z2 / (4 * count)) / count)
    low, high = ((middle + side) / (1 + z2 / count) for side in (-half, half))
    return max(0.0, low), min(1.0, high)


def calibration_error(truth: Index, probabilities: Float) -> float:
    """Expected calibration error of the winning class's probability, in 15 equal bins.

    The sum over bins of their share times |accuracy - confidence| (Guo et al., 2017).

    Args:
        truth: [N].
        probabilities: [N, classes].
    """
    confidence, correct = probabilities.max(1), probabilities.argmax(1) == truth
    bins = np.clip(np.ceil(confidence * CALIBRATION_BINS).astype(int) - 1, 0, CALIBRATION_BINS - 1)
    gaps = np.bincount(bins, correct - confidence, CALIBRATION_BINS)
    return float(np.abs(gaps).sum() / max(1, truth.size))


def summary(truth: Index, probabilities: Float, classes: Sequence[str]) -> dict[str, Any]:
    """Everything of report.json: accuracy, macro F1, calibration, per class, confusion matrix.

    `confusion` is counts [true class, predicted class]. Precision, recall and F1 are 0 where they
    are 0/0; macro F1 is the mean over classes that occur as truth or as prediction.
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
        "accuracy_95": list(wilson(correct, truth.size)),
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
