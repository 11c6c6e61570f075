"""Echoes by way of the faces of a room: image sources (docs/guide/scenes.md, Rooms).

A leg from an antenna at a by way of the faces f1, ..., fn to p is as long as the straight one to
the image p' = M_f1 ... M_fn p. Faces lie across the axes: p' = sign p + shift. Seen from p, the leg
starts at the image sign (a - shift) of the antenna.
"""

from collections.abc import Iterator, Sequence
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.radar.fresnel import reflection

Point = tuple[float, float, float]
X, Y, Z = range(3)
# Axis across which each lies.
FACES = {"front": X, "back": X, "right": Y, "left": Y, "floor": Z, "ceiling": Z}


class Box(NamedTuple):
    """Where the faces of a room are, m; the floor is at 0."""

    x: tuple[float, float]
    y: tuple[float, float]
    height: float

    @property
    def at(self) -> dict[str, float]:
        """Where each face cuts the axis across which it lies, m."""
        (front, back), (right, left) = self.x, self.y
        ends = {"front": front, "back": back, "right": right, "left": left}
        return {**ends, "floor": 0.0, "ceiling": self.height}

    def farthest_outside(self, p: Float) -> tuple[float, str]:
        """How far positions p [3, ...] (m) go beyond the walls or the ceiling, m, and where.

        Returns:
            Distance of the farthest, 0 where all are inside; the place in words.
        """
        x, y, z = p
        ends = [
            ("x", float(x.max()), self.x[1], 1),
            ("x", float(x.min()), self.x[0], -1),
            ("y", float(y.max()), self.y[1], 1),
            ("y", float(y.min()), self.y[0], -1),
            ("z", float(z.max()), self.height, 1),
        ]
        outside = [
            (sign * (at - end), f"{axis} = {at:.3g} m, beyond {end:g} m")
            for axis, at, end, sign in ends
        ]
        farthest = max(outside)
        return farthest if farthest[0] > 0 else (0.0, "")


class Face(NamedTuple):
    """A face of the room, endless, across an axis."""

    name: str
    axis: int
    at: float  # where it cuts the axis, m
    eps: complex = 1.0  # relative permittivity
    parallel: bool = True  # whether the antennas' field is parallel to it
    fixed: float | None = None  # field left after a bounce, whatever the angle

    def reflected(self, cosine: Float) -> Float:
        """Field [...] left of 1 after one bounce, the real part of Fresnel's coefficient."""
        if self.fixed is not None:
            return np.full(cosine.shape, self.fixed)
        if self.parallel:
            return reflection(cosine, self.eps, "perpendicular").real
        return -reflection(cosine, self.eps, "parallel").real


class Way(NamedTuple):
    """A leg by way of some faces, in the order in which it meets them from the antenna on."""

    faces: tuple[Face, ...] = ()

    @property
    def name(self) -> str:
        """The faces' names with + between; - of none."""
        return "+".join(face.name for face in self.faces) or "-"

    def image(self, p: Float) -> Float:
        """Where positions p [3, ...] appear to be (m), seen from the antenna."""
        if not self.faces:
            return p
        sign, shift = self._mirror
        return (p.T * sign + shift).T

    def antenna(self, at: Point) -> Point:
        """Where an antenna (m) appears to be, seen from what the leg leads to."""
        if not self.faces:
            return at
        x, y, z = (s * (a - o) for a, s, o in zip(at, *self._mirror, strict=True))
        return (x, y, z)

    def origin(self, antenna: Point) -> Point:
        """Where the antenna is (m) that appears to be there."""
        x, y, z = self.image(np.array(antenna)).tolist()
        return (x, y, z)

    def field(self, image: Float, antenna: Point) -> Float:
        """What is left of the field [...] of legs from an antenna to images [3, ...] (m)."""
        way = image - np.reshape(antenna, (3,) + (1,) * (image.ndim - 1))
        distance = np.maximum(np.sqrt((way * way).sum(axis=0)), np.finfo(float).tiny)
        left: Float = np.ones(distance.shape)
        for face in self.faces:
            left *= face.reflected(np.abs(way[face.axis]) / distance)
        return left

    @property
    def _mirror(self) -> tuple[Float, Float]:
        """Sign and shift [3] of the image."""
        sign, shift = np.ones(3), np.zeros(3)
        for face in reversed(self.faces):  # M_f1 is the last that acts on p
            sign[face.axis] *= -1
            shift[face.axis] = 2 * face.at - shift[face.axis]
        return sign, shift


STRAIGHT = Way()


def ways(faces: Sequence[Face], order: int, before_front: bool) -> Iterator[tuple[Way, Way]]:
    """Ways of the legs of transmitter and receiver with 1 to `order` bounces on both together.

    Two faces across different axes make one image, whichever comes first: the x axis, then y. An
    antenna before the front sees no face but by way of what is behind it.
    """
    legs: list[list[Way]] = [[STRAIGHT]]
    ordered = sorted(faces, key=lambda face: list(FACES).index(face.name))
    for bounces in range(1, order + 1):
        chosen = product(ordered, repeat=bounces)
        legs.append([Way(some) for some in chosen if _is_path(some, before_front)])
    for n_tx, n_rx in product(range(order + 1), repeat=2):
        if 1 <= n_tx + n_rx <= order:
            yield from product(legs[n_tx], legs[n_rx])


def names_of(legs: tuple[Way, Way]) -> str:
    """How a path is called in files: faces of the transmitter's leg/of the receiver's."""
    return "/".join(way.name for way in legs)


def _is_path(faces: tuple[Face, ...], before_front: bool) -> bool:
    if before_front and faces[0].name == "front":
        return False
    return all(one.name != next_.name and one.axis <= next_.axis for one, next_ in pairwise(faces))
