"""Limping, sticks, walkers and loads: a leg is spared, hands stay with what they hold."""

from dataclasses import replace
from math import inf, radians, sqrt

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.motion.human.idle import motionless
from radhar_cli.motion.human.lane import Lane
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.movements.aids import walking_with_stick, walking_with_walker
from radhar_cli.motion.movements.carrying import carrying
from radhar_cli.motion.movements.limping import largest_limp, limping
from radhar_cli.motion.movements.walking import Gait, Walk
from radhar_cli.motion.skeleton import JOINTS

DT = 2e-3
ANKLES = [JOINTS.index(f"{side}_ankle") for side in ("right", "left")]
HANDS = [JOINTS.index(f"{side}_hand") for side in ("right", "left")]
TORSO, HEAD, HIP = (JOINTS.index(name) for name in ("torso", "head", "hip"))


def walking(gait: Gait, stature: float = 1.75, seconds: float = inf) -> HumanMotion:
    person = Physique(stature)
    idle = motionless(person)
    walk = Walk(gait, seconds, from_rest=seconds < inf)
    return HumanMotion(person, (walk,), (0.0, 0.0), 0.0, 0.4, 8.0, idle)


def shares_on_floor(motion: HumanMotion) -> np.ndarray:
    """Share of two strides that the right and the left foot lie flat."""
    t = np.arange(2.0, 2.0 + 2 * motion.parts[0][0].stride, DT)
    speed = np.gradient(motion.positions(t)[0, ANKLES], DT, axis=1)
    share: np.ndarray = (np.abs(speed) < 0.02).mean(axis=1)
    return share


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("share", [0.05, 0.15, 0.25])
def test_a_painful_leg_stands_shorter(share: float, side: float) -> None:
    usual = shares_on_floor(walking(Gait(0.9))).mean()
    right, left = shares_on_floor(walking(limping(Gait(0.9), share, side, 0.0)))
    painful, other = (right, left) if side < 0 else (left, right)
    assert other - usual == pytest.approx(usual - painful, abs=0.02)
    assert other - painful == pytest.approx(2 * 0.62 * share, abs=0.03)


@pytest.mark.parametrize("side", [-1.0, 1.0])
def test_a_limper_leans_over_the_painful_leg(side: float) -> None:
    motion = walking(limping(Gait(0.9), 0.15, side, radians(6)))
    t = np.arange(2.0, 2.0 + motion.parts[0][0].stride, DT)
    p = motion.positions(t)
    lean = np.degrees(np.arctan2(p[1, HEAD] - p[1, HIP], p[2, HEAD] - p[2, HIP]))
    assert np.abs(lean).max() == pytest.approx(6, abs=1.5)
    painful = ANKLES[0] if side < 0 else ANKLES[1]
    swings = p[2, painful] > 1.6 * Physique(1.75).ankle
    assert (side * lean[np.abs(lean) > 5]).max() > 5
    assert (side * lean)[swings].mean() < 0


def test_without_a_limp_it_is_a_walk() -> None:
    t = np.arange(0.0, 5.0, 0.05)
    plain, spared = (
        walking(gait).positions(t) for gait in (Gait(1.1), limping(Gait(1.1), 0, 1, 0))
    )
    np.testing.assert_array_equal(plain, spared)


@pytest.mark.parametrize("side", [-1.0, 1.0])
@pytest.mark.parametrize("other", [True, False])
def test_a_stick_keeps_its_length_and_stands(side: float, other: bool) -> None:
    gait = walking_with_stick(limping(Gait(0.8), 0.1, side, 0.0), other)
    motion = walking(gait)
    part = motion.parts[0][0]
    (hand,) = gait.held.sides  # type: ignore[union-attr]
    assert (hand == 0) == ((side > 0) == other)
    t = np.arange(2.0, 2.0 + 2 * part.stride, DT)
    tip = part._aid_track(t)
    tip[2] -= Physique(1.75).ankle
    hands = motion.positions(t)[:, HANDS[hand]]
    length = np.hypot(hands[0] - tip[0], hands[2] - tip[2])
    np.testing.assert_allclose(length, 0.53 * 1.75, atol=0.03)
    stands = np.abs(np.gradient(tip[0], DT)) < 1e-9
    assert stands.mean() == pytest.approx(0.58, abs=0.03)
    assert np.ptp(tip[2][stands]) < 1e-9


def test_hands_on_a_rollator_go_ahead_steadily() -> None:
    motion = walking(walking_with_walker(Gait(0.6), True, radians(16), 1.75))
    t = np.arange(2.0, 5.0, DT)
    hands = motion.positions(t)[:, HANDS]
    speed = np.gradient(hands[0], DT, axis=1)
    assert speed.max() < 0.75
    assert speed.min() > 0.45
    assert np.ptp(hands[2], axis=1).max() < 0.03


@pytest.mark.parametrize("stature", [1.0, 1.4, 1.75, 2.1])
@pytest.mark.parametrize("seconds", [inf, 5.0])
def test_a_frame_is_lifted_once_a_stride_and_not_thrown(stature: float, seconds: float) -> None:
    """It is put ahead by 0.2 to 0.32 statures within 0.5 s or more, from the first one on."""
    usual = Gait(0.45 * 1.3 * sqrt(stature / 1.75))
    motion = walking(walking_with_walker(usual, False, radians(16), stature), stature, seconds)
    stride = motion.parts[0][0].stride
    t = np.arange(0.4, 8.0, DT)
    hands = motion.positions(t)[:, HANDS]
    speed = np.linalg.norm(np.gradient(hands, DT, axis=2), axis=0)
    assert speed.max() < 1.5 * sqrt(stature / 1.75)
    ahead = np.gradient(hands[0, 0], DT)
    whole = (t > 1.6) & (t < 1.6 + 2 * stride)
    assert (ahead[whole] < 0.1).mean() > 0.4
    assert np.diff((ahead[whole] > 0.5 * speed.max()).astype(int)).clip(0).sum() == 2
    gone = np.ptp(hands[0, 0][whole]) / stature
    assert 0.4 < gone < 0.64
    hip = motion.positions(t)[0, HIP]
    assert (hands[0] - hip)[:, whole].min() > 0.0


@pytest.mark.parametrize("bag", [None, 0, 1])
def test_hands_with_a_load_do_not_swing(bag: int | None) -> None:
    motion = walking(carrying(Gait(1.2), bag))
    t = np.arange(2.0, 5.0, DT)
    p = motion.positions(t)
    swing = np.ptp(p[0, HANDS] - p[0, [TORSO]], axis=1)
    still = [0, 1] if bag is None else [bag]
    assert swing[still].max() < 0.12
    if bag is not None:
        assert swing[1 - bag] > 0.2
    else:
        assert (p[0, HANDS] - p[0, [HIP]] > 0.1).all()


@settings(max_examples=60, deadline=None)
@given(
    name=st.sampled_from(("limping", "walking_with_stick", "walking_with_walker", "carrying")),
    stature=st.floats(1.0, 2.1),
    speed=st.floats(0.15, 1.8),
    share=st.floats(0.0, 0.25),
    side=st.sampled_from([-1.0, 1.0]),
    seconds=st.one_of(st.just(inf), st.floats(0.3, 4.0)),
    choices=st.tuples(st.booleans(), st.booleans()),
)
def test_everybody_can(
    name: str,
    stature: float,
    speed: float,
    share: float,
    side: float,
    seconds: float,
    choices: tuple[bool, bool],
) -> None:
    """Arms and legs keep their lengths, no foot slides, nothing is below the floor."""
    choice, turns = choices
    speed = min(speed, 1.0) if name == "walking_with_walker" else speed
    usual = Gait(speed * sqrt(stature / 1.75), lane=Lane(2.5, 1.0) if turns else None)
    limp = limping(usual, min(share, largest_limp(usual.speed, stature)), side, radians(10))
    gait = {
        "limping": limp,
        "walking_with_stick": walking_with_stick(limp, choice),
        "walking_with_walker": walking_with_walker(usual, choice, radians(30), stature),
        "carrying": carrying(usual, int(side > 0) if choice else None),
    }[name]
    motion = walking(gait, stature, seconds)
    person = motion.person
    p = motion.positions(np.arange(0.0, 7.0, 0.01))
    assert p[2].min() > 0.9 * person.ankle
    for limb, length in (("elbow", person.arm), ("ankle", person.leg)):
        for joint in (JOINTS.index(f"{which}_{limb}") for which in ("right", "left")):
            parent = joint - 1
            apart = np.linalg.norm(p[:, joint] - p[:, parent], axis=0)
            np.testing.assert_allclose(apart, length, atol=1e-9)
    assert np.abs(np.diff(p, 2, axis=2)).max() / 0.01**2 < 150


def test_a_limp_has_bounds() -> None:
    with pytest.raises(ValueError, match=r"from 0 to 0\.25"):
        replace(Gait(1.0), limp=0.3)


def test_who_goes_fast_limps_less() -> None:
    assert largest_limp(1.3, 1.75) == 0.25
    assert largest_limp(1.5, 1.75) == pytest.approx(0.19, abs=0.01)
    assert largest_limp(1.3, 1.0) < 0.25
    assert largest_limp(2.8, 2.1) == 0
