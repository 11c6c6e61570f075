"""Settings of a process that synthesises samples: one thread, memory kept between samples."""

import ctypes
import os
import platform
from functools import cache

_M_TRIM_THRESHOLD = -1
_M_MMAP_THRESHOLD = -3
_KEPT = 64 * 2**20


@cache
def prepare_process() -> None:
    """Hold numerical libraries to one thread and stop glibc from returning memory after each array.

    Fresh pages for every temporary array of a few MB would take most of a sample's time. One
    thread: the workers already fill the cores, and bytes must not depend on a thread count.
    """
    from threadpoolctl import threadpool_limits

    threadpool_limits(limits=1)
    if platform.libc_ver()[0] == "glibc" and "MALLOC_MMAP_THRESHOLD_" not in os.environ:
        libc = ctypes.CDLL(None)
        libc.mallopt(_M_MMAP_THRESHOLD, _KEPT)
        libc.mallopt(_M_TRIM_THRESHOLD, 2 * _KEPT)
