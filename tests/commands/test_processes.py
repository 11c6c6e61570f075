"""Commands in processes of their own, as a shell starts them.

`make smoke` does so with generate, train, eval and predict.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest
from command_line import Done, process, radhar
from learning.patterns import split_tree, trained
from small import fingerprint, small_config


def smoke(*arguments: object) -> Done:
    done = process("-m", "radhar_cli", *arguments)
    assert done.returncode == 0, done.stderr
    return done


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a config and the data set of it."""
    place = tmp_path_factory.mktemp("made")
    small_config(place)
    assert radhar("generate", place / "small.yaml", "-o", place / "set").returncode == 0
    return place


@pytest.mark.parametrize(
    ("command", "expected"),
    [
        ("simulate {}/small.yaml -a S8 -o {}/scene --no-figures --maps stft", "scene.h5"),
        ("verify {}/set", ""),
        ("preview {}/set --map stft --per-class 1", "preview_stft.png"),
        ("inspect {}/set", "punching"),
        ("config show {}/small.yaml", "samples_per_class: 3"),
        ("tradeoff --help", "Example"),
    ],
)
def test_data(made: Path, command: str, expected: str) -> None:
    assert expected in smoke(*command.replace("{}", str(made)).split()).stdout


@pytest.fixture(scope="module")
def learned(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a tree of images and a run on them."""
    place = tmp_path_factory.mktemp("learned")
    split_tree(place / "tree", 2, 1)
    trained(place / "tree", place / "run", epochs=1)
    return place


@pytest.mark.parametrize(
    ("command", "expected"),
    [
        ("export {}/run -o {}/model.onnx", "model.onnx"),
        ("models", "fftnet"),
    ],
)
def test_learning(learned: Path, command: str, expected: str) -> None:
    assert expected in smoke(*command.replace("{}", str(learned)).split()).stdout


def shell(line: str) -> Done:
    """Run a line of the shell in which RADHAR is the program."""
    line = line.replace("RADHAR", f"{sys.executable} -m radhar_cli")
    return subprocess.run(["bash", "-c", line], capture_output=True, text=True)


@pytest.mark.parametrize("options", ["", "--json"])
def test_output_that_cannot_be_written_is_one_line(made: Path, options: str) -> None:
    if not Path("/dev/full").exists():
        pytest.skip("no /dev/full")
    done = shell(f"RADHAR inspect {made}/set {options} > /dev/full")
    assert (done.returncode, done.stderr) == (1, "radhar: output: No space left on device\n")


@pytest.mark.parametrize("encoding", ["latin-1", "ascii", "utf-8"])
def test_a_summary_prints_in_any_encoding(made: Path, encoding: str) -> None:
    done = subprocess.run(
        [sys.executable, "-m", "radhar_cli", "inspect", made / "set"],
        capture_output=True,
        env={**os.environ, "PYTHONIOENCODING": encoding},
    )
    assert (done.returncode, done.stderr) == (0, b"")
    printed = done.stdout.decode(encoding)
    assert "punching" in printed
    assert "\\u" not in printed


@pytest.mark.parametrize(("closed", "jobs"), [("2>&-", 2), (">&-", 2), ("<&- >&- 2>&-", 1)])
def test_a_build_with_closed_streams(made: Path, tmp_path: Path, closed: str, jobs: int) -> None:
    done = shell(f"RADHAR generate {made}/small.yaml -o {tmp_path}/set --jobs {jobs} {closed}")
    assert done.returncode == 0, done.stderr
    assert fingerprint(tmp_path / "set").items() <= fingerprint(made / "set").items()


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="needs limits as Linux has them")
@pytest.mark.parametrize(
    ("limit", "options", "expected"),
    [
        ("-n 16", "--jobs 2", "Too many open files"),
        ("-v 400000", "--jobs 1 --set image.size_px=8192", "radhar: out of memory"),
    ],
)
def test_limits_of_the_machine_end_in_one_line(
    made: Path, tmp_path: Path, limit: str, options: str, expected: str
) -> None:
    done = shell(f"ulimit {limit}; RADHAR generate {made}/small.yaml -o {tmp_path}/set {options}")
    said = [line for line in done.stderr.splitlines() if not line.startswith("warning: ")]
    assert (done.returncode, len(said)) == (1, 1), done.stderr
    assert expected in said[0]
