"""Streams: bouts, pauses and links one after the other, within a zone."""

from functools import cache
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from helpers.slow import examples
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.config import Config, resolved
from radhar_cli.config.reading import validated
from radhar_cli.config.stream import PAUSE, TRANSITION, frame_classes
from radhar_cli.errors import ConfigError
from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.standing import NOBODY
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.products.segments import segments_of
from radhar_cli.scene.scene import Scene, draw_scene, nominal_scene
from radhar_cli.scene.streams import StreamMotion

CHOSEN = ("walking", "sitting_down", "grabbing", "punching", "walking_to_falling")
OUTSIDE_M = 0.3  # by which a torso may leave its zone: bouts that begin seated cannot turn first


@cache
def config_of(activities: tuple[str, ...] = CHOSEN, seconds: float = 60.0) -> Config:
    return Config(activities=activities, duration_s=seconds, stream={"count": 4})


def scene_of(config: Config, index: int) -> Scene:
    return draw_scene(config, config.chosen_activities[0], index)


def motion(scene: Scene, person: int = 0) -> StreamMotion:
    made = motion_of(scene.people[person])
    assert isinstance(made, StreamMotion)
    return made


@given(index=st.integers(0, 10**6))
@settings(max_examples=examples(15), deadline=None)
def test_people_stay_in_the_zone_for_minutes(index: int) -> None:
    scene = scene_of(config_of(), index)
    x, y = motion(scene).torso(np.arange(0, 60, 0.1))[:2, 0]
    assert x.min() > 2 - OUTSIDE_M
    assert x.max() < 7 + OUTSIDE_M
    assert np.abs(y).max() < 2.5 + OUTSIDE_M


@given(index=st.integers(0, 10**6))
@settings(max_examples=examples(15), deadline=None)
def test_segments_fill_the_recording_with_bouts_pauses_and_links(index: int) -> None:
    config = config_of()
    names = frame_classes(config.stream_activities)
    segments = segments_of(motion(scene_of(config, index)), 60.0, names)
    assert segments[0].start == 0
    assert segments[-1].stop == 60
    assert all(a.stop == b.start and a.label != b.label for a, b in pairwise(segments))
    assert {segment.label for segment in segments} <= set(names)


def test_a_walk_moves_and_a_pause_does_not() -> None:
    config = config_of()
    scene = scene_of(config, 2)
    made = motion(scene)
    paths: dict[str, list[float]] = {}
    for segment in segments_of(made, 60.0, frame_classes(config.stream_activities)):
        t = np.arange(segment.start, segment.stop, 0.02)
        if t.size > 50:
            path = np.hypot(*np.diff(made.torso(t)[:2, 0])).sum() / (segment.stop - segment.start)
            paths.setdefault(segment.label, []).append(path)
    assert min(paths["walking"]) > 0.5  # m/s
    assert max(paths[PAUSE]) < 0.1


def test_a_pause_is_the_class_of_keeping_still_where_there_is_one() -> None:
    config = config_of(("walking", "stationary", "sitting_down"))
    names = frame_classes(config.stream_activities)
    labels = set()
    for index in range(6):
        labels |= {s.label for s in segments_of(motion(scene_of(config, index)), 60.0, names)}
    assert labels == {"walking", "stationary", "sitting_down", PAUSE, TRANSITION}  # seated: a pause


def test_any_movement_may_be_an_activity_of_a_stream() -> None:
    for names in np.array_split(sorted({*MOVEMENTS} - {NOBODY}), 6):
        classes: dict[str, Any] = {f"just_{name}": {"sequence": [name]} for name in names}
        activities = (*classes, *[activity.slug for activity in ACTIVITIES[::3]])
        config = Config(
            classes=classes,
            activities=activities,
            duration_s=60.0,
            stream={"count": 1, "order": "rounds", "pause_s": 0.5, "bout_s": 3.0},
        )
        made = motion(scene_of(config, 0))
        assert np.isfinite(made.positions(np.arange(0, 60, 0.5))).all()


def test_rounds_have_every_activity_once() -> None:
    config = Config(
        activities=CHOSEN, duration_s=200.0, stream={"count": 1, "order": "rounds", "bout_s": 3.0}
    )
    labels = motion(scene_of(config, 0)).labels
    counts = [labels.count(name) for name in CHOSEN if name != "walking_to_falling"]
    counts.append(labels.count("walking_to_falling") // 2)  # a walk and a fall
    assert min(counts) >= 3
    assert max(counts) - min(counts) <= 1


def test_weights_leave_an_activity_out() -> None:
    config = Config(
        activities=CHOSEN, duration_s=60.0, stream={"count": 1, "weights": {"punching": 0}}
    )
    assert all("punching" not in motion(scene_of(config, index)).labels for index in range(5))


def test_people_have_strips_of_their_own() -> None:
    config = Config(
        activities=CHOSEN,
        duration_s=40.0,
        stream={"count": 1, "zone": {"range_m": (2, 6), "cross_range_m": (-3.5, 3.5)}},
        people=({"activity": "stream"},),
    )
    for index in range(4):
        scene = scene_of(config, index)
        t, people = np.arange(0, 40, 0.1), [motion(scene, person) for person in (0, 1)]
        right, left = (person.torso(t)[1, 0] for person in people)
        assert right.max() < -0.3 + OUTSIDE_M
        assert left.min() > 0.3 - OUTSIDE_M
        assert people[0].labels != people[1].labels


def test_a_scene_of_a_stream_has_nothing_left_to_draw() -> None:
    scene = scene_of(config_of(), 3)
    again = validated(Config, resolved(scene.config), "scene", {})
    other = scene_of(again, 3)
    assert resolved(other.config) == resolved(scene.config)
    assert motion(other).labels == motion(scene).labels
    nominal = nominal_scene(config_of(), config_of().chosen_activities[0])
    assert motion(nominal).parts


def test_streams_of_one_config_differ_in_order() -> None:
    labels = {motion(scene_of(config_of(), index)).labels for index in range(5)}
    assert len(labels) == 5


@pytest.mark.parametrize(
    ("values", "right"),
    [
        ({"motion": {"model": "paper"}}, "should be human"),
        ({"duration_s": {"uniform": [30, 40]}}, "should be one number"),
        ({"image": {"size_px": [128, 99]}}, "should be the height alone"),
        ({"stream": {"column_s": 0.001}}, "should make 2 to 8192 columns"),
        ({"stream": {"weights": {"walkin": 1}}}, "did you mean 'walking'"),
        ({"stream": {"weights": {"walking": 0, "grabbing": 0}}}, "leave an activity above 0"),
        ({"activities": ["falling_to_walking", "walking"]}, "begins in a state"),
        ({"stream": {"zone": {"range_m": [2, 3]}}}, "at least 2.5 m apart"),
        ({"people": [{"activity": "stream"}] * 3}, "room for 4 strips"),
        ({"classes": {"stream": {"sequence": ["walking"]}}}, "another name"),
    ],
)
def test_what_does_not_go_with_streams_is_refused(values: dict[str, Any], right: str) -> None:
    base = {"activities": ["walking", "grabbing"], "duration_s": 30.0, "stream": {"count": 3}}
    with pytest.raises(ConfigError, match=right):
        validated(Config, base | values, "f.yaml", {})


def test_the_time_step_gives_images_their_width() -> None:
    base: dict[str, Any] = {"activities": ("walking",), "duration_s": 30.0}
    config = Config(**base, stream={"column_s": 0.05}, image={"size_px": 128})
    assert config.image.size_px == (128, 600)
    assert Config(**base, image={"size_px": 128}).image.size_px == (128, 128)
