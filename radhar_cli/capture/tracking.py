"""The torso of a recording: its range bins, frame by frame, and the track through them."""

from collections.abc import Iterator

import numpy as np

from radhar_cli.arrays import Complex
from radhar_cli.processing.pulse_times import PulseTimes
from radhar_cli.processing.torso_track import (
    RangeDoppler,
    TorsoTrack,
    find_torso,
    hann_in_range,
    range_doppler,
    velocities,
)
from radhar_cli.radar.waveform import Waveform

WINDOW_S = 0.16  # of the tracker's frames
OVERLAP = 0.5


def track_torso(bins: Complex, segments: PulseTimes, waveform: Waveform) -> TorsoTrack | None:
    """Find the torso in range bins [receiver, bin, pulse] from which what stands still was removed.

    Frames of the tracker have 0.16 s, less where segments are shorter, and never cross a gap. None
    where nothing moves.
    """
    length = min(max(round(WINDOW_S * segments.prf), 8), int(segments.lengths.max()))
    speeds = velocities(length, segments.prf, waveform.f0)
    window = np.hanning(length + 2)[1:-1]
    hop = max(round((1 - OVERLAP) * length), 1)

    def frames() -> Iterator[RangeDoppler]:
        for start, first, count in zip(
            segments.start, segments.first, segments.lengths, strict=True
        ):
            for at in range(0, int(count) - length + 1, hop):
                middle = start + (at + (length - 1) / 2) / segments.prf
                part = bins[:, :, first + at : first + at + length]
                part = hann_in_range(part) if waveform.n_fft == waveform.n_adc else part
                yield range_doppler(part, window, float(middle))

    return find_torso(frames(), waveform.range_axis(), speeds, len(bins))


def without_static(bins: Complex) -> Complex:
    """Range bins [..., pulse] less their mean over the recording."""
    moving: Complex = bins - bins.mean(axis=-1, keepdims=True)
    return moving
