"""Recordings of points, made of the rows that published sets hold frame by frame."""

import io
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from radhar_cli.capture.point_recording import PointRecordingDraft, write_point_recording
from radhar_cli.capture.recording import Label, SourceNote
from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import bytes_of
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.processing.points import COLUMNS
from radhar_cli.readers.points.point_frames import (
    NO_TRACK,
    PointFrame,
    are_measurements,
    in_radhar_axes,
    no_targets,
)

MAX_TABLE = 2**28  # bytes of a file
LONGEST_CLIP = 100_000  # frames


@dataclass(frozen=True)
class CloudClip:
    """Frames of one person and one activity.

    Attributes:
        label: Name of the activity.
        person: Name of the person; None if it is not known.
        points: Points [n, 8] of all frames, columns as COLUMNS.
        frame: Frame of each point [n], from 0, in order.
        length: Number of frames, those among them that are empty or lost.
        received: Frames that came [f], with points or without; None for those with points.
        joints: Joints [f, 13, 3] of the frames that came, m; None without any.
        first_number: Number of the first frame, as the file counts.
    """

    label: str
    person: str | None
    points: Float
    frame: Index
    length: int
    received: Index | None = None
    joints: Float | None = None
    first_number: int = 0

    def check(self, names: str) -> None:
        """Refuse a clip that is too long, or numbers that are no measurements.

        Raises:
            CaptureError: Says which; `names` are those of the files.
        """
        if not 0 < self.length <= LONGEST_CLIP:
            raise CaptureError(
                f"{names}: {self.label} has {self.length} frames; should have 1 to {LONGEST_CLIP}"
            )
        if not are_measurements(self.points):
            raise CaptureError(f"{names}: holds numbers that are no m, m/s or dB")

    def frames(self, first: int) -> Iterator[PointFrame]:
        """Yield the frames that came, numbered from `first`, and an empty one at the very end."""
        came = np.unique(self.frame) if self.received is None else self.received
        ends = np.searchsorted(self.frame, [came, came + 1])
        for place, (number, low, high) in enumerate(zip(came, *ends, strict=True)):
            joints = None if self.joints is None else self.joints[place]
            yield _frame_of(first + int(number), self.points[low:high], joints)
        if not len(came) or came[-1] < self.length - 1:
            yield _frame_of(first + self.length - 1, self.points[:0])


def _frame_of(number: int, points: Float, joints: Float | None = None) -> PointFrame:
    """Frame of points [n, 8] without tracks."""
    track = np.full(len(points), float(NO_TRACK))
    return PointFrame(number, points, track, no_targets(), joints=joints)


def write_clips(
    out: Path,
    clips: Iterable[CloudClip],
    frame_s: float,
    sources: Sequence[Path],
    findings: Sequence[str] = (),
) -> None:
    """Write clips, one after the other without a pause, as a recording of points with labels.

    Args:
        out: Recording to write.
        frame_s: Time from frame to frame, s.
        sources: Files that they were read from.
        findings: Damage and losses, in words.

    Raises:
        CaptureError: there is nothing, or numbers are no measurements.
    """
    listed, labels, first = [*clips], list[Label](), 0
    names = ", ".join(path.name for path in sources[:3])
    for clip in listed:
        clip.check(names)
        stop = first + clip.length
        times = {"start_s": round(first * frame_s, 9), "stop_s": round(stop * frame_s, 9)}
        labels.append(Label(label=clip.label, person=clip.person, **times))
        first = stop

    def frames() -> Iterator[PointFrame]:
        number = 0
        for clip in listed:
            yield from clip.frames(number)
            number += clip.length

    note = SourceNote(format="points", files=[path.name for path in sources[:1000]])
    nothing = f"{names}: holds no points"
    draft = PointRecordingDraft(frame_s, nothing, "", "", labels, note, lambda: findings)
    write_point_recording(out, frames(), draft)


def points_of(
    places: Float,
    receding: Float,
    intensity: Float | None = None,
    snr_db: Float | None = None,
) -> Float:
    """Points [n, 8] of COLUMNS; NaN in those that the set does not have.

    Args:
        places: Places [n, 3] ahead, left and up of the radar, m.
        receding: Speeds [n] away from the radar, m/s.
        intensity: Magnitudes [n], in whatever unit the set has.
        snr_db: Powers over the noise [n], dB.
    """
    points = np.full((len(places), len(COLUMNS)), np.nan)
    points[:, :3], points[:, 3] = places, -receding
    if intensity is not None:
        points[:, 4] = intensity
    if snr_db is not None:
        points[:, 5] = snr_db
    return points + 0.0  # never -0


def points_of_ti(rows: Float) -> Float:
    """Points [n, 8] of rows x (right), y (ahead), z (up), Doppler (receding), intensity [n, 5]."""
    return points_of(in_radhar_axes(rows[:, :3]), rows[:, 3], rows[:, 4])


def read_table(path: Path, columns: int) -> tuple[Float, int]:
    """Read the rows [n, columns] of a CSV file with one line of names.

    A last line without its end is left out, and so are further columns.

    Returns:
        The rows, and 1 if a line was left out, else 0.

    Raises:
        CaptureError: a line does not have as many numbers.
    """
    text = bytes_of(path, MAX_TABLE, CaptureError)
    lines, _, cut = text.rpartition(b"\n")
    if cut.strip() and cut.count(b",") + 1 >= columns:  # a last line without an end of line
        lines, cut = text, b""
    _, _, body = lines.partition(b"\n")
    if not body.strip():
        return np.empty((0, columns)), int(bool(cut.strip()))
    try:
        rows = np.loadtxt(
            io.StringIO(body.decode("ascii")),
            delimiter=",",
            ndmin=2,
            usecols=range(columns),
            comments=None,
        )
    except (ValueError, UnicodeDecodeError) as error:
        reason = str(error).partition(";")[0]
        raise CaptureError(f"{path}: {reason}; should be lines of {columns} numbers") from None
    return rows, int(bool(cut.strip()))


def frames_in_order(frame: Float) -> Index:
    """Number of each row's frame [n] by the order of appearance, from 0."""
    if not len(frame):
        return np.empty(0, np.intp)
    return np.concatenate([[0], np.cumsum(np.diff(frame) != 0)]).astype(np.intp)
