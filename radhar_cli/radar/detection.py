"""What the .cfg of a TI board says of detection (mmWave SDK user guide, "CLI")."""

from dataclasses import dataclass
from math import ceil, log2, log10
from typing import NamedTuple

CA, CAGO, CASO = range(3)


class Cfar(NamedTuple):
    """One `cfarCfg`: averaging of decibels along an axis."""

    mode: int  # CA, CAGO or CASO
    # window, guard: cells on each side
    window: int
    guard: int
    cyclic: bool  # whether the axis closes
    threshold_db: float  # over the average


@dataclass(frozen=True)
class Detection:
    """What a .cfg says of detection."""

    # along_range, along_doppler: the CFAR; both must fire where there are two
    along_range: Cfar
    along_doppler: Cfar | None = None
    # whether peaks alone are kept, along range, along Doppler
    grouping: tuple[bool, bool] = (False, False)
    # first_bin, last_bin: ranges that points may have
    first_bin: int = 0
    last_bin: int | None = None
    # least height of a second peak over angle, over the first; None is no second
    second_peak: float | None = None
    remove_mean: bool = False  # take out what stands still
    bias: float = 0.0  # range bias, m
    coefficients: tuple[complex, ...] = ()  # of the virtual channels [V], complex
    # azimuth_deg, elevation_deg, range_m, doppler_mps: fields of view, or None
    azimuth_deg: tuple[float, float] | None = None
    elevation_deg: tuple[float, float] | None = None
    range_m: tuple[float, float] | None = None
    doppler_mps: tuple[float, float] | None = None


def ti_threshold_db(value: float, channels: int) -> float:
    """Threshold of cfarCfg of SDK 1 and 2: 512 an octave, of sums over 2^ceil(log2 n) channels."""
    octaves: float = value / (512 * channels / 2 ** ceil(log2(channels)))
    return octaves * 20 * log10(2)
