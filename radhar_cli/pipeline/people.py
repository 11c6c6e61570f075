"""A scene of `motion.model: human` -> a person who moves.

Numbers come from the scene's config. What differs from one repetition, stride or fidget to the next
comes from streams named by (seed, class, index) and in sizes of the config, 0 for none.
"""

from collections.abc import Iterable
from dataclasses import replace
from math import ceil, inf, pi, radians
from typing import TypeVar

import numpy as np

from radhar_cli.activity import MOVEMENTS
from radhar_cli.arrays import Float
from radhar_cli.config.schema import MotionConfig, SequenceConfig, SubjectConfig
from radhar_cli.motion.human.falling import FallBackward, FallForward
from radhar_cli.motion.human.falling_sideways import FallSideways
from radhar_cli.motion.human.getting_up import GetUp
from radhar_cli.motion.human.grabbing import Grab
from radhar_cli.motion.human.idle import (
    FIDGETS,
    GOLDEN,
    SWAY_HZ,
    Breath,
    Fidget,
    Idle,
    Sway,
    Waves,
    spread_phases,
)
from radhar_cli.motion.human.kicking import Kick
from radhar_cli.motion.human.lane import Lane
from radhar_cli.motion.human.minimum_jerk import Lags
from radhar_cli.motion.human.motion import HumanMotion, Movement
from radhar_cli.motion.human.part import Place
from radhar_cli.motion.human.person import Person
from radhar_cli.motion.human.planted import ELBOWS, LEGS_AND_TRUNK, SHOULDERS
from radhar_cli.motion.human.punching import Punch
from radhar_cli.motion.human.repertoire import AROUND, Repertoire
from radhar_cli.motion.human.sitting import Rise, Seat, SitDown, StandUp
from radhar_cli.motion.human.standing import Stand
from radhar_cli.motion.human.stepping import StepTo
from radhar_cli.motion.human.turning import Turn
from radhar_cli.motion.human.walking import Gait
from radhar_cli.randomness import SCENE, stream
from radhar_cli.scene import Scene

M = TypeVar("M", SitDown, StandUp, GetUp, StepTo, FallForward, FallBackward, FallSideways)

RAGGED_HZ = (0.1, 0.25, 0.4)
MIN_STRIDE_S = 0.5  # no stride is shorter
SHUFFLE = 0.9  # duration of a shuffle, s
STEP_S, STEP_LIFT = 0.7, 0.06  # s, m
# How many of the steps before and after go ahead, the others backwards; None for no step. People
# feel for the chair, and leave it.
STEPS = {"sitting_down": (0.0, None), "standing_up": (None, 1.0), "grabbing": (0.8, 0.4)}
SETTLING = 4  # fidgets after such a movement
# Gestures at a settling of size 1: channel, rad, whether after the movement's end or its beginning,
# from when on and for how long, s. Who stands up rocks back first; what was picked up is looked at.
GESTURES = {
    "sitting_down": (),
    "standing_up": (("pitch", -0.05, False, -0.6, 0.5), ("pitch", 0.0, False, -0.1, 0.5)),
    "grabbing": (("right_elbow", 0.4, True, -1.1, 0.8), ("right_elbow", 0.0, True, 0.4, 0.8)),
}
# Standard deviation of a fidget of size 1, m or rad; and of a shuffle, m and rad.
FIDGET_SIZES = {
    "shift": 0.025,
    "lean": radians(1),
    "pitch": radians(3),
    "yaw": radians(4),
    "right_shoulder": radians(8),
    "left_shoulder": radians(8),
    "right_elbow": radians(12),
    "left_elbow": radians(12),
}
SHUFFLE_SIZES = Place(0.04, 0.03, radians(6))
# Sway that does not repeat: frequencies of no common measure, within 10 % of the usual ones.
_SWAY_HZ = tuple(f * (0.9 + 0.2 * (k * GOLDEN % 1)) for k, f in enumerate(SWAY_HZ, 1))


def human_motion(scene: Scene) -> HumanMotion:
    """The person of a scene, doing what its activity asks for."""
    config = scene.config
    motion = config.motion
    person = Person(_f(config.subject.height_m), weight=_f(config.subject.weight_kg))
    movements, pauses = _what(scene)
    return HumanMotion(
        person=person,
        movements=movements,
        start=(_f(motion.range_m), _f(motion.cross_range_m)),
        heading=radians(_f(motion.angle_deg)),
        begin=_begin(scene),
        horizon=_f(config.duration_s),
        idle=_idle(scene, person, movements),
        pauses=pauses,
    )


def _f(number: object) -> float:
    """A number of a scene's config, none left to draw."""
    assert isinstance(number, (int, float)), number
    return float(number)


def _draws(scene: Scene, name: str) -> np.random.Generator:
    return stream(scene.config.seed, SCENE, scene.activity.index, scene.index, 0, name=name)


def _begin(scene: Scene) -> float:
    """When the first movement begins, s; what repeats is under way at 0 s."""
    timing, motion = scene.config.timing, scene.config.motion
    starts = {
        "grabbing": timing.grab_start_s,
        "sitting_down": timing.seat_start_s,
        "standing_up": timing.seat_start_s,
        "sitting_to_walking": timing.rise_start_s,
        "falling_to_walking": timing.rise_start_s,
    }
    rates = {
        "punching": motion.punch_hz,
        "kicking": motion.kick_hz,
        "body_rotating": motion.rotation_hz,
    }
    if timing.walk_begin_s is not None:
        starts["walking"] = timing.walk_begin_s
    slug = scene.activity.slug
    if slug in rates and (rate := _f(rates[slug])):
        return -(_f(motion.cycle_phase) % 1) / rate
    return _f(starts.get(slug, 0.0))


def _what(scene: Scene) -> tuple[tuple[Movement, ...], tuple[float, ...]]:
    """Movements, and the pause before each, s."""
    config, slug = scene.config, scene.activity.slug
    timing = config.timing
    if slug in config.classes:
        return _sequence(scene)
    seconds = {
        "sitting_down": timing.seat_duration_s,
        "standing_up": timing.seat_duration_s,
        "grabbing": timing.grab_duration_s,
        "sitting_to_walking": timing.rise_duration_s,
        "falling_to_walking": timing.rise_duration_s,
        "walking_to_sitting": timing.sit_duration_s,
        "walking_to_falling": timing.fall_duration_s,
    }
    duration = seconds.get(slug)
    can = _repertoire(scene, None if duration is None else _f(duration))
    movements = can.activity(scene.activity.number)
    if slug == "stationary":
        return _shuffling(scene, (Stand(0.0),), 0.0)
    if slug in STEPS:
        movements = _stepping(scene, movements)
        rest = _ends(movements, _begin(scene)) if slug == "grabbing" else inf
        return _shuffling(scene, movements, rest)
    pause = -_f(timing.overlap_s)
    if slug in ("sitting_to_walking", "falling_to_walking") and timing.walk_start_s is not None:
        risen = _begin(scene) + _f(duration)
        pause = _f(timing.walk_start_s) - risen
    return movements, (0.0, pause) if len(movements) > 1 else ()


def _stepping(scene: Scene, movements: tuple[Movement, ...]) -> tuple[Movement, ...]:
    """Movements and the steps before and after them, `motion.step_m` long."""
    length, rng = _f(scene.config.motion.step_m), _draws(scene, "motion.step_m/ways")
    if not length:
        return movements
    steps: list[tuple[Movement, ...]] = []
    for ahead in STEPS[scene.activity.slug]:
        way, left = 1 if rng.random() < (ahead or 0.0) else -1, np.clip(rng.normal(), -2, 2)
        place = Place(way * length, float(SHUFFLE_SIZES.left * left))
        one = StepTo(STEP_S + 0.5 * length, place, lift=STEP_LIFT)
        steps.append(() if ahead is None else (one,))
    return (*steps[0], *movements, *steps[1])


def _ends(movements: Iterable[Movement], begin: float) -> float:
    """When movements that follow each other from `begin` (s) on have come to rest, s."""
    for movement in movements:
        begin = movement.part(Person(1.7), begin, begin).end
    return begin


def _sequence(scene: Scene) -> tuple[tuple[Movement, ...], tuple[float, ...]]:
    """The movements of a class of `classes:`."""
    one = scene.config.classes[scene.activity.slug]
    assert isinstance(one, SequenceConfig)
    movements: list[Movement] = []
    for place, (name, given) in enumerate(zip(one.sequence, one.durations_s, strict=True)):
        usual = MOVEMENTS[name].seconds
        duration = usual if given is None else _f(given)
        can = _repertoire(scene, duration, place)
        movements += can.sequence([name], [inf if duration is None else duration])
    return tuple(movements), tuple(_f(pause) for pause in one.pauses_s)


def _repertoire(scene: Scene, duration: float | None, place: int = 0) -> Repertoire:
    """How this person moves; `duration` (s) is that of a movement that has one."""
    motion = scene.config.motion
    seat = Seat(
        height=_f(motion.seat_height),
        recline=radians(_f(motion.recline_deg)),
        lap=_f(motion.hands_on_lap),
    )
    rise = Rise(lean=radians(_f(motion.lean_deg)))
    scale, steps = _f(motion.strike_scale), ceil(3 * _f(scene.config.duration_s)) + 8
    paces, sizes = _repetitions(scene, steps, place)
    bend = _f(motion.bend_deg)
    lags = _lags(scene, place)
    against = _f(motion.recline_from), SitDown.recline[1]
    sitting = SitDown(seat=seat, rise=rise, recline=against, lags=lags[0])
    moving = 2.5 if duration is None else duration
    return Repertoire(
        gait=_gait(scene, place),
        walk=_f(scene.config.timing.walk_stop_s),
        standing_first=scene.config.timing.walk_begin_s is not None,
        punch=Punch(
            frequency=scale * _f(motion.punch_hz),
            paces=_some(scale * paces),
            sizes=_some(np.minimum(sizes, 1.0)),  # an arm gets no longer
        ),
        kick=Kick(
            frequency=scale * _f(motion.kick_hz), paces=_some(scale * paces), sizes=_some(sizes)
        ),
        grab=Grab(
            down=moving * 1.2 / 2.5,
            dwell=_f(motion.dwell_s),
            up=moving * 1.3 / 2.5,
            thigh=radians(-62) * bend / 72,
            trunk=radians(bend),
            reach=radians(_f(motion.reach_deg)),
            other_arm=_f(motion.free_arm),
            squat=_f(motion.squat),
            haste=_f(motion.rise_overlap),
            lowering=lags[0],
            rising=lags[1],
        ),
        sit_down=_lasting(duration, sitting),
        stand_up=_lasting(duration, StandUp(seat=seat, rise=rise, lags=lags[1])),
        turn=Turn(
            frequency=_f(motion.rotation_hz),
            angle=radians(_f(motion.turn_deg)),
            paces=_some(paces),
            sizes=_some(sizes),
        ),
        fall=_fall(scene, duration),
        get_up=_lasting(duration, GetUp()),
        turn_around=_lasting(duration, AROUND),
    )


def _lasting(duration: float | None, movement: M) -> M:
    """The movement with another duration (s), if one is given."""
    return movement if duration is None else replace(movement, duration=duration)


def _lags(scene: Scene, place: int) -> tuple[Lags, Lags]:
    """Which joints lead, going down and coming up."""
    rng = _draws(scene, f"motion.joint_lag/{place}")
    share, channels = _f(scene.config.motion.joint_lag), (*LEGS_AND_TRUNK, *SHOULDERS, *ELBOWS)
    down, up = (
        Lags(share, dict(zip(channels, rng.random(len(channels)).tolist(), strict=True)))
        for _ in range(2)
    )
    return down, up


def _fall(scene: Scene, duration: float | None) -> FallForward | FallBackward | FallSideways:
    motion = scene.config.motion
    if motion.fall == "forward":
        return _lasting(
            duration, FallForward(kneel=_f(motion.kneel_s), heels=radians(_f(motion.heels_deg)))
        )
    if motion.fall == "backward":
        return _lasting(duration, FallBackward())
    left = _draws(scene, "motion.fall/side").random() < 0.5
    return _lasting(duration, FallSideways(side=1.0 if left else -1.0))


def _gait(scene: Scene, place: int) -> Gait:
    motion = scene.config.motion
    strides = ceil(_f(scene.config.duration_s) / MIN_STRIDE_S) + 8
    rng = _draws(scene, f"motion.stride_jitter/{place}")
    # The duration of a stride is the difference of two deviations.
    jitter = _f(motion.stride_jitter) / 2**0.5 * rng.standard_normal(strides)
    widths = _draws(scene, f"motion.width_jitter_m/{place}").standard_normal(strides)
    return Gait(
        speed=_f(motion.speed_mps),
        period_scale=_f(motion.period_scale),
        phase=_f(motion.cycle_phase),
        arm_swing=_f(motion.arm_swing),
        trunk_pitch=radians(_f(motion.trunk_pitch_deg)),
        half_width=_f(motion.step_width) / 2,
        surge=_f(motion.speed_ripple),
        surge_asymmetry=_f(motion.speed_ripple_asymmetry),
        start=_f(motion.speed_up),
        asymmetry=_f(motion.step_asymmetry),
        ragged=_waves(motion, _f(motion.speed_variation), RAGGED_HZ, 0.7),
        jitter=_some(np.clip(jitter, -0.03, 0.03)),
        widths=_some(np.clip(_f(motion.width_jitter_m) * widths, -0.02, 0.03)),
        lane=_lane(scene, place),
    )


def _lane(scene: Scene, place: int) -> Lane | None:
    """How far people walk before they turn round, of which a part may lie behind them."""
    motion = scene.config.motion
    if not (length := _f(motion.lane_m)):
        return None
    left = _draws(scene, f"motion.lane_m/side/{place}").random() < 0.5
    first = (1 - _f(motion.lane_start)) * length
    return Lane(length, first, side=1.0 if left else -1.0)


def _some(numbers: Float) -> tuple[float, ...]:
    """The numbers, or none where all are 0."""
    return tuple(numbers.tolist()) if numbers.any() else ()


def _repetitions(scene: Scene, count: int, place: int) -> tuple[Float, Float]:
    """Pace and size of each repetition, over the usual ones [count]."""
    motion = scene.config.motion
    tempo = _draws(scene, f"motion.tempo_jitter/{place}").standard_normal(count)
    size = _draws(scene, f"motion.size_jitter/{place}").standard_normal(count)
    paces = np.clip(1 + _f(motion.tempo_jitter) * tempo, 0.7, 1.4)
    return paces, np.clip(1 + _f(motion.size_jitter) * size, 0.6, 1.15)


def _waves(motion: MotionConfig, deviation: float, rates: Iterable[float], first: float) -> Waves:
    """Low-pass waves that have been going on for `motion.idle_phase_s`."""
    f = tuple(rates)
    phases = np.array(spread_phases(len(f), first)) + 2 * pi * np.array(f) * _f(motion.idle_phase_s)
    return Waves.low_pass(deviation, tuple(phases % (2 * pi)), f) if deviation else Waves()


def _idle(scene: Scene, person: Person, movements: tuple[Movement, ...]) -> Idle:
    subject: SubjectConfig = scene.config.subject
    motion = scene.config.motion
    since = _f(motion.idle_phase_s)
    sway = Sway(
        _waves(motion, _f(subject.sway_ahead_m), _SWAY_HZ, 0.0),
        _waves(motion, _f(subject.sway_aside_m), _SWAY_HZ, 0.3),
    )
    breathing, pulse = _f(subject.breathing_hz), _f(subject.pulse_hz)
    breath = Breath(
        chest=_f(subject.chest_m),
        breathing=breathing,
        breathing_phase=2 * pi * (breathing * since % 1),
        heart=_f(subject.heart_m),
        pulse=pulse,
        pulse_phase=2 * pi * (pulse * since % 1),
    )
    return Idle(person, sway, breath, (*_fidgets(scene), *_settling(scene, movements)))


def _instants(scene: Scene, rate: float, name: str, start: float) -> list[float]:
    """Instants (s) of a Poisson process from `start` to the end of the recording."""
    end, rng, instants = _f(scene.config.duration_s), _draws(scene, name), []
    at = start
    while rate > 0 and (at := at + rng.exponential() / rate) < end:
        instants.append(at)
    return instants


def _fidgets(scene: Scene) -> Iterable[Fidget]:
    motion = scene.config.motion
    rng = _draws(scene, "motion.fidget_size")
    for at in _instants(scene, _f(motion.fidget_hz), "motion.fidget_hz/times", -1.0):
        yield _fidget(rng, _f(motion.fidget_size), at, (0.5, 1.8))


def _settling(scene: Scene, movements: tuple[Movement, ...]) -> Iterable[Fidget]:
    """Small movements around the end of S4 to S6, and of a look behind before sitting down."""
    motion, slug = scene.config.motion, scene.activity.slug
    if slug not in STEPS:
        return
    begin = _begin(scene)
    if slug == "sitting_down" and (look := radians(_f(motion.look_deg))):
        yield Fidget("yaw", look, begin - 0.3, 0.7)
        yield Fidget("yaw", 0.0, begin + 0.7, 0.9)
    if size := _f(motion.settle_size):
        rng = _draws(scene, "motion.settle_size/fidgets")
        count = next(n for n, one in enumerate(movements, 1) if not isinstance(one, StepTo))
        end = _ends(movements[:count], begin)
        for channel, to, after, start, length in GESTURES[slug]:
            yield Fidget(channel, size * to, (end if after else begin) + start, length)
        for at in sorted(end + rng.uniform(-0.8, 1.2, SETTLING)):
            yield _fidget(rng, size, float(at), (0.4, 1.0))


def _fidget(
    rng: np.random.Generator, size: float, at: float, lengths: tuple[float, float]
) -> Fidget:
    channel = FIDGETS[rng.integers(len(FIDGETS))]
    to = size * FIDGET_SIZES[channel] * np.clip(rng.standard_normal(), -2, 2)
    if channel.endswith("elbow"):
        to = abs(to)  # no arm bends backwards
    return Fidget(channel, float(to), at, float(rng.uniform(*lengths)))


def _shuffling(
    scene: Scene, movements: tuple[Movement, ...], rest: float
) -> tuple[tuple[Movement, ...], tuple[float, ...]]:
    """Movements that end standing at `rest` (s), and after them steps to other stances."""
    if rest == inf:
        return movements, ()
    rng, more, pauses = _draws(scene, "motion.shuffle_hz/places"), [], []
    for at in _instants(scene, _f(scene.config.motion.shuffle_hz), "motion.shuffle_hz/times", rest):
        place = Place(*(np.array(SHUFFLE_SIZES) * np.clip(rng.standard_normal(3), -2, 2)).tolist())
        if at >= rest:
            more.append(StepTo(SHUFFLE, place))
            pauses.append(at - rest)
            rest = at + SHUFFLE
    return (*movements, *more), (*[0.0] * len(movements), *pauses)
