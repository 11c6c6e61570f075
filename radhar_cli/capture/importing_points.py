"""A dump of the data port of TI's demos, or a replay file, becomes a recording of points."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import islice
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import Field

from radhar_cli.capture.point_recording import (
    LONGEST_CFG,
    PointRecordingDraft,
    PointRecordingInfo,
    write_point_recording,
)
from radhar_cli.capture.recording import Label, SourceNote
from radhar_cli.config.documents import read_document
from radhar_cli.config.reading import validated, with_overrides
from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import regular_size, text_of
from radhar_cli.radar.frame_timing import FrameTiming
from radhar_cli.readers.captures.settings import Above, Text
from radhar_cli.readers.points.point_frames import PointFrame, RadarSteps, tracks_of
from radhar_cli.readers.points.point_messages import (
    DETECTED_POINTS,
    MessageError,
    MessageReader,
    is_q_format,
)
from radhar_cli.readers.points.uart_packets import PROBED, Dump, Packet, is_dump, open_dump
from radhar_cli.readers.points.visualizer_json import Replay, is_replay, read_replay
from radhar_cli.readers.ti.ti_cfg import MAX_CFG, parse_frames, parse_ti_cfg
from radhar_cli.schema.section import Section

SEARCHED = 2**16  # bytes in which the first magic word of a dump lies
RATIOS = ("people", "3d tracking", "vital")  # words of demos whose SNR is a ratio of powers


class PointSettings(Section):
    """Facts that a dump of points does not state; None is unknown."""

    frame_s: Annotated[Above, Field(ge=1e-5, le=1e6)] | None = None  # from frame to frame
    doppler_step_mps: Above | None = None  # of a bin of Doppler, of SDK 1 and 2
    range_step_m: Above | None = None  # of a range bin
    subframe: Annotated[int, Field(ge=0, le=3, strict=True)] = 0  # whose points are read
    label: Text | None = None  # of the whole recording, as the person
    person: Text | None = None


@dataclass(frozen=True)
class PointHeader:
    """The header of a recording of points: settings, and the board's .cfg where it is known.

    Attributes:
        settings: Settings, from a file and from the command line.
        cfg: Lines of the .cfg; "" without one.
        where: File of the .cfg, for messages.
    """

    settings: PointSettings
    cfg: str = ""
    where: str = "--set"

    def with_cfg(self, cfg: str, where: str) -> "PointHeader":
        """This header, with the .cfg that a capture holds itself where no other was named."""
        return self if self.cfg or not cfg else PointHeader(self.settings, cfg, where)

    @property
    def steps(self) -> RadarSteps:
        """Steps of the board, as far as they are known."""
        s, steps = self.settings, RadarSteps()
        if self.cfg:
            steps = RadarSteps.of_frames(*_parse_cfg(self.cfg, self.where, s.subframe))
        range_m, speed_mps = s.range_step_m or steps.range_m, s.doppler_step_mps or steps.speed_mps
        return RadarSteps(range_m, speed_mps, steps.bias_m)

    @property
    def frame_s(self) -> float | None:
        """Time from frame to frame, s; None where it is unknown."""
        if self.settings.frame_s is not None or not self.cfg:
            return self.settings.frame_s
        return _parse_cfg(self.cfg, self.where, self.settings.subframe)[0].period_s


def is_point_capture(path: Path) -> bool:
    """Whether a file is a dump with the magic word of TI's demos, or a replay file."""
    try:
        regular_size(path)
        with path.open("rb") as file:
            head = file.read(SEARCHED)
    except OSError:
        return False
    return is_dump(head) or is_replay(path, head)


def read_point_header(header: Path | None, overrides: Sequence[str]) -> PointHeader:
    """Read the header of a recording of points.

    Args:
        header: TI's .cfg, or YAML of the keys of `PointSettings`; None for overrides alone.
        overrides: KEY=VALUE of each.

    Raises:
        RadharError: the header or an override cannot be used.
    """
    document: dict[str, Any] = {}
    cfg, where = "", "--set" if header is None else str(header)
    if header is not None and header.suffix.lower() == ".cfg":
        cfg = text_of(header, MAX_CFG, CaptureError)
    elif header is not None:
        document = read_document(header)[0]
    settings = validated(PointSettings, with_overrides(document, overrides), where, {})
    return PointHeader(settings, cfg, where)


def import_points(
    paths: Sequence[Path], out: Path, header: PointHeader, overwrite: bool = True
) -> PointRecordingInfo:
    """Read a dump or replay files and write a recording of points; findings are in its source.

    Args:
        paths: its files, in order.
        out: recording to write.
        header: facts of the board.
        overwrite: replace an existing recording.

    Raises:
        CaptureError: the capture is damaged, or what is missing; names all keys at once.
        FolderError: another process wrote the recording meanwhile.
        UnfinishedError: it cannot be written.
    """
    for path in paths:
        try:
            regular_size(path)
        except OSError as error:
            raise CaptureError(f"{path}: {error.strerror}") from None
    with paths[0].open("rb") as file:
        head = file.read(SEARCHED)
    if is_dump(head):
        return _import_dump(paths, out, header, overwrite)
    return _import_replay(paths, out, header, overwrite)


def _import_dump(
    paths: Sequence[Path], out: Path, header: PointHeader, overwrite: bool
) -> PointRecordingInfo:
    """Import a dump of the data port."""
    dump = open_dump(paths)
    layout = dump.framing.layout
    steps, frame_s = header.steps, header.frame_s
    missing = {} if frame_s is not None else {"frame_s": "0.1"}
    if steps.speed_mps is None and _has_doppler_bins(dump):
        missing["doppler_step_mps"] = "0.13"
    if missing or frame_s is None:
        raise CaptureError(_missing_text(paths, missing))
    reader = MessageReader(layout.is_people_counting, steps)
    frames = DumpFrames(dump, reader, header.settings.subframe)
    demo = f"header of {layout.size} bytes ({layout.name})"
    draft = _draft_of(paths, header, frame_s, demo, frames.findings)
    return write_point_recording(out, frames, draft, not overwrite)


def _import_replay(
    paths: Sequence[Path], out: Path, header: PointHeader, overwrite: bool
) -> PointRecordingInfo:
    """Import replay files of the visualizer."""
    replay = read_replay(paths)
    header = header.with_cfg(replay.cfg, f"{paths[0]}: cfg")
    frame_s, notes = header.frame_s, list[str]()
    if frame_s is None:
        frame_s = _period_of(replay)
        if frame_s is None:
            raise CaptureError(_missing_text(paths, {"frame_s": "0.1"}))
        notes.append(f"no .cfg: time stamps say that frames are {frame_s:.4g} s apart")
    is_ratio = any(word in replay.demo.lower() for word in RATIOS)
    unit = "ratios of powers" if is_ratio else "decibels"
    notes.append(f"SNRs are taken for {unit}, as of {replay.demo or 'an out-of-box demo'}")
    draft = _draft_of(paths, header, frame_s, replay.demo[:1000], lambda: notes)
    frames = replay.frames(header.steps, is_ratio)
    return write_point_recording(out, frames, draft, not overwrite)


def _draft_of(
    paths: Sequence[Path],
    header: PointHeader,
    frame_s: float,
    demo: str,
    findings: Callable[[], Sequence[str]],
) -> PointRecordingDraft:
    """Make the draft of a recording, before its frames are read."""
    s = header.settings
    source = SourceNote(format="points", files=[path.name for path in paths[:1000]])
    labels = [] if s.label is None else [Label(label=s.label, person=s.person)]
    nothing = f"{paths[0]}: holds no frame that could be read"
    cfg = _essential_lines(header.cfg)
    return PointRecordingDraft(frame_s, nothing, demo, cfg, labels, source, findings)


def _essential_lines(cfg: str) -> str:
    """Lines of a .cfg without comments; "" of one that is too long to keep."""
    lines = (line.partition("%")[0].strip() for line in cfg.splitlines())
    text = "".join(f"{line}\n" for line in lines if line)
    return text if len(text) <= LONGEST_CFG else ""


def _parse_cfg(cfg: str, where: str, subframe: int) -> tuple[FrameTiming, float]:
    """Chirps and frames of a .cfg, and the bias of ranges, m.

    Raises:
        CaptureError: a line on chirps or frames cannot be read.
    """
    try:
        header = parse_ti_cfg(cfg, where, subframe=subframe)
    except CaptureError:  # such as DDMA, whose points are sent as others are
        timings, _ = parse_frames(cfg, where)
        return timings[min(subframe, len(timings) - 1)], 0.0
    return header.timing, header.detection.bias


def _has_doppler_bins(dump: Dump) -> bool:
    """Whether the first points of a dump are those of SDK 1 or 2, with bins of Doppler."""
    if dump.framing.layout.is_people_counting:
        return False
    for packet in islice(dump.packets(), PROBED):
        message = packet.messages.get(DETECTED_POINTS)
        if message:
            return is_q_format(message, packet.points)
    return False


def _period_of(replay: Replay) -> float | None:
    """Median time from frame to frame by time stamps, s; None where they do not say it."""
    steps = np.diff(replay.numbers)
    times = np.diff(replay.times)
    usable = (steps > 0) & (times > 0)
    if not usable.any():
        return None
    period = float(np.median(times[usable] / steps[usable]))
    return period if 1e-5 <= period <= 1e6 else None


def _missing_text(paths: Sequence[Path], missing: dict[str, str]) -> str:
    """Message that names all keys that are missing, and commands that give them."""
    are = "are" if len(missing) > 1 else "is"
    overrides = " ".join(f"--set {key}={value}" for key, value in missing.items())
    files = " ".join(map(str, paths[:3])) + (" ..." if len(paths) > 3 else "")
    return (
        f"{paths[0]}: {' and '.join(missing)} {are} missing; the board's .cfg has "
        f"{'both' if len(missing) > 1 else 'it'}: radhar import {files} --radar FILE.cfg "
        f"-o walk.h5; or, with your numbers: radhar import {files} {overrides} -o walk.h5"
    )


@dataclass
class DumpFrames:
    """Frames of a dump, one after the other, and counts of the packets left out.

    Attributes:
        dump: Packets.
        reader: Reads points and targets of a packet.
        subframe: Number of the subframe whose points are read.
        misfits: Number of packets whose messages do not fit.
        first_misfit: Misfit in the first of them.
        others: Number of packets of other subframes.
    """

    dump: Dump
    reader: MessageReader
    subframe: int
    misfits: int = field(default=0, init=False)
    first_misfit: str = field(default="", init=False)
    packets_of_others: int = field(default=0, init=False)

    def __iter__(self) -> Iterator[PointFrame]:
        waiting: PointFrame | None = None  # tracks of its points come with the next packet
        for packet in self.dump.packets():
            if packet.subframe != self.subframe:
                self.packets_of_others += 1
                continue
            frame = self._frame(packet)
            if frame is None:
                continue
            if waiting is not None:
                yield self._with_tracks(waiting, packet)
            waiting = frame
        if waiting is not None:
            yield waiting

    def _frame(self, packet: Packet) -> PointFrame | None:
        """Frame of a packet; None, and counted, if a message does not fit."""
        try:
            return self.reader.frame(packet)
        except MessageError as error:
            self.misfits += 1
            self.first_misfit = self.first_misfit or f"frame {packet.number}: {error}"
            return None

    def _with_tracks(self, frame: PointFrame, after: Packet) -> PointFrame:
        """A frame with the tracks of its points, which the packet after it names."""
        tracks = self.reader.index_of(after)
        fits = tracks is not None and after.number == frame.number + 1
        if tracks is None or not fits or len(tracks) != len(frame.points):
            return frame
        return frame._replace(track=tracks_of(tracks))

    def findings(self) -> list[str]:
        """List the damage, misfits and other subframes that were left out, a sentence for each."""
        sentences = self.dump.damage.findings()
        if self.misfits:
            sentences.append(
                f"{self.misfits} frames have messages that do not fit and are left out; the first: "
                f"{self.first_misfit}"
            )
        if self.packets_of_others:
            sentences.append(
                f"{self.packets_of_others} packets of other subframes than {self.subframe} are "
                "left out (--set subframe=N)"
            )
        return sentences
