"""F1 of segments and the edit score."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.learning.segment_metrics import edit_score, f1_of_segments, spans_of

LABELS = st.lists(st.integers(0, 3), min_size=1, max_size=40).map(np.array)


@given(LABELS)
def test_what_is_right_scores_one(labels: np.ndarray) -> None:
    spans = spans_of(labels, {0})
    assert edit_score(spans, spans) == 1
    assert f1_of_segments([(spans, spans)], 0.5) == 1


@given(LABELS, LABELS)
def test_scores_lie_between_none_and_all_and_fall_with_the_overlap(
    true: np.ndarray, found: np.ndarray
) -> None:
    pair = spans_of(true), spans_of(found)
    f1 = [f1_of_segments([pair], iou) for iou in (0.1, 0.25, 0.5)]
    assert 0 <= f1[2] <= f1[1] <= f1[0] <= 1
    assert 0 <= edit_score(*pair) <= 1
    assert edit_score(*pair) == edit_score(*pair[::-1])


@given(LABELS)
def test_spans_are_the_labels(labels: np.ndarray) -> None:
    again = np.concatenate([np.full(s.stop - s.start, s.label) for s in spans_of(labels)])
    assert (again == labels).all()


def test_an_example_by_hand() -> None:
    true = spans_of(np.repeat([0, 1, 0, 2], [5, 10, 5, 10]), {0})
    found = spans_of(np.repeat([0, 1, 0, 1, 0, 3, 0], [5, 4, 1, 5, 5, 8, 2]), {0})
    # 1 is found twice (4 and 5 of 10 columns), 2 as 3: one right, two wrong, one missed
    assert f1_of_segments([(true, found)], 0.25) == pytest.approx(2 / 5)
    assert f1_of_segments([(true, found)], 0.75) == 0
    assert edit_score(true, found) == pytest.approx(1 - 2 / 3)
