"""The engine of studies: settings are tried one after the other, as far as the time goes.

`radhar tradeoff` varies settings of a config, `radhar limits` sides of its numbers. Both give a
function that yields ever better results of a setting; the last within its time counts.
"""

import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from math import inf
from typing import Generic, TypeVar

from radhar_cli.errors import RadharError
from radhar_cli.processes.progress import Progress
from radhar_cli.processes.time_limit import time_limit

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


def last_within(seconds: float, results: Iterable[R]) -> R | None:
    """Last of some results that there is after so many seconds; None where there is none."""
    result: R | None = None
    with time_limit(seconds):
        for result in results:  # noqa: B007
            pass
    return result


def try_settings(
    settings: Sequence[S],
    measure: Callable[[S], Iterable[R]],
    budget: Budget,
    progress: Progress,
    shares: float = inf,
) -> Iterator[TriedSetting[S, R]]:
    """Measure settings in turn, each within its share of the time, and yield what came of each.

    Args:
        measure: yields results of a setting, of which the last counts.
        budget: time for all of them.
        progress: is told of each that is done.
        shares: equal parts of the time left that one setting may take.
    """
    for number, setting in enumerate(settings):
        seconds, result, refusal = 0.0, None, None
        if budget.left > 0:
            seconds = budget.share(len(settings) - number, shares)
            try:
                result = last_within(seconds, measure(setting))
            except RadharError as error:
                refusal = error
        yield TriedSetting(setting, result, refusal, seconds)
        progress.advance(1)
