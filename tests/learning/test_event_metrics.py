"""Alarms of events: what is found, false alarms, delays, alarms that are one."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.learning.event_metrics import (
    AlarmRules,
    ScoredRecording,
    begin_alarms,
    count_events,
    events_of,
    match_alarms,
    score_events,
)

COLUMN_S = 0.1
FALLS = (2, 3)
RULES = AlarmRules(smooth_s=0.1, merge_s=2.0, early_s=0.5, late_s=3.0)
# spans of labels, each longer than the tolerance, so that events are apart
TRUTHS = st.lists(st.integers(0, 3), min_size=1, max_size=12).map(lambda few: np.repeat(few, 60))


def recording(true: np.ndarray, score: np.ndarray) -> ScoredRecording:
    return ScoredRecording("one", 0, score, true >= 0, events_of(true, FALLS))


def with_falls(*starts: int, columns: int = 600, length: int = 12) -> np.ndarray:
    true = np.zeros(columns, int)
    for start in starts:
        true[start : start + length] = 2
    return true


def with_alarms(*starts: int, columns: int = 600) -> np.ndarray:
    score = np.zeros(columns)
    for start in starts:
        score[start : start + 3] = 0.9
    return score


@given(TRUTHS, st.floats(0.01, 1.0))
def test_a_perfect_score_finds_all_at_once_and_nothing_else(
    true: np.ndarray, threshold: float
) -> None:
    is_fall = np.isin(true, FALLS)
    counts = count_events([recording(true, is_fall.astype(float))], threshold, COLUMN_S, RULES)
    assert counts.is_found.all()
    assert counts.recall in (None, 1)
    assert counts.false_alarms == 0
    assert (counts.delay_s == 0).all()
    assert counts.hours == pytest.approx(true.size * COLUMN_S / 3600)


@given(TRUTHS, st.lists(st.floats(0, 1), min_size=12, max_size=12))
def test_found_and_false_alarms_are_no_more_than_alarms(
    true: np.ndarray, levels: list[float]
) -> None:
    score = np.repeat(levels, 60)[: true.size]
    for threshold in (0.1, 0.5, 0.9):
        alarms = begin_alarms(score, threshold, RULES.merge_s / COLUMN_S)
        counts = count_events([recording(true, score)], threshold, COLUMN_S, RULES)
        assert counts.is_found.sum() + counts.false_alarms <= len(alarms)
        assert counts.delay_s.size == counts.is_found.sum()


def test_without_events_there_is_no_recall_but_a_rate_of_false_alarms() -> None:
    counts = count_events([recording(with_falls(), with_alarms(100, 300))], 0.5, COLUMN_S, RULES)
    assert counts.recall is None
    assert counts.delay(0.5) is None
    assert counts.false_alarms_an_hour == pytest.approx(2 * 60)  # two in a minute


@pytest.mark.parametrize(
    ("start", "delay"), [(196, -0.4), (200, 0.0), (207, 0.7), (240, 4.0), (194, None), (244, None)]
)
def test_an_alarm_is_of_an_event_from_shortly_before_it_to_soon_after(
    start: int, delay: float | None
) -> None:
    """A fall from 20 to 21.2 s, which an alarm from 19.5 to 24.2 s finds."""
    counts = count_events([recording(with_falls(200), with_alarms(start))], 0.5, COLUMN_S, RULES)
    assert counts.delay(0.5) == (None if delay is None else pytest.approx(delay))
    assert counts.false_alarms == (delay is None)
    assert counts.recall == (delay is not None)


def test_alarms_close_to_each_other_are_one_and_a_long_one_is_one() -> None:
    merge = RULES.merge_s / COLUMN_S  # 20 columns
    assert begin_alarms(with_alarms(100, 110, 130), 0.5, merge) == [100]
    assert begin_alarms(with_alarms(100, 123), 0.5, merge) == [100, 123]
    assert begin_alarms(np.ones(600), 0.5, merge) == [0]


def test_an_alarm_finds_one_event_and_a_second_alarm_of_an_event_is_not_false() -> None:
    two = recording(with_falls(200, 225), with_alarms(212))
    assert match_alarms(two, 0.5, COLUMN_S, RULES).of_events == [212, None]
    again = recording(with_falls(200), with_alarms(201, 225))
    alarms = match_alarms(again, 0.5, COLUMN_S, RULES)
    assert (alarms.of_events, alarms.false) == ([201], [])


def test_falls_of_several_kinds_in_a_row_are_one_event() -> None:
    true = np.repeat([0, 2, 3, 1, -1, 3, 0], 10)
    assert [tuple(event) for event in events_of(true, FALLS)] == [(2, 10, 30), (3, 50, 60)]


def test_the_score_is_the_moving_mean_of_the_sum_of_probabilities() -> None:
    probabilities = np.zeros((9, 4))
    probabilities[:, 0] = 1
    probabilities[4] = [0.1, 0.0, 0.6, 0.3]
    score = score_events(probabilities, FALLS, COLUMN_S, smooth_s=0.3)
    assert score == pytest.approx([0, 0, 0, 0.3, 0.3, 0.3, 0, 0, 0])
    assert score_events(probabilities, FALLS, COLUMN_S, 0.1)[4] == pytest.approx(0.9)
    assert score_events(np.ones((3, 4)), FALLS, COLUMN_S, 60.0) == pytest.approx([2, 2, 2])


def test_columns_without_a_label_are_no_time() -> None:
    known = recording(with_falls(200), with_alarms(200))
    half = replace(known, is_known=np.arange(600) >= 300)
    counts = count_events([known, half], 0.5, COLUMN_S, RULES)
    assert counts.hours == pytest.approx(90 / 3600)
