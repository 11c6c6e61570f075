"""Alarms of rare events, such as falls: events found, false alarms an hour, delays.

The score of a column is the sum of the probabilities of the classes that are an event, as a moving
mean. An alarm begins where the score reaches a threshold; it goes on over gaps that are shorter
than `merge_s`. An event is found by an alarm that begins within it, shortly before (a moving mean,
and a network that looks ahead, are early), or soon after its end. One alarm finds one event; an
alarm of no event is false.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass

import numpy as np

from radhar_cli.learning.segment_metrics import LabelSpan, spans_of
from radhar_cli.numerics.arrays import Bool, Float, Index


@dataclass(frozen=True)
class AlarmRules:
    """Rules by which scores become alarms, and alarms find events; all in s."""

    smooth_s: float = 0.5  # of the moving mean
    merge_s: float = 5.0  # shorter gaps between alarms make them one
    early_s: float = 0.5  # before its beginning from which on an alarm is of an event
    late_s: float = 5.0  # after its end until which it is


@dataclass(frozen=True)
class ScoredRecording:
    """A recording with the score of its columns and its true events.

    Columns that are in no window have the score 0 and do not count as time.
    """

    name: str
    group: int  # number of its person, or of itself
    score: Float  # [W]
    is_known: Bool  # [W] whether a column has a true label
    events: list[LabelSpan]  # each with the label of its first column


@dataclass(frozen=True)
class Alarms:
    """Alarms of a recording at a threshold, in columns."""

    of_events: list[int | None]  # [event] column at which its alarm begins; None where it is missed
    false: list[int]  # columns at which false alarms begin


def score_events(
    probabilities: Float, labels: Collection[int], column_s: float, smooth_s: float
) -> Float:
    """Score [W] of events: moving mean of the sum of the probabilities of their labels.

    Args:
        probabilities: [W, classes].
        labels: numbers of the classes that are an event.
        column_s: time step of the columns, s.
        smooth_s: length of the mean, s, an odd number of columns; at the ends it is shorter.
    """
    raw: Float = probabilities[:, sorted(labels)].sum(1)
    half = round(smooth_s / column_s) // 2
    sums = np.concatenate([[0.0], np.cumsum(raw)])
    place = np.arange(raw.size)
    start, stop = np.maximum(place - half, 0), np.minimum(place + half + 1, raw.size)
    mean: Float = (sums[stop] - sums[start]) / (stop - start)
    return mean


def events_of(true: Index, labels: Collection[int]) -> list[LabelSpan]:
    """True events of columns [W]: spans of the given labels, of several in a row one."""
    is_event = np.isin(true, sorted(labels)).astype(int)
    return [
        LabelSpan(int(true[span.start]), span.start, span.stop) for span in spans_of(is_event, {0})
    ]


def begin_alarms(score: Float, threshold: float, merge: float) -> list[int]:
    """Columns at which alarms begin: the score reaches the threshold after `merge` columns below.

    Args:
        score: [W].
        threshold: smallest score of an alarm.
        merge: gaps below that many columns do not end an alarm.
    """
    starts, end = list[int](), -np.inf
    for span in spans_of((score >= threshold).astype(int), {0}):
        if span.start - end >= merge:
            starts.append(span.start)
        end = span.stop
    return starts


def match_alarms(
    recording: ScoredRecording, threshold: float, column_s: float, rules: AlarmRules
) -> Alarms:
    """Find which events have an alarm, and which alarms have no event.

    An alarm finds the first event that it may be of and that has none yet; where all of these have
    one, it is neither found nor false.
    """
    of_events: list[int | None] = [None] * len(recording.events)
    false = list[int]()
    early, late = rules.early_s / column_s, rules.late_s / column_s
    for start in begin_alarms(recording.score, threshold, rules.merge_s / column_s):
        places = [
            place
            for place, event in enumerate(recording.events)
            if event.start - early <= start <= event.stop + late
        ]
        missing = [place for place in places if of_events[place] is None]
        if missing:
            of_events[missing[0]] = start
        elif not places:
            false.append(start)
    return Alarms(of_events, false)


@dataclass(frozen=True)
class EventCounts:
    """Events and alarms of recordings at a threshold."""

    threshold: float
    hours: float
    is_found: Bool  # [event]
    delay_s: Float  # [found event] from its beginning to its alarm; below 0 where that is early
    false_alarms: int

    @property
    def recall(self) -> float | None:
        """Share of the events that are found; None where there are none."""
        return float(self.is_found.mean()) if self.is_found.size else None

    @property
    def false_alarms_an_hour(self) -> float:
        """Rate of the alarms that are false."""
        return self.false_alarms / self.hours

    def delay(self, share: float) -> float | None:
        """Delay that so great a share of the found events does not exceed, s; None without any."""
        return float(np.quantile(self.delay_s, share)) if self.delay_s.size else None


def count_events(
    recordings: Sequence[ScoredRecording], threshold: float, column_s: float, rules: AlarmRules
) -> EventCounts:
    """Count events, found and missed, and false alarms of recordings at a threshold."""
    alarms = [match_alarms(r, threshold, column_s, rules) for r in recordings]
    starts = [
        (event.start, start)
        for recording, one in zip(recordings, alarms, strict=True)
        for event, start in zip(recording.events, one.of_events, strict=True)
    ]
    return EventCounts(
        threshold,
        sum(int(r.is_known.sum()) for r in recordings) * column_s / 3600,
        np.array([start is not None for _, start in starts], bool),
        np.array([(start - begin) * column_s for begin, start in starts if start is not None]),
        sum(len(one.false) for one in alarms),
    )
