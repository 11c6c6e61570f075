"""tradeoff.csv, tradeoff.json and tradeoff.md of the rows of a sweep."""

import json
from collections.abc import Mapping, Sequence
from math import inf
from pathlib import Path
from typing import Any

from radhar_cli.dataset.files import write_result
from radhar_cli.learning.report_folder import csv_text
from radhar_cli.tradeoff.study import Record

FILES = CSV, JSON, TEXT = "tradeoff.csv", "tradeoff.json", "tradeoff.md"
ENGINES = ("budget", "precision", "engine")
COLUMNS = {
    "setting": "{setting}{marked}",
    "sample ms": "{sample_ms:.1f}",
    "time": "{time_ratio:.2f} ({time_ratio_low:.2f} to {time_ratio_high:.2f})",
    "relative to": "{time_over}",
    "signal error dB": "{signal_error_db:.1f}",
    "median dB": "{signal_error_median_db:.1f}",
    "measured dB": "{measured_error_db:.1f}",
    "SSIM": "{ssim:.6f}",
    "pixels changed": "{pixels_changed:.3%}",
}


def write_report(
    folder: Path, title: str, command: str, rows: Sequence[Record], conditions: Mapping[str, Any]
) -> list[Path]:
    """Write tradeoff.csv, .json and .md; return their paths.

    Args:
        folder: folder of the files.
        title: title of the page.
        command: command line that made the rows.
        rows: rows of `run_sweep`; their error of -inf, of exact data, is null in JSON.
        conditions: numbers of scenes and rounds, versions and machine.

    Raises:
        FolderError: a file cannot be written.
    """
    finite = [{key: None if value == -inf else value for key, value in row.items()} for row in rows]
    numbers = {"command": command, **conditions, "settings": finite}
    files = {
        CSV: csv_text([*rows[0]], (row.values() for row in rows)).encode(),
        JSON: (json.dumps(numbers, indent=2) + "\n").encode(),
        TEXT: markdown(title, command, rows, conditions).encode(),
    }
    for name, data in files.items():
        write_result(folder, folder / name, data)
    return [folder / name for name in files]


def markdown(
    title: str, command: str, rows: Sequence[Record], conditions: Mapping[str, Any]
) -> str:
    """Text of tradeoff.md."""
    count, rounds = conditions["scenes"], conditions["rounds"]
    return f"""\
# What accuracy costs: {title}

`{command}`

{count} scene{"s" * (count > 1)}, one an activity, drawn from the config; errors without noise \
against the exact cube in float64, the worst scene's unless it says median. Times of one process, \
{rounds} rounds interleaved; ratios on the same scenes in the same moment, with \
quartiles. A sample is everything from the scene to levels and entropy.

## Engine, budget, precision

{_table(rows, ENGINES)}

## Physics and transforms that are left out

Time is that of the switch on; errors are those of data without it against data with it. Noise \
corner and interference line are added to the config's noise, on both sides.

{_table(rows, ("switch",))}
"""


def _table(rows: Sequence[Record], groups: Sequence[str]) -> str:
    cells = [
        [_cell(form, row) for form in COLUMNS.values()] for row in rows if row["group"] in groups
    ]
    lines = [[*COLUMNS], ["---"] * len(COLUMNS), *cells]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def _cell(template: str, row: Record) -> str:
    try:
        marked = " (default)" * row["default"]
        return template.format(**row, marked=marked).replace("-inf", "exact")
    except TypeError:  # there is no such number
        return "refused" if row["refused"] and "time" in template else ""
