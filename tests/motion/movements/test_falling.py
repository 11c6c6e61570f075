"""Directions of falls: the law of one that is drawn."""

from collections import Counter

import pytest

from radhar_cli.config import Config
from radhar_cli.scene.scene import draw_scene, nominal_scene


def config_of(direction: object) -> Config:
    motion = {"falling": {"direction": direction}}
    return Config.model_validate({"activities": ["falling"], "motion": motion})


def directions(direction: object, count: int = 400) -> list[str]:
    config = config_of(direction)
    (falling,) = config.chosen_activities
    return [
        str(draw_scene(config, falling, index).config.motion.falling.direction)
        for index in range(count)
    ]


def test_weights_say_how_often_people_fall_in_each_direction() -> None:
    shares = Counter(directions({"choice": ["sideways", "forward"], "weights": [1, 3]}))
    assert set(shares) == {"sideways", "forward"}
    assert shares["forward"] / 400 == pytest.approx(0.75, abs=0.07)  # three standard deviations


def test_a_word_that_is_repeated_draws_as_its_weight_does() -> None:
    repeated = {"choice": ["forward", "forward", "backward", "sideways"]}
    weighed = {"choice": ["sideways", "forward", "backward"], "weights": [1, 2, 1]}
    assert directions(repeated, 100) == directions(weighed, 100)
    nominal = [
        nominal_scene(c, c.chosen_activities[0]) for c in map(config_of, (repeated, weighed))
    ]
    assert len({scene.config.motion.falling.direction for scene in nominal}) == 1


@pytest.mark.parametrize("weights", [[1], [1, -1], [0, 0]])
def test_weights_that_fit_no_choice_are_refused(weights: list[float]) -> None:
    with pytest.raises(ValueError, match="a weight of 0 or more for each value"):
        config_of({"choice": ["forward", "backward"], "weights": weights})
