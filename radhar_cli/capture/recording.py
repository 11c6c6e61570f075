"""The recording file: the samples that one radar received (docs/guide/measured.md).

Beat signals follow radhar's sign: a target at range R lies at exp(-j 2 pi (fc tau + K tau t)).
Range profiles are samples over range, real ones of an impulse radar; slow time is a sample a pulse.
"""

import json
from collections.abc import Iterable
from pathlib import Path
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import NDArray
from pydantic import BaseModel, ConfigDict, Field, ValidationError

from radhar_cli import __version__
from radhar_cli.capture.findings import CLIPPED, LOST, Damage, checked
from radhar_cli.capture.source import Parts
from radhar_cli.dataset.untrusted_hdf5 import UntrustedFile
from radhar_cli.errors import CaptureError, FolderError, UnfinishedError
from radhar_cli.files.new_hdf5 import new_hdf5
from radhar_cli.files.replacing import replacing
from radhar_cli.files.untrusted import Closing
from radhar_cli.numerics.arrays import Complex
from radhar_cli.radar.impulse import impulse
from radhar_cli.radar.pulse_times import PulseTimes
from radhar_cli.radar.waveform import Waveform

KIND, SCHEMA_VERSION = "radhar recording", 1
CHUNK_BYTES = 2**20
MAX_PULSE = 2**28  # bytes of a pulse in complex128
NUMBERS = ("i2", "f4", "f8")

Hertz = Annotated[float, Field(gt=0, le=1e15)]
Text = Annotated[str, Field(max_length=1000)]
Whole = Annotated[int, Field(ge=1, le=2**40)]


class _Part(BaseModel):
    """Frozen part of the description of a recording."""

    model_config = ConfigDict(extra="forbid", frozen=True, allow_inf_nan=False)


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
    found: Annotated[list[Text], Field(max_length=1000)] = []


class RecordingInfo(_Part):
    """Description of a recording, stored as the attribute `recording` of its file."""

    # at the first sample of a chirp; of profiles and slow time, the frequency of their Doppler
    carrier_hz: Hertz
    prf_hz: Hertz  # pulses per second of one receiver within a segment
    # of a chirp or a profile; None of slow time, adc_rate_hz of profiles too
    bandwidth_hz: Hertz | None = None
    adc_rate_hz: Hertz | None = None
    samples: Annotated[int, Field(ge=2, le=2**24)] | None = None
    # where the samples of range profiles lie; None of chirps and slow time
    first_range_m: Annotated[float, Field(ge=0, le=1e7)] | None = None
    range_step_m: Annotated[float, Field(gt=0, le=1e7)] | None = None
    # shape of the samples
    receivers: Annotated[int, Field(ge=1, le=2**16)]
    pulses: Whole
    segments: Whole = 1  # stretches of pulses without a gap
    # delay of each receiver's pulses, if transmitters take turns
    receiver_delay_s: Annotated[list[float], Field(max_length=2**16)]
    labels: Annotated[list[Label], Field(max_length=10_000)] = []
    source: SourceNote

    @property
    def holds(self) -> Literal["beat", "profiles", "slow_time"]:
        """Kind of the samples, which is the name of their dataset."""
        if self.samples is None:
            return "slow_time"
        return "beat" if self.range_step_m is None else "profiles"

    def waveform(self, fft_length: int | None = None, centred: bool = True) -> Waveform:
        """Waveform of the recording; `duration` leaves out the gaps.

        Args:
            fft_length: length of the transform over a chirp; None is the number of samples.
            centred: whether ranges refer to the middle of the chirp.

        Raises:
            CaptureError: the recording is slow time, which has no ranges.
        """
        if self.samples is None or self.bandwidth_hz is None:
            raise CaptureError("the recording is slow time, which has no ranges")
        if self.first_range_m is not None and self.range_step_m is not None:
            last = self.first_range_m + self.samples * self.range_step_m
            return impulse(
                self.carrier_hz - self.bandwidth_hz / 2,
                self.bandwidth_hz,
                self.prf_hz,
                self.pulses / self.prf_hz,
                (self.first_range_m, last),
                self.samples,
            )
        assert self.adc_rate_hz is not None  # as _info has seen to
        return Waveform(
            fc=self.carrier_hz,
            bandwidth=self.bandwidth_hz,
            chirp=self.samples / self.adc_rate_hz,
            adc_rate=self.adc_rate_hz,
            prf=self.prf_hz,
            duration=self.pulses / self.prf_hz,
            fft_length=fft_length,
            centred=centred,
        )


def write_recording(
    path: Path,
    info: RecordingInfo,
    number: np.dtype[Any],
    parts: int,
    pieces: Iterable[tuple[int, Parts]],
    segments: PulseTimes,
    damage: Damage | None = None,
    exclusive: bool = False,
) -> RecordingInfo:
    """Write a recording under another name, then rename it into place.

    Args:
        path: file to write.
        info: description of the recording, without findings of the damage.
        number: type of the numbers, one of NUMBERS.
        parts: 2 for complex numbers, 1 for real ones.
        pieces: (first pulse, numbers [receiver, sample, pulse, part]) of each piece.
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
    dtype = number
    if parts == 2:
        pair = [("r", "<i2"), ("i", "<i2")]
        dtype = np.dtype({"f4": "c8", "f8": "c16"}.get(number.str[1:], pair))
    samples, axes_of_samples = info.samples or 1, slice(None, None, 1 if info.samples else 2)
    shape = (info.receivers, samples, info.pulses)
    length = max(CHUNK_BYTES // (samples * dtype.itemsize), 1)
    chunks = (1, samples, min(length, info.pulses))
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        with (
            replacing(path, exclusive=exclusive) as unfinished,
            new_hdf5(unfinished, path) as (file, check),
        ):
            data = file.create_dataset(
                info.holds, shape[axes_of_samples], dtype, chunks=chunks[axes_of_samples]
            )
            across = "range" if info.holds == "profiles" else "fast time"
            data.attrs["axes"] = ["receiver", across, "pulse"][axes_of_samples]
            for first, values in pieces:
                block = np.ascontiguousarray(values, dtype=number).view(dtype)[..., 0]
                stop = first + block.shape[2]
                data[..., first:stop] = block if info.samples else block[:, 0]
                check()
            flags = np.concatenate(damage.flags) if damage else np.zeros(info.pulses, np.uint8)
            if damage is not None and (flags & LOST).all():
                raise CaptureError(
                    f"{path.name}: each of the {info.pulses} pulses lacks samples (zeros, or NaN)"
                )
            findings = damage.findings() if damage else []
            file["flags"] = flags
            file["flags"].attrs["meaning"] = [f"{LOST}: samples lost", f"{CLIPPED}: clipped"]
            file["segment_start"] = segments.start.astype("f8")
            file["segment_start"].attrs["unit"] = "s"
            file["segment_first"] = segments.first.astype("i8")
            source = info.source.model_copy(update={"found": [*info.source.found, *findings]})
            info = info.model_copy(update={"source": source, "segments": len(segments)})
            file.attrs["kind"] = KIND
            file.attrs["schema_version"] = SCHEMA_VERSION
            file.attrs["recording"] = json.dumps(info.model_dump())
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


def is_recording(path: Path) -> bool:
    """Whether a file describes itself as a recording."""
    try:
        with UntrustedFile(path) as file:
            return file.has_attribute("kind") and file.text("kind") == KIND
    except FolderError:
        return False


class Recording(Closing):
    """A recording file opened for reading; it is not trusted.

    Attributes:
        info: description of the recording.
        samples: numbers [receiver, sample, pulse], of slow time [receiver, pulse].
        segments: times of the pulses.
        flags: uint8 [pulse]: 1 samples lost, 2 clipped.

    Raises:
        FolderError: the file is no recording, or is damaged.
    """

    def __init__(self, path: Path) -> None:
        self.path = path
        self._file = UntrustedFile(path)
        try:
            if not self._file.has_attribute("kind") or self._file.text("kind") != KIND:
                raise FolderError(
                    f"{path}: is not a recording; `radhar import` makes one from a capture"
                )
            version = self._file.whole_number("schema_version")
            if version != SCHEMA_VERSION:
                raise FolderError(f"{path}: schema_version = {version}: should be {SCHEMA_VERSION}")
            self.info = info = _info(self._file.json("recording"), path)
            self.samples = self._file.samples(info.holds)
            shape = (info.receivers, info.samples or 1, info.pulses)[:: 1 if info.samples else 2]
            where, number = self.samples.where, self.samples.number
            if self.samples.shape != shape:
                raise FolderError(f"{where}: has the shape {self.samples.shape}; should be {shape}")
            if number.str[1:] not in NUMBERS:
                raise FolderError(f"{where}: is of the type {number}; should be one of {NUMBERS}")
            self.flags: NDArray[np.uint8] = self._file.column("flags", "u1", (info.pulses,))[:]
            self.segments = self._read_segments()
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
        receivers, samples = slice(0, self.info.receivers), self.info.samples
        if samples is None:
            values = self.samples.read((receivers, slice(first, stop)))[:, None]
        else:
            values = self.samples.read((receivers, slice(0, samples), slice(first, stop)))
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
        info = RecordingInfo.model_validate(document)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        key = ".".join(map(str, first["loc"]))
        raise FolderError(f"{path}: attribute recording: {key}: {first['msg']}") from None
    of_chirps, of_profiles = (info.adc_rate_hz,), (info.first_range_m, info.range_step_m)
    of_both = (info.samples, info.bandwidth_hz)
    required, absent = {
        "slow_time": ((), (*of_both, *of_chirps, *of_profiles)),
        "beat": ((*of_both, *of_chirps), of_profiles),
        "profiles": ((*of_both, *of_profiles), of_chirps),
    }[info.holds]
    fits = None not in required and all(value is None for value in absent)
    if len(info.receiver_delay_s) != info.receivers or not fits:
        raise FolderError(
            f"{path}: attribute recording: should have samples and bandwidth_hz together, with "
            "adc_rate_hz of chirps, or with first_range_m and range_step_m of range profiles; and "
            "a delay of every receiver"
        )
    if 16 * info.receivers * (info.samples or 1) > MAX_PULSE:
        raise FolderError(
            f"{path}: attribute recording: a pulse of {info.receivers} receivers and "
            f"{info.samples} samples should take at most {MAX_PULSE} bytes"
        )
    return info


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
            **info.model_dump(exclude={"receiver_delay_s"}),
            "duration_s": recording.segments.duration,
            "complex": recording.samples.parts == 2,
            "lost_pulses": int(np.count_nonzero(flags & LOST)),
            "clipped_pulses": int(np.count_nonzero(flags & CLIPPED)),
        }
        if info.samples is not None:
            waveform = info.waveform()
            summary["half_band_range_m"] = waveform.half_band_range
            summary["range_step_m"] = waveform.range_step
            summary["highest_speed_mps"] = waveform.highest_speed
        return summary
