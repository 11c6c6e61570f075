"""Speeds, heights and durations against the literature and the prototype's figures."""

from dataclasses import replace
from math import radians, sqrt

import numpy as np
import pytest

from radhar_cli.config import Config
from radhar_cli.motion.human import boulic_thalmann as curves
from radhar_cli.motion.human.idle import Breath, Fidget, Idle, Sway, Waves
from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.human.part import Movement
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.movements.falling import FallBackward, FallForward, OnFours, Sitting
from radhar_cli.motion.movements.falling_off_seat import FallFromSeat
from radhar_cli.motion.movements.falling_sideways import FallSideways
from radhar_cli.motion.movements.getting_up import TRIES, GetUp, TryToGetUp
from radhar_cli.motion.movements.grabbing import Grab
from radhar_cli.motion.movements.rotating import Turn
from radhar_cli.motion.movements.sitting import Seat, SitDown, StandUp
from radhar_cli.motion.movements.standing import Stand
from radhar_cli.motion.movements.striking import Kick, Punch
from radhar_cli.motion.movements.stumbling import STUMBLES
from radhar_cli.motion.movements.walking import Gait, Walk
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.scene import draw_scene

DT = 1e-3


def joint(name: str) -> int:
    return JOINTS.index(name)


def still(person: Physique) -> Idle:
    none = Waves()
    return Idle(person, Sway(none, none), Breath(chest=0.0, heart=0.0))


def positions(movement: Movement, seconds: float, stature: float = 1.75) -> np.ndarray:
    person = Physique(stature)
    motion = HumanMotion(person, (movement,), (0.0, 0.0), 0.0, 0.0, seconds, still(person))
    return motion.positions(np.arange(0, seconds, DT))


def speed(p: np.ndarray, name: str) -> float:
    """Largest speed of a joint, m/s."""
    return float(np.linalg.norm(np.diff(p[:, joint(name)], axis=1), axis=0).max() / DT)


@pytest.mark.parametrize(
    ("v", "ankle", "rise"), [(0.8, 3.23, 27), (1.2, 3.15, 44), (1.5, 3.05, 57), (2.0, 2.86, 77)]
)
def test_gait(v: float, ankle: float, rise: float) -> None:
    """Ankle speed over walking speed, and the hip's rise (mm) within 6 % (CMU: 56, 64 at 1.6)."""
    p = positions(Walk(Gait(v, period_scale=0.94), from_rest=False), 4.0)
    velocity = np.diff(p[0], axis=1) / DT
    assert velocity[joint("right_ankle")].max() / v == pytest.approx(ankle, abs=0.02)
    assert velocity[joint("right_ankle")].min() / v > -0.01
    assert 0.87 < velocity[joint("torso")].min() / v < 0.90  # CMU: 0.88
    assert 1.12 < velocity[joint("torso")].max() / v < 1.15  # CMU: 1.14
    assert 1e3 * np.ptp(p[2, joint("hip")]) == pytest.approx(rise, rel=0.06)


def test_ankles_are_fastest_late_and_before_them_knees() -> None:
    """CMU: the ankle at u = 0.88. Boulic and Thalmann's hip curve: the knee at 1.9 times v."""
    v, walk = 1.2, Walk(Gait(1.2), from_rest=False)
    velocity = np.diff(positions(walk, 4.0)[0], axis=1) / DT / v
    stride = walk.part(Physique(1.75), 0.0, 4.0).stride
    one = velocity[:, round(stride / DT) : round(2 * stride / DT)]
    peak = one[joint("right_ankle")].argmax() / one.shape[1]
    assert 0.85 < peak < 0.93
    assert 2.2 < one[joint("right_knee")].max() < 2.4


def knees(motion: HumanMotion, t: np.ndarray) -> np.ndarray:
    """Flexion of the right and left knee [2, M], degrees."""
    p, hips = motion.positions(t), motion.hip_joints(t)
    knee, ankle = (p[:, [joint(f"{s}_{name}") for s in ("right", "left")]] for name in LEG)
    cosine = ((knee - hips) * (ankle - knee)).sum(axis=0) / motion.person.leg**2
    flexion: np.ndarray = np.degrees(np.arccos(cosine))
    return flexion


LEG = ("knee", "ankle")


@pytest.mark.parametrize("stature", [1.0, 1.2, 1.5, 1.75, 2.1])
@pytest.mark.parametrize("v", [0.6, 0.9, 1.2, 1.5])
def test_knee_angles_of_a_walker(v: float, stature: float) -> None:
    """Swing 60 to 65 degrees, loading 15 to 20, mid-stance 5 to 10 (Perry and Burnfield 2010)."""
    person = Physique(stature)
    walk = Walk(Gait(v * sqrt(stature / 1.75), period_scale=0.94), from_rest=False)
    motion = HumanMotion(person, (walk,), (0.0, 0.0), 0.0, 0.0, 4.0, still(person))
    stride = walk.part(person, 0.0, 4.0).stride
    u = np.arange(0, 1, 2e-3)
    right, left = knees(motion, (1 + u) * stride)
    assert 56 < right.max() < 68
    assert left.max() == pytest.approx(right.max(), abs=0.5)
    assert 0.68 < u[right.argmax()] < 0.82
    assert 12 < right[(u > 0.05) & (u < 0.25)].max() < 26
    assert 5 < right[(u > 0.25) & (u < 0.5)].min() < 13
    assert right.min() > 3


@pytest.mark.parametrize("stature", [1.0, 1.3, 1.75, 2.1])
def test_people_stand_on_straight_legs(stature: float) -> None:
    """Knees are bent by 5 degrees (0 to 5 of real people), before a walk and after it, too."""
    person = Physique(stature)
    for movement in (Stand(), Walk(Gait(1.1 * sqrt(stature / 1.75)), 1.5)):
        motion = HumanMotion(person, (movement,), (0.0, 0.0), 0.0, 1.0, 8.0, Idle(person))
        for t in (np.linspace(0.0, 0.99, 40), np.linspace(6.0, 8.0, 40)):
            assert knees(motion, t).max() < 6.0
            assert knees(motion, t).min() > 4.0


def test_steps_a_minute() -> None:
    for v, steps in ((0.8, 83), (1.2, 101), (1.5, 113), (2.0, 131)):
        stride = Walk(Gait(v)).part(Physique(1.75), 0.0, 3.0).stride
        assert 120 / stride == pytest.approx(steps, abs=1.05)


def test_starting_takes_two_steps() -> None:
    walking = Walk(Gait(1.2)).part(Physique(1.75), 0.0, 5.0)
    first = [track.falls.after[0, 0] - track.falls.before[0, 0] for track in walking._foot_tracks]
    assert first[0] == pytest.approx(0.64, abs=0.02)
    assert first[1] == pytest.approx(0.64 + 0.72, abs=0.03)


def test_stopping_takes_one_to_one_and_a_half_seconds() -> None:
    for phase in (0.0, 0.3, 0.6, 0.9):
        walking = Walk(Gait(1.2, phase=phase), 2.0, from_rest=False).part(Physique(1.75), 0.0, 5.0)
        assert 0.95 < walking.end - 2.0 < 1.55


@pytest.mark.parametrize(
    ("movement", "name", "expected"),
    [
        (Punch(), "right_hand", 3.2),
        (Kick(), "right_ankle", 7.2),
        (Turn(), "right_hand", 0.8),
        (StandUp(), "head", 1.17),
        (StandUp(), "hip", 0.9),
    ],
)
def test_peak_speeds(movement: Movement, name: str, expected: float) -> None:
    assert speed(positions(movement, 4.0), name) == pytest.approx(expected, rel=0.07)


@pytest.mark.parametrize("fall", [FallForward(), FallBackward(), FallSideways()])
def test_falls_are_as_fast_as_real_ones(fall: Movement) -> None:
    """Choi et al. 2015, mean and two standard deviations: pelvis 2.1 +- 0.6, head 2.9 +- 0.9."""
    p = positions(fall, 1.5)
    down = -np.diff(p[2], axis=1).min(axis=1) / DT
    assert 1.6 < down[joint("hip")] < 2.7
    assert 2.2 < down[joint("head")] < 4.6
    assert speed(p, "right_hand") < 2.9 + 2 * 1.6
    lying = p[2, :, -1]
    assert lying[[joint("head"), joint("torso"), joint("hip")]].max() < 0.35
    assert lying.min() > 0.02


@pytest.mark.parametrize(
    "fall",
    [
        *(FallFromSeat(ahead=ahead, rising=r) for ahead in (True, False) for r in (0.0, 0.8)),
        *(FallSideways(1.0, seat=Seat(), rising=rising) for rising in (0.0, 0.8)),
    ],
)
def test_falls_off_a_seat_are_slower_and_do_not_rise(fall: Movement) -> None:
    """From half the height the pelvis lands slower than from standing, on the floor."""
    p = positions(fall, 3.0)
    hip = p[2, joint("hip")]
    assert 0.9 < -np.diff(hip).min() / DT < 2.1
    assert -np.diff(p[2, joint("head")]).min() / DT < 2.9 + 0.9
    assert hip[-1] < 0.2
    assert hip.max() < hip[0] + (0.32 if fall.rising else 0.08)


def test_hands_are_down_when_the_trunk_is_that_break_a_fall() -> None:
    """Before the trunk is at its lowest, and the head stays off the floor."""
    for fall, hand in (
        (FallForward(prone=OnFours()), "right_hand"),
        (FallBackward(supine=Sitting()), "right_hand"),
        (FallSideways(caught=0.6), "left_hand"),
    ):
        z = positions(fall, 2.5)[2]
        assert np.flatnonzero(z[joint(hand)] < 0.08)[0] <= z[joint("torso")].argmin()
        assert z[joint("head"), -1] > 0.45


@pytest.mark.parametrize("direction", STUMBLES)
def test_a_stumble_is_caught_by_quick_steps(direction: str) -> None:
    """Steps of 15 to 35 % of the stature, and the trunk comes back."""
    p = positions(STUMBLES[direction], 1.5)
    feet = p[:2, [joint("right_ankle"), joint("left_ankle")]]
    first = np.linalg.norm(np.diff(feet[:, :, [0, 450]], axis=2)[..., 0], axis=0).max()
    assert 0.15 < first / 1.75 < 0.35
    trunk = p[:, joint("head")] - p[:, joint("hip")]
    leant = np.degrees(np.arccos(trunk[2] / np.linalg.norm(trunk, axis=0)))
    assert 10 < leant.max() < 36
    assert leant[-1] < 0.1
    assert p[2, joint("hip"), -1] == pytest.approx(p[2, joint("hip"), 0], abs=1e-6)


def test_a_walker_who_trips_pitches_steps_quickly_and_walks_on() -> None:
    trips, walks = (positions(Walk(Gait(0.7, trip=trip), 5.0), 8.0) for trip in (radians(30), 0.0))
    ahead = (trips - walks)[0, joint("head")]
    assert 0.25 < ahead[2400:4500].max() < 0.4
    assert np.abs(ahead[-1]) < 0.01
    moving = np.abs(np.diff(trips[0, joint("right_ankle")])) > 1e-5
    plain = np.abs(np.diff(walks[0, joint("right_ankle")])) > 1e-5
    assert moving[2500:4200].mean() != plain[2500:4200].mean()


@pytest.mark.parametrize("lies", TRIES)
def test_who_tries_to_get_up_comes_part_of_the_way_and_sinks_back(lies: str) -> None:
    p = positions(TryToGetUp(before=lies), 3.2)
    head = p[2, joint("head")]
    assert 0.05 < head.max() - head[0] < 0.6
    np.testing.assert_allclose(p[..., -1], p[..., 0], atol=1e-9)


@pytest.mark.parametrize("lies", TRIES)
def test_whoever_lies_on_belly_or_back_gets_up(lies: str) -> None:
    """Within human speeds, to where standing people are."""
    p = positions(GetUp(before=lies), 3.2)
    standing = positions(Stand(1.0), 1.0)
    np.testing.assert_allclose(p[2, :, -1], standing[2, :, 0], atol=1e-9)
    assert speed(p, "head") < 1.85
    assert speed(p, "right_ankle") < 1.2


def test_a_fall_ahead_lies_flat() -> None:
    assert positions(FallForward(), 1.5)[2, : joint("hip"), -1].max() < 0.35
    assert positions(FallForward(), 1.5)[2, joint("hip") :, -1].max() < 0.12


def test_falls_go_in_their_direction() -> None:
    for fall, axis, sign in (
        (FallForward(), 0, 1),
        (FallBackward(), 0, -1),
        (FallSideways(), 1, 1),
        (FallSideways(side=-1.0), 1, -1),
    ):
        p = positions(fall, 1.5)
        assert sign * p[axis, joint("head"), -1] > 1.0


def test_a_hand_gets_what_lies_on_the_floor() -> None:
    p = positions(Grab(), 4.0)
    bottom = p[:, joint("right_hand"), int(1.4 / DT)]
    assert bottom[2] == pytest.approx(0.27, abs=0.02)
    assert bottom[0] == pytest.approx(0.37, abs=0.02)


def test_sitting_down_is_standing_up_backwards() -> None:
    down, up = positions(SitDown(2.0), 2.001), positions(StandUp(2.0), 2.001)
    np.testing.assert_allclose(down, up[..., ::-1], atol=1e-9)


def test_people_get_up_over_hands_and_knees() -> None:
    """Hands bear on the floor until the hips are above the knees."""
    p = positions(GetUp(), 3.2)
    on_all_fours = int(0.36 * 3.0 / DT)
    assert p[2, joint("right_hand"), on_all_fours] < 0.1
    assert p[2, joint("hip"), on_all_fours] > 0.45
    assert p[2, joint("right_knee"), on_all_fours] < 0.2
    assert p[2, joint("head"), -1] > 1.45


def test_arms_swung_as_a_prototype_did_would_get_up_through_the_floor() -> None:
    """Shoulders from 165 to 70 degrees while the trunk is down: hands 7 cm below the floor."""
    person, up = Physique(1.75), GetUp()
    course = up.part(person, 0.0).course
    steps = [
        Step(channel, to - start, at, length)
        for channel, start, to, at, length in (
            ("trunk", radians(88), radians(50), 0.06, 1.35),
            ("right_shoulder", radians(165), radians(70), 0.0, 1.2),
        )
    ]
    swung = Course.of(course.at(0.0) | {"hands": 0.0, "right_shoulder": radians(165)}, steps)
    p = np.empty((3, 13, 100))
    t = np.linspace(0, 1, 100)
    planted = replace(up.part(person, 0.0), course=swung)
    planted.pose(t, still(person)(t)).joints(person, p)
    assert p[2, joint("right_hand")].min() < -0.05
    assert positions(up, 3.0)[2].min() > 0.02


def test_elbow_curve_is_continuous_across_gaits() -> None:
    for rv in (0.5, 1.3):
        below, above = curves.elbow(rv - 1e-9), curves.elbow(rv + 1e-9)
        np.testing.assert_allclose(below, above, atol=1e-6)


def test_curves_at_their_points() -> None:
    """Eight harmonics keep to the published points within 0.1 degrees (thorax: within 0.5)."""
    u = np.array([0.05, 0.5, 0.9])
    elbow = np.degrees(curves.elbow(0.9) @ curves.basis(u))
    np.testing.assert_allclose(elbow, [10, 32, 12.5], atol=0.1)
    thorax = np.degrees(curves.thorax_yaw(3.0) @ curves.basis(np.array([0.1, 0.4, 0.6, 0.9])))
    np.testing.assert_allclose(thorax, [4, -4.5, -4, 4.5], atol=0.5)


def test_sway_has_the_deviation_asked_for() -> None:
    t = np.arange(0, 2000, 0.05)
    waves = Waves.low_pass(0.004, tuple(np.arange(8.0)))
    assert waves(t).std() == pytest.approx(0.004, rel=0.02)
    rate = np.gradient(waves.integral(t), t)
    np.testing.assert_allclose(rate[1:-1], waves(t)[1:-1], atol=1e-4)


def test_a_repetition_may_be_faster_or_smaller() -> None:
    usual = positions(Punch(frequency=0.35), 0.9)
    varied = positions(Punch(frequency=0.35, paces=(0.8,), sizes=(0.9,)), 0.9)
    hand = joint("right_hand")
    assert varied[0, hand].max() < usual[0, hand].max() - 0.01
    assert np.argmax(varied[0, hand]) < np.argmax(usual[0, hand])


def test_turns_of_the_trunk_vary() -> None:
    """Each to both sides of its own angle and time; from one to the next both change smoothly."""
    usual = positions(Turn(), 12.0)
    varied = positions(Turn(paces=(1.0, 1.3, 0.8, 1.1), sizes=(1.0, 0.7, 1.1, 0.9)), 12.0)
    across = usual[0, joint("right_shoulder")], varied[0, joint("right_shoulder")]
    peaks = [np.abs(y[s : s + 2000]).max() for y in across for s in range(0, 10000, 2200)]
    assert np.ptp(peaks[:5]) < 2e-3
    assert np.ptp(peaks[5:]) > 0.02
    np.testing.assert_array_equal(usual[..., 0], varied[..., 0])
    jumps = [np.abs(np.diff(p, n=2, axis=2)).max() / DT**2 for p in (usual, varied)]
    assert jumps[1] < 2.5 * jumps[0]


def test_no_elbow_bends_backwards() -> None:
    idle = Idle(Physique(1.75), fidgets=(Fidget("left_elbow", -0.3, 0.0, 1.0),))
    with pytest.raises(ValueError, match="no elbow bends backwards"):
        _ = idle(np.zeros(1)).lean


@pytest.mark.parametrize("gait", [{"speed": 0.0}, {"speed": -1.0}])
def test_a_gait_needs_a_speed_above_0(gait: dict[str, float]) -> None:
    with pytest.raises(ValueError, match="speed above 0"):
        Gait(**gait)


def test_movements_start_from_a_common_rest_pose() -> None:
    """At rest everybody stands as `Physique` says, whatever comes next."""
    person = Physique(1.8)
    pose = positions(Grab(), 0.01, 1.8)[..., 0]
    for movement in (Kick(from_rest=True), Punch(from_rest=True), Turn(from_rest=True)):
        np.testing.assert_allclose(positions(movement, 0.01, 1.8)[..., 0], pose, atol=1e-12)
    np.testing.assert_allclose(positions(Walk(Gait(1.0)), 0.01, 1.8)[..., 0], pose, atol=1e-12)
    assert pose[2, joint("hip")] == pytest.approx(person.rest_height, abs=1e-12)
    assert np.allclose(
        pose[1, [joint("right_ankle"), joint("left_ankle")]], [-person.hip, person.hip]
    )
    assert radians(2) < person.rest_lean < radians(3)


@pytest.mark.parametrize("stature", [1.0, 1.4, 2.0])
def test_steps_of_a_stumble_are_no_longer_than_legs_allow(stature: float) -> None:
    """A child's leg that is asked to stretch over an adult's step straightens within a moment.

    With an adult's steps a child's knee had 216 m/s^2; with its own, and legs that get as straight
    as people's, it has 131.
    """
    stumbling = {"activities": ["stumbling"], "subject": {"height_m": stature}}
    config = Config.model_validate(stumbling)
    motion = motion_of(draw_scene(config, config.chosen_activities[0], 1).people[0])
    p = motion.positions(np.arange(0, config.duration_s, DT))
    acceleration = np.linalg.norm(np.diff(p, n=2, axis=2), axis=0).max() / DT**2
    assert acceleration < 140
