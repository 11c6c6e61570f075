"""Work that is left when its time is over, such as a trial of what a build would do."""

import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from math import inf
from typing import Any

AGAIN_S = 2.0  # longer than a busy machine keeps a process waiting while it leaves the block


class _OutOfTime(BaseException):
    """Leaves the work, past handlers of errors."""


@contextmanager
def time_limit(seconds: float) -> Iterator[None]:
    """Leave the block quietly after so many seconds; what it has put aside by then counts.

    A call of a library is finished first. HDF5 should not be called in the block: what is raised
    while it writes crashes it. There is no limit in a thread, which no signal reaches. A library
    that calls Python back, as a compiler does, may swallow what leaves the block and fail for want
    of what it called for: an error after the end of the time is the end.

    Args:
        seconds: duration, s; inf for no limit.
    """
    main = threading.current_thread() is threading.main_thread()
    if seconds == inf or not main or not hasattr(signal, "setitimer"):
        yield
        return
    over = has_ended = False

    def leave(number: int, frame: Any) -> None:
        nonlocal has_ended
        if not over:
            has_ended = True
            raise _OutOfTime

    hook = sys.unraisablehook  # which would print it
    sys.unraisablehook = lambda swallowed: None if _is_over(swallowed) else hook(swallowed)
    before = signal.signal(signal.SIGALRM, leave)
    # Again and again, as Python swallows what is raised within a `__del__`.
    remaining, interval = signal.setitimer(signal.ITIMER_REAL, max(seconds, 1e-6), AGAIN_S)
    try:
        yield
    except _OutOfTime:
        pass
    except Exception:
        if not has_ended:
            raise
    finally:
        over = True
        signal.setitimer(signal.ITIMER_REAL, remaining, interval)
        signal.signal(signal.SIGALRM, before)
        sys.unraisablehook = hook


def _is_over(swallowed: Any) -> bool:
    """Whether what Python has swallowed is the end of the time, which comes again."""
    return isinstance(swallowed.exc_value, _OutOfTime)
