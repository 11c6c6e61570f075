"""Recordings of minutes: work and memory are those of the instants asked for, not of the length."""

import sys
import tracemalloc
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from helpers.movements import in_groups

from radhar_cli.config.data_set import Config
from radhar_cli.motion.human import minimum_jerk as steps_module
from radhar_cli.motion.human.minimum_jerk import Course, Step, StepsInOrder
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.scene.people import human_motion
from radhar_cli.scene.scene import draw_scene

INSTANTS = 4096
SHORT, LONG = 60.0, 480.0
EXERCISE = {"exercise": {"sequence": ["jumping_jacks"], "durations_s": [None]}}
# What repeats or turns round as long as it lasts, and what does not.
SLUGS = ("walking", "punching", "kicking", "body_rotating", "stationary", "exercise")


def person(slug: str, seconds: float) -> HumanMotion:
    """One of a config in which everything varies."""
    motion = {"lane_m": 4.0, "fidget_hz": 0.3, "speed_variation": 0.05, "tempo_jitter": 0.05}
    config = Config.model_validate(
        {
            "duration_s": seconds,
            "motion": {"model": "human", **in_groups(motion)},
            "classes": EXERCISE,
            "activities": [slug],
        }
    )
    return human_motion(draw_scene(config, config.chosen_activities[0], 0).people[0])


def calls(work: Callable[[], Any]) -> int:
    """How many Python functions are called."""
    count = 0

    def counted(frame: object, event: str, argument: object) -> None:
        nonlocal count
        count += event == "call"

    before = sys.getprofile()
    sys.setprofile(counted)
    try:
        work()
    finally:
        sys.setprofile(before)
    return count


def peak_bytes(work: Callable[[], Any]) -> int:
    """Most memory that is in use at a time, as Python and NumPy count it."""
    tracemalloc.start()
    try:
        work()
        return tracemalloc.get_traced_memory()[1]
    finally:
        tracemalloc.stop()


@pytest.mark.parametrize("slug", SLUGS)
def test_positions_cost_what_their_instants_cost(slug: str) -> None:
    """Eight times the recording takes no more for the same instants, but for another way to sum."""
    found = []
    for seconds in (SHORT, LONG):
        motion, t = person(slug, seconds), np.linspace(10.0, 20.0, INSTANTS)
        motion.positions(t)  # what is worked out once
        found.append(
            [
                measure(lambda motion=motion, t=t: motion.positions(t))
                for measure in (calls, peak_bytes)
            ]
        )
    (few, little), (many, much) = found
    assert many <= 1.5 * few
    assert much <= 1.5 * little


@pytest.mark.parametrize("slug", SLUGS)
def test_what_is_worked_out_once_grows_with_the_recording_and_not_faster(slug: str) -> None:
    """Strides, turns and repetitions: at most eight times the memory for eight times as many."""
    t = np.linspace(10.0, 20.0, 64)
    little, much = (
        peak_bytes(lambda seconds=seconds: person(slug, seconds).positions(t))
        for seconds in (SHORT, LONG)
    )
    assert much <= 9 * little


@pytest.mark.parametrize("late", [False, True])
def test_steps_under_way_make_the_same_course_as_all_steps(
    late: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Steps in any order, of any length, some at once: within rounding of the whole sum."""
    rng = np.random.default_rng(1)
    steps = [
        Step("ab"[k % 2], rng.normal(), 100 * rng.random(), 0.1 + 3 * rng.random() ** 4, late)
        for k in range(200)
    ]
    course = Course.of({"a": 1.0, "b": -2.0}, steps)
    t = np.concatenate([rng.uniform(-1, 105, 3000), course.starts[:, 0], course.breakpoints])
    fast = course(t)
    monkeypatch.setattr(steps_module, "FEW_STEPS", 10**9)
    np.testing.assert_allclose(fast, course(t), rtol=0, atol=1e-12)


def test_the_steps_that_may_be_under_way_are_found() -> None:
    """One long step keeps all that begin within it company, and no others."""
    starts, lengths = np.array([5.0, 0.0, 1.0, 2.0, 9.0]), np.array([1.0, 4.0, 0.5, 0.5, 1.0])
    steps = StepsInOrder.of(starts, lengths)
    assert steps.order.tolist() == [1, 2, 3, 0, 4]
    assert steps.at_once == 3  # those from 0, 1 and 2 s on
    assert steps.earliest(np.array([-1.0, 2.2, 5.5, 20.0])).tolist() == [0, 0, 1, 2]
