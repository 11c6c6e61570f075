"""What studies share: commands of radhar, their results, tables, intervals, the commit."""

import json
import subprocess
import sys
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from radhar_cli.learning.intervals import wilson

ROOT = Path(__file__).resolve().parents[2]


def run_radhar(*arguments: object) -> None:
    """Run a command of radhar; messages go to the error stream, a failure ends the study."""
    _run(arguments, stdout=sys.stderr)


def report_of_radhar(*arguments: object) -> Any:
    """Run a command of radhar and read what it reports (`--json`)."""
    return json.loads(_run((*arguments, "--json"), stdout=subprocess.PIPE))


def _run(arguments: Sequence[object], stdout: Any) -> bytes:
    command = [sys.executable, "-m", "radhar_cli", *map(str, arguments)]
    done = subprocess.run(command, stdout=stdout, cwd=ROOT)
    if done.returncode:
        sys.exit(done.returncode)
    return done.stdout or b""


def as_options(settings: Iterable[str]) -> list[str]:
    """`--set KEY=VALUE` of each setting `KEY=VALUE`, as words of a command."""
    return [word for setting in settings for word in ("--set", setting)]


def commit() -> str:
    """Commit that the sources are of, with "-dirty" where they differ from it."""
    describe = ("git", "describe", "--always", "--dirty", "--exclude=*")
    done = subprocess.run(describe, capture_output=True, text=True, cwd=ROOT)
    return done.stdout.strip() or "unknown"


def wilson_of_share(share: float, count: int) -> tuple[float, float]:
    """Wilson's interval of 95 % of a share of `count` samples."""
    return wilson(round(share * count), count)


def table(header: Sequence[str], rows: Iterable[Sequence[object]]) -> list[str]:
    """Lines of a table in Markdown."""
    lines = [header, ["---"] * len(header), *rows]
    return [f"| {' | '.join(map(str, cells))} |".replace("|  |", "| |") for cells in lines]
