"""Walking to and fro: straight on for a while, then half a turn along an arc, and so on.

In an arc of length a the heading turns by pi S(x) within 0 <= x <= 1, x the share of the arc, so
the walker is at a (int cos(pi S), int sin(pi S)) from its beginning; after it ahead by nothing.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np
from numpy.polynomial import Chebyshev

from radhar_cli.arrays import Float
from radhar_cli.motion.human.minimum_jerk import minimum_jerk

DEGREE = 40  # of the integrals, which then hold to 1e-15


@dataclass(frozen=True)
class Lane:
    """Where half turns are."""

    length: float  # of the straight way between them, m
    first: float = 0.0  # of that before the first one, m
    radius: float = 0.5  # of the turns on average, m
    side: float = 1.0  # 1 to the left, -1 to the right, as all of them
    slow: float = 0.45  # by how much a walker slows down in them, fraction of the speed


@lru_cache(maxsize=1)
def _arc() -> tuple[Chebyshev, Chebyshev]:
    """Integrals of cos and sin of pi S(x) from 0 to x."""
    forth, across = (
        Chebyshev.interpolate(
            lambda x, f=f: f(np.pi * minimum_jerk(x)),  # type: ignore[misc]
            DEGREE,
            domain=[0, 1],
        ).integ(lbnd=0)
        for f in (np.cos, np.sin)
    )
    return forth, across


def along(s: Float, begins: Float, arc: float, side: float) -> tuple[Float, Float, Float]:
    """x, y (m) and heading (rad) [M] of a walker who has gone s [M] (m).

    Half turns of a length `arc` begin at `begins` [K] (m), to the left (side 1) or right (-1).
    """
    x, y, heading = s.copy(), np.zeros_like(s), np.zeros_like(s)
    if not begins.size:
        return x, y, heading
    forth, across = (part(np.ones(1))[0] * arc for part in _arc())
    turn = np.searchsorted(begins, s, side="left") - 1  # the last that has begun, -1 for none
    there = 1.0 - 2.0 * (np.arange(begins.size) % 2)  # 1 on the way there, -1 on the way back
    straight = np.diff(begins) - arc  # between a turn and the next
    x0 = begins[0] + np.concatenate([[0.0], np.cumsum(there[:-1] * (forth - straight))])
    y0 = np.concatenate([[0.0], np.cumsum(there[:-1] * side * across)])
    turned = turn >= 0
    k, gone = turn[turned], s[turned] - begins[turn[turned]]
    share, beyond = np.minimum(gone / arc, 1.0), np.maximum(gone - arc, 0.0)
    forth, across = (arc * part(share) for part in _arc())
    x[turned] = x0[k] + there[k] * (forth - beyond)
    y[turned] = y0[k] + there[k] * side * across
    heading[turned] = side * np.pi * (k + minimum_jerk(share))
    return x, y, heading
