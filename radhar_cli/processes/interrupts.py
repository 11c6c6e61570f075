"""Ctrl-C and SIGTERM of the program: raised, and remembered, as Python may swallow what is raised.

What a handler raises within a `__del__` or a weakref callback is printed and forgotten, and some
libraries turn it into errors of their own.
"""

import signal
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from radhar_cli.errors import INTERRUPTED, TERMINATED

_STATUS = {signal.SIGINT: INTERRUPTED, signal.SIGTERM: TERMINATED}
_received: list[int] = []
_told: list[bool] = []
_complete: list[str] = []


@contextmanager
def handled() -> Iterator[None]:
    """Handle Ctrl-C and SIGTERM within the block; afterwards they are ignored."""
    hook = sys.unraisablehook
    _received.clear()
    _told.clear()
    _complete.clear()
    signal.signal(signal.SIGTERM, _receive)
    if signal.getsignal(signal.SIGINT) is signal.default_int_handler:  # not of a background job
        signal.signal(signal.SIGINT, _receive)
    sys.unraisablehook = lambda swallowed: None if _received else hook(swallowed)
    try:
        yield
    finally:
        for number in _STATUS:
            signal.signal(number, signal.SIG_IGN)
        sys.unraisablehook = hook
        _received.clear()
        _complete.clear()


def tell_once() -> bool:
    """Whether nobody has told the user yet what a signal left behind: true for the first call."""
    first = not _told
    _told.append(True)
    return first


def complete(result: str) -> None:
    """Let no signal end the program from now on, nor one that came before and was swallowed.

    Args:
        result: result that is complete, for the line that names it if there was a signal.
    """
    _complete.append(result)


def outlived() -> str | None:
    """Result that was complete when a signal asked to stop, or None."""
    return _complete[0] if _received and _complete else None


def received() -> int | None:
    """Exit status that belongs to the first signal that came, or None."""
    return _STATUS[signal.Signals(_received[0])] if _received else None


def status() -> int | None:
    """Exit status for the first signal that came before the work was complete, or None."""
    return None if _complete else received()


def check() -> None:
    """Raise the exception of a signal that came, also if it was raised before and swallowed.

    Raises:
        KeyboardInterrupt: Ctrl-C.
        SystemExit: SIGTERM, with its status.
    """
    stopped = status()
    if stopped == INTERRUPTED:
        raise KeyboardInterrupt
    if stopped is not None:
        raise SystemExit(stopped)


def _receive(number: int, frame: Any) -> None:
    """Unwind, so that whatever is open is closed and workers end."""
    _received.append(number)
    check()
