"""Messages and progress of long work."""

from typing import Protocol


class Messages(Protocol):
    """Receives messages."""

    def say(self, message: str) -> None:
        """Something the user should read."""


class Progress(Messages, Protocol):
    """Receives messages and how far the work is."""

    def stage(self, name: str, total: int, done: int, unit: str | None = None) -> None:
        """A part of the work begins: `total` units, of which `done` are finished.

        Args:
            unit: name of one of them, if it is not what this progress counts as a rule.
        """

    def advance(self, count: int) -> None:
        """Some units of it are finished."""


class NoProgress:
    """Progress that nobody watches."""

    def say(self, message: str) -> None:
        """Nobody reads it."""

    def stage(self, name: str, total: int, done: int, unit: str | None = None) -> None:
        """Nobody sees it."""

    def advance(self, count: int) -> None:
        """Nobody sees it."""


NO_PROGRESS = NoProgress()
