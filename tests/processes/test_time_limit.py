"""Work that takes too long is left, what it has done by then stays, and nothing else changes."""

import signal
import sys
import threading
import time
from contextlib import suppress
from math import inf

import pytest

from radhar_cli.processes.time_limit import time_limit

LONG = 3600  # s

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="POSIX signals")


def test_work_is_left_and_what_it_has_done_stays() -> None:
    done = []
    with time_limit(0.1):
        done.append("first")
        time.sleep(LONG)
        done.append("second")
    assert done == ["first"]


class Slow:
    def __del__(self) -> None:
        time.sleep(0.2)


def test_work_is_left_although_python_swallows_the_signal_once(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(sys, "unraisablehook", lambda swallowed: None)
    with time_limit(0.05):
        Slow()
        time.sleep(LONG)


def test_a_library_that_swallows_the_end_may_fail_of_it() -> None:
    """As numba does, whose compiler calls Python back."""
    with time_limit(0.05):
        with suppress(BaseException):
            time.sleep(LONG)
        raise RuntimeError("no compiled object yet")


def test_errors_of_the_work_pass_and_short_work_is_not_disturbed() -> None:
    with pytest.raises(ValueError, match="wrong"), time_limit(LONG):
        raise ValueError("wrong")
    for seconds in (LONG, inf):
        with time_limit(seconds):
            done = True
        assert done


def test_a_timer_of_the_program_goes_on() -> None:
    before = signal.getsignal(signal.SIGALRM)
    signal.setitimer(signal.ITIMER_REAL, LONG)
    try:
        with time_limit(0.05):
            time.sleep(LONG)
        assert 0 < signal.getitimer(signal.ITIMER_REAL)[0] <= LONG
        assert signal.getsignal(signal.SIGALRM) is before
    finally:
        signal.setitimer(signal.ITIMER_REAL, 0)


def test_there_is_no_limit_in_a_thread() -> None:
    done = []

    def work() -> None:
        with time_limit(0.01):
            time.sleep(0.05)
            done.append(True)

    thread = threading.Thread(target=work)
    thread.start()
    thread.join()
    assert done == [True]
