"""Workers keep to one thread, libraries that they load late included."""

import os
import subprocess
import sys

import pytest

THREADS = """
import sys
from radhar_cli.dataset.workers import run_tasks

def counts():
    from radhar_cli.worker_process import prepare_process
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
