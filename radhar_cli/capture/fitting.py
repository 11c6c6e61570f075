"""Estimate a config to simulate by from recordings.

A receiver's noise is the floor of its range-Doppler maps; the person is what moves above it. With
range bins S_k = sum_n s[n] exp(...) of N samples, white noise of variance sigma^2 has |S_k|^2 =
N sigma^2 and a path of amplitude A has sum_k |S_k|^2 = N^2 A^2: SNR = P_s/sigma^2 as in model.md.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import scipy.fft

from radhar_cli.arrays import Complex, Float
from radhar_cli.capture.chain import bins_of_part, pulses_between
from radhar_cli.capture.recording import Recording
from radhar_cli.capture.tracking import WINDOW_S, track_torso, without_static
from radhar_cli.config.reading import validated
from radhar_cli.config.schema import Config
from radhar_cli.errors import CaptureError
from radhar_cli.processing.torso_track import hann_in_range
from radhar_cli.radar.waveform import SPEED_OF_LIGHT, Waveform

PART_S = 4.0  # of a recording that gives one SNR
MAX_PARTS = 50  # of a recording
FEW = 3  # SNRs from which on a spread is fitted
SURE = 0.5  # confidence of the track from which its range counts
SLOW_MPS = 0.15
QUARTILE = 0.25
HANN_GAIN = 0.5**2 + 2 * 0.25**2  # of white noise, by hann_in_range


class Part(NamedTuple):
    """Estimates from a few seconds of a recording.

    Attributes:
        snr_db: of what moves, per raw sample.
        ranges: of the torso where it is surely found, m.
        floor: of the noise in each range bin, as variance of a raw sample [K].
        static_db: what stands still over what moves.
        zero_line_db: of the clutter's slow movement, |v| < 0.15 m/s, over the floor, in the bins of
            the person; after the mean was taken out.
    """

    snr_db: float
    ranges: Float
    floor: Float
    static_db: float
    zero_line_db: float


@dataclass(frozen=True)
class Fit:
    """Estimates from all recordings.

    Attributes:
        document: keys of a config.
        parts: what it rests on.
        waveform: of all.
    """

    document: dict[str, Any]
    parts: list[Part]
    waveform: Waveform

    @property
    def floor_db(self) -> Float:
        """Noise floor over its median [K], of parts in which nobody stands in that bin."""
        floor = np.quantile([part.floor for part in self.parts], QUARTILE, axis=0)
        decibels: Float = 10 * np.log10(floor / np.median(floor))
        return decibels

    @property
    def slope_db(self) -> float:
        """Of the noise floor from the nearest range bin to the farthest (Theil and Sen's)."""
        from scipy.stats import theilslopes

        floor = self.floor_db
        return float(theilslopes(floor, np.linspace(0, 1, floor.size)).slope)

    def numbers(self) -> dict[str, float]:
        """What no key of a config says yet, and what the keys rest on."""
        median = {
            key: float(np.median([getattr(part, key) for part in self.parts]))
            for key in ("snr_db", "static_db", "zero_line_db")
        }
        return {"parts": len(self.parts), **median, "noise_slope_db": self.slope_db}


def fit(paths: Sequence[Path]) -> Fit:
    """Read waveform, SNR and ranges off recordings of one radar.

    Raises:
        CaptureError: they are of different radars, slow time, or nothing moves in any.
        FolderError: one is not a recording.
    """
    parts: list[Part] = []
    waveform: Waveform | None = None
    seconds = []
    for path in paths:
        with Recording(path) as recording:
            one = recording.info.waveform()
            if waveform is not None and _differs(one, waveform):
                raise CaptureError(f"{path}: is of another radar than {paths[0]}")
            waveform = waveform or one
            seconds.append(recording.segments.duration)
            parts += _parts(recording)
    assert waveform is not None
    if not parts:
        raise CaptureError(f"{paths[0]}: nothing moves above the noise in any of the recordings")
    document = _document(waveform, parts, float(np.median(seconds)))
    validated(Config, document, str(paths[0]), {})
    return Fit(document, parts, waveform)


def _differs(one: Waveform, other: Waveform) -> bool:
    keys = ("fc", "bandwidth", "chirp", "adc_rate", "prf")
    return any(abs(getattr(one, k) / getattr(other, k) - 1) > 1e-3 for k in keys)


def _parts(recording: Recording) -> list[Part]:
    """Parts of about PART_S, at most MAX_PARTS, spread over a recording."""
    length = recording.segments.duration
    count = max(int(length / PART_S), 1)
    starts = np.linspace(0, max(length - PART_S, 0), min(count, MAX_PARTS))
    parts = []
    for start in starts.tolist():
        stop = min(start + PART_S, length)
        first, last, segments = pulses_between(recording, start, stop)
        waveform = recording.info.waveform()
        bins = bins_of_part(recording, waveform, [0], first, last)
        part = _part(bins, segments, waveform)
        if part is not None:
            parts.append(part)
    return parts


def _part(bins: Complex, segments: Any, w: Waveform) -> Part | None:
    moving = without_static(bins)
    track = track_torso(moving, segments, w)
    if track is None:
        return None
    length = min(max(round(WINDOW_S * w.prf), 8), int(segments.lengths.max()))
    window = np.hanning(length + 2)[1:-1]
    power = []
    for first, count in zip(segments.first.tolist(), segments.lengths.tolist(), strict=True):
        for at in range(first, first + count - length + 1, length):
            part = hann_in_range(moving[0, :, at : at + length])  # no sidelobes far off
            spectrum = scipy.fft.fft(part * window, axis=1)
            power.append(np.abs(spectrum) ** 2)
    maps = np.stack(power)  # [frame, bin, Doppler]
    # |.|^2 of noise is exponential; the lower quartile of a frame has little of the person in it,
    # and the median over frames little of those in which a person fills the bin.
    white = HANN_GAIN * w.n_adc * float(np.sum(window**2))
    floor = np.median(np.quantile(maps, QUARTILE, axis=2), axis=0)
    floor /= -np.log(1 - QUARTILE) * white
    noise = float(np.quantile(floor, QUARTILE))
    signal = np.mean(np.sum(np.abs(moving[0]) ** 2, axis=0)) - w.n_bins * w.n_adc * noise
    signal /= w.n_adc**2
    if not signal > 0 or not noise > 0:
        return None
    sure = track.confidence >= SURE
    near = np.abs(w.range_axis() - np.median(track.range)) <= 1.0
    still = np.sum(np.abs(bins[0].mean(axis=1)) ** 2) / w.n_adc**2
    slow = int(SLOW_MPS * 2 * w.f0 / SPEED_OF_LIGHT * length / w.prf)
    rows = np.r_[0 : slow + 1, length - slow : length] if slow else np.array([0])
    zero = maps[:, near][:, :, rows].mean() / (noise * white)
    return Part(
        10 * float(np.log10(signal / noise)),
        track.range[sure],
        floor,
        10 * float(np.log10(max(still / signal, 1e-30))),
        10 * float(np.log10(zero)),
    )


def _document(w: Waveform, parts: list[Part], seconds: float) -> dict[str, Any]:
    snr = np.array([part.snr_db for part in parts])
    ranges = np.concatenate([part.ranges for part in parts])
    middle, spread = round(float(snr.mean()), 2), round(float(snr.std()), 2)
    radar = {
        "carrier_hz": w.fc,
        "bandwidth_hz": w.bandwidth,
        "chirp_s": w.chirp,
        "adc_rate_hz": w.adc_rate,
        "prf_hz": w.prf,
    }
    document: dict[str, Any] = {
        "duration_s": round(seconds, 3),
        "radar": {key: float(f"{value:.9g}") for key, value in radar.items()},
        "snr_db": {"normal": [middle, spread]} if snr.size >= FEW and spread > 0 else middle,
    }
    if ranges.size:
        low, high = np.percentile(ranges, [5, 95]).round(2).tolist()
        document["motion"] = {"range_m": {"uniform": [low, high]} if high > low else low}
    return document


def draw(fit: Fit, path: Path) -> None:
    """Write the figure: noise over range and SNRs, measured beside fitted."""
    from radhar_cli.figures.page import page

    figure = page(10.0, 4.0)
    left, right = figure.subplots(1, 2)
    ranges = fit.waveform.range_axis()
    left.plot(ranges, fit.floor_db, label="measured")
    left.axhline(0, color="k", linestyle="--", linewidth=0.8, label="fitted: white")
    left.set(xlabel="range (m)", ylabel="noise floor (dB over its median)")
    left.legend()
    snr = np.array([part.snr_db for part in fit.parts])
    right.hist(snr, bins=min(20, max(3, snr.size // 2)), density=True, label="measured")
    if snr.size >= FEW and snr.std() > 0:
        at = np.linspace(snr.min() - 3, snr.max() + 3, 200)
        bell = np.exp(-(((at - snr.mean()) / snr.std()) ** 2) / 2)
        right.plot(at, bell / (snr.std() * np.sqrt(2 * np.pi)), "k--", label="fitted: normal")
    else:
        right.axvline(snr.mean(), color="k", linestyle="--", label="fitted: constant")
    right.set(xlabel="SNR of a raw sample (dB)", ylabel="density")
    right.legend()
    figure.savefig(path, dpi=90)
