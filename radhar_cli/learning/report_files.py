"""A report on disk: figures, tables, report.json, and a self-contained report.html."""

from base64 import b64encode
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from radhar_cli.dataset.files import write_result
from radhar_cli.learning.report_folder import csv_text, write_report

PAGE = "report.html"
_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1"><title>{{ title }}</title>
<style>
:root { --line: #d8dee4; --soft: #57606a; }
body { font: 15px/1.5 system-ui, sans-serif; color: #1f2328; max-width: 66rem; margin: 2rem auto;
  padding: 0 1rem; }
h1 { font-size: 1.7rem; margin-bottom: .2rem; }
h2 { border-bottom: 1px solid var(--line); padding-bottom: .25rem; margin-top: 2.4rem; }
h3 { margin: 1.4rem 0 .3rem; font-size: 1rem; }
.scroll { overflow-x: auto; }
table { border-collapse: collapse; margin: .4rem 0 1.2rem; font-variant-numeric: tabular-nums; }
th, td { padding: .22rem .7rem; border-bottom: 1px solid var(--line); text-align: right; }
th { color: var(--soft); font-weight: 600; }
th:first-child, td:first-child { text-align: left; }
.soft, figcaption { color: var(--soft); }
.warning { background: #fff8c5; border-left: 4px solid #d4a72c; padding: .4rem .8rem; }
figure { margin: 1.2rem 0; } img { max-width: 100%; height: auto; }
pre { background: #f6f8fa; padding: .8rem; overflow-x: auto; font-size: 13px; }
</style></head><body>
<h1>{{ title }}</h1>
<p class="soft">{{ about }}</p>
{% for section in sections %}{% if section.title %}<h2>{{ section.title }}</h2>
{% endif %}{% for part in section.parts %}{% if part.kind == "line" %}
<p{% if part.warning %} class="warning"{% endif %}>{{ part.text }}</p>
{% elif part.kind == "table" %}<h3>{{ part.title }}</h3>
<div class="scroll"><table><tr>{% for cell in part.head %}<th>{{ cell }}</th>{% endfor %}</tr>
{% for row in part.rows %}<tr>{% for cell in row %}<td>{{ cell }}</td>{% endfor %}</tr>
{% endfor %}</table></div>
{% elif part.kind == "details" %}<details><summary>{{ part.title }}</summary>
<pre>{{ part.text }}</pre></details>
{% else %}<figure><img alt="{{ part.caption }}"
src="data:image/png;base64,{{ part.data }}"><figcaption>{{ part.caption }}</figcaption></figure>
{% endif %}{% endfor %}{% endfor %}
<p class="soft">The same numbers for programs: report.json; each figure and table is a file beside
this page.</p>
</body></html>
"""


@dataclass
class ReportSection:
    """A part of the page under a heading: lines, figures and tables, in their order."""

    title: str
    parts: list[dict[str, object]] = field(default_factory=list)


@dataclass
class Report:
    """Numbers of a report, and its lines, figures and tables in the order of the page."""

    numbers: dict[str, Any]
    title: str = "Evaluation"
    about: str = ""  # a line below the title
    lines: list[str] = field(default_factory=list)
    figures: list[tuple[str, str, bytes]] = field(default_factory=list)
    tables: list[tuple[str, Sequence[object], list[list[object]]]] = field(default_factory=list)
    sections: list[ReportSection] = field(default_factory=lambda: [ReportSection("")])
    # {score: {run: {data set: value}}}, by which a program sums up what was found
    scores: dict[str, dict[str, dict[str, float]]] = field(default_factory=dict)

    def add_score(self, score: str, run: str, data: str, value: float) -> None:
        """Add the number by which a run on a data set is summed up."""
        self.scores.setdefault(score, {}).setdefault(run, {})[data] = value

    def section(self, title: str) -> None:
        """Begin a part of the page, below whose heading the next parts are added."""
        self.sections.append(ReportSection(title))

    def line(self, text: str) -> None:
        """Add a line to those at the top of the page."""
        self.lines.append(text)
        top = {"kind": "line", "text": text, "warning": "warning:" in text}
        self.sections[0].parts.append(top)

    def details(self, title: str, text: str) -> None:
        """Add a text that the page folds away until a reader opens it."""
        self._add("details", title=title, text=text)

    def figure(self, name: str, caption: str, png: bytes) -> None:
        """Add a figure: name of its file, caption, and content of the PNG."""
        self.figures.append((name, caption, png))
        self._add("figure", caption=caption, data=b64encode(png).decode())

    def table(
        self,
        name: str,
        header: Sequence[object],
        rows: Iterable[Iterable[object]],
        title: str | None = None,
    ) -> None:
        """Add a table.

        Args:
            name: name of its CSV file.
            header: titles of the columns.
            rows: cells, row by row.
            title: title on the page; None leaves the table to its file.
        """
        table_rows = [[*row] for row in rows]
        self.tables.append((name, header, table_rows))
        if title is not None:
            self.show_table(title, [str(column).replace("_", " ") for column in header], table_rows)

    def show_table(
        self, title: str, header: Sequence[object], rows: Iterable[Iterable[object]]
    ) -> None:
        """Add a table that the page alone has."""
        cells = [[_as_people_read(value) for value in row] for row in rows]
        self._add("table", title=title, head=list(header), rows=cells)

    def _add(self, kind: str, **content: object) -> None:
        self.sections[-1].parts.append({"kind": kind, **content})

    def write(self, folder: Path) -> None:
        """Write page, figures and tables into a folder, report.json last.

        Raises:
            FolderError: a file cannot be written.
        """
        from jinja2 import Environment

        files = {name: png for name, _, png in self.figures}
        for name, header, rows in self.tables:
            files[name] = csv_text(header, rows).encode("utf-8", "surrogateescape")
        page = Environment(autoescape=True).from_string(_PAGE)
        sections = [section for section in self.sections if section.parts]
        text = page.render(title=self.title, about=self.about, sections=sections)
        write_result(folder, folder / PAGE, text.encode("utf-8", "backslashreplace"))
        write_report(folder, files, self.numbers)


@dataclass(frozen=True)
class ResultPage:
    """Part of a report about one run on one data set; the names of its files end alike."""

    report: Report
    stem: str  # end of the names of its files
    title: str  # of its figures

    def figure(self, name: str, caption: str, png: bytes) -> None:
        """Add a figure: name without its end, caption, and content of the PNG."""
        self.report.figure(f"{name}{self.stem}.png", caption, png)

    def table(
        self,
        name: str,
        header: Sequence[object],
        rows: Iterable[Iterable[object]],
        title: str | None = None,
    ) -> None:
        """Add a table, as `Report.table` does; `name` is without its end."""
        self.report.table(f"{name}{self.stem}.csv", header, rows, title)


def _as_people_read(value: object) -> object:
    """A number as a person reads it; anything else as it is."""
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return "" if value is None else value
    if isinstance(value, int) or value == int(value):
        return f"{int(value):,}".replace(",", "\u202f")
    return f"{value:.4g}"
