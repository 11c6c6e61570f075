"""Positions of the scatterers: closed forms, planted feet, stiff links, speeds, headings."""

from dataclasses import replace
from math import cos, pi, radians, sin
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.motion.activities.activity import ACTIVITIES
from radhar_cli.motion.paper.activities import PAPER_ACTIVITIES, PaperGait, Timing
from radhar_cli.motion.paper.body import PaperBody
from radhar_cli.motion.skeleton import JOINTS, PARENTS, links, standing_height, thigh_length

GAIT = PaperGait(
    frequency=1.0,
    thigh=radians(30),
    calf=radians(45),
    arm=radians(35),
    turn=radians(45),
    speed=1.5,
)
TIMING = Timing(
    seat_start=0.5,
    seat_duration=2.0,
    rise_start=0.5,
    rise_duration=1.5,
    walk_start=2.0,
    walk_stop=2.0,
    sit_duration=1.5,
    fall_duration=0.8,
    blend=0.3,
)
RECORDING = 4.0
T = np.linspace(0, RECORDING, 801)
ALL = range(1, 13)
ANKLES = [JOINTS.index("right_ankle"), JOINTS.index("left_ankle")]
HEAD, TORSO = JOINTS.index("head"), JOINTS.index("torso")

# A sum of a dozen products of numbers below ten in doubles; model.md asks for as much.
ROUNDING = 1e-12
FASTEST = 7.0  # m/s, model.md; 6.24 in a trial


def default_person(number: int, **changes: Any) -> PaperBody:
    slug = ACTIVITIES[number - 1].slug
    person = PaperBody(slug, 1.8, 84.24, start=(2.0, 0.0), angle=0.0, gait=GAIT, timing=TIMING)
    return replace(person, **changes)


HEIGHTS = st.floats(1.2, 2.1)
ANGLES = st.floats(-pi, pi)
SECONDS = st.floats(0.05, 2)
GAITS = st.builds(
    PaperGait,
    frequency=st.floats(0, 3),
    thigh=ANGLES,
    calf=ANGLES,
    arm=ANGLES,
    turn=ANGLES,
    speed=st.floats(0, 3),
)
TIMINGS = st.builds(
    Timing,
    seat_start=SECONDS,
    seat_duration=SECONDS,
    rise_start=SECONDS,
    rise_duration=SECONDS,
    walk_start=SECONDS,
    walk_stop=SECONDS,
    sit_duration=SECONDS,
    fall_duration=SECONDS,
    blend=SECONDS,
)
PEOPLE = st.builds(
    PaperBody,
    activity=st.sampled_from([activity.slug for activity in ACTIVITIES]),
    height=HEIGHTS,
    weight=st.just(80.0),
    start=st.tuples(st.floats(-5, 5), st.floats(-5, 5)),
    angle=ANGLES,
    gait=GAITS,
    timing=TIMINGS,
)


def matrix_positions(body: PaperBody, t: float) -> np.ndarray:
    """Positions [3, 13] at one instant, with the matrices of the paper's equations 1 and 2."""

    def about_y(a: float) -> np.ndarray:
        return np.array([[cos(a), 0, sin(a)], [0, 1, 0], [-sin(a), 0, cos(a)]])

    def about_z(a: float) -> np.ndarray:
        return np.array([[cos(a), -sin(a), 0], [sin(a), cos(a), 0], [0, 0, 1]])

    now = PAPER_ACTIVITIES[body.activity].posture(np.array([t]), body.gait, body.timing)
    theta = {joint: float(np.ravel(a)[0]) for joint, a in now.angles.items()}
    seat, lying, pitch, twist, travelled = (
        float(np.ravel(value)[0])
        for value in (now.seated, now.lying, now.pitch, now.twist, now.travelled)
    )
    bend, thigh, high = pi / 2 * seat, thigh_length(body.height), standing_height(body.height)
    for side in ("right", "left"):
        theta[f"{side}_knee"] = theta.get(f"{side}_knee", 0.0) - bend
        theta[f"{side}_ankle"] = theta.get(f"{side}_ankle", 0.0) + bend
    ahead = np.array([cos(body.angle), sin(body.angle), 0.0])
    p = np.zeros((3, 13))
    p[:, 0] = ahead * (travelled - thigh * sin(bend))
    p[:2, 0] += body.start
    p[2, 0] = high * (1 - lying) + 0.15 * lying - thigh * (1 - cos(bend))
    turned = {0: about_y(theta.get("torso", 0.0))}
    for joint, parent in enumerate(PARENTS):
        if parent is not None:
            turned[joint] = turned[parent] @ about_y(theta.get(JOINTS[joint], 0.0))
            rotation = about_z(body.angle + twist) @ about_y(pitch) @ turned[joint]
            p[:, joint] = p[:, parent] + rotation @ links(body.height)[joint]
    return p


@given(PEOPLE, st.floats(0, RECORDING))
@settings(deadline=None, max_examples=120)
def test_forward_kinematics_are_products_of_rotation_matrices(body: PaperBody, t: float) -> None:
    found = body.positions(np.array([t]))[:, :, 0]
    np.testing.assert_allclose(found, matrix_positions(body, t), atol=ROUNDING)


@given(PEOPLE)
@settings(deadline=None, max_examples=60)
def test_links_are_stiff(body: PaperBody) -> None:
    p = body.positions(np.linspace(0, RECORDING, 101))
    for joint, parent in enumerate(PARENTS):
        if parent is not None:
            length = np.linalg.norm(p[:, joint] - p[:, parent], axis=0)
            own = np.linalg.norm(links(body.height)[joint])
            np.testing.assert_allclose(length, own, atol=ROUNDING)


@given(PEOPLE)
@settings(deadline=None, max_examples=60)
def test_the_torso_alone_is_the_torso_of_all(body: PaperBody) -> None:
    t = np.linspace(0, RECORDING, 101)
    np.testing.assert_array_equal(body.torso(t)[:, 0], body.positions(t)[:, TORSO])


@given(PEOPLE)
@settings(deadline=None, max_examples=60)
def test_the_heading_turns_the_whole_scene(body: PaperBody) -> None:
    t = np.linspace(0, RECORDING, 101)
    north = replace(body, angle=0.0, start=(0.0, 0.0)).positions(t)
    p = body.positions(t)
    x, y = body.start
    c, s = cos(body.angle), sin(body.angle)
    np.testing.assert_allclose(p[0], x + c * north[0] - s * north[1], atol=ROUNDING)
    np.testing.assert_allclose(p[1], y + s * north[0] + c * north[1], atol=ROUNDING)
    np.testing.assert_allclose(p[2], north[2], atol=ROUNDING)


def test_a_motion_angle_of_0_walks_away_and_90_degrees_to_the_left() -> None:
    track = default_person(8, angle=0.0).torso(T)[:, 0]
    np.testing.assert_allclose(track[0], 2 + 1.5 * T, atol=ROUNDING)
    track = default_person(8, angle=pi / 2).torso(T)[:, 0]
    np.testing.assert_allclose(track[1], 1.5 * T, atol=ROUNDING)


@pytest.mark.parametrize("number", [4, 5, 6])
@given(HEIGHTS, ANGLES, GAITS, TIMINGS)
@settings(deadline=None, max_examples=25)
def test_feet_stay_planted(
    number: int, height: float, angle: float, gait: PaperGait, timing: Timing
) -> None:
    body = default_person(number, height=height, angle=angle, gait=gait, timing=timing)
    feet = body.positions(np.linspace(0, RECORDING, 101))[:, ANKLES]
    for axis, at in enumerate((2.0, 0.0, 0.0)):
        np.testing.assert_allclose(feet[axis], at, atol=ROUNDING)


@pytest.mark.parametrize(("number", "then"), [(5, 3.0), (6, 0.0)])
def test_a_seated_person_sits_a_thigh_behind_the_feet(number: int, then: float) -> None:
    p = dict(
        zip(JOINTS, default_person(number).positions(np.array([then]))[:, :, 0].T, strict=True)
    )
    np.testing.assert_allclose(p["hip"], (1.55, 0, 0.45), atol=ROUNDING)
    np.testing.assert_allclose(p["torso"], (1.55, 0, 0.75), atol=ROUNDING)
    np.testing.assert_allclose(p["head"], (1.55, 0, 1.05), atol=ROUNDING)
    np.testing.assert_allclose(p["left_hand"], (1.55, 0.2, 0.35), atol=ROUNDING)
    np.testing.assert_allclose(p["right_knee"], (2, 0, 0.45), atol=ROUNDING)


def test_a_punch_at_two_instants() -> None:
    """Upper arm and forearm hang at these angles, degrees, right and left.

    At 0 s: -45 and -180, -45 and -90; at 0.25 s: -80 and -170, -10 and -100.
    """
    p = default_person(2, start=(0.0, 0.0)).positions(np.array([0.0, 0.25]))
    s45, s10, c10 = sin(pi / 4), sin(radians(10)), cos(radians(10))
    expected = {
        "right_elbow": [(0.3 * s45, 1.4 - 0.3 * s45), (0.3 * c10, 1.4 - 0.3 * s10)],
        "right_hand": [
            (0.3 * s45, 1.7 - 0.3 * s45),
            (0.3 * (c10 + s10), 1.4 + 0.3 * (c10 - s10)),
        ],
        "left_elbow": [(0.3 * s45, 1.4 - 0.3 * s45), (0.3 * s10, 1.4 - 0.3 * c10)],
        "left_hand": [
            (0.3 * s45 + 0.3, 1.4 - 0.3 * s45),
            (0.3 * (s10 + c10), 1.4 + 0.3 * (s10 - c10)),
        ],
    }
    for joint, at in expected.items():
        track = p[:, JOINTS.index(joint)]
        np.testing.assert_allclose(track[[0, 2]].T, at, atol=ROUNDING, err_msg=joint)
        np.testing.assert_allclose(track[1], -0.2 if "right" in joint else 0.2, atol=ROUNDING)
    rest = [JOINTS.index(name) for name in JOINTS if name not in expected]
    np.testing.assert_allclose(p[:, rest, 1], p[:, rest, 0], atol=ROUNDING)


@given(st.floats(1.2, 2.1), st.floats(0.1, 3), ANGLES)
@settings(deadline=None, max_examples=30)
def test_a_kicking_leg_is_a_double_pendulum(height: float, f: float, swing: float) -> None:
    gait = replace(GAIT, frequency=f, thigh=swing)
    p = default_person(3, height=height, gait=gait).positions(T)
    knee, ankle = p[:, JOINTS.index("right_knee")], p[:, JOINTS.index("right_ankle")]
    length, hip = height / 4, height / 2
    upper = swing * np.sin(2 * pi * f * T)
    lower = upper + pi / 6 + radians(45) * np.sin(2 * pi * f * T)
    np.testing.assert_allclose(knee[0], 2 - length * np.sin(upper), atol=ROUNDING)
    np.testing.assert_allclose(knee[2], hip - length * np.cos(upper), atol=ROUNDING)
    np.testing.assert_allclose(ankle[0] - knee[0], -length * np.sin(lower), atol=ROUNDING)
    np.testing.assert_allclose(ankle[2] - knee[2], -length * np.cos(lower), atol=ROUNDING)
    still = p[:, JOINTS.index("left_ankle")]
    np.testing.assert_allclose(still, np.array([[2.0], [0], [0]]) + 0 * T, atol=ROUNDING)


def test_a_turning_body_swings_its_shoulders_about_the_vertical() -> None:
    p = default_person(7, angle=radians(20)).positions(T)
    yaw = radians(20) + radians(45) * np.sin(2 * pi * T)
    shoulder = p[:, JOINTS.index("left_shoulder")]
    np.testing.assert_allclose(shoulder[0], 2 - 0.2 * np.sin(yaw), atol=ROUNDING)
    np.testing.assert_allclose(shoulder[1], 0.2 * np.cos(yaw), atol=ROUNDING)
    axis = [JOINTS.index(name) for name in ("torso", "head", "hip", "left_ankle")]
    np.testing.assert_allclose(p[:2, axis], p[:2, axis, :1] + 0 * T, atol=ROUNDING)


def test_nobody_moves_in_s1() -> None:
    p = default_person(1).positions(T)
    np.testing.assert_array_equal(p, p[:, :, :1] + 0 * T)


def speeds(body: PaperBody, t: np.ndarray, dt: float) -> np.ndarray:
    """Mean speeds [13, M] over [t - dt/2, t + dt/2]."""
    moved = body.positions(t + dt / 2) - body.positions(t - dt / 2)
    return np.sqrt((moved**2).sum(axis=0)) / dt


@pytest.mark.parametrize("number", ALL)
def test_no_joint_of_the_default_person_is_faster_than_7_m_per_s(number: int) -> None:
    body = default_person(number)
    assert speeds(body, np.arange(0, RECORDING, 1e-3), 1e-3).max() < FASTEST


def test_the_fastest_joint_is_a_walkers_ankle() -> None:
    body = default_person(8)
    v = speeds(body, np.arange(0, 1, 1e-4), 1e-4)
    assert v.max() == pytest.approx(6.24, abs=0.005)
    assert int(np.argmax(v.max(axis=1))) in ANKLES


@pytest.mark.parametrize("number", ALL)
def test_positions_are_continuous(number: int) -> None:
    """Over 0.1 us, at every end of a ramp too, no joint gets further than 7 m/s take it."""
    body = default_person(number)
    t = np.concatenate([body.breakpoints, T[1:-1]])
    assert speeds(body, t, 1e-7).max() < FASTEST


def fourth_order(body: PaperBody, t: float, h: float) -> np.ndarray:
    """Acceleration [3, 13] at t from positions on one side of t alone: t, t + h, ... t + 3 h."""
    p = body.positions(t + h * np.arange(4))
    return (2 * p[..., 0] - 5 * p[..., 1] + 4 * p[..., 2] - p[..., 3]) / h**2


def jump(body: PaperBody, t: float) -> float:
    """Largest jump (m/s^2) of a joint's acceleration at t.

    The stencil errs by h^2 times the fourth derivative, at most 1e4 m/s^4 in these gaits.
    """
    return float(np.abs(fourth_order(body, t, 1e-3) - fourth_order(body, t, -1e-3)).max())


@pytest.mark.parametrize("number", ALL)
def test_breakpoints_are_where_the_acceleration_jumps(number: int) -> None:
    body = default_person(number)
    for t in body.breakpoints:
        assert jump(body, t) > 0.5, t
    times = np.linspace(0.1, 3.9, 96)
    smooth = [t for t in times if all(abs(t - kink) > 4e-3 for kink in body.breakpoints)]
    assert max(jump(body, float(t)) for t in smooth) < 0.05


def test_without_a_blend_walking_starts_and_stops_at_once() -> None:
    """The paper's phases, stitched together: S9 is S6 then S8, S10 is S8 then S5."""
    hard = replace(TIMING, blend=0.0)
    before, after = T[T < 2.0], T[T >= 2.0]

    rising = replace(TIMING, seat_start=0.5, seat_duration=1.5)
    s9 = default_person(9, timing=hard)
    s6 = default_person(6, timing=rising)
    np.testing.assert_allclose(s9.positions(before), s6.positions(before), atol=ROUNDING)
    s8 = default_person(8)
    np.testing.assert_allclose(s9.positions(after), s8.positions(after - 2.0), atol=ROUNDING)

    s10 = default_person(10, timing=hard)
    np.testing.assert_allclose(s10.positions(before), s8.positions(before), atol=ROUNDING)
    sitting = replace(TIMING, seat_start=2.0, seat_duration=1.5)
    s5 = default_person(5, timing=sitting, start=(2.0 + 1.5 * 2.0, 0.0))
    np.testing.assert_allclose(s10.positions(after), s5.positions(after), atol=ROUNDING)


@pytest.mark.parametrize("number", [9, 10, 11, 12])
def test_without_a_blend_joints_teleport(number: int) -> None:
    body = default_person(number, timing=replace(TIMING, blend=0.0))
    # The shanks alone stand at 45 degrees times sin(45 degrees) when the gait is switched.
    assert speeds(body, np.array([2.0]), 1e-6).max() * 1e-6 > 0.1


@pytest.mark.parametrize("number", [9, 11])
def test_after_the_blend_a_started_walk_is_s8_half_a_blend_behind(number: int) -> None:
    t = T[T >= 2.3]
    late = default_person(8, start=(2.0 - 1.5 * 0.15, 0.0))
    np.testing.assert_allclose(
        default_person(number).positions(t), late.positions(t - 2.0), atol=ROUNDING
    )


@pytest.mark.parametrize("number", [10, 12])
def test_until_it_stops_a_walk_is_s8(number: int) -> None:
    t = T[T <= 2.0]
    np.testing.assert_allclose(
        default_person(number).positions(t), default_person(8).positions(t), atol=ROUNDING
    )


@given(HEIGHTS, ANGLES, TIMINGS)
@settings(deadline=None, max_examples=30)
def test_s9_starts_seated_a_thigh_behind_and_walks_from_where_it_stands(
    height: float, angle: float, timing: Timing
) -> None:
    body = default_person(9, height=height, angle=angle, timing=timing)
    first = body.positions(np.array([0.0]))[:, :, 0]
    thigh = height / 4
    back = thigh * np.array([cos(angle), sin(angle)])
    np.testing.assert_allclose(first[:2, TORSO], (2, 0) - back, atol=ROUNDING)
    assert first[2, TORSO] == pytest.approx(height * 2 / 3 - thigh, abs=ROUNDING)
    at_ease = np.linspace(0, timing.walk_start, 50)
    feet = body.positions(at_ease)[:, ANKLES]
    np.testing.assert_allclose(feet[0], 2.0, atol=ROUNDING)
    np.testing.assert_allclose(feet[1:], 0.0, atol=ROUNDING)


@given(HEIGHTS, ANGLES, GAITS, TIMINGS)
@settings(deadline=None, max_examples=30)
def test_s10_stands_still_on_its_feet_once_the_blend_is_over(
    height: float, angle: float, gait: PaperGait, timing: Timing
) -> None:
    body = default_person(10, height=height, angle=angle, gait=gait, timing=timing)
    stop, blend, sit = timing.walk_stop, timing.blend, timing.sit_duration
    p = body.positions(stop + blend + np.linspace(0, 3, 50))
    walked = gait.speed * (stop + blend / 2)
    feet = (2 + walked * cos(angle), walked * sin(angle), 0.0)
    for axis, at in enumerate(feet):
        np.testing.assert_allclose(p[axis, ANKLES], at, atol=ROUNDING)
    seated = body.torso(np.array([stop + max(blend, sit)]))[:, 0, 0]
    np.testing.assert_allclose(
        seated[:2],
        (feet[0] - height / 4 * cos(angle), feet[1] - height / 4 * sin(angle)),
        atol=ROUNDING,
    )


@given(HEIGHTS, ANGLES)
@settings(deadline=None, max_examples=30)
def test_s11_gets_up_from_lying_forward(height: float, angle: float) -> None:
    body = default_person(11, height=height, angle=angle)
    lying, standing = body.positions(np.array([0.3, 2.0])).transpose(2, 0, 1)
    np.testing.assert_allclose(lying[2], 0.15, atol=ROUNDING)
    head = height / 6 * np.array([cos(angle), sin(angle)])
    np.testing.assert_allclose(lying[:2, TORSO], (2, 0), atol=ROUNDING)
    np.testing.assert_allclose(lying[:2, HEAD] - lying[:2, TORSO], head, atol=ROUNDING)
    assert standing[2, HEAD] == pytest.approx(height * 2.5 / 3, abs=ROUNDING)
    np.testing.assert_allclose(standing[:2, HEAD], (2, 0), atol=ROUNDING)


@given(HEIGHTS, ANGLES)
@settings(deadline=None, max_examples=30)
def test_s12_falls_forward_along_its_heading(height: float, angle: float) -> None:
    body = default_person(12, height=height, angle=angle)
    fallen = body.positions(np.array([2.8, 3.9]))
    np.testing.assert_allclose(fallen[2], 0.15, atol=ROUNDING)
    np.testing.assert_allclose(fallen[..., 0], fallen[..., 1], atol=ROUNDING)
    ahead = np.array([cos(angle), sin(angle)])
    torso = (2, 0) + 1.5 * (2.0 + 0.15) * ahead
    np.testing.assert_allclose(fallen[:2, TORSO, 0], torso, atol=ROUNDING)
    np.testing.assert_allclose(fallen[:2, HEAD, 0], torso + height / 6 * ahead, atol=ROUNDING)
    feet = torso - height * 2 / 3 * ahead
    np.testing.assert_allclose(fallen[:2, ANKLES[0], 0], feet, atol=ROUNDING)


@pytest.mark.parametrize("number", [11, 12])
def test_without_a_floor_the_ankles_pass_19_cm_below_it(number: int) -> None:
    p = default_person(number).positions(np.arange(0, RECORDING, 1e-3))
    assert p[2, ANKLES].min() == pytest.approx(-0.19, abs=0.005)
    assert p[2].min() == p[2, ANKLES].min()


def test_links_and_rcs_of_a_body() -> None:
    child = default_person(1, height=1.2, weight=40.0)
    np.testing.assert_allclose(child.links, links(1.2))
    scale = np.sqrt(1.2 * 40 / (1.8 * 84.24))
    ratio = child.cross_sections(T) / default_person(1).cross_sections(T)
    np.testing.assert_allclose(ratio, scale)
