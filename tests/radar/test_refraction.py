"""Rays refracted at the faces of the slab: Fermat, Snell, and unchanged special cases."""

from dataclasses import replace
from math import sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.radar.refraction import (
    inside_tangent,
    optical_excess,
    outside_tangent,
    refract,
)
from radhar_cli.radar.wall import Wall, crossing, extra_delay, plane_wave
from radhar_cli.radar.wall_rays import wall_delay

C = 299_792_458.0
WALL = Wall((1.0, 0.0, 1.25), (0.24, 5.0, 2.5), eps_r=6.0, loss_tangent=0.03, rays="refracted")
N = WALL.refractive_index.real
(NEAR, FAR), (RIGHT, LEFT), (LOW, TOP) = WALL.bounds
# A few roundings of lengths that are added up.
ROUNDING = 1e-14
Point = tuple[float, float, float]

indices = st.one_of(st.floats(1, 10), st.floats(0, 1e-3).map(lambda more: 1 + more))
outsides = st.one_of(st.floats(0.01, 10), st.floats(-9, -2).map(lambda e: 10**e))
depths = st.one_of(st.floats(0.01, 1), st.just(0.0), st.floats(-12, -2).map(lambda e: 10**e))
offsets = st.one_of(st.floats(0.01, 30), st.just(0.0), st.floats(-12, 0).map(lambda e: 10**e))


def solved(outside: float, depth: float, offset: float, n: float) -> tuple[float, float, float]:
    """t, t' and L - R of one ray."""
    a, d, rho = (np.array([x]) for x in (outside, depth, offset))
    t = outside_tangent(a, d, rho, n)
    excess = optical_excess(a, d, rho, t, n)
    return float(t[0]), float(inside_tangent(t, n)[0]), float(excess[0])


def late(antenna: Point, p: Point, wall: Wall = WALL) -> float:
    """Extra delay of one leg in metres of air."""
    return C * float(wall_delay(np.reshape(p, (3, 1, 1)).astype(float), antenna, wall)[0, 0])


@given(outsides, depths, offsets, indices)
@settings(deadline=None, max_examples=300)
def test_the_ray_arrives_and_obeys_snell(a: float, d: float, rho: float, n: float) -> None:
    """Angles measured from where it crosses: sin outside is n sin inside, at both faces."""
    t, inside, _ = solved(a, d, rho, n)
    assert a * t + d * inside == pytest.approx(rho, rel=ROUNDING, abs=0)
    sine, sine_inside = t / sqrt(1 + t * t), inside / sqrt(1 + inside * inside)
    assert sine == pytest.approx(n * sine_inside, rel=ROUNDING, abs=1e-300)


@given(outsides, depths, offsets, indices, st.floats(0, 1), st.floats(0, 1), st.floats(0, 1))
@settings(deadline=None, max_examples=300)
def test_no_other_way_is_shorter(
    a: float, d: float, rho: float, n: float, share: float, enters: float, leaves: float
) -> None:
    """Fermat: against the straight ray, and against any other two crossing points."""
    before, behind = a * share, a * (1 - share)
    distance = np.hypot(a + d, rho)
    excess = solved(a, d, rho, n)[2]
    assert 0 <= excess <= (n - 1) * d * distance / (a + d) * (1 + ROUNDING)
    y1, y2 = sorted((enters * rho, leaves * rho))
    other = np.hypot(before, y1) + n * np.hypot(d, y2 - y1) + np.hypot(behind, rho - y2)
    assert excess + distance <= other * (1 + ROUNDING)


@given(outsides, depths, offsets, indices)
@settings(deadline=None, max_examples=200)
def test_the_excess_is_the_optical_length_less_the_distance(
    a: float, d: float, rho: float, n: float
) -> None:
    t, inside, excess = solved(a, d, rho, n)
    length = a * sqrt(1 + t * t) + n * d * sqrt(1 + inside * inside)
    assert excess == pytest.approx(length - np.hypot(a + d, rho), rel=0, abs=ROUNDING * length)


@given(outsides, depths, offsets)
@settings(deadline=None, max_examples=100)
def test_a_wall_of_air_bends_nothing(a: float, d: float, rho: float) -> None:
    t, inside, excess = solved(a, d, rho, 1.0)
    assert t == inside == pytest.approx(rho / (a + d), rel=ROUNDING)
    assert excess == 0
    air = replace(WALL, eps_r=1.0, loss_tangent=0.0)
    assert late((0.4, -0.1, 1.5), (3.0, rho, 1.0), air) == 0


@given(st.floats(-5, 0.879), st.floats(0.88, 8))
@settings(deadline=None, max_examples=100)
def test_normal_incidence_is_the_straight_ray(at: float, x: float) -> None:
    """To a few units of the last place of the whole path."""
    antenna, p = (at, -0.1, 1.5), (x, -0.1, 1.5)
    straight = late(antenna, p, replace(WALL, rays="straight"))
    assert late(antenna, p) == pytest.approx(straight, rel=1e-15, abs=1e-15 * (x - at + 1))


def test_normal_incidence_by_hand() -> None:
    assert solved(1.36, 0.24, 0.0, N) == (0.0, 0.0, (N - 1) * 0.24)


def test_an_oblique_ray_by_hand() -> None:
    """45 degrees outside, sin = 1/sqrt 2; in glass of n = sqrt 2, 30 degrees inside."""
    n, inside = sqrt(2), 1 / sqrt(3)
    a, d = 2.0, 0.3
    t, found, excess = solved(a, d, a + d * inside, n)
    assert t == pytest.approx(1, rel=ROUNDING)
    assert found == pytest.approx(inside, rel=ROUNDING)
    length = a * sqrt(2) + n * d * 2 / sqrt(3)
    assert excess == pytest.approx(length - np.hypot(a + d, a + d * inside), rel=1e-13)


def test_the_slab_is_where_it_is_whichever_faces_a_ray_meets() -> None:
    """Through the side walls, the roof, from behind: the same ray turned has the same delay."""
    cube = replace(WALL, center=(0.0, 0.0, 0.0), size=(2.0, 2.0, 2.0))
    antenna, p = np.array([-3.0, 0.2, -0.1]), np.array([2.5, -0.3, 0.4])
    right = late(tuple(antenna), tuple(p), cube)
    assert right < late(tuple(antenna), tuple(p), replace(cube, rays="straight"))
    for order in ((1, 0, 2), (2, 1, 0), (1, 2, 0)):
        for sign in (1, -1):
            turned = (tuple(sign * way[list(order)]) for way in (antenna, p))
            assert late(*turned, cube) == pytest.approx(right, rel=ROUNDING)
    assert late(tuple(p), tuple(antenna), cube) == pytest.approx(right, rel=ROUNDING)


@pytest.mark.parametrize("z", [1.5, 0.7])
@pytest.mark.parametrize("y", [0.0, 1.7])
def test_a_scatterer_in_the_wall_or_on_a_face(y: float, z: float) -> None:
    """The delay rises from 0 at the near face to the far one, and jumps at neither."""
    antenna = (0.4, -0.1, 1.5)
    found = [late(antenna, (x, y, z)) for x in (NEAR, NEAR + 1e-9, 1.0, FAR, FAR + 1e-9)]
    assert found[0] == 0
    assert found[:4] == sorted(found[:4])
    assert found[1] == pytest.approx(0, abs=1e-8)
    assert found[4] == pytest.approx(found[3], abs=1e-8)
    rho = np.hypot(y + 0.1, z - 1.5)
    for x, d in ((1.0, 1.0 - NEAR), (FAR, FAR - NEAR)):
        assert late(antenna, (x, y, z)) == pytest.approx(solved(0.48, d, rho, N)[2], rel=1e-12)


@pytest.mark.parametrize("gap", [1e-9, 1e-6, 1e-3])
@pytest.mark.parametrize("x", [NEAR + 1e-9, 1.0, FAR, FAR + 1e-9, FAR + 1e-3])
@pytest.mark.parametrize("y", [0.0, 1e-9, 0.1, 0.1073, 0.108, 0.12, 2.4])
def test_grazing_rays_converge(gap: float, x: float, y: float) -> None:
    """Slowest at 0.1073 m = 0.24/sqrt(n^2 - 1), the farthest that the wall alone can reach."""
    straight = late((NEAR - gap, 0.0, 1.5), (x, y, 1.5), replace(WALL, rays="straight"))
    assert 0 <= late((NEAR - gap, 0.0, 1.5), (x, y, 1.5)) <= straight * (1 + ROUNDING)
    depth = min(x, FAR) - NEAR
    t, inside, _ = solved(gap + (x - NEAR - depth), depth, y, N)
    arrives = (gap + (x - NEAR - depth)) * t + depth * inside
    assert arrives == pytest.approx(y, rel=ROUNDING, abs=0)


@pytest.mark.parametrize(
    ("antenna", "p"),
    [
        ((0.4, 0.0, 2.4), (3.0, 0.0, 3.5)),  # over the wall
        ((0.4, 0.0, 1.5), (0.8, 0.0, 1.5)),  # before it
        ((0.4, 2.4, 1.0), (1.3, 2.55, 1.0)),  # around a corner: in by the face, out by the side
    ],
)
def test_misses_and_corners_stay_straight(antenna: Point, p: Point) -> None:
    assert late(antenna, p) == late(antenna, p, replace(WALL, rays="straight"))


def test_the_corner_case_is_one() -> None:
    """That the test above meets the wall at all."""
    assert late((0.4, 2.4, 1.0), (1.3, 2.55, 1.0)) > 0


def test_chord_and_faces_of_refracted_rays() -> None:
    """The chord is the one between the crossing points: shorter than the straight one."""
    antenna, p = (0.4, -0.1, 1.5), np.array([3.0, 2.0, 0.5])[:, None, None]
    straight = crossing(p, antenna, WALL)
    bent = refract(p, antenna, WALL, straight)
    t, inside, excess = solved(0.48 + 3.0 - FAR, FAR - NEAR, np.hypot(2.1, 1.0), N)
    assert bent.tangent[0, 0] == pytest.approx(t, rel=ROUNDING)
    assert bent.crossed.chord[0, 0] == pytest.approx(0.24 * sqrt(1 + inside**2), rel=1e-12)
    assert bent.crossed.chord[0, 0] < straight.chord[0, 0]
    assert bent.crossed.faces[0, 0] == 2
    assert bent.delay[0, 0] == pytest.approx(excess / C, rel=1e-12)
    assert bent.delay[0, 0] < extra_delay(straight.chord, WALL)[0, 0]


def test_a_ray_does_not_depend_on_those_beside_it() -> None:
    """Bit by bit: blocks of pulses may be cut anywhere."""
    rng = np.random.default_rng(3)
    p = rng.uniform((-1, -4, 0), (5, 4, 3), (6, 50, 3)).transpose(2, 0, 1)
    whole = wall_delay(p, (0.4, -0.1, 1.5), WALL)
    parts = [wall_delay(p[:, :, m : m + 1], (0.4, -0.1, 1.5), WALL) for m in range(50)]
    np.testing.assert_array_equal(np.concatenate(parts, axis=1), whole)


PLANE = replace(WALL, rays="plane")


@pytest.mark.parametrize(
    ("degrees", "straight", "plane"),
    [
        (0, 0.34794365589898896, 0.34794365589898896),
        (15, 0.3602177790770255, 0.35283092461126664),
        (30, 0.40177072679220754, 0.36772122540239954),
        (45, 0.4920666371140275, 0.39321332095440553),
        (60, 0.6958873117979778, 0.42997976554766876),
    ],
)
def test_delay_of_a_plane_wave(degrees: float, straight: float, plane: float) -> None:
    """Against numbers of another implementation, from both sides and up as well as across."""
    wall = replace(PLANE, center=(5.0, 0.0, 0.0), size=(0.24, 200.0, 200.0))
    turned = np.deg2rad(degrees)
    across = 10 * np.tan(turned)
    for p in ((10.0, across, 0.0), (10.0, 0.0, -across)):
        assert late((0.0, 0.0, 0.0), p, wall) == pytest.approx(plane, rel=1e-12)
        assert late(p, (0.0, 0.0, 0.0), wall) == pytest.approx(plane, rel=1e-12)
        as_straight = late((0.0, 0.0, 0.0), p, replace(wall, rays="straight"))
        assert as_straight == pytest.approx(straight, rel=1e-12)


@pytest.mark.parametrize(("reach", "most"), [(1.5, 5.3e-3), (1.75, 4.5e-3), (3.0, 2.5e-3)])
def test_a_plane_wave_is_almost_as_right_as_a_refracted_ray(reach: float, most: float) -> None:
    """To 45 degrees; straight rays are up to 96 mm off there."""
    angle = np.deg2rad(np.linspace(-45, 45, 91))
    p = reach * np.array([np.cos(angle), np.sin(angle), 0 * angle])[:, None]
    wall = replace(WALL, center=(0.5, 0.0, 0.0), size=(0.24, 50.0, 50.0))
    straight, plane, bent = (
        C * wall_delay(p, (0.0, 0.0, 0.0), replace(wall, rays=rays))
        for rays in ("straight", "plane", "refracted")
    )
    assert np.abs(plane - bent).max() < most
    assert 0.09 < np.abs(straight - bent).max() < 0.1


def test_chord_of_a_plane_wave() -> None:
    """Snell at the straight angle: sin inside = sin/n."""
    antenna, p = (0.4, -0.1, 1.5), (3.0, 2.0, 0.5)
    way = np.subtract(p, antenna)
    sine = np.sqrt(1 - (way[0] / np.linalg.norm(way)) ** 2) / N
    straight = crossing(np.reshape(p, (3, 1, 1)), antenna, PLANE)
    chord, _ = plane_wave(np.reshape(p, (3, 1, 1)), antenna, PLANE, straight)
    assert chord[0, 0] == pytest.approx(0.24 / np.sqrt(1 - sine * sine), rel=1e-12)


@pytest.mark.parametrize(
    ("antenna", "p"),
    [
        ((0.4, 0.0, 2.4), (3.0, 0.0, 3.5)),  # over the wall
        ((0.4, 0.0, 1.5), (0.8, 0.0, 1.5)),  # before it
        ((0.4, 0.0, 1.5), (1.0, 0.7, 1.2)),  # ends in it
        ((0.4, 2.4, 1.0), (1.3, 2.55, 1.0)),  # in by the face, out by the side
        ((1.0, -4.0, 1.0), (1.1, 4.0, 1.0)),  # lengthwise
    ],
)
def test_a_leg_that_does_not_pass_both_faces_stays_straight(antenna: Point, p: Point) -> None:
    assert late(antenna, p, PLANE) == late(antenna, p, replace(WALL, rays="straight"))


@pytest.mark.parametrize(("eps_r", "loss"), [(1.0, 0.0), (1.0, 1e12), (1e6, 0.0), (1e6, 1e12)])
def test_plane_waves_at_the_edges_of_the_material(eps_r: float, loss: float) -> None:
    wall = replace(PLANE, eps_r=eps_r, loss_tangent=loss)
    found = late((0.4, 0.0, 1.5), (3.0, 2.0, 0.5), wall)
    assert np.isfinite(found)
    assert 0 <= found <= late((0.4, 0.0, 1.5), (3.0, 2.0, 0.5), replace(wall, rays="straight"))
    assert (found == 0) == (eps_r == 1 and loss == 0)
