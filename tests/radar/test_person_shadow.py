"""The shadow of a person against an absorbing screen, the reference that it was fitted to."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import fresnel

from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.radar.person_shadow import HALF_WIDTH_M, LEAST, field_behind_person, limit_shadow

C = 299_792_458.0
ANTENNA, TOP = (0.0, 0.0, 1.2), 1.75
DISTANCES = [(2.5, 1.5), (1.5, 4.5), (4.0, 1.0), (3.0, 2.0)]
CARRIERS_HZ = [2e9, 5.8e9, 24e9, 60e9, 77e9]


def past_screen(p: Float, place: Float, wavelength: float) -> Complex:
    """Kirchhoff's field [n] past a screen at `place` [3], of legs from ANTENNA to p [3, n]."""

    def open_part(low: Float, high: Float) -> Complex:
        (s_low, c_low), (s_high, c_high) = fresnel(low), fresnel(high)
        found: Complex = (0.5 + 0.5j) * ((c_high - c_low) - 1j * (s_high - s_low))
        return found

    length = np.hypot(*p[:2])
    before = (p[0] * place[0] + p[1] * place[1]) / length
    aside = (p[0] * place[1] - p[1] * place[0]) / length
    height = ANTENNA[2] + (p[2] - ANTENNA[2]) * before / length
    v = np.sqrt(2 * length / (wavelength * before * (length - before)))
    across = open_part(v * (aside - HALF_WIDTH_M), v * (aside + HALF_WIDTH_M))
    field: Complex = 1 - across * open_part(-v * height, v * (TOP - height))
    return field


def behind(distances: tuple[float, float], aside: Float, carrier_hz: float) -> tuple[Float, Float]:
    """Echoes left of points behind a person: of the screen, and ours; and how far legs pass."""
    reach = sum(distances)
    p = np.array([np.full(aside.size, reach), aside * reach / distances[0], np.ones(aside.size)])
    place, wavelength = np.array([distances[0], 0.0, 1.2]), C / carrier_hz
    one_way = field_behind_person(
        p[:, None], ANTENNA, place[:, None, None], HALF_WIDTH_M, TOP, wavelength
    )[0]
    screen = limit_shadow(np.abs(past_screen(p, place, wavelength)) ** 2)
    return screen, limit_shadow(one_way**2)


@pytest.mark.parametrize(
    ("carrier_hz", "aside", "field"),
    [
        (2e9, 0.0, 0.26123742892389534 - 0.45363672452724557j),
        (2e9, 0.6, 1.055322592260418 + 0.1690141463586175j),
        (24e9, 0.15, -0.04322437291404646 - 0.20098291571604904j),
        (77e9, 0.3, 0.816660632705201 + 0.21904994412936288j),
    ],
)
def test_the_reference_is_that_of_others(carrier_hz: float, aside: float, field: complex) -> None:
    p, place = np.array([[4.0], [aside], [1.0]]), np.array([2.5, 0.0, 1.2])
    found = past_screen(p, place, C / carrier_hz)[0]
    assert found == pytest.approx(field, abs=1e-12)


@pytest.mark.parametrize("carrier_hz", CARRIERS_HZ)
@pytest.mark.parametrize("distances", DISTANCES)
def test_edges_and_depth_of_the_shadow(distances: tuple[float, float], carrier_hz: float) -> None:
    aside = np.linspace(0, 1.2, 601)
    screen, ours = behind(distances, aside, carrier_hz)
    edges = [aside[np.flatnonzero(left**2 > 0.5)[0]] for left in (screen, ours)]
    assert abs(edges[0] - edges[1]) < 0.04
    middle = aside < 0.1
    depth = 10 * np.log10(np.mean(ours[middle] ** 2) / np.mean(screen[middle] ** 2))
    assert -10.5 < depth < 0.8
    assert ours[-1] > 0.98


def at(x: float, y: float = 0.0, z: float = 1.0) -> Float:
    return np.reshape([x, y, z], (3, 1, 1)).astype(float)


@pytest.mark.parametrize(
    ("p", "place", "why"),
    [
        (at(2), at(3), "the other stands behind"),
        (at(2), at(-1), "behind the radar"),
        (at(4, 2), at(2, -1), "aside"),
        (at(3, 0, 4.5), at(2), "above the head"),
    ],
)
def test_who_is_not_between_hides_nothing(p: Float, place: Float, why: str) -> None:
    left = field_behind_person(p, ANTENNA, place, HALF_WIDTH_M, TOP, 0.0125)
    assert left[0, 0] == pytest.approx(1, abs=1e-3), why


def test_some_of_the_field_always_gets_around() -> None:
    left = limit_shadow(field_behind_person(at(4), ANTENNA, at(2), HALF_WIDTH_M, TOP, 0.004) ** 2)
    assert left[0, 0] == pytest.approx(LEAST, rel=1e-2)


places = st.tuples(st.floats(-20, 20), st.floats(-20, 20), st.floats(0, 3))


@given(places, places, st.sampled_from(CARRIERS_HZ))
def test_it_is_a_share_wherever_people_are(
    p: tuple[float, ...], place: tuple[float, ...], carrier_hz: float
) -> None:
    left = field_behind_person(at(*p), ANTENNA, at(*place), HALF_WIDTH_M, TOP, C / carrier_hz)
    assert 0 <= left[0, 0] <= 1
