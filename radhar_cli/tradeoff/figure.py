"""pareto.png: time against error with the frontier, and what physics left out changes."""

from collections.abc import Sequence
from math import inf
from typing import NamedTuple

import numpy as np
from matplotlib.axes import Axes

from radhar_cli.figures.page import page, png_bytes
from radhar_cli.tradeoff.study import Record

ENGINES = ("budget", "precision", "engine")


class CostPoint(NamedTuple):
    """A setting: time relative to the default's with quartiles, error in dB (-inf: exact)."""

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
    """Draw time against error, and the switches."""
    engines = [row for row in rows if row["group"] in ENGINES and row["time_ratio"] is not None]
    errors = [row["signal_error_db"] for row in engines]
    floor = min((e for e in errors if e is not None and e > -inf), default=-100.0) - 20
    figure = page(15.6, 4.8)
    panels = figure.subplots(1, 3)
    figure.suptitle(title)
    for axes, part, column in (
        (panels[0], "echo alone", "echo_ratio"),
        (panels[1], "whole sample", "time_ratio"),
    ):
        points = [
            CostPoint(
                row["setting"] + (" (default)" if row["default"] else ""),
                row[column],
                row[f"{column}_low"],
                row[f"{column}_high"],
                max(floor, -inf if error is None else error),
                row["default"],
            )
            for row, error in zip(engines, errors, strict=True)
        ]
        _draw_costs(axes, points, floor, f"{part}: time relative to the default's")
    _draw_switches(panels[2], rows)
    return png_bytes(figure)


def _draw_costs(axes: Axes, points: Sequence[CostPoint], floor: float, label: str) -> None:
    """Errors at `floor` are those of what is exact."""
    groups: list[list[CostPoint]] = []  # points so close that their names would lie on each other
    for point in sorted(points, key=lambda p: -p.error_db):
        axes.errorbar(
            point.time,
            point.error_db,
            xerr=[[max(0, point.time - point.low)], [max(0, point.high - point.time)]],
            fmt="D" if point.default else "o",
            color="C3" if point.default else "C0",
            capsize=2,
            zorder=4 if point.default else 3,
        )
        if groups and groups[-1][0].error_db - point.error_db < 4:
            groups[-1].append(point)
        else:
            groups.append([point])
    for group in groups:
        place = (max(p.time for p in group), group[0].error_db)
        names = ", ".join(p.name for p in group)
        axes.annotate(names, place, (7, 4), textcoords="offset points", fontsize=7.5)
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
    axes.set_xlabel(label)
    axes.set_ylabel("error of the slow-time signal (dB), worst scene")
    axes.legend(fontsize=8, loc="upper right")
    axes.grid(alpha=0.3)


def _draw_switches(axes: Axes, rows: Sequence[Record]) -> None:
    names = list[str]()
    for row in rows:
        change_db, ratio = row["signal_error_median_db"], row["time_ratio"]
        if row["group"] != "switch" or not row["of_signal"] or None in (change_db, ratio):
            continue
        axes.barh(len(names), change_db + 100, left=-100, color="C1")
        text = f"{change_db:.0f} dB, {ratio:.1f} times {row['time_over']}"
        axes.text(-98, len(names), text, va="center", fontsize=8)
        names.append(row["setting"])
    axes.set_yticks(range(len(names)), names, fontsize=8)
    axes.set_xlim(-100, 15)
    axes.axvline(0, color="0.5", lw=0.8)
    axes.set_xlabel("what is missed without it (dB of the signal), median")
