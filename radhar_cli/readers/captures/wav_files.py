"""Captures that are sound files: pairs of channels are I and Q, one channel is of real samples."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import regular_size
from radhar_cli.readers.captures.array_axes import as_source
from radhar_cli.readers.captures.parser_errors import parser_errors_as_capture_errors
from radhar_cli.readers.captures.settings import AxisName
from radhar_cli.readers.captures.source import CaptureFiles, CaptureFormat, Source
from radhar_cli.readers.captures.stored_arrays import StoredArray

MAX_WAV = 2**30  # bytes: SciPy holds samples of 24 bits whole


def _is_wav(path: Path, head: bytes) -> bool:
    """Whether a file begins as RIFF files of sound do."""
    del path
    return head[:4] in (b"RIFF", b"RIFX", b"RF64") and head[8:12] == b"WAVE"


def _open_wav(capture: CaptureFiles) -> Source:
    """Open a sound file as slow time, whose rate is that of its header.

    Raises:
        CaptureError: it is damaged, or has other channels than I and Q.
    """
    from scipy.io import wavfile

    path = capture.paths[0]
    with parser_errors_as_capture_errors(str(path)):
        size = regular_size(path)
        if size > MAX_WAV:
            raise CaptureError(f"{path}: has {size} bytes; should have at most {MAX_WAV}")
        rate, samples = wavfile.read(path)
    channels = 1 if samples.ndim == 1 else samples.shape[1]
    settings = capture.settings
    if (channels > 1 and channels % 2 and settings.axes is None) or not rate > 0:
        raise CaptureError(
            f"{path}: has {channels} channels at {rate} Hz; should have one of real samples, or I "
            "and Q of each receiver in turn; --set axes=[pulse,receiver] takes each channel for a "
            "receiver of real samples"
        )
    if settings.axes is None:
        axes: tuple[AxisName, ...] = ("pulse", "receiver", "iq") if channels > 1 else ("pulse",)
        settings = settings.model_copy(update={"axes": axes})
    if settings.axes == ("pulse", "receiver", "iq"):
        samples = samples.reshape(len(samples), -1, 2)
    array = StoredArray(str(path), partial(np.asarray, samples))
    source = as_source(path, array, settings)
    content = "I and Q" if source.parts == 2 else "real samples"
    several = f" of {source.receivers} receivers" if source.receivers > 1 else ""
    note = f"sound file: {content}{several}, {rate} samples/s by its header"
    return replace(source, settings={"prf_hz": float(rate)}, notes=(*source.notes, note))


WAV = CaptureFormat(".wav", _is_wav, _open_wav)
