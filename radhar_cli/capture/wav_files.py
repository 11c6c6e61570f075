"""Captures that are sound files: I and Q as left and right, or one channel of real samples."""

from dataclasses import replace
from functools import partial
from pathlib import Path

import numpy as np

from radhar_cli.capture.array_files import (
    StoredArray,
    as_source,
    parser_errors_as_capture_errors,
)
from radhar_cli.capture.settings import AxisName
from radhar_cli.capture.source import CaptureFiles, CaptureFormat, Source
from radhar_cli.errors import CaptureError
from radhar_cli.files.untrusted import regular_size

MAX_WAV = 2**30  # bytes: SciPy holds samples of 24 bits whole
CHANNELS = {1: "one of real samples", 2: "I and Q"}


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
    if channels not in CHANNELS or not rate > 0:
        known = ", or ".join(f"{count}: {name}" for count, name in CHANNELS.items())
        raise CaptureError(f"{path}: has {channels} channels at {rate} Hz; should have {known}")
    settings = capture.settings
    if settings.axes is None:
        axes: tuple[AxisName, ...] = ("pulse", "iq") if channels == 2 else ("pulse",)
        samples = samples if channels == 2 else samples.reshape(-1)
        settings = settings.model_copy(update={"axes": axes})
    array = StoredArray(str(path), partial(np.asarray, samples))
    source = as_source(path, array, settings)
    note = f"sound file: {CHANNELS[channels]}, {rate} samples/s by its header"
    return replace(source, settings={"prf_hz": float(rate)}, notes=(*source.notes, note))


WAV = CaptureFormat(".wav", _is_wav, _open_wav)
