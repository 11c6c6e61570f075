"""The folder of a report: what an earlier one left there goes."""

from collections.abc import Iterable
from pathlib import Path

from radhar_cli.errors import FolderError
from radhar_cli.untrusted import read_json

NUMBERS = "report.json"


def remove_others(folder: Path, kept: Iterable[str]) -> None:
    """Remove the files that report.json lists, those in `kept` aside."""
    for name in set(_files_of(folder)) - set(kept):
        (folder / name).unlink(missing_ok=True)


def _files_of(folder: Path) -> list[str]:
    """Files of the report that a folder holds, itself aside; those of another kind are not ours."""
    try:
        names = read_json(folder / NUMBERS)["files"]
        return [n for n in names if Path(n).name == n and Path(n).suffix in (".png", ".csv")]
    except (FolderError, KeyError, TypeError):
        return []
