"""A few seconds of a recording: SNR, ranges and noise floor.

With range bins S_k = sum_n s[n] exp(...) of N samples, white noise of variance sigma^2 has
|S_k|^2 = N sigma^2 and a path of amplitude A has sum_k |S_k|^2 = N^2 A^2: SNR = P_s/sigma^2 as in
model.md.
"""

from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

import numpy as np
import scipy.fft

from radhar_cli.arrays import Bool, Complex, Float, Index
from radhar_cli.capture.chain import bins_of_part, filled, pulses_between
from radhar_cli.capture.findings import LOST
from radhar_cli.capture.recording import Recording
from radhar_cli.capture.tracking import WINDOW_S, track_torso, without_static
from radhar_cli.processing.pulse_times import PulseTimes
from radhar_cli.processing.torso_track import hann_in_range
from radhar_cli.radar.waveform import SPEED_OF_LIGHT, Waveform

PART_S = 4.0  # of a recording that gives one SNR
MAX_PARTS = 50  # of a recording
SURE = 0.5  # confidence of the track from which its range counts
HANN_GAIN = 0.5**2 + 2 * 0.25**2  # of white noise, by hann_in_range
QUARTILE = 0.25
SLOW_MPS = 0.15  # what moves no faster is no person
FAST_SHARE = 0.02  # of the power of a person who does something
REACH_M = 1.2  # of a person's limbs from the torso


class Part(NamedTuple):
    """Estimates from a few seconds of a recording.

    Attributes:
        snr_db: of what moves within reach of the torso, per raw sample; NaN where nobody is found.
        ranges: of the torso where it is surely found, m.
        floor: of the noise in each range bin, as variance of a raw sample [K].
    """

    snr_db: float
    ranges: Float
    floor: Float

    @property
    def noise(self) -> float:
        """Variance of a raw sample."""
        return float(np.quantile(self.floor, QUARTILE))


def parts_of(path: Path) -> Iterator[Part]:
    """Estimates from stretches of about PART_S, at most MAX_PARTS, spread over a recording.

    Stretches without noise, or with no pulse that is whole, are left out.
    """
    with Recording(path) as recording:
        w, length = recording.info.waveform(), recording.segments.duration
        count = min(max(int(length / PART_S), 1), MAX_PARTS)
        for start in np.linspace(0, max(length - PART_S, 0), count).tolist():
            first, last, segments = pulses_between(recording, start, min(start + PART_S, length))
            lost = (recording.flags[first:last] & LOST).astype(bool)
            if lost.all():
                continue
            bins = filled(bins_of_part(recording, w, [0], first, last), lost)[0]
            part = _part(without_static(bins), segments, w)
            if part.noise > 0:
                yield part


def _part(moving: Complex, segments: PulseTimes, w: Waveform) -> Part:
    """Estimates from range bins [K, M] without what stands still."""
    maps, middle, white = _range_doppler(moving, segments, w)
    length = maps.shape[2]
    # |.|^2 of noise is exponential; the lower quartile of a frame has little of the person in it,
    # and the median over frames little of those in which a person fills the bin.
    floor = np.median(np.quantile(maps, QUARTILE, axis=2), axis=0)
    nobody = Part(np.nan, np.empty(0), floor / (-np.log(1 - QUARTILE) * white))
    track = track_torso(moving[None], segments, w)
    if track is None or not nobody.noise > 0:
        return nobody
    at = track.ranges(segments.times(middle))
    near = np.abs(w.range_axis() - at[:, None]) <= REACH_M + 2 * w.range_step
    # Curtains and fans move slowly, and are taken for a person where there is none.
    least = SLOW_MPS * 2 * w.f0 / SPEED_OF_LIGHT + 2 * w.prf / length  # beside Hann's main lobe
    fast = np.abs(np.fft.fftfreq(length, 1 / w.prf)) > least
    cell = nobody.noise * white
    signal = _power_near(maps.sum(axis=2), near, cell * length)
    quick = _power_near(maps[:, :, fast].sum(axis=2), near, cell * np.count_nonzero(fast))
    if not (signal > 0 and quick > FAST_SHARE * signal):
        return nobody
    snr = signal / (length * white * w.n_adc) / nobody.noise
    sure = track.range[track.confidence >= SURE]
    return nobody._replace(snr_db=10 * float(np.log10(snr)), ranges=sure)


def _range_doppler(
    moving: Complex, segments: PulseTimes, w: Waveform
) -> tuple[Float, Index, float]:
    """Power [frame, bin, Doppler], the pulse in the middle of each frame, and the noise's gain.

    Frames cross no gap. The gain is the power in a cell of white noise of variance 1.
    """
    length = min(max(round(WINDOW_S * w.prf), 8), int(segments.lengths.max()))
    window = np.hanning(length + 2)[1:-1]
    starts = np.concatenate(
        [np.arange(one.start, one.stop - length + 1, length) for one in segments.slices]
    )
    frames = (hann_in_range(moving[:, at : at + length]) * window for at in starts.tolist())
    maps = np.stack([np.abs(scipy.fft.fft(frame, axis=1)) ** 2 for frame in frames])
    return maps, starts + length // 2, HANN_GAIN * w.n_adc * float(np.sum(window**2))


def _power_near(power: Float, near: Bool, noise: float) -> float:
    """Power of a frame in the bins near the torso, less the noise.

    That is the median of the frame's other bins, with all that lies at all ranges.

    Args:
        power: of the moving echo [frame, bin].
        near: whether a bin is near the torso [frame, bin].
        noise: white noise in a bin, for frames in which all bins are near.
    """
    signal = 0.0
    for bins, inside in zip(power, near, strict=True):
        floor = noise if inside.all() else float(np.median(bins[~inside]))
        signal += float(np.sum(bins[inside] - floor))
    return signal / len(power)
