"""One leg through the wall, with the rays and the faces that the wall asks for."""

from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.fresnel import faces_factor
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.refraction import refract
from radhar_cli.radar.room import Point
from radhar_cli.radar.wall import (
    Crossing,
    Wall,
    absorption,
    both_faces,
    crossing,
    extra_delay,
    field_factor,
    plane_wave,
)


class Transmission(NamedTuple):
    """Delay and loss of legs through the wall."""

    delay: Float  # delay beyond free space [I, M], s
    factor: Float  # field behind the wall over that without it [I, M]


def pass_wall(
    p: Float, antennas: Antennas, wall: Wall, fc: float, delay: Float, amplitude: Float
) -> Float | None:
    """Take paths through a wall, whose delay and loss change them in place.

    A wall of layers, which acts on each frequency in its own way, changes nothing here.

    Args:
        p: Positions [3, I, M] of the scatterers, m.
        antennas: Transmitter and receiver.
        fc: Frequency of the loss, Hz.
        delay: Delays [I, M], s, which are changed.
        amplitude: Amplitudes [I, M], which are changed.

    Returns:
        For a wall of layers cosines [2, I, M] of the angles at which both legs meet it, NaN for
        legs beside it; else None.
    """
    return pass_wall_on_legs(antennas.images(p), wall, fc, delay, amplitude)


def pass_wall_on_legs(
    legs: Iterable[tuple[Float, Point]], wall: Wall, fc: float, delay: Float, amplitude: Float
) -> Float | None:
    """Take paths through a wall by their legs, as `pass_wall` does.

    Args:
        legs: Both legs: where each ends [3, I, M] (m), as if no face turned it, and its antenna.
        fc: Frequency of the loss, Hz.
        delay: Delays [I, M], s, which are changed.
        amplitude: Amplitudes [I, M], which are changed.
    """
    if wall.layers is not None:
        return np.stack([_cosine(image, antenna, wall) for image, antenna in legs])
    for image, antenna in legs:
        through = transmission(image, antenna, wall, fc)
        delay += through.delay
        amplitude *= through.factor
    return None


def _cosine(p: Float, antenna: Point, wall: Wall) -> Float:
    """Cosines [I, M] of the angle at which legs meet the wall; NaN beside it."""
    ray = p - np.reshape(antenna, (3,) + (1,) * (p.ndim - 1))
    with np.errstate(invalid="ignore"):
        cosine = np.abs(ray[0]) / np.sqrt((ray * ray).sum(axis=0))
    straight = crossing(p, antenna, wall)
    return np.where(both_faces(straight, cosine, wall), cosine, np.nan)


class _Ray(NamedTuple):
    """Rays through the wall, in the order of `RefractedRays`; no tangent of straight ones."""

    crossed: Crossing
    delay: Float
    tangent: Float | None


def wall_delay(p: Float, antenna: Point, wall: Wall) -> Float:
    """Delay [I, M] (s) beyond free space of legs from an antenna to positions p [3, I, M] (m)."""
    return _ray(p, antenna, wall).delay


def transmission(p: Float, antenna: Point, wall: Wall, fc: float) -> Transmission:
    """Delay and loss of legs from an antenna to positions p [3, I, M] (m) at a frequency fc (Hz).

    The loss is that of the chord and of the faces; spreading is left to the straight distance.
    """
    crossed, delay, tangent = _ray(p, antenna, wall)
    if wall.fresnel == "normal":
        return Transmission(delay, field_factor(crossed, wall, fc))
    faces = faces_factor(p, antenna, wall, crossed, tangent)
    return Transmission(delay, absorption(crossed.chord, wall, fc) * faces)


def _ray(p: Float, antenna: Point, wall: Wall) -> _Ray:
    straight = crossing(p, antenna, wall)
    if wall.rays == "straight":
        return _Ray(straight, extra_delay(straight.chord, wall), None)
    if wall.rays == "plane":
        chord, delay = plane_wave(p, antenna, wall, straight)
        return _Ray(straight._replace(chord=chord), delay, None)
    bent = refract(p, antenna, wall, straight)
    return _Ray(bent.crossed, bent.delay, bent.tangent)
