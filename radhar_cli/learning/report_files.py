"""A report on disk: figures, tables, report.json, and a self-contained report.html."""

from base64 import b64encode
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from jinja2 import Environment

from radhar_cli.dataset.files import write_whole
from radhar_cli.learning.report_folder import csv_text, write_report

PAGE = "report.html"
LONG = "predictions"  # tables of a row an image, which the page leaves to their files
_PAGE = """<!doctype html>
<html lang="en"><head><meta charset="utf-8"><title>radhar eval</title>
<style>
body { font: 15px/1.45 system-ui, sans-serif; max-width: 70rem; margin: 2rem auto; }
table { border-collapse: collapse; margin: .6rem 0 1.4rem; }
th, td { padding: .18rem .6rem; border-bottom: 1px solid #ccc; text-align: right; }
th:first-child, td:first-child { text-align: left; }
.warning { background: #fff3cd; padding: .4rem .8rem; }
figure { margin: 1.2rem 0; } img { max-width: 100%; } figcaption { color: #555; }
</style></head><body>
<h1>radhar eval: {{ n.runs | join(", ") }}</h1>
<p>Device: {{ n.device }}, {{ n.threads }} threads, float32. Intervals are Wilson's, 95 %.</p>
{% for line in lines %}<p{% if "warning:" in line %} class="warning"{% endif %}>{{ line }}</p>
{% endfor %}
{% for name, head, rows in tables %}<h2>{{ name }}</h2>
<table><tr>{% for one in head %}<th>{{ one }}</th>{% endfor %}</tr>
{% for row in rows %}<tr>{% for one in row %}<td>{{ one }}</td>{% endfor %}</tr>
{% endfor %}</table>{% endfor %}
<h2>Figures</h2>
{% for name, caption, data in figures %}<figure><img alt="{{ name }}"
src="data:image/png;base64,{{ data }}"><figcaption>{{ caption }}</figcaption></figure>
{% endfor %}
</body></html>
"""


@dataclass
class Report:
    """Lines, figures and tables of a report, in the order in which they are read; its numbers."""

    numbers: dict[str, Any]
    lines: list[str] = field(default_factory=list)
    figures: list[tuple[str, str, bytes]] = field(default_factory=list)
    tables: list[tuple[str, Sequence[object], list[list[object]]]] = field(default_factory=list)

    def figure(self, name: str, caption: str, png: bytes) -> None:
        """Add a figure."""
        self.figures.append((name, caption, png))

    def table(self, name: str, header: Sequence[object], rows: Iterable[Iterable[object]]) -> None:
        """Add a table."""
        self.tables.append((name, header, [[*row] for row in rows]))

    def write(self, folder: Path) -> None:
        """Write everything into a folder; report.json comes last."""
        files = {name: png for name, _, png in self.figures}
        for name, head, rows in self.tables:
            files[name] = csv_text(head, rows).encode("utf-8", "surrogateescape")
        page = Environment(autoescape=True).from_string(_PAGE)
        text = page.render(
            n=self.numbers,
            lines=self.lines,
            tables=[one for one in self.tables if not one[0].startswith(LONG)],
            figures=[(name, what, b64encode(png).decode()) for name, what, png in self.figures],
        )
        write_whole(folder, folder / PAGE, text.encode("utf-8", "backslashreplace"))
        write_report(folder, files, self.numbers)
