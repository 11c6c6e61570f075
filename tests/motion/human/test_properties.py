"""Properties of every person and activity: stiff links, planted feet, a floor, no jumps."""

from dataclasses import replace
from math import inf, pi, sqrt

import numpy as np
import pytest
from helpers.bodies import links_of
from hypothesis import example, given, settings
from hypothesis import strategies as st

from radhar_cli.motion.human.idle import FIDGETS, SWAY_HZ, Breath, Fidget, Idle, Sway, Waves
from radhar_cli.motion.human.lane import Lane, position_along_lane
from radhar_cli.motion.human.minimum_jerk import Lags
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.human.part import Movement, Place
from radhar_cli.motion.human.physique import Physique, froude_scale
from radhar_cli.motion.human.stepping import StepTo
from radhar_cli.motion.movements.crawling import Crawl
from radhar_cli.motion.movements.exercises import EXERCISES
from radhar_cli.motion.movements.falling import (
    ON_FLOOR,
    ON_FOURS,
    PROPPED,
    SUPINE,
    FallBackward,
    FallForward,
    OnFours,
    Sitting,
)
from radhar_cli.motion.movements.falling_off_seat import FallFromSeat
from radhar_cli.motion.movements.falling_sideways import FallSideways, RiseFromSide
from radhar_cli.motion.movements.getting_up import GetUp, TryToGetUp
from radhar_cli.motion.movements.grabbing import Grab
from radhar_cli.motion.movements.kneeling import GetDown, Kneel, RiseFromKnees
from radhar_cli.motion.movements.lying import Lie, Rest, TurnOver
from radhar_cli.motion.movements.rotating import Turn
from radhar_cli.motion.movements.sitting import Seat, Sit, SitDown, StandUp
from radhar_cli.motion.movements.standing import Stand
from radhar_cli.motion.movements.striking import Kick, Punch
from radhar_cli.motion.movements.stumbling import STUMBLES
from radhar_cli.motion.movements.transfer import GoToBed, LeaveBed, LieStill, RiseFromRest, Settle
from radhar_cli.motion.movements.walking import Gait, Walk
from radhar_cli.motion.skeleton import GROWN_UP, JOINTS, PARENTS

ANKLES = [JOINTS.index("right_ankle"), JOINTS.index("left_ankle")]
KNEES = [JOINTS.index("right_knee"), JOINTS.index("left_knee")]
TORSO = JOINTS.index("torso")
STIFF = 1e-9  # m
BREATHING = 1e-4  # m, links that touch the torso: (4.25 mm)^2/(2 x 0.25 m) = 0.04 mm
PLANTED = 1e-4  # m
HORIZON = 6.0

STATURES = st.floats(1.0, 2.1)
SPEEDS = st.floats(0.3, 2.8)
PHASES = st.lists(st.floats(0, 6.3), min_size=8, max_size=8).map(tuple)
FIDGETING = st.lists(
    st.builds(
        Fidget, st.sampled_from(FIDGETS), st.floats(-0.06, 0.06), st.floats(0, 6), st.floats(0.4, 2)
    ),
    max_size=6,
).map(tuple)
GAITS = st.builds(
    Gait,
    SPEEDS,
    period_scale=st.floats(0.88, 1.05),
    phase=st.floats(0, 1),
    arm_swing=st.floats(0.6, 1.3),
    trunk_pitch=st.floats(-0.05, 0.15),
    ragged=st.builds(
        Waves.low_pass, st.floats(0.0, 0.08), PHASES.map(lambda p: p[:3]), st.just((0.1, 0.25, 0.4))
    ),
    jitter=st.lists(st.floats(-0.03, 0.03), max_size=8).map(tuple),
    widths=st.lists(st.floats(-0.02, 0.03), max_size=8).map(tuple),
)


SOME, SLIDE = Physique(1.7), FallFromSeat(ahead=False)
LEGS_LAG = Lags(0.6, {"shank": 1.0, "thigh": 0.7, "right_elbow": 0.4})
TRUNK_LAGS = Lags(0.6, {"trunk": 1.0, "right_shoulder": 0.5, "left_elbow": 0.9})


def both_ways_up(lying: str) -> tuple[Movement, ...]:
    """Who lies so tries to get up, then does."""
    return TryToGetUp(before=lying), GetUp(before=lying)


def and_up(fall: FallSideways) -> tuple[Movement, ...]:
    """The same of who has fallen to the side."""
    return fall, RiseFromSide(fall, tries=True), RiseFromSide(fall)


BELLY = Rest(pi, 0.0)
IN_BED = Rest(0.0, 0.22, 0.7, bed=True)


def walks_of(gait: Gait) -> dict[str, tuple[Movement, ...]]:
    """The twelve activities, and what else a person can do."""
    steady, off = Walk(gait, from_rest=False), Walk(gait)
    stopping = Walk(gait, 1.5, from_rest=False)
    return {
        "S1": (Stand(),),
        "S2": (Punch(),),
        "S3": (Kick(),),
        "S4": (Grab(),),
        "S5": (SitDown(),),
        "S6": (StandUp(),),
        "S7": (Turn(paces=(1.0, 1.3, 0.7, 1.4), sizes=(1.1, 0.6, 1.15)),),
        "S8": (steady,),
        "to and fro": (Walk(replace(gait, lane=Lane(1.5, 0.5)), from_rest=False),),
        "round and sit": (Walk(replace(gait, lane=Lane(1.0, 0.3, side=-1.0)), 6.0), SitDown()),
        "S9": (StandUp(), off),
        "S10": (stopping, SitDown()),
        "S11": (GetUp(), off),
        "S12": (stopping, FallForward()),
        "backwards": (stopping, FallBackward()),
        "sideways": (FallSideways(),),
        "steps": (StepTo(0.9, Place(0.4)), Grab(), StepTo(0.9, Place(-0.4, 0.05))),
        "out of step": (
            Grab(lowering=LEGS_LAG, rising=TRUNK_LAGS),
            SitDown(seat=Seat(recline=0.4, lap=0.0), recline=(0.0, 1.0), lags=TRUNK_LAGS),
            StandUp(seat=Seat(recline=0.4, lap=0.0), lags=LEGS_LAG),
        ),
        "over the knees": (stopping, FallForward(heels=1.4)),
        "topples off": (FallFromSeat(), TryToGetUp(), GetUp()),
        "topples on rising": (FallFromSeat(rising=0.8, seat=Seat(recline=0.4, lap=0.0)),),
        "slides off": (FallFromSeat(ahead=False), *both_ways_up(ON_FLOOR)),
        "misses the seat": (FallFromSeat(ahead=False, rising=0.8), *both_ways_up(SUPINE)),
        "off to the side": and_up(FallSideways(side=-1.0, seat=Seat(recline=0.2, height=0.33))),
        "aside on rising": and_up(FallSideways(seat=Seat(height=0.24), rising=0.8)),
        "on the hands": (FallForward(prone=OnFours()), *both_ways_up(ON_FOURS)),
        "back on the hands": (stopping, FallBackward(supine=Sitting()), *both_ways_up(PROPPED)),
        "aside on the hands": and_up(FallSideways(caught=0.6)),
        "stumbles": (*STUMBLES.values(), replace(STUMBLES["sideways"], place=Place(0.0, -0.3))),
        "trips": (Walk(replace(gait, trip=0.6), 3.0),),
        "slowly off": (Grab(dwell=-2.0), Walk(replace(gait, start=2.0))),
        "rightwards": (stopping, FallSideways(side=-1.0)),
        "everything": (
            Punch(duration=0.5, from_rest=True),
            Kick(duration=0.5, from_rest=True),
            Turn(duration=1.8, from_rest=True),
            Walk(gait, 0.8),
            StepTo(1.8, Place(turn=3.0), steps=5),
            SitDown(seat=Seat(recline=0.2)),
            StandUp(seat=Seat(recline=0.2)),
            Stand(0.3),
            StepTo(0.9, Place(0.08, -0.05, -0.3)),
            FallForward(),
            GetUp(),
            Grab(),
        ),
        "sits": (Sit(seat=Seat(recline=0.3)),),
        "kneels": (Kneel(1.0),),
        "crawls": (Crawl(gait.speed / 2.8, misses=(0.05, -0.1, 0.0)),),
        "down and up": (GetDown(), Crawl(0.5, 0.6), RiseFromKnees()),
        "lies": (Lie(Rest(0.4, 0.0, 1.0), head=0.7),),
        "turns over": (TurnOver(Rest()), TurnOver(Rest(pi / 2)), TurnOver(BELLY, -pi, 3.0)),
        "to bed and up": (
            GoToBed(IN_BED),
            TurnOver(IN_BED, -pi / 2),
            LeaveBed(replace(IN_BED, roll=-pi / 2)),
        ),
        "falls and turns": (
            FallForward(),
            LieStill(FallForward(), 0.5),
            Settle(FallForward(), -pi),
        ),
        "slides and turns": (SLIDE, Settle(SLIDE), RiseFromRest(Settle(SLIDE).rest(SOME), GetUp())),
        "falls aside and turns": (
            FallSideways(),
            Settle(FallSideways()),
            RiseFromRest(BELLY, GetUp()),
        ),
        **{
            name: (replace(EXERCISES[name], duration=3.0, sizes=(0.8, 1.1)),)
            for name in EXERCISES
            if "left" not in name
        },
    }


ACTIVITIES = tuple(walks_of(Gait(1.2)))


def walkable(gait: Gait, stature: float) -> Gait:
    """Gait whose steps legs reach: where v^2/(g l) is above 1, people can but run."""
    fastest = 0.9 * sqrt(9.81 * 2 * Physique(stature).leg)
    return replace(gait, speed=min(gait.speed, fastest))


def moving(
    what: str,
    stature: float = 1.75,
    gait: Gait | None = None,
    idle: Idle | None = None,
    heading: float = 0.0,
) -> HumanMotion:
    person = Physique(stature)
    movements = walks_of(gait or Gait(1.2))[what]
    begin = 0.0 if what in ("S2", "S3", "S7", "S8", "S10", "S12") else 0.4
    return HumanMotion(
        person, movements, (3.0, -0.5), heading, begin, HORIZON, idle or Idle(person)
    )


def recording(motion: HumanMotion, rate: float) -> np.ndarray:
    last = max((part.end for part, _ in motion.parts if part.end < inf), default=0.0)
    return np.arange(-0.1, max(HORIZON, last) + 0.2, 1 / rate)


def link_errors(motion: HumanMotion, t: np.ndarray) -> dict[str, float]:
    """Largest deviation of each link from its length; thighs from the hip joints."""
    p, hips = motion.positions(t), motion.hip_joints(t)
    errors = {}
    for joint, (parent, link) in enumerate(zip(PARENTS, links_of(motion.person), strict=True)):
        if parent is None:
            continue
        start = hips[:, KNEES.index(joint)] if joint in KNEES else p[:, parent]
        length = np.linalg.norm(p[:, joint] - start, axis=0)
        errors[JOINTS[joint]] = float(np.abs(length - np.linalg.norm(link)).max())
    return errors


def assert_sound(motion: HumanMotion, t: np.ndarray) -> None:
    errors = link_errors(motion, t)
    at_torso = {"head", "hip", "right_shoulder", "left_shoulder"}
    assert max(errors[name] for name in at_torso) < BREATHING
    assert max(error for name, error in errors.items() if name not in at_torso) < STIFF
    assert motion.positions(t)[2].min() > 0


@pytest.mark.parametrize("what", ACTIVITIES)
@given(stature=STATURES, gait=GAITS, ahead=PHASES, aside=PHASES, fidgets=FIDGETING)
@settings(max_examples=6, deadline=None)
def test_links_are_stiff_and_nothing_is_below_the_floor(
    what: str,
    stature: float,
    gait: Gait,
    ahead: tuple[float, ...],
    aside: tuple[float, ...],
    fidgets: tuple[Fidget, ...],
) -> None:
    sway = Sway(Waves.low_pass(0.005, ahead, SWAY_HZ), Waves.low_pass(0.003, aside, SWAY_HZ))
    idle = Idle(Physique(stature), sway, Breath(), fidgets)
    motion = moving(what, stature, walkable(gait, stature), idle)
    assert_sound(motion, recording(motion, 60))


@pytest.mark.parametrize("what", ACTIVITIES)
def test_positions_and_velocities_are_continuous(what: str) -> None:
    """Changes of velocity from sample to sample fall with the sample interval."""
    motion = moving(what)
    worst = []
    for rate in (500, 4000):
        p = motion.positions(recording(motion, rate))
        worst.append(np.abs(np.diff(p, n=2, axis=2)).max() * rate)
    assert worst[1] < worst[0] / 6  # 1/8, and acceleration that the coarse rate does not resolve


@pytest.mark.parametrize(
    "what",
    [
        "S9",
        "S10",
        "S11",
        "S12",
        "backwards",
        "everything",
        "topples off",
        "slides off",
        "on the hands",
    ],
)
def test_position_and_velocity_are_continuous_across_movements(what: str) -> None:
    fidgets = tuple(Fidget(channel, 0.05, 0.1 * k, 0.7) for k, channel in enumerate(FIDGETS))
    motion = moving(what, idle=Idle(Physique(1.75), fidgets=fidgets))
    dt = 1e-5
    for part, _ in motion.parts[1:]:
        p = motion.positions(part.begin + dt * np.array([-1.5, -0.5, 0.5, 1.5]))
        step = np.diff(p, axis=2)
        assert np.abs(step[..., 1]).max() < 1.0 * dt  # no joint is fast at rest
        assert np.abs(np.diff(step, axis=2)).max() < 100 * dt**2


@pytest.mark.parametrize("what", ACTIVITIES)
def test_smooth_between_breakpoints(what: str) -> None:
    """Where no breakpoint is near, a polynomial of degree 7 fits 0.05 s."""
    motion = moving(what)
    kinks = np.array(motion.breakpoints)
    nodes = 0.025 * np.cos(np.pi * (np.arange(24) + 0.5) / 24)
    basis = np.polynomial.chebyshev.chebvander(nodes / 0.025, 7)
    for centre in np.arange(0.2, 5.8, 0.19):
        if kinks.size and np.abs(kinks - centre).min() < 0.03:
            continue
        p = motion.positions(centre + nodes).reshape(-1, nodes.size).T
        fit = basis @ np.linalg.lstsq(basis, p, rcond=None)[0]
        assert np.abs(p - fit).max() < (1e-5 if what == "jumping" else 3e-6)


def jerk_changes(motion: HumanMotion, kinks: np.ndarray, step: float) -> float:
    """The largest change of any point's jerk (m/s^3) within `step` s, kinks left out."""
    t = np.arange(0.0, HORIZON, step)
    jerk = np.diff(motion.landmark_positions(t), 3, axis=2) / step**3
    change = np.abs(np.diff(jerk, axis=2)).max(axis=(0, 1))
    at = t[: change.size] + 2 * step
    far = np.abs(kinks[:, None] - at).min(axis=0, initial=np.inf) > 3 * COARSE
    return float(change[far].max())


COARSE = 1e-3  # s


@pytest.mark.parametrize("what", ACTIVITIES)
def test_every_breakpoint_is_named(what: str) -> None:
    """Between the named ones the jerk changes in proportion to the time, a quarter in a quarter.

    A jump of velocity, acceleration or jerk would not become less.
    """
    motion = moving(what)
    kinks = np.array(motion.breakpoints)
    coarse, fine = (jerk_changes(motion, kinks, step) for step in (COARSE, COARSE / 4))
    assert fine < 0.3 * coarse + 1e-3


def test_a_breakpoint_that_is_not_named_is_found() -> None:
    """Each of who sits down, in turn; jerk jumps there by 60 w/T^3 of a step of w within T."""
    motion = moving("S5")
    kinks = np.unique(motion.breakpoints)
    for number in range(kinks.size):
        others = np.delete(kinks, number)
        if np.abs(others - kinks[number]).min() < 7 * COARSE:
            continue
        coarse, fine = (jerk_changes(motion, others, step) for step in (COARSE, COARSE / 4))
        assert fine > 0.5 * coarse


@given(stature=STATURES, gait=GAITS, from_rest=st.booleans(), duration=st.floats(0.2, 3.0))
@settings(max_examples=40, deadline=None)
def test_feet_of_walkers_stand_still_between_touch_down_and_heel_off(
    stature: float, gait: Gait, from_rest: bool, duration: float
) -> None:
    person, walk = Physique(stature), Walk(walkable(gait, stature), duration, from_rest)
    motion = HumanMotion(person, (walk,), (0.0, 0.0), 0.0, 0.0, 6.0, Idle(person))
    walking = motion.parts[0][0]
    assert_sound(motion, np.linspace(0, 6, 400))
    for ankle, track in zip(ANKLES, walking._foot_tracks, strict=True):
        falls = track.falls
        assert np.all(falls.off < falls.toe)
        assert np.all(falls.toe < falls.down)
        for down, off in zip(falls.down, np.append(falls.off[1:], falls.down[-1] + 1), strict=True):
            foot = motion.positions(np.linspace(down, off, 9))[:, ankle]
            assert np.ptp(foot, axis=1).max() < PLANTED


@given(
    stature=STATURES,
    speed=SPEEDS,
    start=st.sampled_from([0.4, 1.0, 2.0]),
    duration=st.floats(0.2, 2),
)
@settings(max_examples=40, deadline=None)
@example(stature=1.75, speed=1.3, start=2.0, duration=0.3)
def test_who_stops_before_having_gained_speed_stays_above_the_floor(
    stature: float, speed: float, start: float, duration: float
) -> None:
    person = Physique(stature)
    walk = Walk(walkable(Gait(speed, start=start), stature), duration)
    motion = HumanMotion(person, (walk,), (0.0, 0.0), 0.0, 0.0, 6.0, Idle(person))
    p = motion.positions(np.arange(0, 6, 0.01))
    assert p[2].min() > 0.7 * person.ankle
    assert np.abs(np.diff(p, 2, axis=2)).max() / 0.01**2 < 250


@given(
    begins=st.lists(st.floats(2.0, 5.0), max_size=4).map(np.cumsum),
    arc=st.floats(1.0, 1.9),
    side=st.sampled_from([-1.0, 1.0]),
)
@settings(max_examples=30, deadline=None)
def test_a_lane_is_walked_at_its_own_pace(begins: np.ndarray, arc: float, side: float) -> None:
    """As far as the way says, in the direction of the heading; back where it began in 2 turns."""
    s = np.linspace(0, 25, 20001)
    x, y, heading = position_along_lane(s, begins, arc, side)
    middle = 0.5 * (heading[1:] + heading[:-1])
    step = s[1]
    np.testing.assert_allclose(np.diff(x), step * np.cos(middle), atol=1e-7)
    np.testing.assert_allclose(np.diff(y), step * np.sin(middle), atol=1e-7)
    assert heading[-1] == pytest.approx(side * np.pi * begins.size, abs=1e-12)
    if begins.size % 2 == 0:
        assert y[-1] == pytest.approx(0.0, abs=1e-9)


@given(stature=STATURES, speed=SPEEDS)
@settings(max_examples=20, deadline=None)
def test_walkers_slow_down_to_turn_round_on_planted_feet(stature: float, speed: float) -> None:
    lane = Lane(3.0, 0.5, side=-1.0)
    motion = moving("S8", stature, Gait(speed, lane=lane))
    dt = 1e-3
    p = motion.positions(np.arange(0, 6, dt))
    v = np.linalg.norm(np.diff(p[:, TORSO], axis=1), axis=0) / dt
    assert v.max() < 1.5 * speed
    assert speed < 0.5 or v.min() < 0.7 * speed
    ankle = np.linalg.norm(np.diff(p[:, ANKLES], axis=2), axis=0) / dt
    assert np.mean(ankle < 1e-6, axis=1).min() > 0.25
    assert ankle.max() / speed < 4.8


@given(stature=STATURES, speed=st.floats(0.8, 2.8))
@settings(max_examples=30, deadline=None)
@example(stature=1.0, speed=2.0)
@example(stature=1.5, speed=2.1)
def test_ankles_swing_at_three_times_the_walking_speed_and_never_run_back(
    stature: float, speed: float
) -> None:
    """At speeds of grown-ups, and of children at the Froude numbers of those of 1.5 m.

    Children's feet are long for their legs, and roll over more of a step, so that less is left for
    the swing.
    """
    speed *= min(froude_scale(stature, GROWN_UP), 1.0)
    motion = moving("S8", stature, Gait(speed))
    dt = 1e-3
    v = np.diff(motion.positions(np.arange(0, 3, dt)), axis=2)[0] / dt
    slowest = 2.7 - 0.15 * motion.person.childlike
    assert slowest < v[ANKLES].max() / speed < 3.5
    assert v[ANKLES].min() / speed > -0.1
    assert 0.85 < v[TORSO].min() / speed < v[TORSO].max() / speed < 1.15


@given(stature=STATURES, speed=st.floats(0.3, 0.8))
@settings(max_examples=20, deadline=None)
def test_ankles_of_slow_walkers(stature: float, speed: float) -> None:
    motion = moving("S8", stature, Gait(speed))
    dt = 1e-3
    v = np.diff(motion.positions(np.arange(0, 4, dt)), axis=2)[0, ANKLES] / dt
    assert v.max() / speed < 4.6
    assert v.min() / speed > -0.2


@pytest.mark.parametrize("what", ["S1", "S2", "S4", "S5", "S6", "S7", "S11", "S12", "sideways"])
def test_feet_stay_where_they_are(what: str) -> None:
    motion = moving(what)
    t = recording(motion, 100)
    standing = t > motion.parts[-1][0].begin if what == "S12" else t < motion.parts[0][0].end
    feet = motion.positions(t[standing])[:, ANKLES]
    assert np.ptp(feet, axis=2).max() < PLANTED


@pytest.mark.parametrize("heading", [0.7, -2.0])
def test_a_heading_turns_the_motion_about_its_start(heading: float) -> None:
    t = np.linspace(0, HORIZON, 50)
    x, y, z = moving("S9").positions(t) - np.array([3.0, -0.5, 0.0])[:, None, None]
    turned = moving("S9", heading=heading).positions(t)
    c, s = np.cos(heading), np.sin(heading)
    np.testing.assert_allclose(turned[0], 3.0 + c * x - s * y, atol=1e-12)
    np.testing.assert_allclose(turned[1], -0.5 + s * x + c * y, atol=1e-12)
    np.testing.assert_allclose(turned[2], z, atol=1e-12)


def test_positions_depend_on_the_instant_alone() -> None:
    motion = moving("S10")
    t = np.linspace(-0.3, 6.3, 2500)
    shuffled = np.random.default_rng(0).permutation(t.size)
    together = motion.positions(t)
    np.testing.assert_allclose(motion.positions(t[shuffled]), together[..., shuffled], atol=1e-12)
    np.testing.assert_allclose(motion.torso(t), together[:, [TORSO]], atol=1e-12)


def test_whoever_does_not_breathe_has_a_stiff_trunk() -> None:
    person = Physique(1.8)
    motion = moving("S4", 1.8, idle=Idle(person, breath=Breath(chest=0.0, heart=0.0)))
    assert max(link_errors(motion, np.linspace(0, 6, 200)).values()) < STIFF


OVERLAPPING: dict[str, tuple[Movement, ...]] = {
    "sit to walk": (StandUp(), Walk(Gait(1.2))),
    "up and walk": (GetUp(), Walk(Gait(1.2))),
    "walk to sit": (Walk(Gait(1.2), 1.5, from_rest=False), SitDown()),
    "trip": (Walk(Gait(1.2), 1.5, from_rest=False), FallForward()),
    "slip": (Walk(Gait(1.2), 1.5, from_rest=False), FallBackward()),
}
# Ahead of the mean path where the walk ends, so that its last foot is put back.
LAST_STEP_BACK = Gait(
    2.0,
    period_scale=0.953125,
    trunk_pitch=0.0,
    ragged=Waves.low_pass(0.0625, (0.0, 5.0, 3.0), (0.1, 0.25, 0.4)),
)


@pytest.mark.parametrize("what", OVERLAPPING)
@given(stature=STATURES, gait=GAITS, overlap=st.floats(0.05, 0.8), ahead=PHASES)
@example(stature=1.0, gait=Gait(1.0), overlap=0.5, ahead=(0.0,) * 8)
@example(stature=1.0, gait=Gait(1.0), overlap=0.78125, ahead=(0.0,) * 8)
@example(stature=1.09375, gait=LAST_STEP_BACK, overlap=0.5, ahead=(0.0,) * 8)
@settings(max_examples=10, deadline=None)
def test_transitions_may_overlap(
    what: str, stature: float, gait: Gait, overlap: float, ahead: tuple[float, ...]
) -> None:
    """A walk begins before the body is up, or a fall before the walk has come to rest."""
    person = Physique(stature)
    movements = tuple(
        replace(movement, gait=walkable(gait, stature)) if isinstance(movement, Walk) else movement
        for movement in OVERLAPPING[what]
    )
    idle = Idle(person, Sway(Waves.low_pass(0.005, ahead), Waves.low_pass(0.003, ahead)))
    motion = HumanMotion(person, movements, (3.0, 0.0), 0.3, 0.2, HORIZON, idle, (0.0, -overlap))
    assert_sound(motion, recording(motion, 60))
    (first, _), (second, _) = motion.parts
    assert first.end - second.begin == pytest.approx(overlap)
    for instant in (second.begin, first.end):
        p = motion.positions(instant + 1e-5 * np.array([-1.5, -0.5, 0.5, 1.5]))
        assert np.abs(np.diff(p, n=2, axis=2)).max() < 500 * 1e-10  # no jump, no kink


@pytest.mark.parametrize("what", OVERLAPPING)
@pytest.mark.parametrize("begin", [0.1, 0.7, 1 / 3])
def test_an_overlap_longer_than_the_last_movement_begins_with_it(what: str, begin: float) -> None:
    person = Physique(1.75)
    motion = HumanMotion(
        person, OVERLAPPING[what], (9.0, 0.0), 0.0, 0.0, HORIZON, Idle(person), (begin, -50.0)
    )
    (first, _), (second, _) = motion.parts
    assert second.begin == first.begin == begin  # legs may be too short: scenes are drawn again


def test_only_a_walk_overlaps() -> None:
    person = Physique(1.75)
    motion = HumanMotion(
        person, (SitDown(), StandUp()), (2.0, 0.0), 0.0, 0.0, 6.0, Idle(person), (0.0, -0.3)
    )
    with pytest.raises(ValueError, match="only a walk and a movement on planted feet overlap"):
        motion.positions(np.zeros(1))


def test_movements_join_only_where_one_begins_as_the_other_ends() -> None:
    person = Physique(1.75)
    motion = HumanMotion(
        person, (SitDown(), Walk(Gait(1.0))), (2.0, 0.0), 0.0, 0.0, 6.0, Idle(person)
    )
    with pytest.raises(ValueError, match="Walk begins standing, but the movement before ends seat"):
        motion.positions(np.zeros(1))


def test_phases_name_what_is_under_way() -> None:
    phases = moving("S10").phases
    assert [phase.name for phase in phases] == ["standing", "walking", "sitting down", "seated"]
    starts = [phase.start for phase in phases]
    assert starts == sorted(starts)


@given(gait=GAITS)
@settings(max_examples=10, deadline=None)
def test_a_ragged_walk_covers_the_same_distance(gait: Gait) -> None:
    """What a walker is ahead or behind is made up for by the stop."""
    person = Physique(1.75)
    walk = Walk(gait, 2.0)
    regular = replace(gait, ragged=Waves(), jitter=())
    reached = walk.part(person, 0.0, 5.0).place.ahead
    assert reached == pytest.approx(2.0 * gait.speed, abs=1e-9)
    assert reached == pytest.approx(Walk(regular, 2.0).part(person, 0.0, 5.0).place.ahead)
