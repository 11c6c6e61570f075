"""Run commands of the program one after another in one process, each with 20 s and 2 GB."""

import json
import os
import resource
import signal
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import NamedTuple

SECONDS, BYTES = 60, 2 * 10**9

# Memory is what a case may map beyond what the program had mapped before it.
PROGRAM = """
import contextlib, io, json, resource, signal, sys, time, traceback
from pathlib import Path
from helpers.forks import ForkServer
from radhar_cli.cli import main
from radhar_cli.readers import hdf5_check, untrusted_hdf5

task, result = map(Path, sys.argv[1:])
seconds, most, warm_up, cases = json.loads(task.read_text())

class TooLong(BaseException):
    pass

def stop(*_):
    raise TooLong

def answer(words):
    out, err, status = io.StringIO(), io.StringIO(), 0
    sys.argv = ["radhar", *words]
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            main()
        except SystemExit as end:
            status = end.code or 0
        except TooLong:
            status = "too long"
        except BaseException:
            status = traceback.format_exc()
    return status, out.getvalue(), err.getvalue()

# HDF5 files are tried in forks, with less time than a user has.
check = task.with_name("check.py")
hdf5_check.SECONDS = 2
check.write_text(
    "from radhar_cli.readers import hdf5_check; hdf5_check.SECONDS = 2; hdf5_check.main()"
)
hdf5_check.__file__ = str(check)
untrusted_hdf5.subprocess = ForkServer()
for words in warm_up:
    answer(words)
signal.signal(signal.SIGALRM, stop)
found = {}
for name, words in cases.items():
    mapped = resource.getpagesize() * int(Path("/proc/self/statm").read_text().split()[0])
    resource.setrlimit(resource.RLIMIT_AS, (mapped + most, resource.RLIM_INFINITY))
    began = time.monotonic()
    signal.alarm(seconds)
    found[name] = answer(words)
    signal.alarm(0)
    resource.setrlimit(resource.RLIMIT_AS, (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    signal.signal(signal.SIGINT, signal.default_int_handler)
    print(name, round(time.monotonic() - began, 2), found[name][0], file=sys.stderr)
result.write_text(json.dumps(found))
"""


@contextmanager
def limited() -> Iterator[None]:
    """20 s, then TimeoutError, and 2 GB beyond what this process has mapped now."""

    def stop(*_: object) -> None:
        raise TimeoutError

    mapped = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    before = resource.getrlimit(resource.RLIMIT_AS)
    old = signal.signal(signal.SIGALRM, stop)
    resource.setrlimit(resource.RLIMIT_AS, (mapped + BYTES, before[1]))
    signal.alarm(SECONDS)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, old)
        resource.setrlimit(resource.RLIMIT_AS, before)


class Answer(NamedTuple):
    """How a command ended: its status, or a text where it did not end as a program should."""

    status: int | str
    out: str
    err: str


def answers(
    folder: Path,
    cases: Mapping[str, Sequence[object]],
    warm_up: Sequence[Sequence[object]] = (),
) -> dict[str, Answer]:
    """{name: answer} of {name: arguments of radhar}; `warm_up` loads the libraries first."""
    task, result = folder / "task.json", folder / "result.json"
    text = {name: [str(word) for word in words] for name, words in cases.items()}
    first = [[str(word) for word in words] for words in warm_up]
    task.write_text(json.dumps([SECONDS, BYTES, first, text]))
    done = subprocess.run(
        [sys.executable, "-c", PROGRAM, str(task), str(result)],
        capture_output=True,
        text=True,
        timeout=SECONDS * (len(cases) + 2),
        cwd=folder,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert done.returncode == 0, done.stderr
    return {name: Answer(*ended) for name, ended in json.loads(result.read_text()).items()}


def refused(answer: Answer) -> str:
    """The message of a clear refusal: our own words, no traceback, nothing that steers a terminal.

    Its lines are few and of readable length.
    """
    assert answer.status in (1, 2), (answer.status, answer.err[-2000:])
    assert "Traceback" not in answer.err
    assert answer.err.startswith("radhar: ")
    assert all(c.isprintable() or c == "\n" for c in answer.err), ascii(answer.err)
    assert len(answer.err) < 20_000
    return answer.err.removeprefix("radhar: ").rstrip("\n")
