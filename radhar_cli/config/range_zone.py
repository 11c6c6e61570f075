"""Where people can be, by what a config draws: the range axis that images have by default."""

from collections.abc import Iterable, Iterator
from contextlib import suppress
from math import ceil, hypot
from typing import TYPE_CHECKING, Any

from radhar_cli.activities.activity import Activity
from radhar_cli.config.annotations import ActsIfNull
from radhar_cli.config.number import nominal, support
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
    if request.stream is not None:
        zone = request.stream.zone
        reach = hypot(max(map(abs, zone.range_m)), max(map(abs, zone.cross_range_m)))
        return 0.0, float(ceil(reach + REACH_M))
    people = [(request.motion, request.chosen_activities)]
    with suppress(ValueError):  # of an unknown activity, which is told by itself
        people += [
            (one.motion, request.activities_of(number))
            for number, one in enumerate(request.people, 1)
        ]
    longest = max(_ends(request.duration_s))
    farthest = max(
        _farthest(motion, longest * _speed(motion, activities)) for motion, activities in people
    )
    return 0.0, float(ceil(farthest + REACH_M))


def _farthest(motion: "MotionConfig[B]", course: float) -> float:
    """Range of the farthest place at which a person may start, or be on a usual course, m.

    Who is at a place (`motion.place`) at one instant may be as far away at another as they go.
    """
    starts = motion.range_m, motion.cross_range_m
    reaches = [hypot(*(max(map(abs, _ends(number))) for number in starts))]
    if ActsIfNull("range_m").holds(lambda key: getattr(motion, key)):
        places = motion.place.range_m, motion.place.cross_range_m
        reaches.append(hypot(*(max(map(abs, _ends(number))) for number in places)) + course)
    return max(reaches)


def _speed(motion: "MotionConfig[B]", activities: Iterable[Activity]) -> float:
    """Usual speed of those who go somewhere, m/s; 0 of who turns round or stays in place."""
    movements = {name for activity in activities for name in activity.movements}
    speeds = [0.0]
    if movements & {"walking", "tripping"} and not max(_ends(motion.walking.lane_m)):
        speeds += map(nominal, _forms(motion.walking.speed_mps))
    if "running" in movements:
        speeds += map(nominal, _forms(motion.running.speed_mps))
    return max(speeds)


def _ends(number: Any) -> Iterator[float]:
    """Yield the smallest and the largest value of a number, whatever the activity."""
    for form in _forms(number):
        yield from (0.0, 0.0) if form is None else support(form)


def _forms(number: Any) -> tuple[Any, ...]:
    """Return what a number may be drawn from, by activity."""
    return tuple(number.per_activity.values()) if isinstance(number, PerActivity) else (number,)
