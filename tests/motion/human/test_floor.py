"""Still postures, beds and the floor: nothing sinks in, chests rise, states join."""

from math import inf, pi, radians
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.config import Config
from radhar_cli.motion.activities.activity import first_states, state_after
from radhar_cli.motion.human.idle import Breath, Idle, Sway, Waves
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.human.part import Movement
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.crawling import Crawl, Crawling
from radhar_cli.motion.movements.getting_up import GetUp, TryToGetUp
from radhar_cli.motion.movements.kneeling import Kneel
from radhar_cli.motion.movements.lying import Lie, Rest, TurnOver
from radhar_cli.motion.movements.sitting import Seat, Sit
from radhar_cli.motion.movements.transfer import EDGE, GoToBed, LeaveBed
from radhar_cli.motion.segments import segment_positions, segments_between, thickness
from radhar_cli.motion.skeleton import JOINTS
from radhar_cli.scene.motion import motion_of
from radhar_cli.scene.scene import draw_scene

TORSO = JOINTS.index("torso")
ROLLS = st.floats(-pi, pi)
STATURES = st.floats(1.0, 2.1)
COMPRESSED = 0.018  # by how much flesh and mattress give way, over the stature


def moving(
    *movements: Movement, stature: float = 1.75, breath: Breath | None = None
) -> HumanMotion:
    person = Physique(stature)
    still = Idle(person, Sway(Waves(), Waves()), breath or Breath(0.0, heart=0.0))
    return HumanMotion(person, movements, (0.0, 0.0), 0.0, 0.0, 9.0, still)


def lowest_points(motion: HumanMotion, t: np.ndarray) -> np.ndarray:
    """Lowest point of every ellipsoid of the body [3, S, M], m."""
    stature = motion.person.stature
    segments = segments_between(motion.landmarks)
    start, end, beside = segment_positions(motion, segments, stature, t)
    half = (end - start) / 2
    length = np.linalg.norm(half, axis=0)
    along = half / np.maximum(length, 1e-9)
    aside = beside - along * (along * beside).sum(axis=0)
    aside /= np.maximum(np.linalg.norm(aside, axis=0), 1e-9)
    third = np.cross(along, aside, axis=0)
    thick = thickness(stature, 26 * stature**2)
    radius = thick * np.array([[segment.radius] for segment in segments])
    flat = np.array([[segment.flatness] for segment in segments])
    axes = (length * along, radius * flat * aside, radius / flat * third)
    down = np.sqrt(sum(axis[2] ** 2 for axis in axes))
    towards = sum(axis * axis[2] for axis in axes) / down
    return (start + end) / 2 - towards


@given(stature=STATURES, roll=ROLLS, by=ROLLS, hands=st.floats(0, 1))
@settings(max_examples=20, deadline=None)
def test_who_turns_over_stays_above_the_floor(
    stature: float, roll: float, by: float, hands: float
) -> None:
    motion = moving(TurnOver(Rest(roll, 0.0, hands), by), stature=stature)
    t = np.linspace(0, 5.1, 120)
    assert lowest_points(motion, t)[2].min() > -COMPRESSED * stature
    assert motion.positions(t)[2].min() > 0.02 * stature
    speed = np.linalg.norm(np.diff(motion.positions(t), axis=2), axis=0) / t[1]
    assert speed.max() < 2.5


@given(
    stature=STATURES,
    height=st.floats(0.19, 0.3),
    side=st.sampled_from([-1.0, 1.0]),
    roll=st.sampled_from([0, pi / 2, pi, -pi / 2]),
    hands=st.floats(0, 1),
)
@settings(max_examples=12, deadline=None)
def test_nobody_sinks_into_the_bed(
    stature: float, height: float, side: float, roll: float, hands: float
) -> None:
    rest = Rest(roll, height, hands, bed=True)
    motion = moving(GoToBed(rest, side), LeaveBed(rest, side), stature=stature)
    x, _, z = lowest_points(motion, np.linspace(0, 12.6, 97))
    inside = x < (EDGE - 0.02) * stature
    assert z[inside].min() > (height - COMPRESSED) * stature
    ankles = motion.positions(np.array([-1.0, 12.6]))[:, [-3, -1]]
    np.testing.assert_allclose(ankles[..., 1], ankles[..., 0], atol=1e-9)  # where they began


@pytest.mark.parametrize("roll", [0, 90, -90, 180])
def test_chests_rise_away_from_the_bed(roll: float) -> None:
    """Upwards of who lies on the back or on the belly, ahead of who lies on a side."""
    breath = Breath(0.004, 0.25, 0.0, heart=0.0)
    lying = moving(Lie(Rest(radians(roll))), breath=breath)
    _, y, z = np.ptp(lying.positions(np.linspace(0, 4, 401))[:, TORSO], axis=1)
    if roll in (90, -90):
        assert y == pytest.approx(0.008, rel=0.05)
        assert z < 0.002
    else:
        assert z == pytest.approx(0.008, rel=0.05)
        assert y < 1e-6
    inhaled, exhaled = lying.positions(np.array([1.0, 3.0]))[2, TORSO]
    assert inhaled >= exhaled


@pytest.mark.parametrize("posture", [Sit(), Sit(seat=Seat(recline=0.4)), Kneel(0.0), Kneel(1.0)])
def test_who_sits_or_kneels_breathes_and_sways(posture: Any) -> None:
    person = Physique(1.75)
    motion = HumanMotion(person, (posture,), (0.0, 0.0), 0.0, 0.0, 9.0, Idle(person))
    p = motion.positions(np.linspace(0, 8, 801))
    assert 0.004 < np.ptp(p[0, TORSO]) < 0.04
    assert np.ptp(p[:, JOINTS.index("hip")], axis=1).max() < 1e-9
    assert motion.parts[0][0].end == inf


def test_heights_of_who_kneels() -> None:
    upright, back = (moving(Kneel(b)).positions(np.zeros(1))[2, :, 0] for b in (0.0, 1.0))
    knee, hip, head = (JOINTS.index(name) for name in ("right_knee", "hip", "head"))
    assert upright[knee] == pytest.approx(0.06, abs=0.01)
    assert upright[hip] == pytest.approx(0.50, abs=0.02)
    assert back[hip] == pytest.approx(0.20, abs=0.02)
    assert back[head] < upright[head] - 0.25


LIMBS = [JOINTS.index(f"{side}_{name}") for name in ("knee", "hand") for side in ("right", "left")]


@given(
    stature=STATURES,
    speed=st.floats(0.2, 1.0),
    stride=st.floats(0.8, 1.2),
    misses=st.lists(st.floats(-0.08, 0.08), max_size=7).map(tuple),
)
@settings(max_examples=20, deadline=None)
def test_knees_and_hands_of_crawlers_stay_where_they_are_put(
    stature: float, speed: float, stride: float, misses: tuple[float, ...]
) -> None:
    motion = moving(Crawl(speed, 4.0, stride, misses), stature=stature)
    crawling = motion.parts[0][0]
    assert isinstance(crawling, Crawling)
    t = np.linspace(0, crawling.end, 4001)
    p = motion.positions(t)
    assert p[2].min() > 0.02 * stature
    way = p[0, TORSO, -1] - p[0, TORSO, 0]
    assert way == pytest.approx(4.0 * speed, abs=1e-6)
    steady = (t > 2 * crawling.period) & (t < 4.0)
    limbs = np.diff(p[:, LIMBS][:, :, steady], axis=2) / t[1]
    at_rest = np.abs(limbs).max(axis=0) < 2e-3
    if steady.sum() * t[1] > 1.5 * crawling.period:
        assert (at_rest.sum(axis=0) >= 1).all()  # never in the air
        assert 0.35 < at_rest.mean() < 0.75
    x = p[:, LIMBS]
    assert np.ptp(x[1], axis=1)[2:].max() < 1e-9  # hands go straight ahead
    links = np.linalg.norm(p[:, LIMBS[0]] - motion.hip_joints(t)[:, 0], axis=0)
    np.testing.assert_allclose(links, Physique(stature).leg, atol=1e-9)


def test_diagonal_limbs_swing_together() -> None:
    motion = moving(Crawl(0.7, 9.0))
    t = np.linspace(3, 8, 2001)
    swinging = np.abs(np.diff(motion.positions(t)[0, LIMBS], axis=1)) > 1e-4
    right_knee, left_knee, right_hand, left_hand = swinging
    diagonal = (right_knee & left_hand).mean() + (left_knee & right_hand).mean()
    same_side = (right_knee & right_hand).mean() + (left_knee & left_hand).mean()
    assert diagonal > 2.5 * same_side


def drawn(sequence: list[str], index: int, **motion: Any) -> HumanMotion:
    durations = [1.5 if MOVEMENTS[name].seconds is None else None for name in sequence]
    own = {"own": {"sequence": sequence, "durations_s": durations}}
    config = Config.model_validate(
        {"duration_s": 12.0, "classes": own, "activities": ["own"], "motion": motion}
    )
    found = motion_of(draw_scene(config, config.chosen_activities[0], index).people[0])
    assert isinstance(found, HumanMotion)
    return found


FALLS = {"falling": {"direction": {"choice": ["forward", "backward", "sideways"]}}}
SEQUENCES = [
    "walking lying_down turning_over lying getting_up_from_bed walking",
    "falling lying trying_to_get_up lying getting_up",
    "falling turning_over turning_over getting_up",
    "falling_off_seat lying turning_over lying",
    "lying turning_over trying_to_get_up getting_up walking",
    "lying getting_up_from_bed",
    "sitting_down sitting standing_up",
    "kneeling getting_up walking",
    "walking kneeling_down kneeling getting_up",
    "walking getting_on_fours crawling getting_up",
]


@pytest.mark.parametrize("names", SEQUENCES)
def test_movements_join(names: str) -> None:
    for index in range(5):
        motion = drawn(names.split(), index, **FALLS)
        parts = [part for part, _ in motion.parts]
        assert len(parts) == len(names.split())
        for part in parts[1:]:
            p = motion.positions(part.begin + 1e-5 * np.array([-1.5, -0.5, 0.5, 1.5]))
            assert np.abs(np.diff(p, n=2, axis=2)).max() < 300 * 1e-10


def test_a_bed_is_where_the_sequence_needs_one() -> None:
    for index in range(6):
        bed = drawn(["lying", "getting_up_from_bed"], index).positions(np.zeros(1))
        floor = drawn(["lying", "getting_up"], index).positions(np.zeros(1))
        assert bed[2].min() > 0.25
        assert floor[2].min() < 0.12
    heights = [drawn(["lying"], k).positions(np.zeros(1))[2].min() for k in range(12)]
    assert min(heights) < 0.12
    assert max(heights) > 0.25


def test_states_in_which_a_sequence_may_begin() -> None:
    assert first_states(["lying", "turning_over"]) == ("lying", "in_bed")
    assert first_states(["lying", "getting_up_from_bed"]) == ("in_bed",)
    assert first_states(["lying", "getting_up", "walking"]) == ("lying",)
    assert first_states(["falling", "getting_up_from_bed"]) == ()
    assert state_after("lying", None) == "lying or in_bed"
    assert state_after("walking", "in_bed") is None


def joint(p: np.ndarray, name: str) -> np.ndarray:
    return p[:, JOINTS.index(name)]


def flexion_of_elbows(p: np.ndarray) -> np.ndarray:
    """Flexion of both elbows [2, M], degrees."""
    angles = []
    for side in ("right", "left"):
        shoulder, elbow, hand = (joint(p, f"{side}_{n}") for n in ("shoulder", "elbow", "hand"))
        cosine = ((elbow - shoulder) * (hand - elbow)).sum(axis=0)
        angles.append(np.degrees(np.arccos(cosine / np.linalg.norm(hand - elbow, axis=0) ** 2)))
    return np.array(angles)


def distance_of_shanks(p: np.ndarray) -> float:
    """Least distance of the axes of both shanks, m."""
    shares = np.linspace(0, 1, 21)[:, None]
    axes = []
    for side in ("right", "left"):
        knee, ankle = (joint(p, f"{side}_{name}")[:, None] for name in ("knee", "ankle"))
        axes.append(knee + shares * (ankle - knee))
    right, left = axes
    apart = np.linalg.norm(right[:, :, None] - left[:, None], axis=0)
    return float(apart.min())


@given(stature=STATURES, before=st.sampled_from([GetUp(), TryToGetUp()]))
@settings(max_examples=10, deadline=None)
def test_who_lies_on_the_belly_draws_the_hands_in_without_a_jerk(
    stature: float, before: Movement
) -> None:
    """The first 0.6 s of what follows a fall have no needle that tells of the fall."""
    t = np.arange(0, 0.6, 1e-3)
    p = moving(before, stature=stature).positions(t)
    speed = np.linalg.norm(np.diff(p, axis=2), axis=0) / t[1]
    assert speed.max() < 1.2 * stature / 1.75
    assert flexion_of_elbows(p).max() < 156


@given(
    stature=STATURES,
    roll=st.sampled_from([0, pi / 2, -pi / 2, pi]),
    by=st.sampled_from([pi / 2, -pi / 2, pi, -pi]),
    hands=st.floats(0, 1),
)
@settings(max_examples=20, deadline=None)
def test_a_roll_is_calm_and_limbs_keep_out_of_each_other(
    stature: float, roll: float, by: float, hands: float
) -> None:
    t = np.arange(0, 5.0, 5e-3)
    p = moving(TurnOver(Rest(roll, 0.0, hands), by), stature=stature).positions(t)
    velocity = np.diff(p, axis=2) / t[1]
    assert np.linalg.norm(velocity, axis=0).max() < 1.6 * stature / 1.75
    assert np.linalg.norm(np.diff(velocity, axis=2), axis=0).max() / t[1] < 2 * 9.81
    assert distance_of_shanks(p) > 0.08 * stature / 1.75
    assert flexion_of_elbows(p).max() < 150


@given(stature=STATURES, speed=st.floats(0.2, 0.9))
@settings(max_examples=10, deadline=None)
def test_planted_arms_of_crawlers_are_nearly_straight_and_knees_are_dragged(
    stature: float, speed: float
) -> None:
    motion = moving(Crawl(speed, 9.0), stature=stature)
    crawling = motion.parts[0][0]
    assert isinstance(crawling, Crawling)
    t = np.arange(1.5, 4.5, 1 / 1500) * crawling.period
    p = motion.positions(t)
    speeds = np.linalg.norm(np.diff(p, axis=2), axis=0) / (t[1] - t[0])
    elbows = flexion_of_elbows(p)[:, 1:]
    for side, elbow in zip(("right", "left"), elbows, strict=True):
        planted = speeds[JOINTS.index(f"{side}_hand")] < 1e-3
        assert elbow[planted].max() < 35
        assert speeds[JOINTS.index(f"{side}_elbow"), planted].max() < 0.65 * speed
    assert 2.0 < speeds[JOINTS.index("right_knee")].max() / speed < 2.6
