"""Accuracy over several data sets, with intervals: against the SNR where each has one."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import nan

from radhar_cli.figures.page import page, png_bytes


@dataclass(frozen=True)
class Point:
    """Accuracy and its interval on one data set, in shares; `snr_db` where it has a single one."""

    data: str
    snr_db: float | None
    accuracy: float
    low: float
    high: float


def robustness_png(lines: Mapping[str, Sequence[Point]]) -> bytes:
    """Draw a line for every run; points over the SNR, or over the names of the data sets."""
    figure = page(7.5, 4.6)
    axes = figure.subplots()
    by_snr = all(point.snr_db is not None for points in lines.values() for point in points)
    snrs = {p.snr_db for points in lines.values() for p in points}
    names = list(dict.fromkeys(p.data for points in lines.values() for p in points))
    for number, (name, points) in enumerate(lines.items()):
        if by_snr:
            untested = snrs - {p.snr_db for p in points}  # where the line is interrupted
            points = [*points, *(Point("", snr, nan, nan, nan) for snr in untested)]
            points.sort(key=lambda p: p.snr_db or 0.0)
            x = [p.snr_db or 0.0 for p in points]
        else:
            x = [names.index(p.data) + 0.08 * (number - (len(lines) - 1) / 2) for p in points]
        y = [100 * p.accuracy for p in points]
        spread = [
            [100 * max(0.0, p.accuracy - p.low) for p in points],
            [100 * max(0.0, p.high - p.accuracy) for p in points],
        ]
        axes.errorbar(
            x,
            y,
            spread,
            fmt="o-" if by_snr else "o",
            capsize=3,
            color=f"C{number % 10}",
            label=name,
        )
    if by_snr:
        axes.set_xlabel("SNR of the data (dB)")
    else:
        axes.set_xticks(range(len(names)), names, rotation=25, ha="right", fontsize=8)
    axes.set_ylabel("accuracy (%), 95 % interval")
    axes.set_ylim(0, 102)
    axes.grid(alpha=0.3)
    figure.legend(loc="outside right center", fontsize=8)
    return png_bytes(figure)
