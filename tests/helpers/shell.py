"""Run shell text as it is printed, `radhar` and other programs answered by this process.

Starting Python for every command would take most of the time: PyTorch alone takes seconds.
"""

import contextlib
import os
import signal
import subprocess
import threading
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple


class Call(NamedTuple):
    """A program that the shell calls, and its arguments."""

    program: str
    words: list[str]


class Answer(NamedTuple):
    """What it prints, and how it ends."""

    status: int = 0
    out: str = ""
    err: str = ""


def run_shell(
    text: str,
    folder: Path,
    programs: Mapping[str, Callable[[Call], Answer]],
) -> subprocess.CompletedProcess[str]:
    """Run text in bash; it ends at the first command that fails.

    Args:
        text: commands.
        folder: where they run, and this process with them.
        programs: {name: answers a call}; every other program is the machine's.
    """
    wires = folder / ".wires"
    wires.mkdir(exist_ok=True)
    for name in ("call", "status"):
        with contextlib.suppress(FileExistsError):
            os.mkfifo(wires / name)
    functions = "".join(f'{name}() {{ call {name} "$@"; }}\n' for name in programs)
    head = f"""set -euo pipefail
call() {{
  printf '%s\\0' "$PWD" "$@" >"{wires}/call"
  local status; read -r status <"{wires}/status"
  cat "{wires}/err" >&2; cat "{wires}/out"
  return "$status"
}}
{functions}"""
    shell = subprocess.Popen(
        ["bash", "-c", head + text],
        cwd=folder,
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    printed: list[str] = []

    def wait() -> None:
        printed.extend(shell.communicate())
        (wires / "call").write_bytes(b"")

    waiting = threading.Thread(target=wait)
    waiting.start()
    try:
        while called := (wires / "call").read_bytes():
            place, name, *words = called.decode().split("\0")[:-1]
            with contextlib.chdir(place):
                answer = programs[name](Call(name, words))
            (wires / "out").write_text(answer.out)
            (wires / "err").write_text(answer.err)
            (wires / "status").write_text(f"{answer.status}\n")
    except BaseException:
        os.killpg(shell.pid, signal.SIGKILL)
        (wires / "call").read_bytes()
        raise
    finally:
        waiting.join()
    return subprocess.CompletedProcess([text], shell.returncode, *printed)
