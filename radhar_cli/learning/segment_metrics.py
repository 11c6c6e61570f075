"""Quality of segments: F1 by their overlap, and the edit score of their order.

A predicted segment counts as right if it overlaps a true one of its class by an IoU of at least k,
and no other was predicted there before (Lea et al., Temporal convolutional networks for action
segmentation and detection, CVPR 2017, 156; as Abu Farha and Gall, MS-TCN, CVPR 2019, compute it).
The edit score is 1 - d / max(lengths), d the Levenshtein distance of the two orders of classes.
"""

from collections.abc import Collection, Iterable
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from radhar_cli.numerics.arrays import Index


class LabelSpan(NamedTuple):
    """Columns `start` to `stop` - 1, which have one label."""

    label: int
    start: int
    stop: int


def spans_of(labels: Index, ignored: Collection[int] = ()) -> list[LabelSpan]:
    """Spans of equal labels [column], without those of labels that are ignored."""
    cuts = [0, *(np.flatnonzero(np.diff(labels)) + 1).tolist(), labels.size]
    spans = (LabelSpan(int(labels[start]), start, stop) for start, stop in pairwise(cuts))
    return [span for span in spans if span.label not in ignored]


def count_overlaps(
    true: list[LabelSpan], predicted: list[LabelSpan], iou: float
) -> tuple[int, int, int]:
    """Numbers of segments that are right, wrong and missed, by an IoU of at least `iou`."""
    right, matched = 0, set[int]()
    for span in predicted:
        overlaps = [
            max(0, min(span.stop, other.stop) - max(span.start, other.start))
            / (max(span.stop, other.stop) - min(span.start, other.start))
            if other.label == span.label
            else 0.0
            for other in true
        ]
        if not overlaps:
            continue
        best = int(np.argmax(overlaps))
        if overlaps[best] >= iou and best not in matched:
            matched.add(best)
            right += 1
    return right, len(predicted) - right, len(true) - len(matched)


def f1_of_segments(pairs: Iterable[tuple[list[LabelSpan], list[LabelSpan]]], iou: float) -> float:
    """F1 of segments of several streams, (true, predicted) of each; 1 where there are none."""
    counts = np.array([count_overlaps(*pair, iou) for pair in pairs]).reshape(-1, 3).sum(0)
    right, wrong, missed = counts.tolist()
    total = 2 * right + wrong + missed
    return 2 * right / total if total else 1.0


def edit_score(true: list[LabelSpan], predicted: list[LabelSpan]) -> float:
    """Edit score of the order of classes, 0 to 1; 1 where neither has a segment."""
    a, b = [span.label for span in true], [span.label for span in predicted]
    distance = np.arange(len(b) + 1)
    for row, label in enumerate(a, 1):
        diagonal, distance[0] = distance[0], row
        for column, other in enumerate(b, 1):
            change = diagonal + (label != other)
            diagonal = distance[column]
            distance[column] = min(change, distance[column] + 1, distance[column - 1] + 1)
    return 1.0 - float(distance[-1]) / max(len(a), len(b), 1)
