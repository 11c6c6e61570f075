"""A body of ellipsoids and antennas -> paths, several a segment.

A segment's cross section, and the point of it that is nearest, follow from the aspect at each
instant (`radar/ellipsoid.py`). Its echo comes from n points along it, each with a fixed place and
a fixed share of the power, so that it fills the band between the Dopplers of its ends.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, partial
from math import ceil
from typing import NamedTuple

import numpy as np

from radhar_cli.echo.bodies.motion_paths import OfMotion
from radhar_cli.echo.paths import Paths, Through
from radhar_cli.motion.protocol import Motion, cached_result
from radhar_cli.motion.segments import SOFTNESS, Segment, SegmentPositions, segment_positions
from radhar_cli.numerics.accelerators import machine_code
from radhar_cli.numerics.arrays import Bool, Float, Index
from radhar_cli.radar import ellipsoid
from radhar_cli.radar.ellipsoid import (
    ABOVE,
    ALONG,
    ASIDE,
    CENTRE,
    EARLIER,
    FRAME_ROWS,
    PER_STRENGTH,
    PRODUCT_ROWS,
    RX,
    SQUARE,
    SQUARED_LEFT,
    SQUARED_SPAN,
    STRENGTH,
    TX,
    Frame,
    View,
    square_height,
)
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.radar.propagation import Antennas, amplitude, leg
from radhar_cli.radar.room import Point
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.wall_rays import pass_wall

REFLECTANCE = 0.5  # |Gamma|^2 of skin and clothes
SCATTER = 0.02  # standard deviation across a segment, m; cut at twice that
JITTER = 0.7  # standard deviation along it, over the distance between points
RATE_STEP_S = 1e-3
RATES_PER_SECOND, MAX_RATES = 25.0, 8192
BLOCK = 2048  # times per block, which then fits the cache
EVERY = slice(None)
# Rows of products that the squared delay of each leg is made of, in the order of a point's factors.
SQUARES = [
    [antenna + row for row in (SQUARE, ALONG, ASIDE, ABOVE)] + [SQUARED_SPAN, SQUARED_LEFT]
    for antenna in (TX, RX)
]


class Points(NamedTuple):
    """The n points of a segment.

    Attributes:
        along: places along the segment from its middle, -1/2 to 1/2 of the length [n].
        across: offsets in two directions across it [2, n], m.
        share: shares of the amplitude [n], whose squares add up to 1.
    """

    along: Float
    across: Float
    share: Float


def draw_points(count: int, rng: np.random.Generator) -> Points:
    """Draw points, one in each n-th of a segment, with exponential powers.

    A single point is in the middle, and nothing is drawn.
    """
    if count == 1:
        return Points(np.zeros(1), np.zeros((2, 1)), np.ones(1))
    jitter, power = JITTER * (rng.random(count) - 0.5), rng.exponential(size=count)
    across = SCATTER * rng.standard_normal((2, count)).clip(-2, 2)
    along = (np.arange(count) + 0.5 + jitter) / count - 0.5
    return Points(along, across, np.sqrt(power / power.sum()))


@dataclass(frozen=True)
class Body:
    """Body of ellipsoids that follow the joints of a motion.

    Attributes:
        motion: motion of the joints.
        segments: segments between its joints, S of them.
        stature: stature of the person, m.
        thickness: thickness of the segments, over the usual one.
    """

    motion: Motion
    segments: tuple[Segment, ...]
    stature: float
    thickness: float

    @cached_property
    def radii(self) -> Float:
        """Semi-axes of the segments across [S, 1], m."""
        return self.thickness * np.array([[segment.radius] for segment in self.segments])

    @cached_property
    def flatness(self) -> Float:
        """Flatness of the segments [S, 1]."""
        return np.array([[segment.flatness] for segment in self.segments])

    def at(self, t: Float) -> SegmentPositions:
        """Places of the segments at times t [M] (s)."""
        return segment_positions(self.motion, self.segments, self.stature, t)

    def clearance(self, antenna: tuple[float, float, float], t: Float) -> Float:
        """Distance of an antenna from the surface of each segment at times t [M] (s).

        Returns:
            Distances [S, M], m; below 0 inside of a segment.
        """
        frame = frame_of(self.at(t))
        sight = ellipsoid.line_of_sight(frame, antenna)
        aside = sight.aside / sight.distance
        view = View(sight.along / (sight.distance * frame.length), aside, np.ones(1))
        height = square_height(view, self.radii, 0.5 * frame.length, self.flatness)
        clear: Float = sight.distance - np.sqrt(height)
        return clear


def point_counts(
    body: Body,
    antennas: Antennas,
    wavelength: float,
    window: float,
    duration: float,
    largest_count: int,
) -> tuple[int, ...]:
    """Number of points that each segment needs: n = min(ceil(2 dv T_w/lambda), largest), 1 or more.

    dv is the largest difference of the radial speeds of the segment's ends: n points are less than
    a Doppler cell of the window T_w apart, so that no gaps show between their lines.

    Args:
        antennas: antennas that the speeds are seen by.
        wavelength: lambda, m.
        window: T_w, s.
        duration: duration of the recording, s.
        largest_count: largest number of points of a segment.
    """
    times = int(np.clip(RATES_PER_SECOND * duration, 64, MAX_RATES))
    t = np.linspace(0, duration, times)
    placed = body.at(np.concatenate([t, t + RATE_STEP_S]))
    speed_difference = np.zeros((len(body.segments), times))
    for antenna in (antennas.tx, antennas.rx):
        start, end = (leg(p, antenna) for p in (placed.start, placed.end))
        difference = end - start
        change = difference[:, times:] - difference[:, :times]
        speed_difference += 0.5 * change / RATE_STEP_S
    cells = 2 * np.abs(speed_difference).max(axis=1) * window / wavelength
    return tuple(min(max(ceil(count), 1), largest_count) for count in cells.tolist())


@dataclass(frozen=True)
class SegmentPaths(OfMotion):
    """A source of paths: `PathSource` for a body of segments seen through air or a wall."""

    body: Body  # whose segments
    points: tuple[Points, ...]  # of each segment
    antennas: Antennas  # where the legs start and end
    fc: float  # carrier, Hz
    wall: Wall | None  # the slab between, or None
    shadowing: bool  # whether trunk and thighs hide what is behind them
    # numbers of the segments that scatter; the others hide these all the same
    scattering: tuple[int, ...]
    compiled: bool = False  # whether numba makes them, in air

    @property
    def motion(self) -> Motion:  # type: ignore[override]
        """Motion of the body."""
        return self.body.motion

    @cached_property
    def _table(self) -> Float:
        """[I, 7]: coefficients of the squared delay of each point (s^2), and of its amplitude.

        The first are of |w|^2, w d, w e, w f, |d|^2, |e|^2 = |f|^2 for |w + x d + y e + z f|^2: w
        is the way to the middle of a segment, d that along it, e and f are across.
        """
        points = [self.points[s] for s in self.scattering]
        x, share = (np.concatenate([of_segment[part] for of_segment in points]) for part in (0, 2))
        y, z = np.concatenate([of_segment.across for of_segment in points], axis=1)
        ones, wavelength = np.ones(x.size), SPEED_OF_LIGHT / self.fc
        share = share * amplitude(ones, ones, REFLECTANCE * ones, self.antennas.gain, wavelength)
        rows = np.stack([ones, 2 * x, 2 * y, 2 * z, x * x, y * y + z * z]) / SPEED_OF_LIGHT**2
        return np.vstack([rows, share]).T.copy()

    @cached_property
    def _sizes(self) -> Float:
        """Radius (m), flatness and number of points of each segment [3, S, 1]."""
        counts = np.array([[float(points.share.size)] for points in self.points])
        return np.stack([self.body.radii, self.body.flatness, counts])

    @cached_property
    def _first(self) -> Index:
        """Number of the first point of each segment, and of all points [S + 1]."""
        scatters = np.isin(np.arange(len(self.points)), self.scattering)
        return np.cumsum([0, *(scatters * self._sizes[2, :, 0])]).astype(np.intp)

    def places(self, t: Float) -> tuple[Float, Index]:
        """Middles of the segments, which shadows fall on, as `PlacedPaths.places`."""
        placed, segments = self.body.at(t), list(self.scattering)
        middles: Float = 0.5 * (placed.start + placed.end)[:, segments]
        counts = np.diff(self._first)[segments]
        return middles, np.repeat(np.arange(len(segments)), counts)

    def __call__(self, t: Float) -> Paths:
        """Paths of the points at times t [M] (s), segment by segment."""
        placed: SegmentPositions = cached_result(
            self.motion, "segments", t, lambda: self.body.at(t)
        )
        legs = self.antennas.legs
        delay, strength = np.empty((2, self._first[-1], t.size))
        if self.compiled and self.wall is None:
            sizes, hide = self._sizes[:, :, 0].T.copy(), np.array(self._occluders, np.intp)
            seen_from = (
                (self._middle,) if legs[0] == legs[1] else (self.antennas.tx, self.antennas.rx)
            )
            scene, results = self._scene_from(*seen_from), (delay, strength)
            fill = machine_code(ellipsoid.fill_paths, *ellipsoid.CALLED)
            fill(tuple(placed), scene, sizes, hide, self._first, self._table, results)
            middles = 0.5 * (placed.start + placed.end)
            if (field := self.antennas.field(middles, partial(self._remember, t))) is not None:
                strength *= np.repeat(field, np.diff(self._first), axis=0)
            return Paths(delay, strength)
        # What stands still does so to the last digit only if it is computed once.
        still = np.logical_and.reduce([_constant(part) for part in placed])
        cosine = np.empty((2, len(delay), t.size)) if self.wall and self.wall.layers else None
        for first in range(0, t.size, BLOCK):
            block = slice(first, first + BLOCK)
            self._fill(
                SegmentPositions(*(part[..., block] for part in placed)),
                still,
                delay[:, block],
                strength[:, block],
                None if cosine is None else cosine[..., block],
            )
        through = Through.of(self.wall.layers, cosine) if self.wall is not None else None
        return Paths(delay, strength, through)

    def _remember(self, t: Float, name: object, compute: Callable[[], Float]) -> Float:
        """Field at the middles of the segments at times t [M] (s), computed once."""
        return cached_result(self.motion, ("segments", name), t, compute)

    @property
    def _middle(self) -> Point:
        """Middle between the antennas, m."""
        x, y, z = (0.5 * np.add(self.antennas.tx, self.antennas.rx)).tolist()
        return x, y, z

    def _scene_from(self, *seen_from: Point) -> tuple[Float, float, float]:
        """Scene of `ellipsoid.fill_paths` in which shadows are seen from places (m)."""
        places = np.array([self.antennas.tx, self.antennas.rx, *seen_from]).T.copy()
        return places, SPEED_OF_LIGHT / self.fc, SOFTNESS

    @property
    def _occluders(self) -> list[int]:
        """Numbers of the segments that hide others."""
        segments = enumerate(self.body.segments)
        return [o for o, segment in segments if segment.occludes and self.shadowing]

    def _products(self, placed: SegmentPositions, place: Point) -> tuple[Float, Float]:
        """Frames [11, S, M] and products [12, S, M], with shadows seen from a place."""
        block, scene = np.concatenate(placed), self._scene_from(place)
        frames = np.empty((FRAME_ROWS, *block.shape[1:]))
        products = np.empty((PRODUCT_ROWS, *block.shape[1:]))
        ellipsoid.fill_products(block, scene, self._sizes, frames, products, EVERY)
        for o in self._occluders:
            unshaded, radius = products[STRENGTH, o].copy(), self.body.radii[o, 0]
            ellipsoid.shade(frames, products, frames[:, o], radius, scene[1], EVERY)
            products[STRENGTH, o] = unshaded
        return frames, products

    def _fill(
        self,
        placed: SegmentPositions,
        still: Bool,
        delay: Float,
        strength: Float,
        cosine: Float | None,
    ) -> None:
        """Fill in delays and amplitudes [I, block] of all points, and angles at a layered wall."""
        if self.antennas.legs[0] == self.antennas.legs[1]:
            frames, products = self._products(placed, self._middle)
        else:
            frames, products = self._products(placed, self.antennas.tx)
            behind = self._products(placed, self.antennas.rx)[1][STRENGTH]
            products[STRENGTH] = np.sqrt(products[STRENGTH] * behind)
        if (field := self.antennas.field(frames[CENTRE : CENTRE + 3])) is not None:
            products[STRENGTH] *= field
        frame = frame_of(placed) if self.wall is not None else None
        for s in self.scattering:
            points = slice(self._first[s], self._first[s + 1])
            rows = products[:, s, :1] if still[s] else products[:, s]
            squares = [self._table[points, :PER_STRENGTH] @ rows[leg] for leg in SQUARES]
            tx, rx = (np.sqrt(np.maximum(square, 0, out=square), out=square) for square in squares)
            np.subtract(tx + rx, products[EARLIER, s], out=delay[points])
            np.multiply(
                self._table[points, PER_STRENGTH:], products[STRENGTH, s], out=strength[points]
            )
            if self.wall is not None and frame is not None:
                p = positions(frame, s, self.points[s])
                angles = pass_wall(
                    p, self.antennas, self.wall, self.fc, delay[points], strength[points]
                )
                if cosine is not None:
                    cosine[:, points] = angles


def frame_of(placed: SegmentPositions) -> Frame:
    """Frames of reference of the segments, with numbers [S, M]."""
    start, end, beside = map(tuple, placed)
    return ellipsoid.frame_of(start, end, beside, SOFTNESS)


def positions(frame: Frame, s: int, points: Points) -> Float:
    """Positions [3, n, M] (m) of the points of segment s."""
    x, (y, z) = points.along[:, None], points.across[:, :, None]
    axes = zip(frame.centre, frame.span, frame.left, frame.up, strict=True)
    return np.stack([c[s] + x * along[s] + y * left[s] + z * up[s] for c, along, left, up in axes])


def _constant(p: Float) -> Bool:
    """Whether each segment [S] stays where it is, by positions [3, S, M]."""
    same: Bool = (p == p[..., :1]).all(axis=(0, 2))
    return same
