"""The switches of the wall reach the paths, the torso's track and the survey alike."""

from dataclasses import replace

import numpy as np
import pytest
from radhar_cli.pipeline.body_paths import BodyPaths
from radhar_cli.pipeline.models import antennas_of, body_of, wall_of

from radhar_cli.activity import activity_named
from radhar_cli.config import Config
from radhar_cli.pipeline.validity import survey
from radhar_cli.radar.wall import Wall
from radhar_cli.scene import Scene, nominal_scene

BASE = {"radar": {"carrier_hz": 2e9, "bandwidth_hz": 1e9, "prf_hz": 128}, "wall": {}}
T = np.linspace(0, 4, 50)


def scene_and_config(**wall: object) -> tuple[Scene, Config]:
    config = Config.model_validate(BASE | {"wall": wall, "motion": {"range_m": 2.5}})
    return nominal_scene(config, activity_named("kicking")), config


def source(**wall: object) -> BodyPaths:
    scene, config = scene_and_config(**wall)
    slab = wall_of(scene, config)
    return BodyPaths(body_of(scene), antennas_of(scene), 2e9, slab, True)


def test_off_by_default() -> None:
    slab = source().wall
    assert slab == Wall((1, 0, 1.25), (0.24, 5, 2.5), 6, 0.03, rays="straight", fresnel="normal")


def test_refraction_makes_every_path_shorter_and_the_torsos_with_it() -> None:
    straight, bent = source(), source(rays="refracted")
    assert np.all(bent(T).delay < straight(T).delay)
    free = replace(straight, wall=None)
    normal = 2 * 0.24 * (np.sqrt(6 - 0.18j).real - 1) / 299_792_458.0
    assert np.all(bent(T).delay > free(T).delay + normal)
    np.testing.assert_array_equal(bent.torso_delay(T), bent(T).delay[0])


@pytest.mark.parametrize("polarisation", ["perpendicular", "parallel"])
def test_fresnel_changes_amplitudes_alone(polarisation: str) -> None:
    normal, angled = source(), source(fresnel=polarisation)
    np.testing.assert_array_equal(angled(T).delay, normal(T).delay)
    ratio = angled(T).amplitude / normal(T).amplitude
    assert np.all(ratio < 1 if polarisation == "perpendicular" else ratio > 1)
    np.testing.assert_array_equal(angled(T).power, normal(T).power)


def test_the_survey_looks_along_the_rays_in_use() -> None:
    """A half-band between the longest refracted and the longest straight delay."""
    bent, straight = (source(rays=rays)(T).delay.max() for rays in ("refracted", "straight"))
    slope = 10e6 / (bent + straight)  # c tau/2 = c fs/(4 K)
    for rays, leaves in (("refracted", False), ("straight", True)):
        scene, config = scene_and_config(rays=rays)
        values = dict(scene.values) | {"radar.bandwidth_hz": slope * 40e-6}
        assert survey(replace(scene, values=values), config).leaves_half_band == leaves
