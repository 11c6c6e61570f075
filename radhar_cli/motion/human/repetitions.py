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
    """One repetition: its beginning (s), and the time it takes and its size over the usual ones."""

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

    Args:
        first: When the first repetition begins, s.
        period: Time that a usual one takes until the next begins, s.
        until: When the last has begun at the latest, s.
        paces: Time of each repetition over the period; 1 where they are used up.
        sizes: Size of each repetition over the usual one; 1 where they are used up.

    Raises:
        ValueError: The period is not above 0.
    """
    if not period > 0:
        raise ValueError(f"movements repeat after more than 0 s, not {period:g} s")
    listed: list[Repetition] = []
    start = first
    while start < until:
        n = len(listed)
        pace = paces[n] if n < len(paces) else 1.0
        listed.append(Repetition(start, pace, sizes[n] if n < len(sizes) else 1.0))
        start += period * pace
    return listed


class Strikes(Protocol):
    """How a person strikes blow after blow, from a stance that is taken first.

    Attributes:
        duration: How long there are blows, s; infinity for what goes on.
        first: When the first blow comes after the stance is taken, s.
        entry: Time that it takes to take the stance, and to leave it, s.
        from_rest: Whether the person takes the stance at first; else they stand in it already.
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
    """The `part.Part` of a person who strikes; subclasses have the blows and the pose."""

    person: Physique
    strikes: S
    begin: float  # when the stance begins to be taken, s
    horizon: float  # end of the recording, s; blows that go on are worked out until 1 s after it

    after = STANDING
    place = Place()
    stance = "in stance"
    name = "striking"

    @property
    def before(self) -> str:
        return STANDING if self.strikes.from_rest else self.stance

    @property
    def _first(self) -> float:
        """When the first blow begins, s."""
        entry = self.strikes.entry if self.strikes.from_rest else 0.0
        return self.begin + self.strikes.first + entry

    @property
    def _until(self) -> float:
        """When the last blow has begun at the latest, s."""
        return min(self.horizon + 1.0, self._first + self.strikes.duration)

    @cached_property
    def _strike_steps(self) -> list[Step]:
        """Steps of all blows."""
        raise NotImplementedError

    @cached_property
    def _stance_end_s(self) -> float:
        """When the last blow has ended and the stance begins to be left, s."""
        if isinf(self.strikes.duration):
            return inf
        return max((step.start + step.length for step in self._strike_steps), default=self.begin)

    def _stance_steps(
        self, channel: str, change: float, delay: float = 0.0, share: float = 1.0
    ) -> list[Step]:
        """Steps that take and leave the stance, `delay` late and within a `share` of the entry."""
        entry = self.strikes.entry
        steps = []
        if self.strikes.from_rest:
            steps.append(Step(channel, change, self.begin + delay * entry, share * entry))
        if not isinf(self._stance_end_s):
            steps.append(Step(channel, -change, self._stance_end_s + delay * entry, share * entry))
        return steps

    @property
    def end(self) -> float:
        return self._stance_end_s + self.strikes.entry

    @property
    def phases(self) -> tuple[Phase, ...]:
        under_way = Phase(self.begin, self.name)
        return (under_way,) if isinf(self.end) else (under_way, Phase(self.end, "standing"))

    @cached_property
    def course(self) -> Course:
        """Course of the channels that `pose` needs."""
        raise NotImplementedError

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return self.course.breakpoints
