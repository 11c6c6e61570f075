"""The program as a user calls it: within this process, or in one of its own."""

import contextlib
import io
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from radhar_cli.cli import main

ROOT = Path(__file__).resolve().parents[2]
Done = subprocess.CompletedProcess[str]


def radhar(*arguments: object) -> Done:
    """Run the program in this process, its last handler of errors included."""
    command = ["radhar", *map(str, arguments)]
    out, err, status = io.StringIO(), io.StringIO(), 0
    handler = signal.getsignal(signal.SIGINT)
    with (
        pytest.MonkeyPatch.context() as patch,
        contextlib.redirect_stdout(out),
        contextlib.redirect_stderr(err),
    ):
        patch.setattr(sys, "argv", command)
        try:
            main()
        except SystemExit as ended:
            status = ended.code if isinstance(ended.code, int) else 0
        finally:
            signal.signal(signal.SIGINT, handler)
    return Done(command, status, out.getvalue(), err.getvalue())


def ok(*arguments: object) -> Done:
    """Run the program, which should end well."""
    done = radhar(*arguments)
    assert done.returncode == 0, done.stderr
    return done


def process(*arguments: object) -> Done:
    """Run ``python`` with some arguments."""
    paths = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    return subprocess.run(
        [sys.executable, *map(str, arguments)],
        capture_output=True,
        text=True,
        cwd=ROOT,
        env={**os.environ, "PYTHONPATH": paths},
    )


def processes(group):
    """Command lines of a group's processes, but of those that have ended and wait to be buried."""
    found = {}
    for stat in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = stat.read_text().rpartition(")")[2].split()
            line = (stat.parent / "cmdline").read_bytes()
        except OSError:
            continue
        if int(fields[2]) == group and fields[0] != "Z":
            found[int(stat.parent.name)] = line
    return found
