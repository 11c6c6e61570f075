"""Images by the faces of a room, and what a bounce leaves of the field."""

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.radar.materials import permittivity
from radhar_cli.radar.propagation import Aim, Antennas, amplitude, boresight_axes, leg
from radhar_cli.radar.room import DIRECT_LEG, FACES, Face, Leg, names_of, reflected_legs

WAVELENGTH, GAIN = SPEED_OF_LIGHT / 2.5e9, 10**0.6
P = np.array([3.7, 0.8, 1.5])[:, None, None]
# delay in s, amplitude; of concrete, an inside radar and a vertical field
BY_ONE_FACE = {
    "-/-": (2.281876157750813e-08, 0.0009160531011728263),
    "-/floor": (2.569425198599854e-08, 0.00014479263245382171),
    "-/ceiling": (2.654588597976937e-08, 0.00016212041435758733),
    "-/right": (3.407636176384169e-08, -0.00020285660728893687),
    "-/left": (2.9093768461991034e-08, -0.00028333189009027167),
    "-/front": (2.5425427996256493e-08, -0.0002983160491606257),
    "-/back": (3.7975831099731146e-08, -0.00015511378238946684),
    "floor/-": (2.566297969404145e-08, 0.00014266183663041234),
    "right/-": (3.3341539982376924e-08, -0.00021245650939062457),
    "back/-": (3.7886921242330467e-08, -0.0001571969997388579),
}
# paths, sum of amplitudes, of amplitudes times delays: two bounces at most
SUMS = {
    ("inside", "vertical"): (85, 0.0013769065066887292, 5.114050633362481e-11),
    ("inside", "horizontal"): (85, 0.0007615825597140662, 2.8408106976778007e-11),
    ("before", "vertical"): (62, 0.000752396155530361, 3.189843433764021e-11),
    ("before", "horizontal"): (62, 0.0003131187347500443, 1.6028832545841593e-11),
}


def antennas(x: float = 0.4) -> Antennas:
    return Antennas((x, -0.1, 1.1), (x, 0.1, 1.1), GAIN, 0.0)


def box(polarisation: str = "vertical", material: str = "concrete") -> list[Face]:
    at = {"front": 0.0, "back": 6.0, "right": -2.5, "left": 2.5, "floor": 0.0, "ceiling": 2.8}
    normal = FACES["floor" if polarisation == "vertical" else "left"]
    eps = permittivity(material, 2.5e9)
    return [Face(name, FACES[name], at[name], eps, FACES[name] != normal) for name in FACES]


def seen(radar: Antennas, faces: list[Face], order: int) -> dict[str, tuple[float, float]]:
    """{kind: (delay, amplitude)} of one scatterer of 1 m^2."""
    found = {}
    for legs in [(DIRECT_LEG, DIRECT_LEG), *reflected_legs(faces, order, radar.tx[0] < 0)]:
        by = radar.by_way(*legs)
        r_tx, r_rx = leg(P, by.tx), leg(P, by.rx)
        a = amplitude(r_tx, r_rx, np.ones((1, 1)), GAIN, WAVELENGTH)
        field = by.field(P)
        a = a if field is None else a * field
        found[names_of(legs)] = ((r_tx + r_rx).item() / SPEED_OF_LIGHT, a.item())
    return found


def test_paths_by_one_face_are_the_contracts() -> None:
    found = seen(antennas(), box(), 1)
    assert len(found) == 13
    for kind, expected in BY_ONE_FACE.items():
        assert found[kind] == pytest.approx(expected, rel=1e-12, abs=0), kind


@pytest.mark.parametrize(("where", "polarisation"), SUMS)
def test_paths_by_two_faces_are_the_contracts(where: str, polarisation: str) -> None:
    found = seen(antennas(0.4 if where == "inside" else -0.6), box(polarisation), 2)
    count, total, moment = SUMS[where, polarisation]
    assert len(found) == count
    assert sum(a for _, a in found.values()) == pytest.approx(total, rel=1e-12, abs=0)
    assert sum(t * a for t, a in found.values()) == pytest.approx(moment, rel=1e-12, abs=0)


@pytest.mark.parametrize(
    ("x", "order", "count"), [(0.4, 0, 0), (0.4, 1, 12), (-0.6, 1, 10), (-0.6, 2, 61)]
)
def test_how_many_ways_there_are(x: float, order: int, count: int) -> None:
    assert len(list(reflected_legs(box(), order, x < 0))) == count


def test_a_floor_alone_has_three_images() -> None:
    floor = [face for face in box() if face.name == "floor"]
    kinds = [names_of(legs) for legs in reflected_legs(floor, 2, False)]
    assert sorted(kinds) == ["-/floor", "floor/-", "floor/floor"]


@given(st.integers(0, 84), st.floats(0.5, 5.5), st.floats(-2, 2), st.floats(0.1, 2.7))
def test_transmitter_and_receiver_may_change_places(
    number: int, x: float, y: float, z: float
) -> None:
    radar = antennas()
    other = Antennas(radar.rx, radar.tx, GAIN, 0.0)
    one = {
        names_of(legs): legs
        for legs in [(DIRECT_LEG, DIRECT_LEG), *reflected_legs(box(), 2, False)]
    }
    kind = sorted(one)[number]
    p = np.array([x, y, z])[:, None, None]
    (by, back) = radar.by_way(*one[kind]), other.by_way(*reversed(one[kind]))
    there, here = leg(p, by.tx) + leg(p, by.rx), leg(p, back.tx) + leg(p, back.rx)
    assert there == pytest.approx(here, rel=1e-12)
    fields = [np.ones(1) if one.field(p) is None else one.field(p) for one in (by, back)]
    assert fields[0] == pytest.approx(fields[1], rel=1e-12)


def test_a_metal_wall_behind_on_axis() -> None:
    """Delays 2x, 2X, 2X, 2 (2X - x) over c; amplitudes 1, twice -x/(2X - x), the square of that."""
    far, at = 6.0, 4.0
    radar = Antennas((0, 0, 1), (0, 0, 1), 1.0, 0.0)
    p, wall = np.array([at, 0, 1])[:, None, None], Face("back", 0, far, constant_reflection=-1.0)
    ratio = at / (2 * far - at)
    expected = {"-/-": (at, 1), "back/-": (far, -ratio), "back/back": (2 * far - at, ratio**2)}
    for legs in [(DIRECT_LEG, DIRECT_LEG), *reflected_legs([wall], 2, False)]:
        by = radar.by_way(*legs)
        r_tx, r_rx = leg(p, by.tx), leg(p, by.rx)
        field = 1.0 if by.field(p) is None else by.field(p).item()
        name = names_of(legs).replace("-/back", "back/-")
        found = ((r_tx + r_rx).item() / 2, at**2 / (r_tx * r_rx).item() * field)
        assert found == pytest.approx(expected[name], rel=1e-9), name


def test_reflections_at_45_degrees() -> None:
    """What is left of a field along the normal is the square of that of a parallel one."""
    cos45 = np.array([2**-0.5])
    along, parallel = (
        Face("floor", 2, 0.0, 5.24 + 0j, parallel).reflection_coefficient(cos45)[0]
        for parallel in (False, True)
    )
    assert along == pytest.approx(parallel**2)
    assert parallel == pytest.approx(-0.5097, abs=1e-4)


@given(st.floats(1e8, 1e11), st.floats(0.001, 1.0))
def test_no_bounce_gains(frequency: float, cosine: float) -> None:
    for parallel in (True, False):
        eps = permittivity("glass", frequency)
        face = Face("floor", 2, 0.0, eps, parallel)
        assert abs(face.reflection_coefficient(np.array([cosine]))[0]) <= 1


def test_an_image_and_the_antennas_image_are_as_far() -> None:
    faces = box()
    way = Leg((faces[1], faces[0], faces[2], faces[4]))
    a, p = (0.4, -0.1, 1.1), P[:, 0, 0]
    from_p = np.linalg.norm(p - np.array(way.antenna(a)))
    assert np.linalg.norm(way.image(P)[:, 0, 0] - np.array(a)) == pytest.approx(from_p)
    assert way.origin(way.antenna(a)) == pytest.approx(a)


def test_beam_at_half_its_width() -> None:
    half = np.sqrt(np.log(2) * 20 / (6 * np.log(10)))  # as scene/radar.py has it
    aim = Aim((0, 0, 1), boresight_axes(0.0, 0.0), (35 * half, 15 * half), 10 ** (-30 / 10))
    angle = np.radians(35)
    aside = np.array([np.cos(angle), np.sin(angle), 1])[:, None]
    assert 20 * np.log10(aim.two_way(aside))[0] == pytest.approx(-6, abs=1e-9)
    behind = np.array([-1.0, 0.2, 1])[:, None]
    assert 20 * np.log10(aim.two_way(behind))[0] == pytest.approx(-60, abs=1e-9)
    there = Antennas((0, 0, 1), (0, 0, 1), 1.0, 0.0, aim)
    left = Face("left", 1, 3.0, constant_reflection=1.0)
    mixed = there.by_way(DIRECT_LEG, Leg((left,))).field(np.array([4.0, 0, 1])[:, None])
    angle = np.arctan2(6, 4) * 180 / pi
    assert 20 * np.log10(mixed[0]) == pytest.approx(-min(12 * (angle / 70) ** 2, 30), abs=1e-9)
