"""What compares several runs, or one run on several data sets."""

from collections.abc import Mapping, Sequence

from radhar_cli.figures.curves import curves_png
from radhar_cli.figures.filters import filters_png
from radhar_cli.figures.robustness import Point, robustness_png
from radhar_cli.learning.filter_weights import magnitudes, table
from radhar_cli.learning.report_files import Report
from radhar_cli.learning.run_folder import best_epoch
from radhar_cli.learning.single_result import EvalOptions, Run
from radhar_cli.learning.tables import csv_text


def compare(
    report: Report, runs: Sequence[Run], lines: Mapping[str, Sequence[Point]], options: EvalOptions
) -> None:
    """What compares runs or data sets."""
    with_history = {run.name: run.history for run in runs if run.history}
    if with_history:
        best = {name: best_epoch(rows).epoch for name, rows in with_history.items()}
        report.figure("curves.png", "Training curves.", curves_png(with_history, best))
    if any(len(points) > 1 for points in lines.values()):
        caption = "Accuracy over the data sets."
        report.figure("robustness.png", caption, robustness_png(lines))
        rows = (
            (name, p.data, p.snr_db, p.accuracy, p.low, p.high)
            for name, points in lines.items()
            for p in points
        )
        head = ("run", "data", "snr_db", "accuracy", "low_95", "high_95")
        report.tables.append(("robustness.csv", csv_text(head, rows)))
    if options.filters:
        filters = {run.name: magnitudes(run.model) for run in runs}
        filters = {name: weights for name, weights in filters.items() if weights}
        report.figure(
            "filters.png",
            "Magnitude of the global filters by spatial frequency, mean over channels; the zero "
            "frequency is in the middle.",
            filters_png(filters),
        )
        tables = {name: table(weights) for name, weights in filters.items()}
        report.numbers["filters"] = tables
        keys = list(next(iter(tables.values()))[0])
        every = ((name, *row.values()) for name, weights in tables.items() for row in weights)
        report.tables.append(("filters.csv", csv_text(["run", *keys], every)))
