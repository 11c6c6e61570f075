"""Memory of temporary arrays is kept, so that a process does not fault in its pages anew."""

import ctypes
import platform
import subprocess
import sys

import pytest

from radhar_cli.processes.worker_process import keep_memory

MIB = 2**20
M_MMAP_THRESHOLD = -3
FAULTS = """
import resource, sys
import numpy as np
from radhar_cli.processes.worker_process import keep_memory
before, size, up_to = sys.argv[1:]
if before == "kept":
    keep_memory(int(up_to) or None)
def faults():
    return resource.getrusage(resource.RUSAGE_SELF).ru_minflt
np.ones(int(size), np.uint8)
first = faults()
for _ in range(8):
    np.ones(int(size), np.uint8)
print(faults() - first)
"""

pytestmark = pytest.mark.skipif(
    platform.libc_ver()[0] != "glibc", reason="another libc has other thresholds"
)


def faults(before: str, size: int, up_to: int = 0) -> int:
    """Page faults of writing eight temporary arrays of one size, after a first one."""
    line = [sys.executable, "-c", FAULTS, before, str(size), str(up_to)]
    done = subprocess.run(line, capture_output=True, text=True, check=True, env={})
    return int(done.stdout)


@pytest.mark.parametrize("size", [16 * MIB, 256 * MIB])
def test_kept_memory_is_not_faulted_in_again(size: int) -> None:
    assert faults("kept", size) < 100


def test_memory_is_kept_up_to_a_size_only() -> None:
    assert faults("kept", 16 * MIB, up_to=64 * MIB) < 100
    assert faults("kept", 256 * MIB, up_to=64 * MIB) > 8


def test_an_older_glibc_keeps_what_it_can(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = list[tuple[int, int]]()

    class OlderGlibc:
        def __init__(self, name: None) -> None:
            pass

        def mallopt(self, parameter: int, value: int) -> int:
            asked.append((parameter, value))
            return int(parameter != M_MMAP_THRESHOLD or value <= 32 * MIB)

    monkeypatch.setattr(ctypes, "CDLL", OlderGlibc)
    monkeypatch.delenv("MALLOC_MMAP_THRESHOLD_", raising=False)
    keep_memory(64 * MIB)
    assert [value for parameter, value in asked if parameter == M_MMAP_THRESHOLD][-1] == 32 * MIB


def test_glibc_alone_faults_a_large_array_in_each_time() -> None:
    assert faults("as it is", 256 * MIB) > 8
