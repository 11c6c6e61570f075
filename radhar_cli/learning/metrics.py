"""How good predictions are: intervals, confusion, precision and recall, calibration."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.arrays import Float, Index

CALIBRATION_BINS = 15


def wilson(right: int, count: int, confidence: float = 0.95) -> tuple[float, float]:
    """Wilson's interval of a proportion of `right` among `count`; (0, 1) of none."""
    if count == 0:
        return 0.0, 1.0
    from scipy.stats import binomtest

    interval = binomtest(right, count).proportion_ci(confidence, method="wilson")
    return float(interval.low), float(interval.high)


def confusion(truth: Index, predicted: Index, classes: int) -> NDArray[np.int64]:
    """Counts [true class, predicted class]."""
    flat = np.bincount(truth * classes + predicted, minlength=classes * classes)
    return flat.reshape(classes, classes).astype(np.int64)


@dataclass(frozen=True)
class PerClass:
    """Precision, recall and F1 [classes], each 0 where it is undefined, and images a class."""

    precision: Float
    recall: Float
    f1: Float
    support: NDArray[np.int64]


def per_class(counts: NDArray[np.int64]) -> PerClass:
    """Precision, recall and F1 of every class of a confusion matrix."""
    right = np.diag(counts).astype(float)
    called, there = counts.sum(0), counts.sum(1)
    return PerClass(
        precision=_ratio(right, called),
        recall=_ratio(right, there),
        f1=_ratio(2 * right, called + there),
        support=there,
    )


def _ratio(above: Float, below: NDArray[np.int64]) -> Float:
    return np.divide(above, below, out=np.zeros_like(above), where=below > 0)


def macro_f1(counts: NDArray[np.int64]) -> float:
    """Mean F1 of the classes that occur, as truth or as prediction."""
    found = per_class(counts)
    occurs = (counts.sum(0) + counts.sum(1)) > 0
    return float(found.f1[occurs].mean()) if occurs.any() else 0.0


@dataclass(frozen=True)
class Calibration:
    """Predictions by confidence: mean confidence, accuracy and number of each bin; their gap.

    Attributes:
        error: expected calibration error, sum over bins of share |accuracy - confidence|
            (Guo et al., 2017), 15 equal bins.
    """

    confidence: Float
    accuracy: Float
    count: NDArray[np.int64]
    error: float


def calibration(truth: Index, probabilities: Float) -> Calibration:
    """Calibration of the winning class's probability.

    Args:
        truth: [N].
        probabilities: [N, classes].
    """
    sure, right = probabilities.max(1), probabilities.argmax(1) == truth
    bins = np.clip(np.ceil(sure * CALIBRATION_BINS).astype(int) - 1, 0, CALIBRATION_BINS - 1)
    count = np.bincount(bins, minlength=CALIBRATION_BINS)
    mean_sure = _ratio(np.bincount(bins, sure, CALIBRATION_BINS).astype(float), count)
    mean_right = _ratio(np.bincount(bins, right, CALIBRATION_BINS).astype(float), count)
    gap = float((count * np.abs(mean_right - mean_sure)).sum() / max(1, truth.size))
    return Calibration(mean_sure, mean_right, count.astype(np.int64), gap)


def summary(truth: Index, probabilities: Float, classes: Sequence[str]) -> dict[str, Any]:
    """All of it as plain values for report.json."""
    predicted = probabilities.argmax(1)
    counts = confusion(truth, predicted, len(classes))
    right, found = int(np.trace(counts)), per_class(counts)
    low, high = wilson(right, truth.size)
    present = found.support > 0
    return {
        "images": int(truth.size),
        "right": right,
        "accuracy": right / truth.size,
        "accuracy_95": [low, high],
        "macro_f1": macro_f1(counts),
        "calibration_error": calibration(truth, probabilities).error,
        "classes": {
            name: {
                "precision": float(found.precision[i]),
                "recall": float(found.recall[i]),
                "f1": float(found.f1[i]),
                "images": int(found.support[i]),
            }
            for i, name in enumerate(classes)
            if present[i] or counts[:, i].any()
        },
        "confusion": counts.tolist(),
    }
