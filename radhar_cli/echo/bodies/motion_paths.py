"""Motion, antennas and wall -> paths, one a scatterer."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar, NamedTuple, Protocol

import numpy as np

from radhar_cli.echo.paths import Paths, PathSource, Through
from radhar_cli.motion.protocol import Motion
from radhar_cli.motion.reflectors import Reflectors
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.radar.person_shadow import BodyBox, field_behind_person, limit_shadow
from radhar_cli.radar.propagation import Antennas, amplitude, bistatic_delay, leg
from radhar_cli.radar.wall import Wall
from radhar_cli.radar.wall_rays import pass_wall, wall_delay

NEARBY_M = 1.0


class OfMotion:
    """Base of sources of paths through air or a wall: properties that follow from the motion."""

    motion: Motion | Reflectors
    wall: Wall | None

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Instants (s) at which positions are not smooth."""
        return self.motion.breakpoints

    @property
    def highest_frequency(self) -> float:
        """Fundamental of the fastest motion, Hz."""
        return self.motion.highest_frequency

    @property
    def smooth(self) -> bool:
        """Whether paths are smooth between breakpoints: not where legs pass an edge of the wall."""
        return self.wall is None


@dataclass(frozen=True)
class MotionPaths(OfMotion):
    """A source of paths: `PathSource` for a motion seen through air or a wall."""

    motion: Motion | Reflectors  # scatterer positions over time
    antennas: Antennas  # where the legs start and end
    fc: float  # carrier, Hz
    wall: Wall | None  # the slab between, or None

    def places(self, t: Float) -> tuple[Float, Index]:
        """Positions at times t [M] (s) that shadows fall on, as `PlacedPaths.places`."""
        p = self.motion.positions(t)
        return p, np.arange(p.shape[1])

    def __call__(self, t: Float) -> Paths:
        """Paths of the scatterers at times t [M] (s)."""
        p, sigma = self.motion.positions(t), self.motion.cross_sections(t)
        r_tx, r_rx = leg(p, self.antennas.tx), leg(p, self.antennas.rx)
        tau = bistatic_delay(r_tx, r_rx)
        a = amplitude(r_tx, r_rx, sigma, self.antennas.gain, SPEED_OF_LIGHT / self.fc)
        if (field := self.antennas.field(p)) is not None:
            a *= field
        if self.wall is None:
            return Paths(tau, a)
        cosine = pass_wall(p, self.antennas, self.wall, self.fc, tau, a)
        return Paths(tau, a, Through.of(self.wall.layers, cosine))


@dataclass(frozen=True)
class NothingPath:
    """The echo of nothing: a path of amplitude 0 from NEARBY_M ahead, a `PathSource`."""

    antennas: Antennas

    breakpoints: ClassVar[tuple[float, ...]] = ()
    highest_frequency: ClassVar[float] = 0.0
    smooth: ClassVar[bool] = True

    def __call__(self, t: Float) -> Paths:
        """The path at times t [M] (s)."""
        place = np.add(self.antennas.tx, (NEARBY_M, 0.0, 0.0))[:, None, None]
        delay = point_delay(np.broadcast_to(place, (3, 1, t.size)), self.antennas, None)
        return Paths(delay, np.zeros_like(delay))


@dataclass(frozen=True)
class TorsoPath(OfMotion):
    """The path of a person's torso, of amplitude 1: a `PathSource`."""

    motion: Motion
    antennas: Antennas
    wall: Wall | None

    def __call__(self, t: Float) -> Paths:
        """The path at times t [M] (s)."""
        delay = point_delay(self.motion.torso(t), self.antennas, self.wall)
        return Paths(delay, np.ones_like(delay))


class PlacedPaths(PathSource, Protocol):
    """Source of paths that says where they end."""

    @property
    def antennas(self) -> Antennas:
        """Antennas between which the paths run."""

    def places(self, t: Float) -> tuple[Float, Index]:
        """Positions at times t [M] (s) that shadows fall on.

        Returns:
            Positions [3, P, M], m, and the number of the position of each path [I].
        """


class Shade(NamedTuple):
    """Boxes that throw a person's shadow (`radar/person_shadow.py`).

    Attributes:
        motion: motion of the person.
        boxes: boxes of the person at times [M], s.
    """

    motion: Motion
    boxes: Callable[[Float], tuple[BodyBox, ...]]


@dataclass(frozen=True)
class ShadowedPaths:
    """The paths of one person, weakened where others stand in their way."""

    source: PlacedPaths
    shades: tuple[Shade, ...]
    fc: float  # carrier, Hz

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Instants (s) at which any of the people does not move smoothly."""
        others = (at for shade in self.shades for at in shade.motion.breakpoints)
        return tuple(sorted({*self.source.breakpoints, *others}))

    @property
    def highest_frequency(self) -> float:
        """Fundamental of the fastest of the people, Hz."""
        others = (shade.motion.highest_frequency for shade in self.shades)
        return max(self.source.highest_frequency, *others)

    @property
    def smooth(self) -> bool:
        """Whether the source's own paths are smooth between breakpoints."""
        return self.source.smooth

    def __call__(self, t: Float) -> Paths:
        """Paths of the source at times t [M] (s)."""
        paths, (p, position_numbers) = self.source(t), self.source.places(t)
        remaining_field, wavelength = np.ones(p.shape[1:]), SPEED_OF_LIGHT / self.fc
        for shade in self.shades:
            boxes, legs = shade.boxes(t), np.ones(p.shape[1:])
            for antenna in (self.source.antennas.tx, self.source.antennas.rx):
                legs *= field_behind_person(p, antenna, boxes, wavelength)
            remaining_field *= limit_shadow(legs)
        return paths._replace(amplitude=paths.amplitude * remaining_field[position_numbers])


@dataclass(frozen=True)
class SumOfPaths:
    """Several sources at once, such as several people: `PathSource` of all their paths."""

    sources: tuple[PathSource, ...]

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Instants (s) at which any path is not smooth."""
        return tuple(sorted({at for source in self.sources for at in source.breakpoints}))

    @property
    def highest_frequency(self) -> float:
        """Fundamental of the fastest source, Hz."""
        return max(source.highest_frequency for source in self.sources)

    @property
    def smooth(self) -> bool:
        """Whether every source's paths are smooth between the breakpoints."""
        return all(source.smooth for source in self.sources)

    def __call__(self, t: Float) -> Paths:
        """Paths of all sources, one source after the other, at times t [M] (s)."""
        delay, a, through = zip(*(source(t) for source in self.sources), strict=True)
        return Paths(np.concatenate(delay), np.concatenate(a), Through.joined(through))


def point_delay(p: Float, antennas: Antennas, wall: Wall | None) -> Float:
    """Two-way delay tau [I, M], s, of positions p [3, I, M], m, with what the wall adds."""
    tau = bistatic_delay(leg(p, antennas.tx), leg(p, antennas.rx))
    return tau if wall is None else tau + through_wall_delay(p, antennas, wall)


def through_wall_delay(p: Float, antennas: Antennas, wall: Wall) -> Float:
    """Delay [I, M] (s) that a wall adds to both legs to positions p [3, I, M] (m)."""
    return wall_delay(p, antennas.tx, wall) + wall_delay(p, antennas.rx, wall)
