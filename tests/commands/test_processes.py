"""Commands in processes of their own, as a shell starts them.

`make smoke` does so with generate, train, eval and predict.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from helpers.command_line import process
from helpers.slow import slow
from helpers.small import fingerprint


def shell(line):
    """Run a line of the shell in which RADHAR is the program."""
    line = line.replace("RADHAR", f"{sys.executable} -m radhar_cli")
    return subprocess.run(["bash", "-c", line], capture_output=True, text=True)


@pytest.mark.parametrize("options", ["", "--json"])
def test_output_that_cannot_be_written_is_one_line(small_set, options):
    if not Path("/dev/full").exists():
        pytest.skip("no /dev/full")
    done = shell(f"RADHAR inspect {small_set} {options} > /dev/full")
    assert (done.returncode, done.stderr) == (1, "radhar: output: No space left on device\n")


@pytest.mark.parametrize("encoding", ["latin-1", "ascii", "utf-8"])
def test_a_summary_prints_in_any_encoding(small_set, encoding):
    done = subprocess.run(
        [sys.executable, "-m", "radhar_cli", "inspect", small_set],
        capture_output=True,
        env={**os.environ, "PYTHONIOENCODING": encoding},
    )
    assert (done.returncode, done.stderr) == (0, b"")
    printed = done.stdout.decode(encoding)
    assert "punching" in printed
    assert "\\u" not in printed


@pytest.mark.parametrize(
    ("closed", "jobs"), [("<&- >&- 2>&-", 1), *slow([("2>&-", 2), (">&-", 2)])]
)
def test_a_build_with_closed_streams(small_set, tmp_path, closed, jobs):
    done = shell(
        f"RADHAR generate {small_set.parent}/small.yaml -o {tmp_path}/set --jobs {jobs} {closed}"
    )
    assert done.returncode == 0, done.stderr
    assert fingerprint(tmp_path / "set").items() <= fingerprint(small_set).items()


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="needs limits as Linux has them")
@pytest.mark.parametrize(
    ("limit", "options", "expected"),
    [
        ("-n 16", "--jobs 2", "Too many open files"),
        ("-v 400000", "--jobs 1 --set image.size_px=8192", "radhar: out of memory"),
    ],
)
def test_limits_of_the_machine_end_in_one_line(small_set, tmp_path, limit, options, expected):
    done = shell(
        f"ulimit {limit}; RADHAR generate {small_set.parent}/small.yaml -o {tmp_path}/set {options}"
    )
    said = [line for line in done.stderr.splitlines() if not line.startswith("warning: ")]
    assert (done.returncode, len(said)) == (1, 1), done.stderr
    assert expected in said[0]


PROGRAM = """
import sys
from radhar_cli.cli import main
try:
    main()
except SystemExit as ended:
    assert not ended.code, ended.code
assert not {"torch", "timm", "safetensors"} & set(sys.modules)
"""


@pytest.mark.every(3)
@pytest.mark.parametrize(
    "words",
    [
        "train --help",
        "generate {}/small.yaml -o {}/set",
        *slow(["eval --help", "export --help", "predict --help", "verify {}/set --samples 1"]),
        *slow(["inspect {}/set/png/stft/train", "preview {}/set -o {}/sheet.png"]),
        "compare {}/set {}/set -o {}/compared --map stft --per-class 2",
    ],
)
def test_what_learns_nothing_needs_no_torch(small_set, words):
    done = process("-c", PROGRAM, *words.format(*[small_set.parent] * 3).split())
    assert done.returncode == 0, done.stderr
