"""tradeoff.csv, tradeoff.json, pareto.png and tradeoff.md."""

import json
from collections.abc import Sequence
from math import inf
from pathlib import Path
from typing import Any

from radhar_cli.dataset.files import write_whole
from radhar_cli.learning.tables import csv_text
from radhar_cli.tradeoff.figure import tradeoff_png
from radhar_cli.tradeoff.study import Row
from radhar_cli.tradeoff.text import markdown

CSV, JSON, FIGURE, TEXT = "tradeoff.csv", "tradeoff.json", "pareto.png", "tradeoff.md"


def record(row: Row) -> dict[str, Any]:
    """One row in plain numbers; JSON has null for the error of what is exact."""
    time, echo = row.spread("ratio"), row.spread("echo_ratio")
    return {
        "group": row.setting.group,
        "setting": row.setting.name,
        "default": row.setting.is_default,
        "overrides": " ".join(row.setting.overrides),
        "time_over": row.setting.baseline_name,
        "sample_ms": row.middle("sample_ms"),
        "time_ratio": row.middle("ratio"),
        "time_ratio_low": time and time[0],
        "time_ratio_high": time and time[1],
        "echo_ms": row.middle("echo_ms"),
        "echo_ratio": row.middle("echo_ratio"),
        "echo_ratio_low": echo and echo[0],
        "echo_ratio_high": echo and echo[1],
        "exact": row.worst("signal_error_db") == -inf,
        "signal_error_db": row.worst("signal_error_db"),
        "signal_error_median_db": row.usual("signal_error_db"),
        "map_error_db": row.worst("map_error_db"),
        "map_error_max_db": row.worst("map_error_max_db"),
        "ssim": min(row.values("ssim"), default=None),
        "psnr_db": min(row.values("psnr_db"), default=None),
        "pixels_changed": row.worst("pixels_changed"),
        "measured_error_db": row.worst("measured_error_db"),
        "scenes": len(row.differences),
        "refused": len(row.refused),
    }


def write_report(
    folder: Path,
    title: str,
    command: str,
    rows: Sequence[Row],
    conditions: dict[str, Any],
) -> list[Path]:
    """Write the four files; return their paths."""
    records = [record(row) for row in rows]
    numbers = {"command": command, **conditions, "settings": records}
    header = list(records[0])
    files = {
        CSV: csv_text(header, ([one[name] for name in header] for one in records)).encode(),
        JSON: (json.dumps(_finite(numbers), indent=2) + "\n").encode(),
        FIGURE: tradeoff_png(title, rows),
        TEXT: markdown(title, command, FIGURE, records, conditions).encode(),
    }
    for name, data in files.items():
        write_whole(folder, folder / name, data)
    return [folder / name for name in files]


def _finite(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _finite(each) for key, each in value.items()}
    if isinstance(value, list):
        return [_finite(each) for each in value]
    return None if value == -inf else value
