"""Movements that are repeated: when each begins, how fast and how far it goes."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import inf, isinf
from typing import Generic, NamedTuple, Protocol, TypeVar

from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.part import STANDING, Phase, Place
from radhar_cli.motion.human.physique import Physique


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


class Strikes(Protocol):
    """Blows one after the other for `duration` s, from a stance that takes `entry` s to take.

    The first comes `first` s after the stance is taken.
    """

    @property
    def duration(self) -> float: ...
    @property
    def first(self) -> float: ...
    @property
    def entry(self) -> float: ...
    @property
    def from_rest(self) -> bool: ...


S = TypeVar("S", bound=Strikes)


@dataclass(frozen=True)
class Striking(Generic[S]):
    """Blows of a person; see `part.Part`. Subclasses have the steps of the blows and the pose."""

    person: Physique  # whose blows
    strikes: S  # how
    begin: float  # from when on, s
    horizon: float  # until when there are blows, s

    after = STANDING
    place = Place()
    stance = "in stance"
    name = "striking"

    @property
    def before(self) -> str:
        return STANDING if self.strikes.from_rest else self.stance

    @property
    def _first(self) -> float:
        entry = self.strikes.entry if self.strikes.from_rest else 0.0
        return self.begin + self.strikes.first + entry

    @property
    def _until(self) -> float:
        return min(self.horizon + 1.0, self._first + self.strikes.duration)

    @cached_property
    def _blows(self) -> list[Step]:
        raise NotImplementedError

    @cached_property
    def _leaves(self) -> float:
        if isinf(self.strikes.duration):
            return inf
        return max((step.start + step.length for step in self._blows), default=self.begin)

    def _taken(
        self, channel: str, change: float, at: float = 0.0, share: float = 1.0
    ) -> list[Step]:
        """Steps by which the stance is taken and left, `at` and for a `share` of the entry."""
        entry, steps = self.strikes.entry, []
        if self.strikes.from_rest:
            steps.append(Step(channel, change, self.begin + at * entry, share * entry))
        if not isinf(self._leaves):
            steps.append(Step(channel, -change, self._leaves + at * entry, share * entry))
        return steps

    @property
    def end(self) -> float:
        return self._leaves + self.strikes.entry

    @property
    def phases(self) -> tuple[Phase, ...]:
        under_way = Phase(self.begin, self.name)
        return (under_way,) if isinf(self.end) else (under_way, Phase(self.end, "standing"))

    @cached_property
    def course(self) -> Course:
        """The channels that `pose` needs."""
        raise NotImplementedError

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return self.course.breakpoints
