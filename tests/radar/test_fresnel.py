"""Faces at an angle: normal and grazing incidence, Brewster's angle, energy, reciprocity."""

from dataclasses import replace
from math import atan, cos, sin, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.radar.fresnel import Polarisation, face_factor, reflection
from radhar_cli.radar.wall import Wall, crossing, field_factor
from radhar_cli.radar.wall_rays import transmission

WALL = Wall((1.0, 0.0, 1.25), (0.24, 5.0, 2.5), eps_r=6.0, loss_tangent=0.03)
FC = 2e9
# A few complex products and a root.
ROUNDING = 1e-14
BOTH: tuple[Polarisation, ...] = ("perpendicular", "parallel")
both = pytest.mark.parametrize("polarisation", BOTH)
permittivities = st.builds(
    lambda eps_r, tangent: eps_r * (1 - 1j * tangent),
    st.one_of(st.floats(1, 100), st.floats(0, 30).map(lambda e: 10**e)),
    st.one_of(st.floats(0, 1), st.just(0.0), st.floats(0, 6).map(lambda e: 10**e)),
)


def factor(cosine: float, eps: complex, polarisation: Polarisation) -> float:
    return float(face_factor(np.array(cosine), eps, polarisation))


def gamma(cosine: float, eps: complex, polarisation: Polarisation) -> complex:
    return complex(reflection(np.array(cosine), eps, polarisation))


def left(antenna: tuple, p: tuple, wall: Wall) -> float:
    """Field left of one leg."""
    return float(transmission(np.reshape(p, (3, 1, 1)), antenna, wall, FC).factor[0, 0])


@both
def test_normal_incidence_is_that_of_the_wall(polarisation: Polarisation) -> None:
    eps = WALL.permittivity
    assert abs(gamma(1.0, eps, polarisation)) == pytest.approx(abs(WALL.reflection), rel=ROUNDING)
    face = sqrt(1 - abs(WALL.reflection) ** 2)
    assert factor(1.0, eps, polarisation) == pytest.approx(face, rel=ROUNDING)
    antenna, p = (0.4, 0.0, 1.2), (3.0, 0.0, 1.2)
    crossed = crossing(np.reshape(p, (3, 1, 1)), antenna, WALL)
    expected = float(field_factor(crossed, WALL, FC)[0, 0])
    for rays in ("straight", "plane", "refracted"):
        wall = replace(WALL, rays=rays, fresnel=polarisation)
        assert left(antenna, p, wall) == pytest.approx(expected, rel=ROUNDING)


@given(st.floats(1, 100))
@settings(deadline=None, max_examples=50)
def test_brewsters_angle(eps_r: float) -> None:
    """tan theta_B = n: no reflection of the parallel field, and of that alone."""
    cosine = cos(atan(sqrt(eps_r)))
    assert abs(gamma(cosine, eps_r, "parallel")) < ROUNDING * eps_r
    assert factor(cosine, eps_r, "parallel") == pytest.approx(1, abs=ROUNDING)
    across = (eps_r - 1) / (eps_r + 1)
    assert abs(gamma(cosine, eps_r, "perpendicular")) == pytest.approx(across, abs=ROUNDING)


@both
def test_grazing_incidence_lets_nothing_through(polarisation: Polarisation) -> None:
    eps = WALL.permittivity
    assert factor(0.0, eps, polarisation) == 0
    assert abs(gamma(0.0, eps, polarisation)) == pytest.approx(1, rel=ROUNDING)
    # As the root of the cosine: 4 cos Re(w)/|w|^2 and 4 cos Re(eps conj(w))/|w|^2.
    w = np.sqrt(eps - 1)
    x = eps if polarisation == "parallel" else 1
    expected = 2 * sqrt((x * w.conjugate()).real * 1e-12) / abs(w)
    assert factor(1e-12, eps, polarisation) == pytest.approx(expected, rel=1e-9)


@both
@given(st.one_of(st.just(0.0), st.floats(1e-100, 1)), permittivities)
@settings(deadline=None, max_examples=200)
def test_energy(polarisation: Polarisation, cosine: float, eps: complex) -> None:
    """What passes and what is reflected are all there is."""
    if eps == 1 and cosine == 0:
        return  # along a face of air: no face at all
    passed = factor(cosine, eps, polarisation)
    assert 0 <= passed <= 1 + ROUNDING
    assert passed**2 + abs(gamma(cosine, eps, polarisation)) ** 2 == pytest.approx(1, abs=ROUNDING)


@both
@given(st.floats(0.05, 1), st.floats(1.01, 100))
@settings(deadline=None, max_examples=100)
def test_a_face_without_loss_is_the_same_from_both_sides(
    polarisation: Polarisation, cosine: float, eps_r: float
) -> None:
    """Going out at the refracted angle, from a medium eps_r times as dense as what follows."""
    sine = sqrt(1 - cosine**2) / sqrt(eps_r)
    outwards = factor(sqrt(1 - sine**2), 1 / eps_r, polarisation)
    assert outwards == pytest.approx(factor(cosine, eps_r, polarisation), rel=1e-9)


def test_perpendicular_loses_more_than_parallel() -> None:
    """Between normal incidence and Brewster's angle one falls while the other rises."""
    angles = np.linspace(0.05, atan(sqrt(6.0)), 20)
    s = face_factor(np.cos(angles), 6.0, "perpendicular")
    p = face_factor(np.cos(angles), 6.0, "parallel")
    assert np.all(np.diff(s) < 0)
    assert np.all(np.diff(p) > 0)
    assert np.all(s < p)


@both
def test_each_face_at_its_own_angle(polarisation: Polarisation) -> None:
    """A straight ray around a corner enters at theta and leaves by the side at 90 - theta."""
    clear = replace(WALL, loss_tangent=0.0, fresnel=polarisation)
    theta = atan(0.15 / 0.9)
    expected = factor(cos(theta), 6.0, polarisation) * factor(sin(theta), 6.0, polarisation)
    for rays in ("straight", "plane", "refracted"):
        corner = left((0.4, 2.4, 1.0), (1.3, 2.55, 1.0), replace(clear, rays=rays))
        assert corner == pytest.approx(expected, rel=1e-12)


@both
def test_the_angle_is_that_of_the_ray_in_use(polarisation: Polarisation) -> None:
    """30 degrees in glass of n = sqrt 2 are 45 outside, where the straight ray has another."""
    glass = replace(WALL, center=(0, 0, 0), eps_r=2.0, loss_tangent=0.0, fresnel=polarisation)
    a, b = 1.0, 0.5
    antenna = (-0.12 - a, 0.0, 0.0)
    p = (0.12 + b, a + b + 0.24 / sqrt(3), 0.0)
    bent = left(antenna, p, replace(glass, rays="refracted"))
    assert bent == pytest.approx(factor(sqrt(0.5), 2.0, polarisation) ** 2, rel=1e-12)
    straight = (a + b + 0.24) / np.hypot(a + b + 0.24, p[1])
    assert left(antenna, p, glass) == pytest.approx(
        factor(straight, 2.0, polarisation) ** 2, rel=1e-12
    )


@both
@pytest.mark.parametrize("rays", ["straight", "plane", "refracted"])
def test_a_scatterer_inside_has_one_face_and_a_miss_has_none(
    polarisation: Polarisation, rays: str
) -> None:
    clear = replace(WALL, loss_tangent=0.0, rays=rays, fresnel=polarisation)
    one, two = (left((0.4, 0.0, 1.2), (x, 0.0, 1.2), clear) for x in (1.0, 3.0))
    assert two == pytest.approx(one**2, rel=ROUNDING)
    assert left((0.4, 0.0, 2.4), (3.0, 0.0, 3.5), clear) == 1


@both
def test_absorption_is_that_of_the_chord(polarisation: Polarisation) -> None:
    """Twice the loss, the same faces to first order: exp of the chord is what changes."""
    antenna, p = (0.4, -0.1, 1.5), np.array([3.0, 2.0, 0.5])[:, None, None]
    wall = replace(WALL, fresnel=polarisation)
    chord = float(crossing(p, antenna, wall).chord[0, 0])
    length = np.linalg.norm(p[:, 0, 0] - antenna)
    faces = factor(2.6 / length, wall.permittivity, polarisation) ** 2
    k0 = 2 * np.pi * FC / 299_792_458.0
    expected = faces * np.exp(-k0 * abs(wall.refractive_index.imag) * chord)
    assert left(antenna, tuple(p[:, 0, 0]), wall) == pytest.approx(expected, rel=1e-12)
