"""A scene of `motion.model: human` -> a person who moves.

Numbers come from the scene's config. What differs from one repetition, stride or fidget to the next
comes from streams named by (seed, class, index) and in sizes of the config, 0 for none.
"""

from collections.abc import Iterable
from dataclasses import replace
from math import ceil, inf, pi, radians
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from radhar_cli.activity import MOVEMENTS
from radhar_cli.arrays import Float
from radhar_cli.motion.human.falling import (
    FallBackward,
    FallForward,
    OnFours,
    Prone,
    Sitting,
    Supine,
)
from radhar_cli.motion.human.falling_from_seat import FallFromSeat
from radhar_cli.motion.human.falling_sideways import FallingSideways, FallSideways, RiseFromSide
from radhar_cli.motion.human.getting_up import GetUp, TryToGetUp
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
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import ELBOWS, LEGS_AND_TRUNK, SHOULDERS
from radhar_cli.motion.human.punching import Punch
from radhar_cli.motion.human.repertoire import AROUND, Repertoire
from radhar_cli.motion.human.sitting import Rise, Seat, SitDown, StandUp
from radhar_cli.motion.human.standing import Stand
from radhar_cli.motion.human.stepping import STUMBLES, StepTo
from radhar_cli.motion.human.turning import Turn
from radhar_cli.motion.human.walking import Gait
from radhar_cli.scene import Numbers, Person

if TYPE_CHECKING:
    from _typeshed import DataclassInstance

Fall = FallForward | FallBackward | FallSideways
M = TypeVar("M", bound="DataclassInstance")  # a movement with a duration

RAGGED_HZ = (0.1, 0.25, 0.4)
MIN_STRIDE_S = 0.5  # no stride is shorter
SHUFFLE = 0.9  # duration of a shuffle, s
STEP_S, STEP_LIFT = 0.7, 0.06  # s, m
# How many of the steps before and after go ahead, the others backwards; None for no step. People
# feel for the chair, and leave it.
STEPS = {"sitting_down": (0.0, None), "standing_up": (None, 1.0), "grabbing": (0.8, 0.4)}
RISING = ("sitting_to_walking", "falling_to_walking")
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


def human_motion(person: Person) -> HumanMotion:
    """A person who does what the activity asks for."""
    motion = person.motion
    physique = Physique(person.subject.height_m, weight=person.subject.weight_kg)
    movements, pauses = _what(person)
    return HumanMotion(
        person=physique,
        movements=movements,
        start=(motion.range_m, motion.cross_range_m),
        heading=radians(motion.angle_deg),
        begin=_begin(person),
        horizon=person.seconds,
        idle=_idle(person, physique, movements),
        pauses=pauses,
    )


def _begin(person: Person) -> float:
    """When the first movement begins, s; what repeats is under way at 0 s."""
    timing, motion = person.timing, person.motion
    starts: dict[str, float] = {
        "grabbing": timing.grab_start_s,
        "sitting_down": timing.seat_start_s,
        "standing_up": timing.seat_start_s,
        "sitting_to_walking": timing.rise_start_s,
        "falling_to_walking": timing.rise_start_s,
    }
    rates: dict[str, float] = {
        "punching": motion.punch_hz,
        "kicking": motion.kick_hz,
        "body_rotating": motion.rotation_hz,
    }
    if timing.walk_begin_s is not None:
        starts["walking"] = timing.walk_begin_s
    slug = person.activity.slug
    if slug in rates and (rate := rates[slug]):
        phase: float = motion.cycle_phase % 1
        return -phase / rate
    return starts.get(slug, 0.0)


def _what(person: Person) -> tuple[tuple[Movement, ...], tuple[float, ...]]:
    """Movements, and the pause before each, s."""
    timing, slug = person.timing, person.activity.slug
    if slug in person.config.classes:
        return _sequence(person)
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
    can = _repertoire(person, None if duration is None else duration)
    movements = can.activity(person.activity.number)
    if slug == "stationary":
        return _shuffling(person, (Stand(0.0),), 0.0)
    if slug in STEPS:
        movements = _stepping(person, movements)
        rest = _ends(movements, _begin(person)) if slug == "grabbing" else inf
        return _shuffling(person, movements, rest)
    pause = -timing.overlap_s
    if duration is not None and slug in RISING and timing.walk_start_s is not None:
        risen = _begin(person) + duration
        pause = timing.walk_start_s - risen
    return movements, (0.0, pause) if len(movements) > 1 else ()


def _stepping(person: Person, movements: tuple[Movement, ...]) -> tuple[Movement, ...]:
    length, rng = person.motion.step_m, person.stream("motion.step_m/ways")
    if not length:
        return movements
    steps: list[tuple[Movement, ...]] = []
    for ahead in STEPS[person.activity.slug]:
        way, left = 1 if rng.random() < (ahead or 0.0) else -1, np.clip(rng.normal(), -2, 2)
        place = Place(way * length, float(SHUFFLE_SIZES.left * left))
        one = StepTo(STEP_S + 0.5 * length, place, lift=STEP_LIFT)
        steps.append(() if ahead is None else (one,))
    return (*steps[0], *movements, *steps[1])


def _ends(movements: Iterable[Movement], begin: float) -> float:
    """When movements that follow each other from `begin` (s) on have come to rest, s."""
    for movement in movements:
        begin = movement.part(Physique(1.7), begin, begin).end
    return begin


def _sequence(person: Person) -> tuple[tuple[Movement, ...], tuple[float, ...]]:
    one, movements = person.own_class, list[Movement]()
    for place, (name, given) in enumerate(zip(one.sequence, one.durations_s, strict=True)):
        usual = MOVEMENTS[name].seconds
        duration = usual if given is None else given
        can = _repertoire(person, duration, place)
        (movement,) = can.sequence([name], [inf if duration is None else duration])
        if isinstance(movement, GetUp | TryToGetUp) and movements:
            movement = _after(movements[-1], movement)
        movements.append(movement)
    return tuple(movements), one.pauses_s


def _after(fall: Movement, up: GetUp | TryToGetUp) -> Movement:
    """How people get up who have fallen, or tried to get up, so."""
    fell = fall.part(Physique(1.7), 0.0, 0.0)
    if isinstance(fell, FallingSideways):
        return RiseFromSide(fell.fall, up.duration, isinstance(up, TryToGetUp))
    return replace(up, before=fell.after)


def _repertoire(person: Person, duration: float | None, place: int = 0) -> Repertoire:
    """How this person moves; `duration` (s) is that of a movement that has one."""
    motion = person.motion
    seat = Seat(
        height=motion.seat_height, recline=radians(motion.recline_deg), lap=motion.hands_on_lap
    )
    rise = Rise(lean=radians(motion.lean_deg))
    scale, steps = motion.strike_scale, ceil(3 * person.seconds) + 8
    paces, sizes = _repetitions(person, steps, place)
    bend = motion.bend_deg
    lags = _lags(person, place)
    sitting = SitDown(seat=seat, rise=rise, lags=lags[0])
    moving = 2.5 if duration is None else duration
    return Repertoire(
        gait=_gait(person, place),
        walk=person.timing.walk_stop_s,
        standing_first=person.timing.walk_begin_s is not None,
        punch=Punch(
            frequency=scale * motion.punch_hz,
            paces=_some(scale * paces),
            sizes=_some(np.minimum(sizes, 1.0)),  # an arm gets no longer
        ),
        kick=Kick(frequency=scale * motion.kick_hz, paces=_some(scale * paces), sizes=_some(sizes)),
        grab=Grab(
            down=moving * 1.2 / 2.5,
            dwell=motion.dwell_s,
            up=moving * 1.3 / 2.5,
            thigh=radians(-62) * bend / 72,
            trunk=radians(bend),
            lowering=lags[0],
            rising=lags[1],
        ),
        sit_down=_lasting(duration, sitting),
        stand_up=_lasting(duration, StandUp(seat=seat, rise=rise, lags=lags[1])),
        turn=Turn(
            frequency=motion.rotation_hz,
            angle=radians(motion.turn_deg),
            paces=_some(paces),
            sizes=_some(sizes),
        ),
        fall=_fall(person, duration),
        fall_on_hands=_fall(person, duration, caught=True),
        fall_off_seat=_fall_from(seat, person, 1.0 if duration is None else duration),
        fall_on_rising=_fall_from(seat, person, 1.7 if duration is None else duration, 0.5),
        stumble=_lasting(duration, _stumble(person)),
        trip=radians(motion.stumble_deg),
        get_up=_lasting(duration, GetUp()),
        try_to_get_up=_lasting(duration, TryToGetUp()),
        turn_around=_lasting(duration, AROUND),
        exercise_period=motion.exercise_period,
        exercise_paces=_some(paces),
        exercise_sizes=_some(motion.exercise_size * np.minimum(sizes, 1.05)),
    )


def _lasting(duration: float | None, movement: M) -> M:
    """The movement with another duration (s), if one is given."""
    return movement if duration is None else replace(movement, duration=duration)


def _lags(person: Person, place: int) -> tuple[Lags, Lags]:
    """Which joints lead, going down and coming up."""
    rng = person.stream(f"motion.joint_lag/{place}")
    share, channels = person.motion.joint_lag, (*LEGS_AND_TRUNK, *SHOULDERS, *ELBOWS)
    down, up = (
        Lags(share, dict(zip(channels, rng.random(len(channels)).tolist(), strict=True)))
        for _ in range(2)
    )
    return down, up


def _side(person: Person) -> float:
    """1 for a fall to the left, -1 to the right."""
    return 1.0 if person.stream("motion.fall/side").random() < 0.5 else -1.0


def _fall(person: Person, duration: float | None, caught: bool = False) -> Fall:
    """A fall from standing, broken by the hands or not."""
    motion = person.motion
    if motion.fall == "forward":
        prone, heels = OnFours() if caught else Prone(), radians(motion.heels_deg)
        return _lasting(duration, FallForward(prone=prone, heels=heels))
    if motion.fall == "backward":
        return _lasting(duration, FallBackward(supine=Sitting() if caught else Supine()))
    aside = FallSideways(side=_side(person), caught=radians(36) if caught else 0.0)
    return _lasting(duration, aside)


def _fall_from(
    seat: Seat, person: Person, whole: float, rises: float = 0.0
) -> FallFromSeat | FallSideways:
    """A fall off a seat within a `whole` duration, s, of which people rise for a share."""
    rising, duration = rises * whole, (1 - 0.75 * rises) * whole
    if person.motion.fall == "sideways":
        return FallSideways(duration, _side(person), seat=seat, rising=rising)
    return FallFromSeat(duration, person.motion.fall == "forward", rising, seat)


def _stumble(person: Person) -> StepTo:
    motion = person.motion
    one, pitch = STUMBLES[motion.fall], radians(motion.stumble_deg)
    if motion.fall == "forward":
        return replace(one, pitch=pitch)
    if motion.fall == "backward":
        return replace(one, pitch=-0.4 * pitch)
    side = _side(person)
    return replace(one, place=Place(0.0, side * one.place.left), lean=side * 0.4 * pitch)


def _gait(person: Person, place: int) -> Gait:
    motion = person.motion
    strides = ceil(person.seconds / MIN_STRIDE_S) + 8
    rng, varies = person.stream(f"motion.speed_variation/{place}"), motion.speed_variation
    # The duration of a stride is the difference of two deviations.
    jitter, widths = (share * varies * rng.standard_normal(strides) for share in (8**-0.5, 1 / 3))
    return Gait(
        speed=motion.speed_mps,
        period_scale=motion.period_scale,
        phase=motion.cycle_phase,
        arm_swing=motion.arm_swing,
        trunk_pitch=radians(motion.trunk_pitch_deg),
        half_width=motion.step_width / 2,
        start=motion.speed_up,
        ragged=_waves(motion, varies, RAGGED_HZ, 0.7),
        jitter=_some(np.clip(jitter, -0.03, 0.03)),
        widths=_some(np.clip(widths, -0.02, 0.03)),
        lane=_lane(person, place),
    )


def _lane(person: Person, place: int) -> Lane | None:
    """How far people walk before they turn round, of which a part may lie behind them."""
    motion = person.motion
    if not (length := motion.lane_m):
        return None
    left = person.stream(f"motion.lane_m/side/{place}").random() < 0.5
    first = (1 - motion.lane_start) * length
    return Lane(length, first, side=1.0 if left else -1.0)


def _some(numbers: Float) -> tuple[float, ...]:
    """The numbers, or none where all are 0."""
    return tuple(numbers.tolist()) if numbers.any() else ()


def _repetitions(person: Person, count: int, place: int) -> tuple[Float, Float]:
    """Pace and size of each repetition, over the usual ones [count]."""
    motion = person.motion
    tempo = person.stream(f"motion.tempo_jitter/{place}").standard_normal(count)
    size = person.stream(f"motion.size_jitter/{place}").standard_normal(count)
    paces = np.clip(1 + motion.tempo_jitter * tempo, 0.7, 1.4)
    return paces, np.clip(1 + motion.size_jitter * size, 0.6, 1.15)


def _waves(motion: Numbers, deviation: float, rates: Iterable[float], first: float) -> Waves:
    """Low-pass waves that have been going on for `motion.idle_phase_s`."""
    f = tuple(rates)
    phases = np.array(spread_phases(len(f), first)) + 2 * pi * np.array(f) * motion.idle_phase_s
    return Waves.low_pass(deviation, tuple(phases % (2 * pi)), f) if deviation else Waves()


def _idle(person: Person, physique: Physique, movements: tuple[Movement, ...]) -> Idle:
    subject = person.subject
    motion = person.motion
    since = motion.idle_phase_s
    sway = Sway(
        _waves(motion, subject.sway_ahead_m, _SWAY_HZ, 0.0),
        _waves(motion, subject.sway_aside_m, _SWAY_HZ, 0.3),
    )
    breathing, pulse = subject.breathing_hz, subject.pulse_hz
    breath = Breath(
        chest=subject.chest_m,
        breathing=breathing,
        breathing_phase=2 * pi * (breathing * since % 1),
        heart=subject.heart_m,
        pulse=pulse,
        pulse_phase=2 * pi * (pulse * since % 1),
    )
    return Idle(physique, sway, breath, (*_fidgets(person), *_settling(person, movements)))


def _instants(person: Person, rate: float, name: str, start: float) -> list[float]:
    """Instants (s) of a Poisson process from `start` to the end of the recording."""
    end, rng, instants = person.seconds, person.stream(name), []
    at = start
    while rate > 0 and (at := at + rng.exponential() / rate) < end:
        instants.append(at)
    return instants


def _fidgets(person: Person) -> Iterable[Fidget]:
    motion = person.motion
    rng = person.stream("motion.fidget_size")
    for at in _instants(person, motion.fidget_hz, "motion.fidget_hz/times", -1.0):
        yield _fidget(rng, motion.fidget_size, at, (0.5, 1.8))


def _settling(person: Person, movements: tuple[Movement, ...]) -> Iterable[Fidget]:
    """Small movements around the end of S4 to S6."""
    motion, slug = person.motion, person.activity.slug
    if slug not in STEPS:
        return
    begin = _begin(person)
    if size := motion.settle_size:
        rng = person.stream("motion.settle_size/fidgets")
        count = next(n for n, one in enumerate(movements, 1) if not isinstance(one, StepTo))
        end = _ends(movements[:count], begin)
        for channel, target, after, start, length in GESTURES[slug]:
            yield Fidget(channel, size * target, (end if after else begin) + start, length)
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
    person: Person, movements: tuple[Movement, ...], rest: float
) -> tuple[tuple[Movement, ...], tuple[float, ...]]:
    """Movements that end standing at `rest` (s), and after them steps to other stances."""
    if rest == inf:
        return movements, ()
    rng, more, pauses = person.stream("motion.shuffle_hz/places"), [], []
    for at in _instants(person, person.motion.shuffle_hz, "motion.shuffle_hz/times", rest):
        place = Place(*(np.array(SHUFFLE_SIZES) * np.clip(rng.standard_normal(3), -2, 2)).tolist())
        if at >= rest:
            more.append(StepTo(SHUFFLE, place))
            pauses.append(at - rest)
            rest = at + SHUFFLE
    return (*movements, *more), (*[0.0] * len(movements), *pauses)
