"""Activities of people of a stream over time, and the label of each column of an image."""

from collections.abc import Sequence
from math import inf
from typing import NamedTuple

import numpy as np

from radhar_cli.config.data_set import Config
from radhar_cli.config.stream import frame_classes, label_of_pause
from radhar_cli.motion.human.part import kind_of_rest
from radhar_cli.motion.protocol import Motion
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.scene.scene import Scene
from radhar_cli.scene.streams import StreamMotion

SEGMENT_COLUMNS = ("start_s", "stop_s", "label", "person")
SEGMENT_UNITS = ("s", "s", "1", "1")
NOBODY = -1  # label where a person is not there, or of no stream


def label_names(config: Config) -> tuple[str, ...]:
    """Names of the labels of a stream's segments and frames."""
    return frame_classes(config.stream_activities)


def make_segments(scene: Scene, motions: tuple[Motion, ...]) -> Float:
    """Segments [n, 4] of everybody: start and stop (s), label, and number of the person."""
    names = label_names(scene.config)
    rows = [
        (segment.start, segment.stop, names.index(segment.label), person.number)
        for person, motion in zip(scene.people, motions, strict=False)
        if hasattr(motion, "labels")  # one that is cached is no StreamMotion
        for segment in segments_of(motion, scene.seconds, names)  # type: ignore[arg-type]
    ]
    return np.array(rows, float).reshape(-1, len(SEGMENT_COLUMNS))


class LabelledSegment(NamedTuple):
    """Activity of a person from one time to another."""

    start: float  # s
    stop: float  # s
    label: str  # class, PAUSE or TRANSITION


def segments_of(
    motion: StreamMotion, seconds: float, classes: Sequence[str]
) -> list[LabelledSegment]:
    """List the activities of a person of a stream in a recording, without gaps.

    Args:
        seconds: duration of the recording, s.
        classes: names of the labels; that of keeping still stands for pauses, if it is there.
    """
    parts = [part for part, _ in motion.parts]
    segments = [
        LabelledSegment(
            -inf, parts[0].begin, label_of_pause(kind_of_rest(parts[0].before), classes)
        )
    ]
    ends = [part.begin for part in parts[1:]] + [inf]
    for part, label, end in zip(parts, motion.labels, ends, strict=False):
        segments.append(LabelledSegment(part.begin, part.end, label))
        segments.append(
            LabelledSegment(part.end, end, label_of_pause(kind_of_rest(part.after), classes))
        )
    joined = list[LabelledSegment]()
    for segment in segments:
        start, stop = max(0.0, segment.start), min(seconds, segment.stop)
        if start >= stop:
            continue
        if joined and joined[-1].label == segment.label:
            joined[-1] = joined[-1]._replace(stop=stop)
        else:
            joined.append(LabelledSegment(start, stop, segment.label))
    return joined


def label_frames(segments: Float, people: int, t: Float) -> Index:
    """Labels [person, M] at times t [M] (s), NOBODY where nothing is known of a person.

    Args:
        segments: segments [n, 4] of everybody.
        people: number of persons.
        t: times, s.
    """
    labels = np.full((people, t.size), NOBODY)
    for start, stop, label, person in segments:
        labels[int(person), (t >= start) & (t < stop)] = int(label)
    return labels


def column_times(extent: Sequence[float], width: int) -> Float:
    """Times of the middles of the columns of an image over time [width], s."""
    left, right = extent[:2]
    times: Float = left + (np.arange(width) + 0.5) * (right - left) / width
    return times
