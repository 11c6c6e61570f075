"""Running: flight, planted feet, steps by speed, starts and stops, all statures."""

from itertools import pairwise
from math import inf, radians, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.motion.human.idle import Fidget, Idle, Sway, Waves, motionless, spread_phases
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.quintics import Quintics
from radhar_cli.motion.movements.running import GoRunning, RunningGait, step_times
from radhar_cli.motion.movements.standing import Stand
from radhar_cli.motion.skeleton import JOINTS, PARENTS

G, DT = 9.81, 1e-3
FEET = [JOINTS.index(name) for name in ("right_ankle", "left_ankle")]
HIP = JOINTS.index("hip")
SPEEDS = [2.5, 3.0, 4.0, 5.0, 6.0]


def running(
    speed: float, stature: float = 1.75, seconds: float = inf, **more: object
) -> HumanMotion:
    person = Physique(stature)
    gait = RunningGait(speed, **more)  # type: ignore[arg-type]
    run = GoRunning(gait, seconds, from_rest=seconds < inf)
    return HumanMotion(person, (run,), (0.0, 0.0), 0.0, 0.5, 6.0, motionless(person))


def velocity(p: np.ndarray) -> np.ndarray:
    v: np.ndarray = np.gradient(p, DT, axis=-1)
    return v


@pytest.mark.parametrize("speed", [0.0, *SPEEDS])
def test_in_flight_the_hip_falls_freely_and_keeps_its_speed(speed: float) -> None:
    motion = running(speed)
    contacts = motion.parts[0][0]._contacts
    for one, following in pairwise(contacts[2:7]):
        t = np.arange(one.off + 2 * DT, following.down - 2 * DT, DT)
        assert t.size > 20
        p = motion.positions(t)
        np.testing.assert_allclose(np.diff(p[2, HIP], 2) / DT**2, -G, atol=1e-3)
        np.testing.assert_allclose(np.diff(p[0, HIP], 2) / DT**2, 0.0, atol=1e-3)
        assert (p[2, FEET] > Physique(1.75).ankle).all(axis=0).mean() > 0.9


@pytest.mark.parametrize("speed", [0.0, *SPEEDS])
def test_a_foot_on_the_floor_stays(speed: float) -> None:
    motion = running(speed)
    for foot, stances in zip(FEET, motion.parts[0][0]._stances, strict=True):
        for stance in stances[2:5]:
            t = np.linspace(stance.down, stance.heel, 20)
            assert np.ptp(motion.positions(t)[:, foot], axis=1).max() < 1e-9


@pytest.mark.parametrize("speed", SPEEDS)
def test_steps_of_people(speed: float) -> None:
    """Duty factor, steps, rise and fall, and speed of the feet, beside Novacheck's and Dorn's."""
    step, contact = step_times(speed, 1.75)
    assert 2.6 < 1 / step < 3.4
    assert 0.25 < contact / (2 * step) < 0.41
    t = np.arange(1.0, 1.0 + 4 * step, DT)
    p = running(speed).positions(t)
    assert (p[0, HIP, -1] - p[0, HIP, 0]) / (t[-1] - t[0]) == pytest.approx(speed, rel=0.02)
    assert 0.06 < np.ptp(p[2, HIP]) < 0.10
    assert 1.8 < velocity(p[0, FEET[0]]).max() / speed < 2.5
    assert velocity(velocity(p[2, HIP])).max() < 2 * G  # a force of 3 times the weight


def test_the_pelvis_rises_and_falls_less_at_speed() -> None:
    """Some 95 mm at 2.5 to 3 m/s, 60 to 70 at 5 to 6."""
    for stature in (1.75, 1.55):
        scale, rises = sqrt(stature / 1.75), []
        for speed in SPEEDS:
            step, _ = step_times(speed * scale, stature)
            t = np.arange(1.0, 1.0 + 4 * step, DT)
            heights = running(speed * scale, stature).positions(t)[2, HIP]
            rises.append(1e3 * np.ptp(heights) / scale**2)
        assert 84 < min(rises[:2]) <= max(rises[:2]) < 100
        assert 58 < rises[4] < 72
        assert 64 < rises[3] < 78
        assert rises[1] > rises[2] > rises[3] > rises[4]


def test_steps_come_faster_with_speed_as_measured() -> None:
    slow, fast = (1 / step_times(v, 1.75)[0] for v in (3.5, 5.2))
    assert fast / slow == pytest.approx(1.12, abs=0.02)
    assert 1 / step_times(3.0, 1.75)[0] == pytest.approx(2.75, rel=0.03)


def heights_at_equal_froude_numbers(stature: float) -> tuple[np.ndarray, np.ndarray]:
    """Heights [13, M] of all points, over the stature, of who is of 1.75 m and of another."""
    scale = sqrt(stature / 1.75)
    t = np.arange(1.0, 2.0, 0.01)
    usual = running(3.0).positions(0.5 + t)[2] / 1.75
    other = running(3.0 * scale, stature).positions(0.5 + scale * t)[2] / stature
    return usual, other


@pytest.mark.parametrize("stature", [1.5, 2.1])
def test_grown_ups_run_alike_at_equal_froude_numbers(stature: float) -> None:
    usual, other = heights_at_equal_froude_numbers(stature)
    np.testing.assert_allclose(other, usual, atol=1e-3)


def test_children_run_alike_on_shorter_legs() -> None:
    usual, other = heights_at_equal_froude_numbers(1.0)
    child, scaled = Physique(1.0), 2 * Physique(1.75).leg / 1.75
    assert (usual - other)[HIP].mean() == pytest.approx(scaled - 2 * child.leg, abs=0.005)
    np.testing.assert_allclose(np.ptp(other[HIP]), np.ptp(usual[HIP]), atol=0.005)
    np.testing.assert_allclose(other[FEET], usual[FEET], atol=0.03)
    np.testing.assert_allclose(other[JOINTS.index("head")], usual[JOINTS.index("head")], atol=0.005)


@pytest.mark.parametrize("speed", [0.0, 2.5, 6.0])
def test_a_run_begins_and_ends_standing(speed: float) -> None:
    person = Physique(1.75)
    idle = Idle(person)
    run = GoRunning(RunningGait(speed), 2.0)
    motion = HumanMotion(person, (Stand(0.5), run, Stand(1.0)), (0.0, 0.0), 0.3, 0.0, 8.0, idle)
    t = np.arange(0, 7, DT)
    p = motion.positions(t)
    assert np.abs(np.diff(p, 2, axis=2)).max() / DT**2 < 250
    end = motion.parts[1][0].end
    feet = motion.positions(np.array([end, end + 2.0]))[:, FEET]
    np.testing.assert_allclose(feet[..., 0], feet[..., 1], atol=1e-9)
    assert np.hypot(*p[:2, HIP, -1]) == pytest.approx(motion.parts[1][0].place.ahead, abs=0.03)


@pytest.mark.parametrize("knee", [45, 115])
def test_jogging_on_the_spot_stays_there(knee: float) -> None:
    motion = running(0.0, seconds=4.0, knee=radians(knee))
    p = motion.positions(np.arange(0, 6, DT))
    assert np.abs(p[:2, HIP]).max() < 0.05
    lifted = p[2, FEET].max() - Physique(1.75).ankle
    assert 0.05 < lifted < 0.55
    assert motion.phases[1].name == "jogging in place"


def test_a_negative_speed_is_refused() -> None:
    with pytest.raises(ValueError, match="0 m/s or more"):
        RunningGait(-1.0)


@settings(max_examples=60, deadline=None)
@given(
    stature=st.floats(1.0, 2.1),
    speed=st.one_of(st.just(0.0), st.floats(0.8, 6.5)),
    cadence=st.floats(0.85, 1.15),
    seconds=st.one_of(st.just(inf), st.floats(0.3, 4.0)),
    from_rest=st.booleans(),
    jitter=st.floats(0.0, 0.08),
    seed=st.integers(0, 99),
)
def test_everybody_can_run(
    stature: float,
    speed: float,
    cadence: float,
    seconds: float,
    from_rest: bool,
    jitter: float,
    seed: int,
) -> None:
    """Links keep their lengths, no joint is below the floor, whatever the steps and the sway."""
    person, rng = Physique(stature), np.random.default_rng(seed)
    paces, speeds = (1 + jitter * rng.uniform(-1, 1, (2, 40))).tolist()
    gait = RunningGait(
        speed * sqrt(stature / 1.75), cadence, paces=tuple(paces), speeds=tuple(speeds)
    )
    waves = Waves.low_pass(0.01, spread_phases(8))
    idle = Idle(person, Sway(waves, waves), fidgets=(Fidget("shift", 0.05, -1.0, 0.5),))
    run = GoRunning(gait, seconds, from_rest)
    motion = HumanMotion(person, (run,), (0.0, 0.0), 0.0, 0.4, 5.0, idle)
    t = np.arange(0, 5, 4e-3)
    p, hips = motion.positions(t), motion.hip_joints(t)
    assert p[2].min() > 0.8 * person.ankle
    for side, name in enumerate(("right", "left")):
        knee, ankle = (p[:, JOINTS.index(f"{name}_{part}")] for part in ("knee", "ankle"))
        for a, b in ((hips[:, side], knee), (knee, ankle)):
            np.testing.assert_allclose(np.linalg.norm(a - b, axis=0), person.leg, atol=1e-9)
    for joint, parent in enumerate(PARENTS):
        if parent is not None and "knee" not in JOINTS[joint] and "ankle" not in JOINTS[joint]:
            length = np.linalg.norm(p[:, joint] - p[:, parent], axis=0)
            if JOINTS[joint] not in ("head", "hip") and "shoulder" not in JOINTS[joint]:
                assert np.ptp(length) < 1e-9


def test_quintics_go_through_their_knots() -> None:
    rng = np.random.default_rng(3)
    times, knots = np.array([0.0, 0.3, 1.0, 1.1]), rng.standard_normal((4, 3, 2))
    curve = Quintics(times, knots)
    for time, knot in zip(times, knots, strict=True):
        if time < 1.1:
            np.testing.assert_allclose(curve.knot(time), knot, atol=1e-9)
        np.testing.assert_allclose(curve(np.array([time]))[:, 0], knot[0], atol=1e-12)
