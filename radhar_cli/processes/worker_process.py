"""Settings of a process that synthesises samples: one thread, memory kept between samples."""

import ctypes
import os
import platform
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from functools import cache
from typing import Any

_M_TRIM_THRESHOLD = -1
_M_MMAP_THRESHOLD = -3
_M_MMAP_MAX = -4
_KEPT = 64 * 2**20
_LARGEST_OLD_THRESHOLD = 32 * 2**20
PARENT_CHECK_S = 0.5
_THREADS = (
    "OMP_NUM_THREADS",
    "OPENBLAS_NUM_THREADS",
    "MKL_NUM_THREADS",
    "BLIS_NUM_THREADS",
    "VECLIB_MAXIMUM_THREADS",
    "NUMEXPR_NUM_THREADS",
)


@cache
def prepare_process() -> None:
    """Hold numerical libraries to one thread and keep the memory of arrays of some MB.

    One thread: the workers already fill the cores, and bytes must not depend on a thread count.
    Libraries that are loaded already are set; those loaded later (scipy has an OpenBLAS of its
    own) read the environment.
    """
    from threadpoolctl import threadpool_limits

    os.environ.update(dict.fromkeys(_THREADS, "1"))
    threadpool_limits(limits=1)
    keep_memory(_KEPT)


@cache
def end_with(parent_pid: int) -> None:
    """End this process soon after that parent, however it ended and whatever is under way here.

    Nobody waits for what it makes then, and a new run may be at work in the same folder.
    """
    threading.Thread(target=_watch, args=(parent_pid,), daemon=True, name="parent").start()


def _watch(parent_pid: int) -> None:
    while os.getppid() == parent_pid:
        time.sleep(PARENT_CHECK_S)
    os._exit(1)


@contextmanager
def one_thread() -> Iterator[None]:
    """Hold linear algebra to one thread within the block, in a process that does other things."""
    if prepare_process.cache_info().currsize:
        yield
        return
    with _loaded_libraries().limit(limits=1, user_api="blas"):
        yield


@cache
def _loaded_libraries() -> Any:
    from threadpoolctl import ThreadpoolController

    return ThreadpoolController()


def keep_memory(up_to: int | None = None) -> None:
    """Stop glibc from returning memory after each array, unless the user has configured it.

    Fresh pages, mapped, zeroed and faulted in for every temporary array, would take most of a
    sample's time, and two thirds of a training step's (docs/guide/training.md).

    Args:
        up_to: bytes of the largest array whose memory is kept, and half of what is kept in all;
            None keeps everything until the process ends.
    """
    if platform.libc_ver()[0] == "glibc" and "MALLOC_MMAP_THRESHOLD_" not in os.environ:
        libc = ctypes.CDLL(None)
        if up_to is None:
            libc.mallopt(_M_MMAP_MAX, 0)
            libc.mallopt(_M_TRIM_THRESHOLD, -1)
        else:
            # An older glibc refuses more than half of what it maps for a thread's arena.
            if not libc.mallopt(_M_MMAP_THRESHOLD, up_to):
                libc.mallopt(_M_MMAP_THRESHOLD, _LARGEST_OLD_THRESHOLD)
            libc.mallopt(_M_TRIM_THRESHOLD, 2 * up_to)
