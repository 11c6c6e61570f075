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
    """A file whose `write` never fails; `check` raises what it would have raised.

    An exception out of `write` crashes HDF5 too, and signal handlers may run and raise there: what
    they raise is kept as well.
    """

    error: BaseException | None = None

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

    def check(self) -> None:
        if self.error is not None:
            raise self.error

    @contextmanager
    def keeping_signals(self) -> Iterator[None]:
        """Keep what handlers of SIGINT and SIGTERM raise, for `check`."""
        numbers = (signal.SIGINT, signal.SIGTERM)
        in_main = threading.current_thread() is threading.main_thread()  # no other may set handlers
        before = {n: signal.getsignal(n) for n in numbers if in_main}
        handlers = {n: handler for n, handler in before.items() if callable(handler)}

        def keep(number: int, frame: Any) -> None:
            try:
                handlers[signal.Signals(number)](number, frame)
            except BaseException as error:
                # its frames would keep h5py's objects past the end of HDF5, which then crashes
                self.error = self.error or error.with_traceback(None)

        try:
            for number in handlers:
                signal.signal(number, keep)
            yield
        finally:
            for number, handler in handlers.items():
                signal.signal(number, handler)


@contextmanager
def new_hdf5(
    path: Path, final: Path, **options: Any
) -> Iterator[tuple[h5py.File, Callable[[], None]]]:
    """Yield a new HDF5 file and a check, to be called now and then, that it could be written.

    Args:
        path: of the file; one that is there is replaced.
        final: the name that errors give.
        options: of `h5py.File`.

    Raises:
        OSError: it cannot be written; by the check, or at the end.
    """
    try:
        with _Disk(path, "w+") as disk:
            try:
                with disk.keeping_signals(), h5py.File(disk, "w", **options) as file:
                    yield file, disk.check
            finally:
                disk.check()  # before what came of it
    except OSError as error:
        error.filename = error.filename or str(final)
        raise
