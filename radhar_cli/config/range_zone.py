"""Ranges at which a config places people: the range axis that images have by default."""

from collections.abc import Iterable, Iterator
from contextlib import suppress
from itertools import product
from math import ceil, cos, hypot, pi, radians
from typing import TYPE_CHECKING, Any

from radhar_cli.motion.activities.activity import Activity
from radhar_cli.schema.annotations import People, at, of_kind
from radhar_cli.schema.number import nominal, support
from radhar_cli.schema.section import for_activity

if TYPE_CHECKING:
    from radhar_cli.config.first_level import Request

AXES = ("range_m", "cross_range_m")
REACH_M = 1.0  # of a limb, and of what a person drifts and falls, beyond the feet


def range_zone(request: "Request") -> tuple[float, float]:
    """Ranges in which people can be: from 0 to the whole metre beyond the farthest of them.

    It follows from what the config may draw, not from what a sample has drawn: an axis that
    followed a sample would tell where its person is, and so maybe what it does. Walkers go as
    far as the usual speed takes them within the recording; the few faster ones leave the image.
    """
    if request.stream is not None:
        zone = request.stream.zone
        if request.radar_name is not None:
            corners = [*product(zone.range_m, zone.cross_range_m)]
            return 0.0, float(ceil(_farthest_corner(request, corners) + REACH_M))
        reach = hypot(max(map(abs, zone.range_m)), max(map(abs, zone.cross_range_m)))
        return 0.0, float(ceil(reach + REACH_M))
    ranges = [_farthest(request, activity) for activity in request.chosen_activities]
    for number in range(1, len(request.people) + 1):
        person = request.of_person(number)
        with suppress(ValueError):  # of an unknown activity, which is told elsewhere
            ranges += [_farthest(person, activity) for activity in request.activities_of(number)]
    return 0.0, float(ceil(max(ranges, default=0.0) + REACH_M))


def _farthest(request: "Request", activity: Activity) -> float:
    """Range of the farthest place that a person reaches by one activity, m."""
    motion, ahead = request.motion, max(-_nearest_antenna(request), 0.0)
    starts = for_activity(motion.range_m, activity) is not None
    holder: Any = motion if starts else motion.place
    if request.radar_name is not None:  # one of several, which may look along any direction
        places = [for_activity(getattr(holder, key), activity) for key in AXES]
        x, y = ((0.0, 0.0) if one is None else support(one) for one in places)
        corners = [*product(x, y)]
        return _farthest_corner(request, corners) + _way(request, activity)
    along = max(_ends(for_activity(holder.range_m, activity)))
    across = max(_ends(for_activity(holder.cross_range_m, activity)))
    away = _share_away(request, activity) if starts else 1.0
    return hypot(along + ahead, across) + away * _way(request, activity)


def _farthest_corner(request: "Request", corners: Iterable[tuple[float, float]]) -> float:
    """Largest distance (m) of places on the ground from the places where antennas may be."""
    radar = request.radar
    return max(
        hypot(x - a, y - b)
        for x, y in corners
        for key in radar.place_keys
        for a, b in product(*map(support, getattr(radar, key)[:2]))
    )


def _nearest_antenna(request: "Request") -> float:
    """Least range of an antenna of the radar, m."""
    radar = request.radar
    return min(support(getattr(radar, key)[0])[0] for key in radar.place_keys)


def _ends(number: Any) -> Iterator[float]:
    """Yield the magnitudes of the smallest and the largest value of a number; 0 for null."""
    yield from (0.0, 0.0) if number is None else map(abs, support(number))


def _share_away(request: "Request", activity: Activity) -> float:
    """Largest share of a way that leads away from the radar, by what headings may be drawn."""
    low, high = map(radians, support(for_activity(request.motion.angle_deg, activity)))
    turns = ceil(low / (2 * pi)) * 2 * pi  # the first heading of 0 that is not below `low`
    return 1.0 if turns <= high else max(cos(low), cos(high), 0.0)


def _way(request: "Request", activity: Activity) -> float:
    """Way that people go within a recording at their usual speed, at most their lane, m."""
    seconds = support(request.duration_s)[1]
    speeds = [
        nominal(for_activity(at(request, key), activity))
        for key, _ in of_kind(type(request), People)
        if key.startswith("motion.") and key.endswith(".speed_mps")
        if request.depends_on(activity, key)
    ]
    distance = max(speeds, default=0.0) * seconds
    lane = support(for_activity(request.motion.walking.lane_m, activity))
    return distance if lane[0] == 0 else min(distance, lane[1])
