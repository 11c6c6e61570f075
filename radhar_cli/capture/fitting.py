"""Estimate a simulation config from recordings: radar, SNR, ranges and noise floor.

A receiver's noise is the floor of its range-Doppler maps; the person is what moves above it. With
range bins S_k = sum_n s[n] exp(...) of N samples, white noise of variance sigma^2 has
|S_k|^2 = N sigma^2 and a path of amplitude A has sum_k |S_k|^2 = N^2 A^2: SNR = P_s/sigma^2 as in
model.md, A being the amplitude as received, behind the antennas' beam. Samples of a profile are
bins as they are, and a pulse is spread over sum_k g(t_k)^2 of them, g being its envelope; slow time
has a bin.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise
from math import pi, sqrt
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import scipy.fft
from scipy.special import gammaincinv

from radhar_cli.capture.chain import (
    MIN_FRAME_PULSES,
    RecordingPart,
    analytic,
    bins_of_part,
    part_of_pulses,
    slow_time_of_part,
)
from radhar_cli.capture.content import Beat, Content, SlowTime
from radhar_cli.capture.fitted_radar import (
    describe_chosen_frames,
    differing_key,
    frames_in,
    has_beam,
    keeps_whole_band,
    place_of,
    radar_of_recording,
    read_radar,
)
from radhar_cli.capture.recording import Recording
from radhar_cli.capture.tracking import WINDOW_S, TorsoTrack, hann_in_range, track_torso
from radhar_cli.config.data_set import Config
from radhar_cli.config.reading import validated, with_overrides
from radhar_cli.errors import CaptureError
from radhar_cli.figures.page import page, write_figure
from radhar_cli.numerics.arrays import Bool, Complex, Float, Index
from radhar_cli.processing.frames import Frames
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT, Waveform
from radhar_cli.radar.impulse import Impulse
from radhar_cli.radar.pulse_times import PulseTimes

MIN_SNRS = 3  # SNRs needed to fit a spread
MIN_S = 0.5  # shortest duration of the longest recording
PART_S = 4.0  # shortest part of a longer recording; none is twice as long
HANN_GAIN = 0.5**2 + 2 * 0.25**2  # gain of white noise in hann_in_range
QUARTILE = 0.25
LEAST_IN_BARS = 6  # recordings whose SNRs a histogram shows
SLOW_MPS = 0.15  # slower movement does not count as a person's
FAST_SHARE = 0.02  # least share of a person's power that moves faster
REACH_M = 1.2  # limbs from the torso


class Estimates(NamedTuple):
    """Estimates from a few seconds of a recording."""

    # SNR per raw sample of the moving echo within reach of the torso; 0 where nothing rises above
    # the noise, NaN where what moves is too slow for a person
    snr: float
    ranges: Float  # of the torso where it is sure, m; none of a track that may be lost
    floor: Float  # noise in each range bin, as variance of a raw sample [K]
    pulses: int  # pulses of the part

    @property
    def noise(self) -> float:
        """Variance of the noise of a raw sample: the lower quartile over the range bins."""
        return float(np.quantile(self.floor, QUARTILE))


@dataclass(frozen=True)
class Fit:
    """Estimates from all recordings."""

    recordings: list[list[Estimates]]  # estimates of the parts of each recording
    radar: Mapping[str, Any]  # section of a config, common to all recordings
    ranges: Float | None  # of the range bins [K], m; None of slow time
    seconds: float  # median duration of the recordings
    overrides: Sequence[str] = ()  # KEY=VALUE of a config
    remark: str | None = None  # on frames that were chosen; None where recordings tell them

    @property
    def parts(self) -> list[Estimates]:
        """Estimates of the parts of all recordings."""
        return [part for parts in self.recordings for part in parts]

    @property
    def source(self) -> str:
        """Data that the config was fitted to, in words."""
        return f"{len(self.parts)} parts of recordings"

    @property
    def snr_db(self) -> Float:
        """SNR of each recording in which somebody moves, dB.

        It is the power mean over pulses, as `snr_db` of a config is of a simulated recording.
        """
        snr = np.array([_mean_snr(parts) for parts in self.recordings])
        return np.asarray(10 * np.log10(snr[snr > 0]))

    @property
    def floor_db(self) -> Float:
        """Noise floor relative to its median [K]; a lower quartile over parts leaves people out."""
        floor = np.quantile([part.floor for part in self.parts], QUARTILE, axis=0)
        return np.asarray(10 * np.log10(floor / np.median(floor)))

    @property
    def doubt(self) -> str | None:
        """Note on parts whose ranges are not used, as the track may be lost, or None."""
        walked = [part for part in self.parts if part.snr > 0]
        doubtful = sum(not part.ranges.size for part in walked)
        if self.ranges is None or not doubtful:
            return None
        left_out = (
            f"ranges of {doubtful} of {len(walked)} parts are left out, as the torso's track "
        )
        config_has_none = "; motion.place.range_m is not fitted" if doubtful == len(walked) else ""
        return f"{left_out}is unsure{config_has_none}"

    @property
    def notes(self) -> list[str]:
        """Notes on what was chosen or left out."""
        return [note for note in (self.remark, self.doubt) if note is not None]

    def numbers(self) -> dict[str, float]:
        """Summary of the estimates, and the noise floor, for which the config has no key.

        noise_floor_db is the variance of a raw sample as recorded; noise_over_range_db is the rise
        of the floor from the nearest range bin to the farthest (Theil-Sen slope).
        """
        from scipy.stats import theilslopes  # slow to import

        numbers = {
            "parts": len(self.parts),
            "snr_db": float(np.median(self.snr_db)),
            "noise_floor_db": 10 * float(np.log10(np.median([p.noise for p in self.parts]))),
        }
        if self.ranges is not None:
            floor = self.floor_db
            slope = float(theilslopes(floor, np.linspace(0, 1, floor.size)).slope)
            numbers["noise_over_range_db"] = slope
        return numbers

    def draw(self, path: Path) -> None:
        """Write a figure of the noise floor over range, if there are ranges, and of the SNRs."""
        figure = page(10.0, 3.5)
        axes = figure.subplots(1, 1 if self.ranges is None else 2, squeeze=False)
        *floors, snrs = axes[0]
        for floor in floors:
            floor.plot(self.ranges, self.floor_db, label="measured")
            floor.axhline(
                0, color="k", linestyle="--", linewidth=0.8, label="fitted: the same everywhere"
            )
            floor.set(xlabel="range (m)", ylabel="noise floor (dB over its median)")
            floor.legend()
        snr, quantity = self.snr_db, "SNR of a raw sample (dB)"
        if snr.size < LEAST_IN_BARS:
            snrs.plot(np.arange(snr.size) + 1, snr, "o", label="of each recording")
            snrs.axhline(snr.mean(), color="k", linestyle="--", label="mean")
            snrs.set(xlabel="recording", ylabel=quantity, xticks=np.arange(snr.size) + 1)
            snrs.set_xlim(0.5, snr.size + 0.5)
        else:
            snrs.hist(snr, bins=min(20, snr.size // 2), label="of each recording")
            snrs.axvline(snr.mean(), color="k", linestyle="--", label="mean")
            snrs.set(xlabel=quantity, ylabel="recordings")
        snrs.legend()
        write_figure(figure, path, 90)

    @cached_property
    def document(self) -> dict[str, Any]:
        """Config of the estimates, as plain values by key.

        Raises:
            ConfigError: it is none, with what the overrides say.
        """
        snr = self.snr_db
        middle = round(float(snr.mean()), 2)
        spread = round(float(snr.std()), 2) if snr.size >= MIN_SNRS else 0
        document: dict[str, Any] = {
            "duration_s": round(self.seconds, 6),
            "radar": dict(self.radar),
            "snr_db": {"normal": [middle, spread]} if spread > 0 else middle,
        }
        radar = read_radar(self.radar)
        if has_beam(radar):  # which has taken its part of the measured echo
            document["snr_reference"] = "received"
        if self.radar.get("output") == "rf":  # whose real samples have no other map as they are
            document["maps"] = ["rtm"]
        ranges = np.concatenate([part.ranges for part in self.parts])
        if ranges.size:
            low, high = (np.percentile(ranges, [5, 95]) + place_of(radar)).round(2).tolist()
            distance: Any = {"uniform": [low, high]} if high > low else low
            document["motion"] = {"place": {"range_m": distance}}
        return with_overrides(document, self.overrides)


def fit(paths: Sequence[Path], overrides: Sequence[str] = ()) -> Fit:
    """Estimate radar, SNR, ranges and noise floor from recordings of one radar.

    Args:
        paths: the recordings.
        overrides: KEY=VALUE of the config; those of `radar` say what recordings do not, such as
            where receivers stand.

    Raises:
        CaptureError: radars differ, recordings are too short, nobody moves in them, or no config
            has their radar.
        ConfigError: an override cannot be used.
    """
    radar, seconds, remark = _common_radar(paths, overrides)
    is_whole = keeps_whole_band(radar)
    recordings = [[*parts_of(path, is_whole)] for path in paths]
    if not any(_mean_snr(parts) > 0 for parts in recordings):
        raise CaptureError(f"{paths[0]}: nobody moves faster than {SLOW_MPS} m/s in any recording")
    others = [text for text in overrides if not text.strip().startswith("radar.")]
    fitted = Fit(recordings, radar, _ranges_of(paths[0], is_whole), seconds, others, remark)
    validated(Config, fitted.document, str(paths[0]), {})
    return fitted


def _common_radar(
    paths: Sequence[Path], overrides: Sequence[str]
) -> tuple[dict[str, Any], float, str | None]:
    """Section `radar` of all recordings, their median duration, s, and a remark on its frames."""
    radar: dict[str, Any] | None = None
    remark: str | None = None
    first_kind = ""
    says_chirps = any("radar.frame.chirps" in text for text in overrides)
    seconds = []
    for path in paths:
        with Recording(path) as recording:
            kind = ("real", "complex")[recording.samples.parts - 1]
            first_kind = first_kind or kind
            if kind != first_kind:
                raise CaptureError(
                    f"{path}: has {kind} samples; should have {first_kind} ones, as {paths[0]}: "
                    "a config has one kind"
                )
            section = radar_of_recording(recording, overrides)
            radar = section if radar is None else radar
            if difference := differing_key(section, radar):
                raise CaptureError(f"{path}: differs in radar from {paths[0]}: {difference}")
            seconds.append(_seconds_of(recording.segments))
            if not says_chirps:
                remark = remark or describe_chosen_frames(recording, section)
    if max(seconds) < MIN_S:
        raise CaptureError(
            f"{paths[0]}: the longest recording lasts {max(seconds):.3g} s; should last at least "
            f"{MIN_S:g} s"
        )
    assert radar is not None
    return radar, float(np.median(seconds)), remark


def _seconds_of(segments: PulseTimes) -> float:
    """Duration of a recording, s, with the pause after its last frame if that is whole."""
    frames = frames_in(segments)
    if frames is None or segments.lengths[-1] < frames.pulses:
        return segments.duration
    return float(segments.start[-1] - segments.start[0]) + frames.period_s


def _ranges_of(path: Path, is_whole: bool) -> Float | None:
    """Ranges of the bins of a recording [K], m; None of slow time."""
    with Recording(path) as recording:
        if isinstance(recording.info.content, SlowTime):
            return None
        content = recording.info.ranging
        if is_whole and isinstance(content, Beat):
            content = replace(content, is_whole=True)
        return content.waveform(1.0).range_axis()


def _mean_snr(parts: Sequence[Estimates]) -> float:
    """SNR of a recording of which these are the parts: their power mean; 0 where nobody moves.

    Of slow movement nothing tells whether it is a person's, so its part is left out.
    """
    known = [part for part in parts if not np.isnan(part.snr)]
    pulses = sum(part.pulses for part in known)
    return sum(part.snr * part.pulses for part in known) / max(pulses, 1)


def parts_of(path: Path, is_whole: bool = False) -> Iterator[Estimates]:
    """Yield estimates from parts of equal duration that cover a recording, of PART_S or more.

    Parts without noise, or without a complete pulse, are left out.

    Args:
        path: the recording.
        is_whole: whether the radar has ranges in both halves of the band, whatever the import
            found.
    """
    with Recording(path) as recording:
        content = recording.info.content
        if is_whole and isinstance(content, Beat):
            content = replace(content, is_whole=True)
        cells = DopplerCells.of_content(content, recording.samples.parts == 2)
        for part in _parts(recording):
            if part.lost.all():
                continue
            estimates = _part(_bins(part, cells), part.segments, cells)
            if estimates.noise > 0:
                yield estimates


def _parts(recording: Recording) -> Iterator[RecordingPart]:
    """Yield the parts of a recording, which hold all its pulses but a few between long gaps."""
    segments, receivers = recording.segments, _first_receivers(recording)
    times = segments.times(np.arange(segments.pulses))
    count = max(int(segments.duration / PART_S), 1)
    begins = times[0] + segments.duration / count * np.arange(count)
    for first, stop in pairwise([*np.searchsorted(times, begins).tolist(), times.size]):
        if stop - first >= MIN_FRAME_PULSES:
            yield part_of_pulses(recording, receivers, first, stop)


def _first_receivers(recording: Recording) -> list[int]:
    """Numbers of the first receiver of each transmitter, whose powers may differ."""
    delays = recording.info.receiver_delay_s
    return [number for number, delay in enumerate(delays) if delay not in delays[:number]]


@dataclass(frozen=True)
class DopplerCells:
    """Cells of range-Doppler maps of a recording, with their gains of noise and of an echo."""

    f0: float  # frequency at which Doppler is read, Hz
    prf: float  # pulses per second, Hz
    waveform: Waveform | None  # None of slow time
    is_tapered: bool  # whether Hann's window is laid over range
    is_real: bool  # whether samples of profiles are real
    noise: float  # power of a bin of white noise of variance 1
    signal: float  # power of all bins of a path of P_s = 1

    @classmethod
    def of_content(cls, content: Content, is_iq: bool) -> "DopplerCells":
        """Cells of a recording of a content.

        Args:
            is_iq: whether samples are complex.
        """
        if isinstance(content, SlowTime):
            return cls(content.carrier_hz, content.prf_hz, None, False, False, 1.0, 1.0)
        w = content.waveform(1.0)
        if isinstance(content, Beat):
            # Real samples are the real part of echo and noise, of half the noise's variance; in the
            # half band a quarter of the echo's power is left.
            share = 1.0 if is_iq else 0.5
            gains = HANN_GAIN * w.n_adc, share * HANN_GAIN * w.n_adc**2
            return cls(w.f0, w.prf, w, True, False, *gains)
        assert isinstance(w, Impulse)
        spread = w.width * sqrt(pi) * SPEED_OF_LIGHT / (2 * w.range_step)  # sum_k g(t_k)^2
        parts = 1.0 if is_iq else 2.0  # an analytic signal has twice the power
        return cls(w.f0, w.prf, w, False, not is_iq, parts, parts * spread)


def _track(bins: Complex, segments: PulseTimes, waveform: Waveform) -> TorsoTrack | None:
    """Track the torso in range bins [receiver, K, M], from which their median is taken.

    A strong echo that comes for a while into a bin is part of the mean there, which would remain
    in all other pulses: a ghost that is stronger than a person far away.
    """
    for receiver in bins:  # one at a time, as a median takes a copy
        receiver.real -= np.median(receiver.real, axis=-1, keepdims=True)
        receiver.imag -= np.median(receiver.imag, axis=-1, keepdims=True)
    return track_torso(bins, segments, waveform)


def _bins(part: RecordingPart, cells: DopplerCells) -> Complex:
    """Range bins [receiver, K, M] of a part, real profiles as analytic ones."""
    if cells.waveform is None:
        samples = slow_time_of_part(part)
    else:
        samples = bins_of_part(part, part.recording.info.ranging, cells.waveform)
    return analytic(samples) if cells.is_real else samples


def _part(bins: Complex, segments: PulseTimes, cells: DopplerCells) -> Estimates:
    """Estimate SNR, ranges and floor from range bins [receiver, K, M], which are overwritten."""
    track = None if cells.waveform is None else _track(bins, segments, cells.waveform)
    bins -= bins.mean(axis=-1, keepdims=True)
    maps, middle, window_power = _range_doppler(bins, segments, cells)
    length, white = maps.shape[2], cells.noise * window_power
    # The mean of |.|^2 of noise over R receivers has a gamma distribution. The lower quartile of a
    # frame contains little of the person, and the median over frames little of those in which a
    # person fills the bin.
    floor = np.median(np.quantile(maps, QUARTILE, axis=2), axis=0)
    receivers = len(bins)
    quartile = float(gammaincinv(receivers, QUARTILE)) / receivers
    nobody = Estimates(0.0, np.empty(0), floor / (quartile * white), segments.pulses)
    near = np.ones(maps.shape[:2], bool)
    ranges: Float = np.empty(0)
    if cells.waveform is not None and track is None:
        return nobody
    if cells.waveform is not None and track is not None:
        of_frame = track.range_at(segments.times(middle))[:, None]
        reach = REACH_M + 2 * cells.waveform.range_step
        near = np.abs(cells.waveform.range_axis() - of_frame) <= reach
        ranges = track.range[track.is_sure] if track.is_reliable else ranges
    if not nobody.noise > 0:
        return nobody
    # Curtains and fans move slowly, and would be mistaken for a person; where pulses are too few
    # per second to show it, all that moves counts.
    slowest_hz = (
        SLOW_MPS * 2 * cells.f0 / SPEED_OF_LIGHT + 2 * cells.prf / length
    )  # beside Hann's main lobe
    fast = np.abs(np.fft.fftfreq(length, 1 / cells.prf)) > slowest_hz
    cell = nobody.noise * white
    signal = _power_near(maps.sum(axis=2), near, cell * length)
    fast_signal = _power_near(maps[:, :, fast].sum(axis=2), near, cell * np.count_nonzero(fast))
    is_fast = not fast.any() or fast_signal > FAST_SHARE * signal
    if signal <= 0:
        return nobody
    if not is_fast:
        return nobody._replace(snr=np.nan)
    snr = signal / (length * window_power * cells.signal) / nobody.noise
    return nobody._replace(snr=snr, ranges=ranges)


def _range_doppler(
    moving: Complex, segments: PulseTimes, cells: DopplerCells
) -> tuple[Float, Index, float]:
    """Power [frame, bin, Doppler], the pulse in the middle of each frame, and the window's power.

    The power is the mean over the receivers. Frames cross no gap. The window's power is
    sum_m w[m]^2.
    """
    length = min(max(round(WINDOW_S * cells.prf), 8), int(segments.lengths.max()))
    window = np.hanning(length + 2)[1:-1]
    starts = Frames(length, length).starts(segments.slices)
    frames = [moving[..., at : at + length] for at in starts.tolist()]
    tapered = [hann_in_range(frame) for frame in frames] if cells.is_tapered else frames
    spectra = (scipy.fft.fft(frame * window, axis=2) for frame in tapered)
    maps = np.stack([np.mean(np.abs(x) ** 2, axis=0) for x in spectra])
    return maps, starts + length // 2, float(np.sum(window**2))


def _power_near(power: Float, near: Bool, noise: float) -> float:
    """Mean power of a frame in the bins near the torso, less the median of its other bins.

    Args:
        power: power of the moving echo [frame, bin].
        near: whether a bin is near the torso [frame, bin].
        noise: power of white noise in a bin, for frames in which all bins are near.
    """
    signal = 0.0
    for bins, inside in zip(power, near, strict=True):
        floor = noise if inside.all() else float(np.median(bins[~inside]))
        signal += float(np.sum(bins[inside] - floor))
    return signal / len(power)
