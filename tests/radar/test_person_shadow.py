"""The shadow of a box against the absorbing screen that it stands for.

The screen's edges are off by normal errors of 1.5 cm, whose mean field and mean power are computed
here by quadrature of Fresnel's integrals.
"""

from typing import NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import fresnel

from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.radar.person_shadow import LEAST, field_past_box, limit_shadow

ERROR_M = 0.015  # of an edge, rms
NODES, WEIGHTS = np.polynomial.hermite_e.hermegauss(41)
# GHz; half-width, aside, height, top, bottom, before, behind (m); field, computed by others.
VECTORS = [
    ((77, 0.165, 0, 1, 1.75, -1e3, 2, 2), 0.084563),
    ((77, 0.165, 0.165, 1, 1.75, -1e3, 3, 1), 0.398640),
    ((77, 0.165, 0, 1.75, 1.75, -1e3, 4, 2), 0.451780),
    ((60, 0.2, 0.05, 1.2, 1.7, -1e3, 2.5, 2.5), 0.098589),
    ((24, 0.165, 0, 1, 1.75, -1e3, 4, 4), 0.219184),
    ((24, 0.14, 0.2, 0.9, 1.6, -1e3, 1, 5), 0.887431),
    ((10, 0.165, 0.1, 0.2, 0.25, -1e3, 2, 3), 0.580262),
    ((5.8, 0.165, 0, 1, 1.75, -1e3, 4, 2), 0.402308),
    ((5.8, 0.25, 0.12, 0.6, 0.9, 0.3, 1.5, 1.5), 0.274648),
    ((3, 0.165, 0, 1, 1.75, -1e3, 0.5, 0.5), 0.220606),
    ((2, 0.165, 0, 1, 1.75, -1e3, 4, 4), 0.668975),
    ((2, 0.165, 0.4, 1, 1.75, -1e3, 3, 0.05), 0.999313),
]


class Geometry(NamedTuple):
    """A leg past the middle of a box; lengths in m."""

    ghz: float
    half_width: float
    top: float
    height: float
    before: float
    behind: float

    def ours(self, aside: Float, height: Float | float | None = None) -> Float:
        height = self.height if height is None else height
        edges, place = (
            (self.half_width, self.top, -100.0),
            (aside, height, self.before, self.behind),
        )
        field: Float = field_past_box(edges, place, 1.0, 0.299792458 / self.ghz)
        return field

    def screen(self, aside: Float, height: Float | None = None) -> Float:
        """Root of the mean power past the screen."""
        wavelength, d1, d2 = 0.299792458 / self.ghz, self.before, self.behind
        height = np.full(aside.shape, self.height) if height is None else height
        v = np.sqrt(2 * (d1 + d2) / (wavelength * d1 * d2))
        first, left = past_edge(self.half_width - aside, v)
        second, right = past_edge(self.half_width + aside, v)
        z_power, z = past_edge(self.top - height, v)
        x_power, x = first + second + 2 * (left * right.conj()).real, left + right
        power = x_power * (1 - 2 * z.real + z_power) + z_power + 2 * (x * (z.conj() - z_power)).real
        root: Float = np.sqrt(power)
        return root


def past_edge(inside: Float, v: float) -> tuple[Float, Complex]:
    """Mean power and mean field past an edge that is off by normal errors."""
    t = v * (inside[:, None] + ERROR_M * NODES)
    sine, cosine = fresnel(t)
    field = (0.5 + 0.5j) * ((0.5 - cosine) - 1j * (0.5 - sine))
    weights = WEIGHTS / WEIGHTS.sum()
    return (np.abs(field) ** 2) @ weights, field @ weights


def random_geometries(count: int, seed: int) -> list[Geometry]:
    rng, drawn = np.random.default_rng(seed), []
    for _ in range(count):
        top = rng.uniform(0.25, 2)
        drawn.append(
            Geometry(
                np.exp(rng.uniform(np.log(2), np.log(77))),
                rng.uniform(0.1, 0.25),
                top,
                rng.uniform(0, top),
                rng.uniform(0.5, 8),
                rng.uniform(0.5, 8),
            )
        )
    return drawn


@pytest.mark.parametrize(("given_values", "field"), VECTORS)
def test_fields_are_those_of_others(given_values: tuple[float, ...], field: float) -> None:
    ghz, a, u, h, top, bottom, d1, d2 = given_values
    d2_share = 1 / (1 + np.exp((0.06 - d2) / 0.03))
    found = field_past_box((a, top, bottom), (u, h, d1, d2), d2_share, 0.299792458 / ghz)
    assert found == pytest.approx(field, abs=1.5e-6)


def test_the_middle_of_a_shadow_is_that_of_the_screen() -> None:
    aside = np.linspace(-0.03, 0.03, 31)
    errors_db = [
        10 * np.log10(np.mean(one.ours(aside) ** 2) / np.mean(one.screen(aside) ** 2))
        for one in random_geometries(400, 5)
    ]
    assert np.mean(np.abs(errors_db) < 3) > 0.97


def outermost_edge(field: Float, places: Float) -> float:
    """Outermost place at which a field is 1/2, from the light inwards."""
    crossing = np.flatnonzero((field[:-1] < 0.5) & (field[1:] >= 0.5))
    return float(places[crossing[-1]]) if crossing.size else np.nan


@pytest.mark.parametrize("edge", ["side", "top"])
def test_edges_of_a_shadow_are_those_of_the_screen(edge: str) -> None:
    errors = []
    for one in random_geometries(500, 6):
        if one.screen(np.zeros(1))[0] > 0.35:
            continue
        places = np.arange(0, 3, 0.002)
        zeros = np.zeros(places.shape)
        if edge == "side":
            fields = one.screen(places), one.ours(places)
        else:
            if one._replace(top=1e3).screen(np.zeros(1))[0] > 0.35:  # the sides alone
                continue
            places = one.height + places
            fields = one.screen(zeros, places), one.ours(zeros, places)
        errors.append(outermost_edge(fields[1], places) - outermost_edge(fields[0], places))
    assert len(errors) > 150
    assert np.mean(np.abs(errors) < 0.04) > 0.95


@given(
    st.sampled_from([2.0, 5.8, 24.0, 77.0]),
    st.floats(0.1, 0.25),
    st.floats(0.3, 8),
    st.floats(0.3, 8),
    st.floats(0, 3),
)
def test_shadows_end_without_a_step(
    ghz: float, half_width: float, before: float, behind: float, aside: float
) -> None:
    one = Geometry(ghz, half_width, 1.75, 1.0, before, behind)
    step = 1e-4
    field = one.ours(np.array([aside, aside + step]))
    assert abs(field[1] - field[0]) < 30 * step
    assert 0.01 < field[0] < 1.05


def test_some_of_the_field_always_gets_around() -> None:
    assert limit_shadow(np.zeros((1, 1)))[0, 0] == pytest.approx(LEAST, rel=1e-2)
    assert limit_shadow(np.ones((1, 1)))[0, 0] == 1
