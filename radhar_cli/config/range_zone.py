"""Where people can be, by what a config draws: the range axis that images have by default."""

from collections.abc import Iterator
from math import ceil, hypot
from typing import TYPE_CHECKING, Any

from radhar_cli.config.number import support
from radhar_cli.config.section import PerActivity

if TYPE_CHECKING:
    from radhar_cli.config.motion import MotionConfig
    from radhar_cli.config.request import Request
    from radhar_cli.config.section import B

REACH_M = 1.0  # of a limb, and of what a person drifts and falls, beyond the feet


def range_zone(request: "Request") -> tuple[float, float]:
    """Ranges in which people can be: from 0 to the whole metre beyond the farthest of them.

    It follows from what the config may draw, not from what a sample has drawn: an axis that
    followed a sample would tell where its person is, and so maybe what it does.
    """
    sections = [request.motion, *(person.motion for person in request.people)]
    return 0.0, float(ceil(max(map(_farthest, sections)) + REACH_M))


def _farthest(motion: "MotionConfig[B]") -> float:
    """Range of the farthest place at which a person may start, m."""
    along = max(abs(end) for end in _ends(motion.range_m))
    across = max(abs(end) for end in _ends(motion.cross_range_m))
    return hypot(along, across)


def _ends(number: Any) -> Iterator[float]:
    """Yield the smallest and the largest value of a number, whatever the activity."""
    forms = number.per_activity.values() if isinstance(number, PerActivity) else (number,)
    for form in forms:
        yield from (0.0, 0.0) if form is None else support(form)
