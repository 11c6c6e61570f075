"""A few seconds of a recording: SNR, noise and what stands in the room.

With range bins S_k = sum_n s[n] exp(...) of N samples, white noise of variance sigma^2 has
|S_k|^2 = N sigma^2 and a path of amplitude A has sum_k |S_k|^2 = N^2 A^2: SNR = P_s/sigma^2 as in
model.md.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import scipy.fft

from radhar_cli.arrays import Bool, Complex, Float, Index
from radhar_cli.capture.chain import bins_of_part, filled, pulses_between
from radhar_cli.capture.findings import LOST
from radhar_cli.capture.recording import Recording
from radhar_cli.capture.room_returns import MAIN_LOBE, QUARTILE, Returns, range_window, returns
from radhar_cli.capture.tracking import WINDOW_S, track_torso, without_static
from radhar_cli.processing.pulse_times import PulseTimes
from radhar_cli.processing.torso_track import TorsoTrack, hann_in_range
from radhar_cli.radar.waveform import SPEED_OF_LIGHT, Waveform

PART_S = 4.0  # of a recording that gives one SNR
MAX_PARTS = 50  # of a recording
SURE = 0.5  # confidence of the track from which its range counts
HANN_GAIN = 0.5**2 + 2 * 0.25**2  # of white noise, by hann_in_range
SLOW_MPS = 0.15  # what moves no faster is no person
FAST_SHARE = 0.02  # of the power of a person who does something
REACH_M = 1.2  # of a person's limbs from the torso


class Part(NamedTuple):
    """Estimates from a few seconds of a recording.

    Attributes:
        snr_db: of what moves within reach of the torso, per raw sample; NaN where nobody is found.
        ranges: of the torso where it is surely found, m.
        spreading: mean of 1/R^4 along its track, 1/m^4.
        floor: of the noise in each range bin, as variance of a raw sample [K].
        static_db: what stands still over what moves.
        room: what stands there.
    """

    snr_db: float
    ranges: Float
    spreading: float
    floor: Float
    static_db: float
    room: Returns

    @property
    def noise(self) -> float:
        """Variance of a raw sample."""
        return float(np.quantile(self.floor, QUARTILE))


class Excerpt(NamedTuple):
    """A few seconds of a recording.

    Attributes:
        w: the radar.
        segments: of the pulses.
        bins: range bins [K, M].
        smooth: the same through a window without sidelobes, in which a path of amplitude A has A.
        gain: variance in these of white noise of variance 1.
        track: of the torso, None where nobody is.
        away: where nobody is near [K, M].
    """

    w: Waveform
    segments: PulseTimes
    bins: Complex
    smooth: Complex
    gain: float
    track: TorsoTrack | None
    away: Bool

    def empty(self) -> "Excerpt":
        """The same, of which it turned out that nobody is there."""
        return self._replace(track=None, away=np.ones(self.bins.shape, bool))

    def stretches(self) -> Iterator[tuple[Complex, Bool]]:
        """(`smooth` without its mean while nobody is near, `away`) of the pulses between gaps."""
        count = np.maximum(self.away.sum(axis=1, keepdims=True), 1)
        moving = self.smooth - np.sum(self.smooth * self.away, axis=1, keepdims=True) / count
        for one in self.segments.slices:
            yield moving[:, one], self.away[:, one]


def excerpts(paths: Sequence[Path]) -> Iterator[Excerpt]:
    """Stretches of about PART_S, at most MAX_PARTS, spread over each recording."""
    for path in paths:
        with Recording(path) as recording:
            length = recording.segments.duration
            count = min(max(int(length / PART_S), 1), MAX_PARTS)
            for start in np.linspace(0, max(length - PART_S, 0), count).tolist():
                stop = min(start + PART_S, length)
                first, last, segments = pulses_between(recording, start, stop)
                if not (recording.flags[first:last] & LOST).all():
                    yield _excerpt(recording, first, last, segments)


def _excerpt(recording: Recording, first: int, last: int, segments: PulseTimes) -> Excerpt:
    w, lost = recording.info.waveform(), (recording.flags[first:last] & LOST).astype(bool)
    window = range_window(w.n_adc)
    bins, smooth = (
        filled(bins_of_part(recording, w, [0], first, last, one), lost)[0] for one in (None, window)
    )
    track = track_torso(without_static(bins)[None], segments, w)
    away = np.ones(bins.shape, bool)
    if track is not None:
        at = track.ranges(segments.times(np.arange(last - first)))
        away = np.abs(w.range_axis()[:, None] - at) > REACH_M + MAIN_LOBE * w.range_step
    return Excerpt(w, segments, bins, smooth, float(np.sum(window**2)), track, away)


def part_of(excerpt: Excerpt) -> tuple[Excerpt, Part] | None:
    """Estimates from a stretch, `empty` where nobody is; None of one that holds no noise."""
    w, moving = excerpt.w, without_static(excerpt.bins)
    length = min(max(round(WINDOW_S * w.prf), 8), int(excerpt.segments.lengths.max()))
    window = np.hanning(length + 2)[1:-1]
    power, middle = [], []
    for one in excerpt.segments.slices:
        for at in range(one.start, one.stop - length + 1, length):
            here = hann_in_range(moving[:, at : at + length])  # no sidelobes far off
            power.append(np.abs(scipy.fft.fft(here * window, axis=1)) ** 2)
            middle.append(at + length // 2)
    maps = np.stack(power)  # [frame, bin, Doppler]
    # |.|^2 of noise is exponential; the lower quartile of a frame has little of the person in it,
    # and the median over frames little of those in which a person fills the bin.
    white = HANN_GAIN * w.n_adc * float(np.sum(window**2))
    floor = np.median(np.quantile(maps, QUARTILE, axis=2), axis=0)
    floor /= -np.log(1 - QUARTILE) * white
    noise = float(np.quantile(floor, QUARTILE))
    if not noise > 0:
        return None
    # Reflectors move slowly, and are taken for a person where there is none.
    least = SLOW_MPS * 2 * w.f0 / SPEED_OF_LIGHT + 2 * w.prf / length  # beside Hann's main lobe
    fast = np.abs(np.fft.fftfreq(length, 1 / w.prf)) > least
    signal, quick = (
        _of_the_person(maps[:, :, some].sum(axis=2), excerpt, np.array(middle), noise * white * n)
        / (length * white * w.n_adc)
        for some, n in ((fast | True, length), (fast, np.count_nonzero(fast)))
    )
    found = signal > 0 and quick > FAST_SHARE * signal
    excerpt = excerpt if found else excerpt.empty()
    room = returns(excerpt.smooth, excerpt.away, excerpt.segments.first, w.prf, w.f0)
    part = Part(np.nan, np.empty(0), np.nan, floor, np.nan, room)
    if excerpt.track is None:
        return excerpt, part
    still = np.sum(np.abs(excerpt.bins.mean(axis=1)) ** 2) / w.n_adc**2
    return excerpt, part._replace(
        snr_db=10 * float(np.log10(signal / noise)),
        ranges=excerpt.track.range[excerpt.track.confidence >= SURE],
        spreading=float(np.mean(np.maximum(excerpt.track.range, w.range_step) ** -4)),
        static_db=10 * float(np.log10(max(still / signal, 1e-30))),
    )


def _of_the_person(power: Float, excerpt: Excerpt, middle: Index, noise: float) -> float:
    """Power of a frame that comes from within reach of the torso; 0 where there is none.

    Args:
        power: of the moving echo [frame, bin].
        excerpt: of the recording.
        middle: pulse in the middle of each frame.
        noise: white noise in a bin; taken off where there is no bin without the person, else the
            median of these is, with all that lies at all ranges.
    """
    if excerpt.track is None:
        return 0.0
    at = excerpt.track.ranges(excerpt.segments.times(middle))
    reach = REACH_M + 2 * excerpt.w.range_step
    near = np.abs(excerpt.w.range_axis() - at[:, None]) <= reach
    signal = 0.0
    for bins, inside, free in zip(power, near, excerpt.away[:, middle].T, strict=True):
        floor = float(np.median(bins[free])) if free.any() else noise
        signal += float(np.sum(bins[inside] - floor))
    return signal / len(power)
