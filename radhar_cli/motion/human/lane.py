"""Walking to and fro: straight on for a while, then half a turn along an arc, and so on.

In an arc of length a the heading turns by pi S(x) within 0 <= x <= 1, x the share of the arc, so
the walker is at a (int cos(pi S), int sin(pi S)) from its beginning; after it ahead by nothing.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import ceil
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from radhar_cli.motion.human.minimum_jerk import minimum_jerk
from radhar_cli.numerics.arrays import Float

if TYPE_CHECKING:
    from numpy.polynomial import Chebyshev

DEGREE = 40  # of the integrals, which then hold to 1e-15


@dataclass(frozen=True)
class Lane:
    """The way of a walker who goes to and fro, and where the half turns are."""

    length: float  # length of the straight way between half turns, m
    first: float = 0.0  # length of the way before the first half turn, m
    radius: float = 0.5  # mean radius of the half turns, m
    side: float = 1.0  # side to which all half turns go: 1 to the left, -1 to the right
    slow: float = 0.45  # by how much a walker slows down in half turns, fraction of the speed


class WalkTimes(NamedTuple):
    """Beginning and end of a walk, and durations of its changes, s."""

    begin: float
    end: float  # when it begins to stop; of a walk that goes on, the end of the recording
    stops: bool  # whether it ends
    start_up: float  # time in which it gains its speed, 0 for a walk under way
    ramp: float  # time in which it changes its speed
    stride: float


def place_half_turns(lane: Lane, speed: float, arc: float, walk: WalkTimes) -> Float:
    """Place the half turns of a walk to and fro.

    Args:
        lane: Straight way between turns, way before the first, loss of speed in a turn.
        speed: Walking speed on the straight, m/s.
        arc: Length of a half turn, m.

    Returns:
        Distance at which each turn begins [K], m, rising. A walk that stops ends on a straight: a
        turn that would not be over one ramp before its end is left out.
    """
    lost = arc * lane.slow / (1 - lane.slow)  # way lost in a turn, walked at (1 - slow) speed
    spacing = arc + max(lane.length, speed * walk.ramp)
    first = max(lane.first, speed * walk.start_up)
    if walk.stops:
        reach = speed * (walk.end - walk.ramp - walk.begin) - (arc + lost)
    else:
        reach = speed * (walk.end + walk.stride - walk.begin)
    count = max(0, ceil((reach - first) / (spacing + lost)))
    starts: Float = first + spacing * np.arange(count)
    return starts


@lru_cache(maxsize=1)
def _arc() -> "tuple[Chebyshev, Chebyshev]":
    """Integrals of cos and sin of pi S(x) from 0 to x."""
    from numpy.polynomial import Chebyshev  # slow to import

    forth, across = (
        Chebyshev.interpolate(
            lambda x, f=f: f(np.pi * minimum_jerk(x)),  # type: ignore[misc]
            DEGREE,
            domain=[0, 1],
        ).integ(lbnd=0)
        for f in (np.cos, np.sin)
    )
    return forth, across


def position_along_lane(
    s: Float, begins: Float, arc: float, side: float
) -> tuple[Float, Float, Float]:
    """Position and heading of a walker who has gone some distance along a lane.

    Args:
        s: Distance gone [M], m.
        begins: Distances at which half turns begin [K], m.
        arc: Length of a half turn, m.
        side: 1 for turns to the left, -1 to the right.

    Returns:
        x, y (m) and heading (rad), each [M].
    """
    x, y, heading = s.copy(), np.zeros_like(s), np.zeros_like(s)
    if not begins.size:
        return x, y, heading
    forth, across = (integral(np.ones(1))[0] * arc for integral in _arc())
    turn = np.searchsorted(begins, s, side="left") - 1  # the last that has begun, -1 for none
    direction = 1.0 - 2.0 * (np.arange(begins.size) % 2)  # 1 on the way there, -1 on the way back
    straight = np.diff(begins) - arc  # between a turn and the next
    x0 = begins[0] + np.concatenate([[0.0], np.cumsum(direction[:-1] * (forth - straight))])
    y0 = np.concatenate([[0.0], np.cumsum(direction[:-1] * side * across)])
    has_turned = turn >= 0
    k, beyond_turn = turn[has_turned], s[has_turned] - begins[turn[has_turned]]
    share, after_arc = np.minimum(beyond_turn / arc, 1.0), np.maximum(beyond_turn - arc, 0.0)
    forth, across = (arc * integral(share) for integral in _arc())
    x[has_turned] = x0[k] + direction[k] * (forth - after_arc)
    y[has_turned] = y0[k] + direction[k] * side * across
    heading[has_turned] = side * np.pi * (k + minimum_jerk(share))
    return x, y, heading
