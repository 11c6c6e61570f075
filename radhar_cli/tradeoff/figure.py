"""pareto.png: time against error, with the frontier."""

from collections.abc import Sequence
from math import inf
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes

from radhar_cli.figures.page import page, png_bytes
from radhar_cli.tradeoff.study import Record

ENGINES = ("budget", "precision", "engine")
CLOSE_DB = 4  # names of points so close would lie on each other


class CostPoint(NamedTuple):
    """A setting: time relative to the default's with quartiles, error in dB."""

    name: str
    time: float
    low: float
    high: float
    error_db: float
    default: bool


def frontier(points: Sequence[CostPoint]) -> list[CostPoint]:
    """The settings that no other one beats in both time and error, the fastest first."""
    best: list[CostPoint] = []
    for point in sorted(points, key=lambda p: (p.time, p.error_db)):
        if not best or point.error_db < best[-1].error_db:
            best.append(point)
    return best


def tradeoff_png(title: str, rows: Sequence[Record]) -> bytes:
    """Draw time against error of the engine's settings; what is exact lies at the bottom."""
    engines = [row for row in rows if row["group"] in ENGINES and row["time_ratio"] is not None]
    errors = [row["signal_error_db"] for row in engines]
    floor = min((e for e in errors if e is not None and e > -inf), default=-100.0) - 20
    points = [
        CostPoint(
            row["setting"] + " (default)" * row["default"],
            row["time_ratio"],
            row["time_ratio_low"],
            row["time_ratio_high"],
            max(floor, -inf if error is None else error),
            row["default"],
        )
        for row, error in zip(engines, errors, strict=True)
    ]
    figure = page(7.5, 4.8)
    axes = figure.subplots()
    named: list[CostPoint] = []
    for point in sorted(points, key=lambda p: -p.error_db):
        axes.errorbar(
            point.time,
            point.error_db,
            xerr=[[point.time - point.low], [point.high - point.time]],
            fmt="D" if point.default else "o",
            color="C3" if point.default else "C0",
            capsize=2,
            zorder=4 if point.default else 3,
        )
        if named and named[0].error_db - point.error_db >= CLOSE_DB:
            _name(axes, named)
            named = []
        named.append(point)
    _name(axes, named)
    line = frontier(points)
    times, errors = [p.time for p in line], [p.error_db for p in line]
    axes.step(times, errors, where="post", color="0.6", lw=1, label="frontier")
    axes.set_xscale("log")
    longest = max(p.high for p in points)
    axes.set_xlim(right=2.5 * longest)
    ticks = [tick for tick in (0.5, 0.7, 1, 1.5, 2, 3, 5, 10, 20, 50) if tick < 2 * longest]
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()
    steps = np.arange(20 * (int(floor) // 20 + 2), 1, 20)
    axes.set_yticks([floor, *steps], ["exact", *(f"{step:g}" for step in steps)])
    axes.set_ylim(floor - 8, max(p.error_db for p in points) + 10)
    axes.set_title(title)
    axes.set_xlabel("time of a sample relative to the default's")
    axes.set_ylabel("error of the slow-time signal (dB), worst scene")
    axes.legend(fontsize=8, loc="upper right")
    axes.grid(alpha=0.3)
    return png_bytes(figure)


def _name(axes: Axes, points: Sequence[CostPoint]) -> None:
    place = (max(p.time for p in points), points[0].error_db)
    names = ", ".join(p.name for p in points)
    axes.annotate(names, place, (7, 4), textcoords="offset points", fontsize=7.5)
