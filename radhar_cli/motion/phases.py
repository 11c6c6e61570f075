"""Names of what a body does within an activity, and their numbers over time."""

from collections.abc import Sequence

import numpy as np

from radhar_cli.numerics.arrays import Float, Levels

# What the twelve activities and sequences of movements consist of. Data sets store these numbers:
# new names go to the end.
PHASES = (
    "standing",
    "seated",
    "lying",
    "walking",
    "punching",
    "kicking",
    "picking up",
    "turning",
    "sitting down",
    "standing up",
    "falling",
    "getting up",
    "turning around",
    "stepping",
    "squatting",
    "lunging",
    "jumping",
    "raising",
    "stumbling",
    "kneeling",
    "getting down",
    "crawling",
    "lying down",
    "turning over",
    "drinking",
    "writing",
    "waving",
    "clapping",
    "running",
    "jogging in place",
    "limping",
    "walking with a stick",
    "walking with a walker",
    "carrying",
)


def phase_numbers(
    phases: Sequence[tuple[float, str]], t: Float, names: Sequence[str], other: int
) -> Levels:
    """Number of the phase under way at each time [M].

    Args:
        phases: (start in s, name) of each, in their order.
        t: Times [M], s.
        names: Names whose places are the numbers.
        other: Number where no phase is under way, or one that `names` lacks.
    """
    numbers = np.full(t.size, other, dtype=np.uint8)
    for start, name in phases:
        numbers[t >= start] = names.index(name) if name in names else other
    return numbers
