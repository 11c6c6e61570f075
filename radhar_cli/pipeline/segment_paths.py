"""A body of ellipsoids and antennas -> paths, several a segment.

A segment's cross section, and the point of it that is nearest, follow from the aspect at each
instant (`radar/ellipsoid.py`). Its echo comes from n points along it, each with a fixed place and
a fixed share of the power, so that it fills the band between the Dopplers of its ends.
"""

from dataclasses import dataclass
from functools import cached_property
from math import ceil
from typing import NamedTuple

import numpy as np

from radhar_cli.arrays import Bool, Float, Index
from radhar_cli.echo.paths import Paths, Through
from radhar_cli.motion.protocol import Motion
from radhar_cli.motion.segments import Placed, Segment, cross, place, soft_unit
from radhar_cli.pipeline.motion_paths import OfMotion
from radhar_cli.radar.ellipsoid import View, cross_section, shadow, square_height
from radhar_cli.radar.propagation import Antennas, amplitude, leg
from radhar_cli.radar.transmission import pass_wall
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.waveform import SPEED_OF_LIGHT

REFLECTANCE = 0.5  # |Gamma|^2 of skin and clothes
SCATTER = 0.02  # standard deviation across a segment, m; cut at twice that
JITTER = 0.7  # standard deviation along it, over the distance between points
RATE_STEP_S = 1e-3
RATES_PER_SECOND, MAX_RATES = 25.0, 8192
BLOCK = 2048  # times per block, which then fits the cache
TINY = np.finfo(float).tiny
FORWARD = 1e-6  # least |u_tx + u_rx|^2: scattering forwards has no aspect


class Points(NamedTuple):
    """The n points of a segment."""

    along: Float  # from the middle, -1/2 to 1/2 of the length [n]
    across: Float  # in two directions [2, n], m
    share: Float  # of the amplitude [n]; squares add up to 1

    @property
    def coefficients(self) -> Float:
        """[n, 6]: what makes |w + x d + y e + z f|^2 of |w|^2, w d, w e, w f, |d|^2, |e|^2 = |f|^2.

        w is the way to the middle of a segment, d that along it, e and f are across.
        """
        x, (y, z) = self.along, self.across
        return np.stack([np.ones_like(x), 2 * x, 2 * y, 2 * z, x * x, y * y + z * z], axis=1)


def draw_points(count: int, rng: np.random.Generator) -> Points:
    """Points one to each n-th of a segment, with exponential powers; a single one in its middle."""
    if count == 1:
        return Points(np.zeros(1), np.zeros((2, 1)), np.ones(1))
    jitter, power = JITTER * (rng.random(count) - 0.5), rng.exponential(size=count)
    across = SCATTER * rng.standard_normal((2, count)).clip(-2, 2)
    along = (np.arange(count) + 0.5 + jitter) / count - 0.5
    return Points(along, across, np.sqrt(power / power.sum()))


@dataclass(frozen=True)
class Body:
    """Whose segments they are."""

    motion: Motion  # how the joints move
    segments: tuple[Segment, ...]  # those that its joints have
    stature: float  # of the person, m
    thickness: float  # of the segments, over the usual one

    @cached_property
    def radii(self) -> Float:
        """Semi-axes across [S, 1], m."""
        return self.thickness * np.array([[one.radius] for one in self.segments])

    @cached_property
    def flatness(self) -> Float:
        """Of the segments [S, 1]."""
        return np.array([[one.flatness] for one in self.segments])

    def at(self, t: Float) -> Placed:
        """The segments at times t [M] (s)."""
        return place(self.motion, self.segments, self.stature, t)

    def clearance(self, antenna: tuple[float, float, float], t: Float) -> Float:
        """Way [S, M] (m) from an antenna to the nearest point of each segment, below 0 in it."""
        frames = SegmentAxes.of(self.at(t))
        seen = frames.seen_from(antenna)
        aside = seen.ways[:, 2] / seen.distance
        view = View(seen.ways[:, 1] / (seen.distance * frames.length), aside, np.ones(1))
        height = square_height(view, self.radii, 0.5 * frames.length, self.flatness)
        clear: Float = seen.distance - np.sqrt(height)
        return clear


def point_counts(
    body: Body, antennas: Antennas, wavelength: float, window: float, duration: float, most: int
) -> tuple[int, ...]:
    """n = min(ceil(2 dv T_w/lambda), most), 1 or more, of each segment; lambda in m, times in s.

    dv is the largest difference of the radial speeds of the segment's ends: n points are less than
    a Doppler cell of the window T_w apart, so that no gaps show between their lines.
    """
    count = int(np.clip(RATES_PER_SECOND * duration, 64, MAX_RATES))
    t = np.linspace(0, duration, count)
    placed = body.at(np.concatenate([t, t + RATE_STEP_S]))
    apart = np.zeros((len(body.segments), count))
    for antenna in (antennas.tx, antennas.rx):
        start, end = (leg(p, antenna) for p in (placed.start, placed.end))
        longer = end - start
        apart += 0.5 * (longer[:, count:] - longer[:, :count]) / RATE_STEP_S
    cells = 2 * np.abs(apart).max(axis=1) * window / wavelength
    return tuple(min(max(ceil(one), 1), most) for one in cells.tolist())


@dataclass(frozen=True)
class SegmentPaths(OfMotion):
    """A source of paths: `PathSource` for a body of segments seen through air or a wall."""

    body: Body  # whose segments
    points: tuple[Points, ...]  # of each segment
    antennas: Antennas  # where the legs start and end
    fc: float  # carrier, Hz
    wall: Wall | None  # the slab between, or None
    shadowing: bool  # whether trunk and thighs hide what is behind them
    # numbers of the segments whose paths are wanted; the others hide these all the same
    kept: tuple[int, ...]

    @property
    def motion(self) -> Motion:  # type: ignore[override]
        """Of the body."""
        return self.body.motion

    @cached_property
    def _coefficients(self) -> list[Float]:
        return [points.coefficients for points in self.points]

    def places(self, t: Float) -> tuple[Float, Index]:
        """Middles [3, S, M] (m) of the segments, and that of each path [I]."""
        placed, counts = self.body.at(t), [self.points[s].share.size for s in self.kept]
        middles: Float = 0.5 * (placed.start + placed.end)[:, list(self.kept)]
        return middles, np.repeat(np.arange(len(counts)), counts)

    def __call__(self, t: Float) -> Paths:
        """Paths of the points at times t [M] (s), segment by segment."""
        placed = self.body.at(t)
        # What stands still does so to the last digit only if it is computed once.
        still = np.logical_and.reduce([_constant(part) for part in placed])
        count = sum(self.points[s].share.size for s in self.kept)
        delay, strength = np.empty((2, count, t.size))
        cosine = np.empty((2, count, t.size)) if self.wall and self.wall.layers else None
        for first in range(0, t.size, BLOCK):
            some = slice(first, first + BLOCK)
            self._fill(
                SegmentAxes.of(Placed(*(part[..., some] for part in placed))),
                still,
                delay[:, some],
                strength[:, some],
                None if cosine is None else cosine[..., some],
            )
        through = Through.of(self.wall.layers, cosine) if self.wall is not None else None
        return Paths(delay, strength, through)

    def _fill(
        self,
        frames: "SegmentAxes",
        still: Bool,
        delay: Float,
        strength: Float,
        cosine: Float | None,
    ) -> None:
        """Fill in delays and amplitudes [I, block] of all points, and angles at a layered wall."""
        tx, rx = (frames.seen_from(antenna) for antenna in (self.antennas.tx, self.antennas.rx))
        # The sum of the unit vectors of both legs.
        square = 2 + 2 * _dot(tx.way, rx.way) / (tx.distance * rx.distance)
        view = View(
            (tx.ways[:, 1] / tx.distance + rx.ways[:, 1] / rx.distance) / frames.length,
            tx.ways[:, 2] / tx.distance + rx.ways[:, 2] / rx.distance,
            np.maximum(square, FORWARD, out=square),
        )
        half, radii, flatness = 0.5 * frames.length, self.body.radii, self.body.flatness
        height = square_height(view, radii, half, flatness) / view.square
        sigma = cross_section(height, radii, half, REFLECTANCE)
        wavelength = SPEED_OF_LIGHT / self.fc
        a = amplitude(tx.distance, rx.distance, sigma, self.antennas.gain, wavelength)
        if (field := self.antennas.field(frames.centre)) is not None:
            a *= field
        if self.shadowing and self.antennas.ways[0] == self.antennas.ways[1]:
            a *= self._light(frames, 0.5 * (tx.way + rx.way), wavelength)
        elif self.shadowing:
            light = (self._light(frames, one.way, wavelength) for one in (tx, rx))
            a *= np.sqrt(np.multiply(*light))
        # The n-th part of a segment is an ellipsoid of its own, with its own nearest point.
        parts = np.array([[points.share.size] for points in self.points])
        nearer = np.sqrt(square_height(view, radii, half / parts, flatness)) / SPEED_OF_LIGHT
        ways = np.stack([tx.ways, rx.ways]) / SPEED_OF_LIGHT**2
        first = 0
        for s in self.kept:
            points = self.points[s]
            some = slice(first, first + points.share.size)
            first = some.stop
            seconds = self._coefficients[s] @ (ways[:, s, :, :1] if still[s] else ways[:, s])
            np.sqrt(np.maximum(seconds, 0, out=seconds), out=seconds)
            np.subtract(seconds[0] + seconds[1], nearer[s], out=delay[some])
            np.multiply(points.share[:, None], a[s], out=strength[some])
            if self.wall is not None:
                p, given = frames.positions(s, points), (self.antennas, self.wall, self.fc)
                angles = pass_wall(p, *given, delay[some], strength[some])
                if cosine is not None:
                    cosine[:, some] = angles

    def _light(self, frames: "SegmentAxes", way: Float, wavelength: float) -> Float:
        """Field left [S, M] by the segments that hide others, seen along ways [3, S, M] (m)."""
        distance, left = np.sqrt(_dot(way, way)), np.ones(way.shape[1:])
        for o, one in enumerate(self.body.segments):
            if not one.occludes:
                continue
            axis, radius = frames.axis[:, o, None], self.body.radii[o]
            stretch = (2 / frames.length[o]) ** 2 - 1 / radius**2
            # Lengths in which the occluder is a ball of radius 1.
            apart = frames.centre[:, o, None] - frames.centre
            ray, gap = _dot(way, axis), _dot(apart, axis)
            long = distance * distance / radius**2 + ray * ray * stretch
            near = _dot(apart, way) / radius**2 + ray * gap * stretch
            clearance = _dot(apart, apart) / radius**2 + gap * gap * stretch - near * near / long
            dimmed = shadow(clearance, distance - distance[o], radius, wavelength)
            dimmed[o] = 1
            left *= dimmed
        return left


class SegmentAxes(NamedTuple):
    """Segments as frames of reference."""

    # centre, way: middle, and way from start to end [3, S, M], m
    centre: Float
    way: Float
    length: Float  # [S, M], m
    axis: Float  # unit vector along [3, S, M]
    # left, up: at right angles to it and to each other, as long as each other [3, S, M]
    left: Float
    up: Float

    @classmethod
    def of(cls, placed: Placed) -> "SegmentAxes":
        way = placed.end - placed.start
        length = np.sqrt(_dot(way, way))
        axis = way / np.maximum(length, TINY)
        left = soft_unit(placed.beside - _dot(placed.beside, axis) * axis)
        centre = placed.start + 0.5 * way
        return cls(centre, way, np.maximum(length, TINY), axis, left, cross(axis, left))

    def seen_from(self, antenna: tuple[float, float, float]) -> "_Seen":
        """Where the segments are from an antenna's place."""
        way = self.centre - np.array(antenna)[:, None, None]
        square = _dot(way, way)
        ways = np.empty((square.shape[0], 6, square.shape[1]))
        ways[:, 0] = square
        for row, other in enumerate((self.way, self.left, self.up), 1):
            ways[:, row] = _dot(way, other)
        ways[:, 4] = self.length * self.length
        ways[:, 5] = _dot(self.left, self.left)
        return _Seen(way, np.sqrt(np.maximum(square, TINY)), ways)

    def positions(self, s: int, points: Points) -> Float:
        """Positions [3, n, M] (m) of the points of segment s."""
        y, z = points.across[:, :, None]
        p: Float = self.centre[:, s, None] + points.along[:, None] * self.way[:, s, None]
        p += y * self.left[:, s, None]
        p += z * self.up[:, s, None]
        return p


class _Seen(NamedTuple):
    """Segments seen from an antenna."""

    way: Float  # to their centres [3, S, M], m
    distance: Float  # of these [S, M], m
    # products that the squared distances of points are made of [S, 6, M], m^2:
    # `Points.coefficients`
    ways: Float


def _constant(p: Float) -> Bool:
    same: Bool = (p == p[..., :1]).all(axis=(0, 2))
    return same


def _dot(a: Float, b: Float) -> Float:
    product: Float = a[0] * b[0]
    product += a[1] * b[1]
    product += a[2] * b[2]
    return product
