"""Estimate a simulation config from recordings: waveform, SNR, ranges and noise floor.

A receiver's noise is the floor of its range-Doppler maps; the person is what moves above it. With
range bins S_k = sum_n s[n] exp(...) of N samples, white noise of variance sigma^2 has
|S_k|^2 = N sigma^2 and a path of amplitude A has sum_k |S_k|^2 = N^2 A^2: SNR = P_s/sigma^2 as in
model.md.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import scipy.fft

from radhar_cli.capture.chain import bins_of_part, part_of
from radhar_cli.capture.content import Beat
from radhar_cli.capture.recording import Recording
from radhar_cli.capture.tracking import WINDOW_S, hann_in_range, track_torso, without_static
from radhar_cli.config.data_set import Config
from radhar_cli.config.number import nominal
from radhar_cli.config.radar import FmcwRadar
from radhar_cli.config.reading import validated
from radhar_cli.errors import CaptureError
from radhar_cli.figures.page import page, write_figure
from radhar_cli.numerics.arrays import Bool, Complex, Float, Index
from radhar_cli.processing.frames import Frames
from radhar_cli.radar.fmcw_timing import FmcwTiming
from radhar_cli.radar.pulse_times import PulseTimes
from radhar_cli.radar.waveform import SPEED_OF_LIGHT, Waveform

RADAR = ("carrier_hz", "bandwidth_hz", "chirp_s", "adc_rate_hz", "prf_hz")  # keys that are fitted
TOLERANCE = 1e-3  # relative difference of the numbers of one radar, as clocks differ
MIN_SNRS = 3  # SNRs needed to fit a spread
MIN_S = 0.5  # shortest duration of the longest recording
PART_S = 4.0  # length of a part, which gives one SNR
MAX_PARTS = 50  # parts of a recording
SURE = 0.5  # least confidence of the track at ranges that are used
HANN_GAIN = 0.5**2 + 2 * 0.25**2  # gain of white noise in hann_in_range
QUARTILE = 0.25
SLOW_MPS = 0.15  # slower movement does not count as a person's
FAST_SHARE = 0.02  # least share of a person's power that moves faster
REACH_M = 1.2  # limbs from the torso


class Estimates(NamedTuple):
    """Estimates from a few seconds of a recording."""

    snr_db: float  # moving echo within reach of the torso, per raw sample; NaN if nobody is found
    ranges: Float  # of the torso where its track is reliable, m
    floor: Float  # noise in each range bin, as variance of a raw sample [K]

    @property
    def noise(self) -> float:
        """Variance of the noise of a raw sample: the lower quartile over the range bins."""
        return float(np.quantile(self.floor, QUARTILE))


@dataclass(frozen=True)
class Fit:
    """Estimates from all recordings."""

    parts: list[Estimates]  # the estimates of each part
    timing: FmcwTiming  # common to all recordings
    seconds: float  # median duration of the recordings

    @property
    def snr_db(self) -> Float:
        """SNR of each part in which somebody moves."""
        snr = np.array([part.snr_db for part in self.parts])
        return np.asarray(snr[np.isfinite(snr)])

    @property
    def floor_db(self) -> Float:
        """Noise floor relative to its median [K]; a lower quartile over parts leaves people out."""
        floor = np.quantile([part.floor for part in self.parts], QUARTILE, axis=0)
        return np.asarray(10 * np.log10(floor / np.median(floor)))

    def numbers(self) -> dict[str, float]:
        """Summary of the estimates, and the noise floor, for which the config has no key.

        noise_floor_db is the variance of a raw sample as recorded; noise_over_range_db is the rise
        of the floor from the nearest range bin to the farthest (Theil-Sen slope).
        """
        from scipy.stats import theilslopes  # slow to import

        floor = self.floor_db
        return {
            "parts": len(self.parts),
            "snr_db": float(np.median(self.snr_db)),
            "noise_floor_db": 10 * float(np.log10(np.median([p.noise for p in self.parts]))),
            "noise_over_range_db": float(theilslopes(floor, np.linspace(0, 1, floor.size)).slope),
        }

    @cached_property
    def document(self) -> dict[str, Any]:
        """Config of the estimates, as plain values by key."""
        snr, defaults = self.snr_db, FmcwRadar()
        middle = round(float(snr.mean()), 2)
        spread = round(float(snr.std()), 2) if snr.size >= MIN_SNRS else 0
        document: dict[str, Any] = {
            "duration_s": round(self.seconds, 3),
            "radar": {key: float(f"{getattr(self.timing, key):.9g}") for key in RADAR},
            "snr_db": {"normal": [middle, spread]} if spread > 0 else middle,
        }
        ranges = np.concatenate([part.ranges for part in self.parts])
        if ranges.size:
            antennas = (nominal(defaults.tx_m[0]) + nominal(defaults.rx_m[0])) / 2
            low, high = (np.percentile(ranges, [5, 95]) + antennas).round(2).tolist()
            distance: Any = {"uniform": [low, high]} if high > low else low
            document["motion"] = {"place": {"range_m": distance}}
        return document


def fit(paths: Sequence[Path]) -> Fit:
    """Estimate waveform, SNR, ranges and noise floor from recordings of one radar.

    Raises:
        CaptureError: radars differ, recordings are too short, or nobody moves in them.
    """
    timing, seconds = _timing(paths)
    parts = [part for path in paths for part in parts_of(path)]
    if not any(np.isfinite(part.snr_db) for part in parts):
        raise CaptureError(f"{paths[0]}: nobody moves faster than {SLOW_MPS} m/s in any recording")
    fitted = Fit(parts, timing, seconds)
    validated(Config, fitted.document, str(paths[0]), {})
    return fitted


def _timing(paths: Sequence[Path]) -> tuple[FmcwTiming, float]:
    """Common timing of all recordings, and their median duration, s."""
    timing: FmcwTiming | None = None
    seconds = []
    for path in paths:
        with Recording(path) as recording:
            content = recording.info.content
            if not isinstance(content, Beat):
                raise CaptureError(f"{path}: holds {content.noun}; should be {Beat.noun}")
            timing = timing or content.timing
            if (name := content.timing.first_difference(timing, TOLERANCE)) is not None:
                values = getattr(content.timing, name), getattr(timing, name)
                raise CaptureError(
                    f"{path}: differs in radar from {paths[0]}: {name} = {values[0]:.10g}, not "
                    f"{values[1]:.10g}"
                )
            seconds.append(recording.segments.duration)
    if max(seconds) < MIN_S:
        raise CaptureError(
            f"{paths[0]}: the longest recording lasts {max(seconds):.3g} s; should last at least "
            f"{MIN_S:g} s"
        )
    assert timing is not None
    return timing, float(np.median(seconds))


def refuse_frames_and_receivers(path: Path) -> None:
    """Refuse a recording of frames or of several receivers: the radar of a fitted config has none.

    Raises:
        CaptureError: says what would differ, and what to do.
    """
    with Recording(path) as recording:
        info, segments = recording.info, recording.segments
    differences = []
    period = float(np.median(np.diff(segments.start))) if len(segments) > 1 else 0.0
    is_regular = np.allclose(np.diff(segments.start), period, rtol=0.01)
    if len(segments) > 1 and is_regular and np.ptp(segments.lengths[:-1]) == 0:
        pulses = segments.lengths[0]
        differences.append(
            f"{len(segments)} frames of {pulses:g} pulses every {period * 1e3:.4g} ms (fitted: "
            "pulses without a pause)"
        )
    if info.receivers > 1:
        differences.append(f"{info.receivers} receivers (fitted: one)")
    if differences:
        raise CaptureError(
            f"{path}: has {' and '.join(differences)}, which fit does not keep: "
            "write a config by hand, whose radar has these frames and this array"
        )


def parts_of(path: Path) -> Iterator[Estimates]:
    """Yield estimates from parts of about PART_S, at most MAX_PARTS, spread over a recording.

    Parts without noise, or without a complete pulse, are left out.
    """
    with Recording(path) as recording:
        content, length = recording.info.ranging, recording.segments.duration
        w = recording.info.waveform()
        count = min(max(int(length / PART_S), 1), MAX_PARTS)
        for start in np.linspace(0, max(length - PART_S, 0), count).tolist():
            part = part_of(recording, start, min(start + PART_S, length), receiver=0)
            if part.lost.all():
                continue
            bins = bins_of_part(part, content, w)[0]
            estimates = _part(without_static(bins), part.segments, w)
            if estimates.noise > 0:
                yield estimates


def _part(moving: Complex, segments: PulseTimes, w: Waveform) -> Estimates:
    """Estimate SNR, ranges and floor from range bins [K, M] with static echoes removed."""
    maps, middle, white = _range_doppler(moving, segments, w)
    length = maps.shape[2]
    # |.|^2 of noise is exponential; the lower quartile of a frame contains little of the person,
    # and the median over frames little of those in which a person fills the bin.
    floor = np.median(np.quantile(maps, QUARTILE, axis=2), axis=0)
    nobody = Estimates(np.nan, np.empty(0), floor / (-np.log(1 - QUARTILE) * white))
    track = track_torso(moving[None], segments, w)
    if track is None or not nobody.noise > 0:
        return nobody
    range_of_frame = track.range_at(segments.times(middle))
    near = np.abs(w.range_axis() - range_of_frame[:, None]) <= REACH_M + 2 * w.range_step
    # Curtains and fans move slowly, and would be mistaken for a person.
    slowest_hz = (
        SLOW_MPS * 2 * w.f0 / SPEED_OF_LIGHT + 2 * w.prf / length
    )  # beside Hann's main lobe
    fast = np.abs(np.fft.fftfreq(length, 1 / w.prf)) > slowest_hz
    cell = nobody.noise * white
    signal = _power_near(maps.sum(axis=2), near, cell * length)
    fast_signal = _power_near(maps[:, :, fast].sum(axis=2), near, cell * np.count_nonzero(fast))
    if not (signal > 0 and fast_signal > FAST_SHARE * signal):
        return nobody
    snr = signal / (length * white * w.n_adc) / nobody.noise
    reliable_ranges = track.range[track.confidence >= SURE]
    return nobody._replace(snr_db=10 * float(np.log10(snr)), ranges=reliable_ranges)


def _range_doppler(
    moving: Complex, segments: PulseTimes, w: Waveform
) -> tuple[Float, Index, float]:
    """Power [frame, bin, Doppler], the pulse in the middle of each frame, and the noise's gain.

    Frames cross no gap. The gain is the power in a cell of white noise of variance 1.
    """
    length = min(max(round(WINDOW_S * w.prf), 8), int(segments.lengths.max()))
    window = np.hanning(length + 2)[1:-1]
    starts = Frames(length, length).starts(segments.slices)
    frames = (hann_in_range(moving[:, at : at + length]) * window for at in starts.tolist())
    maps = np.stack([np.abs(scipy.fft.fft(frame, axis=1)) ** 2 for frame in frames])
    return maps, starts + length // 2, HANN_GAIN * w.n_adc * float(np.sum(window**2))


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


def draw(fit: Fit, path: Path) -> None:
    """Write a figure of the noise floor over range, and of the SNRs of the parts."""
    figure = page(10.0, 3.5)
    floor, snrs = figure.subplots(1, 2)
    floor.plot(fit.timing.waveform(fit.seconds).range_axis(), fit.floor_db, label="measured")
    floor.axhline(0, color="k", linestyle="--", linewidth=0.8, label="fitted: the same everywhere")
    floor.set(xlabel="range (m)", ylabel="noise floor (dB over its median)")
    floor.legend()
    snr = fit.snr_db
    snrs.hist(snr, bins=min(20, max(3, snr.size // 2)), label="measured")
    snrs.axvline(snr.mean(), color="k", linestyle="--", label="mean")
    snrs.set(xlabel="SNR of a raw sample (dB)", ylabel="parts")
    snrs.legend()
    write_figure(figure, path, 90)
