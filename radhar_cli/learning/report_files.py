"""A report on disk: figures, tables, report.json, and a self-contained report.html."""

import base64
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from jinja2 import Environment

from radhar_cli.dataset.files import write_whole
from radhar_cli.learning.report_folder import csv_text, write_report

PAGE = "report.html"
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
<h2>Accuracy</h2>
<table><tr><th>run</th><th>data</th><th>split</th><th>map</th>
<th>SNR (dB)</th><th>images</th><th>accuracy (%)</th>
<th>interval (%)</th><th>macro F1</th><th>calibration error</th></tr>
{% for name, run in n.runs.items() %}{% for data, r in run.data.items() if r.accuracy is defined %}
<tr><td>{{ name }}</td><td>{{ data }}</td><td>{{ r.split }}</td><td>{{ r.map or "" }}</td>
<td>{{ "" if r.snr_db is none else r.snr_db }}</td>
<td>{{ r.images }}</td><td>{{ "%.2f" | format(100 * r.accuracy) }}</td>
<td>{{ "%.2f" | format(100 * r.accuracy_95[0]) }} to {{ "%.2f" | format(100 * r.accuracy_95[1]) }}
</td><td>{{ "%.4f" | format(r.macro_f1) }}</td><td>{{ "%.4f" | format(r.calibration_error) }}</td>
</tr>{% endfor %}{% endfor %}</table>
{% for name, run in n.runs.items() %}{% for data, r in run.data.items() %}
{% if r.mpjpe_cm is defined %}<p>{{ name }} on {{ data }}, {{ r.split }}, {{ r.map }}:
mean absolute error {{ "%.2f" | format(r.mean_absolute_error_cm) }} cm, MPJPE
{{ "%.2f" | format(r.mpjpe_cm) }} cm (the mean pose in its place
{{ "%.2f" | format(r.mpjpe_of_the_mean_pose_in_place_cm) }} cm), {{ r.frames }} frames.</p>
{% elif r.exact_match is defined %}<p>{{ name }} on {{ data }}, {{ r.split }}, {{ r.map }}:
mean average precision {{ "%.2f" | format(100 * r.mean_average_precision) }} %, all labels right in
{{ "%.2f" | format(100 * r.exact_match) }} % of {{ r.images }} images.</p>
{% endif %}{% if r.seen_in_training.images or r.seen_in_training.scenes %}
<p class="warning">{{ name }} on {{ data }}: {{ r.seen_in_training.images }} of {{ r.images }}
images, and the person and motion of {{ r.seen_in_training.scenes }}, were trained on.</p>
{% endif %}{% if r.left_out %}<p class="warning">{{ name }} on {{ data }}: left out
{% for class, n in r.left_out.items() %}{{ class }} ({{ n }} images){{ ", " if not loop.last }}
{% endfor %}</p>{% endif %}{% endfor %}{% endfor %}
<h2>Networks</h2>
<table><tr><th>run</th><th>model</th><th>parameters</th><th>multiply-adds (G)</th>
<th>best epoch</th>
<th>trained on</th><th>loading (ms)</th><th>one image (ms)</th><th>both (ms)</th>
<th>images/s at {{ n.batch }}</th></tr>
{% for name, run in n.runs.items() %}<tr><td>{{ name }}</td><td>{{ run.model }}</td>
<td>{{ "{:,}".format(run.parameters) }}</td><td>{{ "%.3f" | format(run.multiply_adds / 1e9) }}</td>
<td>{{ run.best_epoch or "" }}</td><td>{{ run.trained_on.path }}</td>
<td>{{ "%.0f" | format(1e3 * run.speed.load_s) }}</td>
<td>{{ "%.1f" | format(1e3 * run.speed.image_s) }}</td>
<td>{{ "%.0f" | format(1e3 * run.speed.load_and_image_s) }}</td>
<td>{{ "%.1f" | format(run.speed.images_per_s) }}</td></tr>{% endfor %}</table>
{% for name, run in n.runs.items() %}{% for data, r in run.data.items() %}
<h2>{{ name }} on {{ data }}</h2>
{% if r.mpjpe_cm is defined %}
<table><tr><th>class</th><th>frames</th><th>MPJPE (cm)</th></tr>
{% for class, c in r.classes.items() %}<tr><td>{{ class }}</td><td>{{ c.frames }}</td>
<td>{{ "%.2f" | format(c.mpjpe_cm) }}</td></tr>{% endfor %}</table>
<table><tr><th>joint</th><th>MPJPE (cm)</th><th>ahead</th><th>left</th><th>up</th></tr>
{% for joint, c in r.joints.items() %}<tr><td>{{ joint }}</td>
{% for cm in c.values() %}<td>{{ "%.2f" | format(cm) }}</td>{% endfor %}</tr>{% endfor %}</table>
{% elif r.exact_match is defined %}
<table><tr><th>label</th><th>images</th><th>average precision</th></tr>
{% for class, c in r.classes.items() %}<tr><td>{{ class }}</td><td>{{ c.images }}</td>
<td>{{ "%.4f" | format(c.average_precision) }}</td></tr>{% endfor %}</table>
<table><tr><th>people</th><th>images</th><th>all labels right (%)</th></tr>
{% for count, c in r.people.items() %}<tr><td>{{ count }}</td><td>{{ c.images }}</td>
<td>{{ "%.2f" | format(100 * c.exact_match) }}</td></tr>{% endfor %}</table>
{% else %}
<table><tr><th>class</th><th>images</th><th>precision</th><th>recall</th><th>F1</th></tr>
{% for class, c in r.classes.items() %}<tr><td>{{ class }}</td><td>{{ c.images }}</td>
<td>{{ "%.4f" | format(c.precision) }}</td><td>{{ "%.4f" | format(c.recall) }}</td>
<td>{{ "%.4f" | format(c.f1) }}</td></tr>{% endfor %}</table>{% endif %}
{% endfor %}{% endfor %}
<h2>Figures</h2>
{% for name, caption, data in figures %}<figure><img alt="{{ name }}"
src="data:image/png;base64,{{ data }}"><figcaption>{{ caption }}</figcaption></figure>
{% endfor %}
</body></html>
"""


@dataclass
class Report:
    """Files of a report, in the order in which they are read, and its numbers."""

    numbers: dict[str, Any]
    figures: list[tuple[str, str, bytes]] = field(default_factory=list)
    tables: list[tuple[str, str]] = field(default_factory=list)

    def figure(self, name: str, caption: str, png: bytes) -> None:
        """Add a figure."""
        self.figures.append((name, caption, png))

    def table(self, name: str, header: Sequence[object], rows: Iterable[Iterable[object]]) -> None:
        """Add a table."""
        self.tables.append((name, csv_text(header, rows)))

    def write(self, folder: Path) -> None:
        """Write everything into a folder; report.json comes last."""
        files = {name: png for name, _, png in self.figures}
        files |= {name: text.encode("utf-8", "surrogateescape") for name, text in self.tables}
        figures = [(name, text, base64.b64encode(png).decode()) for name, text, png in self.figures]
        page = (
            Environment(autoescape=True).from_string(_PAGE).render(n=self.numbers, figures=figures)
        )
        write_whole(folder, folder / PAGE, page.encode("utf-8", "backslashreplace"))
        write_report(folder, files, self.numbers)
