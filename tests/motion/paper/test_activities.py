"""Angles and displacements over time, activity by activity, and where they are not smooth."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy import cos, pi, sin

from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.motion.paper.activities import (
    PAPER_ACTIVITIES,
    PaperActivity,
    PaperGait,
    Posture,
    Timing,
)
from radhar_cli.motion.paper.progress import progress

GAIT = PaperGait(frequency=0.9, thigh=0.5, calf=0.8, arm=0.6, turn=0.7, speed=1.4)
TIMING = Timing(
    seat_start=0.4,
    seat_duration=1.9,
    rise_start=0.6,
    rise_duration=1.3,
    walk_start=2.1,
    walk_stop=1.7,
    sit_duration=1.2,
    fall_duration=0.9,
    blend=0.25,
)
T = np.linspace(0, 5, 301)
# Sines of arguments of order ten.
ROUNDING = 1e-13
TWO_PI_F = 2 * pi * GAIT.frequency

Angles = dict[str, Callable[[np.ndarray], np.ndarray]]


def record(number: int) -> PaperActivity:
    return PAPER_ACTIVITIES[ACTIVITIES[number - 1].slug]


def gait(phase: np.ndarray) -> dict[str, np.ndarray]:
    """S8 in the paper's table "Rotation Functions"."""
    return {
        "right_elbow": GAIT.arm * sin(phase + pi),
        "left_elbow": -GAIT.arm * sin(phase + pi),
        "right_knee": GAIT.thigh * sin(phase),
        "left_knee": -GAIT.thigh * sin(phase),
        "right_ankle": GAIT.calf * sin(phase + pi / 4),
        "left_ankle": -GAIT.calf * sin(phase + pi / 4),
    }


TABLE: dict[int, Angles] = {
    1: {},
    2: {
        "right_elbow": lambda t: -pi / 4 - GAIT.arm * sin(TWO_PI_F * t),
        "right_hand": lambda t: -pi / 2 - GAIT.calf * cos(TWO_PI_F * t),
        "left_elbow": lambda t: -pi / 4 + GAIT.arm * sin(TWO_PI_F * t),
        "left_hand": lambda t: -pi / 2 + GAIT.calf * cos(TWO_PI_F * t),
    },
    3: {
        "right_knee": lambda t: GAIT.thigh * sin(TWO_PI_F * t),
        "right_ankle": lambda t: pi / 6 + GAIT.calf * sin(TWO_PI_F * t),
    },
    4: {
        "torso": lambda t: pi / 2 * (1 - cos(TWO_PI_F * t)),
        "right_elbow": lambda t: -pi / 2 * (1 - cos(TWO_PI_F * t)),
        "left_elbow": lambda t: -pi / 3 * (1 - cos(TWO_PI_F * t)),
        "left_hand": lambda t: -pi / 12 * (1 - cos(TWO_PI_F * t)),
        "hip": lambda t: -pi / 2 * (1 - cos(TWO_PI_F * t)),
    },
    5: {},
    6: {},
    7: {},
}


def everywhere(value: np.ndarray | float) -> np.ndarray:
    return np.broadcast_to(value, T.shape)


def angles_equal(found: Posture, expected: dict[str, np.ndarray]) -> None:
    for joint in found.angles.keys() | expected.keys():
        np.testing.assert_allclose(
            everywhere(found.angles.get(joint, 0.0)),
            everywhere(expected.get(joint, 0.0)),
            atol=ROUNDING,
            err_msg=joint,
        )


@pytest.mark.parametrize("number", TABLE)
def test_angles_of_the_papers_table(number: int) -> None:
    expected = {joint: angle(T) for joint, angle in TABLE[number].items()}
    angles_equal(record(number).posture(T, GAIT, TIMING), expected)


def test_the_gait_of_the_papers_table() -> None:
    walking = record(8).posture(T, GAIT, TIMING)
    angles_equal(walking, gait(TWO_PI_F * T))
    np.testing.assert_allclose(walking.travelled, GAIT.speed * T, atol=ROUNDING)


@pytest.mark.parametrize("number", [9, 11])
def test_a_gait_that_starts_counts_its_time_from_there(number: int) -> None:
    ramp = progress(T, TIMING.walk_start, TIMING.blend)
    since = gait(TWO_PI_F * (T - TIMING.walk_start))
    angles_equal(
        record(number).posture(T, GAIT, TIMING), {joint: ramp * a for joint, a in since.items()}
    )


@pytest.mark.parametrize("number", [10, 12])
def test_a_gait_that_stops_counts_its_time_from_0(number: int) -> None:
    ramp = 1 - progress(T, TIMING.walk_stop, TIMING.blend)
    angles_equal(
        record(number).posture(T, GAIT, TIMING),
        {joint: ramp * a for joint, a in gait(TWO_PI_F * T).items()},
    )


@pytest.mark.parametrize("number", range(1, 13))
def test_seat_fall_and_twist(number: int) -> None:
    found = record(number).posture(T, GAIT, TIMING)
    seat = progress(T, TIMING.seat_start, TIMING.seat_duration)
    rise = progress(T, TIMING.rise_start, TIMING.rise_duration)
    sit = progress(T, TIMING.walk_stop, TIMING.sit_duration)
    fall = progress(T, TIMING.walk_stop, TIMING.fall_duration)
    seated = {5: seat, 6: 1 - seat, 9: 1 - rise, 10: sit}.get(number, 0.0)
    lying = {11: 1 - rise, 12: fall}.get(number, 0.0)
    twist = GAIT.turn * sin(TWO_PI_F * T) if number == 7 else 0.0
    for value, expected in [
        (found.seated, seated),
        (found.lying, lying),
        (found.pitch, pi / 2 * everywhere(lying)),
        (found.twist, twist),
    ]:
        np.testing.assert_allclose(everywhere(value), everywhere(expected), atol=ROUNDING)


@pytest.mark.parametrize("number", range(1, 13))
def test_the_torso_travels_by_the_integral_of_the_ramped_speed(number: int) -> None:
    speed = {
        8: np.ones_like,
        9: lambda t: progress(t, TIMING.walk_start, TIMING.blend),
        10: lambda t: 1 - progress(t, TIMING.walk_stop, TIMING.blend),
    }
    speed |= {11: speed[9], 12: speed[10]}
    ramp = speed.get(number, np.zeros_like)
    fine = np.linspace(0, 5, 50_001)
    v = GAIT.speed * ramp(fine)
    walked = np.concatenate([[0], np.cumsum((v[1:] + v[:-1]) / 2)]) * (fine[1] - fine[0])
    found = np.broadcast_to(record(number).posture(fine, GAIT, TIMING).travelled, fine.shape)
    # Trapezoids over 0.1 ms: (1e-4)^2/12 times the largest acceleration of 9 m/s^2.
    np.testing.assert_allclose(found, walked, atol=1e-8)


@pytest.mark.parametrize("number", [9, 10, 11, 12])
def test_without_a_blend_the_gait_switches_at_the_instant(number: int) -> None:
    hard = replace(TIMING, blend=0.0)
    instant = hard.walk_start if number in (9, 11) else hard.walk_stop
    t = np.array([np.nextafter(instant, 0), instant])
    found = record(number).posture(t, GAIT, hard)
    phase = TWO_PI_F * (t - hard.walk_start if number in (9, 11) else t)
    on = np.array([0, 1] if number in (9, 11) else [1, 0])
    for joint, angle in gait(phase).items():
        np.testing.assert_allclose(found.angles[joint], on * angle, atol=ROUNDING)
    step = GAIT.speed * 1.0
    after = np.broadcast_to(
        record(number).posture(instant + np.array([0.0, 1.0]), GAIT, hard).travelled, 2
    )
    expected = step if number in (9, 11) else 0.0
    assert after[1] - after[0] == pytest.approx(expected, abs=ROUNDING)


RAMPS = {
    5: [0.4, 0.4 + 1.9],
    6: [0.4, 0.4 + 1.9],
    9: [0.6, 0.6 + 1.3, 2.1, 2.1 + 0.25],
    10: [1.7, 1.7 + 0.25, 1.7 + 1.2],
    11: [0.6, 0.6 + 1.3, 2.1, 2.1 + 0.25],
    12: [1.7, 1.7 + 0.25, 1.7 + 0.9],
}


@pytest.mark.parametrize("number", range(1, 13))
def test_breakpoints_are_both_ends_of_every_ramp(number: int) -> None:
    assert record(number).breakpoints(TIMING) == pytest.approx(RAMPS.get(number, []))


@given(st.integers(1, 12), st.floats(0, 5), st.floats(0.01, 5))
@settings(deadline=None, max_examples=60)
def test_nothing_oscillates_faster_than_the_highest_frequency(
    number: int, frequency: float, shortest: float
) -> None:
    """A ramp of length d is half a period of a cosine: 1/(2 d)."""
    timing = replace(
        TIMING, seat_duration=shortest, rise_duration=9.0, fall_duration=shortest, blend=9.0
    )
    ramps = {5: shortest, 6: shortest, 9: 9.0, 10: 1.2, 11: 9.0, 12: min(shortest, 9.0)}
    fastest = max(
        0.5 / ramps[number] if number in ramps else 0.0,
        frequency if number not in (1, 5, 6) else 0.0,
    )
    swinging = replace(GAIT, frequency=frequency)
    assert record(number).highest_frequency(swinging, timing) == pytest.approx(fastest)
