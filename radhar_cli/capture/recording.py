"""The recording file: the samples that one radar received (docs/guide/measured.md).

Beat signals follow radhar's sign: a target at range R lies at exp(-j 2 pi (fc tau + K tau t)).
Range profiles are samples over range, real ones of an impulse radar; slow time is a sample a pulse.
"""

import json
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from radhar_cli import __version__
from radhar_cli.capture.content import (
    Beat,
    Content,
    RangeProfiles,
    Ranging,
    SlowTime,
    numbers_of,
)
from radhar_cli.capture.findings import CLIPPED, LOST, Damage, checked
from radhar_cli.errors import CaptureError, FolderError, UnfinishedError, describe_schema
from radhar_cli.files.new_hdf5 import new_hdf5
from radhar_cli.files.replacing import replacing
from radhar_cli.files.untrusted import Closing
from radhar_cli.numerics.arrays import Complex
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.pulse_times import PulseTimes
from radhar_cli.readers.captures.source import Parts
from radhar_cli.readers.untrusted_hdf5 import UntrustedFile

KIND, SCHEMA_VERSION = "radhar recording", 1
KIND_OF_POINTS = "radhar recording of points"  # `point_recording.py`
CHUNK_BYTES = 2**20
MAX_PULSE = 2**28  # bytes of a pulse in complex128
NUMBERS = ("i2", "f4", "f8")

Hertz = Annotated[float, Field(gt=0, le=1e15)]
Text = Annotated[str, Field(max_length=1000)]
Whole = Annotated[int, Field(ge=1, le=2**40)]


class _Part(BaseModel):
    """Frozen part of the description of a recording."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, allow_inf_nan=False, populate_by_name=True
    )


class Label(_Part):
    """Activity and person from start to stop, s; without these, in the whole recording."""

    label: Text
    person: Text | None = None
    start_s: float | None = None
    stop_s: float | None = None


class SourceNote(_Part):
    """Origin of a recording: format, files, and findings on import."""

    format: Text
    files: Annotated[list[Text], Field(max_length=1000)] = []
    findings: Annotated[list[Text], Field(max_length=1000, alias="found")] = []


class _Description(_Part):
    """Description of a recording as its file has it, in the attribute `recording`."""

    carrier_hz: Hertz
    prf_hz: Hertz
    # of a chirp or a profile; None of slow time, adc_rate_hz of profiles too
    bandwidth_hz: Hertz | None = None
    adc_rate_hz: Hertz | None = None
    samples: Annotated[int, Field(ge=2, le=2**24)] | None = None
    # where the samples of range profiles lie; None of chirps and slow time
    first_range_m: Annotated[float, Field(ge=0, le=1e7)] | None = None
    range_step_m: Annotated[float, Field(gt=0, le=1e7)] | None = None
    whole_band: bool = False  # of chirps, whether ranges are those of both halves of the band
    receivers: Annotated[int, Field(ge=1, le=2**16)]
    pulses: Whole
    segments: Whole = 1
    receiver_delay_s: Annotated[list[float], Field(max_length=2**16)]
    labels: Annotated[list[Label], Field(max_length=10_000)] = []
    source: SourceNote

    def content(self) -> Content | None:
        """Content that the numbers describe; None if they describe none."""
        match (
            self.samples,
            self.bandwidth_hz,
            self.adc_rate_hz,
            self.first_range_m,
            self.range_step_m,
        ):
            case (None, None, None, None, None):
                return SlowTime(self.carrier_hz, self.prf_hz)
            case (int(n), float(band), float(rate), None, None):
                return Beat(self.carrier_hz, band, rate, n, self.prf_hz, self.whole_band)
            case (int(n), float(band), None, float(first), float(step)):
                return RangeProfiles(self.carrier_hz, band, n, self.prf_hz, first, step)
        return None


@dataclass(frozen=True)
class RecordingInfo:
    """Description of a recording."""

    content: Content  # what the samples are, with the numbers of the radar
    receivers: int  # virtual ones: transmitters times receivers
    pulses: int  # of each receiver
    receiver_delay_s: Sequence[float]  # delay of each receiver's pulses, if transmitters take turns
    source: SourceNote
    segments: int = 1  # stretches of pulses without a gap
    labels: Sequence[Label] = ()
    # places in a loop of the chirps in which two transmitters send together, of a simulated board
    bpm: tuple[int, int] | None = None
    # keys of a config's section `radar` that the header said, such as where the receivers stand
    radar: Mapping[str, Any] = field(default_factory=dict)

    @property
    def carrier_hz(self) -> float:
        """Frequency of the Doppler of slow time and profiles, of a chirp's first sample, Hz."""
        return self.content.carrier_hz

    @property
    def prf_hz(self) -> float:
        """Pulses per second of one receiver within a segment."""
        return self.content.prf_hz

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the samples [receiver, sample, pulse], of slow time [receiver, pulse]."""
        sizes = {"receiver": self.receivers, "pulse": self.pulses}
        return tuple(sizes.get(axis, self.content.samples) for axis in self.content.axes)

    @property
    def ranging(self) -> Ranging:
        """Content, of which ranges are needed.

        Raises:
            CaptureError: the recording is slow time, which has no ranges.
        """
        if isinstance(self.content, SlowTime):
            raise CaptureError("the recording is slow time, which has no ranges")
        return self.content

    def waveform(self, fft_length: int | None = None, centred: bool = True) -> Waveform:
        """Waveform of the recording; `duration` leaves out the gaps.

        Args:
            fft_length: length of the transform over a chirp; None is the number of samples.
            centred: whether ranges refer to the middle of the chirp.

        Raises:
            CaptureError: the recording is slow time, which has no ranges.
        """
        return self.ranging.waveform(self.pulses / self.prf_hz, fft_length, centred)

    def document(self) -> dict[str, Any]:
        """Plain values, as they are stored in a file."""
        return _Description(
            **numbers_of(self.content),
            receivers=self.receivers,
            pulses=self.pulses,
            segments=self.segments,
            receiver_delay_s=[*self.receiver_delay_s],
            labels=[*self.labels],
            source=self.source,
        ).model_dump(by_alias=True)


@dataclass(frozen=True)
class SampleStream:
    """Samples of a recording, piece by piece, as they are written."""

    number: np.dtype[Any]  # type of the numbers, one of NUMBERS
    parts: int  # 2 for complex numbers, 1 for real ones
    # (first pulse, numbers [receiver, sample, pulse, part]) of each piece
    pieces: Iterable[tuple[int, Parts]]

    @property
    def dtype(self) -> np.dtype[Any]:
        """Type of a sample."""
        if self.parts == 1:
            return self.number
        pair = [("r", "<i2"), ("i", "<i2")]
        return np.dtype({"f4": "c8", "f8": "c16"}.get(self.number.str[1:], pair))


def write_recording(
    path: Path,
    info: RecordingInfo,
    stream: SampleStream,
    segments: PulseTimes,
    damage: Damage | None = None,
    exclusive: bool = False,
) -> RecordingInfo:
    """Write a recording under another name, then rename it into place.

    Args:
        path: file to write.
        info: description of the recording, without findings of the damage.
        stream: samples.
        segments: times of the pulses.
        damage: damage, counted while the pieces are made; None for none.
        exclusive: leave a file alone that another process made meanwhile.

    Returns:
        The description that was written, with findings.

    Raises:
        CaptureError: every pulse lacks samples.
        FolderError: another process made the file meanwhile.
        UnfinishedError: it cannot be written.
    """
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with (
            replacing(path, exclusive=exclusive) as unfinished,
            new_hdf5(unfinished, path) as (file, check),
        ):
            dtype, content = stream.dtype, info.content
            chunks = _chunks(info, dtype)
            data = file.create_dataset(content.dataset, info.shape, dtype, chunks=chunks)
            data.attrs["axes"] = content.axes
            if info.bpm is not None:
                data.attrs["bpm"] = info.bpm
            for pulses, block in _blocks(info, stream):
                data[..., pulses] = block
                check()
            flags = np.concatenate(damage.flags) if damage else np.zeros(info.pulses, np.uint8)
            if damage is not None and (flags & LOST).all():
                raise CaptureError(
                    f"{path.name}: each of the {info.pulses} pulses lacks samples (zeros, or NaN)"
                )
            findings = [*info.source.findings, *(damage.findings() if damage else [])]
            source = info.source.model_copy(update={"findings": findings})
            info = replace(info, source=source, segments=len(segments))
            file["flags"] = flags
            file["flags"].attrs["meaning"] = [f"{LOST}: samples lost", f"{CLIPPED}: clipped"]
            file["segment_start"] = segments.start.astype("f8")
            file["segment_start"].attrs["unit"] = "s"
            file["segment_first"] = segments.first.astype("i8")
            file.attrs["kind"] = KIND
            file.attrs["schema_version"] = SCHEMA_VERSION
            file.attrs["recording"] = json.dumps(info.document())
            if info.radar:
                file.attrs["radar"] = json.dumps(dict(info.radar))
            file.attrs["radhar_version"] = __version__
    except FileExistsError:
        raise FolderError(
            f"{path}: was written by another process meanwhile; --overwrite replaces it"
        ) from None
    except OSError as error:
        raise UnfinishedError(
            f"{error.filename or path}: {error.strerror or error}; nothing was written"
        ) from None
    return info


def _chunks(info: RecordingInfo, dtype: np.dtype[Any]) -> tuple[int, ...]:
    """Shape of the chunks of a recording's samples: whole pulses of one receiver."""
    samples = info.content.samples
    pulses = max(CHUNK_BYTES // (samples * dtype.itemsize), 1)
    sizes = {"receiver": 1, "pulse": min(pulses, info.pulses)}
    return tuple(sizes.get(axis, samples) for axis in info.content.axes)


def _blocks(info: RecordingInfo, stream: SampleStream) -> Iterator[tuple[slice, NDArray[Any]]]:
    """Yield (pulses, samples [receiver, sample, pulse], of slow time [receiver, pulse])."""
    for first, values in stream.pieces:
        block = np.ascontiguousarray(values, dtype=stream.number).view(stream.dtype)[..., 0]
        pulses = slice(first, first + block.shape[2])
        yield pulses, block[:, 0] if isinstance(info.content, SlowTime) else block


def is_recording(path: Path) -> bool:
    """Whether a file describes itself as a recording."""
    return is_of_kind(path, KIND)


def is_of_kind(path: Path, kind: str) -> bool:
    """Whether a file is HDF5 whose attribute `kind` is a text."""
    try:
        with UntrustedFile(path) as file:
            return file.has_attribute("kind") and file.text("kind") == kind
    except FolderError:
        return False


class Recording(Closing):
    """A recording file opened for reading; it is not trusted.

    Attributes:
        info: description of the recording.
        samples: numbers [receiver, sample, pulse], of slow time [receiver, pulse].
        segments: times of the pulses.
        flags: uint8 [pulse]: 1 samples lost, 2 clipped.
        radar: the header's keys of the radar, as in a config's section `radar`, unchecked.

    Raises:
        FolderError: the file is no recording, or is damaged.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file = UntrustedFile(path)
        try:
            kind = self._file.text("kind") if self._file.has_attribute("kind") else ""
            if kind == KIND_OF_POINTS:
                raise FolderError(
                    f"{path}: is a recording of points, which has no samples; a data set of it: "
                    "radhar generate CONFIG --recordings LIST.csv (docs/guide/points.md)"
                )
            if kind != KIND:
                raise FolderError(
                    f"{path}: is not a recording; `radhar import` makes one from a capture"
                )
            version = self._file.whole_number("schema_version")
            if version != SCHEMA_VERSION:
                raise FolderError(f"{path}: {describe_schema(version, SCHEMA_VERSION)}")
            self.info = info = _info(self._file.json("recording"), path)
            self.samples = self._file.samples(info.content.dataset)
            where, number = self.samples.where, self.samples.number
            if self.samples.shape != info.shape:
                raise FolderError(
                    f"{where}: has the shape {self.samples.shape}; should be {info.shape}"
                )
            if number.str[1:] not in NUMBERS:
                raise FolderError(f"{where}: is of the type {number}; should be one of {NUMBERS}")
            if isinstance(self.info.content, RangeProfiles):
                of_type = replace(self.info.content, is_iq=self.samples.parts == 2)
                self.info = replace(self.info, content=of_type)
            self.flags: NDArray[np.uint8] = self._file.column("flags", "u1", (info.pulses,))[:]
            self.segments = self._read_segments()
            radar = self._file.json("radar") if self._file.has_attribute("radar") else {}
            self.radar: dict[str, Any] = radar if isinstance(radar, dict) else {}
        except BaseException:
            self._file.close()
            raise

    def _read_segments(self) -> PulseTimes:
        """Read and check the times of the pulses."""
        shape = (self.info.segments,)
        start = self._file.column("segment_start", "f8", shape)[:]
        first = self._file.column("segment_first", "i8", shape)[:]
        lengths = np.diff(first, append=self.info.pulses)
        ordered = (lengths >= 1).all() and (np.diff(start) > 0).all()
        if first[0] != 0 or not np.isfinite(start).all() or not ordered:
            raise FolderError(f"{self.path}: /segment_first: segments should be in order")
        return PulseTimes(start, first, self.info.pulses, self.info.prf_hz)

    def parts(self, first: int, stop: int) -> Parts:
        """Read numbers [receiver, sample, stop - first, part] as stored; slow time has one sample.

        Raises:
            CaptureError: a number is too large, or NaN in a pulse that is not flagged as lost.
        """
        sizes, pulses = self.info.shape[:-1], slice(first, stop)
        values = self.samples.read((*(slice(0, size) for size in sizes), pulses))
        if isinstance(self.info.content, SlowTime):
            values = values[:, None]
        values, gone = checked(values, first, str(self.path))
        gone &= (self.flags[first:stop] & LOST) == 0
        if gone.any():
            raise CaptureError(
                f"{self.path}: pulse {first + gone.argmax()} holds NaN; should be flagged as lost "
                f"({LOST}), as by `radhar import`"
            )
        return values

    def beat(self, first: int, stop: int) -> Complex:
        """Read complex samples [receiver, sample, stop - first]; errors are those of `parts`."""
        values = self.parts(first, stop)
        out = np.zeros(values.shape[:3], dtype=complex)
        out.real = values[..., 0]
        if values.shape[3] == 2:
            out.imag = values[..., 1]
        return out

    def close(self) -> None:
        """Close the file."""
        self._file.close()


def _info(document: Any, path: Path) -> RecordingInfo:
    """Check the description of a recording, read from its file."""
    try:
        stored = _Description.model_validate(document)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = ".".join(map(str, first["loc"]))
        raise FolderError(f"{path}: attribute recording: {key}: {first['msg']}") from None
    content = stored.content()
    if len(stored.receiver_delay_s) != stored.receivers or content is None:
        raise FolderError(
            f"{path}: attribute recording: should have samples and bandwidth_hz together, with "
            "adc_rate_hz of chirps, or with first_range_m and range_step_m of range profiles; and "
            "a delay of every receiver"
        )
    if 16 * stored.receivers * content.samples > MAX_PULSE:
        raise FolderError(
            f"{path}: attribute recording: a pulse of {stored.receivers} receivers and "
            f"{content.samples} samples should take at most {MAX_PULSE} bytes"
        )
    return RecordingInfo(
        content,
        stored.receivers,
        stored.pulses,
        stored.receiver_delay_s,
        stored.source,
        stored.segments,
        stored.labels,
    )


def summarise_recording(path: Path) -> dict[str, Any]:
    """Summarise a recording, as plain values, for `radhar inspect`.

    Raises:
        FolderError: the file is no recording, or is damaged.
    """
    with Recording(path) as recording:
        info, flags = recording.info, recording.flags
        summary: dict[str, Any] = {
            "kind": "recording",
            "path": str(path),
            "bytes": path.stat().st_size,
            **{key: value for key, value in info.document().items() if key != "receiver_delay_s"},
            "duration_s": recording.segments.duration,
            "complex": recording.samples.parts == 2,
            "lost_pulses": int(np.count_nonzero(flags & LOST)),
            "clipped_pulses": int(np.count_nonzero(flags & CLIPPED)),
        }
        if not isinstance(info.content, SlowTime):
            waveform = info.waveform()
            summary["half_band_range_m"] = waveform.half_band_range
            summary["range_step_m"] = waveform.range_step
            summary["highest_speed_mps"] = waveform.highest_speed
        return summary
