"""Movements that are repeated: when each begins, how fast and how far it goes."""

from collections.abc import Sequence
from math import ceil
from typing import Annotated, Generic, NamedTuple

import numpy as np

from radhar_cli.motion.movements.kind import Mover
from radhar_cli.numerics.arrays import Float
from radhar_cli.schema.annotations import UNSTEADY, People
from radhar_cli.schema.number import NOT_NEGATIVE, RATIO, SIGNED, uniform
from radhar_cli.schema.section import B, ByActivity, Section, default_draw

MOST_HZ = 5.0  # repetitions per second: claps
EACH = ("repeating.tempo_jitter", "repeating.size_jitter")  # keys by which repetitions differ
PHASE = "repeating.cycle_phase"


class RepeatingConfig(Section, Generic[B]):
    """How what is done again and again differs from one time to the next."""

    cycle_phase: Annotated[B, ByActivity(SIGNED), People(None, -1, 1)] = default_draw(
        uniform(-0.5, 0.5)
    )
    """Initial phase of steady walks, punches, kicks and turns, in cycles."""
    tempo_jitter: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, RATIO),
        People(
            None,
            0,
            0.2,
        ),
        UNSTEADY,
    ] = default_draw(uniform(0.0, 0.1))
    """Relative standard deviation of the time from one punch, kick or turn to the next."""
    size_jitter: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, RATIO),
        People(
            None,
            0,
            0.15,
        ),
        UNSTEADY,
    ] = default_draw(uniform(0.0, 0.1))
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
