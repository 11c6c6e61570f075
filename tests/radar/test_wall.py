"""A slab crossed by straight rays: chords, faces, loss and delay."""

from dataclasses import replace
from math import log10, pi
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.echo.bodies.motion_paths import MotionPaths, point_delay
from radhar_cli.echo.paths import Paths
from radhar_cli.radar.propagation import Antennas
from radhar_cli.radar.wall import Crossing, Wall, crossing, extra_delay, field_factor

# The paper's table "Experimental Parameter Settings".
WALL = Wall(center=(1.0, 0.0, 1.25), size=(0.24, 5.0, 2.5), eps_r=6.0, loss_tangent=0.03)
FC = 2e9
C = 299_792_458.0
(NEAR, FAR), (RIGHT, LEFT), (_, TOP) = WALL.bounds
# A difference of numbers of order one, in doubles.
ROUNDING = 1e-14
Point = tuple[float, float, float]


def ray(antenna: Point, p: Point, wall: Wall = WALL) -> tuple[float, int]:
    """Chord and faces of one ray."""
    crossed = crossing(np.reshape(p, (3, 1, 1)).astype(float), antenna, wall)
    return float(crossed.chord[0, 0]), int(crossed.faces[0, 0])


def decibel(crossed: Crossing, wall: Wall = WALL) -> float:
    """Two-way loss of the power where both legs cross in the same way."""
    return -2 * 20 * log10(float(field_factor(crossed, wall, FC)))


def through(chord: float, faces: int) -> Crossing:
    return Crossing(np.array(chord), np.array(faces))


def test_the_papers_wall_costs_9_80_db() -> None:
    """Two ways, normal incidence, 2 GHz: chord 6.42 dB, faces 3.38 dB (docs/physics/model.md)."""
    assert decibel(through(0.24, 0)) == pytest.approx(6.42, abs=0.01)
    assert decibel(through(0.0, 2)) == pytest.approx(3.38, abs=0.01)
    crossed = crossing(np.array([[[2.0]], [[0.0]], [[1.2]]]), (0.4, 0.0, 1.2), WALL)
    assert decibel(Crossing(crossed.chord[0, 0], crossed.faces[0, 0])) == pytest.approx(
        9.80, abs=0.01
    )


def test_the_wall_by_hand() -> None:
    n = np.sqrt(6 - 0.18j)
    assert WALL.refractive_index == pytest.approx(n)
    assert WALL.refractive_index.imag < 0
    assert WALL.reflection == pytest.approx((1 - n) / (1 + n))
    # A wave inside decays as exp(-k0 |Im n| d) and is late by d (Re n - 1)/c.
    k0 = 2 * pi * FC / C
    face = 1 - abs((1 - n) / (1 + n)) ** 2
    for chord, faces in ((0.24, 2), (0.1, 1), (0.3, 2)):
        expected = np.exp(-k0 * abs(n.imag) * chord) * face ** (faces / 2)
        assert field_factor(through(chord, faces), WALL, FC) == pytest.approx(expected, rel=1e-13)
        late = chord * (n.real - 1) / C
        assert extra_delay(np.array(chord), WALL) == pytest.approx(late, rel=1e-13, abs=0)
    assert float(extra_delay(np.array(0.24), WALL)) == pytest.approx(1.1605e-9, rel=1e-3, abs=0)


def test_a_normal_ray_crosses_the_thickness_and_two_faces() -> None:
    chord, faces = ray((0.4, -0.1, 1.5), (2.0, -0.1, 1.5))
    assert chord == pytest.approx(0.24, abs=ROUNDING)
    assert faces == 2


def test_an_oblique_ray_has_the_longer_chord() -> None:
    """A 3-4-5 ray: 0.24 along x is 0.30 along the ray."""
    chord, faces = ray((0.0, -1.5, 1.0), (4.0, 1.5, 1.0))
    assert chord == pytest.approx(0.30, abs=ROUNDING)
    assert faces == 2


@pytest.mark.parametrize(
    ("antenna", "p"),
    [
        ((0.4, 0.0, 1.5), (0.8, 0.0, 1.5)),  # ends before the wall
        ((0.4, 0.0, 1.5), (-3.0, 0.0, 1.5)),  # turns its back on it
        ((2.0, 0.0, 1.5), (3.0, 0.0, 1.5)),  # starts behind it
        ((0.4, 0.0, 3.0), (3.0, 0.0, 3.0)),  # over it, level
        ((0.4, 0.0, 2.4), (3.0, 0.0, 3.5)),  # over it, rising
        ((0.4, 2.4, 1.0), (3.0, 5.0, 1.0)),  # past its side
        ((0.4, 0.0, 1.0), (0.4, 0.0, 1.0)),  # no ray at all
    ],
)
def test_a_ray_that_misses_is_untouched(antenna: Point, p: Point) -> None:
    assert ray(antenna, p) == (0.0, 0)
    assert field_factor(through(0.0, 0), WALL, FC) == 1
    assert extra_delay(np.array(0.0), WALL) == 0


@pytest.mark.parametrize(
    ("antenna", "p", "inwards", "chord"),
    [
        ((NEAR, -4.0, 1.0), (NEAR, 4.0, 1.0), (1, 0, 0), 5.0),
        ((FAR, -4.0, 1.0), (FAR, 4.0, 1.0), (-1, 0, 0), 5.0),
        ((0.4, LEFT, 1.0), (2.0, LEFT, 1.0), (0, -1, 0), 0.24),
        ((0.4, RIGHT, 1.0), (2.0, RIGHT, 1.0), (0, 1, 0), 0.24),
        ((0.4, 0.0, TOP), (2.0, 0.0, TOP), (0, 0, -1), 0.24),
    ],
)
def test_a_ray_along_a_face_is_untouched_and_one_beside_it_is_not(
    antenna: Point, p: Point, inwards: Point, chord: float
) -> None:
    assert ray(antenna, p) == (0.0, 0)
    beside = 1e-9 * np.array(inwards)
    found, faces = ray(tuple(antenna + beside), tuple(p + beside))
    assert found == pytest.approx(chord, abs=ROUNDING)
    assert faces == 2
    assert ray(tuple(antenna - beside), tuple(p - beside)) == (0.0, 0)


def test_a_ray_that_touches_an_edge_is_untouched() -> None:
    cube = Wall(center=(0.5, 0.5, 0.5), size=(1.0, 1.0, 1.0), eps_r=6.0, loss_tangent=0.03)
    assert ray((-1.0, 1.0, 0.5), (1.0, -1.0, 0.5), cube) == (0.0, 0)


@pytest.mark.parametrize(
    ("x", "chord", "faces"),
    [
        (NEAR - 1e-9, 0.0, 0),
        (NEAR, 0.0, 1),
        (1.0, 0.12, 1),
        (FAR, 0.24, 1),
        (FAR + 1e-9, 0.24, 2),
        (5.0, 0.24, 2),
    ],
)
@pytest.mark.parametrize("antenna_x", [0.4, -7.3])
def test_a_scatterer_in_the_wall_has_a_shorter_chord_and_one_face_less(
    x: float, chord: float, faces: int, antenna_x: float
) -> None:
    found, crossed = ray((antenna_x, 0.3, 1.1), (x, 0.3, 1.1))
    assert found == pytest.approx(chord, abs=ROUNDING)
    assert crossed == faces


def test_contains_counts_the_bounds_as_inside() -> None:
    p = np.array([[NEAR, FAR, 1.0, 1.0, NEAR - 1e-9], [0, LEFT, RIGHT, 0, 0], [0, TOP, 1, 3, 1]])
    np.testing.assert_array_equal(WALL.contains(p), [True, True, True, False, False])


def sampled(antenna: Point, p: Point, count: int) -> tuple[float, float]:
    """Chord by counting points on the ray that lie inside, and the length of one step."""
    s = (np.arange(count) + 0.5) / count
    points = np.asarray(antenna)[:, None] + s * np.subtract(p, antenna)[:, None]
    length = float(np.linalg.norm(np.subtract(p, antenna)))
    return float(WALL.contains(points).mean()) * length, length / count


def off_faces(low: float, high: float) -> st.SearchStrategy[float]:
    """Coordinates half a micrometre off any face; rays along and ends on faces stand above."""
    return st.integers(int(low * 1e6), int(high * 1e6)).map(lambda n: (n + 0.5) * 1e-6)


@given(
    st.tuples(off_faces(-1, 0.8), off_faces(-4, 4), off_faces(-1, 4)),
    st.tuples(off_faces(-1, 4), off_faces(-4, 4), off_faces(-1, 4)),
)
@settings(deadline=None, max_examples=150)
def test_the_chord_is_what_lies_of_the_ray_in_the_slab(antenna: Point, p: Point) -> None:
    expected, step = sampled(antenna, p, 4000)
    chord, faces = ray(antenna, p)
    assert chord == pytest.approx(expected, abs=2 * step)  # half a step at either end, and to spare
    if expected > 2 * step:
        assert faces == (1 if WALL.contains(np.array(p)) else 2)


@given(st.floats(0, 10), st.integers(0, 2))
@settings(deadline=None, max_examples=20)
def test_a_wall_of_air_is_none(chord: float, faces: int) -> None:
    air = replace(WALL, eps_r=1.0, loss_tangent=0.0)
    assert float(field_factor(through(chord, faces), air, FC)) == pytest.approx(1, rel=1e-12)
    assert float(extra_delay(np.array(chord), air)) == pytest.approx(0, abs=1e-12 / FC)


POINTS = np.array([[1.0, 1.5, 3.0], [0.0, -0.5, 1.0], [1.2, 1.0, 0.2]])
STILL = SimpleNamespace(
    breakpoints=(),
    highest_frequency=0.0,
    cross_sections=lambda t: np.array([[1.0], [0.5], [0.2]]),
    positions=lambda t: np.repeat(POINTS[:, :, None], t.size, axis=2),
)
ANTENNAS = Antennas(tx=(0.4, -0.1, 1.5), rx=(0.4, 0.1, 1.5), gain=4.0, isolation_db=10.0)


def paths(wall: Wall | None) -> Paths:
    return MotionPaths(STILL, ANTENNAS, FC, wall)(np.array([0.0, 1.0]))


def test_each_leg_of_a_path_crosses_by_itself() -> None:
    free, behind = paths(None), paths(WALL)
    for i, p in enumerate(POINTS.T):
        delay, factor = 0.0, 1.0
        for antenna in (ANTENNAS.tx, ANTENNAS.rx):
            chord, faces = ray(antenna, tuple(p))
            delay += chord * (WALL.refractive_index.real - 1) / C
            factor *= float(field_factor(through(chord, faces), WALL, FC))
        np.testing.assert_allclose(behind.delay[i] - free.delay[i], delay, rtol=1e-6)
        np.testing.assert_allclose(behind.amplitude[i], free.amplitude[i] * factor, rtol=1e-12)


@pytest.mark.parametrize("wall", [None, WALL])
def test_a_point_is_as_late_as_the_path_by_way_of_it(wall: Wall | None) -> None:
    p = STILL.positions(np.array([0.0, 1.0]))
    np.testing.assert_array_equal(point_delay(p, ANTENNAS, wall), paths(wall).delay)


@pytest.mark.parametrize(("eps_r", "loss_tangent"), [(1.0, 1e9), (1e30, 1e30), (1e30, 0.0)])
def test_a_wall_like_metal_lets_nothing_through(eps_r: float, loss_tangent: float) -> None:
    """Every warning is an error here, so the underflow must be silent."""
    metal = Wall(WALL.center, WALL.size, eps_r, loss_tangent)
    factor = float(field_factor(through(0.24, 2), metal, FC))
    if loss_tangent:
        assert factor == 0
    else:  # 1 - |Gamma|^2 = 4 n/(1 + n)^2, lost to cancellation if it were taken literally
        assert factor == pytest.approx(4e-15, rel=1e-12, abs=0)
    assert np.isfinite(float(extra_delay(np.array(0.24), metal)))
