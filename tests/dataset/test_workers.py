"""Workers keep to one thread, libraries that they load late included, and end with their parent."""

import os
import subprocess
import sys
import time
from pathlib import Path

import pytest

THREADS = """
import sys
from radhar_cli.dataset.workers import run_tasks

def counts():
    from radhar_cli.processes.worker_process import prepare_process
    prepare_process()
    import scipy.linalg
    from threadpoolctl import threadpool_info
    return {entry["filepath"]: entry["num_threads"] for entry in threadpool_info()}

if __name__ == "__main__":
    for found in run_tasks(counts, [()] * 2, int(sys.argv[1])):
        assert any("scipy" in path for path in found), found
        assert set(found.values()) == {1}, found
"""


@pytest.mark.parametrize("jobs", [1, 2])
def test_a_library_loaded_late_keeps_to_one_thread(jobs):
    asked = dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS"), "3")
    done = subprocess.run(
        [sys.executable, "-c", THREADS, str(jobs)],
        capture_output=True,
        text=True,
        env={**os.environ, **asked},
    )
    assert done.returncode == 0, done.stderr


SLEEPERS = """
import os, sys, time
from radhar_cli.dataset.workers import run_tasks

def sleep(folder):
    open(os.path.join(folder, str(os.getpid())), "w").close()
    time.sleep(3600)

if __name__ == "__main__":
    list(run_tasks(sleep, [(sys.argv[1],)] * 2, 2))
"""


def is_alive(pid):
    try:
        state = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0]
    except OSError:
        return False
    return state != "Z"


def wait_until(holds):
    """Whether something holds within a minute, however busy the machine is."""
    end = time.monotonic() + 60
    while not holds():
        if time.monotonic() > end:
            return False
        time.sleep(0.05)
    return True


@pytest.mark.skipif(not Path("/proc").is_dir(), reason="needs /proc")
def test_workers_end_amid_their_task_when_their_parent_is_killed(tmp_path):
    with subprocess.Popen([sys.executable, "-c", SLEEPERS, str(tmp_path)]) as parent:
        assert wait_until(lambda: len([*tmp_path.iterdir()]) == 2)
        parent.kill()
    workers = [int(path.name) for path in tmp_path.iterdir()]
    try:
        assert wait_until(lambda: not any(map(is_alive, workers)))
    finally:
        for worker in filter(is_alive, workers):
            os.kill(worker, 9)


LEAVING = """
import time
from radhar_cli.dataset.workers import run_tasks

def wait(seconds):
    time.sleep(seconds)

if __name__ == "__main__":
    for _ in run_tasks(wait, [(0,), (3600,), (3600,)], 2):
        raise SystemExit("left")  # as Ctrl-C leaves, at a bar
"""


@pytest.mark.slow
def test_tasks_that_are_left_under_way_are_cancelled_without_a_warning():
    done = subprocess.run([sys.executable, "-c", LEAVING], capture_output=True, text=True)
    assert done.stderr == "left\n"
