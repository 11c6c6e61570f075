"""The engine of studies: settings are tried one after the other, as far as the time goes."""

import time
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from math import inf
from typing import Generic, TypeVar

from radhar_cli.errors import RadharError
from radhar_cli.processes.progress import Progress

S = TypeVar("S")
R = TypeVar("R")
LEAST_S = 1e-3  # that a setting may take


class Budget:
    """Time that a study may take."""

    def __init__(self, seconds: float) -> None:
        self._end = time.monotonic() + seconds

    @property
    def left(self) -> float:
        """Seconds that are left, 0 or more."""
        return max(0.0, self._end - time.monotonic())

    def share(self, waiting: int, shares: float = inf) -> float:
        """Time of a setting, s: so many equal parts of the time left for those that wait."""
        return max(self.left * min(shares / max(waiting, 1), 1.0), LEAST_S)


@dataclass(frozen=True)
class TriedSetting(Generic[S, R]):
    """A setting that was tried, with its result, or why there is none."""

    setting: S
    result: R | None  # its result; None where it was refused, or the time was too short
    refusal: RadharError | None  # error by which it was refused
    seconds: float  # time that it had


def try_settings(
    settings: Sequence[S],
    measure: Callable[[S, float], R | None],
    budget: Budget,
    progress: Progress,
    shares: float = inf,
) -> Iterator[TriedSetting[S, R]]:
    """Measure settings in turn, each within its share of the time, and yield what came of each.

    Args:
        settings: the settings.
        measure: measures a setting within so many seconds; returns None where they are too few.
        budget: time for all of them.
        progress: is told of each that is done.
        shares: equal parts of the time left that one setting may take.
    """
    for number, setting in enumerate(settings):
        seconds = budget.share(len(settings) - number, shares)
        result, refusal = None, None
        if budget.left > 0:
            try:
                result = measure(setting, seconds)
            except RadharError as error:
                refusal = error
        yield TriedSetting(setting, result, refusal, seconds if budget.left > 0 else 0.0)
        progress.advance(1)
