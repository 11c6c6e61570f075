"""What people of a stream do from when to when, and the label of each column of an image."""

from collections.abc import Sequence

import numpy as np

from radhar_cli.config.data_set import Config
from radhar_cli.config.stream import frame_classes
from radhar_cli.motion.protocol import Motion
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.scene.assembly.streams import segments_of
from radhar_cli.scene.scene import Scene

SEGMENT_COLUMNS = ("start_s", "stop_s", "label", "person")
NOBODY = -1  # label where a person is not there, or of no stream


def label_names(config: Config) -> tuple[str, ...]:
    """Names of the labels of a stream's segments and frames."""
    return frame_classes(config.stream_activities)


def make_segments(scene: Scene, motions: tuple[Motion, ...]) -> Float:
    """Segments [n, 4] of everybody: start and stop (s), label, and number of the person.

    Args:
        scene: the scene.
        motions: motions of its people, the sample's own person first.
    """
    names = label_names(scene.config)
    rows = [
        (segment.start, segment.stop, names.index(segment.label), person.number)
        for person, motion in zip(scene.people, motions, strict=False)
        if hasattr(motion, "labels")
        for segment in segments_of(motion, scene.seconds, names)  # type: ignore[arg-type]
    ]
    return np.array(rows, float).reshape(-1, len(SEGMENT_COLUMNS))


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
