"""Report of an audit: audit.json, audit.csv, audit.png, and its lines on the terminal."""

from collections.abc import Iterator, Sequence
from math import isfinite
from pathlib import Path
from typing import Any

from radhar_cli.dataset.audited import (
    AUDIT,
    AUDIT_FIGURE,
    AUDIT_KIND,
    AUDIT_TABLE,
    audit_folder,
)
from radhar_cli.dataset.layout import DATASET
from radhar_cli.figures.class_shares import ShareBar, class_shares_png
from radhar_cli.figures.report.parts import ReportFigure, ReportTable
from radhar_cli.figures.report.report import Report
from radhar_cli.study.audit.audit import Audit, AuditLine
from radhar_cli.study.audit.duplicates import Pairs
from radhar_cli.study.audit.evidence import EvidencePart

COLUMNS = (
    *("part", "name", "key", "share", "low_95", "high_95", "chance", "p_uncalibrated", "tells"),
    *("classes", "samples", "groups", "verdict", "instead"),
)


def write_audit(audit: Audit, folder: Path) -> list[Path]:
    """Write audit.json, audit.csv and audit.png into a folder; return their paths.

    Raises:
        FolderError: a file cannot be written.
    """
    report = Report(audit_numbers(audit), stem=AUDIT)
    report.add(_table(audit), ReportFigure(AUDIT_FIGURE, "", audit_figure(audit)))
    return report.write(folder)


def audit_numbers(audit: Audit) -> dict[str, Any]:
    """Plain numbers by their keys in audit.json."""
    overlaps, images, beside = audit.overlaps, audit.data.images, audit_folder(audit.data.where)
    return {
        "kind": AUDIT_KIND,
        "data": str(audit.data.where),
        "bytes": None if beside is None else (beside.parent / DATASET).stat().st_size,
        "map": None if images is None else images.map,
        "samples": audit.rows.size,
        "all_samples": len(audit.data),
        "classes": list(audit.data.classes),
        "held_out": audit.held_out,
        "seed": audit.effort.seed,
        "lines": [_line_numbers(line) for line in audit.lines],
        "identical": _pair_numbers(overlaps.identical),
        "near": _pair_numbers(overlaps.near),
        "across_splits": dict(overlaps.across_splits),
        "sentences": [" ".join(sentence.split()) for sentence in audit.sentences],
        "warnings": list(audit.warnings),
    }


def _line_numbers(line: AuditLine) -> dict[str, Any]:
    """Plain numbers of a line."""
    result = line.result
    numbers: dict[str, Any] = dict.fromkeys(
        ("share", "low", "high", "chance", "accuracy", "majority", "classes", "samples")
    )
    if result is not None:
        numbers |= result._asdict() | {"p_uncalibrated": line.p}
        del numbers["p"], numbers["is_confounded"]
    return {
        "part": str(line.evidence.part),
        "name": _printable(line.evidence.name),
        "key": line.evidence.key,
        **numbers,
        "tells": line.is_leak,
        "verdict": line.verdict,
        "cure": _printable(line.cure),
        "may_be_movement": line.evidence.may_be_movement,
    }


def _printable(text: str) -> str:
    """A line of text without characters that could steer a terminal."""
    return "".join(c if c.isprintable() else "?" for c in text)[:1000]


def _pair_numbers(pairs: Pairs) -> dict[str, Any]:
    return {
        "images": pairs.count,
        "across_splits": pairs.across_splits,
        "across_classes": pairs.across_classes,
        "examples": [list(pair) for pair in pairs.examples],
    }


def _table(audit: Audit) -> ReportTable:
    """Table of audit.csv: a row for each line."""
    rows = []
    for line in audit.lines:
        result, evidence = line.result, line.evidence
        numbers: Sequence[object] = ("",) * 9
        if result is not None:
            shares = (result.share, result.low, result.high, result.chance, line.p)
            counts = (result.classes, result.samples, result.groups)
            numbers = (*(f"{share:.6g}" for share in shares), line.is_leak, *counts)
        rows.append((evidence.part, evidence.name, evidence.key, *numbers, line.verdict, line.cure))
    return ReportTable(COLUMNS, rows, file=AUDIT_TABLE)


def audit_figure(audit: Audit) -> bytes:
    """Figure of all lines, as PNG."""
    bars = [
        ShareBar(str(line.evidence.part), line.evidence.name, *line.result[:4])
        for line in ordered(audit.lines)
        if line.result is not None
    ]
    classes, data = len(audit.data.classes), audit.data.where
    name = data.stem if data.suffix == ".csv" else data.resolve().name
    title = (
        f"{name}: how often the class is told from what is not the movement\n"
        f"{audit.rows.size} samples of {classes} classes, {audit.held_out}s held out"
    )
    return class_shares_png(bars, title)


def ordered(lines: Sequence[AuditLine]) -> list[AuditLine]:
    """Lines part by part, the highest share of each part first; what could not be tested last."""
    parts = list(EvidencePart)

    def place(line: AuditLine) -> tuple[int, float]:
        share = -1.0 if line.result is None else line.result.share
        return parts.index(line.evidence.part), -share

    return sorted(lines, key=place)


def terminal_lines(audit: Audit) -> Iterator[str]:
    """Yield what the terminal shows."""
    width = max((len(line.evidence.name) for line in audit.lines), default=0)
    part = None
    for line in ordered(audit.lines):
        if line.evidence.part != part:
            part = line.evidence.part
            yield f"{part}:"
        yield f"  {line.evidence.name:{width}}  {share_in_words(line)}"
        if line.cure:
            yield f"  {'':{width}}  -> {line.cure}"
    for sentence in audit.sentences:
        yield f"WRONG {sentence}"


def share_in_words(line: AuditLine) -> str:
    """Share, interval, chance and verdict of a line, in words."""
    result = line.result
    if result is None or not isfinite(result.share):
        return line.verdict
    share, low, high, chance = (f"{100 * value:.1f}" for value in result[:4])
    return f"{share:>5} % ({low} to {high}), chance {chance}: {line.verdict}"
