"""Estimate a config to simulate by from recordings: waveform, SNR, ranges and noise floor.

A receiver's noise is the floor of its range-Doppler maps; the person is what moves above it.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.capture.fit_parts import QUARTILE, SLOW_MPS, Part, parts_of
from radhar_cli.capture.recording import Recording
from radhar_cli.config.number import nominal
from radhar_cli.config.reading import validated
from radhar_cli.config.schema import Config
from radhar_cli.errors import CaptureError
from radhar_cli.radar.waveform import Waveform

RADAR = {  # key: attribute of a waveform
    "carrier_hz": "fc",
    "bandwidth_hz": "bandwidth",
    "chirp_s": "chirp",
    "adc_rate_hz": "adc_rate",
    "prf_hz": "prf",
}
FEW = 3  # SNRs from which on a spread is fitted
MIN_S = 0.5  # of the longest recording; somebody has to move in it


@dataclass(frozen=True)
class Fit:
    """Estimates from all recordings.

    Attributes:
        parts: what it rests on.
        waveform: of all.
        seconds: that half of the recordings last at least.
    """

    parts: list[Part]
    waveform: Waveform
    seconds: float

    @property
    def snr_db(self) -> Float:
        """Of the parts in which somebody moves."""
        snr = np.array([part.snr_db for part in self.parts])
        return np.asarray(snr[np.isfinite(snr)])

    @property
    def floor_db(self) -> Float:
        """Noise floor over its median [K], of parts in which nobody stands in that bin."""
        floor = np.quantile([part.floor for part in self.parts], QUARTILE, axis=0)
        return np.asarray(10 * np.log10(floor / np.median(floor)))

    def numbers(self) -> dict[str, float]:
        """What the keys rest on, and the noise floor, which no key says.

        noise_floor_db is the variance of a raw sample as recorded; noise_over_range_db how much the
        floor rises from the nearest range bin to the farthest (Theil and Sen's slope).
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
        """Keys of a config."""
        w, snr, usual = self.waveform, self.snr_db, Config().radar
        middle, spread = round(float(snr.mean()), 2), round(float(snr.std()), 2)
        document: dict[str, Any] = {
            "duration_s": round(self.seconds, 3),
            "radar": {key: float(f"{getattr(w, name):.9g}") for key, name in RADAR.items()},
            "snr_db": {"normal": [middle, spread]} if snr.size >= FEW and spread > 0 else middle,
        }
        ranges = np.concatenate([part.ranges for part in self.parts])
        if ranges.size:
            antennas = (nominal(usual.tx_m[0]) + nominal(usual.rx_m[0])) / 2
            low, high = (np.percentile(ranges, [5, 95]) + antennas).round(2).tolist()
            document["motion"] = {"range_m": {"uniform": [low, high]} if high > low else low}
        return document


def fit(paths: Sequence[Path]) -> Fit:
    """Read waveform, SNR, ranges and noise floor off recordings of one radar.

    Raises:
        CaptureError: one holds what another does or is of another radar, they are slow time or too
            short, or nobody moves in any.
        FolderError: one is not a recording.
    """
    waveform, seconds = _waveform(paths)
    parts = [part for path in paths for part in parts_of(path)]
    if not any(np.isfinite(part.snr_db) for part in parts):
        raise CaptureError(
            f"{paths[0]}: nobody is seen to move faster than {SLOW_MPS} m/s in any recording"
        )
    fitted = Fit(parts, waveform, seconds)
    validated(Config, fitted.document, str(paths[0]), {})
    return fitted


def _waveform(paths: Sequence[Path]) -> tuple[Waveform, float]:
    """The chirps of all recordings, and how long they last (s)."""
    waveform, seconds = None, []
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
    if max(seconds) < MIN_S:
        raise CaptureError(
            f"{paths[0]}: the longest recording lasts {max(seconds):.3g} s; it should "
            f"last at least {MIN_S:g} s for somebody to be seen to move"
        )
    assert waveform is not None
    return waveform, float(np.median(seconds))


def _differs(one: Waveform, other: Waveform) -> bool:
    return any(abs(getattr(one, n) / getattr(other, n) - 1) > 1e-3 for n in RADAR.values())
