"""SIGKILL at any moment costs the batches in flight and nothing else."""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from small import fingerprint, small_config

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
FOLDERS = 7
KILLS_PER_FOLDER = 3


def command(folder: Path) -> list[str]:
    config = str(folder.parent / "small.yaml")
    return [
        *(sys.executable, "-m", "radhar_cli", "generate", config, "-o", str(folder)),
        *("--jobs", "2", "--batch", "1"),
    ]


def start(folder: Path) -> subprocess.Popen[str]:
    return subprocess.Popen(
        command(folder),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )


@pytest.fixture(scope="module")
def uninterrupted(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, str], float]:
    """Fingerprint of the data set made in one go, and the seconds that took."""
    place = tmp_path_factory.mktemp("whole")
    small_config(place)
    began = time.monotonic()
    subprocess.run(command(place / "set"), check=True, capture_output=True)
    return fingerprint(place / "set"), time.monotonic() - began


@pytest.mark.parametrize("trial", range(FOLDERS))
def test_killed_at_random_moments(
    trial: int, uninterrupted: tuple[dict[str, str], float], tmp_path: Path
) -> None:
    right, seconds = uninterrupted
    small_config(tmp_path)
    folder, moments = tmp_path / "set", random.Random(trial)
    for _ in range(KILLS_PER_FOLDER):
        run = start(folder)
        time.sleep(moments.uniform(0.05, 1.05 * seconds))
        os.kill(run.pid, signal.SIGKILL)  # the master alone: its workers may still be writing
        run.wait()
        assert run.stdout is not None
        run.stdout.close()
    last = subprocess.run(command(folder), capture_output=True, text=True)
    assert last.returncode == 0, last.stderr
    assert fingerprint(folder) == right


def children(pid: int) -> list[int]:
    found = []
    for status in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = status.read_text().rpartition(")")[2].split()
            line = (status.parent / "cmdline").read_bytes()
        except OSError:
            continue
        if int(fields[1]) == pid and b"popen_loky" in line:
            found.append(int(status.parent.name))
    return found


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="needs /proc")
def test_killed_worker_is_one_clear_line_and_the_run_goes_on(
    uninterrupted: tuple[dict[str, str], float], tmp_path: Path
) -> None:
    small_config(tmp_path)
    folder = tmp_path / "set"
    run = start(folder)
    while run.poll() is None and not children(run.pid):
        time.sleep(0.01)
    for worker in children(run.pid)[:1]:
        os.kill(worker, signal.SIGKILL)
    output = run.communicate()[0]
    assert run.returncode == 1, output
    assert "a worker process was killed" in output
    assert "Traceback" not in output
    subprocess.run(command(folder), check=True, capture_output=True)
    assert fingerprint(folder) == uninterrupted[0]


@pytest.mark.parametrize("share", [0.3, 0.6, 0.9])
def test_ctrl_c_is_quiet_and_resumable(
    share: float, uninterrupted: tuple[dict[str, str], float], tmp_path: Path
) -> None:
    right, seconds = uninterrupted
    small_config(tmp_path)
    folder = tmp_path / "set"
    run = start(folder)
    time.sleep(share * seconds)
    os.killpg(run.pid, signal.SIGINT)  # as a terminal does: master and workers alike
    output = run.communicate()[0]
    assert run.returncode in (130, 0), output
    if run.returncode == 130:
        assert "the same command goes on" in output
    assert "Traceback" not in output
    subprocess.run(command(folder), check=True, capture_output=True)
    assert fingerprint(folder) == right
