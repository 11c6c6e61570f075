"""When people begin: under way as the recording begins, or cut off by its end; always a body."""

from typing import Any

import numpy as np
import pytest
from helpers.slow import examples
from hypothesis import example, given, settings
from hypothesis import strategies as st

from radhar_cli.config import Config
from radhar_cli.dataset.scene_fields import movement_onset
from radhar_cli.motion.activities.activity import ACTIVITIES, Activity, activity_named
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.standing import NOBODY
from radhar_cli.motion.skeleton import JOINTS, PARENTS, TORSO, links
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.scene import Scene, draw_scene, nominal_scene

SLUGS = [activity.slug for activity in ACTIVITIES]
SEQUENCES = {f"only_{name}": {"sequence": [name]} for name in MOVEMENTS if name != NOBODY} | {
    "comes_home": {
        "sequence": ["walking", "sitting_down", "standing_up", "walking"],
        "durations_s": [{"uniform": [1, 4]}, None, None, None],
    },
    "falls_after_long_boxing": {
        "sequence": ["punching", "falling", "getting_up"],
        "durations_s": [40, None, None],
        "pauses_s": [0.5, 0, 2],
    },
}
KNEES = tuple(JOINTS.index(f"{side}_knee") for side in ("right", "left"))


def config(seconds: float, **timing: Any) -> Config:
    return Config.model_validate(
        {"duration_s": seconds, "classes": SEQUENCES, "timing": timing, "motion": {"range_m": 20}}
    )


def motion(scene: Scene) -> HumanMotion:
    found = motion_of(scene.people[0])
    assert isinstance(found, HumanMotion)
    return found


def assert_a_body(person: HumanMotion, t: np.ndarray) -> None:
    """Links keep their lengths, those at the torso up to its breath, and the floor holds."""
    p, hips = person.positions(t), person.hip_joints(t)
    for joint, (parent, link) in enumerate(zip(PARENTS, links(person.person.stature), strict=True)):
        if parent is not None:
            start = hips[:, KNEES.index(joint)] if joint in KNEES else p[:, parent]
            off = np.abs(np.linalg.norm(p[:, joint] - start, axis=0) - np.linalg.norm(link))
            assert off.max() < (3e-4 if TORSO in (joint, parent) else 1e-9), JOINTS[joint]
    assert p[2].min() > 0


def activity(slug: str, all_classes: Config) -> Activity:
    return activity_named(slug, {one.slug: one for one in all_classes.every_class})


@settings(deadline=None, max_examples=examples(60))
@given(
    st.sampled_from([*SLUGS, *SEQUENCES]),
    st.sampled_from([0.5, 1.0, 2.5, 6.0, 20.0, 60.0]),
    st.sampled_from([0.0, 0.2, 0.5, 0.9, 1.0]),
    st.sampled_from([0.0, 0.5, 0.75, 1.0]),
    st.integers(0, 99),
)
@example("walking_to_falling", 0.5, 0.0, 0.75, 0)
@example("falls_after_long_boxing", 0.5, 0.0, 0.75, 1)
def test_at_every_onset_people_are_bodies(
    slug: str, seconds: float, onset: float, visible: float, index: int
) -> None:
    drawn = config(seconds, onset=onset, visible=visible)
    scene = draw_scene(drawn, activity(slug, drawn), index)
    assert_a_body(motion(scene), np.linspace(-0.25, seconds + 0.25, 120))


@pytest.mark.every(4)
@pytest.mark.parametrize("slug", SLUGS)
def test_velocities_are_continuous_at_every_onset(slug: str) -> None:
    """A step of time half as long changes a velocity half as much: nothing jumps."""
    for onset in (0.0, 0.35, 1.0):
        person = motion(draw_scene(config(4.0, onset=onset), activity_named(slug), 3))
        t = np.arange(-0.2, 4.2, 1e-3)
        speeds = np.diff(person.positions(t), axis=-1) / 1e-3
        assert np.abs(np.diff(speeds, axis=-1)).max() < 0.6


@pytest.mark.every(4)
@pytest.mark.parametrize(
    ("slug", "name", "usual"),
    [
        ("grabbing", "picking up", None),
        ("sitting_down", "sitting down", 2.0),
        ("standing_up", "standing up", 1.8),
        ("sitting_to_walking", "standing up", 1.8),
        ("walking_to_sitting", "sitting down", 2.0),
        ("falling_to_walking", "getting up", 3.0),
        ("walking_to_falling", "falling", 1.1),
        ("comes_home", "sitting down", 2.0),
    ],
)
def test_three_quarters_of_a_movement_are_seen(slug: str, name: str, usual: float | None) -> None:
    seconds, onsets = 6.0, []
    for index in range(examples(60)):
        drawn = config(seconds)
        scene = draw_scene(drawn, activity(slug, drawn), index)
        phases = motion(scene).phases
        place = [one.name for one in phases].index(name)
        begin, end = phases[place].start, phases[place + 1].start
        seen = min(end, seconds) - max(begin, 0.0)
        assert seen > 0.75 * (end - begin) - 0.2  # strides are ragged, steps differ
        onsets.append(movement_onset(scene))
    assert np.std(onsets) > (0.25 if usual is None or slug != "comes_home" else 0.1)


@pytest.mark.parametrize("slug", ["punching", "kicking", "body_rotating", "walking"])
def test_bouts_begin_and_end_within_recordings(slug: str) -> None:
    """Half of them people stand before, half of them afterwards; the phase is drawn as well."""
    early, late = (
        motion(draw_scene(config(6.0, onset=onset), activity_named(slug), 1))
        for onset in (0.1, 0.9)
    )
    assert early.onset == pytest.approx(-1.2)
    assert late.onset == pytest.approx(1.2)
    moved_before, moved_after = (
        np.ptp(person.positions(np.arange(first, last, 0.02)), axis=2).max()
        for person, first, last in ((late, 0.0, 1.0), (early, 0.0, 4.0))
    )
    assert moved_before < 0.06 < moved_after
    nominal = motion(nominal_scene(config(6.0), activity_named(slug)))
    assert nominal.onset == 0.0


@pytest.mark.parametrize(
    ("slug", "key"),
    [
        ("grabbing", "grab_start_s"),
        ("sitting_down", "seat_start_s"),
        ("sitting_to_walking", "rise_start_s"),
        ("walking", "walk_begin_s"),
    ],
)
def test_a_beginning_that_is_given_holds(slug: str, key: str) -> None:
    person = motion(draw_scene(config(6.0, **{key: 1.25}), activity_named(slug), 2))
    assert person.begin == 1.25


def test_the_end_of_a_walk_may_be_given() -> None:
    stops = {
        float(motion(draw_scene(config(6.0, walk_stop_s=2.0), activity_named(slug), n)).begin)
        for slug in ("walking_to_sitting", "walking_to_falling")
        for n in range(5)
    }
    assert stops == {0.0}


def test_the_papers_onsets_are_the_papers() -> None:
    timing = Config.model_validate({"motion": {"model": "paper"}}).timing
    assert (timing.seat_start_s, timing.rise_start_s, timing.walk_stop_s) == (0.5, 0.5, 2.0)
    scene = draw_scene(Config.model_validate({"motion": {"model": "paper"}}), ACTIVITIES[4], 0)
    assert np.isnan(movement_onset(scene))
