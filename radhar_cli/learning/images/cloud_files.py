"""Point clouds of files that are no data set, cut into sequences of a network's length."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli.capture.importing_points import is_point_capture
from radhar_cli.capture.point_recording import PointRecording, is_point_recording
from radhar_cli.capture.recipes.clouds import CloudClip
from radhar_cli.capture.recipes.points import PointTableSettings, read_clips
from radhar_cli.config.reading import Overrides, load_section
from radhar_cli.errors import CaptureError, ConfigError
from radhar_cli.learning.images.sequences import cloud_frames, fit_length
from radhar_cli.numerics.arrays import Float, Index

TABLES = (".csv", ".tsv", ".txt", ".npz")


@dataclass(frozen=True)
class CloudClipFrames:
    """Clouds of frames that follow each other: points [n, 8], and the first of each frame."""

    points: Float
    start: Index  # [frames + 1]
    first_number: int  # of the first frame, as the file counts


@dataclass(frozen=True)
class CloudFilePixels:
    """Sequences of `frames` frames of clips, one after the other; the last is filled up."""

    clips: tuple[CloudClipFrames, ...]
    places: tuple[tuple[int, int], ...]  # [N] clip and first frame in it of each sequence
    frames: int
    points: int  # number of points of a cloud

    def read(self, row: int) -> NDArray[Any]:
        """Clouds float32 [T, points, 6] of a sequence."""
        number, first = self.places[row]
        clip = self.clips[number]
        start = clip.start[first : first + self.frames + 1]
        return fit_length(cloud_frames(clip.points, start, self.points), self.frames, 0)

    def span(self, row: int) -> tuple[int, int]:
        """Number of the first frame of a sequence in its file, and the number of frames read."""
        number, first = self.places[row]
        clip = self.clips[number]
        return clip.first_number + first, min(self.frames, len(clip.start) - 1 - first)


def is_cloud_file(path: Path) -> bool:
    """Whether a path is a table of points, or a recording of points."""
    if not path.is_file():
        return False
    return path.suffix.lower() in TABLES or is_point_recording(path)


def open_cloud_file(path: Path, size: tuple[int, int], settings: Overrides = ()) -> CloudFilePixels:
    """Open a table of points, or a recording of points, as sequences.

    Args:
        path: the file.
        size: (frames, points) of a sequence.
        settings: of `PointTableSettings`, such as axes=[right,ahead,up].

    Raises:
        RadharError: the file cannot be used, or does not say which way its axes point.
    """
    if is_point_recording(path):
        if settings:
            raise ConfigError(f"{path}: says its axes itself; --set should be left out")
        clips = [_clip_of_recording(path)]
    elif is_point_capture(path):
        raise CaptureError(f"{path}: is a dump of a board; radhar import {path} -o points.h5 first")
    else:
        table_settings = load_section(PointTableSettings, None, settings)
        clips = [_frames_of_clip(path, clip) for clip in read_clips(path, table_settings)]
    places = [
        (number, first)
        for number, clip in enumerate(clips)
        for first in range(0, len(clip.start) - 1, size[0])
    ]
    return CloudFilePixels(tuple(clips), tuple(places), *size)


def _frames_of_clip(path: Path, clip: CloudClip) -> CloudClipFrames:
    """Frames of a clip of a table, those that are empty among them."""
    clip.check(str(path))
    start = np.searchsorted(clip.frame, np.arange(clip.length + 1))
    return CloudClipFrames(clip.points, start, clip.first_number)


def _clip_of_recording(path: Path) -> CloudClipFrames:
    """Clouds of a whole recording, frames that are lost among them."""
    with PointRecording(path) as recording:
        cloud = recording.window(0, recording.duration)
        return CloudClipFrames(cloud.points, cloud.start, int(recording.number[0]))
