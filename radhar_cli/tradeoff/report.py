"""Files of a sweep: tradeoff.json, which it goes on from, .csv, .md, .png and .html."""

import html
import json
from base64 import b64encode
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from math import inf, isfinite
from pathlib import Path
from typing import Any

from radhar_cli.dataset.files import write_result
from radhar_cli.dataset.identity import differences, identity
from radhar_cli.errors import FolderError
from radhar_cli.figures.tradeoff import DEFAULT_NAME, SettingMark, tradeoff_png
from radhar_cli.files.plain_json import plain
from radhar_cli.files.table_text import csv_text
from radhar_cli.files.untrusted import read_json
from radhar_cli.tradeoff.recommendation import drops_map, recommend, saves, sentences_as_list
from radhar_cli.tradeoff.row import Row
from radhar_cli.tradeoff.scenes import Scenes
from radhar_cli.tradeoff.setting import DEFAULT
from radhar_cli.tradeoff.sweep import Sweep, omissions_text

FILES = CSV, JSON, TEXT, FIGURE, PAGE = (
    *("tradeoff.csv", "tradeoff.json", "tradeoff.md", "tradeoff.png", "tradeoff.html"),
)
SETTINGS = "## Settings"  # heading of the tables
HEADER = "setting", "ms a sample", "time", "over", "error dB", "shown"
_STYLE = (
    "body{font:15px/1.5 system-ui,sans-serif;color:#1f2328;max-width:70rem;margin:2rem auto;"
    "padding:0 1rem}table{border-collapse:collapse}th,td{padding:.2rem .6rem;text-align:left;"
    "border-bottom:1px solid #d8dee4}img{max-width:100%}code{background:#f6f8fa}"
)


@dataclass(frozen=True)
class TradeoffReport:
    """What is written of a sweep.

    Attributes:
        folder: folder of the files.
        scenes: scenes of the sweep.
        command: command line of it.
        cores: cores of the machine.
    """

    folder: Path
    scenes: Scenes
    command: str
    cores: int

    @property
    def title(self) -> str:
        """Title of pages: name of the config."""
        return self.scenes.path.stem

    def read_earlier(self, overwrite: bool) -> Sweep:
        """Sweep that an earlier run of the same command has left in the folder; else an empty one.

        Args:
            overwrite: start over whatever there is.

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
        numbers = {
            "command": self.command,
            "recommendation": self.recommendation(sweep),
            **sweep.numbers(),
            "identity": self._identity(),
        }
        text = json.dumps(plain(numbers), indent=2) + "\n"
        write_result(self.folder, self.folder / JSON, text.encode())

    def write(self, sweep: Sweep) -> list[Path]:
        """Write all files of a sweep, finished or not; return their paths.

        Raises:
            FolderError: a file cannot be written.
        """
        self.keep(sweep)
        figure = tradeoff_png(marks_of(sweep), self.title)
        sentences = self.recommendation(sweep)
        files = {
            CSV: _csv(sweep.rows).encode(),
            TEXT: markdown(self.title, self.command, sweep, sentences).encode(),
            FIGURE: figure,
            PAGE: page(self.title, self.command, sweep, sentences, figure).encode(),
        }
        for name, data in files.items():
            write_result(self.folder, self.folder / name, data)
        return [self.folder / name for name in FILES]

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
        share = _largest_difference(row)
        if row.sample_ms is None or row.ratio is None or row.base_name != DEFAULT or share is None:
            continue
        marks.append(
            SettingMark(
                DEFAULT_NAME if row.is_default else row.name,
                1.0 if row.is_default else row.ratio,
                share,
                row.is_error,
                has_all_maps=not drops_map(row),
                saves=saves(row, sweep.blur),
            )
        )
    return marks


def _largest_difference(row: Row) -> float | None:
    """Largest rms difference of a map in levels, of its median scene; of points alone the share."""
    rms = [numbers.rms_levels_median for numbers in row.maps.values()]
    if rms:
        return max(rms)
    return None if row.points is None else 255 * row.points.moved


def markdown(title: str, command: str, sweep: Sweep, sentences: Sequence[str]) -> str:
    """Text of tradeoff.md.

    Args:
        title: name of the config.
        command: command line.
        sweep: what was measured.
        sentences: its recommendation.
    """
    sections = "\n\n".join(
        f"### {heading}\n\n{about}\n\n{_markdown_table(rows)}"
        for heading, about, rows in _sections(sweep)
    )
    return f"""\
# What accuracy costs: {title}

`{command}`

{sentences_as_list(sentences)}

![time against difference]({FIGURE})

{SETTINGS}

{_about_times(sweep)}

{sections}
{_omitted(sweep)}"""


def page(title: str, command: str, sweep: Sweep, sentences: Sequence[str], figure: bytes) -> str:
    """Text of tradeoff.html, a page that needs no other file.

    Args:
        title: name of the config.
        command: command line.
        sweep: what was measured.
        sentences: its recommendation.
        figure: its figure, PNG.
    """
    items = "".join(f"<li>{_code(sentence)}</li>" for sentence in sentences)
    tables = "".join(
        f"<h3>{heading}</h3><p>{_code(about)}</p>{_html_table(rows)}"
        for heading, about, rows in _sections(sweep)
    )
    image = b64encode(figure).decode()
    name = html.escape(title)
    return (
        '<!doctype html>\n<html lang="en"><head><meta charset="utf-8">'
        f"<title>What accuracy costs: {name}</title><style>{_STYLE}</style></head><body>"
        f"<h1>What accuracy costs: {name}</h1><p><code>{html.escape(command)}</code></p>"
        f'<ul>{items}</ul><img alt="time against difference" '
        f'src="data:image/png;base64,{image}"><h2>Settings</h2>'
        f"<p>{_code(_about_times(sweep))}</p>{tables}<p>{_code(_omitted(sweep))}</p></body></html>\n"
    )


def _code(text: str) -> str:
    """HTML of a text in which `words` are code."""
    parts = html.escape(text).split("`")
    return "".join(f"<code>{part}</code>" if n % 2 else part for n, part in enumerate(parts))


def _about_times(sweep: Sweep) -> str:
    """What times are, in words."""
    default = sweep.row_of(DEFAULT)
    scenes = 0 if default is None else default.scenes
    return (
        f"A sample is everything from drawing a scene to grey levels and entropy, without files. "
        f"Times are of one process, ratios medians over rounds in turns with what they are over, "
        f"with intervals (trust these: ms of different rows are of different moments); {scenes} "
        f"scene{'s' * (scenes != 1)}. What is shown is that of each map: "
        "the share of pixels more than a level apart, rms, SSIM."
    )


def _sections(sweep: Sweep) -> Iterable[tuple[str, str, list[Row]]]:
    """Headings, what their tables show, and rows."""
    errors = [row for row in sweep.rows if row.is_error]
    pictures = [row for row in sweep.rows if not row.is_error]
    yield (
        "Error: the same physics, computed otherwise",
        "Against the exact sum in float64, with the same noise on both sides; the worst scene's.",
        errors,
    )
    yield (
        "Another picture: other physics, or other parameters",
        "Against what the time is over, without noise; medians of the scenes. Such a difference is "
        "no error.",
        pictures,
    )


def _cells(row: Row) -> list[str]:
    """Cells of a row in pages."""
    sample = "" if row.sample_ms is None else f"{row.sample_ms:.1f}"
    ratio = ""
    if row.ratio is not None:
        ratio = f"{row.ratio:.2f} ({row.ratio_low:.2f} to {row.ratio_high:.2f})"
    name = f"**{row.name}**" if row.is_default else f"`{row.name}`"
    visible = "; ".join(_shown_cells(row))
    if row.accuracy is not None:
        accuracy = row.accuracy
        visible += f"; accuracy {100 * accuracy.mean:.1f} % "
        visible += f"({100 * accuracy.low:.1f} to {100 * accuracy.high:.1f})"
    note = f" ({row.note})" if row.note else ""
    over = "" if row.base_name == DEFAULT else row.base_name
    return [name, sample, ratio, over, _error_text(row), visible + note]


def _error_text(row: Row) -> str:
    """Error of the signal, and what the engine states of it."""
    if row.error_db is None:
        return ""
    text = "exact" if row.error_db == -inf else f"{row.error_db:.0f}"
    if not row.is_error:
        return "the same" if row.error_db == -inf else text
    is_stated = row.stated_db is not None and isfinite(row.stated_db)
    return f"{text} (states {row.stated_db:.0f})" if is_stated else text


def _shown_cells(row: Row) -> Iterable[str]:
    """What each map and the points show."""
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


def _markdown_table(rows: Sequence[Row]) -> str:
    lines = [HEADER, ["---"] * len(HEADER), *map(_cells, rows)]
    return "\n".join(f"| {' | '.join(cell.replace('|', '/') for cell in line)} |" for line in lines)


def _html_table(rows: Sequence[Row]) -> str:
    def line(cells: Iterable[str], tag: str, form: Callable[[str], str]) -> str:
        return "<tr>" + "".join(f"<{tag}>{form(cell)}</{tag}>" for cell in cells) + "</tr>"

    body = "".join(
        line(_cells(row), "td", lambda cell: _code(cell.replace("**", ""))) for row in rows
    )
    return f"<table>{line(HEADER, 'th', html.escape)}{body}</table>"


def _omitted(sweep: Sweep) -> str:
    """What has no row, and why."""
    lines = []
    if sweep.left_out:
        lines.append(f"\nLeft out: {omissions_text(sweep.left_out)}.\n")
    if sweep.unmeasured:
        lines.append(f"\nNot measured for lack of time: {omissions_text(sweep.unmeasured)}.\n")
    return "".join(lines)


def _csv(rows: Sequence[Row]) -> str:
    """Text of tradeoff.csv: a line for each setting and map."""
    header = (
        *("group", "setting", "effect", "over", "sample_ms", "ratio", "ratio_low", "ratio_high"),
        *("error_db", "stated_db", "map", "changed", "over_one", "ssim", "rms_levels", "rms_db"),
        *("points_moved", "points_per_frame", "accuracy", "accuracy_low", "accuracy_high"),
    )
    lines = list[list[object]]()
    for row in rows:
        numbers: Mapping[str, Any] = row.maps or {"": None}
        points = ("", "")
        accuracy: tuple[object, ...] = ("", "", "")
        if row.points is not None:
            points = (f"{row.points.moved:.6g}", f"{row.points.per_frame:.6g}")
        if row.accuracy is not None:
            accuracy = row.accuracy.mean, row.accuracy.low, row.accuracy.high
        for name, each in numbers.items():
            visible: tuple[object, ...] = ("",) * 5
            if each is not None:
                visible = each.changed, each.over_one, each.ssim, each.rms_levels, each.rms_db
            times = row.sample_ms, row.ratio, row.ratio_low, row.ratio_high
            start = row.group, row.name, str(row.effect), row.base_name
            errors = row.error_db, row.stated_db
            lines.append([*start, *times, *errors, name, *visible, *points, *accuracy])
    return csv_text(header, lines)
