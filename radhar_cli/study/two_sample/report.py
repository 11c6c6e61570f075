"""Report of a comparison: numbers, a table, a figure."""

from pathlib import Path

import numpy as np

from radhar_cli.figures.report.parts import ReportFigure, ReportTable
from radhar_cli.figures.report.report import Report
from radhar_cli.figures.two_samples import Picture, pictures_png
from radhar_cli.study.two_sample.comparison import Comparison

PICTURES = 4  # of a class and side


def write(comparison: Comparison, folder: Path) -> list[Path]:
    """Write report.json, statistics.csv and pictures.png into a folder; return their paths.

    Files of an earlier comparison there are replaced or removed.

    Raises:
        FolderError: a file cannot be written.
    """
    report = Report(comparison.numbers(), lists_files=True)
    report.add(_table(comparison), ReportFigure("pictures.png", "", _pictures(comparison)))
    return report.write(folder)


def _table(comparison: Comparison) -> ReportTable:
    kinds = [f"{side}_{name}" for side in ("simulated", "measured") for name in ("mean", "sd", "n")]
    header = ["class", "statistic", "unit", *kinds, "distance", "p"]
    rows = [
        (of_class.name, name, comparison.unit(name), *d.simulated, *d.measured, d.distance, d.p)
        for of_class in comparison.classes
        for name, d in of_class.differences.items()
    ]
    return ReportTable(header, rows, file="statistics.csv")


def _pictures(comparison: Comparison) -> bytes:
    """Figure with a row for each class: some simulated maps, and as many measured ones."""
    pair = comparison.pair
    rows = dict[str, list[Picture]]()
    for class_comparison in comparison.classes:
        accuracy_in_words = "no test"
        if class_comparison.tested is not None:
            accuracy_in_words = (
                f"{100 * class_comparison.tested[0] / class_comparison.tested[1]:.0f} % told apart"
            )
        selected = np.linspace(
            0, class_comparison.rows[0].size - 1, min(PICTURES, class_comparison.rows[0].size)
        ).astype(int)
        rows[f"{class_comparison.name}\n{accuracy_in_words}"] = [
            Picture(side.levels(row), pair.edges(side, row), words)
            for words, side, side_rows in zip(
                ("simulated", "measured"), pair.sides, class_comparison.rows, strict=True
            )
            for row in side_rows[selected]
        ]
    units = pair.units
    upwards = f"{'range' if pair.ranges else 'Doppler'} ({units['rows']})"
    if pair.clouds:
        upwards = "front views of frames, one after the other (px)"
    return pictures_png(rows, "simulated and measured", f"time ({units['columns']})", upwards)
