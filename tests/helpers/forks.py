"""Python programs in forks of a small process that has loaded h5py already.

`radhar_cli/readers/hdf5_check.py` runs in a process of its own for every HDF5 file that is opened.
A fork has the same limits, and may crash as freely, for a hundredth of the processor time.
"""

import os
import pickle
import subprocess
import sys
from collections.abc import Sequence
from threading import get_ident
from typing import Any

SERVER = """
import io, os, pickle, runpy, sys, tempfile, traceback
import h5py

def run(program, text):
    sys.argv, sys.stdin = [program], io.TextIOWrapper(io.BytesIO(text))
    try:
        runpy.run_path(program, run_name="__main__")
    except SystemExit as end:
        if isinstance(end.code, int) or end.code is None:
            return end.code or 0
        print(end.code, file=sys.stderr)
        return 1
    except BaseException:
        traceback.print_exc()
        return 1
    return 0

answers, requests = os.fdopen(os.dup(1), "wb"), sys.stdin.buffer
while True:
    try:
        program, text = pickle.load(requests)
    except EOFError:
        break
    with tempfile.TemporaryFile() as out, tempfile.TemporaryFile() as err:
        child = os.fork()
        if not child:
            os.dup2(out.fileno(), 1)
            os.dup2(err.fileno(), 2)
            status = run(program, text)
            sys.stdout.flush()
            sys.stderr.flush()
            os._exit(status)
        status = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
        out.seek(0)
        err.seek(0)
        pickle.dump((status, out.read(), err.read()), answers)
        answers.flush()
"""


class ForkServer:
    """A process that runs programs in forks of itself, one after another.

    It starts with the first program. Each process and thread that asks has a server of its own: by
    the pipes of its parent, a worker that loads batches would take answers to other requests.
    """

    def __init__(self) -> None:
        self._servers: dict[tuple[int, int], subprocess.Popen[bytes]] = {}

    def run(
        self, command: Sequence[str], *, input: bytes, **_: Any
    ) -> subprocess.CompletedProcess[bytes]:
        """Stand for `subprocess.run` of a Python file that has no arguments."""
        asker = os.getpid(), get_ident()
        if asker not in self._servers:
            self._servers[asker] = subprocess.Popen(
                [sys.executable, "-P", "-c", SERVER],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                start_new_session=True,
            )
        server = self._servers[asker]
        assert server.stdin is not None
        assert server.stdout is not None
        try:
            pickle.dump((command[-1], input), server.stdin)
            server.stdin.flush()
            answer = pickle.load(server.stdout)
        except BaseException:  # an alarm, say: the next request would get this answer
            self._end(asker)
            raise
        return subprocess.CompletedProcess([*command], *answer)

    def close(self) -> None:
        """Kill the servers of this process: a fork may hold their inputs open for ever."""
        for asker in [*self._servers]:
            if asker[0] == os.getpid():
                self._end(asker)

    def _end(self, asker: tuple[int, int]) -> None:
        with self._servers.pop(asker) as server:
            server.kill()
