"""What is not the movement does not tell the class: neither numbers of scenes nor where people are.

A forest and a tree of scikit-learn try, on scenes alone, without an echo. Chance is one of twelve,
8.3 %; 14 % is what the project allows.
"""

from pathlib import Path

import numpy as np
import pytest
from helpers.slow import examples
from sklearn.ensemble import RandomForestClassifier
from sklearn.model_selection import cross_val_score
from sklearn.tree import DecisionTreeClassifier

from radhar_cli.config import load_config
from radhar_cli.dataset.scene_fields import movement_onset
from radhar_cli.scene.motion import moving
from radhar_cli.scene.scene import draw_scene, scene_numbers
from radhar_cli.study.audit.scene_numbers import is_of_movement

QUICKSTART = Path(__file__).parents[2] / "configs" / "quickstart.yaml"
SAMPLES = examples(150)  # of each class
MOST = 0.14
ON_CUE_S = 0.25


@pytest.fixture(scope="module")
def scenes() -> tuple[list[dict[str, float]], np.ndarray, np.ndarray, np.ndarray]:
    """Numbers of scenes, mean places of torsos [N, 2] (m), onsets [N] (s) and classes [N]."""
    config, t = load_config(QUICKSTART), np.linspace(0, 6, 31)
    numbers, places, onsets, classes = [], [], [], []
    for number, activity in enumerate(config.chosen_activities):
        for index in range(SAMPLES):
            scene = draw_scene(config, activity, index)
            numbers.append(scene_numbers(scene))
            places.append(moving(scene.people[0]).torso(t)[:2, 0].mean(axis=1))
            onsets.append(movement_onset(scene))
            classes.append(number)
    return numbers, np.array(places), np.array(onsets), np.array(classes)


def accuracies(table: np.ndarray, classes: np.ndarray) -> list[float]:
    """Cross-validated accuracy of a tree and of a forest."""
    learners = (
        DecisionTreeClassifier(max_depth=6, random_state=0),
        RandomForestClassifier(60, min_samples_leaf=5, random_state=0),
    )
    return [float(cross_val_score(one, table, classes, cv=5).mean()) for one in learners]


@pytest.mark.slow
def test_no_number_but_those_of_the_movement_tells_the_class(scenes) -> None:
    numbers, _, _, classes = scenes
    keys = sorted({key for of_scene in numbers for key in of_scene if not is_of_movement(key)})
    assert {"motion.place.range_m", "motion.place.instant", "motion.angle_deg"} <= {*keys}
    assert {"timing.onset", "timing.visible", "subject.height_m", "snr_db"} <= {*keys}
    table = np.array([[of_scene.get(key, -1e3) for key in keys] for of_scene in numbers])
    assert max(accuracies(table, classes)) < MOST


@pytest.mark.slow
def test_where_people_are_on_average_hardly_tells_the_class(scenes) -> None:
    _, places, _, classes = scenes
    assert max(accuracies(places[:, :1], classes)) < MOST
    assert max(accuracies(places, classes)) < MOST


def test_no_class_begins_on_cue(scenes) -> None:
    _, _, onsets, classes = scenes
    for number in range(12):
        assert np.std(onsets[classes == number]) > ON_CUE_S
