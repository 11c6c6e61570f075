"""Echoes by way of the faces of a room: image sources (docs/guide/scenes.md, Rooms).

A leg from an antenna at a by way of the faces f1, ..., fn to p is as long as the straight one to
the image p' = M_f1 ... M_fn p. Faces lie across the axes: p' = sign p + shift. Seen from p, the leg
starts at the image sign (a - shift) of the antenna.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np

from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.fresnel import reflection

Point = tuple[float, float, float]
X, Y, Z = range(3)
# Axis across which each lies.
FACES = {"front": X, "back": X, "right": Y, "left": Y, "floor": Z, "ceiling": Z}


class Box(NamedTuple):
    """Positions of the faces of a room, m; the floor is at 0."""

    x: tuple[float, float]
    y: tuple[float, float]
    height: float

    @property
    def face_offsets(self) -> dict[str, float]:
        """Coordinate (m) at which each face cuts the axis across which it lies."""
        (front, back), (right, left) = self.x, self.y
        ends = {"front": front, "back": back, "right": right, "left": left}
        return {**ends, "floor": 0.0, "ceiling": self.height}

    def farthest_outside(self, p: Float) -> tuple[float, str]:
        """Distance by which positions leave the room through the walls or the ceiling.

        Args:
            p: Positions [3, ...], m.

        Returns:
            Distance (m) of the farthest, 0 where all are inside; its coordinate in words.
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
            (sign * (reached - end), f"{axis} = {reached:.3g} m, beyond {end:g} m")
            for axis, reached, end, sign in ends
        ]
        farthest = max(outside)
        return farthest if farthest[0] > 0 else (0.0, "")


class Face(NamedTuple):
    """A face of the room, endless, across an axis."""

    name: str
    axis: int
    offset: float  # coordinate at which it cuts the axis, m
    eps: complex = 1.0  # relative permittivity
    parallel: bool = True  # whether the antennas' field is parallel to it
    constant_reflection: float | None = None  # coefficient of a bounce, whatever the angle

    def reflection_coefficient(self, cosine: Float) -> Float:
        """Field [...] after one bounce of 1, the real part of Fresnel's coefficient.

        Args:
            cosine: Cosines [...] of the angle of incidence.
        """
        if self.constant_reflection is not None:
            return np.full(cosine.shape, self.constant_reflection)
        if self.parallel:
            return reflection(cosine, self.eps, "perpendicular").real
        return -reflection(cosine, self.eps, "parallel").real


class Leg(NamedTuple):
    """A leg by way of some faces, in the order in which it meets them from the antenna on."""

    faces: tuple[Face, ...] = ()

    @property
    def name(self) -> str:
        """Names of the faces with + between; - without any."""
        return "+".join(face.name for face in self.faces) or "-"

    def image(self, p: Float) -> Float:
        """Images [3, ...] (m) of positions p [3, ...], where the antenna sees them."""
        if not self.faces:
            return p
        sign, shift = self._mirror
        return (p.T * sign + shift).T

    def antenna(self, position: Point) -> Point:
        """Image (m) of an antenna at a position (m), seen from the end of the leg."""
        if not self.faces:
            return position
        x, y, z = (s * (a - o) for a, s, o in zip(position, *self._mirror, strict=True))
        return (x, y, z)

    def origin(self, antenna: Point) -> Point:
        """Position (m) of the antenna whose image this is."""
        x, y, z = self.image(np.array(antenna)).tolist()
        return (x, y, z)

    def field(self, image: Float, antenna: Point) -> Float:
        """Field [...] after the bounces of legs from an antenna to images [3, ...] (m)."""
        ray = image - np.reshape(antenna, (3,) + (1,) * (image.ndim - 1))
        distance = np.maximum(np.sqrt((ray * ray).sum(axis=0)), np.finfo(float).tiny)
        field: Float = np.ones(distance.shape)
        for face in self.faces:
            field *= face.reflection_coefficient(np.abs(ray[face.axis]) / distance)
        return field

    @property
    def _mirror(self) -> tuple[Float, Float]:
        """Sign and shift [3] (m) of the image."""
        sign, shift = np.ones(3), np.zeros(3)
        for face in reversed(self.faces):  # M_f1 is the last that acts on p
            sign[face.axis] *= -1
            shift[face.axis] = 2 * face.offset - shift[face.axis]
        return sign, shift


DIRECT_LEG = Leg()


def reflected_legs(
    faces: Sequence[Face], max_bounces: int, in_front_of_room: bool
) -> Iterator[tuple[Leg, Leg]]:
    """Pairs of legs of transmitter and receiver that bounce at least once.

    Two faces across different axes make one image, whichever comes first: the x axis, then y.

    Args:
        faces: Faces of the room that reflect.
        max_bounces: Largest number of bounces of both legs together.
        in_front_of_room: Whether the antennas stand before the front, which they see by way of
            another face alone.
    """
    legs: list[list[Leg]] = [[DIRECT_LEG]]
    ordered = sorted(faces, key=lambda face: list(FACES).index(face.name))
    for bounces in range(1, max_bounces + 1):
        chosen = product(ordered, repeat=bounces)
        legs.append([Leg(path) for path in chosen if _is_path(path, in_front_of_room)])
    for n_tx, n_rx in product(range(max_bounces + 1), repeat=2):
        if 1 <= n_tx + n_rx <= max_bounces:
            yield from product(legs[n_tx], legs[n_rx])


def names_of(legs: tuple[Leg, Leg]) -> str:
    """Name of a path in files: faces of the transmitter's leg/of the receiver's."""
    return "/".join(leg.name for leg in legs)


def _is_path(faces: tuple[Face, ...], in_front_of_room: bool) -> bool:
    """Whether a leg may meet these faces in this order, each image counted once."""
    if in_front_of_room and faces[0].name == "front":
        return False
    return all(
        face.name != next_.name and face.axis <= next_.axis for face, next_ in pairwise(faces)
    )


@dataclass(frozen=True)
class RoomBox:
    """Box in the axes of the room, from the floor point below a board.

    Attributes:
        ahead_m: Limits along the x axis of scenes, m.
        left_m: Limits along the y axis, m.
        up_m: Limits of heights above the floor, m.
    """

    ahead_m: tuple[float, float]
    left_m: tuple[float, float]
    up_m: tuple[float, float]
