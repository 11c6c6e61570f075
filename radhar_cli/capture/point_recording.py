"""The file of a recording of points of a board, frame by frame (docs/guide/points.md)."""

import json
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from radhar_cli import __version__
from radhar_cli.capture.recording import KIND_OF_POINTS, Label, SourceNote, is_of_kind
from radhar_cli.errors import CaptureError, FolderError, UnfinishedError, describe_schema
from radhar_cli.files.new_hdf5 import new_hdf5
from radhar_cli.files.replacing import replacing
from radhar_cli.files.untrusted import Closing
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.processing.points import COLUMNS, Cloud
from radhar_cli.readers.points.point_frames import NO_TRACK, TARGET_COLUMNS, PointFrame
from radhar_cli.readers.untrusted_hdf5 import UntrustedFile

SCHEMA_VERSION = 1
CHUNK = 8192  # rows
NOBODY = -1
LONGEST_GAP = 100_000  # frames; a larger step of the numbers is a board that began again
MAX_FRAMES = 10**6  # of a window
LONGEST_CFG = 2**15  # characters that are kept

Whole = Annotated[int, Field(ge=0, le=2**40)]


class PointRecordingInfo(BaseModel):
    """Description of a recording of points, as its file has it in the attribute `recording`."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)

    frame_s: Annotated[float, Field(ge=1e-5, le=1e6)]  # time from frame to frame
    frames: Annotated[int, Field(ge=1, le=2**31)]  # that were received
    points: Whole
    lost_frames: Whole = 0  # numbers that are missing between those received
    targets: Whole = 0
    demo: Annotated[str, Field(max_length=1000)] = ""  # what sent it, in words
    cfg: Annotated[str, Field(max_length=LONGEST_CFG)] = ""  # of the board; "" where it is unknown
    labels: Annotated[list[Label], Field(max_length=10_000)] = []
    source: SourceNote


@dataclass
class FrameClock:
    """Numbers and times of frames, as they come.

    Attributes:
        frame_s: Time from frame to frame, s.
        numbers: Numbers as the board counts.
        places: Numbers counted on where the board began again, from 0.
        restarts: Number of times that it began again.
        repeated: Number of frames that came twice, of which the first stays.
    """

    frame_s: float
    numbers: list[int] = field(default_factory=list)
    places: list[int] = field(default_factory=list)
    restarts: int = 0
    repeated: int = 0

    def takes(self, number: int) -> bool:
        """Whether the next frame has another number than the one before; it is counted then."""
        step = 1 if not self.numbers else number - self.numbers[-1]
        if step == 0:
            self.repeated += 1
            return False
        if not 0 < step <= LONGEST_GAP:
            self.restarts += 1
            step = 1
        self.numbers.append(number)
        self.places.append(self.places[-1] + step if self.places else 0)
        return True

    @property
    def lost(self) -> int:
        """Number of frames that are missing in between."""
        return self.places[-1] + 1 - len(self.places) if self.places else 0

    def findings(self) -> list[str]:
        """List the lost, repeated and restarted frame numbers, a sentence for each."""
        sentences = []
        if self.lost:
            total = self.places[-1] + 1
            sentences.append(f"{self.lost} of {total} frames are lost: their numbers are missing")
        if self.repeated:
            sentences.append(f"{self.repeated} frames came twice, and the first is kept")
        if self.restarts:
            sentences.append(f"frame numbers begin again {self.restarts} times; time goes on")
        return sentences


def write_point_recording(
    path: Path,
    frames: Iterable[PointFrame],
    draft: "PointRecordingDraft",
    exclusive: bool = False,
) -> PointRecordingInfo:
    """Write a recording of points under another name, then rename it into place.

    Args:
        path: file to write.
        frames: its frames, which are read one after the other.
        draft: facts of it beside its frames.
        exclusive: leave a file alone that another process made meanwhile.

    Returns:
        Description of the recording.

    Raises:
        CaptureError: there is no frame.
        FolderError: another process made the file meanwhile.
        UnfinishedError: it cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with (
            replacing(path, exclusive=exclusive) as unfinished,
            new_hdf5(unfinished, path) as (file, check),
        ):
            clock = FrameClock(draft.frame_s)
            points, targets = _write_frames(file, frames, clock, check)
            if not clock.numbers:
                raise CaptureError(draft.nothing)
            info = draft.info(clock, points, targets)
            _write_columns(file, clock, info)
    except FileExistsError:
        raise FolderError(
            f"{path}: was written by another process meanwhile; --overwrite replaces it"
        ) from None
    except OSError as error:
        raise UnfinishedError(
            f"{error.filename or path}: {error.strerror or error}; nothing was written"
        ) from None
    return info


@dataclass(frozen=True)
class PointRecordingDraft:
    """Facts of a recording that do not come from its frames.

    Attributes:
        frame_s: Time from frame to frame, s.
        nothing: Message where there is no frame.
        demo: Firmware that sent it, in words.
        cfg: Lines of the board's .cfg; "" where it is unknown.
        labels: Labels of the recording.
        source: Format and files.
        findings: Lists further findings, once all frames are read.
    """

    frame_s: float
    nothing: str
    demo: str
    cfg: str
    labels: Sequence[Label]
    source: SourceNote
    findings: Callable[[], Sequence[str]]

    def info(self, clock: FrameClock, points: int, targets: int) -> PointRecordingInfo:
        """Describe the recording of the frames of a clock."""
        sentences = [*self.source.findings, *clock.findings(), *self.findings()]
        return PointRecordingInfo(
            frame_s=self.frame_s,
            frames=len(clock.numbers),
            points=points,
            lost_frames=clock.lost,
            targets=targets,
            demo=self.demo,
            cfg=self.cfg,
            labels=[*self.labels],
            source=self.source.model_copy(update={"findings": sentences}),
        )


def _write_frames(
    file: Any, frames: Iterable[PointFrame], clock: FrameClock, check: Callable[[], None]
) -> tuple[int, int]:
    """Write points and targets of frames; return how many there are of each."""
    rows = {
        "points": _new_rows(file, "points", "<f4", len(COLUMNS)),
        "targets": _new_rows(file, "targets", "<f4", len(TARGET_COLUMNS)),
        "points_track": _new_rows(file, "points_track", "<i2"),
    }
    starts = {"points": [0], "targets": [0]}
    joints = list[Float | None]()
    waiting: dict[str, list[NDArray[Any]]] = {name: [] for name in rows}

    def flush() -> None:
        for name, blocks in waiting.items():
            if blocks:
                values = np.concatenate(blocks)
                first = rows[name].shape[0]
                rows[name].resize(first + len(values), axis=0)
                rows[name][first:] = values
                blocks.clear()
        check()

    for frame in frames:
        if not clock.takes(frame.number):
            continue
        columns = {"points": frame.points, "targets": frame.targets, "points_track": frame.track}
        for name, values in columns.items():
            waiting[name].append(np.asarray(values, rows[name].dtype))
        for name, start in starts.items():
            start.append(start[-1] + len(columns[name]))
        joints.append(frame.joints)
        if len(waiting["points"]) >= 1024:
            flush()
    flush()
    file["points_start"] = np.array(starts["points"], "<i8")
    file["targets_start"] = np.array(starts["targets"], "<i8")
    if any(places is not None for places in joints):
        nowhere = np.full((len(JOINTS), 3), np.nan)
        known = [nowhere if places is None else places for places in joints]
        file["joints"] = np.array(known, "<f4")
        file["joints"].attrs["names"] = JOINTS
        file.attrs["joints"] = len(JOINTS)
    return starts["points"][-1], starts["targets"][-1]


def _new_rows(file: Any, name: str, kind: str, columns: int | None = None) -> Any:
    """Make an empty dataset of rows that grows."""
    inner = () if columns is None else (columns,)
    return file.create_dataset(
        name, (0, *inner), kind, maxshape=(None, *inner), chunks=(CHUNK, *inner), compression="gzip"
    )


def _write_columns(file: Any, clock: FrameClock, info: PointRecordingInfo) -> None:
    """Write numbers and times of the frames, whose a point is, and the attributes."""
    person = _new_rows(file, "points_person", "<i2")
    person.resize(info.points, axis=0)
    for first in range(0, info.points, 2**20):
        person[first : first + 2**20] = NOBODY
    file["frame_number"] = np.array(clock.numbers, "<i8")
    file["frame_time"] = np.array(clock.places) * clock.frame_s
    file["frame_time"].attrs["unit"] = "s"
    file["points"].attrs["columns"] = COLUMNS
    file["points"].attrs["axes"] = "x ahead, y left, z up (m), Doppler approaching positive (m/s)"
    file["targets"].attrs["columns"] = TARGET_COLUMNS
    file["points_track"].attrs["meaning"] = f"number of the track of a point; {NO_TRACK} none"
    file["points_person"].attrs["meaning"] = f"whose a point is; {NOBODY} unknown"
    file.attrs["kind"] = KIND_OF_POINTS
    file.attrs["schema_version"] = SCHEMA_VERSION
    file.attrs["recording"] = json.dumps(info.model_dump(by_alias=True))
    file.attrs["radhar_version"] = __version__


def is_point_recording(path: Path) -> bool:
    """Whether a file describes itself as a recording of points."""
    return is_of_kind(path, KIND_OF_POINTS)


class PointRecording(Closing):
    """A recording of points opened for reading; it is not trusted.

    Attributes:
        info: description of the recording.
        start: number of the first point of each frame, and of all points [frames + 1].
        number: number of each frame, as the board counts [frames].
        time: time of each frame since the first, s [frames].
        joints: places of the thirteen joints in each frame [frames, 13, 3], m; NaN where nothing
            saw them. None of a recording without joints.

    Raises:
        FolderError: the file is no recording of points, or is damaged.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file = UntrustedFile(path)
        try:
            self.info = self._read_info()
            frames, total = self.info.frames, self.info.points
            self.start: Index = self._file.column("points_start", "i8", (frames + 1,))[:]
            self.number: Index = self._file.column("frame_number", "i8", (frames,))[:]
            self.time: Float = self._file.column("frame_time", "f8", (frames,))[:]
            self._points = self._file.samples("points", may_be_empty=True)
            self.joints: Float | None = None
            if self._file.has_attribute("joints"):
                shape = (frames, len(JOINTS), 3)
                self.joints = self._file.column("joints", "<f4", shape)[:]
            ordered = (np.diff(self.start) >= 0).all() and (np.diff(self.time) > 0).all()
            ends = self.start[0] == 0 and self.start[-1] == total
            if not (ordered and ends and np.isfinite(self.time).all()):
                raise FolderError(f"{path}: /points_start: frames should be in order")
            if self._points.shape != (total, len(COLUMNS)) or self._points.parts != 1:
                raise FolderError(
                    f"{path}: /points: has the shape {self._points.shape}; should be "
                    f"({total}, {len(COLUMNS)})"
                )
        except BaseException:
            self._file.close()
            raise

    def _read_info(self) -> PointRecordingInfo:
        """Read and check the description."""
        if not self._file.has_attribute("kind") or self._file.text("kind") != KIND_OF_POINTS:
            raise FolderError(
                f"{self.path}: is no recording of points; `radhar import` makes one of a dump of "
                "a board's data port"
            )
        version = self._file.whole_number("schema_version")
        if version != SCHEMA_VERSION:
            raise FolderError(f"{self.path}: {describe_schema(version, SCHEMA_VERSION)}")
        try:
            return PointRecordingInfo.model_validate(self._file.json("recording"))
        except ValidationError as error:
            first = error.errors(include_url=False)[0]
            key = ".".join(map(str, first["loc"]))
            raise FolderError(f"{self.path}: attribute recording: {key}: {first['msg']}") from None

    @property
    def duration(self) -> float:
        """Duration from the first frame to the end of the last, s."""
        return float(self.time[-1]) + self.info.frame_s

    def window(self, start: float, seconds: float) -> Cloud:
        """Points of the frames of a window; frames that are lost are there, without points.

        Args:
            start: begin of the window since the first frame, s.
            seconds: its length, s.

        Raises:
            CaptureError: points hold infinite numbers, or the window too many frames.
        """
        inside, places, count = self._frames_within(start, seconds)
        low, high = inside.start, inside.stop
        counts = np.zeros(count, np.int64)
        counts[places] = np.diff(self.start[low : high + 1])
        rows = slice(int(self.start[low]), int(self.start[high]))
        points = np.empty((0, len(COLUMNS)), np.float32)
        if rows.stop > rows.start:
            read = self._points.read((rows, slice(0, len(COLUMNS))))
            points = read[..., 0].astype(np.float32)
        if np.isinf(points).any():
            raise CaptureError(f"{self.path}: /points: holds infinite numbers")
        return Cloud(points, np.concatenate([[0], np.cumsum(counts)]).astype(np.int64))

    def joints_within(self, start: float, seconds: float) -> Float:
        """Joints [frames, 1, 13, 3] of the frames of a `window`, m; NaN in those that are lost."""
        inside, places, count = self._frames_within(start, seconds)
        joints = np.full((count, 1, len(JOINTS), 3), np.nan, np.float32)
        if self.joints is not None:
            joints[places, 0] = self.joints[inside]
        return joints

    def _frames_within(self, start: float, seconds: float) -> tuple[slice, Index, int]:
        """Received frames of a window, the place of each in it [n], and its number of frames."""
        frame_s = self.info.frame_s
        first, count = round(start / frame_s), max(round(seconds / frame_s), 1)
        if count > MAX_FRAMES:
            raise CaptureError(
                f"{self.path}: {seconds:g} s are {count} frames; should be at most {MAX_FRAMES}"
            )
        places = np.round(self.time / frame_s).astype(np.int64)
        low, high = np.searchsorted(places, [first, first + count]).tolist()
        return slice(low, high), places[low:high] - first, count

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def summarise_point_recording(path: Path) -> dict[str, Any]:
    """Summarise a recording of points, as plain values, for `radhar inspect`.

    Raises:
        FolderError: the file is none, or is damaged.
    """
    with PointRecording(path) as recording:
        counts = np.diff(recording.start)
        document = recording.info.model_dump(by_alias=True)
        has_cfg = bool(document.pop("cfg"))
        return {
            "kind": "recording of points",
            "path": str(path),
            "bytes": path.stat().st_size,
            **document,
            "has_cfg": has_cfg,
            "duration_s": recording.duration,
            "first_frame": int(recording.number[0]),
            "last_frame": int(recording.number[-1]),
            "points_a_frame": {
                "mean": float(counts.mean()),
                "min": int(counts.min()),
                "max": int(counts.max()),
            },
        }
