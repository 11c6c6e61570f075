"""Report of a sweep: tradeoff.json, which it goes on from, .csv, .md, .png and .html."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from math import inf, isfinite
from pathlib import Path
from typing import Any

from radhar_cli.dataset.identity import differences, identity
from radhar_cli.errors import FolderError
from radhar_cli.figures.report.parts import ReportFigure, ReportTable, Sentences
from radhar_cli.figures.report.report import Report
from radhar_cli.figures.tradeoff import DEFAULT_NAME, SettingMark, tradeoff_png
from radhar_cli.files.untrusted import read_json
from radhar_cli.study.tradeoff.recommendation import drops_map, recommend, saves
from radhar_cli.study.tradeoff.row import Row
from radhar_cli.study.tradeoff.scenes import Scenes
from radhar_cli.study.tradeoff.setting import DEFAULT
from radhar_cli.study.tradeoff.sweep import Sweep, omissions_text

STEM = "tradeoff"
CSV, JSON, TEXT, FIGURE = (f"{STEM}.{suffix}" for suffix in ("csv", "json", "md", "png"))
SETTINGS = "Settings"  # heading of the tables
HEADER = "setting", "ms a sample", "time", "over", "error dB", "shown"
COLUMNS = (
    *("group", "setting", "effect", "over", "sample_ms", "ratio", "ratio_low", "ratio_high"),
    *("error_db", "stated_db", "map", "changed", "over_one", "ssim", "rms_levels", "rms_db"),
    *("points_moved", "points_per_frame", "accuracy", "accuracy_low", "accuracy_high"),
)


@dataclass(frozen=True)
class TradeoffReport:
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
        numbers = read_json(path)
        try:
            differing = differences(numbers["identity"], self._identity())
            sweep = Sweep.read(numbers)
        except (KeyError, TypeError, ValueError, AttributeError):
            raise FolderError(
                f"{path}: is no result of this version of radhar; --overwrite replaces it, another "
                "folder keeps it"
            ) from None
        if differing:
            raise FolderError(
                f"{self.folder}: holds another sweep; it differs in\n  "
                + "\n  ".join(differing)
                + "\n--overwrite replaces it, another folder keeps it"
            )
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
        title = f"What accuracy costs: {name}"
        report = Report(numbers, title, f"`{self.command}`", STEM, ("md", "html"))
        figure = tradeoff_png(marks_of(sweep), name)
        report.add(
            Sentences(numbers["recommendation"], is_list=True),
            ReportFigure(FIGURE, "time against difference", figure),
        )
        report.section(SETTINGS)
        report.add(Sentences([_describe_times(sweep)]), *_tables(sweep))
        report.add(*_omissions(sweep))
        report.add(ReportTable(COLUMNS, [*_csv_rows(sweep)], file=CSV, is_shown=False))
        return report.write(self.folder)

    def _numbers(self, sweep: Sweep) -> dict[str, Any]:
        return {
            "command": self.command,
            "recommendation": self.recommendation(sweep),
            **sweep.numbers(),
            "identity": self._identity(),
        }

    def _identity(self) -> dict[str, Any]:
        """What rows depend on: config, versions, and whether all scenes are measured."""
        named = identity(self.scenes.config())
        keys = {**named["keys"], "--quick": self.scenes.quick}
        versions = {key: value for key, value in named["versions"].items() if key != "h5py"}
        return {"keys": keys, "versions": versions}


def marks_of(sweep: Sweep) -> list[SettingMark]:
    """Marks of the figure: time and difference of the rows that are compared with the default."""
    marks = []
    for row in sweep.rows:
        levels = _largest_difference(row)
        if row.sample_ms is None or row.ratio is None or row.base_name != DEFAULT or levels is None:
            continue
        name, ratio = (DEFAULT_NAME, 1.0) if row.is_default else (row.name, row.ratio)
        is_saving = saves(row, sweep.blur)
        marks.append(SettingMark(name, ratio, levels, row.is_error, not drops_map(row), is_saving))
    return marks


def _largest_difference(row: Row) -> float | None:
    """Largest rms difference of a map in levels, of its median scene; of points alone the share."""
    rms = [numbers.rms_levels_median for numbers in row.maps.values()]
    if rms:
        return max(rms)
    return None if row.points is None else 255 * row.points.moved


def _describe_times(sweep: Sweep) -> str:
    """Sentence on how times were measured."""
    default = sweep.row_of(DEFAULT)
    scenes = 0 if default is None else default.scenes
    return (
        f"A sample is everything from drawing a scene to grey levels and entropy, without files. "
        f"Times are of one process, ratios medians over rounds in turns with what they are over, "
        f"with intervals (trust these: ms of different rows are of different moments); {scenes} "
        f"scene{'s' * (scenes != 1)}. What is shown is that of each map: "
        "the share of pixels more than a level apart, rms, SSIM."
    )


def _tables(sweep: Sweep) -> Iterator[ReportTable]:
    """Yield the tables of the pages: errors of computation, and other pictures."""
    for is_error, title, about in (
        (
            True,
            "Error: the same physics, computed otherwise",
            "Against the exact sum in float64, with the same noise on both sides; the worst "
            "scene's.",
        ),
        (
            False,
            "Another picture: other physics, or other parameters",
            "Against what the time is over, without noise; medians of the scenes. Such a "
            "difference is no error.",
        ),
    ):
        rows = [_cells(row) for row in sweep.rows if row.is_error == is_error]
        yield ReportTable(HEADER, rows, title, about=about)


def _cells(row: Row) -> list[str]:
    """Cells of a row in pages."""
    sample = "" if row.sample_ms is None else f"{row.sample_ms:.1f}"
    ratio = ""
    if row.ratio is not None:
        ratio = f"{row.ratio:.2f} ({row.ratio_low:.2f} to {row.ratio_high:.2f})"
    name = row.name if row.is_default else f"`{row.name}`"
    visible = "; ".join(_shown_cells(row))
    if row.accuracy is not None:
        mean, low, high = (100 * getattr(row.accuracy, end) for end in ("mean", "low", "high"))
        visible += f"; accuracy {mean:.1f} % ({low:.1f} to {high:.1f})"
    over = "" if row.base_name == DEFAULT else row.base_name
    return [
        *(name, sample, ratio, over, _error_text(row)),
        visible + (f" ({row.note})" if row.note else ""),
    ]


def _error_text(row: Row) -> str:
    """Error of the signal, and what the engine states of it."""
    if row.error_db is None:
        return ""
    text = "exact" if row.error_db == -inf else f"{row.error_db:.0f}"
    if not row.is_error:
        return "the same" if row.error_db == -inf else text
    is_stated = row.stated_db is not None and isfinite(row.stated_db)
    return f"{text} (states {row.stated_db:.0f})" if is_stated else text


def _shown_cells(row: Row) -> Iterator[str]:
    """Yield how much each map and the points differ."""
    for name, numbers in row.maps.items():
        if numbers.changed == 0:
            yield f"{name}: the same"
            continue
        over_one, rms_levels, rms_db = numbers.over_one, numbers.rms_levels, numbers.rms_db
        if not row.is_error:
            over_one, rms_levels = numbers.over_one_median, numbers.rms_levels_median
            rms_db = numbers.rms_median_db
        size = f"{rms_levels:.2g} levels" if rms_db is None else f"{rms_db:.2g} dB"
        similar = "" if numbers.ssim is None else f", SSIM {numbers.ssim:.3f}"
        yield f"{name}: {100 * over_one:.2g} %, {size}{similar}"
    if row.points is not None:
        points = row.points
        moved_by = "" if points.distance_m is None else f" by {100 * points.distance_m:.1f} cm"
        yield (
            f"points: {100 * points.moved:.2g} % moved{moved_by}, {points.per_frame:.1f} a frame "
            f"({points.base_per_frame:.1f})"
        )


def _omissions(sweep: Sweep) -> Iterator[Sentences]:
    """Yield sentences on settings without a row, and why."""
    for words, omissions in (
        ("Left out", sweep.left_out),
        ("Not measured for lack of time", sweep.unmeasured),
    ):
        if omissions:
            yield Sentences([f"{words}: {omissions_text(omissions)}."])


def _csv_rows(sweep: Sweep) -> Iterator[Sequence[object]]:
    """Yield the rows of tradeoff.csv: one for each setting and map."""
    for row in sweep.rows:
        points: tuple[object, ...] = ("", "")
        accuracy: tuple[object, ...] = ("", "", "")
        if row.points is not None:
            points = (f"{row.points.moved:.6g}", f"{row.points.per_frame:.6g}")
        if row.accuracy is not None:
            accuracy = row.accuracy.mean, row.accuracy.low, row.accuracy.high
        start = (
            *(row.group, row.name, str(row.effect), row.base_name),
            *(row.sample_ms, row.ratio, row.ratio_low, row.ratio_high),
            *(row.error_db, row.stated_db),
        )
        for name, each in row.maps.items() or [("", None)]:
            visible: tuple[object, ...] = ("",) * 5
            if each is not None:
                visible = each.changed, each.over_one, each.ssim, each.rms_levels, each.rms_db
            yield (*start, name, *visible, *points, *accuracy)
