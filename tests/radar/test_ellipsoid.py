"""Ellipsoids against closed forms: a sphere, broadside, end-on; tangent planes; shadows."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.radar.ellipsoid import (
    View,
    cross_section,
    rise,
    rise_of_number,
    shadow,
    square_height,
)

ASPECTS = np.cos(np.linspace(0, np.pi, 19))  # components of the line of sight along the axis
SIZES = st.floats(0.01, 1.0)


def view(along: np.ndarray, aside: float = 0.0, square: float = 1.0) -> View:
    return View(along, np.full_like(along, aside), np.full_like(along, square))


def sigma(along: np.ndarray, radius: float, half: float, reflectance: float = 1.0) -> np.ndarray:
    height = square_height(view(along), radius, half)
    return cross_section(height, radius, half, reflectance)


@given(radius=SIZES)
def test_a_sphere_echoes_its_disc_from_everywhere(radius):
    assert sigma(ASPECTS, radius, radius) == pytest.approx(np.pi * radius**2)


@given(radius=SIZES, half=SIZES)
def test_broadside_and_end_on(radius, half):
    """pi c^2 and pi r^4/c^2: pi times the product of the radii of curvature."""
    broadside, end_on = sigma(np.array([0.0, 1.0]), radius, half)
    assert broadside == pytest.approx(np.pi * half**2)
    assert end_on == pytest.approx(np.pi * radius**4 / half**2)


@given(radius=SIZES, half=SIZES, angle=st.floats(0, np.pi), length=st.floats(0.1, 2))
def test_the_nearest_tangent_plane(radius, half, angle, length):
    """h of a unit vector is the largest component of a point of the surface along it."""
    around = np.linspace(0, 2 * np.pi, 100_001)
    surface = half * np.cos(around) * np.cos(angle) + radius * np.sin(around) * np.sin(angle)
    seen = view(np.array(length * np.cos(angle)), square=length**2)
    assert np.sqrt(square_height(seen, radius, half)) == pytest.approx(length * surface.max(), 1e-6)


@given(radius=SIZES, half=SIZES, flatness=st.floats(1, 2))
def test_a_flat_body_seen_from_ahead_and_from_the_side(radius, half, flatness):
    """pi (b c/a)^2 with a the semi-axis towards the observer: f^4 more and f^4 less."""
    ahead, aside = (
        cross_section(
            square_height(view(np.zeros(1), one), radius, half, flatness), radius, half, 1
        )
        for one in (0.0, 1.0)
    )
    assert ahead == pytest.approx(np.pi * half**2 * flatness**4)
    assert aside == pytest.approx(np.pi * half**2 / flatness**4)


def test_the_reflectance_is_that_of_the_power():
    assert sigma(ASPECTS, 0.05, 0.2, 0.5) == pytest.approx(0.5 * sigma(ASPECTS, 0.05, 0.2))


FC77, FC2 = 299_792_458.0 / 77e9, 299_792_458.0 / 2e9


@pytest.mark.parametrize("wavelength", [FC77, FC2])
def test_a_shadow_falls_behind_and_inside(wavelength):
    """More, the nearer the ray is to the centre and the farther behind; nothing in front."""
    clearance = np.linspace(0, 9, 50)[:, None]
    behind = np.linspace(-1, 1, 50)
    field = shadow(clearance, behind, 0.14, wavelength)
    assert (np.diff(field, axis=0) >= 0).all()
    assert (np.diff(field, axis=1) <= 0).all()
    assert field[:, 0] == pytest.approx(1, abs=1e-9)
    assert field.min() >= 0.03
    assert field[0, -1] == field.min()


def test_a_trunk_hides_at_77_GHz_what_passes_around_it_at_2():
    behind = np.array(0.5)
    at_77, at_2 = (20 * np.log10(shadow(np.array(0.0), behind, 0.14, w)) for w in (FC77, FC2))
    assert at_77 < -20
    assert -12 < at_2 < -5


def test_a_shadow_has_no_infinities():
    far = np.array([-1e12, 0.0, 1e12])
    assert np.isfinite(shadow(np.array([[0.0], [1e30]]), far, 0.14, FC77)).all()


def test_the_compiled_edge_of_a_shadow():
    x = np.linspace(-40, 40, 2001)
    assert [rise_of_number(one) for one in x] == pytest.approx(rise(x), abs=1e-10)
