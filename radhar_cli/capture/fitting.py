"""Estimate a config to simulate by from recordings.

A receiver's noise is the floor of its range-Doppler maps; the person is what moves above it. What
stands in the room is measured against the person, whose cross section is taken to be that of the
model: sigma_r = sigma_p (A_r R_r^2)^2/(A_p R_p^2)^2.
"""

import warnings
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.capture.fit_parts import SLOW_MPS, Part, excerpts, part_of
from radhar_cli.capture.noise_spectrum import (
    WHITE,
    WINDOW_S,
    Colour,
    FoundLine,
    NoiseSpectrum,
    OnOff,
    colour,
    lines,
)
from radhar_cli.capture.recording import Recording
from radhar_cli.capture.room_returns import (
    BLOCK_S,
    MAIN_LOBE,
    QUARTILE,
    Return,
    Returns,
    peaks,
    range_window,
)
from radhar_cli.config.number import nominal
from radhar_cli.config.reading import validated
from radhar_cli.config.schema import MAX_REFLECTORS, Config
from radhar_cli.errors import CaptureError
from radhar_cli.motion.skeleton import cross_sections, default_weight
from radhar_cli.radar.propagation import amplitude
from radhar_cli.radar.waveform import SPEED_OF_LIGHT, Waveform

FEW = 3  # SNRs from which on a spread is fitted
PAIR_HZ, PAIR_DB = 0.2, 3.0  # twice the error of a line
MAX_SNR_DB = 100.0  # beyond which the floor is rounding, whose spectrum says nothing
MIN_S = 0.5  # of the longest recording; somebody has to move in it
LEAKAGE_BINS = 3  # the nearest, in which the antennas' leakage lies


@dataclass(frozen=True)
class Fit:
    """Estimates from all recordings.

    Attributes:
        parts: what it rests on.
        waveform: of all.
        seconds: that half of the recordings last at least.
        spectrum: of the noise.
        colour: fitted to it.
        lines: found in it.
        room: returns of all parts, powers over the noise.
        reflectors: found in it.
        leakage: between the antennas, power over the noise of a raw sample, or at most so much.
    """

    parts: list[Part]
    waveform: Waveform
    seconds: float
    spectrum: NoiseSpectrum
    colour: Colour
    lines: list[FoundLine]
    room: Returns
    reflectors: list[Return]
    leakage: float

    @property
    def floor_db(self) -> Float:
        """Noise floor over its median [K], of parts in which nobody stands in that bin."""
        floor = np.quantile([part.floor for part in self.parts], QUARTILE, axis=0)
        decibels: Float = 10 * np.log10(floor / np.median(floor))
        return decibels

    @property
    def snr_db(self) -> Float:
        """Of the parts in which somebody moves, over the white noise."""
        snr = np.array([part.snr_db for part in self.parts])
        finite: Float = snr[np.isfinite(snr)]
        return finite - 10 * float(np.log10(self.colour.white))

    @property
    def slope_db(self) -> float:
        """Of the noise floor from the nearest range bin to the farthest (Theil and Sen's)."""
        from scipy.stats import theilslopes

        floor = self.floor_db
        return float(theilslopes(floor, np.linspace(0, 1, floor.size)).slope)

    def numbers(self) -> dict[str, float]:
        """What the keys rest on, and what no key says.

        static_db is what stands still over what moves; zero_line_db slow movement, |v| < 0.15 m/s,
        over the white noise where nobody is; noise_over_range_db how much noise rises with range.
        """
        zero = self.spectrum.slow_db(SLOW_MPS * 2 * self.waveform.f0 / SPEED_OF_LIGHT)
        return {
            "parts": len(self.parts),
            "snr_db": float(np.median(self.snr_db)),
            "static_db": float(np.nanmedian([part.static_db for part in self.parts])),
            **({} if zero is None else {"zero_line_db": zero}),
            "noise_corner_hz": self.colour.corner,
            "lines": len(self.lines),
            "reflectors": len(self.reflectors),
            "noise_over_range_db": self.slope_db,
        }

    @cached_property
    def document(self) -> dict[str, Any]:
        """Keys of a config."""
        w, snr, usual = self.waveform, self.snr_db, Config()
        ranges = np.concatenate([part.ranges for part in self.parts])
        middle, spread = round(float(snr.mean()), 2), round(float(snr.std()), 2)
        radar = {
            "carrier_hz": w.fc,
            "bandwidth_hz": w.bandwidth,
            "chirp_s": w.chirp,
            "adc_rate_hz": w.adc_rate,
            "prf_hz": w.prf,
        }
        tx, rx = (np.array([nominal(x) for x in p]) for p in (usual.radar.tx_m, usual.radar.rx_m))
        place, apart = (tx + rx) / 2, float(np.linalg.norm(tx - rx))
        document: dict[str, Any] = {
            "duration_s": round(self.seconds, 3),
            "radar": {key: float(f"{value:.9g}") for key, value in radar.items()},
            "snr_db": {"normal": [middle, spread]} if snr.size >= FEW and spread > 0 else middle,
        }
        if ranges.size:
            low, high = (np.percentile(ranges, [5, 95]) + place[0]).round(2).tolist()
            document["motion"] = {"range_m": {"uniform": [low, high]} if high > low else low}
        # Cross section of unit power at unit range, both over the noise.
        height = nominal(usual.subject.height_m)
        body = float(cross_sections(height, default_weight(height)).sum())
        unit = body * float(
            np.nanmedian([part.spreading / 10 ** (part.snr_db / 10) for part in self.parts])
        )
        if self.leakage > 0:
            gain = 10 ** (nominal(usual.radar.antenna_gain_dbi) / 10)
            one = np.ones(1)
            a = float(amplitude(one, one, self.leakage * unit * one, gain, w.wavelength)[0])
            document["radar"]["antenna_isolation_db"] = round(-20 * float(np.log10(a)), 1)
        if self.reflectors:
            document["room"] = {
                "reflectors": [_reflector(one, unit, place, apart) for one in self.reflectors]
            }
        receiver: dict[str, Any] = {}
        if self.colour.corner > 0:
            receiver["noise_corner_hz"] = float(f"{self.colour.corner:.4g}")
            receiver["noise_slope_db"] = round(self.colour.slope, 1)
        if self.lines:
            receiver["tones"] = line_keys(self.lines)
        if receiver:
            document["receiver"] = receiver
        return document


def fit(paths: Sequence[Path]) -> Fit:
    """Read waveform, SNR, ranges, noise and what stands in the room off recordings of one radar.

    Raises:
        CaptureError: one holds what another does or is of another radar, they are slow time or too
            short, or nobody moves in any.
        FolderError: one is not a recording.
    """
    waveform, seconds, length = _waveform(paths)
    spectrum = NoiseSpectrum(length, waveform.prf)
    every: list[Part | None] = []
    for excerpt in excerpts(paths):
        seen = part_of(excerpt)
        every.append(seen and seen[1])
        for moving, away in seen[0].stretches() if seen else ():
            spectrum.add(moving, away)
    parts = [part for part in every if part is not None]
    if not any(np.isfinite(part.snr_db) for part in parts):
        raise CaptureError(
            f"{paths[0]}: nobody is seen to move faster than {SLOW_MPS} m/s in any recording"
        )
    room, found, leakage = _room(parts, waveform)
    for one in found:
        if one.residual > 0:
            beside = np.abs(waveform.range_axis() - one.range)
            spectrum.left_out |= beside < MAIN_LOBE * waveform.range_step
    narrow, coloured = list[FoundLine](), WHITE
    if np.nanmedian([part.snr_db for part in parts]) < MAX_SNR_DB:
        narrow = _with_times(lines(spectrum), paths, every, waveform.prf)
        coloured = colour(spectrum, narrow)
    fitted = Fit(parts, waveform, seconds, spectrum, coloured, narrow, room, found, leakage)
    validated(Config, fitted.document, str(paths[0]), {})
    return fitted


def _with_times(
    found: list[FoundLine], paths: Sequence[Path], parts: list[Part | None], prf: float
) -> list[FoundLine]:
    """Lines, with the times for which they are on and off: the recordings are read once more."""
    if not found:
        return []
    times = [OnOff(line, prf) for line in found]
    for excerpt, part in zip(excerpts(paths), parts, strict=True):
        if part is None:
            continue
        known = excerpt if np.isfinite(part.snr_db) else excerpt.empty()
        for moving, away in known.stretches():
            for one in times:
                one.add(moving, away, part.noise * excerpt.gain)
    return [one.line_with_times() for one in times]


def _waveform(paths: Sequence[Path]) -> tuple[Waveform, float, int]:
    """The chirps of all recordings, how long they last (s), and pulses of a window in any."""
    waveform, seconds, lengths = None, [], []
    known: dict[bytes, Path] = {}
    for path in paths:
        with Recording(path) as recording:
            one = recording.info.waveform()
            if waveform is not None and _differs(one, waveform):
                raise CaptureError(f"{path}: is of another radar than {paths[0]}")
            samples = recording.digest()
            if samples in known:
                raise CaptureError(
                    f"{path}: has the samples of {known[samples]}; a recording counts once"
                )
            known[samples] = path
            waveform = waveform or one
            seconds.append(recording.segments.duration)
            lengths.append(int(recording.segments.lengths.max()))
    if max(seconds) < MIN_S:
        raise CaptureError(
            f"{paths[0]}: the longest recording lasts {max(seconds):.3g} s; it should "
            f"last at least {MIN_S:g} s for somebody to be seen to move"
        )
    assert waveform is not None
    return waveform, float(np.median(seconds)), min(round(WINDOW_S * waveform.prf), *lengths)


def _differs(one: Waveform, other: Waveform) -> bool:
    keys = ("fc", "bandwidth", "chirp", "adc_rate", "prf", "n_adc")
    return any(abs(getattr(one, k) / getattr(other, k) - 1) > 1e-3 for k in keys)


def _room(parts: list[Part], w: Waveform) -> tuple[Returns, list[Return], float]:
    """Returns of all parts together, those that stand out, and the leakage, over the noise."""
    noise = np.array([part.noise for part in parts])[:, None]
    power, residual, highest = (np.array(one) for one in zip(*(p.room for p in parts), strict=True))
    seen, moves = np.isfinite(residual).sum(axis=0), residual > 0
    moving = 2 * moves.sum(axis=0) >= np.maximum(seen, 1)  # in half of the parts that show it
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a bin that is seen in no part is NaN
        room = Returns(
            np.nanmedian(power / noise, axis=0),
            np.where(moving, np.nanmedian(np.where(moves, residual, np.nan), axis=0), 0.0),
            np.nanmedian(highest, axis=0),
        )
    gain = float(np.sum(range_window(w.n_adc) ** 2))
    found = peaks(room, gain / max(round(BLOCK_S * w.prf), 1), w)
    far = [one for one in found if one.range > LEAKAGE_BINS * w.range_step]
    strongest = sorted(far, key=lambda one: -one.power)[:MAX_REFLECTORS]
    leakage = float(np.nanmax(room.power[: LEAKAGE_BINS + 1], initial=0))
    return room, [one for one in far if one in strongest], leakage


def _reflector(one: Return, unit: float, place: Float, apart: float) -> dict[str, Any]:
    """A reflector straight ahead of the antennas, `apart` (m) across the line of sight."""
    ahead = np.sqrt(max(one.range**2 - (apart / 2) ** 2, 0.01))
    rcs = np.clip(10 * np.log10(one.power * unit * one.range**4), -120, 120)
    reflector: dict[str, Any] = {
        "position_m": [round(float(place[0] + ahead), 3), float(place[1]), float(place[2])],
        "rcs_dbsm": round(float(rcs), 1),
        "residual_m": float(f"{min(one.residual, 0.01):.3g}"),
    }
    if one.residual > 0:
        reflector["highest_hz"] = round(min(one.highest, 100.0), 2)
    return reflector


def line_keys(found: list[FoundLine]) -> list[dict[str, Any]]:
    """Keys of the lines; two at opposite Dopplers, equally strong within the errors, are one."""
    left, keys = list(found), []
    while left:
        one = left.pop(0)
        line = _line(one)
        for other in left:
            apart = abs(10 * float(np.log10(other.level / one.level)))
            if abs(one.doppler + other.doppler) < PAIR_HZ and apart < PAIR_DB:
                left.remove(other)
                line["both_sides"] = True
                break
        keys.append(line)
    return keys


def _line(one: FoundLine) -> dict[str, Any]:
    level = round(10 * float(np.log10(one.level)), 1)
    line: dict[str, Any] = {"doppler_hz": round(one.doppler, 3), "level_db": level}
    if one.off > 0:
        line |= {"on_s": float(f"{one.on:.3g}"), "off_s": float(f"{one.off:.3g}")}
    return line
