"""The folder of a report: tables and figures, report.json last; what an earlier one left goes."""

import csv
import io
import json
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path
from typing import Any

from radhar_cli.dataset.files import write_result
from radhar_cli.errors import FolderError
from radhar_cli.files.plain_json import plain
from radhar_cli.files.untrusted import read_json

NUMBERS = "report.json"


def write_report(folder: Path, files: Mapping[str, bytes], numbers: dict[str, Any]) -> None:
    """Write files and report.json, which lists them; remove the files of an earlier report.

    Args:
        folder: folder of the report.
        files: {name: content}.
        numbers: numbers of report.json, to which the list of files is added.

    Raises:
        FolderError: a file cannot be written.
    """
    try:
        listed_names = read_json(folder / NUMBERS)["files"]
        earlier = [
            n for n in listed_names if Path(n).name == n and Path(n).suffix in (".png", ".csv")
        ]
    except (FolderError, KeyError, TypeError):
        earlier = []
    for name in set(earlier) - set(files):
        (folder / name).unlink(missing_ok=True)
    for name, content in files.items():
        write_result(folder, folder / name, content)
    text = json.dumps(plain({**numbers, "files": sorted(files)}), indent=2) + "\n"
    write_result(folder, folder / NUMBERS, text.encode())


def csv_text(header: Sequence[object], rows: Iterable[Iterable[object]]) -> str:
    """Text of a table as CSV; cells are quoted where they need it."""
    text = io.StringIO(newline="")
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(header)
    writer.writerows(rows)
    return text.getvalue()
