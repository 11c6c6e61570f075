"""Programs in forks answer the process that asks, and end with it, whatever it has forked."""

import os
import signal
import sys
import time
from pathlib import Path

import pytest
from helpers.forks import ForkServer

pytestmark = pytest.mark.skipif(not hasattr(os, "fork"), reason="this system cannot fork")
WAIT_S = 60.0


@pytest.fixture
def program(tmp_path: Path) -> str:
    """A program that prints its input, after a moment in which others may ask."""
    path = tmp_path / "program.py"
    path.write_text("import sys, time; time.sleep(0.01); print(sys.stdin.read())")
    return str(path)


def test_the_server_ends_although_a_fork_holds_its_input_open(program: str) -> None:
    forks = ForkServer()
    assert forks.run([sys.executable, program], input=b"first").stdout == b"first\n"
    fork = os.fork()
    if not fork:
        time.sleep(WAIT_S)
        os._exit(0)
    try:
        began = time.monotonic()
        forks.close()
        assert time.monotonic() - began < WAIT_S / 2
    finally:
        os.kill(fork, signal.SIGKILL)
        os.waitpid(fork, 0)


def test_a_fork_and_its_parent_each_get_their_own_answers(program: str) -> None:
    def ask(name: str) -> bool:
        texts = [f"{name} {number}" for number in range(20)]
        answers = [forks.run([sys.executable, program], input=text.encode()) for text in texts]
        return [answer.stdout.decode().strip() for answer in answers] == texts

    forks = ForkServer()
    assert ask("before")
    fork = os.fork()
    if not fork:
        signal.alarm(int(WAIT_S))
        os._exit(0 if ask("fork") else 1)
    assert ask("parent")
    assert os.waitstatus_to_exitcode(os.waitpid(fork, 0)[1]) == 0
    forks.close()


def test_an_answer_that_was_not_waited_for_is_not_that_of_the_next_request(program: str) -> None:
    def leave(*_: object) -> None:
        raise TimeoutError

    forks = ForkServer()
    slow = Path(program).with_name("slow.py")
    slow.write_text("import time; time.sleep(1); print('late')")
    forks.run([sys.executable, program], input=b"")
    before = signal.signal(signal.SIGALRM, leave)
    signal.setitimer(signal.ITIMER_REAL, 0.2)
    try:
        with pytest.raises(TimeoutError):
            forks.run([sys.executable, str(slow)], input=b"")
    finally:
        signal.signal(signal.SIGALRM, before)
    assert forks.run([sys.executable, program], input=b"next").stdout == b"next\n"
    forks.close()
