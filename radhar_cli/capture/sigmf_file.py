"""SigMF, the open format of recordings of radio signals, in and out (sigmf.org, version 1.2).

A recording becomes one stream of channels (receivers), chirp after chirp, at the rate within a
chirp. Fields that SigMF lacks, such as the PRF, are keys of the optional extension `radhar`.
Stretches are captures, labels annotations.
"""

import hashlib
import json
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
from numpy.typing import NDArray

from radhar_cli import __version__
from radhar_cli.capture.array_files import MAX_RECEIVERS
from radhar_cli.capture.recording import Recording
from radhar_cli.capture.settings import CaptureSettings
from radhar_cli.capture.source import Parts, Source
from radhar_cli.config.reading import validated
from radhar_cli.errors import CaptureError, MachineError, UnfinishedError
from radhar_cli.replacing import replacing
from radhar_cli.untrusted import read_json, refuse_outside, regular_size

META, DATA = ".sigmf-meta", ".sigmf-data"
SPECIFICATION = "1.2.6"
EXTENSION = "radhar"
MAX_CAPTURES = 10_000


def _validated(metadata: dict[str, Any], where: str) -> None:
    try:
        from sigmf.validate import validate
    except ImportError:
        raise MachineError(
            "SigMF needs sigmf, which is not installed: pip install 'radhar[capture]'"
        ) from None
    try:
        validate(metadata)
    except Exception as error:  # jsonschema's, and whatever else it meets
        first = str(error).partition("\n")[0]
        raise CaptureError(f"{where}: is not valid SigMF ({first})") from None


def open_sigmf(path: Path, settings: CaptureSettings) -> Source:
    """Open a SigMF recording by its .sigmf-meta or .sigmf-data file.

    Raises:
        CaptureError: it is not valid, or lacks fields that `settings` lacks too.
        FolderError: the metadata are damaged, or one of the two is a link to outside the folder.
    """
    meta, data = path.with_suffix(META), path.with_suffix(DATA)
    refuse_outside(meta if path == data else data, path.parent)
    document = read_json(meta)
    _validated(document, str(meta))
    from sigmf.sigmffile import dtype_info

    metadata, captures = document["global"], document["captures"]
    if len(captures) > MAX_CAPTURES:
        raise CaptureError(f"{meta}: captures: has {len(captures)}; at most {MAX_CAPTURES}")
    for key in ("core:dataset", "core:metadata_only", "core:trailing_bytes"):
        if metadata.get(key):
            raise CaptureError(f"{meta}: {key} = {metadata[key]!r}: should be data in {data.name}")
    if any(one.get("core:header_bytes") for one in captures):
        raise CaptureError(f"{meta}: core:header_bytes: should be 0; headers are not read")
    found = dtype_info(metadata["core:datatype"])
    dtype, parts = np.dtype(found["component_dtype"]), 1 + found["is_complex"]
    if dtype.kind not in "iuf":
        raise CaptureError(
            f"{meta}: core:datatype = {metadata['core:datatype']}: should be numbers"
        )
    given = _given(metadata, captures, settings)
    validated(CaptureSettings, given, str(meta), {})
    samples = given.get("samples") or settings.samples
    channels = metadata.get("core:num_channels", 1)
    if channels > MAX_RECEIVERS:
        raise CaptureError(
            f"{meta}: core:num_channels = {channels}: should be at most {MAX_RECEIVERS}"
        )
    try:
        size = regular_size(data)
    except OSError as error:
        raise CaptureError(f"{data}: {error.strerror}") from None
    pulse = channels * (samples or 1) * parts
    pulses, rest = divmod(size, pulse * dtype.itemsize)
    if pulses == 0:
        raise CaptureError(
            f"{data}: holds {size} bytes; a pulse by {meta.name} takes {pulse * dtype.itemsize}"
        )
    if wanted := metadata.get("core:sha512"):
        with data.open("rb") as file:
            if hashlib.file_digest(file, "sha512").hexdigest() != wanted.lower():
                raise CaptureError(f"{data}: differs from the core:sha512 in {meta.name}")
    number = dtype.newbyteorder("=")

    def read(first: int, stop: int) -> Parts:
        offset, count = first * pulse * dtype.itemsize, (stop - first) * pulse
        values = np.fromfile(data, dtype, count, offset=offset).astype(number, copy=False)
        return values.reshape(stop - first, samples or 1, channels, parts).transpose(2, 1, 0, 3)

    notes = [f"the last {rest} bytes (an incomplete pulse) are left out"] if rest else []
    starts = metadata.get(f"{EXTENSION}:segment_start_s")
    times = None
    if starts is not None and "prf_hz" in given:
        first = [one["core:sample_start"] // (samples or 1) for one in captures]
        times = _times(starts, first, pulses, given["prf_hz"], str(meta))
    return Source(
        *((data, meta), channels, samples, pulses, number, parts, read, times),
        settings=given,
        notes=tuple(notes),
    )


def _given(
    metadata: dict[str, Any], captures: list[dict[str, Any]], settings: CaptureSettings
) -> dict[str, Any]:
    """Settings that the metadata hold."""
    given: dict[str, Any] = {}
    for key in ("carrier_hz", "bandwidth_hz", "prf_hz", "samples", "beat"):
        if f"{EXTENSION}:{key}" in metadata:
            given[key] = metadata[f"{EXTENSION}:{key}"]
    if captures and "core:frequency" in captures[0]:
        given.setdefault("carrier_hz", captures[0]["core:frequency"])
    if captures and "core:datetime" in captures[0]:
        given["start_time"] = captures[0]["core:datetime"]
    if "core:sample_rate" in metadata:
        slow = not (given.get("samples") or settings.samples)
        given.setdefault("prf_hz" if slow else "adc_rate_hz", metadata["core:sample_rate"])
    return given


def _times(
    starts: Any, first: list[int], pulses: int, prf: float, where: str
) -> NDArray[np.float64]:
    """Times (s) of the pulses, from the start and the first pulse of each segment."""
    good = isinstance(starts, list) and len(starts) == len(first) and first[0] == 0
    try:
        if not good or first[-1] >= pulses:
            raise ValueError
        start = np.array([float(one) for one in starts])
    except (ValueError, TypeError, OverflowError):
        raise CaptureError(
            f"{where}: {EXTENSION}:segment_start_s: should have one time per capture"
        ) from None
    at = np.searchsorted(first, np.arange(pulses), side="right") - 1
    return np.asarray(start[at] + (np.arange(pulses) - np.array(first)[at]) / prf)


@contextmanager
def recording_or_sigmf(out: Path, sigmf: bool) -> Iterator[tuple[Path, list[Path]]]:
    """(where to write a recording, files that there are afterwards); SigMF is converted from it."""
    files = [out]
    if not sigmf:
        yield out, files
        return
    out.parent.mkdir(parents=True, exist_ok=True)
    with TemporaryDirectory(prefix=f".{out.name}.", dir=out.parent) as folder:
        yield (target := Path(folder) / "recording.h5"), files
        with Recording(target) as recording:
            files[:] = write_sigmf(recording, out)


def write_sigmf(recording: Recording, out: Path) -> list[Path]:
    """Write a recording as out.sigmf-meta and out.sigmf-data; return their paths.

    Raises:
        UnfinishedError: they cannot be written.
    """
    meta, data = out.with_suffix(META), out.with_suffix(DATA)
    digest = hashlib.sha512()
    try:
        out.parent.mkdir(parents=True, exist_ok=True)
        with replacing(data) as unfinished, replacing(meta) as unfinished_meta:
            with unfinished.open("wb") as file:
                for values in recording.pieces():
                    ordered = np.ascontiguousarray(values.transpose(2, 1, 0, 3))
                    block = ordered.astype(recording.samples.number.newbyteorder("<")).tobytes()
                    digest.update(block)
                    file.write(block)
            document = _metadata(recording, digest.hexdigest())
            _validated(document, str(meta))
            unfinished_meta.write_text(json.dumps(document, indent=2) + "\n")
    except OSError as error:
        raise UnfinishedError(f"{error.filename or out}: {error.strerror or error}") from None
    return [meta, data]


def _metadata(recording: Recording, sha512: str) -> dict[str, Any]:
    info, segments = recording.info, recording.segments
    samples = info.samples or 1
    number, kind = recording.samples.number, "rc"[recording.samples.parts - 1]
    radhar = {
        "carrier_hz": info.carrier_hz,
        "bandwidth_hz": info.bandwidth_hz,
        "prf_hz": info.prf_hz,
        "samples": info.samples,
        "beat": "negative" if kind == "c" and info.samples else None,
        "segment_start_s": segments.start.tolist() if len(segments) > 1 else None,
        "receiver_delay_s": info.receiver_delay_s if any(info.receiver_delay_s) else None,
    }
    captures: list[dict[str, Any]] = [
        {"core:sample_start": int(first) * samples, "core:frequency": info.carrier_hz}
        for first in segments.first
    ]
    if info.start_time is not None:
        captures[0]["core:datetime"] = info.start_time
    return {
        "global": {
            "core:datatype": f"{kind}{number.kind}{8 * number.itemsize}_le",
            "core:sample_rate": info.adc_rate_hz or info.prf_hz,
            "core:version": SPECIFICATION,
            "core:num_channels": info.receivers,
            "core:sha512": sha512,
            "core:recorder": f"radhar {__version__}",
            "core:extensions": [{"name": EXTENSION, "version": "1.0.0", "optional": True}],
            **{f"{EXTENSION}:{key}": value for key, value in radhar.items() if value is not None},
        },
        "captures": captures,
        "annotations": _annotations(recording, samples),
    }


def _annotations(recording: Recording, samples: int) -> list[dict[str, Any]]:
    info = recording.info
    times = recording.segments.times(np.arange(info.pulses))
    annotations = []
    for one in info.labels:
        first = 0 if one.start_s is None else int(np.searchsorted(times, one.start_s))
        stop = info.pulses if one.stop_s is None else int(np.searchsorted(times, one.stop_s))
        annotation = {
            "core:sample_start": first * samples,
            "core:sample_count": max(stop - first, 1) * samples,
            "core:label": one.label,
        }
        if one.person is not None:
            annotation["core:comment"] = f"person {one.person}"
        annotations.append(annotation)
    return sorted(annotations, key=lambda one: one["core:sample_start"])
