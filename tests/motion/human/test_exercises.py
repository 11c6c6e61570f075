"""Exercises: free flight, feet that stay, speeds and depths of people, both sides alike."""

from dataclasses import replace

import numpy as np
import pytest
from helpers.movers import usual_movement

from radhar_cli.motion.human.idle import Idle, motionless
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.exercises import EXERCISES
from radhar_cli.motion.skeleton import JOINTS

G = 9.81
FEET = [JOINTS.index(name) for name in ("right_ankle", "left_ankle")]
HIP = JOINTS.index("hip")
PLANTED = ["squatting", "raising_arms", "raising_arms_ahead", "raising_right_arm"]


def moving(name: str, stature: float = 1.75, **more: object) -> HumanMotion:
    person = Physique(stature)
    one = replace(EXERCISES[name], duration=6.0, **more)  # type: ignore[arg-type]
    return HumanMotion(person, (one,), (3.0, 0.0), 0.0, 0.0, 9.0, motionless(person))


def joint(motion: HumanMotion, name: str, t: np.ndarray) -> np.ndarray:
    return motion.positions(t)[:, JOINTS.index(name)]


def test_a_config_can_name_every_exercise() -> None:
    assert {*EXERCISES} <= {*MOVEMENTS}
    for name in EXERCISES:
        one = usual_movement(name, 2.0)
        assert one.part(Physique(1.7), 0.0, 4.0).phases[0].name == EXERCISES[name].name


@pytest.mark.parametrize("name", ["jumping", "jumping_jacks"])
def test_in_the_air_a_body_falls_freely(name: str) -> None:
    motion = moving(name, sizes=(1.0,) * 9)
    part = motion.parts[0][0]
    dt = 1e-3
    for at, air in part._flights[:3]:
        t = np.arange(at + 2 * dt, at + air - 2 * dt, dt)
        z = motion.positions(t)[2, HIP]
        if name == "jumping":  # legs that open move the hip against the centre of mass
            np.testing.assert_allclose(np.diff(z, 2) / dt**2, -G, atol=0.6)
        feet = motion.positions(t)[2, FEET]
        assert feet.min() > Physique(1.75).ankle + 0.02
    standing = [at - 0.11 for at, _ in part._flights[:3]]
    feet = motion.positions(np.array(standing))[2, FEET]
    np.testing.assert_allclose(feet, Physique(1.75).ankle, atol=1e-6)


@pytest.mark.parametrize("name", PLANTED)
def test_feet_stay(name: str) -> None:
    feet = moving(name).positions(np.arange(0, 8, 0.02))[:, FEET]
    assert np.ptp(feet, axis=2).max() < 1e-6


@pytest.mark.parametrize("name", [name for name in tuple(EXERCISES) if "lunge" in name])
def test_the_other_foot_carries_who_lunges(name: str) -> None:
    """Its toes stay: the heel alone rises, and no foot slides along the floor."""
    feet = moving(name).positions(np.arange(0, 8, 0.01))[:, FEET]
    side = int(name.startswith("left"))
    carrying = feet[:, 1 - side]
    assert np.ptp(carrying[:2], axis=1).max() < 1e-6
    moved = feet[:, side]
    fast = np.abs(np.diff(moved[:2], axis=1)).max(axis=0) > 2e-3
    assert (moved[2, 1:][fast] > Physique(1.75).ankle + 0.005).mean() > 0.9


@pytest.mark.parametrize(
    ("name", "what", "low", "high"),
    [
        ("squatting", "hip", 0.6, 1.0),
        ("jumping", "hip", 1.9, 2.5),
        ("jumping_jacks", "right_hand", 4.0, 7.0),
        ("raising_arms", "left_hand", 1.8, 3.2),
        ("right_lunge", "right_ankle", 1.0, 2.0),
        ("left_side_lunge", "hip", 0.4, 1.0),
        ("raising_right_leg", "right_ankle", 0.6, 1.3),
    ],
)
def test_peak_speeds(name: str, what: str, low: float, high: float) -> None:
    t = np.arange(0, 8, 2e-3)
    speed = np.linalg.norm(np.diff(joint(moving(name), what, t)), axis=0).max() / 2e-3
    assert low < speed < high


def test_depths() -> None:
    """A squat as deep as a measured one (MARS: 0.49 m), a jump of 16 cm, arms overhead."""
    t = np.arange(0, 6, 0.01)
    assert np.ptp(joint(moving("squatting"), "hip", t)[2]) == pytest.approx(0.47, abs=0.04)
    hip = joint(moving("jumping"), "hip", t)[2]
    assert hip.max() - hip[0] == pytest.approx(0.24, abs=0.03)  # with the ankles stretched
    hand, head = (joint(moving("raising_arms"), name, t)[2] for name in ("right_hand", "head"))
    assert hand.max() > head[0] + 0.3


@pytest.mark.parametrize("name", [name for name in tuple(EXERCISES) if "right" in name])
def test_left_is_right_in_a_mirror(name: str) -> None:
    t = np.arange(0, 4, 0.05)
    right, left = (moving(one).positions(t) for one in (name, name.replace("right", "left")))
    swapped = [
        JOINTS.index(one.replace("right", "x").replace("left", "right").replace("x", "left"))
        for one in JOINTS
    ]
    left[1] *= -1
    np.testing.assert_allclose(right, left[:, swapped], atol=1e-9)


@pytest.mark.parametrize(("period", "size"), [(0.6, 1.1), (1.8, 0.5)])
@pytest.mark.parametrize("name", ["jumping", "jumping_jacks"])
def test_feet_do_not_slide_however_fast_people_jump(name: str, period: float, size: float) -> None:
    usual = EXERCISES[name].period
    motion = moving(name, period=period * usual, sizes=(size,) * 40, paces=(0.7, 1.3) * 20)
    t = np.arange(0, 8, 1e-3)
    feet = motion.positions(t)[:, FEET]
    low = feet[2, :, 1:] < Physique(1.75).ankle + 1e-3
    assert np.abs(np.diff(feet[:2], axis=2) / 1e-3).max(axis=0)[low].max() < 0.05


def test_an_exercise_that_begins_after_the_recording_is_done_once() -> None:
    motion = HumanMotion(
        Physique(1.7), (EXERCISES["squatting"],), (3.0, 0.0), 0.0, 20.0, 8.0, Idle(Physique(1.7))
    )
    assert np.isfinite(motion.positions(np.arange(0, 8, 0.1))).all()


def test_sizes_and_paces() -> None:
    t = np.arange(0, 8, 0.01)
    usual, small = (
        np.ptp(joint(moving("squatting", sizes=(size,) * 9), "hip", t)[2]) for size in (1.0, 0.5)
    )
    assert small == pytest.approx(usual / 2, rel=0.15)
    second = [moving("squatting", paces=(pace,)).parts[0][0]._repetitions[1] for pace in (1, 1.3)]
    assert second[1].start - second[0].start == pytest.approx(0.3 * 2.7)
