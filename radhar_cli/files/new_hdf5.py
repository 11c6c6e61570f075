"""A new HDF5 file on a disk that may be full.

HDF5 crashes the interpreter where it cannot write what it holds when a dataset or a file is closed.
So it writes through a Python file that keeps the first error and discards everything after it.
"""

import io
import signal
import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import h5py


class _Disk(io.FileIO):
    """A file whose `write` never fails, which would crash HDF5 too, but keeps the first error."""

    error: OSError | None = None

    def write(self, data: Any) -> int:
        rest = memoryview(data)
        try:
            while rest and self.error is None:
                rest = rest[super().write(rest) :]
        except OSError as error:
            self.error = error
        return len(data)

    def truncate(self, size: int | None = None) -> int:
        try:
            return super().truncate(size) if self.error is None else 0
        except OSError as error:
            self.error = error
            return 0


@contextmanager
def new_hdf5(path: Path, final: Path) -> Iterator[tuple[h5py.File, Callable[[], None]]]:
    """Create an HDF5 file within the block; an existing one is replaced.

    SIGINT and SIGTERM wait for the check: what their handlers raise within a `write` crashes HDF5.

    Args:
        final: name that errors give.

    Yields:
        The file, open for writing, and a check, to be called now and then, that raises what went
        wrong meanwhile.

    Raises:
        OSError: the file cannot be written; by the check, or at the end of the block.
    """
    received: list[int] = []
    before: dict[int, Any] = {}
    if threading.current_thread() is threading.main_thread():  # no other may set handlers
        for number in (signal.SIGINT, signal.SIGTERM):
            if callable(handler := signal.getsignal(number)):
                before[number] = handler
                signal.signal(number, lambda number, _: received.append(number))
    try:
        with _Disk(path, "w+") as disk:

            def check() -> None:
                if disk.error is not None:
                    raise disk.error
                if received:
                    before[received[0]](received.pop(), None)

            try:
                with h5py.File(disk, "w") as file:
                    yield file, check
            finally:
                for signal_, handler in before.items():
                    signal.signal(signal_, handler)
                check()  # before what came of it
    except OSError as error:
        error.filename = error.filename or str(final)
        raise
