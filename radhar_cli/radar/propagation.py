"""Bistatic delay and amplitude of a path (paper, "Radar Echo Model"; docs/physics/model.md)."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial
from math import cos, pi, sin
from typing import NamedTuple, TypeAlias

import numpy as np

from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.radar.room import DIRECT_LEG, Leg, Point

Remember: TypeAlias = Callable[[object, Callable[[], Float]], Float]


def compute_anew(_: object, compute: Callable[[], Float]) -> Float:
    """Compute a named result, without remembering it."""
    return compute()


class Aim(NamedTuple):
    """Direction of an antenna, and the pattern of its gain."""

    position: Point  # of the array, m
    axes: tuple[Point, ...]  # [3, 3], rows are ahead, left and up of the radar in the scene
    half_power_deg: tuple[float, float]  # half-power half-widths (azimuth, elevation), one way
    least: float = 0.0  # smallest value of the two-way pattern
    of_each: bool = False  # whether angles are seen from each antenna instead of `position`

    def to_radar(self, p: Float) -> Float:
        """Coordinates ahead, left and up [3, ...] (m) of positions p [3, ...] (m) of the scene."""
        return np.tensordot(np.array(self.axes), (p.T - np.array(self.position)).T, axes=1)

    def two_way(self, p: Float) -> Float:
        """Two-way amplitude exp(-ln 2 ((az/az3)^2 + (el/el3)^2)) [...] at p [3, ...] (m)."""
        ahead, left, up = self.to_radar(p)
        azimuth, elevation = np.arctan2(left, ahead), np.arctan2(up, np.hypot(ahead, left))
        az3, el3 = np.radians(self.half_power_deg)
        pattern: Float = np.exp(-np.log(2) * ((azimuth / az3) ** 2 + (elevation / el3) ** 2))
        return np.maximum(pattern, self.least)


def boresight_axes(yaw: float, tilt: float, roll: float = 0.0) -> tuple[Point, ...]:
    """Unit vectors ahead, left and up of a radar that is turned.

    Args:
        yaw: Angle of boresight to the left, rad.
        tilt: Angle of boresight below the horizontal, rad.
        roll: Angle about boresight by which the left side goes up, rad.

    Returns:
        Unit vectors ahead, left and up of the radar in the scene, [3] of [3].
    """
    cy, sy, ct, st = cos(yaw), sin(yaw), cos(tilt), sin(tilt)
    ahead, left, up = (cy * ct, sy * ct, -st), (-sy, cy, 0.0), (cy * st, sy * st, ct)
    if roll == 0:
        return ahead, left, up
    turned = roll_matrix(roll) @ np.array([left, up])
    return ahead, *((float(x), float(y), float(z)) for x, y, z in turned)


def roll_matrix(roll: float) -> Float:
    """Left and up of a radar [2, 2] in those before it rolled, the left side up, by an angle (rad).

    Rows are the turned unit vectors; coordinates before the roll are those after it times it.
    """
    return np.array([[cos(roll), sin(roll)], [-sin(roll), cos(roll)]])


@dataclass(frozen=True)
class Antennas:
    """Transmitter and receiver.

    Attributes:
        tx: Position of the transmitter, m; of its image for an echo by way of a room's faces.
        rx: Position of the receiver, m, likewise.
        gain: Linear gain of each antenna.
        isolation_db: Isolation between the two; used by the static leakage alone.
        aim: Direction and pattern of both; None radiates evenly.
        legs: Legs of transmitter and receiver, direct or by way of faces.
    """

    tx: Point
    rx: Point
    gain: float
    isolation_db: float
    aim: Aim | None = None
    legs: tuple[Leg, Leg] = (DIRECT_LEG, DIRECT_LEG)

    def by_way(self, tx: Leg, rx: Leg) -> "Antennas":
        """Images of these antennas, by way of the faces of a leg for each."""
        return replace(self, tx=tx.antenna(self.tx), rx=rx.antenna(self.rx), legs=(tx, rx))

    @property
    def places(self) -> tuple[Point, Point]:
        """Positions (m) of transmitter and receiver, not of their images."""
        tx, rx = self.legs
        return tx.origin(self.tx), rx.origin(self.rx)

    def images(self, p: Float) -> Iterator[tuple[Float, Point]]:
        """Images [3, ...] (m) of positions p [3, ...] and the antenna that sees them, by leg."""
        for leg, antenna in zip(self.legs, self.places, strict=True):
            yield leg.image(p), antenna

    def field(self, p: Float, remember: Remember = compute_anew) -> Float | None:
        """Two-way field [...] that pattern and bounces leave at p [3, ...] (m); None for 1.

        Args:
            p: Positions.
            remember: Returns what has a name, such as the pattern in the direction of one leg, and
                computes it only where it does not know it of these positions: the channels of an
                array have many legs in common. What it returns is not changed.
        """
        field: Float | None = None
        ends = list(zip(self.legs, self.places, strict=True))
        if self.aim is not None:
            patterns = [self._pattern(p, leg, antenna, remember) for leg, antenna in ends]
            if self.legs[0] == self.legs[1] and not self.aim.of_each:
                field = patterns[0]
            else:
                field = np.sqrt(patterns[0] * patterns[1])
        for leg, antenna in ends:
            if leg.faces:
                bounced = remember(
                    ("bounces", leg, antenna), partial(_field_of_bounces, p, leg, antenna)
                )
                field = bounced if field is None else field * bounced
        return field

    def _pattern(self, p: Float, leg: Leg, antenna: Point, remember: Remember) -> Float:
        """Two-way pattern [...] of one antenna in the direction of its leg to p [3, ...] (m)."""
        assert self.aim is not None
        aim = self.aim._replace(position=antenna) if self.aim.of_each else self.aim
        return remember(("pattern", leg, aim.position), lambda: aim.two_way(leg.image(p)))


def _field_of_bounces(p: Float, leg: Leg, antenna: Point) -> Float:
    """Field [...] after the bounces of a leg from an antenna to positions p [3, ...] (m)."""
    return leg.field(leg.image(p), antenna)


def leg(p: Float, antenna: Point) -> Float:
    """Distance [I, M] (m) between positions p [3, I, M] (m) and an antenna."""
    x, y, z = p[0] - antenna[0], p[1] - antenna[1], p[2] - antenna[2]
    x *= x
    y *= y
    z *= z
    x += y
    x += z
    distance: Float = np.sqrt(x, out=x)
    return distance


def bistatic_delay(r_tx: Float, r_rx: Float) -> Float:
    """Bistatic delay tau = (R_tx + R_rx)/c (s) of legs (m)."""
    return (r_tx + r_rx) / SPEED_OF_LIGHT


def amplitude(r_tx: Float, r_rx: Float, sigma: Float, gain: float, wavelength: float) -> Float:
    """Amplitude A = sqrt(G_tx G_rx lambda^2 sigma/(4 pi)^3)/(R_tx R_rx) for unit transmit power.

    Args:
        r_tx: Legs of the transmitter [I, M], m.
        r_rx: Legs of the receiver [I, M], m.
        sigma: Cross sections [I, M] or [I, 1], m^2.
        gain: Linear gain of each antenna.
        wavelength: Wavelength lambda of the carrier, m.

    Returns:
        A [I, M].
    """
    scale = gain * wavelength / (4 * pi) ** 1.5 * np.sqrt(sigma)
    a: Float = scale / (r_tx * r_rx)
    return a
