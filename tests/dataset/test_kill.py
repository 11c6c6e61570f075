"""SIGKILL at any moment costs the batches in flight and nothing else.

A moment is a number of files that the run has made, not a time: the same on any machine.
"""

import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest
from helpers.command_line import processes
from helpers.slow import slow
from helpers.small import SMALL, fingerprint, small_config

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")
FOLDERS = 7
KILLS_PER_FOLDER = 3
FILES = 30  # of about forty that a run makes


def command(folder, *more):
    config = str(folder.parent / "small.yaml")
    return [
        *(sys.executable, "-m", "radhar_cli", "generate", config, "-o", str(folder)),
        *("--jobs", "2", "--batch", "1", *more),
    ]


def files(folder):
    """Files below the folder; os.walk passes over what the run removes meanwhile."""
    return sum(len(names) for _, _, names in os.walk(folder))


def shards(folder):
    return files(folder / ".radhar/shards")


def start(folder, *more):
    return subprocess.Popen(
        command(folder, *more),
        stdout=subprocess.PIPE,
        stderr=subprocess.STDOUT,
        text=True,
        start_new_session=True,
    )


def wait_for(run, folder, more_files):
    """Until the run has made so many files, or has ended."""
    enough = files(folder) + more_files
    while run.poll() is None and files(folder) < enough:
        time.sleep(0.001)


@pytest.mark.parametrize("trial", [0, *slow(range(1, FOLDERS))])
def test_builds_killed_at_random_moments_resume_to_the_same_bytes(trial, small_set, tmp_path):
    small_config(tmp_path)
    folder, moments = tmp_path / "set", random.Random(trial)
    for _ in range(KILLS_PER_FOLDER):
        with start(folder) as run:
            wait_for(run, folder, moments.randint(1, FILES))
            run.kill()  # the master alone: its workers may still be writing
    last = subprocess.run(command(folder), capture_output=True, text=True)
    assert last.returncode == 0, last.stderr
    assert fingerprint(folder) == fingerprint(small_set)
    assert not list(folder.rglob("*unfinished*"))


SEVERAL = SMALL.replace("[rtm, stft, fsst_compensated]", "[stft]").replace(
    "radar: {", "radars:\n  low: {carrier_hz: 9e9, prf_hz: 400}\n  front: {"
)


@pytest.mark.slow
@pytest.mark.parametrize(("trial", "jobs"), [(n, 1 + (n + 1) % 2) for n in range(FOLDERS)])
def test_several_radars_killed_at_random_moments_resume_to_the_same_bytes(trial, jobs, tmp_path):
    small_config(tmp_path, SEVERAL)
    folder, moments = tmp_path / "set", random.Random(trial)
    subprocess.run(command(tmp_path / "other"), check=True, capture_output=True)
    for _ in range(KILLS_PER_FOLDER):
        with start(folder, "--jobs", str(jobs)) as run:
            wait_for(run, folder, moments.randint(1, 2 * FILES))
            run.kill()
    last = subprocess.run(command(folder), capture_output=True, text=True)
    assert last.returncode == 0, last.stderr
    assert fingerprint(folder) == fingerprint(tmp_path / "other")
    assert not list(folder.rglob("*unfinished*"))


def amid_the_work(folder):
    """A run that has made the first of three hundred samples, of many pixels each."""
    run = start(folder, "--set", "samples_per_class=100", "--set", "image.size_px=2048")
    while run.poll() is None and not shards(folder):
        time.sleep(0.01)
    return run


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="needs /proc")
def test_a_killed_worker_is_one_clear_line_and_finished_batches_are_kept(tmp_path):
    small_config(tmp_path)
    run = amid_the_work(tmp_path / "set")
    workers = [pid for pid, line in processes(run.pid).items() if b"popen_loky" in line]
    for worker in workers[:1]:
        os.kill(worker, signal.SIGKILL)
    output = run.communicate()[0]
    assert workers, output
    assert run.returncode == 1, output
    assert "a worker process was killed" in output
    assert "the same command resumes" in output
    assert "Traceback" not in output
    assert shards(tmp_path / "set") > 0


@pytest.mark.slow
def test_ctrl_c_is_quiet_and_keeps_what_is_finished(tmp_path):
    small_config(tmp_path)
    run = amid_the_work(tmp_path / "set")
    os.killpg(run.pid, signal.SIGINT)  # as a terminal does: master and workers
    output = run.communicate()[0]
    assert run.returncode == 130, output
    assert "the same command resumes" in output
    assert "Traceback" not in output
    assert shards(tmp_path / "set") > 0
