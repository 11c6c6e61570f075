"""Echo of an ellipsoid: cross section, nearest point, and the shadow behind it.

Seen along a unit vector with the components u, v, w along the semi-axes c, a, b, the tangent plane
nearest to the observer is h in front of the centre, h^2 = (a v)^2 + (b w)^2 + (c u)^2. Optics gives
sigma = |Gamma|^2 pi a^2 b^2 c^2/h^4 (Mahafza, Radar Systems Analysis and Design, section "RCS of
simple objects", ellipsoid), from the point that is h nearer than the centre. Here a = r f aside and
b = r/f, r the mean radius across and f the flatness, 1 for an ellipsoid of revolution.
Seen from two antennas, the bisector of the legs takes the place of the line of sight.

Every formula is of numbers, one ellipsoid at one instant, or of arrays. `fill_paths` is the loop
over numbers that `accelerators.py` compiles; what it calls is in this file, so that no change of a
formula leaves old machine code in use.
"""

from math import pi
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.numerics.constants import SPEED_OF_LIGHT

LEFT_IN_SHADOW = 0.03  # field deep in the shadow of a body, relative to none
PENUMBRA = 0.4  # width of the edge of a shadow over sqrt(wavelength * 1 m)
BEHIND, BEHIND_WIDTH = 0.06, 0.03  # start of a shadow behind its occluder, and transition, m
# Added to |u_tx + u_rx|^2, as scattering forwards has no aspect, and to lengths squared (m^2).
FORWARD, SMALLEST = 1e-9, 1e-30
BLOCK = 128  # instants at once in `fill_paths`: a processor's SIMD lanes many times over

# Rows of frames [FRAME_ROWS, ...]: centre (m, 3 rows), axis (3 rows), line of sight from between
# the antennas (m, 3 rows) and its length (m), length of the ellipsoid (m).
CENTRE, AXIS, SIGHT, SIGHT_LENGTH, LENGTH, FRAME_ROWS = 0, 3, 6, 9, 10, 11
# Rows of products [PRODUCT_ROWS, ...]: of the line of sight from the transmitter, then from the
# receiver, four rows each: squared distance, products with the frame's span, left and up.
SQUARE, ALONG, ASIDE, ABOVE = 0, 1, 2, 3
TX, RX = 0, 4
# Then squares of the frame's span and of its left; the strength sqrt(sigma)/(R_tx R_rx) of the echo
# for |Gamma| = 1, 1/m; and how much earlier it is than from the centre, s.
SQUARED_SPAN, SQUARED_LEFT, STRENGTH, EARLIER, PRODUCT_ROWS = 8, 9, 10, 11, 12
# Columns of points [I, 7]: factors of SQUARE to ABOVE, then of SQUARED_SPAN and
# SQUARED_LEFT, whose sum is a leg's squared delay (s^2); the factor from strength to amplitude.
PER_SQUARED_SPAN, PER_SQUARED_LEFT, PER_STRENGTH = 4, 5, 6

Number: TypeAlias = Any  # or an array of them
Vector: TypeAlias = tuple[Number, Number, Number]


class Frame(NamedTuple):
    """An ellipsoid as a frame of reference.

    Left and up are at right angles to the axis and to each other, as long as each other.
    """

    centre: Vector  # m
    span: Vector  # from start to end, m
    length: Number  # of the span, m
    axis: Vector  # unit vector along the span
    left: Vector
    up: Vector


class LineOfSight(NamedTuple):
    """Vector from an antenna to the centre of an ellipsoid, and products with it, m and m^2."""

    vector: Vector
    distance: Number  # length of the vector
    square: Number  # square of the distance
    along: Number  # product of the vector and the frame's span
    aside: Number  # product of the vector and the frame's left
    above: Number  # product of the vector and the frame's up


class View(NamedTuple):
    """Components of a vector towards the observer, of any length."""

    along: Number  # component along the axis
    aside: Number  # component across, where flat bodies are wide
    square: Number  # of the length


def dot(a: Vector, b: Vector) -> Number:
    """Scalar product a b."""
    product = a[0] * b[0]
    product += a[1] * b[1]
    product += a[2] * b[2]
    return product


def frame_of(start: Vector, end: Vector, beside: Vector, softness: float) -> Frame:
    """Frame of an ellipsoid between two ends, its left the side that `beside` is on.

    Left fades, as v/sqrt(|v|^2 + softness^2), where that direction is along the ellipsoid.

    Args:
        start: Beginning of the ellipsoid, m.
        end: End of the ellipsoid, m.
        beside: Direction beside it, of any length.
        softness: Length of `beside` across the axis below which left fades.
    """
    span = end[0] - start[0], end[1] - start[1], end[2] - start[2]
    length = np.sqrt(dot(span, span) + SMALLEST)
    axis = x, y, z = span[0] / length, span[1] / length, span[2] / length
    part = dot(beside, axis)
    left = beside[0] - part * x, beside[1] - part * y, beside[2] - part * z
    size = np.sqrt(dot(left, left) + softness * softness)
    left = u, v, w = left[0] / size, left[1] / size, left[2] / size
    centre = start[0] + 0.5 * span[0], start[1] + 0.5 * span[1], start[2] + 0.5 * span[2]
    return Frame(centre, span, length, axis, left, (y * w - z * v, z * u - x * w, x * v - y * u))


def line_of_sight(frame: Frame, antenna: Vector) -> LineOfSight:
    """Line of sight from an antenna at a position (m) to an ellipsoid, and products with it."""
    x, y, z = frame.centre
    sight = x - antenna[0], y - antenna[1], z - antenna[2]
    square, along = dot(sight, sight), dot(sight, frame.span)
    distance = np.sqrt(square + SMALLEST)
    return LineOfSight(sight, distance, square, along, dot(sight, frame.left), dot(sight, frame.up))


def echo_of(
    frame: Frame,
    tx: LineOfSight,
    rx: LineOfSight,
    radius: Number,
    flatness: Number,
    parts: Number,
) -> tuple[Number, Number]:
    """Echo of an ellipsoid from two antennas, by the bisector of the legs.

    Args:
        frame: Frame of the ellipsoid.
        tx: Line of sight from the transmitter.
        rx: Line of sight from the receiver.
        radius: Mean radius r across, m.
        flatness: Ratio f; the semi-axes across are r f and r/f.
        parts: Number n of parts along the axis, each with a point of its own.

    Returns:
        sqrt(sigma)/(R_tx R_rx) in 1/m for |Gamma| = 1; and by how much (m) both legs together are
        shorter to the surface of an n-th part than to its middle.
    """
    legs = tx.distance * rx.distance
    view = View(
        (tx.along / tx.distance + rx.along / rx.distance) / frame.length,
        tx.aside / tx.distance + rx.aside / rx.distance,
        2 + FORWARD + 2 * dot(tx.vector, rx.vector) / legs,
    )
    half = 0.5 * frame.length
    height = square_height(view, radius, half, flatness) / view.square
    nearer = np.sqrt(square_height(view, radius, half / parts, flatness))
    return np.sqrt(cross_section(height, radius, half, 1.0)) / legs, nearer


def square_height(view: View, radius: Number, half: Number, flatness: Number = 1.0) -> Number:
    """Square h^2 (m^2) of the height of the tangent plane, times |view|^2.

    Args:
        view: Viewing vector.
        radius: Mean radius r across, m.
        half: Semi-axis c along, m.
        flatness: Ratio f, 1 or more.
    """
    along, aside = view.along * view.along, view.aside * view.aside
    depth, width = radius / flatness, radius * flatness
    height = depth * depth * (view.square - along - aside) + half * half * along
    height += width * width * aside
    return height


def cross_section(
    square_height: Number, radius: Number, half: Number, reflectance: float
) -> Number:
    """Cross section sigma = |Gamma|^2 pi r^4 c^2/h^4 (m^2).

    Args:
        square_height: h^2 for a unit vector towards the observer, m^2.
        radius: Mean semi-axis r across, m.
        half: Semi-axis c along, m.
        reflectance: |Gamma|^2.
    """
    size = pi * reflectance * radius**4 * half**2
    return size / (square_height * square_height)


def clearance(
    end: Vector, sight: Vector, distance: Number, occluder: tuple[Vector, Vector, Number, Number]
) -> Number:
    """Clearance of a ray: (distance from an occluder's centre over that of its surface there)^2.

    Args:
        end: End of the ray, m.
        sight: Vector from the antenna to the end, m.
        distance: Length of that vector, m.
        occluder: Centre (m), axis, length and radius (m).

    Returns:
        1 where the ray touches the occluder, less where it passes through.
    """
    (x, y, z), axis, length, radius = occluder
    apart = x - end[0], y - end[1], z - end[2]
    # In lengths in which the occluder is a ball of radius 1.
    across = 1 / (radius * radius)
    stretch = 4 / (length * length) - across
    ray, gap = dot(sight, axis), dot(apart, axis)
    long = distance * distance * across + ray * ray * stretch
    near = dot(apart, sight) * across + ray * gap * stretch
    return dot(apart, apart) * across + gap * gap * stretch - near * near / long


def shadow(clearance: Number, behind: Number, radius: Number, wavelength: float) -> Number:
    """Field of a path whose ray passes an occluder and ends `behind` (m) it, 1 without a shadow.

    A logistic edge of width w, half the field at the edge, a tenth at 2.2 w behind it: as a knife
    edge 0.4 m in front has it, w = 2.5 cm at 77 GHz and 15 cm at 2 GHz. At a `clearance` of 1.
    """
    edge = 2 * PENUMBRA * np.sqrt(wavelength)
    # 1/(1 + exp(-x)) = (1 + tanh(x/2))/2, in a third of the time of scipy.special.expit
    covered = rise((1 - clearance) * (radius / (2 * edge)))
    field = covered * rise((behind - BEHIND) / (2 * BEHIND_WIDTH))
    field *= (LEFT_IN_SHADOW - 1) / 4
    field += 1
    return field


def rise(x: Float) -> Float:
    """1 + tanh(x)."""
    return 1 + np.tanh(x)


def rise_of_number(x: float) -> float:
    """1 + tanh(x) = 2/(1 + exp(-2 x)) to 1e-10, by products alone, which SIMD lanes share.

    For NaN it is 0.
    """
    r = max(-36.0, min(36.0, -2 * x)) / 128
    e = 1 + r / 6 * (1 + r / 7 * (1 + r / 8 * (1 + r / 9 * (1 + r / 10))))
    e = 1 + r * (1 + r / 2 * (1 + r / 3 * (1 + r / 4 * (1 + r / 5 * e))))
    for _ in range(7):
        e *= e
    return 2 / (1 + e)


def fill_paths(
    ends: tuple[Float, Float, Float],
    scene: tuple[Float, float, float],
    sizes: Float,
    occluders: Index,
    first: Index,
    points: Float,
    paths: tuple[Float, Float],
) -> None:
    """Fill in delays and amplitudes [I, M] of the points of S ellipsoids, seen through air.

    Args:
        ends: Starts, ends, and directions beside them [3, S, M], m.
        scene: Positions (m) of transmitter, receiver and of where shadows are seen from [3, 3], or
            of two such places [3, 4], of whose strengths the echo has the geometric mean;
            wavelength, m; softness.
        sizes: Radius (m), flatness and number of parts [S, 3].
        occluders: Numbers of the ellipsoids that throw shadows.
        first: Number of the first point of each ellipsoid, and I [S + 1].
        points: Factors [I, 7] that make squared delays and amplitudes of products.
        paths: Delays (s) and amplitudes [I, M], which are filled in.
    """
    # Loops are over whole blocks, so that every instant is computed in the same way.
    frames = np.empty((first.size - 1, FRAME_ROWS, BLOCK))
    products = np.empty((first.size - 1, PRODUCT_ROWS, BLOCK))
    block, strength = np.empty((9, BLOCK)), np.empty((first.size - 1, BLOCK))
    for start in range(0, ends[0].shape[2], BLOCK):
        count = min(BLOCK, ends[0].shape[2] - start)
        for s in range(first.size - 1):
            for row in range(9):
                block[row, :count] = ends[row // 3][row % 3, s, start : start + count]
                block[row, count:] = block[row, count - 1]
            size = sizes[s, 0], sizes[s, 1], sizes[s, 2]
            for m in range(BLOCK):
                fill_products(block, scene, size, frames[s], products[s], m)
        for place in range(2, scene[0].shape[1]):
            for s in range(first.size - 1):
                for m in range(BLOCK):
                    if place == 2:
                        strength[s, m] = products[s, STRENGTH, m]
                    else:
                        products[s, STRENGTH, m], strength[s, m] = (
                            strength[s, m],
                            products[s, STRENGTH, m],
                        )
                        look_from(frames[s], _vector(scene[0], place), m)
            for s in range(first.size - 1):
                for o in occluders:
                    if o != s and first[s] < first[s + 1]:
                        for m in range(BLOCK):
                            shade(frames[s], products[s], frames[o], sizes[o, 0], scene[1], m)
                if place > 2:
                    for m in range(BLOCK):
                        both = products[s, STRENGTH, m] * strength[s, m]
                        products[s, STRENGTH, m] = np.sqrt(both)
        for s in range(first.size - 1):
            for i in range(first[s], first[s + 1]):
                _fill_point(products[s], points[i], block)
                paths[0][i, start : start + count] = block[0, :count]
                paths[1][i, start : start + count] = block[1, :count]


def look_from(frames: Float, place: Vector, m: int | slice) -> None:
    """Let shadows on ellipsoids be seen from another place (m), at instants m.

    Args:
        frames: Frames [FRAME_ROWS, ...] of the ellipsoids.
        place: Place from which they are seen, m.
        m: Instants.
    """
    x, y, z = _vector(frames[CENTRE:], m)
    sight = x - place[0], y - place[1], z - place[2]
    frames[SIGHT, m], frames[SIGHT + 1, m], frames[SIGHT + 2, m] = sight
    frames[SIGHT_LENGTH, m] = np.sqrt(dot(sight, sight) + SMALLEST)


def fill_products(
    block: Float,
    scene: tuple[Float, float, float],
    size: Number,
    frames: Float,
    products: Float,
    m: int | slice,
) -> None:
    """Fill in frames of ellipsoids, and products of lines of sight with them, at instants m.

    Args:
        block: Starts, ends, and directions beside them [9, ...], m.
        scene: As in `fill_paths`.
        size: Radius (m), flatness and number of parts.
        frames: Rows [FRAME_ROWS, ...] to fill in.
        products: Rows [PRODUCT_ROWS, ...] to fill in.
        m: Instants.
    """
    frame = frame_of(_vector(block, m), _vector(block[3:], m), _vector(block[6:], m), scene[2])
    tx = line_of_sight(frame, _vector(scene[0], 0))
    rx = line_of_sight(frame, _vector(scene[0], 1))
    middle = line_of_sight(frame, _vector(scene[0], 2))
    products[TX + SQUARE, m], products[TX + ALONG, m] = tx.square, tx.along
    products[TX + ASIDE, m], products[TX + ABOVE, m] = tx.aside, tx.above
    products[RX + SQUARE, m], products[RX + ALONG, m] = rx.square, rx.along
    products[RX + ASIDE, m], products[RX + ABOVE, m] = rx.aside, rx.above
    products[SQUARED_SPAN, m] = frame.length * frame.length
    products[SQUARED_LEFT, m] = dot(frame.left, frame.left)
    products[STRENGTH, m], nearer = echo_of(frame, tx, rx, size[0], size[1], size[2])
    products[EARLIER, m] = nearer / SPEED_OF_LIGHT
    frames[CENTRE, m], frames[CENTRE + 1, m], frames[CENTRE + 2, m] = frame.centre
    frames[AXIS, m], frames[AXIS + 1, m], frames[AXIS + 2, m] = frame.axis
    frames[SIGHT, m], frames[SIGHT + 1, m], frames[SIGHT + 2, m] = middle.vector
    frames[SIGHT_LENGTH, m], frames[LENGTH, m] = middle.distance, frame.length


def shade(
    frames: Float,
    products: Float,
    occluder: Float,
    radius: float,
    wavelength: float,
    m: int | slice,
) -> None:
    """Weaken echoes of ellipsoids where another is in their way, at instants m.

    Args:
        frames: Frames [FRAME_ROWS, ...] of the ellipsoids that may be hidden.
        products: Their products [PRODUCT_ROWS, ...], whose row STRENGTH is weakened.
        occluder: Frame [FRAME_ROWS, ...] of the ellipsoid in their way.
        radius: Its radius, m.
        wavelength: Wavelength of the carrier, m.
        m: Instants.
    """
    body = _vector(occluder[CENTRE:], m), _vector(occluder[AXIS:], m), occluder[LENGTH, m], radius
    sight, distance = _vector(frames[SIGHT:], m), frames[SIGHT_LENGTH, m]
    clear = clearance(_vector(frames[CENTRE:], m), sight, distance, body)
    behind = distance - occluder[SIGHT_LENGTH, m]
    products[STRENGTH, m] *= shadow(clear, behind, radius, wavelength)


def _fill_point(products: Float, point: Float, paths: Float) -> None:
    """Fill in delays (s) and amplitudes of a point [2, BLOCK]."""
    square, along, aside, above = point[SQUARE], point[ALONG], point[ASIDE], point[ABOVE]
    span, left, share = point[PER_SQUARED_SPAN], point[PER_SQUARED_LEFT], point[PER_STRENGTH]
    for m in range(BLOCK):
        # What the squared delays of both legs have in common.
        common = span * products[SQUARED_SPAN, m] + left * products[SQUARED_LEFT, m]
        tx = square * products[TX + SQUARE, m] + along * products[TX + ALONG, m]
        tx = tx + aside * products[TX + ASIDE, m] + above * products[TX + ABOVE, m] + common
        rx = square * products[RX + SQUARE, m] + along * products[RX + ALONG, m]
        rx = rx + aside * products[RX + ASIDE, m] + above * products[RX + ABOVE, m] + common
        paths[0, m] = np.sqrt(max(tx, 0.0)) + np.sqrt(max(rx, 0.0)) - products[EARLIER, m]
        paths[1, m] = share * products[STRENGTH, m]


def _vector(rows: Float, m: int | slice) -> Vector:
    """First three rows [3, ...] at instants m."""
    return rows[0, m], rows[1, m], rows[2, m]


_SAME: tuple[Any, ...] = (dot, frame_of, line_of_sight, echo_of, square_height, cross_section)
_SAME += (clearance, shadow, fill_products, look_from, shade, _fill_point, _vector)
CALLED = (*zip(_SAME, _SAME, strict=True), (rise, rise_of_number))  # by `fill_paths`
