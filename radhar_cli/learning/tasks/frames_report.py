"""One network that labels frames, on streams: frames, segments, and labels under the maps.

Windows of a stream are put together again: where they overlap, probabilities are averaged with
weights that fall towards the ends of a window, where it knows one side alone.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from sklearn.metrics import confusion_matrix

from radhar_cli.config.image import DEFAULT_COLOUR_MAP
from radhar_cli.figures.evaluation import confusion_png
from radhar_cli.figures.page import png_bytes
from radhar_cli.figures.stream_page import AT_REST, LabelledMap, draw_labelled_maps
from radhar_cli.learning.event_metrics import ScoredRecording, events_of, score_events
from radhar_cli.learning.intervals import Groups, numbers_of_share
from radhar_cli.learning.segment_metrics import LabelSpan, edit_score, f1_of_segments, spans_of
from radhar_cli.learning.tasks.events_report import report_events
from radhar_cli.learning.tasks.predictions import Predictions
from radhar_cli.learning.tasks.task import Evaluation
from radhar_cli.numerics.arrays import Float, Index, Levels

IOUS = (10, 25, 50)  # %
DRAWN = 4  # streams of the figure


@dataclass(frozen=True)
class LabelledStream:
    """A stream with true labels of its columns [W], -1 unknown, and those that were predicted."""

    name: str
    rows: list[int]  # places of its windows in the predictions
    true: Index
    probabilities: Float  # [W, classes]; 0 of columns in no window

    @property
    def predicted(self) -> Index:
        """Likeliest class of each column [W]."""
        winners: Index = self.probabilities.argmax(1)
        return winners


def report_frames(evaluation: Evaluation) -> dict[str, Any]:
    """Report the accuracy of frames, and F1 and edit score of segments without pauses and links.

    Returns:
        Plain numbers by their keys in report.json.
    """
    predictions = evaluation.predictions
    names, streams = predictions.names, join_windows(evaluation.predictions)
    true, predicted = (
        np.concatenate([getattr(s, end) for s in streams]) for end in ("true", "predicted")
    )
    # Windows of a stream are together, so that each has the number of its first one.
    group = np.concatenate(
        [np.full(s.true.size, evaluation.groups.number[s.rows[0]]) for s in streams]
    )
    is_known = true >= 0
    groups = Groups(group[is_known], evaluation.groups.kind)
    true, predicted = true[is_known], predicted[is_known]
    numbers = np.arange(len(names))
    counts = confusion_matrix(true, predicted, labels=numbers)
    accuracy = float(np.trace(counts) / max(1, counts.sum()))
    title = f"{evaluation.title}: {100 * accuracy:.2f} % of {true.size} frames"
    caption = f"Confusion matrix of frames, {evaluation.title}."
    evaluation.figure("confusion", caption, confusion_png(counts, names, title))
    _draw_streams(evaluation, predictions, streams)
    pairs = [_segments(stream, names) for stream in streams]
    segments = _segments_by_class(pairs, names)
    _show_segments(evaluation, segments)
    by_class = _numbers_by_class(counts, names)
    header = ("class", "precision", "recall", "f1", "frames")
    table = [(name, *(values[key] for key in header[1:])) for name, values in by_class.items()]
    evaluation.table("frames", header, table, "Class by class, of frames")
    occurring = [values["f1"] for values in by_class.values()]
    return {
        "images": int(predictions.rows.size),
        "streams": len(streams),
        "frames": int(true.size),
        "frame_accuracy": accuracy,
        **numbers_of_share("frame_accuracy", (true == predicted).astype(float), groups),
        "frame_macro_f1": float(np.mean(occurring)) if occurring else 0.0,
        **{f"segment_f1_{k}": f1_of_segments(pairs, k / 100) for k in IOUS},
        "edit_score": float(np.mean([edit_score(*pair) for pair in pairs])),
        "segments": sum(len(pair[0]) for pair in pairs),
        "found_segments": sum(len(pair[1]) for pair in pairs),
        "segments_by_class": segments,
        "classes": by_class,
        "confusion": counts.tolist(),
        **({"events": _report_events(evaluation, streams)} if evaluation.options.events else {}),
    }


def _report_events(evaluation: Evaluation, streams: list[LabelledStream]) -> dict[str, Any]:
    """Report the alarms of events in streams."""
    predictions, options = evaluation.predictions, evaluation.options
    labels = [predictions.names.index(name) for name in options.events]
    column_s = predictions.images.column_s
    assert column_s is not None  # of streams
    recordings = [
        ScoredRecording(
            stream.name,
            int(evaluation.groups.number[stream.rows[0]]),
            score_events(stream.probabilities, labels, column_s, options.alarms.smooth_s),
            stream.true >= 0,
            events_of(stream.true, labels),
        )
        for stream in streams
    ]
    numbers = report_events(evaluation, recordings, column_s)
    is_event = np.isin(np.arange(len(predictions.names)), labels).astype(int)
    pairs = [
        (
            spans_of(is_event[stream.true] * (stream.true >= 0), {0}),
            spans_of(is_event[stream.predicted], {0}),
        )
        for stream in streams
    ]
    return numbers | {f"segment_f1_{k}": f1_of_segments(pairs, k / 100) for k in IOUS}


def join_windows(predictions: Predictions) -> list[LabelledStream]:
    """Put the windows of each stream together."""
    samples, rows = predictions.images.samples, predictions.rows
    assert samples.frame_labels is not None
    recordings, first = samples.recordings[rows], samples.first_columns[rows]
    width, classes = predictions.values.shape[1:]
    weight = np.minimum(np.arange(width) + 1, width - np.arange(width))[:, None]
    streams = []
    for name in dict.fromkeys(recordings.tolist()):
        places = np.flatnonzero(recordings == name).tolist()
        length = int(first[places].max()) + width
        sums, true = np.zeros((length, classes)), np.full(length, -1)
        weights = np.zeros((length, 1))
        for place in places:
            columns = slice(first[place], first[place] + width)
            sums[columns] += weight * predictions.values[place]
            weights[columns] += weight
            true[columns] = samples.frame_labels[rows[place]]
        probabilities = sums / np.maximum(weights, 1)
        streams.append(LabelledStream(str(name), places, true, probabilities))
    return streams


def _segments(
    stream: LabelledStream, names: tuple[str, ...]
) -> tuple[list[LabelSpan], list[LabelSpan]]:
    """Segments of a stream that are true, and predicted, without pauses and transitions."""
    ignored = {-1, *(number for number, name in enumerate(names) if name in AT_REST)}
    return spans_of(stream.true, ignored), spans_of(stream.predicted, ignored)


def _segments_by_class(
    pairs: Sequence[tuple[list[LabelSpan], list[LabelSpan]]], names: tuple[str, ...]
) -> dict[str, dict[str, float]]:
    """Numbers and F1 of the segments of each class that has any, true or predicted."""
    numbers = {}
    for number, name in enumerate(names):
        of_class = [
            ([s for s in true if s.label == number], [s for s in found if s.label == number])
            for true, found in pairs
        ]
        true_count, found_count = (sum(len(pair[end]) for pair in of_class) for end in (0, 1))
        if true_count + found_count:
            f1 = {f"f1_{k}": f1_of_segments(of_class, k / 100) for k in IOUS}
            numbers[name] = {"segments": true_count, "found_segments": found_count, **f1}
    return numbers


def _show_segments(evaluation: Evaluation, by_class: dict[str, dict[str, float]]) -> None:
    """Add the table of the segments of each class."""
    header = ("class", "segments", "found_segments", *(f"f1_{k}" for k in IOUS))
    rows = [(name, *numbers.values()) for name, numbers in by_class.items()]
    title = "Class by class, F1 of segments at an IoU of 10, 25 and 50 %"
    evaluation.table("segments", header, rows, title)


def _numbers_by_class(counts: Index, names: tuple[str, ...]) -> dict[str, dict[str, float]]:
    """Precision, recall and F1 of frames of each class that occurs, of counts [true, predicted]."""
    numbers = {}
    for number, name in enumerate(names):
        right, true, predicted = (
            int(counts[number, number]),
            int(counts[number].sum()),
            int(counts[:, number].sum()),
        )
        if true + predicted:
            numbers[name] = {
                "precision": right / max(1, predicted),
                "recall": right / max(1, true),
                "f1": 2 * right / (true + predicted),
                "frames": true,
            }
    return numbers


def _draw_streams(
    evaluation: Evaluation, predictions: Predictions, streams: list[LabelledStream]
) -> None:
    """Add the first streams with true labels and predicted ones below."""
    images = predictions.images
    quantity, *edges = images.row_axis
    maps = [
        LabelledMap(
            stream.name,
            _pixels_of(predictions, stream),
            (0.0, stream.true.size * (images.column_s or 1.0), *edges),
            quantity,
            {"true": stream.true, "found": stream.predicted},
        )
        for stream in streams[:DRAWN]
    ]
    figure = draw_labelled_maps(maps, predictions.names, images.colours or DEFAULT_COLOUR_MAP)
    caption = f"True labels and those that were predicted, {evaluation.title}."
    evaluation.figure("streams", caption, png_bytes(figure))


def _pixels_of(predictions: Predictions, stream: LabelledStream) -> Levels:
    """Pixels [H, W, 3], or [H, W] of gray ones, of a stream, from its windows."""
    images, rows = predictions.images, predictions.rows
    first = images.samples.first_columns
    pixels = np.zeros((images.size[0], stream.true.size, images.channels), np.uint8)
    for place in stream.rows:
        start = first[rows[place]]
        pixels[:, start : start + images.size[1]] = images.pixels.read(int(rows[place]))
    return pixels[..., 0] if images.channels == 1 else pixels
