"""Bistatic delay and amplitude of a path (paper, "Radar Echo Model"; docs/physics/model.md)."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from math import cos, pi, sin
from typing import NamedTuple

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.radar.room import STRAIGHT, Point, Way
from radhar_cli.radar.waveform import SPEED_OF_LIGHT


class Aim(NamedTuple):
    """Where an antenna looks, and how its gain falls off to the sides."""

    position: Point  # of the array, m
    axes: tuple[Point, ...]  # [3, 3], rows are ahead, left and up of the radar in the scene
    half_power_deg: tuple[float, float]  # half-power half-widths (azimuth, elevation), one way
    least: float = 0.0  # the pattern is nowhere below it
    of_each: bool = False  # seen from each antenna, and not from `position`

    def to_radar(self, p: Float) -> Float:
        """Places p [3, ...] of the scene as the radar has them: ahead, left, up, m."""
        return np.tensordot(np.array(self.axes), (p.T - np.array(self.position)).T, axes=1)

    def two_way(self, p: Float) -> Float:
        """Two-way amplitude pattern exp(-ln 2 ((az/az3)^2 + (el/el3)^2)) [...] at p [3, ...]."""
        ahead, left, up = self.to_radar(p)
        azimuth, elevation = np.arctan2(left, ahead), np.arctan2(up, np.hypot(ahead, left))
        az3, el3 = np.radians(self.half_power_deg)
        pattern: Float = np.exp(-np.log(2) * ((azimuth / az3) ** 2 + (elevation / el3) ** 2))
        return np.maximum(pattern, self.least)


def boresight_axes(yaw: float, tilt: float) -> tuple[Point, ...]:
    """Rows ahead, left, up of a radar turned by yaw to the left and tilt down (rad)."""
    cy, sy, ct, st = cos(yaw), sin(yaw), cos(tilt), sin(tilt)
    return (cy * ct, sy * ct, -st), (-sy, cy, 0.0), (cy * st, sy * st, ct)


@dataclass(frozen=True)
class Antennas:
    """Transmitter and receiver."""

    # tx, rx: positions (x, y, z), m; of an echo by way of a room's faces, of the images
    tx: Point
    rx: Point
    gain: float  # linear gain of each antenna
    isolation_db: float  # between the two; used by the static leakage alone
    aim: Aim | None = None  # where both look, with their pattern; None radiates evenly
    ways: tuple[Way, Way] = (STRAIGHT, STRAIGHT)  # of the legs of both, by way of faces or straight

    def by_way(self, tx: Way, rx: Way) -> "Antennas":
        """As their images by way of faces: what these see is seen by way of those."""
        return replace(self, tx=tx.antenna(self.tx), rx=rx.antenna(self.rx), ways=(tx, rx))

    @property
    def places(self) -> tuple[Point, Point]:
        """Where transmitter and receiver are, and not their images, m."""
        tx, rx = self.ways
        return tx.origin(self.tx), rx.origin(self.rx)

    def seen(self, p: Float) -> Iterator[tuple[Float, Point]]:
        """For both legs, where positions p [3, ...] appear to the antenna, and that, m."""
        for way, antenna in zip(self.ways, self.places, strict=True):
            yield way.image(p), antenna

    def field(self, p: Float) -> Float | None:
        """Two-way field [...] that pattern and bounces leave at p [3, ...]; None of all of it."""
        left, seen = None, tuple(self.seen(p))
        if self.aim is not None:
            (p_tx, tx), (p_rx, rx) = seen
            if self.aim.of_each:
                aims = self.aim._replace(position=tx), self.aim._replace(position=rx)
                left = np.sqrt(aims[0].two_way(p_tx) * aims[1].two_way(p_rx))
            elif self.ways[0] == self.ways[1]:
                left = self.aim.two_way(p_tx)
            else:
                left = np.sqrt(self.aim.two_way(p_tx) * self.aim.two_way(p_rx))
        for way, (image, antenna) in zip(self.ways, seen, strict=True):
            if way.faces:
                bounced = way.field(image, antenna)
                left = bounced if left is None else left * bounced
        return left


def leg(p: Float, antenna: Point) -> Float:
    """Distance (m) [I, M] between positions p [3, I, M] and an antenna."""
    x, y, z = p[0] - antenna[0], p[1] - antenna[1], p[2] - antenna[2]
    x *= x
    y *= y
    z *= z
    x += y
    x += z
    distance: Float = np.sqrt(x, out=x)
    return distance


def bistatic_delay(r_tx: Float, r_rx: Float) -> Float:
    """tau = (R_tx + R_rx)/c in s."""
    return (r_tx + r_rx) / SPEED_OF_LIGHT


def amplitude(r_tx: Float, r_rx: Float, sigma: Float, gain: float, wavelength: float) -> Float:
    """A = sqrt(G_tx G_rx lambda^2 sigma/(4 pi)^3)/(R_tx R_rx) [I, M] for unit transmit power.

    Legs [I, M] and the wavelength in m, sigma [I, M] or [I, 1] in m^2; gain of each antenna.
    """
    scale = gain * wavelength / (4 * pi) ** 1.5 * np.sqrt(sigma)
    a: Float = scale / (r_tx * r_rx)
    return a
