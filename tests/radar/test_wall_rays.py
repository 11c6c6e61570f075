"""The switches of the wall reach the paths, the torso's track and the check of scenes."""

from dataclasses import replace

import numpy as np
import pytest

from radhar_cli.config import Config
from radhar_cli.echo.bodies.motion_paths import MotionPaths
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.radar.wall import Wall
from radhar_cli.scene.checks.flags import Flags
from radhar_cli.scene.checks.validity import check_scene
from radhar_cli.scene.products.run import record
from radhar_cli.scene.scene import Scene, nominal_scene

T = np.linspace(0, 4, 50)


def scene_of(bandwidth: float = 1e9, **wall: object) -> Scene:
    radar = {"carrier_hz": 2e9, "bandwidth_hz": bandwidth, "prf_hz": 128}
    document = {"radar": radar, "wall": wall, "motion": {"model": "paper", "range_m": 2.5}}
    return nominal_scene(Config.model_validate(document), activity_named("kicking"))


def source(**wall: object) -> MotionPaths:
    found: MotionPaths = record(scene_of(**wall), ["paths"])["paths"]
    return found


def test_off_by_default() -> None:
    slab = source().wall
    assert slab == Wall((1, 0, 1.25), (0.24, 5, 2.5), 6, 0.03, rays="straight", fresnel="normal")


@pytest.mark.parametrize(
    ("model", "rays"), [("paper", "straight"), ("human", "plane"), ("file", "plane")]
)
def test_rays_by_default(model: str, rays: str) -> None:
    classes = {"walking": {"files": ["walk.bvh"]}} if model == "file" else {}
    document = {"motion": {"model": model}, "wall": {}, "classes": classes}
    wall = Config.model_validate(document | {"activities": ["walking"]}).wall
    assert wall is not None
    assert wall.rays == rays


def test_refraction_makes_every_path_shorter_and_the_torsos_with_it() -> None:
    straight, bent = source(), source(rays="refracted")
    assert np.all(bent(T).delay < straight(T).delay)
    free = replace(straight, wall=None)
    normal = 2 * 0.24 * (np.sqrt(6 - 0.18j).real - 1) / 299_792_458.0
    assert np.all(bent(T).delay > free(T).delay + normal)
    track = record(scene_of(rays="refracted"), ["torso_track"])["torso_track"]
    np.testing.assert_array_equal(track, bent(np.arange(track.size) / 128).delay[0])


@pytest.mark.parametrize("polarisation", ["perpendicular", "parallel"])
def test_fresnel_changes_amplitudes_alone(polarisation: str) -> None:
    normal, angled = source(), source(fresnel=polarisation)
    np.testing.assert_array_equal(angled(T).delay, normal(T).delay)
    ratio = angled(T).amplitude / normal(T).amplitude
    assert np.all(ratio < 1 if polarisation == "perpendicular" else ratio > 1)


def test_the_check_of_a_scene_follows_the_rays_in_use() -> None:
    """A half-band between the longest refracted and the longest straight delay."""
    bent, straight = (source(rays=rays)(T).delay.max() for rays in ("refracted", "straight"))
    slope = 10e6 / (bent + straight)  # c tau/2 = c fs/(4 K)
    for rays, leaves in (("refracted", False), ("straight", True)):
        flags = check_scene(scene_of(slope * 40e-6, rays=rays)).flags
        assert (Flags.HALF_BAND in flags) == leaves
