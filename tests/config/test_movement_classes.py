"""Movements, and other words for them, as classes without a `classes:` block."""

import json
from typing import Any

import numpy as np
import pytest
from pydantic import ValidationError

from radhar_cli.config import Config, load_config
from radhar_cli.config.checks.doubts import word_warnings
from radhar_cli.config.classes import movement_class
from radhar_cli.config.identity import config_hash, resolved
from radhar_cli.errors import ConfigError
from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.scene import Scene, draw_scene, nominal_scene, scene_numbers
from radhar_cli.scene.single.request import activity_of


def _scene(config: Config, slug: str, index: int = 0) -> Scene:
    return draw_scene(config, activity_of(slug, config), index)


def _read_again(config: Config) -> Config:
    return Config.model_validate(json.loads(json.dumps(resolved(config))))


def test_a_movement_is_a_class_beside_the_twelve() -> None:
    config = Config(activities=["walking", "falling", "S1", "squatting"])
    assert config.activities == ("walking", "falling", "stationary", "squatting")
    assert [a.slug for a in config.chosen_activities] == [*config.activities]  # labels 0 to 3
    assert config.classes["falling"].sequence == ("falling",)
    assert _read_again(config) == config
    assert config_hash(_read_again(config)) == config_hash(config)


def test_all_stays_the_twelve() -> None:
    assert len(Config(people=[{"activity": "jumping"}]).chosen_activities) == 12


def test_scenes_of_a_movement_do_not_depend_on_the_other_classes() -> None:
    alone = Config(activities=["falling"])
    among = Config(activities=["squatting", "S1", "falling"], classes={"a": {"sequence": ["trip"]}})
    numbers = [scene_numbers(_scene(config, "falling", 3)) for config in (alone, among)]
    assert numbers[0] == numbers[1]
    not_chosen = _scene(Config(), "falling", 3)
    assert scene_numbers(not_chosen) == numbers[0]


def test_a_scene_is_the_same_when_its_config_is_read_again() -> None:
    config = Config(
        activities=["picking_up", "falling"],
        classes={"b": {"sequence": ["boxing"]}},
        people=[{"activity": "jumping"}],
    )
    scene = _scene(config, "falling", 1)
    again = _read_again(scene.config)
    assert again == scene.config
    assert _scene(again, "falling", 1).config == scene.config
    assert again.classes["falling"].durations_s == scene.config.classes["falling"].durations_s


def test_durations_of_a_movement_that_is_a_class_differ() -> None:
    config = Config(activities=["falling"])
    durations = {_scene(config, "falling", n).config.classes["falling"].durations_s for n in (0, 1)}
    assert len(durations) == 2
    assert all(0.9 < duration < 1.3 for (duration,) in durations)


def test_ones_own_class_of_that_name_comes_first() -> None:
    config = Config(classes={"falling": {"sequence": ["falling", "getting_up"]}})
    config = Config(classes=config.classes, activities=["falling"])
    assert config.classes["falling"].sequence == ("falling", "getting_up")


def test_other_words_within_sequences_and_of_other_people_are_said_once() -> None:
    config = Config(
        classes={
            "spar": {
                "sequence": ["kick", {"optional": ["boxing", "jump"]}],
                "durations_s": [1, 1, 1],
            }
        },
        activities=["spar", "Walking"],
        people=[{"activity": {"choice": ["fall", "standing"]}}],
    )
    assert config.classes["spar"].written == ("kicking", "punching", "jumping")
    (line,) = word_warnings(config)
    for words in ("boxing is taken for punching", "fall is taken for falling", "standing is taken"):
        assert words in line
    assert "Walking" not in line
    assert word_warnings(_read_again(config)) == []


WORDS = {
    "picking_up": "grabbing",
    "Jumps": "jumping",
    "army crawling": "crawling",
    "walk": "walking",
}


def test_a_class_has_the_name_that_somebody_gives_it() -> None:
    """Of another word for a movement, without a warning, with the numbers of either name."""
    config = Config(
        activities=[*WORDS],
        samples_per_class={"per_activity": {"picking_up": 7, "crawling": 3, "default": 2}},
    )
    names = tuple(word.lower().replace(" ", "_") for word in WORDS)
    assert config.activities == names
    assert tuple(activity.slug for activity in config.chosen_activities) == names
    for activity, movement in zip(config.chosen_activities, WORDS.values(), strict=True):
        assert activity.movements == (movement,)
        if activity.number > len(ACTIVITIES):
            assert config.classes[activity.slug] == movement_class(movement)
    assert [*map(config.samples_of, config.chosen_activities)] == [7, 2, 3, 2]
    assert word_warnings(config) == []
    assert _read_again(config) == config


@pytest.mark.parametrize("word", WORDS)
def test_a_class_by_another_word_moves_as_the_movement_does(word: str) -> None:
    paths = []
    for name in (word, WORDS[word]):
        config = Config(activities=[name], duration_s=3)
        (person,) = nominal_scene(config, config.chosen_activities[0]).people
        paths.append(motion_of(person).positions(np.linspace(0, 3, 31)))
    np.testing.assert_allclose(*paths, atol=0.02)


@pytest.mark.parametrize("model", ["human", "paper"])
def test_one_of_the_twelve_by_another_word_has_the_same_scenes(model: str) -> None:
    scenes = [
        _scene(Config(activities=["kicking", name], motion={"model": model}), name, 1)
        for name in ("walk", "walking")
    ]
    assert [scene.activity.slug for scene in scenes] == ["walk", "walking"]
    assert scene_numbers(scenes[0]) == scene_numbers(scenes[1])
    assert scenes[0].activity.label == "S8"


def test_a_word_for_a_class_of_files_stays_that_class() -> None:
    config = Config(classes={"walking": ["a.bvh"]}, activities=["walk", "S1"])
    assert config.activities == ("walking", "stationary")
    assert word_warnings(config)[0].startswith("walk is taken for walking")


@pytest.mark.parametrize(
    ("document", "message"),
    [
        ({"activities": ["picking_up", "S4"]}, "picking_up and S4 is grabbing twice"),
        ({"activities": ["falling", "falling"]}, "falling is falling twice"),
        ({"activities": []}, "at least one activity"),
        ({"activities": ["waving_hands_about"]}, "'waving_hands_about' is not an activity"),
        (
            {"motion": {"model": "paper"}, "activities": ["falling", "S1"]},
            "is a movement of people, which motion.model: human makes",
        ),
        (
            {"samples_per_class": {"per_activity": {"boxing": 1, "S2": 2}}},
            "is punching, named here, too",
        ),
    ],
)
def test_mistakes(document: dict[str, Any], message: str) -> None:
    with pytest.raises(ValidationError, match=message):
        Config.model_validate(document)


def test_the_paper_has_no_movements() -> None:
    with pytest.raises(ConfigError, match=r"activity = falling: is a movement of people"):
        activity_of("falling", Config(motion={"model": "paper"}))


def test_mistakes_name_file_and_line(tmp_path) -> None:
    path = tmp_path / "c.yaml"
    path.write_text("seed: 1\nactivities: [boxing, punching]\n")
    with pytest.raises(
        ConfigError, match=r"c.yaml:2: activities.* boxing and punching is punching"
    ):
        load_config(path)
