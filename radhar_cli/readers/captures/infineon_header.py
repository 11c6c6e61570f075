"""The header of a capture of Infineon's BGT60 in the JSON that its Radar SDK writes.

`config.json` beside `radar.npy` [frame, receiver, chirp, sample], real samples from 0 to 1 or of 12
bits; keys of the SDK's versions 3 (`device_config: {fmcw_single_shape: ...}`) and of its settings
in Python (`num_samples`, `num_chirps`). The sweep takes as long as its samples.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from radhar_cli.errors import CaptureError

# {key of a capture: names of it, of any version}
NAMES = {
    "start": ("start_frequency_Hz", "lower_frequency_Hz"),
    "end": ("end_frequency_Hz", "upper_frequency_Hz"),
    "samples": ("num_samples_per_chirp", "num_samples"),
    "chirps": ("num_chirps_per_frame", "num_chirps"),
    "rate": ("sample_rate_Hz",),
    "chirp_s": ("chirp_repetition_time_s",),
    "frame_s": ("frame_repetition_time_s",),
}
RECEIVERS = 3


def is_infineon(document: object) -> bool:
    """Whether a JSON document is a header of Infineon's SDK."""
    return isinstance(document, dict) and bool(_section_of(document))


def read_infineon(document: Mapping[str, Any], path: Path) -> dict[str, Any]:
    """Read the settings of a capture (fields of `CaptureSettings`).

    Args:
        document: the JSON document.
        path: its file, for messages.

    Raises:
        CaptureError: numbers are missing, or several transmitters take turns; names all keys.
    """
    section = _section_of(document)
    numbers = {key: _first_of(section, names) for key, names in NAMES.items()}
    missing = [" or ".join(NAMES[key]) for key, number in numbers.items() if number is None]
    if missing:
        raise CaptureError(f"{path}: {', '.join(missing)}: should be numbers above 0")
    known = {key: number for key, number in numbers.items() if number is not None}
    if section.get("tdm_mimo") or section.get("mimo_mode", "off") != "off":
        raise CaptureError(
            f"{path}: mimo_mode: should be off; of transmitters that take turns give the keys by "
            "--set: carrier_hz, bandwidth_hz, adc_rate_hz, prf_hz, frame_s, transmitters, axes"
        )
    if not known["end"] > known["start"]:
        raise CaptureError(f"{path}: the end frequency should be above the start frequency")
    return {
        "carrier_hz": known["start"],
        "bandwidth_hz": known["end"] - known["start"],
        "adc_rate_hz": known["rate"],
        "prf_hz": 1 / known["chirp_s"],
        "samples": round(known["samples"]),
        "receivers": _count_receivers(section),
        "frame_pulses": round(known["chirps"]),
        "frame_s": known["frame_s"],
        "complex": False,
        "axes": ["frame", "receiver", "pulse", "sample"],
    }


def _section_of(document: Mapping[str, Any], depth: int = 0) -> dict[str, Any]:
    """Find the section with the frequencies of the sweep, and the keys around it; {} without."""
    keys = {name for key in ("start", "rate") for name in NAMES[key]}
    if len(keys & document.keys()) >= 2:
        return dict(document)
    for value in document.values():
        if isinstance(value, dict) and depth < 4:
            section = _section_of(value, depth + 1)
            if section:
                flat = {k: v for k, v in document.items() if not isinstance(v, dict | list)}
                return flat | section
    return {}


def _first_of(section: Mapping[str, Any], names: tuple[str, ...]) -> float | None:
    """Number above 0 of the first name that a section has; None without."""
    values = [section[name] for name in names if name in section]
    is_number = values and isinstance(values[0], int | float) and 0 < values[0] < 1e15
    return float(values[0]) if is_number else None


def _count_receivers(section: Mapping[str, Any]) -> int:
    """Number of receivers that are on."""
    antennas, mask = section.get("rx_antennas"), section.get("rx_mask")
    if isinstance(antennas, list) and antennas:
        return len(antennas)
    if isinstance(mask, int) and 0 < mask < 2**RECEIVERS:
        return mask.bit_count()
    count = section.get("num_rx")
    return count if isinstance(count, int) and 1 <= count <= RECEIVERS else RECEIVERS
