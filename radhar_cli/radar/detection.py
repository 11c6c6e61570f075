"""Detection settings of the .cfg of a TI board (mmWave SDK user guide, "CLI")."""

from dataclasses import dataclass, replace
from math import ceil, log2, log10
from typing import Literal, NamedTuple, TypeAlias

CA, CAGO, CASO = range(3)
# Chains of TI's firmware: those of out-of-box demos, and two that look for people.
Firmware: TypeAlias = Literal["sdk1", "sdk3", "people_tracking", "people_counting"]
# How points are found: as well as the data allow, or by firmware; `board` is that of the file.
Chain: TypeAlias = Literal["best", "board", "sdk1", "sdk3", "people_tracking", "people_counting"]


class Cfar(NamedTuple):
    """Settings of one `cfarCfg`: averaging of decibels along an axis.

    Attributes:
        mode: CA (mean of both sides), CAGO (the greater) or CASO (the smaller).
        window: Number of averaged cells on each side.
        guard: Number of cells on each side that are left out.
        cyclic: Whether the axis closes on itself.
        threshold_db: Threshold over the average.
    """

    mode: int
    window: int
    guard: int
    cyclic: bool
    threshold_db: float


NO_CFAR = Cfar(CASO, 8, 4, False, 15.0)  # along range, where nothing sets it


class Demo(NamedTuple):
    """Traits in which the firmware of one out-of-box demo differs from another's.

    Attributes:
        max_points: Most points of a frame.
        groups_diagonally: Whether peak grouping along both axes compares eight neighbours, and not
            four.
        snr_scale: SNR of a point over the decibels of the CFAR.
        snr_step_db: Step of the SNR of points, dB; 0 for none.
    """

    max_points: int = 64
    groups_diagonally: bool = True
    snr_scale: float = 1.0
    snr_step_db: float = 0.0


DEMO_OF_SDK_1 = Demo()


@dataclass(frozen=True)
class Detection:
    """Settings of the detection of points: those of a .cfg, or what holds without one.

    Attributes:
        along_range: CFAR along range.
        along_doppler: CFAR along Doppler, which must fire too; None for none.
        grouping: Whether peaks alone are kept, along range and along Doppler.
        first_bin: First range bin that points may have.
        last_bin: Last range bin that points may have; None for the last of all.
        second_peak: Least height of a second peak over angle, over the first; None for no second.
        remove_mean: Whether the mean over the loops of a frame is taken out.
        bias: Range bias, m.
        coefficients: Phase and gain corrections of the virtual channels [V]; () for none.
        azimuth_deg: Limits of azimuth, positive to the left; None for none, as below.
        elevation_deg: Limits of elevation.
        range_m: Limits of range.
        doppler_mps: Limits of radial speed, positive receding.
        demo: Settings of the firmware that no line of the .cfg has.
    """

    along_range: Cfar = NO_CFAR
    along_doppler: Cfar | None = None
    grouping: tuple[bool, bool] = (False, False)
    first_bin: int = 0
    last_bin: int | None = None
    second_peak: float | None = None
    remove_mean: bool = False
    bias: float = 0.0
    coefficients: tuple[complex, ...] = ()
    azimuth_deg: tuple[float, float] | None = None
    elevation_deg: tuple[float, float] | None = None
    range_m: tuple[float, float] | None = None
    doppler_mps: tuple[float, float] | None = None
    demo: Demo = DEMO_OF_SDK_1

    def without_limits(self) -> "Detection":
        """Return the detection without limits of angles, range and speed."""
        return replace(self, azimuth_deg=None, elevation_deg=None, range_m=None, doppler_mps=None)


def demo_of_sdk3(channels: int) -> Demo:
    """The out-of-box demo of SDK 3 (`objdetrangehwa`), for a number n of virtual channels.

    Its sum of logarithms over n channels is divided by 2^ceil(log2 n), which the threshold takes
    into account and the SNR of points does not: 12/16 of the decibels of an IWR6843.
    """
    return Demo(500, False, channels / 2 ** ceil(log2(channels)), 0.1)


def ti_threshold_db(value: float, channels: int) -> float:
    """Threshold in dB of a cfarCfg of SDK 1 and 2.

    Args:
        value: Number in the .cfg: 512 an octave, for sums over 2^ceil(log2 n) channels.
        channels: Number n of virtual channels.
    """
    octaves: float = value / (512 * channels / 2 ** ceil(log2(channels)))
    return octaves * 20 * log10(2)
