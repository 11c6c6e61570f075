"""Axes of the maps: what the rows and columns of a power map mean."""

from typing import NamedTuple

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.pipeline.run import Recording


class Axes(NamedTuple):
    """Axes of a map [vertical, time], lowest first.

    Attributes:
        vertical: Doppler frequency (Hz) or range (m) of the rows.
        time: centres of the columns, s.
    """

    vertical: Float
    time: Float

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Outer edges (time start, time stop, vertical low, vertical high) of the map."""
        return (*_edges(self.time), *_edges(self.vertical))


def axes_of(name: str, recording: Recording) -> Axes:
    """Axes of the map `name` of a recording."""
    waveform = recording.waveform
    late = 0.5 if recording.config.processing.mti else 0.0  # a difference lies between its pulses
    if name == "rtm":
        return Axes(waveform.range_axis(), (recording.shown + late) / waveform.prf)
    frames = recording.fsst_frames if name.startswith("fsst") else recording.frames
    length = frames.length
    if name.startswith("stft"):
        length = recording.config.processing.stft_fft_length or length
    kept = waveform.n_pulses - recording.config.processing.mti
    centres = frames.starts(kept) + (frames.length - 1) / 2 + late
    frequency = np.fft.fftshift(np.fft.fftfreq(length, 1 / waveform.prf))
    return Axes(frequency, centres / waveform.prf)


def _edges(axis: Float) -> tuple[float, float]:
    half = 0.5 * (axis[1] - axis[0]) if axis.size > 1 else 0.0
    return float(axis[0] - half), float(axis[-1] + half)
