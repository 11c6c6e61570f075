"""Echoes of a room's faces themselves: the radar sees its own image in each (image sources).

Of an endless face at distance d, as long as the wave is mirrored, a receiver beside the transmitter
has P_r = P_t G^2 lambda^2 |r|^2/((4 pi)^2 (2 d)^2): Friis' equation over the way to the image
(C. A. Balanis, Antenna Theory, 2.17; J. B. Allen and D. A. Berkley, "Image method for efficiently
simulating small-room acoustics", 1979).
"""

from collections.abc import Iterable
from dataclasses import dataclass
from math import dist, inf, pi
from typing import ClassVar

import numpy as np

from radhar_cli.echo.paths import Paths, Through
from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.room import Face, Leg, Point
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.wall_rays import pass_wall_on_legs

# A face nearer than this to the middle of the antennas is what they are mounted on, m.
MOUNT_M = 0.05


@dataclass(frozen=True)
class StillPaths:
    """Paths that do not move, as a `PathSource`.

    Attributes:
        paths: Paths at one time [I, 1].
    """

    paths: Paths

    breakpoints: ClassVar[tuple[float, ...]] = ()
    highest_frequency: ClassVar[float] = 0.0
    smooth: ClassVar[bool] = True

    def __call__(self, t: Float) -> Paths:
        """Return the paths at times t [M] (s), the same at all of them."""
        return self.paths.at_times(np.zeros(t.size, np.intp))


def echoes_of_faces(
    antennas: Antennas, ways: Iterable[Leg], wall: Wall | None, fc: float, latest: float = inf
) -> StillPaths:
    """Make the paths from transmitter to receiver by way of a room's faces alone.

    A path is as long as the straight one from the transmitter to the image of the receiver. Its
    amplitude is G lambda/(4 pi R) times the coefficients of the bounces and the pattern of both
    antennas. A wall between acts on its first and its last stretch.

    Args:
        antennas: Transmitter and receiver, not their images.
        ways: Faces of each path, in the order in which it meets them. Paths by a face that is
            within MOUNT_M of the middle of the antennas are left out: they are mounted on it.
        wall: Wall that the paths cross, or None.
        fc: Carrier, Hz.
        latest: Delay (s) from which on a receiver filters echoes out.
    """
    middle = tuple((a + b) / 2 for a, b in zip(antennas.tx, antennas.rx, strict=True))
    reflecting = [way for way in ways if not any(_is_mount(face, middle) for face in way.faces)]
    every = [_echo(antennas, way, wall, fc) for way in reflecting]
    parts = [paths for paths in every if paths.delay.item() < latest]
    if not parts:
        return StillPaths(Paths(np.empty((0, 1)), np.empty((0, 1))))
    delay, amplitude, through = zip(*parts, strict=True)
    paths = Paths(np.concatenate(delay), np.concatenate(amplitude), Through.joined(through))
    return StillPaths(paths)


def _is_mount(face: Face, middle: tuple[float, ...]) -> bool:
    return abs(middle[face.axis] - face.offset) < MOUNT_M


def _echo(antennas: Antennas, leg: Leg, wall: Wall | None, fc: float) -> Paths:
    """Return the path [1, 1] of a leg by faces, met in its order by the transmitter's wave."""
    back = Leg(leg.faces[::-1])
    image_of_rx, image_of_tx = _image(leg, antennas.rx), _image(back, antennas.tx)
    distance = dist(antennas.tx, image_of_rx.ravel().tolist())
    a = antennas.gain * SPEED_OF_LIGHT / fc / (4 * pi * distance)
    amplitude = a * leg.field(image_of_rx, antennas.tx)
    if antennas.aim is not None:
        aims = antennas.aim, antennas.aim
        if antennas.aim.of_each:
            aims = aims[0]._replace(position=antennas.tx), aims[1]._replace(position=antennas.rx)
        amplitude *= np.sqrt(aims[0].two_way(image_of_rx) * aims[1].two_way(image_of_tx))
    delay = np.full((1, 1), distance / SPEED_OF_LIGHT)
    if wall is None:
        return Paths(delay, amplitude)
    ends = (image_of_rx, antennas.tx), (image_of_tx, antennas.rx)
    cosine = pass_wall_on_legs(ends, wall, fc, delay, amplitude)
    return Paths(delay, amplitude, Through.of(wall.layers, cosine))


def _image(leg: Leg, antenna: Point) -> Float:
    """Image [3, 1, 1] (m) of an antenna by way of faces."""
    return leg.image(np.reshape(antenna, (3, 1, 1)))
