"""A body as a board at 77 GHz sees it: scatterers on the surfaces of its parts that face the radar.

Every segment has n points, uniform along it and within +-SPREAD of the side that faces the array,
at DEPTH of its radius. A point's field goes with cos^1.9 of the angle between its normal and the
line of sight and with sin^0.9 of that between segment and sight, times a circular Gaussian number
of its own: as limbs turn, points slide over their surfaces and the echo speckles. The facing cross
sections were fitted to measured clouds (docs/guide/boards.md).
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property, partial
from math import pi
from typing import NamedTuple

import numpy as np

from radhar_cli.echo.bodies.motion_paths import OfMotion
from radhar_cli.echo.bodies.segment_paths import Body
from radhar_cli.echo.paths import Paths, Through
from radhar_cli.motion.protocol import Motion, cached_result
from radhar_cli.motion.segments import REFERENCE_STATURE, cross, soft_unit, unit
from radhar_cli.numerics.arrays import Bool, Complex, Float, Index
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.radar.propagation import Antennas, amplitude, bistatic_delay, leg
from radhar_cli.radar.room import Point
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.wall_rays import pass_wall

SPREAD = np.radians(59.0)
DEPTH = 0.86
NORMAL_POWER, ALONG_POWER = 1.9, 0.9
# Of a segment that faces the radar, dBsm, by the last word of its name.
FACING_DBSM = {
    "trunk": -4.0,
    "head": -20.7,
    "arm": -17.7,
    "forearm": -21.5,
    "hand": -26.7,
    "thigh": -24.3,
    "shank": -31.7,
    "foot": -35.7,
}
TREMOR_MPS, COMMON_MPS = 0.012, 0.010  # rms speed of a segment, and of the body, beside its motion
TREMOR_HZ = (2.0, 8.0)
TONES = 4


class SurfacePoints(NamedTuple):
    """Drawn numbers of a body's points and of its tremor.

    Attributes:
        segment: number of the segment of each point [I].
        along: place of the point along it [I], 0 at its start, 1 at its end.
        around: angle from the side that faces the radar [I], rad.
        weight: circular Gaussian factor of the field [I].
        rate: rates of the tones of the tremor [S + 1, TONES], Hz; the last row is the body's.
        phase: phases of the tones [S + 1, TONES], cycles.
    """

    segment: np.ndarray[tuple[int], np.dtype[np.intp]]
    along: Float
    around: Float
    weight: Complex
    rate: Float
    phase: Float


def draw_surface(segments: int, points: int, rng: np.random.Generator) -> SurfacePoints:
    """Draw points of each segment, spread evenly along it, and the tones of the tremor.

    Args:
        segments: number of segments.
        points: number of points of each.
        rng: random numbers.
    """
    shape = (segments, points)
    weight = rng.standard_normal((2, *shape)) * np.sqrt(0.5)
    along = (np.arange(points) + rng.random(shape)) / points
    around = rng.uniform(-SPREAD, SPREAD, shape)
    rate = rng.uniform(*TREMOR_HZ, (segments + 1, TONES))
    return SurfacePoints(
        np.repeat(np.arange(segments), points),
        along.ravel(),
        around.ravel(),
        (weight[0] + 1j * weight[1]).ravel(),
        rate,
        rng.random((segments + 1, TONES)),
    )


@dataclass(frozen=True)
class SurfacePaths(OfMotion):
    """A source of paths: `PathSource` for surfaces seen through air or a wall."""

    body: Body  # whose segments
    drawn: SurfacePoints = field(repr=False)  # their points
    antennas: Antennas  # where the legs start and end
    fc: float  # carrier, Hz
    wall: Wall | None  # the slab between, or None
    scattering: tuple[int, ...]  # numbers of the segments whose points scatter

    @property
    def motion(self) -> Motion:  # type: ignore[override]
        """Motion of the body."""
        return self.body.motion

    def places(self, t: Float) -> tuple[Float, Index]:
        """Middles of the segments, which shadows fall on, as `PlacedPaths.places`."""
        placed, segment = self.body.at(t), self.drawn.segment
        return 0.5 * (placed.start + placed.end), segment[self._scatters]

    def __call__(self, t: Float) -> Paths:
        """Paths of the points at times t [M] (s)."""
        # A way and its reverse have the same points, and one leg is part of many ways.
        tx, rx = sorted(way.antenna(self._centre()) for way in self.antennas.legs)

        def remember(name: object, compute: Callable[[], Float]) -> Float:
            return cached_result(self.motion, ("surface", tx, rx, name), t, compute)

        p, strength = cached_result(
            self.motion, ("surface", tx, rx), t, lambda: self.scatter(t, tx, rx)
        )
        r_tx, r_rx = (
            remember(("leg", antenna), partial(leg, p, antenna))
            for antenna in (self.antennas.tx, self.antennas.rx)
        )
        tau = bistatic_delay(r_tx, r_rx)
        field_ = self.antennas.field(p, remember)
        if field_ is not None:
            strength = strength * field_
        a = amplitude(r_tx, r_rx, strength**2, self.antennas.gain, SPEED_OF_LIGHT / self.fc)
        cosine, layers = None, None
        if self.wall is not None:
            cosine = pass_wall(p, self.antennas, self.wall, self.fc, tau, a)
            layers = self.wall.layers
        tau -= (np.angle(self.drawn.weight) / (2 * pi * self.fc))[:, None]  # less than lambda/2
        paths = Paths(tau, a, Through.of(layers, cosine))
        return paths if self._scatters.all() else paths.only(self._scatters)

    @cached_property
    def _scatters(self) -> Bool:
        """Whether each point [I] scatters."""
        scatters: Bool = np.isin(self.drawn.segment, self.scattering)
        return scatters

    def _centre(self) -> Point:
        """Return the point that surfaces face: the array, or the middle of the antennas."""
        if self.antennas.aim is not None:
            return self.antennas.aim.position
        x, y, z = np.mean(self.antennas.places, axis=0)
        return (x, y, z)

    def scatter(self, t: Float, tx: Point, rx: Point) -> tuple[Float, Float]:
        """Positions [3, I, M] (m) of the points, and their fields sqrt(sigma) [I, M] (m).

        Patterns of antennas and bounces are not in them.

        They face the array, or the direction between those from which its legs come.
        """
        drawn, placed = self.drawn, self.body.at(t)
        span = placed.end - placed.start
        axis = unit(span)
        middle = 0.5 * (placed.start + placed.end)
        sight = unit(np.array(tx)[:, None, None] - middle)
        if tx != rx:
            sight = soft_unit(sight + unit(np.array(rx)[:, None, None] - middle))
        facing = soft_unit(sight - (sight * axis).sum(axis=0) * axis)
        aside = cross(axis, facing)
        across = np.sqrt(np.maximum(1 - (sight * axis).sum(axis=0) ** 2, 0))  # sin(segment, sight)
        s = drawn.segment
        cosine, sine = np.cos(drawn.around)[:, None], np.sin(drawn.around)[:, None]
        outwards = cosine * facing[:, s] + sine * aside[:, s]
        p = placed.start[:, s] + drawn.along[:, None] * span[:, s]
        p += DEPTH * self.body.radii[s] * outwards
        p += self._tremor(t)[s] * sight[:, s]
        normal = np.maximum(cosine * across[s], 0) ** NORMAL_POWER
        strength = normal * across[s] ** ALONG_POWER
        strength *= (np.abs(drawn.weight) * self._facing[s])[:, None]
        return p, strength

    def _tremor(self, t: Float) -> Float:
        """Displacement along the sight [segment, M], m: tones of random rates."""
        drawn = self.drawn
        speeds = np.full(len(drawn.rate), TREMOR_MPS)
        speeds[-1] = COMMON_MPS
        size = speeds[:, None] * np.sqrt(2 / TONES) / (2 * pi * drawn.rate)
        tones = np.sin(2 * pi * (drawn.rate[..., None] * t + drawn.phase[..., None]))
        moved = (size[..., None] * tones).sum(axis=1)
        shaken: Float = moved[:-1] + moved[-1]
        return shaken

    @property
    def _facing(self) -> Float:
        """Fields of a point of each facing segment, m; powers of all add up to sigma."""
        count = self.drawn.segment.size // len(self.body.segments)
        x = np.linspace(-SPREAD, SPREAD, 1001)
        mean = float(np.mean(np.cos(x) ** (2 * NORMAL_POWER)))
        words = (one.name.split("_")[-1] for one in self.body.segments)
        sigma = 10 ** (np.array([FACING_DBSM[word] for word in words]) / 10)
        size = self.body.stature / REFERENCE_STATURE * self.body.thickness
        return np.sqrt(sigma * size / (count * mean))
