"""Report of a sweep: tradeoff.json, which it goes on from, .csv, .md, .png and .html."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any

from radhar_cli.dataset.identity import differences, identity
from radhar_cli.errors import FolderError
from radhar_cli.figures.report.parts import ReportFigure, ReportTable, Sentences
from radhar_cli.figures.report.report import Report
from radhar_cli.figures.tradeoff import DEFAULT_NAME, SettingMark, tradeoff_png
from radhar_cli.files.untrusted import read_json
from radhar_cli.study.tradeoff.recommendation import percent_text, recommend, verdict_of
from radhar_cli.study.tradeoff.samples import Scenes
from radhar_cli.study.tradeoff.settings import DEFAULT
from radhar_cli.study.tradeoff.sweep import Omission, Row, Sweep

STEM = "tradeoff"
JSON, TEXT, FIGURE = (f"{STEM}.{suffix}" for suffix in ("json", "md", "png"))
SETTINGS = "Settings"  # heading of the table
ABOUT = (
    "A sample is everything from drawing a scene to grey levels and entropy, without files. Times "
    "are of one process, ratios medians over rounds in turns with what they are over, with "
    "intervals (trust these: ms of different rows are of different moments). An *error* is another "
    "computation of the same physics: against the exact sum in float64, with the same noise on "
    "both sides, of the worst scene. *Another picture* is other physics, or other parameters, and "
    "no error: against what the time is over, without noise, medians of the scenes. What is shown "
    "is that of each map: the share of pixels more than a level apart, rms, SSIM."
)
HEADER = "setting", "effect", "ms a sample", "time", "over", "error dB", "shown", "verdict"
COLUMNS = (
    *("group", "setting", "effect", "over", "sample_ms", "ratio", "ratio_low", "ratio_high"),
    *("error_db", "stated_db", "map", "changed", "over_one", "ssim", "rms_levels", "rms_db"),
    *("points_moved", "points_per_frame", "accuracy", "accuracy_low", "accuracy_high"),
)


@dataclass(frozen=True)
class TradeoffFiles:
    """Files of a sweep in a folder."""

    folder: Path
    scenes: Scenes
    command: str
    cores: int

    def read_earlier(self, overwrite: bool) -> Sweep:
        """Sweep that an earlier run of the same command has left in the folder; else an empty one.

        Raises:
            FolderError: the folder holds the sweep of another config, code or options.
        """
        path = self.folder / JSON
        if overwrite or not path.exists():
            return Sweep()
        keeps = "--overwrite replaces it, another folder keeps it"
        try:
            numbers = read_json(path)
            differing = differences(numbers["identity"], self._identity())
            sweep = Sweep.read(numbers)
        except (KeyError, TypeError, ValueError, AttributeError):
            text = f"{path}: is no result of this version of radhar; {keeps}"
            raise FolderError(text) from None
        if differing:
            lines = (f"{self.folder}: holds another sweep; it differs in", *differing)
            raise FolderError("\n  ".join(lines) + f"\n{keeps}")
        return sweep

    def recommendation(self, sweep: Sweep) -> list[str]:
        """Sentences on what the config may save, as `recommend` has them."""
        return recommend(sweep, self.scenes.config().engine, self.cores)

    def keep(self, sweep: Sweep) -> None:
        """Write tradeoff.json, from which the same command goes on.

        Raises:
            FolderError: it cannot be written.
        """
        Report(self._numbers(sweep), stem=STEM).write(self.folder)

    def write(self, sweep: Sweep) -> list[Path]:
        """Write all files of a sweep, finished or not; return their paths.

        Raises:
            FolderError: a file cannot be written.
        """
        numbers, name = self._numbers(sweep), self.scenes.path.stem
        title, engine = f"What accuracy costs: {name}", self.scenes.config().engine
        report = Report(numbers, title, f"`{self.command}`", STEM, ("md", "html"))
        figure = tradeoff_png(marks_of(sweep), name)
        report.add(
            Sentences(numbers["recommendation"], is_list=True),
            ReportFigure(FIGURE, "time against difference", figure),
        )
        report.section(SETTINGS)
        rows = [
            (
                *_cells(row),
                "" if row.is_default else verdict_of(row, sweep.blur, engine).name.lower(),
            )
            for row in sweep.rows
        ]
        csv = [cells for row in sweep.rows for cells in _csv_rows(row)]
        report.add(
            Sentences([ABOUT]),
            ReportTable(HEADER, rows),
            ReportTable(COLUMNS, csv, file=f"{STEM}.csv", is_shown=False),
            *_omissions("Left out", sweep.left_out),
            *_omissions("Not measured for lack of time", sweep.unmeasured),
        )
        return report.write(self.folder)

    def _numbers(self, sweep: Sweep) -> dict[str, Any]:
        return {
            "command": self.command,
            "recommendation": self.recommendation(sweep),
            **sweep.numbers(),
            "identity": self._identity(),
        }

    def _identity(self) -> dict[str, Any]:
        """Return the identity of rows: config, versions, and whether all scenes are measured."""
        named = identity(self.scenes.config())
        keys = {**named["keys"], "--quick": self.scenes.quick}
        versions = {key: value for key, value in named["versions"].items() if key != "h5py"}
        return {"keys": keys, "versions": versions}


def marks_of(sweep: Sweep) -> list[SettingMark]:
    """Marks of the figure: time and difference of the rows that are compared with the default.

    The difference is the largest rms of a map in levels, of its median scene; of points alone their
    share.
    """
    marks = []
    for row in sweep.rows:
        levels = [numbers.rms_levels_median for numbers in row.maps.values()]
        levels += [255 * row.points.moved] if row.points is not None and not levels else []
        if row.ratio is None or row.base_name != DEFAULT or not levels:
            continue
        name, ratio = (DEFAULT_NAME, 1.0) if row.is_default else (row.name, row.ratio)
        saves = row.saves(sweep.blur)
        marks.append(SettingMark(name, ratio, max(levels), row.is_error, not row.drops_map, saves))
    return marks


def _cells(row: Row) -> tuple[object, ...]:
    """Cells of a row in pages, but for its verdict."""
    name = row.name if row.is_default else f"`{row.name}`"
    time = f"{row.ratio:.2f} ({row.ratio_low:.2f} to {row.ratio_high:.2f})"
    over = "" if row.base_name == DEFAULT else row.base_name
    error = "" if row.error_db is None else f"{row.error_db:.0f}"
    error = "none" if row.error_db == -inf else error
    if row.is_error and row.stated_db is not None:
        error += f" (states {row.stated_db:.0f})"
    changes = "; ".join([*_shown_cells(row), *[row.note] * bool(row.note)])
    return name, row.effect, row.sample_ms, time, over, error, changes


def _shown_cells(row: Row) -> Iterator[str]:
    """Yield how much each map and the points differ, and the accuracy of networks."""
    for name, numbers in row.maps.items():
        over_one, size = numbers.shown(is_worst=row.is_error)
        similar = "" if numbers.ssim is None else f", SSIM {numbers.ssim:.3f}"
        is_same = numbers.changed == 0
        yield f"{name}: " + (
            "the same" if is_same else f"{percent_text(over_one)}, {size}{similar}"
        )
    if row.points is not None:
        distance_m = row.points.distance_m
        moved_by = "" if distance_m is None else f" by {100 * distance_m:.1f} cm"
        number = f"{row.points.per_frame:.1f} a frame ({row.points.base_per_frame:.1f})"
        yield f"points: {percent_text(row.points.moved)} moved{moved_by}, {number}"
    if row.accuracy is not None:
        mean, low, high = (100 * getattr(row.accuracy, end) for end in ("mean", "low", "high"))
        yield f"accuracy {mean:.1f} % ({low:.1f} to {high:.1f})"


def _omissions(words: str, omissions: list[Omission]) -> Iterator[Sentences]:
    """Yield the sentence on settings without a row, and why."""
    if omissions:
        listed = "; ".join(f"{omission.name} ({omission.reason})" for omission in omissions)
        yield Sentences([f"{words}: {listed}."])


def _csv_rows(row: Row) -> Iterator[tuple[object, ...]]:
    """Yield the rows of tradeoff.csv: one for each map of a setting."""
    points, accuracy = row.points, row.accuracy
    for name, numbers in row.maps.items() or [("", None)]:
        cells: tuple[object, ...] = ("",) * 5
        if numbers is not None:
            cells = (
                numbers.changed,
                numbers.over_one,
                numbers.ssim,
                numbers.rms_levels,
                numbers.rms_db,
            )
        yield (
            *(row.group, row.name, row.effect, row.base_name),
            *(row.sample_ms, row.ratio, row.ratio_low, row.ratio_high),
            *(row.error_db, row.stated_db, name, *cells),
            *(("", "") if points is None else (points.moved, points.per_frame)),
            *(("", "", "") if accuracy is None else (accuracy.mean, accuracy.low, accuracy.high)),
        )
