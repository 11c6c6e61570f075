"""Rare events, such as falls, that one network finds in streams: alarms over the threshold."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from typing import Any

import numpy as np

from radhar_cli.errors import FolderError
from radhar_cli.figures.evaluation import AlarmPoint, alarms_png
from radhar_cli.learning.event_metrics import (
    EventCounts,
    ScoredRecording,
    count_events,
    match_alarms,
)
from radhar_cli.learning.intervals import (
    Groups,
    ends_in_words,
    interval_in_words,
    numbers_of_rate,
    numbers_of_share,
)
from radhar_cli.learning.tasks.task import Evaluation

THRESHOLDS = (0.02, 0.05, *(n / 10 for n in range(1, 10)), 0.95, 0.98)
CURVE = ("threshold", "found", "events", "recall", "false_alarms", "false_alarms_an_hour")
DELAYS = ("delay_median_s", "delay_90_s")
ALARMS = ("recording", "class", "start_s", "stop_s", "alarm_s", "delay_s")


def report_events(
    evaluation: Evaluation, recordings: Sequence[ScoredRecording], column_s: float
) -> dict[str, Any]:
    """Report events found, false alarms an hour and delays, at one threshold and over all.

    Args:
        evaluation: network, data and options, which name the events.
        recordings: scores and true events.
        column_s: time step of the columns, s.

    Returns:
        Plain numbers of the key `events` in report.json; a recall of null without any events.

    Raises:
        FolderError: no column has a label that the network knows.
    """
    options = evaluation.options
    if not any(recording.is_known.any() for recording in recordings):
        where = evaluation.predictions.images.where
        raise FolderError(f"{where}: --events: no column has a class that the network knows")
    curve = [
        count_events(recordings, threshold, column_s, options.alarms)
        for threshold in sorted({*THRESHOLDS, options.event_threshold})
    ]
    counts = next(c for c in curve if c.threshold == options.event_threshold)
    kind = evaluation.groups.kind
    numbers = {
        "classes": list(options.events),
        "threshold": counts.threshold,
        **asdict(options.alarms),
        "hours": counts.hours,
        "events": int(counts.is_found.size),
        "found": int(counts.is_found.sum()),
        "recall": _recall(recordings, counts, kind),
        "false_alarms": _false_alarms(evaluation, recordings, column_s),
        "delay_median_s": counts.delay(0.5),
        "delay_90_s": counts.delay(0.9),
        "by_class": _count_by_class(evaluation, recordings, counts),
        "curve": [dict(zip((*CURVE, *DELAYS), _curve_row(c), strict=True)) for c in curve],
    }
    _show(evaluation, numbers)
    _list_alarms(evaluation, recordings, column_s)
    return numbers


def summarise_events(numbers: Mapping[str, Any]) -> str:
    """Numbers of `report_events` in words."""
    names, false = ", ".join(numbers["classes"]), numbers["false_alarms"]
    ends = ends_in_words(false["an_hour_95"], "an hour", false["interval_over"])
    alarms = f"{false['an_hour']:.2f} false alarms an hour {ends} in {numbers['hours']:.2f} h"
    if not numbers["events"]:
        return f"no {names} in these data, so that recall is not measured; {alarms}"
    recall = numbers["recall"]
    interval = interval_in_words(recall["share_95"], recall["interval_over"])
    median, delay_90 = numbers["delay_median_s"], numbers["delay_90_s"]
    delay = "" if median is None else f", delay {median:.1f} s (90 % within {delay_90:.1f} s)"
    return (
        f"{numbers['found']} of {numbers['events']} events ({names}) found at a threshold of "
        f"{numbers['threshold']:g}: {100 * recall['share']:.1f} % {interval}, {alarms}{delay}"
    )


def _curve_row(counts: EventCounts) -> tuple[float | None, ...]:
    """Cells of CURVE and DELAYS at one threshold."""
    return (
        counts.threshold,
        int(counts.is_found.sum()),
        int(counts.is_found.size),
        counts.recall,
        counts.false_alarms,
        counts.false_alarms_an_hour,
        counts.delay(0.5),
        counts.delay(0.9),
    )


def _recall(
    recordings: Sequence[ScoredRecording], counts: EventCounts, kind: str
) -> dict[str, Any] | None:
    """Share of the events that are found and its interval; None without any."""
    if not counts.is_found.size:
        return None
    group = np.repeat([r.group for r in recordings], [len(r.events) for r in recordings])
    groups = Groups(group, kind)
    return {
        "share": counts.recall,
        **numbers_of_share("share", counts.is_found.astype(float), groups),
    }


def _false_alarms(
    evaluation: Evaluation, recordings: Sequence[ScoredRecording], column_s: float
) -> dict[str, Any]:
    """Number of false alarms, their rate and its interval."""
    options = evaluation.options
    number = np.array(
        [
            len(match_alarms(r, options.event_threshold, column_s, options.alarms).false)
            for r in recordings
        ]
    )
    hours = np.array([r.is_known.sum() * column_s / 3600 for r in recordings])
    groups = Groups(np.array([r.group for r in recordings]), evaluation.groups.kind)
    return {
        "count": int(number.sum()),
        "an_hour": float(number.sum() / hours.sum()),
        **numbers_of_rate("an_hour", number, hours, groups),
    }


def _count_by_class(
    evaluation: Evaluation, recordings: Sequence[ScoredRecording], counts: EventCounts
) -> dict[str, dict[str, int]]:
    """Events of each class, and those that are found."""
    names = evaluation.predictions.names
    label = np.array([event.label for r in recordings for event in r.events], int)
    return {
        name: {
            "events": int((label == names.index(name)).sum()),
            "found": int(counts.is_found[label == names.index(name)].sum()),
        }
        for name in evaluation.options.events
    }


def _show(evaluation: Evaluation, numbers: Mapping[str, Any]) -> None:
    """Add the tables of events, and the curve over the threshold where there are events."""
    header = (*CURVE, *DELAYS)
    rows = [tuple(row[key] for key in header) for row in numbers["curve"]]
    evaluation.table("events", header, rows, "Events found and false alarms, by threshold")
    rows_by_class = [(name, *of.values()) for name, of in numbers["by_class"].items()]
    title = f"Events by class, at a threshold of {numbers['threshold']:g}"
    evaluation.table("events_by_class", ("class", "events", "found"), rows_by_class, title)
    if not numbers["events"]:
        return
    recall, false = numbers["recall"], numbers["false_alarms"]
    points = [
        AlarmPoint(row["threshold"], row["recall"], row["false_alarms_an_hour"])
        for row in numbers["curve"]
    ]
    chosen = AlarmPoint(numbers["threshold"], recall["share"], false["an_hour"])
    names = ", ".join(numbers["classes"])
    title = f"{evaluation.title}: {numbers['events']} events in {numbers['hours']:.2f} h"
    png = alarms_png(points, chosen, recall["share_95"], false["an_hour_95"], title)
    caption = (
        f"Events found ({names}) over false alarms, threshold by threshold, {evaluation.title}. "
        f"An alarm is of an event if it begins from {numbers['early_s']:g} s before it to "
        f"{numbers['late_s']:g} s after its end. At low thresholds alarms go on for so long that "
        "few begin at an event."
    )
    evaluation.figure("events", caption, png)


def _list_alarms(
    evaluation: Evaluation, recordings: Sequence[ScoredRecording], column_s: float
) -> None:
    """Add a file with every event, its alarm if it has one, and every false alarm."""
    options, names = evaluation.options, evaluation.predictions.names
    rows = list[tuple[object, ...]]()
    for recording in recordings:
        alarms = match_alarms(recording, options.event_threshold, column_s, options.alarms)
        for event, start in zip(recording.events, alarms.of_events, strict=True):
            times = [round(column * column_s, 6) for column in (event.start, event.stop)]
            alarm_s = None if start is None else round(start * column_s, 6)
            delay = None if alarm_s is None else round(alarm_s - times[0], 6)
            rows.append((recording.name, names[event.label], *times, alarm_s, delay))
        for start in alarms.false:
            alarm_s = round(start * column_s, 6)
            rows.append((recording.name, "false alarm", None, None, alarm_s, None))
    evaluation.table("alarms", ALARMS, rows)
