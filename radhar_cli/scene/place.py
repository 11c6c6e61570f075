"""Start of a person, so that they are where `motion.place` says at one instant.

A person who stays in place is there. A course is laid through the place at one of the instants at
which all of it stays within the zone that radar, wall and room leave. It is chosen among those, not
by trying again: whether a scene is possible would depend on what people do, and where they are
would tell it. As `motion.place.instant` is drawn, far places are at the far ends of courses: ranges
at any instant then vary about as much as places do, for any walk.
"""

from dataclasses import dataclass
from math import ceil, inf, sqrt

import numpy as np

from radhar_cli.motion.protocol import Motion
from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.propagation import Antennas
from radhar_cli.scene.radar import antennas_of, waveform_of
from radhar_cli.scene.room import wall_of
from radhar_cli.scene.scene import Person, Scene

INSTANTS = 25  # at which people may be at their place
COURSE_HZ = 4.0  # instants of a course that are looked at, in a second; INSTANTS at least
NEAREST_M = 1.0  # of a torso and an antenna, along the boresight
MARGIN_M = 0.15  # of a body and what it must not meet, and of an echo and the end of the range
LOOKS_AHEAD = 0.5  # least horizontal share of the boresight of a radar that has a behind


@dataclass(frozen=True)
class Zone:
    """Region in which a body may be, as radar, wall and room leave it.

    Attributes:
        antennas: antennas of the radar.
        looks_at: place before antennas without a pattern [2], m; None for antennas that look along
            x.
        farthest: distance from the antennas, m, on average of the two.
        x: least and largest range, m.
        y: least and largest cross-range, m.
    """

    antennas: Antennas
    looks_at: tuple[float, float] | None
    farthest: float
    x: tuple[float, float]
    y: tuple[float, float]

    def miss(self, joints: Float, torso: Float, starts: Float) -> Float:
        """Compute the largest distance of bodies out of the zone [K], m; 0 or less inside.

        Args:
            joints: joints of a body that starts at the origin [2, I, M], m.
            torso: its torso [2, M], m.
            starts: places from where it starts instead [2, K], m.
        """
        misses = list[Float]()
        for start, along, (low, high) in zip(starts, joints, (self.x, self.y), strict=True):
            misses += [low - start - along.min(), start + along.max() - high]
        body = starts[..., None] + torso[:, None]  # [2, K, M]
        reach = np.hypot(*(joints - torso[:, None])).max()
        distances = [np.hypot(body[0] - x, body[1] - y) for x, y, _ in self.antennas.places]
        misses.append(np.mean(distances, axis=0).max(axis=-1) + reach - self.farthest)
        ahead = distance_ahead(body, self.antennas, self.looks_at)
        misses.append(NEAREST_M - ahead.min(axis=-1))
        worst: Float = np.max(misses, axis=0)
        return worst


def zone_of(scene: Scene, place: tuple[float, float]) -> Zone:
    """Zone that the radar of a scene leaves for people, behind its wall and within its room.

    Args:
        place: place of a person (m), before which each of several radars is.
    """
    wall, box, x, y = wall_of(scene), scene.room.make_box(), (-inf, inf), (-inf, inf)
    farthest = waveform_of(scene).half_band_range - MARGIN_M
    if wall is not None:
        depth = wall.size[0]
        farthest -= depth * sqrt(wall.eps_r)  # waves take longer inside
        x = (wall.center[0] + depth / 2 + MARGIN_M, inf)
    if scene.room.back_wall_m is not None:
        x = x[0], scene.room.back_wall_m - MARGIN_M
    if box is not None:
        x = max(x[0], box.x[0] + MARGIN_M), box.x[1] - MARGIN_M
        y = box.y[0] + MARGIN_M, box.y[1] - MARGIN_M
    looks_at = place if scene.config.other_radars else None
    return Zone(antennas_of(scene), looks_at, farthest, x, y)


def distance_ahead(
    torso: Float, antennas: Antennas, looks_at: tuple[float, float] | None = None
) -> Float:
    """Compute the distance of a torso [2 or 3, ...] before the hindmost antenna [...], m.

    It is infinite where a radar looks down. Antennas without a pattern look along x.

    Args:
        torso: the torso, m.
        looks_at: place on the ground (m) that antennas without a pattern look at instead.
    """
    forward = np.array((1.0, 0.0))
    if antennas.aim is not None:
        forward = np.array(antennas.aim.axes[0])[:2]
    elif looks_at is not None:
        forward = np.array(looks_at) - np.mean(antennas.places, axis=0)[:2]
        forward = forward / max(float(np.hypot(*forward)), 1e-9)
    if np.hypot(*forward) < LOOKS_AHEAD:
        return np.full(torso.shape[1:], inf)
    hindmost = min(forward @ np.array(place)[:2] for place in antennas.places)
    ahead: Float = np.tensordot(forward, torso[:2], 1) - hindmost
    return ahead


def start_of(person: Person, motion: Motion) -> tuple[float, float]:
    """Range and cross-range (m) at which a person starts.

    Args:
        motion: their motion, if they start at the origin.
    """
    x, y = person.place
    starts = person.motion.range_m is not None
    if person.activity.stays_in_place or (starts and getattr(motion, "begin", 0.0) >= 0):
        return x, y
    if starts:
        ahead, left = motion.torso(np.zeros(1))[:2, 0, 0]
        return x - ahead, y - left
    count = 1 + (INSTANTS - 1) * max(1, ceil(COURSE_HZ * person.seconds / INSTANTS))
    joints = motion.positions(np.linspace(0.0, person.seconds, count))[:2]
    torso = joints[:, motion.names.index("torso")]
    starts_of_instants = np.array([[x], [y]]) - torso[:, :: (count - 1) // (INSTANTS - 1)]
    if person.motion.cross_range_m is not None:
        starts_of_instants[1] = y
    zones = [zone_of(scene, (x, y)) for scene in person.scene.of_each_radar]
    miss = np.max([zone.miss(joints, torso, starts_of_instants) for zone in zones], axis=0)
    by_range = np.argsort(-starts_of_instants[0], kind="stable")  # the nearest instant first
    possible = np.flatnonzero((miss <= max(0.0, miss.min()))[by_range])
    wanted_rank = person.motion.place.instant * (INSTANTS - 1)
    chosen = by_range[possible[np.abs(possible - wanted_rank).argmin()]]
    ahead, left = starts_of_instants[:, chosen]
    return float(ahead), float(left)
