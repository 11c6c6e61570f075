"""Runners, limpers, walkers with aids and loads, children and grown-ups, from a config."""

from typing import Any

import numpy as np
import pytest
from helpers.bodies import links_of

from radhar_cli.config import Config
from radhar_cli.config.checks.people import HUMAN_LIMITS
from radhar_cli.motion.activities.activity import activity_named
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.human.physique import Physique, froude_scale
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.walking import Gait, Walk
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.scene import Scene, draw_scene, nominal_scene, scene_numbers

GAITS = (
    *("running", "jogging_in_place", "limping"),
    *("walking_with_stick", "walking_with_walker", "carrying"),
)
SECTIONS = ("motion.running.", "motion.limping.", "motion.aids.", "motion.carrying.")
KEYS = [key for key in HUMAN_LIMITS if key.startswith(SECTIONS)]
T = np.arange(0.0, 4.0, 0.02)


def people(slug: str, **numbers: Any) -> Config:
    """Config of one class of 4 s, its numbers by dotted key with `__` for dots."""
    document: dict[str, Any] = {"duration_s": 4.0, "activities": [slug]}
    for key, value in numbers.items():
        *sections, name = key.split("__")
        inner = document
        for section in sections:
            inner = inner.setdefault(section, {})
        inner[name] = value
    return Config.model_validate(document)


def moving(scene: Scene) -> HumanMotion:
    motion = motion_of(scene.people[0])
    assert isinstance(motion, HumanMotion)
    return motion


def assert_limbs(motion: HumanMotion) -> None:
    p, length = motion.positions(T), np.linalg.norm(links_of(motion.person), axis=1)
    for joint in (JOINTS.index(name) for name in ("right_elbow", "left_hand", "right_ankle")):
        apart = np.linalg.norm(p[:, joint] - p[:, joint - 1], axis=0)
        np.testing.assert_allclose(apart, length[joint], atol=1e-9)
    assert p[2].min() > 0


@pytest.mark.every(4)
@pytest.mark.parametrize("slug", GAITS)
@pytest.mark.parametrize("stature", [1.0, 1.25, 2.1])
def test_draws_are_bodies(slug: str, stature: float) -> None:
    config = people(slug, subject__height_m=stature)
    for index in range(3):
        assert_limbs(moving(draw_scene(config, activity_named(slug), index)))


@pytest.mark.every(4)
@pytest.mark.parametrize("key", KEYS)
def test_the_ends_of_every_range(key: str) -> None:
    for slug in (slug for slug in GAITS if key in numbers_of(slug)):
        for end in HUMAN_LIMITS[key]:
            config = people(slug, **{key.replace(".", "__"): end})
            assert_limbs(moving(nominal_scene(config, activity_named(slug))))


@pytest.mark.parametrize("slug", ["limping", "walking_with_stick"])
@pytest.mark.parametrize("stature", [1.5, 2.1])
def test_who_hurries_with_a_painful_leg_keeps_above_the_floor(slug: str, stature: float) -> None:
    config = people(
        slug,
        subject__height_m=stature,
        motion__walking__speed_mps=2.3,
        motion__limping__pace=1.0,
        motion__limping__asymmetry=0.25,
        motion__aids__stick_pace=1.0,
    )
    motion = moving(nominal_scene(config, activity_named(slug)))
    assert_limbs(motion)
    assert motion.positions(T)[2].min() > 0.85 * motion.person.ankle


def numbers_of(slug: str) -> dict[str, float]:
    """Numbers that scenes of a class depend on."""
    return scene_numbers(nominal_scene(people(slug), activity_named(slug)))


def test_every_key_is_used_by_somebody() -> None:
    used = {key for slug in GAITS for key in numbers_of(slug)}
    assert set(KEYS) <= used


@pytest.mark.parametrize("slug", ["walking", "running"])
def test_speeds_that_the_config_does_not_say_follow_the_stature(slug: str) -> None:
    def speed(stature: float, **more: Any) -> float:
        config = people(slug, subject__height_m=stature, **more)
        return scene_numbers(nominal_scene(config, activity_named(slug)))[key]

    key = f"motion.{slug}.speed_mps"
    usual = speed(1.7)
    assert usual == pytest.approx({"walking": 1.3, "running": 3.3}[slug], abs=0.2)
    for stature in (1.0, 1.5, 2.1):
        assert speed(stature) == pytest.approx(usual * froude_scale(stature))
        said = {key.replace(".", "__"): 1.2}
        assert speed(stature, **said) == 1.2


@pytest.mark.parametrize(
    ("stature", "speed", "steps"), [(1.0, 0.95, 150), (1.2, 1.14, 143), (1.75, 1.3, 113)]
)
def test_children_step_as_often_as_measured(stature: float, speed: float, steps: float) -> None:
    """Steps a minute of children of 4 and 7 years (Sutherland et al. 1980), and of grown-ups."""
    walk = Walk(Gait(speed, period_scale=0.95)).part(Physique(stature), 0.0, 2.0)
    assert 120 / walk.stride == pytest.approx(steps, rel=0.1)


def test_a_child_weighs_less_and_has_shorter_legs() -> None:
    def weight(stature: float) -> float:
        config = people("walking", subject__height_m=stature)
        return float(nominal_scene(config, activity_named("walking")).config.subject.weight_kg)

    assert weight(1.0) == pytest.approx(15.5)
    assert weight(1.7) == pytest.approx(26 * 1.7**2)
    child, grown_up = Physique(1.0), Physique(1.7)
    assert child.leg / child.stature == pytest.approx(0.92 * grown_up.leg / 1.7)
    heights = [(body.tallest + body.trunk + body.neck) / body.stature for body in (child, grown_up)]
    assert heights[0] == pytest.approx(heights[1], abs=2e-3)


@pytest.mark.parametrize(
    "slug", [name for name, info in MOVEMENTS.items() if info.like == "walking"]
)
def test_slow_gaits_are_slower_than_walks(slug: str) -> None:
    config = people(slug, motion__walking__speed_mps=1.3, duration_s=6.0)
    p = moving(nominal_scene(config, activity_named(slug))).torso(np.array([1.5, 4.5]))
    if slug != "tripping":
        assert np.hypot(*(p[:2, 0, 1] - p[:2, 0, 0])) / 3 < 1.25


WALKS = ("walking", "limping", "walking_with_stick", "walking_with_walker", "carrying")


@pytest.mark.every(4)
@pytest.mark.parametrize("slug", WALKS)
@pytest.mark.parametrize("stature", [1.0, 1.4, 1.75, 2.1])
def test_knees_of_walkers_bend_as_those_of_people(slug: str, stature: float) -> None:
    """About 60 to 65 degrees in the swing; behind a walker a leg is never straighter than 15."""
    config = people(slug, subject__height_m=stature)
    largest, least = [], []
    for index in range(6):
        motion = moving(draw_scene(config, activity_named(slug), index))
        p, hips = motion.positions(T), motion.hip_joints(T)
        for side, name in enumerate(("right", "left")):
            knee, ankle = (p[:, JOINTS.index(f"{name}_{part}")] for part in ("knee", "ankle"))
            cosine = ((knee - hips[:, side]) * (ankle - knee)).sum(axis=0) / motion.person.leg**2
            flexion = np.degrees(np.arccos(cosine))
            largest.append(flexion.max())
            least.append(flexion.min())
    assert 56 < np.median(largest) < 71
    assert max(largest) < 79
    assert max(least) < 17
