"""What an audit adds to the report of `eval`."""

import json

from radhar_cli.figures.report.report import Report
from radhar_cli.learning.report import _add_audit

LINE = {"part": "numbers", "name": "motion.range_m", "share": 0.25, "low": 0.2, "high": 0.3}
LINE |= {"chance": 0.1, "verdict": "tells some of the class", "cure": "motion.range_m: 2"}
UNTESTED = {**LINE, "name": "snr_db", "cure": "", **dict.fromkeys(("share", "low", "high"))}
STORED = {
    "kind": "radhar audit",
    "samples": 20,
    "classes": ["a", "b"],
    "held_out": "person",
    "lines": [LINE, UNTESTED],
    "sentences": [],
}


def data_set(folder, stored):
    (folder / "audit").mkdir()
    (folder / "dataset.h5").touch()
    (folder / "audit/audit.json").write_text(json.dumps(stored))
    return folder


def test_the_report_has_the_figure(tmp_path):
    report = Report({})
    _add_audit(report, "mine", data_set(tmp_path, STORED), single=True)
    ((name, caption, png),) = report.figures
    assert name == "audit.png"
    assert "motion.range_m: tells some of the class" in caption
    assert "20 samples, persons held out" in caption
    assert png.startswith(b"\x89PNG")


def test_the_audit_of_an_earlier_build_is_not_shown(tmp_path):
    report = Report({})
    _add_audit(report, "mine", data_set(tmp_path, {**STORED, "bytes": 7}), single=True)
    assert not report.figures
    assert not report.lines


def test_a_damaged_audit_is_a_warning(tmp_path):
    report = Report({})
    _add_audit(report, "mine", data_set(tmp_path, {"kind": "other"}), single=True)
    assert not report.figures
    assert report.lines[0].startswith("warning: ")


def test_without_an_audit_there_is_nothing(tmp_path):
    report = Report({})
    _add_audit(report, "mine", tmp_path, single=True)
    assert not report.figures
    assert not report.lines
