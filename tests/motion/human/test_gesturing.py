"""Drinking, writing, waving and clapping: hands go where they should, and through no body."""

from dataclasses import replace
from math import inf

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.config import Config
from radhar_cli.motion.human.idle import Idle, Waves
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.movements.gestures import AT_TABLE, Clap, Drink, Gesture, Wave, Write
from radhar_cli.motion.movements.sitting import Seat, SitDown, StandUp
from radhar_cli.motion.movements.standing import Stand
from radhar_cli.motion.skeleton import JOINTS, PARENTS
from radhar_cli.numerics.arrays import Float
from radhar_cli.scene.single.simulate import simulate

STEP = 1 / 400
RHYTHM = {
    "up": Waves((0.8, 0.8, 0.8), (2.0, 3.9, 5.1), (0.1, 1.4, 2.0)),
    "across": Waves((0.8, 0.8, 0.8), (1.6, 3.1, 4.4), (2.1, 0.4, 5.0)),
}
GESTURES: dict[str, Gesture] = {
    "drinking": Drink(),
    "drinking, cup held": Drink(held=True, left=True),
    "drinking_seated": Drink(seat=Seat()),
    "writing": Write(**RHYTHM),
    "writing, left": Write(left=True, **RHYTHM),
    "writing_seated": replace(AT_TABLE, **RHYTHM),
    "waving": Wave(),
    "waving, both": Wave(both=True),
    "clapping": Clap(),
}
ELBOW_DEG = 150.0  # no elbow bends farther
FASTEST, HARDEST = 6.0, 120.0  # of a hand, m/s and m/s^2; claps are hardest


def motion_of(gesture: Gesture, stature: float = 1.75, duration: float = inf) -> HumanMotion:
    made = replace(gesture, duration=duration)  # type: ignore[type-var]
    person = Physique(stature)
    return HumanMotion(person, (made,), (0.0, 0.0), 0.0, 0.2, 8.0, Idle(person))


def joints_of(motion: HumanMotion, seconds: float = 8.0) -> dict[str, Float]:
    t = np.arange(0, seconds, STEP)
    return dict(zip(JOINTS, motion.positions(t).swapaxes(0, 1), strict=True))


def distance_to_link(p: Float, start: Float, end: Float) -> Float:
    """Distance of points p [3, M] from links [3, M] to [3, M], m."""
    along = end - start
    share = np.clip(((p - start) * along).sum(axis=0) / (along * along).sum(axis=0), 0, 1)
    distance: Float = np.sqrt(((start + share * along - p) ** 2).sum(axis=0))
    return distance


@pytest.mark.parametrize("name", GESTURES)
@given(stature=st.floats(1.5, 2.0), size=st.floats(0.6, 1.15), pace=st.floats(0.7, 1.4))
@settings(max_examples=5, deadline=None)
def test_bodies_stay_whole(name: str, stature: float, size: float, pace: float) -> None:
    gesture = replace(GESTURES[name], sizes=(size,) * 40, paces=(pace,) * 40)  # type: ignore[type-var]
    motion = motion_of(gesture, stature)
    joints = joints_of(motion)
    for number, parent in enumerate(PARENTS):
        if parent is None or JOINTS[number].endswith("knee"):  # which hangs on a hip joint
            continue
        link = joints[JOINTS[number]] - joints[JOINTS[parent]]
        length = np.sqrt((link**2).sum(axis=0))
        if JOINTS[parent] == "torso":  # which breathes
            continue
        assert np.ptp(length) < 1e-9, JOINTS[number]
    for side in ("right", "left"):
        ankle, hand = joints[f"{side}_ankle"], joints[f"{side}_hand"]
        assert np.ptp(ankle, axis=1).max() < 1e-9
        speed = np.diff(hand, axis=1) / STEP
        assert np.abs(speed).max() < FASTEST
        assert np.abs(np.diff(speed, axis=1)).max() / STEP < HARDEST
    assert min(p[2].min() for p in joints.values()) > 0


@pytest.mark.parametrize("name", GESTURES)
def test_arms_bend_as_arms_do_and_pass_beside_head_and_trunk(name: str) -> None:
    joints = joints_of(motion_of(GESTURES[name]))
    neck = joints["torso"] + 0.6 * (joints["head"] - joints["torso"])
    for side in ("right", "left"):
        upper = joints[f"{side}_elbow"] - joints[f"{side}_shoulder"]
        fore = joints[f"{side}_hand"] - joints[f"{side}_elbow"]
        lengths = np.sqrt((upper**2).sum(axis=0) * (fore**2).sum(axis=0))
        cosine = (upper * fore).sum(axis=0) / lengths
        assert np.degrees(np.arccos(cosine.clip(-1, 1))).max() < ELBOW_DEG
        for share in np.linspace(0, 1, 9):
            point = joints[f"{side}_elbow"] + share * fore
            assert np.sqrt(((point - joints["head"]) ** 2).sum(axis=0)).min() > 0.15
            assert distance_to_link(point, joints["hip"], neck).min() > 0.14


@pytest.mark.parametrize("name", GESTURES)
def test_a_bout_begins_and_ends_at_rest(name: str) -> None:
    gesture = GESTURES[name]
    motion = motion_of(gesture, duration=5.0)
    part, _ = motion.parts[0]
    assert part.before == part.after == ("seated" if gesture.seat else "standing")
    p = motion.positions(np.array([0.0, 0.2, part.end, part.end + 0.5]))
    still = p - p[:, 8:9]  # from the hip, which sways
    assert np.abs(still[..., 1] - still[..., 2]).max() < 0.02
    speed = (motion.positions(np.array([part.end + 1e-4])) - p[..., 2:3]) / 1e-4
    assert np.abs(speed).max() < 0.1


@given(lead=st.floats(0, 0.8), period=st.floats(0.2, 1.0), size=st.floats(0.4, 1.3))
@settings(max_examples=10, deadline=None)
def test_palms_meet_and_do_not_pass(lead: float, period: float, size: float) -> None:
    gesture = Clap(lead=lead, period=period, sizes=(size,) * 60)
    motion = HumanMotion(Physique(1.75), (gesture,), (0, 0), 0.0, 0.0, 6.0, Idle(Physique(1.75)))
    joints = joints_of(motion, 6.0)
    apart = np.sqrt(((joints["left_hand"] - joints["right_hand"]) ** 2).sum(axis=0))
    claps = apart[int(1.4 / STEP) :]
    assert claps.min() == pytest.approx(0.03, abs=1e-3)  # half the thickness of two palms
    assert claps.max() > 0.03 + 0.2 * period * size
    assert (joints["left_hand"][1] > joints["right_hand"][1]).all()
    ahead = joints["right_hand"][0] - joints["torso"][0]
    assert ahead[int(1.4 / STEP) :].min() > 0.2


def test_cups_reach_the_mouth_and_waves_the_height_of_the_head() -> None:
    joints = joints_of(motion_of(Drink()))
    to_mouth = np.sqrt(((joints["right_hand"] - joints["head"]) ** 2).sum(axis=0))
    assert 0.15 < to_mouth.min() < 0.22
    assert np.abs(joints["left_hand"] - joints["left_hand"][:, :1]).max() < 0.1
    joints = joints_of(motion_of(Wave()))
    above = (joints["right_hand"] - joints["right_shoulder"])[2][int(1.4 / STEP) :]
    assert above.min() > 0
    swings = np.diff(np.sign(np.diff(joints["right_hand"][1][int(1.4 / STEP) :])))
    assert np.count_nonzero(swings) == pytest.approx(2 * 6.6 / 0.65, abs=3)


def test_peak_speeds_of_drinking_are_those_of_measured_people() -> None:
    joints = joints_of(motion_of(Drink(seat=Seat())))
    speed = np.sqrt((np.diff(joints["right_hand"], axis=1) ** 2).sum(axis=0)) / STEP
    assert 0.5 < speed.max() < 0.9  # 0.63 to 0.72 m/s, medians of the phases


def test_gestures_join_what_comes_before_and_after() -> None:
    person = Physique(1.7)
    drink, write = Drink(seat=Seat(), duration=5.0), replace(AT_TABLE, duration=4.0, **RHYTHM)
    movements = (Stand(0.5), SitDown(), drink, write, StandUp(), Clap(duration=2.0), Wave())
    motion = HumanMotion(person, movements, (0.0, 0.0), 0.0, 0.0, 24.0, Idle(person))
    p = motion.positions(np.arange(0, 24, STEP))
    assert np.abs(np.diff(p, n=2, axis=2)).max() / STEP**2 < HARDEST


KEYS = {
    "drinking": {"left_handed": (0, 1), "drink_s": (3, 20), "cup_held": (0, 1)},
    "drinking_seated": {"left_handed": (0, 1), "drink_s": (3, 20)},
    "writing": {"left_handed": (0, 1), "strokes_hz": (1, 6), "size": (0.4, 1.3)},
    "writing_seated": {"left_handed": (0, 1), "strokes_hz": (1, 6), "size": (0.4, 1.3)},
    "waving": {"waving_hz": (0.5, 2.5), "raise_deg": (30, 100), "both_hands": (0, 1)},
    "clapping": {"clapping_hz": (1, 5), "size": (0.4, 1.3)},
}


@pytest.mark.parametrize(("name", "key"), [(name, key) for name in KEYS for key in KEYS[name]])
@pytest.mark.parametrize("end", [0, 1])
def test_edges_of_keys_are_within_reach_of_the_engine(name: str, key: str, end: int) -> None:
    bodies = ("points", "segments", "surfaces")
    config = Config(
        activities=[name],
        duration_s=2,
        radar={"carrier_hz": 77e9, "bandwidth_hz": 4e9, "prf_hz": 4000, "adc_rate_hz": 5e6},
        motion={
            "range_m": 2.5,
            "gestures": {key: KEYS[name][key][end]},
            "repeating": {"tempo_jitter": 0.2, "size_jitter": 0.15},
        },
        subject={"height_m": (1.5, 2.0)[end]},
        body={"scatterers": bodies[len(key) % 3], "points_per_segment": 3},
        snr_db=None,
        image={"size_px": 32},
    )
    simulation = simulate(config, name)
    assert simulation.maps["stft"].power.any()
    assert np.isfinite(simulation.truth.positions).all()
    assert simulation.accuracy is not None
    assert simulation.accuracy.error_db < -80
