"""The writer of reports: numbers, tables, figures and pages, whatever stands in them."""

import csv
import json
import re

import pytest

from radhar_cli.figures.report.parts import (
    Details,
    ReportFigure,
    ReportTable,
    Sentences,
    number_text,
)
from radhar_cli.figures.report.report import Report

PNG = b"\x89PNG"
HOSTILE = '<script>alert("a")</script>'
TABLE = ReportTable(("class_name", "share"), [("a|b", 0.5), (HOSTILE, 1234567)], "Classes", "t.csv")


def report(**more):
    made = Report({"x": (1, float("nan"))}, f"On {HOSTILE}", "`radhar x`", **more)
    made.line("warning: `a.png` is dark")
    made.section("All")
    made.add(Sentences(["first", "second"], is_list=True), TABLE)
    made.add(ReportFigure("f.png", f"Of {HOSTILE}", PNG), Details("Config", "a: <b>"))
    made.add(ReportTable(("hidden",), [("no",)], file="h.csv", is_shown=False))
    return made


def test_every_format_has_its_file(tmp_path):
    written = report(stem="mine", formats=("md", "html")).write(tmp_path)
    names = ["mine.json", "t.csv", "f.png", "h.csv", "mine.md", "mine.html"]
    assert [path.name for path in written] == names
    assert json.loads(written[0].read_text()) == {"x": [1, None]}
    with written[1].open() as file:
        assert [*csv.reader(file)] == [
            ["class_name", "share"],
            ["a|b", "0.5"],
            [HOSTILE, "1234567"],
        ]


def test_a_page_shows_names_from_elsewhere_as_they_are(tmp_path):
    report(formats=("html",)).write(tmp_path)
    page = (tmp_path / "report.html").read_text()
    assert "<script" not in page
    assert page.count("&lt;script&gt;") == 5  # title twice, table, figure twice
    assert '<p class="warning">warning: <code>a.png</code> is dark</p>' in page
    assert "<ul><li>first</li><li>second</li></ul>" in page
    assert '<th>class name</th><th class="number">share</th>' in page
    assert '<td class="number">1\u202f234\u202f567</td>' in page
    assert "hidden" not in page
    assert re.findall(r'src="([^"]*)"', page) == ["data:image/png;base64,iVBORw=="]


def test_numbers_of_a_page_have_three_digits(tmp_path):
    made = Report({}, "t", formats=("html", "md"))
    made.add(ReportTable(("share",), [(0.123456,)]))
    made.write(tmp_path)
    assert '<td class="number">0.123</td>' in (tmp_path / "report.html").read_text()
    assert "| 0.1235 |" in (tmp_path / "report.md").read_text()


def test_markdown_keeps_cells_apart(tmp_path):
    report(formats=("md",)).write(tmp_path)
    text = (tmp_path / "report.md").read_text()
    assert "| class name | share |\n| --- | --- |\n| a\\|b | 0.5 |" in text
    assert "- first\n- second\n\n### Classes" in text
    assert "](f.png)" in text
    assert "hidden" not in text


def test_a_later_report_removes_the_files_that_it_lacks(tmp_path):
    folder, outside = tmp_path / "out", tmp_path / "outside.csv"
    outside.write_text("mine")
    report(lists_files=True).write(folder)
    numbers = json.loads((folder / "report.json").read_text())
    assert numbers["files"] == ["f.png", "h.csv", "t.csv"]
    (folder / "notes.txt").write_text("mine")
    numbers["files"] += ["../outside.csv", "notes.txt", str(outside)]
    (folder / "report.json").write_text(json.dumps(numbers))
    later = Report({}, lists_files=True)
    later.add(TABLE)
    later.write(folder)
    assert {path.name for path in folder.iterdir()} == {"report.json", "t.csv", "notes.txt"}
    assert outside.read_text() == "mine"


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (None, ""),
        (True, "True"),
        (12345, "12\u202f345"),
        (2.0, "2"),
        (0.123456, "0.1235"),
        (float("nan"), "nan"),
        ("x", "x"),
    ],
)
def test_numbers_as_people_read_them(value, text):
    assert number_text(value) == text
