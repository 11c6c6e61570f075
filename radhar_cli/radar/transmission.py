"""One leg through the wall, with the rays and the faces that the wall asks for."""

from typing import NamedTuple

import numpy as np

from radhar_cli.arrays import Float
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
    """A leg through the wall: delay beyond free space (s), field left (1), [I, M] each."""

    delay: Float
    factor: Float


def pass_wall(
    p: Float, antennas: Antennas, wall: Wall, fc: float, delay: Float, amplitude: Float
) -> Float | None:
    """Take paths [I, M] by positions p [3, I, M] (m) through a wall, at a frequency fc (Hz).

    The wall's delay and loss change them in place; not of a wall of layers, for which the cosine
    of the angle at which both legs meet it is returned, nan beside it [2, I, M]; else None.
    """
    if wall.layers is not None:
        return np.stack([_cosine(image, antenna, wall) for image, antenna in antennas.seen(p)])
    for image, antenna in antennas.seen(p):
        through = transmission(image, antenna, wall, fc)
        delay += through.delay
        amplitude *= through.factor
    return None


def _cosine(p: Float, antenna: Point, wall: Wall) -> Float:
    way = p - np.reshape(antenna, (3,) + (1,) * (p.ndim - 1))
    with np.errstate(invalid="ignore"):
        cosine = np.abs(way[0]) / np.sqrt((way * way).sum(axis=0))
    straight = crossing(p, antenna, wall)
    return np.where(both_faces(straight, cosine, wall), cosine, np.nan)


class _Ray(NamedTuple):
    crossed: Crossing
    delay: Float
    tangent: Float | None


def wall_delay(p: Float, antenna: Point, wall: Wall) -> Float:
    """Delay (s) [I, M] beyond free space of the legs from an antenna to positions p [3, I, M]."""
    return _ray(p, antenna, wall).delay


def transmission(p: Float, antenna: Point, wall: Wall, fc: float) -> Transmission:
    """Delay and loss of the legs from an antenna to positions p [3, I, M] at a frequency fc (Hz).

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
