"""Detection of points as the lines of a TI .cfg set it."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import replace
from typing import TypeAlias

from radhar_cli.radar.detection import Cfar, Detection, demo_of_sdk3, ti_threshold_db
from radhar_cli.readers.ti.ti_commands import CfgLine, lines_of_detection

Numbers: TypeAlias = Mapping[str, float]


def read_detection(
    lines: Iterable[CfgLine], channels: int, bins: int, subframe: int = 0
) -> Detection:
    """Read the detection of a subframe.

    Args:
        lines: Lines of a .cfg; of equal commands the last holds.
        channels: Number of virtual channels.
        bins: Number of range bins.
        subframe: Number of the subframe, from 0 on.

    Raises:
        CaptureError: A line cannot be read.
    """
    detection = Detection()
    for line in lines_of_detection(lines, subframe):
        numbers = line.numbers
        if line.name == "cfarCfg" and "thresholdScale" in numbers:
            detection = _set_cfar(detection, line, numbers, channels, bins)
        elif line.name == "compRangeBiasAndRxChanPhase":
            detection = _set_bias(detection, line, numbers, channels)
        elif line.name in _SETTERS:
            detection = _SETTERS[line.name](detection, numbers)
    return detection


def _set_cfar(
    detection: Detection, line: CfgLine, numbers: Numbers, channels: int, bins: int
) -> Detection:
    """Set the CFAR of an axis; the line of SDK 3 has decibels, and the peak grouping, too.

    With that line come the other habits of its firmware.
    """
    window, guard = int(numbers["winLen"]), int(numbers["guardLen"])
    scale, grouping = numbers["thresholdScale"], numbers.get("peakGroupingEn")
    threshold_db = ti_threshold_db(scale, channels) if grouping is None else scale
    is_cyclic = bool(numbers["cyclicMode"])
    cfar = Cfar(int(numbers["averageMode"]), window, guard, is_cyclic, threshold_db)
    along_doppler = bool(numbers["procDirection"])
    if not along_doppler and 2 * (window + guard) + 1 > bins:
        raise line.refusal(
            "winLen", window, f"less: {window + guard} cells on each side do not fit {bins} bins"
        )
    if grouping is not None:
        detection = replace(detection, demo=demo_of_sdk3(channels))
        axes = list(detection.grouping)
        axes[along_doppler] = bool(grouping)
        detection = replace(detection, grouping=(axes[0], axes[1]))
    if along_doppler:
        return replace(detection, along_doppler=cfar)
    return replace(detection, along_range=cfar)


def _set_bias(detection: Detection, line: CfgLine, numbers: Numbers, channels: int) -> Detection:
    """Set range bias and a complex factor of each virtual channel; all 1 are none."""
    coefficients = read_coefficients(line, channels)
    has_effect = set(coefficients) != {1 + 0j}
    return replace(
        detection, bias=numbers["rangeBias"], coefficients=coefficients if has_effect else ()
    )


def read_coefficients(line: CfgLine, channels: int) -> tuple[complex, ...]:
    """Read the phase and gain corrections of the virtual channels.

    Args:
        line: Line compRangeBiasAndRxChanPhase.
        channels: Number of virtual channels.

    Raises:
        CaptureError: There are fewer corrections than channels.
    """
    parts = [value for name, value in line.numbers.items() if name[:2] in ("Re", "Im")]
    pairs = zip(parts[::2], parts[1::2], strict=False)
    coefficients = tuple(complex(*pair) for pair in pairs)[:channels]
    if len(coefficients) < channels or len(parts) % 2:
        right = f"{channels} pairs of Re and Im at least, one a virtual channel"
        raise line.refusal("Re Im", f"{len(parts)} numbers", right)
    return coefficients


def _set_grouping(detection: Detection, numbers: Numbers) -> Detection:
    """Set along which axes peaks are grouped, and the range bins that count."""
    return replace(
        detection,
        grouping=(bool(numbers["rangeDimEn"]), bool(numbers["dopplerDimEn"])),
        first_bin=int(numbers["startRangeIdx"]),
        last_bin=int(numbers["endRangeIdx"]),
    )


def _set_second_peak(detection: Detection, numbers: Numbers) -> Detection:
    """Set the share of the highest peak over angle from which a second one counts."""
    return replace(detection, second_peak=numbers["threshold"] if numbers["enabled"] else None)


def _set_mean_removal(detection: Detection, numbers: Numbers) -> Detection:
    """Set whether the mean over the loops of a frame is taken out."""
    flag = numbers["enabled" if "enabled" in numbers else "clutterRemovalFlag"]
    return replace(detection, remove_mean=bool(flag))


def _remove_mean(detection: Detection, _: Numbers) -> Detection:
    """Take the mean over the loops of a frame out, as people tracking always does."""
    return replace(detection, remove_mean=True)


def _set_angle_limits(detection: Detection, numbers: Numbers) -> Detection:
    """Set the limits of azimuth and elevation of points, degrees."""
    return replace(
        detection,
        azimuth_deg=(numbers["minAzimuthDeg"], numbers["maxAzimuthDeg"]),
        elevation_deg=(numbers["minElevationDeg"], numbers["maxElevationDeg"]),
    )


def _set_range(detection: Detection, numbers: Numbers) -> Detection:
    """Set the limits of range (m) of points."""
    return replace(detection, range_m=(numbers["min"], numbers["max"]))


def _set_cfar_limits(detection: Detection, numbers: Numbers) -> Detection:
    """Set the limits of range (m) or of speed (m/s) of points."""
    limits = numbers["min"], numbers["max"]
    if numbers["procDirection"]:
        return replace(detection, doppler_mps=limits)
    return replace(detection, range_m=limits)


_SETTERS: Mapping[str, Callable[[Detection, Numbers], Detection]] = {
    "peakGrouping": _set_grouping,
    "multiObjBeamForming": _set_second_peak,
    **dict.fromkeys(("clutterRemoval", "doaCfg"), _set_mean_removal),
    "dynamicRACfarCfg": _remove_mean,
    "aoaFovCfg": _set_angle_limits,
    "cfarFovCfg": _set_cfar_limits,
    "rangeSelCfg": _set_range,
}
