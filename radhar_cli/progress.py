"""Messages and progress of long work."""

from typing import Protocol


class Messages(Protocol):
    """Receives messages."""

    def say(self, message: str) -> None:
        """Something the user should read."""


class Progress(Messages, Protocol):
    """Receives messages and how far the work is."""

    def stage(self, name: str, total: int, done: int) -> None:
        """A part of the work begins: `total` units, of which `done` are finished."""

    def advance(self, count: int) -> None:
        """Some units of it are finished."""
