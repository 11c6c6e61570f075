"""Where people are: at their place at one instant, on a course that the scene leaves room for."""

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from radhar_cli.config import Config, load_config
from radhar_cli.motion.activities.activity import ACTIVITIES, activity_named
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.checks.validity import check_scene
from radhar_cli.scene.motion import moving
from radhar_cli.scene.place import NEAREST_M, distance_ahead, zone_of
from radhar_cli.scene.radar import antennas_of
from radhar_cli.scene.scene import draw_scene, scene_numbers

SLUGS = [activity.slug for activity in ACTIVITIES]
MOVING = SLUGS[7:]
KEYS = "range_m", "instant"
QUICKSTART = Path(__file__).parents[2] / "configs" / "quickstart.yaml"
ROOM = {
    "radar": {"tx_m": [0.2, -0.02, 1.5], "rx_m": [0.2, 0.02, 1.5]},
    "motion": {"place": {"range_m": {"uniform": [2, 8]}}, "walking": {"speed_mps": 0.7}},
    "room": {
        "box_m": {"x": [0, 9], "y": [-3, 3], "height": 2.6},
        "faces": {"floor": "concrete"},
    },
}
SURROUNDINGS: dict[str, dict[str, Any]] = {
    "free space": {},
    "wall": {"wall": {"center_m": [1, 0, 1.25], "size_m": [0.24, 5, 2.5]}},
    "short band": {"radar": {"bandwidth_hz": 2.5e9}},
    "room": ROOM,
}


@pytest.mark.parametrize("slug", SLUGS)
def test_people_are_at_their_place_at_one_instant(slug: str) -> None:
    config, t = Config(), np.linspace(0, 6, 601)
    for index in range(10):
        person = draw_scene(config, activity_named(slug), index).people[0]
        place = np.array(person.place)[:, None]
        assert 2 <= place[0] <= 8
        away = np.hypot(*(moving(person).torso(t)[:2, 0] - place))
        assert away.min() < (0.03 if slug in MOVING else 0.6)


@pytest.mark.parametrize("around", SURROUNDINGS)
def test_first_draws_have_room(around: str) -> None:
    """Rejected draws would tell what people do by where they are."""
    config, rejected = Config.model_validate(SURROUNDINGS[around]), 0
    for slug in SLUGS:
        for index in range(12):
            scene = draw_scene(config, activity_named(slug), index)
            rejected += check_scene(scene).invalid is not None
    assert rejected <= (14 if around == "room" else 3)


def test_walkers_keep_clear_of_the_radar() -> None:
    t, config = np.linspace(0, 6, 121), Config(motion={"place": {"range_m": 2}})
    for slug in MOVING:
        for index in range(20):
            scene = draw_scene(config, activity_named(slug), index)
            torso = moving(scene.people[0]).torso(t)[:, 0]
            assert distance_ahead(torso, antennas_of(scene)).min() > NEAREST_M - 0.05


@pytest.mark.parametrize("heading", [0, 180])
def test_the_instant_goes_from_the_near_to_the_far_end(heading: int) -> None:
    """Who walks away from the radar is there first, or last; who approaches, last or first."""
    config = {"motion": {"angle_deg": heading, "place": {"range_m": 9, "cross_range_m": 0}}}
    t, walking = np.linspace(0, 6, 601), activity_named("walking")
    instants = []
    for instant in (0.0, 0.5, 1.0) if heading == 0 else (1.0, 0.5, 0.0):
        config["motion"]["place"]["instant"] = instant
        x = moving(draw_scene(Config.model_validate(config), walking, 0).people[0]).torso(t)[0, 0]
        instants.append(float(t[np.abs(x - 9).argmin()]))
    assert instants[0] < (0.1 if heading == 0 else 0.3)  # who is about to walk sways
    assert instants[0] + 0.5 < instants[1] < instants[2] - 0.5


def test_who_walks_is_where_others_are_at_a_random_instant() -> None:
    """Before, walkers were 1.5 m farther away, at a distance of 0.3 (Kolmogorov-Smirnov)."""
    config, t = load_config(QUICKSTART), np.linspace(0, 6, 31)
    ranges = {}
    for slug in ("punching", "walking", "sitting_to_walking", "walking_to_falling"):
        people = [draw_scene(config, activity_named(slug), index).people[0] for index in range(150)]
        ranges[slug] = np.sort(
            [np.hypot(*moving(one).torso(t)[:2, 0]) for one in people], axis=None
        )
    at = np.linspace(0, 20, 401)
    shares = {slug: np.searchsorted(r, at) / r.size for slug, r in ranges.items()}
    for slug, share in shares.items():
        assert np.abs(share - shares["punching"]).max() < 0.16, slug
        assert abs(ranges[slug].mean() - ranges["punching"].mean()) < 0.5, slug


def test_the_instant_follows_the_range_and_chance_alike() -> None:
    """A scene that is written holds the number, and needs no law to be simulated again."""
    config = Config()
    drawn = np.array(
        [
            [scene_numbers(draw_scene(config, one, index))[f"motion.place.{key}"] for key in KEYS]
            for one in map(activity_named, ("walking", "punching"))
            for index in range(100)
        ]
    )
    assert 0.5 < np.corrcoef(drawn.T)[0, 1] < 0.85
    assert drawn[:, 1].min() > 0
    assert drawn[:, 1].max() < 1
    assert abs(drawn[:, 1].mean() - 0.5) < 0.06


def test_a_start_that_is_given_is_where_people_are_at_first() -> None:
    """Also of those who have been walking for a while."""
    for slug in SLUGS:
        motion = {"range_m": 6, "angle_deg": 180, "idle": {"shuffle_hz": 0}}
        config = Config(motion=motion, timing={"onset": 0.3})
        person = draw_scene(config, activity_named(slug), 0).people[0]
        assert person.place == (6, 0)
        x, y = moving(person).torso(np.zeros(1))[:2, 0, 0]
        assert abs(x - 6) < 0.75, slug
        assert abs(y) < 0.15, slug
        assert "motion.place.range_m" not in scene_numbers(person.scene)


def test_only_the_cross_range_of_the_start_may_be_given() -> None:
    config = Config(motion={"cross_range_m": 0.7, "angle_deg": 150})
    scene = draw_scene(config, activity_named("walking"), 0)
    assert scene.people[0].place[1] == 0.7
    assert 2 <= scene.people[0].place[0] <= 8
    assert {"motion.place.range_m", "motion.cross_range_m"} <= scene_numbers(scene).keys()
    assert "motion.place.cross_range_m" not in scene_numbers(scene)


def test_a_start_by_activity_leaves_the_others_their_place() -> None:
    config = Config(motion={"range_m": {"per_activity": {"walking": 9}}})
    for slug, key in (("walking", "motion.range_m"), ("punching", "motion.place.range_m")):
        numbers = scene_numbers(draw_scene(config, activity_named(slug), 0))
        assert key in numbers
        assert ("motion.range_m" in numbers) != ("motion.place.range_m" in numbers)


def test_zone_lies_behind_the_wall_and_in_the_room() -> None:
    config = Config.model_validate(SURROUNDINGS["wall"])
    zone = zone_of(draw_scene(config, activity_named("walking"), 0), (3, 0))
    assert zone.x[0] > 1.12
    assert zone.farthest < 30
    room = zone_of(draw_scene(Config.model_validate(ROOM), activity_named("walking"), 0), (3, 0))
    assert room.x[1] < 9
    assert room.y[1] < 3
    scene, _ = draw_valid_scene(config, activity_named("walking"), 0)
    assert scene.attempt == 0
    config = Config.model_validate({"room": {"back_wall_m": 9.5}})
    for index in range(8):
        scene = draw_scene(config, activity_named("walking"), index)
        assert zone_of(scene, (3, 0)).x[1] < 9.5
        x = moving(scene.people[0]).positions(np.linspace(0, 6, 61))[0]
        assert x.max() < 9.8  # a walk may be longer than the room is deep
