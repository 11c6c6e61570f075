"""Walls at their extremes: air, metal, a micrometre; an edge across a limb, a touched face."""

import math
from typing import Any

import numpy as np
import pytest
from helpers import reference as ref
from helpers.extreme_scenes import config_of, record, relative, signal

from radhar_cli.config import MAP_NAMES, Config
from radhar_cli.config.reading import validated
from radhar_cli.errors import ConfigError, SceneError
from radhar_cli.radar.wall import Wall, crossing
from radhar_cli.scene.products.run import Results

DIRECT_DB = -60.0
AIR = {"eps_r": 1, "loss_tangent": 0}
METAL = {"loss_tangent": 1e12}
ALL = [f"{kind}{name}" for name in MAP_NAMES for kind in ("", "image:")]

engines = pytest.mark.parametrize("engine", ["cube", "direct"])


def assert_finite(recording: Results) -> None:
    for name in MAP_NAMES:
        assert np.isfinite(recording[name].power).all()
        assert np.isfinite(recording[f"image:{name}"].entropy)


def test_a_wall_of_air_is_free_space() -> None:
    """eps = 1: no delay, no loss, no reflection."""
    free = signal(config_of("cube"))
    walled = signal(config_of("cube", wall=AIR))
    print(f"wall of air: cube {relative(walled, free):.1e}")
    assert relative(walled, free) < 1e-12
    assert ref.error_db(signal(config_of("direct", wall=AIR)), free) < DIRECT_DB


@engines
@pytest.mark.parametrize("wall", [METAL, METAL | {"eps_r": 1e6}, {"loss_tangent": 1e6}], ids=str)
def test_metal_lets_nothing_through(engine: str, wall: dict[str, Any]) -> None:
    """The field underflows to an exact zero: no echo, no NaN, no warning."""
    config = config_of(engine, wall=wall)
    found = record(config, "signal", *ALL)
    assert not found["signal"].x[0, 0].any()
    assert_finite(found)
    for name in MAP_NAMES:
        assert found[f"image:{name}"].entropy == 0
        assert not found[f"image:{name}"].levels.any()


@engines
def test_behind_metal_there_is_only_the_noise_that_the_snr_refers_to(engine: str) -> None:
    noisy = {"wall": METAL, "snr_db": 10.0}
    found = record(config_of(engine, **noisy, snr_reference="free_space"), *ALL)
    assert_finite(found)
    assert found["stft"].power.any()
    with pytest.raises(SceneError, match=r"power is 0; snr_db = 10 needs .*wall\.loss_tangent"):
        record(config_of(engine, **noisy, snr_reference="received"), "signal")


@engines
def test_losses_down_to_denormal_amplitudes(engine: str) -> None:
    """Losses that leave amplitudes of 1e-122 and less: still finite, and the engines agree."""
    for loss_tangent in (1.0, 2.0, 3.0):
        config = config_of(engine, wall={"loss_tangent": loss_tangent}, snr_db=0.0)
        assert_finite(record(config, *ALL))
    quiet = {"wall": {"loss_tangent": 1.0}}
    weak = signal(config_of("cube", **quiet))
    assert 0 < np.abs(weak).max() < 1e-100
    error = ref.error_db(signal(config_of("direct", **quiet)), weak)
    print(f"wall of loss tangent 1, amplitudes of {np.abs(weak).max():.0e}: direct {error:.0f} dB")
    assert error < DIRECT_DB


@pytest.mark.parametrize("thickness", [1e-6, 1e6])
def test_thinnest_and_thickest_walls(thickness: float) -> None:
    """A micrometre is two faces and hardly any chord; a wall of 1e6 m has the person inside."""
    wall = {"size_m": [thickness, 5, 2.5], "center_m": [1 + thickness / 2, 0, 1.25]}
    found = {engine: signal(config_of(engine, wall=wall)) for engine in ("cube", "direct")}
    assert np.abs(found["cube"]).max() > 0
    assert ref.error_db(found["direct"], found["cube"]) < DIRECT_DB


# A wall whose upper edge at 0.9 m, the height of the hip, hides the legs and leaves the rest.
HALF = Wall((1.0, 0.0, 0.45), (0.24, 5.0, 0.9), 6.0, 0.03)


def sampled_chord(p: np.ndarray, antenna: np.ndarray, wall: Wall, count: int) -> float:
    """Length of a ray inside the wall, by looking at `count` points of it."""
    s = (np.arange(count) + 0.5) / count
    ray = antenna[:, None] + s * (p - antenna)[:, None]
    return float(wall.contains(ray).mean() * np.linalg.norm(p - antenna))


def test_an_edge_that_crosses_a_limb() -> None:
    """Chords along a leg that hangs across the shadow's edge, against points counted on rays."""
    count, antenna = 20000, np.array([0.4, -0.1, 1.5])
    heights = np.linspace(0.0, 1.2, 25)
    p = np.stack([np.full(25, 2.0), np.full(25, 0.1), heights])[:, :, None]
    found = crossing(p, tuple(antenna), HALF)
    right = [sampled_chord(p[:, i, 0], antenna, HALF, count) for i in range(25)]
    error = np.abs(found.chord[:, 0] - right).max()
    print(f"edge across a limb: chords off by {error:.1e} m, the counting by {2 * 1.9 / count:.1e}")
    assert error < 2 * 2.3 / count  # one point of the ray at either end
    assert set(found.faces[:, 0]) == {0, 2}
    wall = {"center_m": list(HALF.center), "size_m": list(HALF.size)}
    free = signal(config_of("cube"))
    walled = signal(config_of("cube", wall=wall))
    assert 0.01 < relative(walled, free) < 1  # some of the body is hidden, not all of it
    assert ref.error_db(signal(config_of("direct", wall=wall)), walled) < DIRECT_DB


SLAB = Wall((1.0, 0.0, 1.25), (0.25, 5.0, 2.5), 6.0, 0.03)  # faces at exact binary numbers


@pytest.mark.parametrize(
    ("x", "chord", "faces"),
    [
        (math.nextafter(0.875, 0), 0.0, 0),
        (0.875, 0.0, 1),
        (math.nextafter(0.875, 1), 0.0, 1),
        (1.0, 0.125, 1),
        (math.nextafter(1.125, 1), 0.25, 1),
        (1.125, 0.25, 1),
        (math.nextafter(1.125, 2), 0.25, 2),
    ],
)
def test_a_scatterer_on_a_face(x: float, chord: float, faces: int) -> None:
    """The chord is continuous; a ray that ends on the far face has not left."""
    found = crossing(np.array([x, 0.0, 1.5]).reshape(3, 1, 1), (0.5, 0.0, 1.5), SLAB)
    assert found.chord[0, 0] == pytest.approx(chord, abs=1e-15)
    if x != 0.875:  # a touch of the near face is a chord of nothing: one face or none
        assert found.faces[0, 0] == faces


@engines
@pytest.mark.parametrize("face", [0.875, 1.125])
def test_a_person_on_a_face(engine: str, face: float) -> None:
    wall = {"center_m": list(SLAB.center), "size_m": list(SLAB.size)}
    motion = {"range_m": face, "angle_deg": 0.0}
    for activity in ("stationary", "walking"):
        config = config_of(engine, wall=wall, motion=motion, snr_db=20.0)
        assert_finite(record(config, *ALL, activity=activity))


TOUCHING = {
    "near face": [0.875, 0.0, 1.25],
    "far face": [1.125, 0.0, 1.25],
    "left side": [1.0, -2.5, 1.25],
    "right side": [1.0, 2.5, 1.25],
    "bottom": [1.0, 0.0, 0.0],
    "top": [1.0, 0.0, 2.5],
    "edge": [0.875, 2.5, 1.25],
    "corner": [0.875, 2.5, 2.5],
}
WALL = {"center_m": list(SLAB.center), "size_m": list(SLAB.size)}


@pytest.mark.parametrize("key", ["tx_m", "rx_m"])
@pytest.mark.parametrize("where", TOUCHING)
def test_an_antenna_that_touches_the_wall_is_refused(key: str, where: str) -> None:
    with pytest.raises(ConfigError, match=rf"radar.{key} = \[.*should be outside the wall"):
        validated(Config, {"radar": {key: TOUCHING[where]}, "wall": WALL}, "here", {})


@engines
@pytest.mark.parametrize(
    ("where", "axis", "towards"),
    [
        ("near face", 0, -1),
        ("far face", 0, 9),
        ("left side", 1, -9),
        ("right side", 1, 9),
        ("bottom", 2, -1),
        ("top", 2, 9),
    ],
)
def test_a_hairs_breadth_from_the_wall(engine: str, where: str, axis: int, towards: float) -> None:
    """The next double: the same as a nanometre away.

    24 GHz sees 1e-7 of a cycle of it; rays that run through the wall lengthwise stretch it.
    """
    signals = []
    for gap in (0.0, 1e-9):
        at = list(TOUCHING[where])
        at[axis] = math.nextafter(at[axis], towards) + math.copysign(gap, towards - at[axis])
        radar = {"tx_m": at, "rx_m": [at[0], at[1], at[2]]}
        config = config_of(engine, radar, wall=WALL, motion={"range_m": 3.0, "angle_deg": 0.0})
        found = record(config, "signal", *ALL)
        assert_finite(found)
        signals.append(found["signal"].x[0, 0])
    error = relative(signals[0], signals[1])
    print(f"hair's breadth from the {where}, {engine}: {error:.1e} from a nanometre away")
    assert error < 1e-4
