"""Movements that are repeated: when each begins, how fast and how far it goes."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from math import ceil, inf, isinf
from typing import Annotated, Generic, NamedTuple, TypeVar

import numpy as np

from radhar_cli.motion.human.minimum_jerk import Course
from radhar_cli.motion.human.part import HERE, STANDING, Phase
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.movements.kind import Mover
from radhar_cli.numerics.arrays import Float
from radhar_cli.schema.annotations import UNSTEADY, People
from radhar_cli.schema.number import NOT_NEGATIVE, RATIO, SIGNED, uniform
from radhar_cli.schema.section import B, ByActivity, Section, default_draw

MOST_HZ = 5.0  # repetitions per second: claps
EACH = ("repeating.tempo_jitter", "repeating.size_jitter")  # keys by which repetitions differ
PHASE = "repeating.cycle_phase"


class RepeatingConfig(Section, Generic[B]):
    """Differences between one repetition of a movement and the next."""

    cycle_phase: Annotated[B, ByActivity(SIGNED), People(None, -1, 1)] = default_draw(
        uniform(-0.5, 0.5)
    )
    """Initial phase of steady walks, punches, kicks and turns, in cycles."""
    tempo_jitter: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(None, 0, 0.2), UNSTEADY] = (
        default_draw(uniform(0.0, 0.1))
    )
    """Relative standard deviation of the time from one punch, kick or turn to the next."""
    size_jitter: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(None, 0, 0.15), UNSTEADY] = (
        default_draw(uniform(0.0, 0.1))
    )
    """Relative standard deviation of the size from one punch, kick or turn to the next."""


SECTION = RepeatingConfig


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
        first: Beginning of the first repetition, s.
        period: Time that a usual one takes until the next begins, s.
        until: Latest beginning of the last, s.
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


def draw_repetitions(mover: Mover) -> tuple[Float, Float]:
    """Draw the pace and the size of each repetition over the usual ones, each [count]."""
    numbers, count = mover.numbers(RepeatingConfig[float]), ceil(MOST_HZ * mover.seconds) + 8
    tempo = mover.stream(f"motion.tempo_jitter/{mover.place}").standard_normal(count)
    size = mover.stream(f"motion.size_jitter/{mover.place}").standard_normal(count)
    paces = np.clip(1 + numbers.tempo_jitter * tempo, 0.7, 1.4)
    return paces, np.clip(1 + numbers.size_jitter * size, 0.6, 1.15)


def nonzero_tuple(numbers: Float) -> tuple[float, ...]:
    """Numbers as a tuple, empty where all are 0."""
    return tuple(numbers.tolist()) if numbers.any() else ()


@dataclass(frozen=True, kw_only=True)
class Repeated:
    """A movement that is repeated for `duration` s; infinity goes on."""

    duration: float = inf
    # paces, sizes: time and size of each repetition, over the usual ones
    paces: tuple[float, ...] = ()
    sizes: tuple[float, ...] = ()


R = TypeVar("R", bound=Repeated)


@dataclass(frozen=True)
class Repeating(Generic[R]):
    """The `part.Part` of a person who repeats a movement; subclasses have course, end and pose."""

    person: Physique
    movement: R
    begin: float  # s
    horizon: float  # end of the recording, s; what goes on is worked out until 1 s after it

    place = HERE

    @property
    def name(self) -> str:
        """Name of its phase."""
        raise NotImplementedError

    @property
    def before(self) -> str:
        return STANDING

    @property
    def after(self) -> str:
        return STANDING

    @property
    def end(self) -> float:
        raise NotImplementedError

    @cached_property
    def course(self) -> Course:
        """Course of the channels that `pose` needs."""
        raise NotImplementedError

    @property
    def phases(self) -> tuple[Phase, ...]:
        under_way = Phase(self.begin, self.name)
        return (under_way,) if isinf(self.end) else (under_way, Phase(self.end, self.after))

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return self.course.breakpoints

    def repeat(self, start: float, period: float, until: float, least: int = 1) -> list[Repetition]:
        """Repetitions from `start` (s) to `until` (s) or the end; 0 or 1 at least."""
        until = max(min(self.horizon + 1.0, until), start + 1e-9 * least)
        return repetitions(start, period, until, self.movement.paces, self.movement.sizes)
