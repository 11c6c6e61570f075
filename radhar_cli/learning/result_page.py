"""The report of an evaluation, and its part about one run on one data set."""

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field

from radhar_cli.figures.report.parts import ReportFigure, ReportTable
from radhar_cli.figures.report.report import Format, Report


@dataclass
class EvalReport(Report):
    """Report of runs on data sets, in report.html and report.json."""

    formats: tuple[Format, ...] = ("html",)
    lists_files: bool = True
    # {score: {run: {data set: value}}}, by which a program sums up what was found
    scores: dict[str, dict[str, dict[str, float]]] = field(default_factory=dict)

    def add_score(self, score: str, run: str, data: str, value: float) -> None:
        """Add the number by which a run on a data set is summed up."""
        self.scores.setdefault(score, {}).setdefault(run, {})[data] = value


@dataclass(frozen=True)
class ResultPage:
    """Part of a report about one run on one data set; the names of its files end alike."""

    report: Report
    stem: str  # end of the names of its files
    title: str  # of its figures

    def figure(self, name: str, caption: str, png: bytes) -> None:
        """Add a figure: name without its end, caption, and content of the PNG."""
        self.report.add(ReportFigure(f"{name}{self.stem}.png", caption, png))

    def table(
        self,
        name: str,
        header: Sequence[object],
        rows: Iterable[Sequence[object]],
        title: str | None = None,
    ) -> None:
        """Add a table.

        Args:
            name: name of its file, without its end.
            header: names of the columns.
            rows: cells, row by row.
            title: title on the page; None leaves the table to its file.
        """
        file = f"{name}{self.stem}.csv"
        self.report.add(ReportTable(header, [*rows], title or "", file, title is not None))
