"""Bars on the error stream where that is a terminal, and messages in between."""

import sys
from typing import Any

from tqdm import tqdm

from radhar_cli import interrupts
from radhar_cli.commands.tell import is_quiet, wanted
from radhar_cli.untrusted import Closing, shown


class Bars(Closing):
    """One bar at a time, which `with` takes away; none without a terminal, or with --quiet."""

    def __init__(self) -> None:
        self._bar: tqdm[Any] | None = None

    def open(self, name: str, total: int, unit: str, done: int = 0, leave: bool = True) -> None:
        """Show a bar instead of the one before."""
        self.close()
        self._bar = tqdm(
            total=total,
            initial=done,
            desc=name,
            unit=unit,
            leave=leave,
            disable=True if is_quiet() else None,
            file=sys.stderr,
        )

    def advance(self, count: int, note: str = "") -> None:
        """Some units are done."""
        interrupts.check()
        if self._bar is not None:
            if note:
                self._bar.set_postfix_str(note, False)
            self._bar.update(count)

    def say(self, message: str) -> None:
        """A line above the bar."""
        if wanted(message):
            tqdm.write(shown(message), file=sys.stderr)

    def close(self) -> None:
        """Take the bar away."""
        if self._bar is not None:
            self._bar.close()
            self._bar = None
