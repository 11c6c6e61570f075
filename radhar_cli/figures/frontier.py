"""What accuracy costs: time against error with the frontier, and what physics left out changes."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from matplotlib.axes import Axes

from radhar_cli.figures.page import page, png_bytes


@dataclass(frozen=True)
class CostPoint:
    """A setting: its time over the default's with quartiles, and its error in dB (None: exact)."""

    name: str
    time: float
    low: float
    high: float
    error_db: float | None
    default: bool


@dataclass(frozen=True)
class Change:
    """A switch: what is missed without it (dB of the signal), its time over what setting's."""

    name: str
    change_db: float
    time: float
    over: str


@dataclass(frozen=True)
class Score:
    """Accuracy of a network trained on a setting's data, in shares."""

    name: str
    mean: float
    low: float
    high: float


def frontier(points: Sequence[CostPoint]) -> list[CostPoint]:
    """The settings that no other one beats in both time and error, the fastest first."""
    best: list[CostPoint] = []
    exact = float("-inf")
    for point in sorted(points, key=lambda p: (p.time, _error(p, exact))):
        if not best or _error(point, exact) < _error(best[-1], exact):
            best.append(point)
    return best


def tradeoff_png(
    title: str,
    echo: Sequence[CostPoint],
    whole: Sequence[CostPoint],
    changes: Sequence[Change],
    scores: Sequence[Score],
) -> bytes:
    """Draw time against error, the switches, and accuracies where there are any."""
    count = 3 + bool(scores)
    figure = page(5.2 * count, 4.8)
    panels = figure.subplots(1, count)
    figure.suptitle(title)
    _draw_costs(panels[0], echo, "echo alone: time over the default's")
    _draw_costs(panels[1], whole, "whole sample: time over the default's")
    _draw_changes(panels[2], changes)
    if scores:
        _draw_scores(panels[3], scores)
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


def _draw_changes(axes: Axes, changes: Sequence[Change]) -> None:
    rows = range(len(changes))
    axes.barh(rows, [c.change_db + 100 for c in changes], left=-100, color="C1")
    for row, change in zip(rows, changes, strict=True):
        text = f"{change.change_db:.0f} dB, {change.time:.1f} times {change.over}"
        axes.text(-98, row, text, va="center", fontsize=8)
    axes.set_yticks(rows, [c.name for c in changes], fontsize=8)
    axes.set_xlim(-100, 15)
    axes.axvline(0, color="0.5", lw=0.8)
    axes.set_xlabel("what is missed without it (dB of the signal), median")


def _draw_scores(axes: Axes, scores: Sequence[Score]) -> None:
    rows = range(len(scores))
    mean = [100 * s.mean for s in scores]
    spread = [
        [100 * max(0, s.mean - s.low) for s in scores],
        [100 * max(0, s.high - s.mean) for s in scores],
    ]
    axes.errorbar(mean, list(rows), xerr=spread, fmt="o", capsize=3)
    axes.set_yticks(rows, [s.name for s in scores], fontsize=8)
    axes.set_xlabel("accuracy on the reference (%), 95 % interval")
    axes.grid(alpha=0.3)


def _error(point: CostPoint, exact: float) -> float:
    return exact if point.error_db is None else point.error_db
