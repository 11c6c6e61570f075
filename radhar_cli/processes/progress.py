"""Messages and progress of long work."""

from typing import Protocol


class Messages(Protocol):
    """Receives messages."""

    def say(self, message: str) -> None:
        """Tell the user something."""


class Progress(Messages, Protocol):
    """Receives messages and how far the work is."""

    def stage(self, name: str, total: int, done: int, unit: str | None = None) -> None:
        """Note that a part of the work begins.

        Args:
            name: name of the part, in a word.
            total: number of its units.
            done: number of units that are finished already.
            unit: name of a unit, if it is not what this progress counts as a rule.
        """

    def advance(self, count: int) -> None:
        """Note that so many further units of the stage are finished."""


class NoProgress:
    """Progress that nobody watches."""

    def say(self, message: str) -> None:
        """Nobody reads it."""

    def stage(self, name: str, total: int, done: int, unit: str | None = None) -> None:
        """Nobody sees it."""

    def advance(self, count: int) -> None:
        """Nobody sees it."""


NO_PROGRESS = NoProgress()
