"""tradeoff.csv, tradeoff.json, pareto.png and tradeoff.md."""

import json
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from math import inf
from pathlib import Path
from typing import Any

from radhar_cli.dataset.files import write_whole
from radhar_cli.figures.frontier import Change, CostPoint, Score, tradeoff_png
from radhar_cli.learning.tables import csv_text
from radhar_cli.tradeoff.accuracy import Accuracy
from radhar_cli.tradeoff.advice import advice
from radhar_cli.tradeoff.study import Row

CSV, JSON, FIGURE, TEXT = "tradeoff.csv", "tradeoff.json", "pareto.png", "tradeoff.md"
BOUNDS = ("interpolation_bound_db", "table_bound_db", "rounding_bound_db")
ENGINES = ("budget", "precision", "engine")


def record(row: Row) -> dict[str, Any]:
    """One row in plain numbers; an error of -inf is written as null in JSON and -inf in CSV."""
    time, echo = row.spread("ratio"), row.spread("echo_ratio")
    return {
        "group": row.setting.group,
        "setting": row.setting.name,
        "default": row.setting.is_default,
        "overrides": " ".join(row.setting.timed),
        "sample_ms": row.middle("sample_ms"),
        "time_ratio": row.middle("ratio"),
        "time_ratio_low": time and time[0],
        "time_ratio_high": time and time[1],
        "echo_ms": row.middle("echo_ms"),
        "echo_ratio": row.middle("echo_ratio"),
        "echo_ratio_low": echo and echo[0],
        "echo_ratio_high": echo and echo[1],
        "signal_error_db": row.worst("signal_error_db"),
        "signal_error_median_db": row.usual("signal_error_db"),
        "map_error_db": row.worst("map_error_db"),
        "map_error_max_db": row.worst("map_error_max_db"),
        "ssim": min(row.values("ssim"), default=None),
        "psnr_db": min(row.values("psnr_db"), default=None),
        "pixels_changed": row.worst("pixels_changed"),
        **{name: row.worst(name) for name in BOUNDS},
        "scenes": len(row.differences),
        "refused": len(row.refused),
    }


def write_report(
    folder: Path,
    title: str,
    command: str,
    rows: Sequence[Row],
    accuracies: Sequence[Accuracy],
    conditions: dict[str, Any],
) -> list[Path]:
    """Write the four files; return their paths."""
    records = [record(row) for row in rows]
    accuracy = {"accuracy": [asdict(each) for each in accuracies]} if accuracies else {}
    numbers = {"command": command, **conditions, "settings": records, **accuracy}
    header = list(records[0])
    files = {
        CSV: csv_text(header, ([one[name] for name in header] for one in records)).encode(),
        JSON: (json.dumps(_finite(numbers), indent=2) + "\n").encode(),
        FIGURE: _figure(title, rows, accuracies),
        TEXT: markdown(title, command, records, accuracies, conditions).encode(),
    }
    for name, data in files.items():
        write_whole(folder, folder / name, data)
    return [folder / name for name in files]


def _figure(title: str, rows: Sequence[Row], accuracies: Sequence[Accuracy]) -> bytes:
    engines = [row for row in rows if row.setting.group in ENGINES and row.times]
    changes = [
        Change(row.setting.name, change, row.middle("ratio") or 1.0)
        for row in rows
        if row.setting.group == "switch" and row.times
        for change in [row.usual("signal_error_db")]
        if change is not None and "FSST" not in row.setting.name
    ]
    return tradeoff_png(
        title,
        [_point(row, "echo_ratio") for row in engines],
        [_point(row, "ratio") for row in engines],
        changes,
        [Score(a.name, a.mean, a.low, a.high) for a in accuracies],
    )


def _point(row: Row, column: str) -> CostPoint:
    middle, spread = row.middle(column), row.spread(column)
    assert middle is not None
    assert spread is not None
    error = row.worst("signal_error_db")
    return CostPoint(
        row.setting.name,
        middle,
        *spread,
        None if error in (None, -inf) else error,
        row.setting.is_default,
    )


def markdown(
    title: str,
    command: str,
    records: Sequence[dict[str, Any]],
    accuracies: Sequence[Accuracy],
    conditions: dict[str, Any],
) -> str:
    """The report in words and tables."""
    parts = [
        f"# What accuracy costs: {title}",
        f"`{command}`",
        "\n".join(f"- {line}" for line in advice(records, accuracies)),
        f"![time against error]({FIGURE})",
        _conditions(conditions),
        "## Engine, budget, precision",
        _table(
            (
                "setting",
                "sample ms",
                "time",
                "echo time",
                "signal error dB",
                "median dB",
                "interpolation, table, rounding: bounds dB",
                "map error dB",
                "SSIM",
                "pixels changed",
            ),
            (
                [
                    one["setting"] + (" (default)" if one["default"] else ""),
                    _number(one["sample_ms"], 1),
                    _ratio(one, "time_ratio"),
                    _ratio(one, "echo_ratio"),
                    _number(one["signal_error_db"], 1),
                    _number(one["signal_error_median_db"], 1),
                    ", ".join(_number(one[name], 0) for name in BOUNDS),
                    _number(one["map_error_db"], 4),
                    _number(one["ssim"], 6),
                    _share(one["pixels_changed"]),
                ]
                for one in records
                if one["group"] in ENGINES
            ),
        ),
        "## Physics and transforms that are left out",
        "Time is that of the switch on; error is what data without it are away from data with it.",
        _table(
            (
                "switch",
                "time",
                "signal dB, median",
                "worst",
                "map dB",
                "SSIM",
                "PSNR dB",
                "pixels changed",
            ),
            (
                [
                    one["setting"],
                    _ratio(one, "time_ratio"),
                    _number(one["signal_error_median_db"], 1),
                    _number(one["signal_error_db"], 1),
                    _number(one["map_error_db"], 2),
                    _number(one["ssim"], 4),
                    _number(one["psnr_db"], 1),
                    _share(one["pixels_changed"]),
                ]
                for one in records
                if one["group"] == "switch"
            ),
        ),
        "## Image size and kind of map",
        "Images of another size are brought to the config's before they are compared.",
        _table(
            ("group", "setting", "sample ms", "time", "SSIM", "PSNR dB", "pixels changed"),
            (
                [
                    one["group"],
                    one["setting"],
                    _number(one["sample_ms"], 1),
                    _ratio(one, "time_ratio"),
                    _number(one["ssim"], 6),
                    _number(one["psnr_db"], 1),
                    _share(one["pixels_changed"]),
                ]
                for one in records
                if one["group"] in ("image size", "map")
            ),
        ),
    ]
    if accuracies:
        parts += [
            "## What a network makes of it",
            f"smallnet, trained at {conditions['snr_db']:g} dB SNR; mean over the seeds, Wilson "
            "95 % interval for the number of test images.",
            _table(
                ("trained on", "accuracy %", "interval %", "seeds %"),
                (
                    [
                        a.name,
                        f"{100 * a.mean:.1f}",
                        f"{100 * a.low:.1f} to {100 * a.high:.1f}",
                        ", ".join(f"{100 * seed:.1f}" for seed in a.seeds),
                    ]
                    for a in accuracies
                ),
            ),
        ]
    return "\n\n".join(parts) + "\n"


def _conditions(conditions: dict[str, Any]) -> str:
    return (
        f"{conditions['scenes']} scenes, one an activity, drawn from the config; errors without "
        f"noise against the exact cube in float64, the worst scene's unless it says median. Times "
        f"of one process, {conditions['rounds']} rounds interleaved; ratios to the default on the "
        "same scenes in the same moment, with quartiles. A sample is everything from the scene to "
        "levels and entropy; its echo is paths and slow-time signal alone."
    )


def _table(header: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [header, ["---"] * len(header), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _ratio(one: dict[str, Any], name: str) -> str:
    if one[name] is None:
        return "refused"
    return f"{one[name]:.2f} ({one[name + '_low']:.2f} to {one[name + '_high']:.2f})"


def _number(value: float | None, digits: int) -> str:
    if value is None:
        return ""
    return "exact" if value == -inf else f"{value:.{digits}f}"


def _share(value: float | None) -> str:
    return "" if value is None else f"{100 * value:.3g} %"


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_finite(each) for each in value]
    return None if value == -inf else value
