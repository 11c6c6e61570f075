"""Wall, faces and reflectors of a scene, as its radar sees them."""

import numpy as np

from radhar_cli.motion.reflectors import Reflectors
from radhar_cli.radar.room import Leg, names_of
from radhar_cli.radar.wall import Wall
from radhar_cli.scene.radar import antennas_of
from radhar_cli.scene.scene import Scene


def wall_of(scene: Scene) -> Wall | None:
    """Make the wall of a scene, or None where it has none."""
    return None if scene.wall is None else scene.wall.make_wall(*_band_of(scene))


def ways_of(scene: Scene) -> list[tuple[Leg, Leg]]:
    """Find the ways of the transmitter's and the receiver's leg by faces, or by a back wall."""
    return scene.room.find_ways(_nearest_antenna(scene), *_band_of(scene))


def echo_ways_of(scene: Scene) -> list[Leg]:
    """Find the ways from transmitter to receiver by faces of the room alone, at most `order`."""
    ways = [tx for tx, rx in ways_of(scene) if not rx.faces]
    box = scene.room.make_box()
    if box is None or _nearest_antenna(scene) >= box.x[0]:
        return ways
    return [way for way in ways if way.faces[-1].name != "front"]  # behind which the radar is


def names_of_ways(scene: Scene) -> list[str]:
    """Names of the ways by which people are seen, as "floor/-", the straight one, "-/-", first."""
    return ["-/-", *map(names_of, ways_of(scene))]


def reflectors_of(scene: Scene) -> Reflectors | None:
    """Make the reflectors that stand in the room of a scene; None where there are none."""
    if not scene.room.reflectors:
        return None
    antennas, rng = antennas_of(scene), scene.surroundings_stream("room.reflectors")
    return scene.room.make_reflectors((np.array(antennas.tx) + np.array(antennas.rx)) / 2, rng)


def _band_of(scene: Scene) -> tuple[float, str]:
    """Middle of the band of a scene's radar (Hz), and its polarisation."""
    radar = scene.radar
    return radar.carrier_hz + radar.bandwidth_hz / 2, radar.polarisation


def _nearest_antenna(scene: Scene) -> float:
    """Least x of the antennas of a scene, m."""
    return min(x for x, _, _ in antennas_of(scene).places)
