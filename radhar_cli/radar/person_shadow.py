"""The shadow that a person throws on others: two boxes that follow the joints, with soft edges.

The reference is the absorbing screen (Kirchhoff's integral) whose edges are known to 1.5 cm, as the
outline of a body is known no better; that takes the fringes away, which no interpolation in time
could follow. Over 2 to 77 GHz and 0.5 to 8 m the middle of a shadow lies within 3 dB of the
screen's in more than 97 % of random geometries, and its edges within 4 cm in more than 95 %
(tests/radar/test_person_shadow.py).
"""

from collections.abc import Sequence
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from radhar_cli.numerics.accelerators import installed, machine_code
from radhar_cli.numerics.arrays import Bool, Float

Real: TypeAlias = Any  # a number, or an array of them

LEAST = 0.03  # two-way field that gets around a person
BRIGHTEST = 0.5  # A^-4 of a field beside a person, in fringes of extreme carriers
LEAST_POWER = 1e-6  # of the field that gets around a box
BEYOND_M, BEYOND_WIDTH_M = 0.06, 0.03  # where a shadow begins behind a person, and how softly
WIDTHS = 25.0  # of those softnesses beyond which nothing is left of a shadow, 1e-11
FLOOR_M = 0.02  # height over the floor within which a box is taken to stand on it
SHORTEST_M = 1e-3  # horizontal length of a leg, of which a vertical one has none
MOST = 1e3  # Fresnel number of an edge beyond which the field stays as it is
MIN_LEGS = 2000  # legs at instants; with fewer, machine code takes longer to load than it saves


class BodyBox(NamedTuple):
    """An upright sheared box about lines of a body, at M instants.

    Attributes:
        centre: its centre [3, M], m.
        spread: xx, yy, zz, xy, xz, yz of its second moments [6, M], m^2.
    """

    centre: Float
    spread: Float


def box_about(lines: Sequence[tuple[Float, Float]], radius: float) -> BodyBox:
    """Box about lines from [3, M] to [3, M] (m), which are as thick as a radius (m)."""
    middles = [0.5 * (start + end) for start, end in lines]
    centre: Float = sum(middles[1:], start=middles[0]) / len(lines)
    spread = np.zeros((6, centre.shape[1]))
    for middle, (start, end) in zip(middles, lines, strict=True):
        for offset, weight in ((middle - centre, 3.0), (0.5 * (end - start), 1.0)):
            x, y, z = offset
            spread += weight * np.array([x * x, y * y, z * z, x * y, x * z, y * z])
    spread /= len(lines)
    spread[:3] += radius * radius
    return BodyBox(centre, spread)


def field_behind_person(
    p: Float, antenna: tuple[float, float, float], boxes: Sequence[BodyBox], wavelength: float
) -> Float:
    """Field [I, M] of legs past a person, 1 with nobody between.

    Overlaps of the boxes count once: A = (A_1^-4 + A_2^-4 - 1)^(-1/4).

    Args:
        p: Positions [3, I, M] to which the legs lead, m.
        antenna: Position of the antenna, m.
        wavelength: Wavelength of the carrier, m.
    """
    dimming = np.zeros(p.shape[1:])  # sum of A^-4 - 1
    place = [box.centre - np.reshape(antenna, (3, 1)) for box in boxes]
    if dimming.size >= MIN_LEGS and installed("numba") is not None:
        seen_from, spread = np.array(place), np.array([box.spread for box in boxes])
        fill_in = machine_code(_fill_in, *((part, part) for part in PARTS))
        fill_in(np.ascontiguousarray(p), antenna, seen_from, spread, wavelength, dimming)
        return dimming
    offset = p - np.reshape(antenna, (3, 1, 1))
    length = np.maximum(np.sqrt(offset[0] * offset[0] + offset[1] * offset[1]), SHORTEST_M)
    unit = offset[:2] / length
    for box, (x, y, z) in zip(boxes, place, strict=True):
        before = unit[0] * x + unit[1] * y
        legs = Legs(unit, offset[2], before, length - before, unit[0] * y - unit[1] * x)
        near = np.flatnonzero(_is_near(legs, np.hypot(x, y), box.spread, wavelength))
        if near.size:
            during = slice(int(near[0]), int(near[-1]) + 1)
            spread_then = tuple(box.spread[:, during])
            ways = legs.at(during)
            behind = _share_beyond(ways.before) * _share_beyond(ways.after)
            leg_values = (*ways.unit, *ways[1:], behind)
            dimming[:, during] += _dimming(
                leg_values, (z[during], *spread_then), (antenna[2], wavelength)
            )
    field: Float = 1 / np.sqrt(np.sqrt(np.maximum(1 + dimming, BRIGHTEST)))
    return field


class Legs(NamedTuple):
    """Legs of paths past a box.

    Attributes:
        unit: horizontal directions [2, I, M] from the antenna.
        rise: heights [I, M] of their ends above the antenna, m.
        before: horizontal distances [I, M] from the antenna to the box, m.
        after: horizontal distances [I, M] from the box to their ends, m.
        aside: horizontal distances [I, M] of the box's centre to their left, m.
    """

    unit: Float
    rise: Float
    before: Float
    after: Float
    aside: Float

    def at(self, instants: slice) -> "Legs":
        """The legs at some of the instants."""
        return Legs(*(part[..., instants] for part in self))


def _is_near(legs: Legs, distance: Float, spread: Float, wavelength: float) -> Bool:
    """Whether a box may dim any leg at some instants [M].

    Args:
        legs: Legs past the box.
        distance: Horizontal distance [M] from the antenna to the box, m.
        spread: Its second moments [6, M], m^2.
        wavelength: Wavelength of the carrier, m.
    """
    least = BEYOND_M - WIDTHS * BEYOND_WIDTH_M
    # The end of an edge's shadow is a convex function of v, and v falls with both distances.
    farthest_end = np.maximum(legs.after.max(axis=0), 0.0)
    distances = distance, farthest_end, np.zeros(farthest_end.shape)
    ends = [_end_of_shadow(_fresnel_scale(d, d, wavelength)) for d in distances]
    end = np.maximum(np.maximum(ends[0], ends[1]), ends[2])
    lean = np.hypot(spread[4], spread[5]) / spread[2]
    reach = np.sqrt(spread[0] + spread[1]) + end * np.sqrt(1 + lean * lean)
    reach += lean * (np.sqrt(spread[2]) + end)
    near = np.abs(legs.aside) < reach
    near &= (legs.before > least) & (legs.after > least)
    result: Bool = near.any(axis=0)
    return result


def _share_beyond(distance: Float) -> Float:
    """Share of a shadow that is left at a distance (m) from the person."""
    near = distance < BEYOND_M + WIDTHS * BEYOND_WIDTH_M
    share = np.ones(distance.shape)
    share[near] = 1 / (1 + np.exp(np.minimum((BEYOND_M - distance[near]) / BEYOND_WIDTH_M, 700)))
    return share


def _fill_in(
    p: Float,
    antenna: tuple[float, float, float],
    place: Float,
    spread: Float,
    wavelength: float,
    field: Float,
) -> None:
    """Fill in the field [I, M] past boxes [B, 3, M] and [B, 6, M], for machine code."""
    count, (x0, y0, z0) = p.shape[2], antenna
    ex, ey, before, after, aside, behind = np.empty((6, count))
    scale = z0, wavelength
    for i in range(p.shape[1]):
        for box in range(place.shape[0]):
            up, moments = place[box, 2], spread[box]
            for m in range(count):
                x, y = p[0, i, m] - x0, p[1, i, m] - y0
                length = max(np.sqrt(x * x + y * y), SHORTEST_M)
                ex[m], ey[m] = x / length, y / length
                before[m] = ex[m] * place[box, 0, m] + ey[m] * place[box, 1, m]
                after[m] = length - before[m]
                aside[m] = ex[m] * place[box, 1, m] - ey[m] * place[box, 0, m]
                behind[m] = 1.0
            for m in range(count):
                least = min(before[m], after[m])
                if least < BEYOND_M + WIDTHS * BEYOND_WIDTH_M:
                    behind[m] = 1 / (1 + np.exp((BEYOND_M - before[m]) / BEYOND_WIDTH_M))
                    behind[m] /= 1 + np.exp((BEYOND_M - after[m]) / BEYOND_WIDTH_M)
            for m in range(count):
                rise = p[2, i, m] - z0
                offset = ex[m], ey[m], rise, before[m], after[m], aside[m], behind[m]
                first = moments[0, m], moments[1, m], moments[2, m]
                size = (up[m], *first, moments[3, m], moments[4, m], moments[5, m])
                field[i, m] += _dimming(offset, size, scale)
        for m in range(count):
            field[i, m] = 1 / np.sqrt(np.sqrt(max(1 + field[i, m], BRIGHTEST)))


def _dimming(ways: tuple[Real, ...], sizes: tuple[Real, ...], scale: tuple[float, float]) -> Any:
    """A^-4 - 1 of legs past a box, A being the field that is left; as `_field_past`."""
    left = _field_past(ways, sizes, scale)
    square = left * left
    return 1 / (square * square) - 1


def _field_past(ways: tuple[Real, ...], sizes: tuple[Real, ...], scale: tuple[float, float]) -> Any:
    """Field of legs past a box: of arrays, or of numbers, as machine code asks for it.

    Args:
        ways: Directions x and y, rise, distances before, after and aside of the legs (`Legs`), and
            the share of the shadow that is left by the distances before and after.
        sizes: Height of the box's centre above the antenna, and its second moments (`BodyBox`).
        scale: Height of the antenna, and wavelength, m.
    """
    ex, ey, rise, before, after, aside, behind = ways
    up, xx, yy, zz, xy, xz, yz = sizes
    antenna_height, wavelength = scale
    width = xx * ey * ey - 2 * xy * ex * ey + yy * ex * ex
    lean = (yz * ex - xz * ey) / zz
    turned = 1 / np.sqrt(1 + lean * lean)
    above = rise * before / (before + after) - up
    middle, half_height = antenna_height + up, np.sqrt(zz)
    below = middle - half_height
    bottom = 0.5 * (below + np.sqrt(below * below + 4 * FLOOR_M * FLOOR_M))
    half_width = np.sqrt(np.maximum(width - lean * lean * zz, 0.0)) * turned
    edges = half_width, middle + half_height, bottom
    place = (aside + lean * above) * turned, middle + above, before, after
    return field_past_box(edges, place, behind, wavelength)


def field_past_box(
    edges: tuple[Real, Real, Real],
    place: tuple[Real, Real, Real, Real],
    behind: Real,
    wavelength: float,
) -> Any:
    """Field of legs that pass an upright box, 1 where nothing is between.

    It is the root of the mean of |x + z - x z|^2, x and z being the fields past the sides and past
    top and bottom, of an absorbing screen each of whose edges is off by its own 1.5 cm.

    Args:
        edges: Half-width of the box, and heights of its upper and its lower edge, m; the latter is
            far below the floor of a box that stands on it.
        place: Horizontal distances of the box's middle to the left of the legs, heights of the legs
            where they pass, horizontal distances from the antenna to the box, and on to the end, m.
        behind: Shares of the shadow that are left by these distances.
        wavelength: Wavelength of the carrier, m.
    """
    half_width, top, bottom = edges
    aside, height, before, after = place
    v = _fresnel_scale(before, after, wavelength)
    p1, re1, im1 = _past_edge(half_width - aside, v)
    p2, re2, im2 = _past_edge(half_width + aside, v)
    x_power = p1 + p2 - p1 * p2 * (p1**3 + p2**3) + 2 * (re1 * re2 + im1 * im2)
    x_re, x_im = re1 + re2, im1 + im2
    slit = 2 * (v * bottom) ** 2
    slit = slit / (1 + slit)
    p3, re3, im3 = _past_edge(top - height, v)
    p4, re4, im4 = _past_edge(height - bottom, v)
    root = np.sqrt(slit)
    p4, re4, im4 = p4 * slit, re4 * root, im4 * root
    z_power = p3 + p4 - p3 * p4 * (p3**3 + p4**3) + 2 * (re3 * re4 + im3 * im4)
    z_re, z_im = re3 + re4, im3 + im4
    power = x_power * (1 - 2 * z_re + z_power) + z_power
    power += 2 * (x_re * (z_re - z_power) + x_im * z_im)
    end = _end_of_shadow(v)
    per_metre = 1 / (end - (6 / v + 0.01 * v))
    share = _step((half_width - np.abs(aside) + end) * per_metre)
    share *= _step((top - height + end) * per_metre) * _step((height - bottom + end) * per_metre)
    return 1 - share * behind * (1 - np.sqrt(np.maximum(power, LEAST_POWER)))


def _fresnel_scale(before: Real, after: Real, wavelength: float) -> Any:
    """Fresnel numbers per metre, v, of legs whose parts have some lengths (m)."""
    d1 = 0.5 * (before + np.sqrt(before * before + 0.01))
    d2 = 0.5 * (after + np.sqrt(after * after + 0.01))
    return np.sqrt(2 * (d1 + d2) / (wavelength * d1 * d2))


def _past_edge(inside: Real, v: Real) -> Any:
    """Mean power, and real and imaginary part of the mean field, some way (m) inside an edge."""
    t = np.minimum(v * inside, MOST)
    q = 0.5 * (t + np.sqrt(t * t + 0.65 + (0.03 * v) ** 2))
    square = q * q
    power = 1 / np.sqrt(1 + 4 * np.pi**4 * square * square)
    fringes = 0.002 * np.minimum(v, MOST) ** 2
    re, im = 1 + square * (fringes / 16), square * (1.65 / 16)
    re, im = re * re - im * im, 2 * re * im
    re, im = re * re - im * im, 2 * re * im
    re, im = re * re - im * im, 2 * re * im
    re, im = re * re - im * im, 2 * re * im
    scale = np.sqrt(power) / (re * re + im * im)
    return power, re * scale, -im * scale


def _end_of_shadow(v: Real) -> Any:
    """Distance (m) from an edge beyond which a shadow takes less than 3e-4 of a field."""
    return 8 / v + 0.015 * v


def _step(x: Real) -> Any:
    """Quintic step from 0 at x = 0 to 1 at x = 1, flat at both ends."""
    x = np.minimum(np.maximum(x, 0.0), 1.0)
    return x * x * x * (10 + x * (6 * x - 15))


PARTS = _dimming, _field_past, field_past_box, _fresnel_scale, _past_edge, _end_of_shadow, _step


def limit_shadow(two_way_field: Float) -> Float:
    """Factor [I, M] of a path's amplitude from the product of the fields of its legs [I, M].

    It is 1 for 1, and about LEAST for 0, as some field gets around a person.
    """
    factor: Float = np.hypot(two_way_field, LEAST) / np.hypot(1, LEAST)
    return factor
