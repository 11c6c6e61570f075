"""A homogeneous axis-aligned slab crossed at straight angles (docs/physics/model.md)."""

from collections.abc import Iterator
from dataclasses import dataclass
from math import pi, sqrt
from typing import Literal, NamedTuple

import numpy as np

from radhar_cli.numerics.arrays import Bool, Float, Index
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.radar.layers import Layers


@dataclass(frozen=True)
class Wall:
    """Place, size, material and model of the slab."""

    center: tuple[float, float, float]  # m
    size: tuple[float, float, float]  # m
    eps_r: float  # relative permittivity, real part
    loss_tangent: float  # tan delta; eps = eps_r (1 - j tan delta)
    # chord of the straight ray, plane wave at its angle, or refracted (`refraction.py`)
    rays: Literal["straight", "plane", "refracted"] = "straight"
    # transmission of a face at normal incidence, or at the ray's angle for a field perpendicular or
    # parallel to the plane of incidence (`fresnel.py`)
    fresnel: Literal["normal", "perpendicular", "parallel"] = "normal"
    # layers of a wall whose echoes are exact, instead of delay and loss at the carrier; eps_r and
    # loss_tangent are then those of a homogeneous wall of the same depth and n
    layers: Layers | None = None

    @property
    def permittivity(self) -> complex:
        """Complex relative permittivity eps = eps_r (1 - j tan delta)."""
        return self.eps_r * (1 - 1j * self.loss_tangent)

    @property
    def refractive_index(self) -> complex:
        """Complex refractive index n = sqrt(eps)."""
        return complex(np.sqrt(self.permittivity))

    @property
    def bounds(self) -> tuple[tuple[float, float], ...]:
        """Faces (low, high) along x, y and z, m."""
        return tuple((c - s / 2, c + s / 2) for c, s in zip(self.center, self.size, strict=True))

    @property
    def reflection(self) -> complex:
        """Reflection coefficient at normal incidence, Gamma = (1 - sqrt(eps))/(1 + sqrt(eps))."""
        n = self.refractive_index
        return (1 - n) / (1 + n)

    def contains(self, p: Float) -> Bool:
        """Whether positions p [3, ...] (m) lie in the slab, bounds included."""
        inside = np.ones(p.shape[1:], dtype=bool)
        for axis, (low, high) in enumerate(self.bounds):
            inside &= (p[axis] >= low) & (p[axis] <= high)
        return inside

    def depth(self, p: Float) -> Float:
        """Depth [...] (m) of positions p [3, ...] (m) in the slab; below 0 outside."""
        sides = [
            np.minimum(p[axis] - low, high - p[axis])
            for axis, (low, high) in enumerate(self.bounds)
        ]
        nearest: Float = np.min(sides, axis=0)
        return nearest


class Crossing(NamedTuple):
    """Straight rays through the slab."""

    chord: Float  # length inside [I, M], m
    faces: Index  # number of faces crossed [I, M], 0 to 2


def crossing(p: Float, antenna: tuple[float, float, float], wall: Wall) -> Crossing:
    """Intersect the straight rays from an antenna, which is outside, to positions p [3, I, M] (m).

    A ray is a + s (p - a), 0 <= s <= 1. Bounds count as inside, so a ray that ends on a face has
    entered but not left; a ray along a face, or one that touches an edge, is untouched.
    """
    enter = np.full(p.shape[1:], -np.inf)
    leave = np.full(p.shape[1:], np.inf)
    length2 = np.zeros(p.shape[1:])
    misses = np.zeros(p.shape[1:], dtype=bool)
    for step, outside, near, far in _between_planes(p, antenna, wall):
        length2 += step * step
        misses |= outside
        np.maximum(enter, near, out=enter)
        np.minimum(leave, far, out=leave)
    hit = ~misses & (enter < leave) & (enter <= 1) & (leave > 0)
    chord = np.where(hit, (np.minimum(leave, 1) - enter), 0.0) * np.sqrt(length2)
    faces = hit.astype(np.intp) + (hit & (leave < 1))
    return Crossing(chord, faces)


def faces_met(p: Float, antenna: tuple[float, float, float], wall: Wall) -> tuple[Index, Index]:
    """Axes (0, 1, 2) [I, M] of the faces where the rays of `crossing` enter and leave the slab.

    Valid where `crossing` counts that many faces; at an edge the first axis is taken.
    """
    planes = list(_between_planes(p, antenna, wall))
    entered = np.argmax([near for _, _, near, _ in planes], axis=0)
    exited = np.argmin([far for _, _, _, far in planes], axis=0)
    return entered, exited


class _Between(NamedTuple):
    """Rays and one pair of parallel faces."""

    step: Float  # way along the axis of the faces, m
    outside: Bool  # whether a ray runs outside the pair and parallel to it
    near: Float  # s at the nearer face
    far: Float  # s at the farther face


def _between_planes(
    p: Float, antenna: tuple[float, float, float], wall: Wall
) -> Iterator[_Between]:
    """Rays between the faces across x, y and z."""
    for axis, (low, high) in enumerate(wall.bounds):
        start = antenna[axis]
        step = p[axis] - start
        parallel = step == 0
        # A nearly parallel ray overflows to infinity, which the comparisons handle.
        with np.errstate(divide="ignore", over="ignore", invalid="ignore"):
            first, second = (low - start) / step, (high - start) / step
        near, far = np.minimum(first, second), np.maximum(first, second)
        if parallel.any():
            near[parallel], far[parallel] = -np.inf, np.inf
        yield _Between(step, parallel & (not low < start < high), near, far)


def extra_delay(chord: Float, wall: Wall) -> Float:
    """Delay beyond free space, d (Re sqrt(eps) - 1)/c (s), of chords d [...] (m)."""
    return chord * ((wall.refractive_index.real - 1) / SPEED_OF_LIGHT)


def both_faces(straight: Crossing, cosine: Float, wall: Wall) -> Bool:
    """Whether straight rays [I, M] pass both x faces, by the cosine of their angle to x."""
    passes: Bool = (straight.faces == 2) & (straight.chord * cosine > wall.size[0] * (1 - 1e-6))
    return passes


def plane_wave(
    p: Float, antenna: tuple[float, float, float], wall: Wall, straight: Crossing
) -> tuple[Float, Float]:
    """Chord [I, M] (m) and delay [I, M] (s) beyond free space of plane waves along the rays.

    At the angle of the ray, cos = |dx|/R, a slab of depth D has the delay
    D (sqrt(n^2 - 1 + cos^2) - cos)/c and the chord D/sqrt(1 - (1 - cos^2)/n^2), n = Re sqrt(eps).
    A ray that does not pass both x faces keeps its own chord.
    """
    ray = p - np.reshape(antenna, (3,) + (1,) * (p.ndim - 1))
    reach = np.sqrt(np.sum(ray * ray, axis=0))
    with np.errstate(invalid="ignore", divide="ignore"):
        cos = np.abs(ray[0]) / reach
        n, depth = wall.refractive_index.real, wall.size[0]
        both = both_faces(straight, cos, wall)
        steps = (n - 1) * (n + 1)
        inside = np.sqrt(steps + cos * cos)  # n times the cosine inside
        delay = depth * steps / (inside + cos) / SPEED_OF_LIGHT
        chord = depth * n / inside
    straight_delay = extra_delay(straight.chord, wall)
    return np.where(both, chord, straight.chord), np.where(both, delay, straight_delay)


def field_factor(crossed: Crossing, wall: Wall, fc: float) -> Float:
    """Field [I, M] behind one leg, exp(-k0 |Im sqrt(eps)| d) (1 - |Gamma|^2)^(n/2), n faces."""
    n = wall.refractive_index
    face = sqrt(4 * n.real) / abs(1 + n)  # sqrt(1 - |Gamma|^2), without its cancellation
    through = np.array([1.0, face, face * face])[crossed.faces]
    factor: Float = absorption(crossed.chord, wall, fc) * through
    return factor


def absorption(chord: Float, wall: Wall, fc: float) -> Float:
    """Field after chords d [...] (m) at a frequency fc (Hz): exp(-k0 |Im sqrt(eps)| d)."""
    k0 = 2 * pi * fc / SPEED_OF_LIGHT
    field: Float = np.exp(-k0 * abs(wall.refractive_index.imag) * chord)
    return field
