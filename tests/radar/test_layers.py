"""Layered walls: transfer matrices of plane waves."""

from math import cos, log10, radians, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.radar.layers import Layer, Layers
from radhar_cli.radar.materials import NUMBERS
from radhar_cli.radar.wall import Crossing, Wall, field_factor

EPS_6 = (Layer(0.24, 6 - 0.18j),)
CONCRETE = (Layer(0.2, "concrete"),)
PLASTERBOARD = (Layer(0.0125, "plasterboard"), Layer(0.07, 1 + 0j), Layer(0.0125, "plasterboard"))
WALLS = {"EPS_6": EPS_6, "CONCRETE": CONCRETE, "PLASTERBOARD": PLASTERBOARD}
# wall, Hz, degrees, polarisation, T, R, H: a twelfth of a reference's cases
REFERENCE = """
EPS_6 1e09 0 te 0.7304224050478+0.234708814348j
    -0.1904021450343+0.1440556461491j 0.451096502022-0.6205780073383j
EPS_6 2e09 0 te 0.5038032718793+0.3201994074276j
    -0.3324539012089+0.1556646979988j -0.2155078347023-0.5566882165586j
EPS_6 2.5e09 0 tm 0.4122181938386+0.3354169184991j
    -0.3797329681292+0.1409425170581j 0.4092846667739+0.3389902802305j
EPS_6 3e09 0 tm 0.3328180963635+0.3402314000069j
    -0.4137549383061+0.120911252401j -0.4683816773528-0.08452156611107j
PLASTERBOARD 1e09 30 te -0.5942769408023-0.7401400208385j
    0.05657199820856-0.06893347246358j 0.8223039705737-0.4741186695279j
PLASTERBOARD 2e09 30 te -0.3168831780749+0.6052781096387j
    -0.6185426256839-0.2622211503161j 0.4849880694835-0.4812100487453j
PLASTERBOARD 2.5e09 30 tm 0.4260553560719+0.7866815036695j
    -0.268905346383+0.1541565266965j 0.5575258430503-0.6996827059349j
PLASTERBOARD 3e09 30 tm 0.8655957862634-0.1192778211219j
    -0.08204563513275-0.2517422295197j 0.2778294677671-0.8284286635847j
CONCRETE 1e09 60 te -0.2304113322256-0.1661454781252j
    -0.5851177492637+0.09707039968324j 0.2592604696505-0.1160935433004j
CONCRETE 2e09 60 te 0.06775800614817+0.133012978246j
    -0.6319485527446+0.04395323641562j 0.08167629385213-0.1249503213346j
CONCRETE 2.5e09 60 tm -0.1781409221256+0.04964285065269j
    -0.1044523760363+0.02393609043125j -0.046727374088+0.1789277878574j
CONCRETE 3e09 60 tm -0.001005553268089-0.1428757126723j
    -0.1092216700743+0.02619431865277j -0.0003840708444168-0.1428787349419j
"""
CASES = [
    (WALLS[wall], float(f), float(deg), kind, *map(complex, rest))
    for wall, f, deg, kind, *rest in zip(*[iter(REFERENCE.split())] * 7, strict=True)
]


def one(value: float) -> np.ndarray:
    return np.array(float(value))


@pytest.mark.parametrize(("layers", "f", "deg", "kind", "t", "r", "h"), CASES)
def test_coefficients_are_those_of_the_reference(layers, f, deg, kind, t, r, h) -> None:
    wall = Layers(layers, parallel=kind == "tm")
    found, cosine = (
        wall.scattering_coefficients(one(f), np.cos(np.radians(one(deg)))),
        np.cos(radians(deg)),
    )
    assert abs(found.transmitted - t) < 1e-12
    assert abs(found.reflected - r) < 1e-12
    assert abs(wall.transfer_function(one(f), one(cosine)) - h) < 1e-12


layer = st.builds(Layer, st.floats(1e-3, 0.5), st.floats(1, 12).map(complex))


@given(
    st.lists(layer, min_size=5, max_size=5), st.floats(1e8, 1e11), st.floats(0.02, 1), st.booleans()
)
def test_without_loss_no_power_is_lost(several, f, cosine, parallel) -> None:
    t, r = Layers(tuple(several), parallel).scattering_coefficients(one(f), one(cosine))
    assert abs(t) ** 2 + abs(r) ** 2 == pytest.approx(1, abs=1e-12)


def test_windows_of_half_and_quarter_a_wave() -> None:
    f, eps = one(3e9), 4.0
    wave = SPEED_OF_LIGHT / 3e9 / sqrt(eps)
    half = Layers((Layer(wave / 2, complex(eps)),), False).scattering_coefficients(f, one(1))
    quarter = Layers((Layer(wave / 4, complex(eps)),), False).scattering_coefficients(f, one(1))
    assert abs(half.reflected) < 1e-12
    assert abs(quarter.reflected) == pytest.approx((eps - 1) / (eps + 1), abs=1e-12)


def test_the_second_pass_is_21_dB_below_the_first() -> None:
    # Wiggles of T over frequency are the passes: those of the paper's wall at 2 GHz, one leg.
    n = np.sqrt(6 - 0.18j)
    f = np.linspace(1e9, 3e9, 4001)[:-1] + 0.25e6
    t = Layers(EPS_6, False).scattering_coefficients(f, one(1)).transmitted
    single = 4 * n / (1 + n) ** 2 * np.exp(-2j * np.pi * f * n * 0.24 / SPEED_OF_LIGHT)
    second = ((n - 1) / (n + 1)) ** 2 * np.exp(-4j * np.pi * f * n * 0.24 / SPEED_OF_LIGHT)
    at_2 = np.abs(f - 2e9).argmin()
    assert 20 * log10(abs(second[at_2])) == pytest.approx(-21.48, abs=0.02)
    assert t == pytest.approx(single / (1 - second), abs=1e-12)


def test_over_a_band_and_both_ways_it_is_15_dB_below_and_59_cm_behind() -> None:
    f, away = np.linspace(1e9, 3e9, 400), np.linspace(0, 1.5, 1501)
    turn = np.exp(4j * np.pi / SPEED_OF_LIGHT * f * away[:, None])
    both = Layers(EPS_6, False).transfer_function(f, np.ones(1)) ** 2
    level = 20 * np.log10(np.abs(turn @ (np.hanning(f.size) * both)))
    first = int(level.argmax())
    behind = first + 400 + int(level[first + 400 : first + 800].argmax())
    assert level[behind] - level[first] == pytest.approx(-15.2, abs=0.1)
    assert away[behind] - away[first] == pytest.approx(0.59, abs=0.005)


def test_where_nothing_comes_back_it_is_the_loss_at_the_carrier() -> None:
    # 1 m with a loss tangent of 0.1 swallows what is reflected inside.
    thick = Wall((2.0, 0.0, 0.0), (1.0, 9.0, 9.0), 6.0, 0.1)
    loss = field_factor(Crossing(one(1.0), np.array(2)), thick, 2e9)
    left = Layers((Layer(1.0, thick.permittivity),), False).transfer_function(one(2e9), one(1))
    assert 20 * log10(abs(left) / loss) == pytest.approx(0, abs=0.02)


@pytest.mark.parametrize("parallel", [False, True])
def test_both_polarisations_are_one_at_normal_incidence(parallel) -> None:
    both = [
        Layers(PLASTERBOARD, kind).scattering_coefficients(one(5e9), one(1))
        for kind in (False, parallel)
    ]
    assert both[0].transmitted == pytest.approx(both[1].transmitted, abs=1e-13)
    assert both[0].reflected == pytest.approx(both[1].reflected, abs=1e-13)


@given(
    st.sampled_from([*NUMBERS]),
    st.floats(1e-6, 1e3),
    st.floats(1e6, 1e13),
    st.floats(1e-6, 1),
    st.booleans(),
)
def test_extremes_stay_finite_and_passive(material, thickness, f, cosine, parallel) -> None:
    t, r = Layers((Layer(thickness, material),), parallel).scattering_coefficients(
        one(f), one(cosine)
    )
    assert np.isfinite([t, r]).all()
    assert abs(t) ** 2 + abs(r) ** 2 <= 1 + 1e-9


def test_air_is_no_wall() -> None:
    air, f = Layers((Layer(0.3, 1 + 0j),), False), np.linspace(1e9, 2e9, 5)
    assert air.transfer_function(f, one(cos(0.7))) == pytest.approx(1, abs=1e-12)
