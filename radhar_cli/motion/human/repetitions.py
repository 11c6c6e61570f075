"""Movements that are repeated: when each begins, how fast and how far it goes."""

from collections.abc import Sequence
from typing import NamedTuple


class Repetition(NamedTuple):
    """One of them: its beginning (s), the time it takes and its size over the usual ones."""

    start: float
    pace: float = 1.0
    size: float = 1.0


def repetitions(
    first: float,
    period: float,
    until: float,
    paces: Sequence[float] = (),
    sizes: Sequence[float] = (),
) -> list[Repetition]:
    """Repetitions from `first` (s) on that begin before `until` (s).

    Each takes `period` (s) times its pace until the next one begins; where the paces or the sizes
    are used up, they are 1.
    """
    if not period > 0:
        raise ValueError(f"movements repeat after more than 0 s, not {period:g} s")
    found: list[Repetition] = []
    start = first
    while start < until:
        n = len(found)
        pace = paces[n] if n < len(paces) else 1.0
        found.append(Repetition(start, pace, sizes[n] if n < len(sizes) else 1.0))
        start += period * pace
    return found
