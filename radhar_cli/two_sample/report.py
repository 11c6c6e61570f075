"""What `radhar compare` writes: numbers, a table, figures."""

import re
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from scipy.special import expit

from radhar_cli.arrays import Index
from radhar_cli.figures.two_samples import (
    Distribution,
    Picture,
    distances_png,
    distributions_png,
    pictures_png,
)
from radhar_cli.learning.report_folder import NUMBERS, csv_text, write_report
from radhar_cli.two_sample.comparison import ClassCompared, Comparison
from radhar_cli.two_sample.map_statistics import STATISTICS

DRAWN = 12  # statistics of a class, the most wrong first; statistics.csv has all


def write(comparison: Comparison, folder: Path) -> list[Path]:
    """Write report.json, statistics.csv and the figures into a folder; return their paths.

    Files of an earlier comparison there are replaced or removed.
    """
    files = {"statistics.csv": _table(comparison).encode(), "distances.png": _distances(comparison)}
    for number, one in enumerate(comparison.classes, 1):
        stem = f"{number:02d}_" + re.sub(r"[^\w-]", "_", one.name)
        files[f"{stem}_statistics.png"] = _distributions(comparison, one)
        files[f"{stem}_pictures.png"] = _pictures(comparison, one)
    write_report(folder, files, comparison.numbers())
    return [folder / NUMBERS, *(folder / name for name in files)]


def _table(comparison: Comparison) -> str:
    means = [f"{side}_{name}" for side in ("simulated", "measured") for name in ("mean", "sd")]
    rows = (
        (one.name, name, comparison.scale.unit(name), *d.simulated[:2], *d.measured[:2], *d[2:])
        for one in comparison.classes
        for name, d in one.differences.items()
    )
    return csv_text(["class", "statistic", "unit", *means, "distance", "ks", "p"], rows)


def _distances(comparison: Comparison) -> bytes:
    """Statistics that any class has, of all classes, what is most wrong over all of them first."""
    table = np.array(
        [
            [one.differences[name].distance for one in comparison.classes]
            for name in comparison.scale.names
        ]
    )
    order = np.argsort(-np.nan_to_num(table).mean(axis=1), kind="stable")
    order = order[np.isfinite(table[order]).any(axis=1)]
    columns = [one.name.replace("_", " ") + "\n" + how_sure(one) for one in comparison.classes]
    rows = [STATISTICS[comparison.scale.names[number]].words for number in order]
    return distances_png(table[order], rows, columns)


def how_sure(one: ClassCompared) -> str:
    """How surely the two sides of a class are told apart."""
    if one.tested is None:
        return "no test"
    return f"{100 * one.tested.right / one.tested.truth.size:.0f} % told apart"


def _distributions(comparison: Comparison, one: ClassCompared) -> bytes:
    some = []
    for name, difference in list(one.differences.items())[:DRAWN]:
        column = comparison.scale.names.index(name)
        values = [side.statistics[:, column] for side in (one.simulated, one.measured)]
        x, y = (v[np.isfinite(v)] for v in values)
        words = f"{STATISTICS[name].words}: {difference.distance:.2f}"
        some.append(Distribution(words, x, y, comparison.scale.unit(name)))
    return distributions_png(some, f"{one.name}: statistic and distance, the largest first")


def _pictures(comparison: Comparison, one: ClassCompared) -> bytes:
    count, tested, far = comparison.options.pictures, one.tested, one.uncovered
    away = zip(one.measured.rows.tolist(), far.tolist(), strict=True)
    odds = np.empty(0) if tested is None else np.sort(tested.score[tested.truth])[::-1]
    sure = zip(one.surest.tolist(), expit(odds).tolist(), strict=False)
    words = [
        {row: f"{100 * chance:.1f} % simulated" for row, chance in sure},
        {row: f"{distance:.2f} radii away" for row, distance in away},
    ]
    rows = {
        "simulated": _drawn(comparison, 0, _spread(one.typical[0], count), {}),
        "measured": _drawn(comparison, 1, _spread(one.typical[1], count), {}),
        "surest to be\nsimulated": _drawn(comparison, 0, one.surest[:count], words[0]),
        "measured, least\ncovered": _drawn(comparison, 1, one.far[:count], words[1]),
    }
    units = comparison.scale.units()
    quantity = "range" if comparison.scale.ranges else "Doppler"
    title = f"{one.name}: {how_sure(one)}, {100 * np.mean(far <= 1):.0f} % covered"
    return pictures_png(rows, title, f"time ({units['columns']})", f"{quantity} ({units['rows']})")


def _spread(rows: Index, count: int) -> Index:
    """Some, evenly, of the nearer three quarters of rows that go from the middle outwards."""
    near: Index = rows[: max(count, 3 * rows.size // 4)]
    return np.asarray(near[np.linspace(0, near.size - 1, min(count, near.size)).astype(int)])


def _drawn(
    comparison: Comparison, number: int, rows: Index, words: Mapping[int, str]
) -> list[Picture]:
    """Maps of a side with the rows that are shown alone."""
    side, (above, below), drawn = comparison.sides[number], comparison.shown, []
    for row in rows.tolist():
        levels = side.levels(row)
        first, last = round(above * len(levels)), round(below * len(levels))
        left, right, bottom, top = comparison.scale.edges(side, row)
        step = (top - bottom) / len(levels)
        extent = (left, right, top - last * step, top - first * step)
        drawn.append(Picture(levels[first:last], extent, words.get(row, "")))
    return drawn
