"""pareto.png: time against error with the frontier, and what physics left out changes."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

import numpy as np
from matplotlib.axes import Axes

from radhar_cli.figures.page import page, png_bytes
from radhar_cli.tradeoff.study import Row
from radhar_cli.tradeoff.text import ENGINES


@dataclass(frozen=True)
class CostPoint:
    """A setting: its time over the default's with quartiles, and its error in dB (None: exact)."""

    name: str
    time: float
    low: float
    high: float
    error_db: float | None
    default: bool

    @classmethod
    def of(cls, row: Row, column: str) -> "CostPoint":
        """A row of the sweep, with the time of a column of its `Times`."""
        middle, spread = row.middle(column), row.spread(column)
        assert middle is not None
        assert spread is not None
        error = row.worst("signal_error_db")
        exact = error in (None, -inf)
        return cls(
            row.setting.name, middle, *spread, None if exact else error, row.setting.is_default
        )


def frontier(points: Sequence[CostPoint]) -> list[CostPoint]:
    """The settings that no other one beats in both time and error, the fastest first."""
    best: list[CostPoint] = []
    exact = float("-inf")
    for point in sorted(points, key=lambda p: (p.time, _error(p, exact))):
        if not best or _error(point, exact) < _error(best[-1], exact):
            best.append(point)
    return best


def tradeoff_png(title: str, rows: Sequence[Row]) -> bytes:
    """Draw time against error, and the switches."""
    engines = [row for row in rows if row.setting.group in ENGINES and row.times]
    figure = page(15.6, 4.8)
    panels = figure.subplots(1, 3)
    figure.suptitle(title)
    for axes, part, column in (
        (panels[0], "echo alone", "echo_ratio"),
        (panels[1], "whole sample", "ratio"),
    ):
        points = [CostPoint.of(row, column) for row in engines]
        _draw_costs(axes, points, f"{part}: time over the default's")
    _draw_switches(panels[2], rows)
    return png_bytes(figure)


def _draw_costs(axes: Axes, points: Sequence[CostPoint], label: str) -> None:
    least = min((p.error_db for p in points if p.error_db is not None), default=-100.0)
    floor = least - 20
    for point in points:
        axes.errorbar(
            point.time,
            _error(point, floor),
            xerr=[[max(0, point.time - point.low)], [max(0, point.high - point.time)]],
            fmt="D" if point.default else "o",
            color="C3" if point.default else "C0",
            capsize=2,
            zorder=4 if point.default else 3,
        )
    for group in _level(points, floor):
        names = ", ".join(f"{p.name} (default)" if p.default else p.name for p in group)
        place = (max(p.time for p in group), _error(group[0], floor))
        axes.annotate(names, place, (7, 4), textcoords="offset points", fontsize=7.5)
    line = frontier(points)
    axes.step(
        [p.time for p in line],
        [_error(p, floor) for p in line],
        where="post",
        color="0.6",
        lw=1,
        label="frontier",
    )
    axes.set_xscale("log")
    longest = max(p.high for p in points)
    axes.set_xlim(right=2.5 * longest)
    ticks = [tick for tick in (0.5, 0.7, 1, 1.5, 2, 3, 5, 10, 20, 50) if tick < 2 * longest]
    axes.set_xticks(ticks, [f"{tick:g}" for tick in ticks])
    axes.minorticks_off()
    steps = np.arange(20 * (int(floor) // 20 + 2), 1, 20)
    axes.set_yticks([floor, *steps], ["exact", *(f"{step:g}" for step in steps)])
    axes.set_ylim(floor - 8, max(_error(p, floor) for p in points) + 10)
    axes.set_xlabel(label)
    axes.set_ylabel("error of the slow-time signal (dB), worst scene")
    axes.legend(fontsize=8, loc="upper right")
    axes.grid(alpha=0.3)


def _level(points: Sequence[CostPoint], floor: float) -> list[list[CostPoint]]:
    """Points whose errors are so close that their names would lie on each other."""
    groups: list[list[CostPoint]] = []
    for point in sorted(points, key=lambda p: -_error(p, floor)):
        if groups and _error(groups[-1][0], floor) - _error(point, floor) < 4:
            groups[-1].append(point)
        else:
            groups.append([point])
    return groups


def _draw_switches(axes: Axes, rows: Sequence[Row]) -> None:
    names = list[str]()
    for row in rows:
        setting, change_db = row.setting, row.usual("signal_error_db")
        if setting.group != "switch" or not setting.of_signal or change_db is None or not row.times:
            continue
        axes.barh(len(names), change_db + 100, left=-100, color="C1")
        text = f"{change_db:.0f} dB, {row.middle('ratio'):.1f} times {setting.baseline_name}"
        axes.text(-98, len(names), text, va="center", fontsize=8)
        names.append(setting.name)
    axes.set_yticks(range(len(names)), names, fontsize=8)
    axes.set_xlim(-100, 15)
    axes.axvline(0, color="0.5", lw=0.8)
    axes.set_xlabel("what is missed without it (dB of the signal), median")


def _error(point: CostPoint, exact: float) -> float:
    return exact if point.error_db is None else point.error_db
