"""What `radhar compare` writes: numbers, a table, a figure."""

from pathlib import Path

import numpy as np

from radhar_cli.figures.two_samples import Picture, pictures_png
from radhar_cli.learning.report_folder import NUMBERS, csv_text, write_report
from radhar_cli.two_sample.comparison import Comparison

PICTURES = 4  # of a class and side


def write(comparison: Comparison, folder: Path) -> list[Path]:
    """Write report.json, statistics.csv and pictures.png into a folder; return their paths.

    Files of an earlier comparison there are replaced or removed.
    """
    files = {"statistics.csv": _table(comparison).encode(), "pictures.png": _pictures(comparison)}
    write_report(folder, files, comparison.numbers())
    return [folder / NUMBERS, *(folder / name for name in files)]


def _table(comparison: Comparison) -> str:
    kinds = [f"{side}_{name}" for side in ("simulated", "measured") for name in ("mean", "sd", "n")]
    rows = (
        (one.name, name, comparison.unit(name), *d.simulated, *d.measured, d.distance, d.p)
        for one in comparison.classes
        for name, d in one.differences.items()
    )
    return csv_text(["class", "statistic", "unit", *kinds, "distance", "p"], rows)


def _pictures(comparison: Comparison) -> bytes:
    """A row of each class: some simulated maps, and as many measured ones."""
    pair = comparison.pair
    rows = dict[str, list[Picture]]()
    for one in comparison.classes:
        told = "no test"
        if one.tested is not None:
            told = f"{100 * one.tested[0] / one.tested[1]:.0f} % told apart"
        some = np.linspace(0, one.rows[0].size - 1, min(PICTURES, one.rows[0].size)).astype(int)
        rows[f"{one.name}\n{told}"] = [
            Picture(side.levels(row), pair.edges(side, row), words)
            for words, side, mine in zip(
                ("simulated", "measured"), pair.sides, one.rows, strict=True
            )
            for row in mine[some]
        ]
    units = pair.units
    upwards = f"{'range' if pair.ranges else 'Doppler'} ({units['rows']})"
    return pictures_png(rows, "simulated and measured", f"time ({units['columns']})", upwards)
