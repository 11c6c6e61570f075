"""Rays bent by Snell's law at the faces of the slab (Born and Wolf, Principles of Optics, 3.2).

Between two parallel faces, or from one face to a point inside, a ray is fixed by the tangent t of
its angle outside. With a and b the distances outside before and after, d the depth in the wall, all
along the normal, rho the lateral offset of the ends and n = Re sqrt(eps) the ray arrives where

    f(t) = (a + b) t + d t/q - rho = 0,    q = sqrt(n^2 (1 + t^2) - t^2),

and t' = t/q is the tangent inside. f rises and is concave: Newton's steps from a t below the root
stay below it. The faces are taken as endless where a ray that enters close to an edge is bent
beyond it.
"""

from typing import NamedTuple

import numpy as np

from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.radar.wall import Crossing, Wall, extra_delay, faces_met

# Rounding error of f in units of rho: at most seven roundings of half an epsilon each.
MISSES_BY = 8 * np.finfo(float).eps
# Newton gains a factor of 3/2 in t a step, or more, until it converges quadratically. Slowest is
# rho = d/sqrt(n^2 - 1) as a + b vanishes: 19 steps for 1e-9 m, 24 for 1e-12 m; 3 are usual.
MAX_STEPS = 64


class RefractedRays(NamedTuple):
    """Refracted rays through a wall.

    Attributes:
        crossed: Chord inside the wall (m) and faces [I, M]; the straight ray's where not bent.
        delay: Delay beyond free space [I, M], s.
        tangent: Tangent t of the angle outside [I, M]; NaN where not bent.
    """

    crossed: Crossing
    delay: Float
    tangent: Float


def refract(
    p: Float, antenna: tuple[float, float, float], wall: Wall, straight: Crossing
) -> RefractedRays:
    """Bend the rays from an antenna to positions p that meet parallel faces.

    A ray that enters and leaves through faces of different axes (around a corner) keeps its
    straight chord; one that misses is untouched.

    Args:
        p: Positions [3, I, M], m.
        antenna: Position of the antenna, m.
        straight: `crossing` of the same rays.
    """
    entered, exited = faces_met(p, antenna, wall)
    bends = (straight.faces == 1) | ((straight.faces == 2) & (entered == exited))
    chord, tangent = straight.chord.copy(), np.full_like(straight.chord, np.nan)
    delay = extra_delay(chord, wall)
    n = wall.refractive_index.real
    for axis in range(3):
        chosen = bends & (entered == axis)
        outside, depth = _along_normal(p[axis][chosen], antenna[axis], wall.bounds[axis])
        across = [p[other][chosen] - antenna[other] for other in range(3) if other != axis]
        offset = np.hypot(*across)
        t = outside_tangent(outside, depth, offset, n)
        tangent[chosen] = t
        chord[chosen] = depth * np.sqrt(1 + inside_tangent(t, n) ** 2)
        delay[chosen] = optical_excess(outside, depth, offset, t, n) / SPEED_OF_LIGHT
    return RefractedRays(Crossing(chord, straight.faces), delay, tangent)


def _along_normal(x: Float, start: float, faces: tuple[float, float]) -> tuple[Float, Float]:
    """Lengths (a + b, d) of rays from `start`, outside two faces, to x beyond the nearer one."""
    low, high = faces
    near, far = (low, high) if start <= low else (high, low)
    depth = np.minimum(np.abs(x - near), high - low)
    beyond = np.where(np.abs(x - near) > high - low, np.abs(x - far), 0.0)
    return abs(near - start) + beyond, depth


def inside_tangent(t: Float, n: float) -> Float:
    """Tangent t' = t/q of the refracted angle, for t [...] outside and an index n."""
    return t / _q(t, n)


def _q(t: Float, n: float) -> Float:
    """Root q = sqrt(n^2 (1 + t^2) - t^2)."""
    return np.sqrt(1 + (n - 1) * (n + 1) * (1 + t * t))


def outside_tangent(outside: Float, depth: Float, offset: Float, n: float) -> Float:
    """Tangent t [R] with f(t) = 0, so that the ray misses its end by rounding of rho alone.

    Args:
        outside: a + b [R], above 0, m.
        depth: d [R], m.
        offset: rho [R], m.
        n: Real refractive index, 1 or more.
    """
    t: Float = offset / (outside + depth / n)
    unsolved = np.arange(t.size)
    for _ in range(MAX_STEPS):
        a, d, rho, x = outside[unsolved], depth[unsolved], offset[unsolved], t[unsolved]
        q = _q(x, n)
        short = rho - (a * x + d * x / q)
        too_short = short > MISSES_BY * rho
        if not too_short.any():
            break
        # Each ray stops by itself: its number does not depend on those beside it.
        unsolved = unsolved[too_short]
        slope = a + d * (n / q) ** 2 / q
        t[unsolved] += (short / slope)[too_short]
    return t


def optical_excess(outside: Float, depth: Float, offset: Float, t: Float, n: float) -> Float:
    """Excess L - R [R] (m) of the optical length L = (a + b) sqrt(1 + t^2) + n d sqrt(1 + t'^2).

    A segment of length l at an angle to the straight ray advances l cos(angle) along it, so that
    L - R = (n - 1) l' + sum of l (1 - cos(angle)) over outside and inside. With
    l (1 - cos) = (l sin)^2/(l + l cos) and l sin = (a + b) d (t - t')/R for both, every term is
    positive and nothing cancels. Arguments are those of `outside_tangent`, and its t.
    """
    height = outside + depth
    distance = np.hypot(height, offset)
    inside = inside_tangent(t, n)
    # t - t' = t (q - 1)/q, q - 1 = (q^2 - 1)/(q + 1)
    turn = inside * (n - 1) * (n + 1) * (1 + t * t) / (_q(t, n) + 1) / distance
    ahead = np.sqrt(1 + t * t) + (height + t * offset) / distance
    ahead_inside = np.sqrt(1 + inside * inside) + (height + inside * offset) / distance
    detour = outside * depth * turn * turn * (depth / ahead + outside / ahead_inside)
    return (n - 1) * depth * np.sqrt(1 + inside * inside) + detour
