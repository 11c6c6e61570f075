"""How good predictions are: intervals, confusion, precision and recall, calibration."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import Any

import numpy as np
from numpy.typing import NDArray

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


def _ratio(above: Float, below: NDArray[np.int64]) -> Float:
    return np.divide(above, below, out=np.zeros_like(above), where=below > 0)


@dataclass(frozen=True)
class Calibration:
    """Predictions by confidence: mean confidence, accuracy and number of each bin; their gap."""

    confidence: Float
    accuracy: Float
    count: NDArray[np.int64]
    # expected calibration error, sum over bins of share |accuracy - confidence| (Guo et al., 2017),
    # 15 equal bins
    error: float


def calibration(truth: Index, probabilities: Float) -> Calibration:
    """Calibration of the winning class's probability.

    Args:
        truth: [N].
        probabilities: [N, classes].
    """
    confidence, correct = probabilities.max(1), probabilities.argmax(1) == truth
    bins = np.clip(np.ceil(confidence * CALIBRATION_BINS).astype(int) - 1, 0, CALIBRATION_BINS - 1)
    count = np.bincount(bins, minlength=CALIBRATION_BINS)
    mean_confidence = _ratio(np.bincount(bins, confidence, CALIBRATION_BINS).astype(float), count)
    accuracy = _ratio(np.bincount(bins, correct, CALIBRATION_BINS).astype(float), count)
    gap = float((count * np.abs(accuracy - mean_confidence)).sum() / max(1, truth.size))
    return Calibration(mean_confidence, accuracy, count.astype(np.int64), gap)


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
        "calibration_error": calibration(truth, probabilities).error,
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
