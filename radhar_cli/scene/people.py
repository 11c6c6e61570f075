"""Motion of a person in a scene of `motion.model: human`.

Numbers come from the scene's config. What differs from one repetition, stride or fidget to the next
comes from streams named by (seed, class, index) and in sizes of the config, 0 for none.
"""

from collections.abc import Iterable, Sequence
from dataclasses import replace
from math import inf, pi, radians
from typing import Any, NamedTuple

import numpy as np

from radhar_cli.config.sequence import SequenceConfig, SequenceStep
from radhar_cli.motion.human.idle import FIDGETS, GOLDEN, SWAY_HZ, Breath, Fidget, Idle, Sway
from radhar_cli.motion.human.motion import HumanMotion
from radhar_cli.motion.human.part import Movement, Place
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.stepping import StepTo
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.idle import low_pass_waves
from radhar_cli.motion.movements.joining import join_on_floor
from radhar_cli.motion.movements.standing import Stand
from radhar_cli.scene.mover import SceneMover
from radhar_cli.scene.onset import (
    Bout,
    bout_of,
    bout_onset,
    movement_onset,
    rise_onset,
    sequence_onset,
    stop_onset,
)
from radhar_cli.scene.place import start_of
from radhar_cli.scene.scene import Person

SHUFFLE_S = 0.9  # duration of a shuffle
STEP_S = 0.7  # duration of a step towards or from a seat, without that of its length
STEP_LIFT = 0.06  # height of its foot, m
TRANSITIONS = "sitting_down", "standing_up", "grabbing"
RISING = ("sitting_to_walking", "falling_to_walking")
STOPPING = ("walking_to_sitting", "walking_to_falling")
SETTLING = 4  # number of fidgets around the end of such a movement
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


class _Plan(NamedTuple):
    """Movements of a person, one after the other.

    Attributes:
        movements: movements in their order.
        pauses: pause before each, s; those that are not given are 0.
        begin: beginning of the first, s.
        onset: beginning of the movement that names the class, s; None: that of the first.
    """

    movements: tuple[Movement, ...]
    pauses: tuple[float, ...] = ()
    begin: float = 0.0
    onset: float | None = None


def human_motion(person: Person) -> HumanMotion:
    """Motion of a person who does what the activity asks for, where `motion` has them."""
    motion = person.motion
    physique = Physique(person.subject.height_m, weight=person.subject.weight_kg)
    plan = _plan(person, physique)
    at_origin = HumanMotion(
        person=physique,
        movements=plan.movements,
        start=(0.0, 0.0),
        heading=radians(motion.angle_deg),
        begin=plan.begin,
        horizon=person.seconds,
        idle=_idle(person, physique, plan),
        pauses=plan.pauses,
        onset=plan.begin if plan.onset is None else plan.onset,
    )
    return at_origin.moved_to(start_of(person, at_origin))


def _plan(person: Person, physique: Physique) -> _Plan:
    """Plan what a person does, and when."""
    if person.activity.slug in person.config.classes:
        return _plan_sequence(person, physique)
    slug = person.activity.usual_slug
    if slug in TRANSITIONS:
        return _plan_transition(person)
    if slug in RISING:
        return _plan_rise(person)
    if slug in STOPPING:
        return _plan_stop(person, physique)
    return _plan_bout(person)


def _plan_bout(person: Person) -> _Plan:
    """Plan what lasts; what repeats and is under way at 0 s has its phase then."""
    timing, motion, slug = person.timing, person.motion, person.activity.usual_slug
    bout = bout_of(person)
    if slug == "stationary":
        return _add_shuffles(person, _Plan((Stand(0.0),), onset=bout_onset(person)), 0.0)
    if slug == "walking" and timing.walk_begin_s is not None:
        bout = Bout(timing.walk_begin_s, inf, from_rest=True)
    begin, rate = bout.begin, MOVEMENTS[slug].rate
    if not bout.from_rest and rate is not None and (hz := rate(SceneMover(person, inf))):
        begin = -(motion.repeating.cycle_phase % 1) / hz
    movement: Any = _make(person, slug, bout.end - begin)
    onset = begin if bout.from_rest else bout_onset(person)
    return _Plan((replace(movement, from_rest=bout.from_rest),), begin=begin, onset=onset)


def _make(person: Person, name: str, duration: float) -> Movement:
    """Make a movement of a person that is alone, or one of two."""
    return MOVEMENTS[name].make(SceneMover(person, duration))


def _plan_transition(person: Person) -> _Plan:
    """Plan picking up, sitting down or standing up, with the steps before and after."""
    timing, slug = person.timing, person.activity.usual_slug
    duration, start = timing.seat_duration_s, timing.seat_start_s
    if slug == "grabbing":
        duration, start = timing.grab_duration_s, timing.grab_start_s
    main = _make(person, slug, duration)
    movements = _add_steps(person, (main,))
    if start is None:
        before = _time_of_rest(movements[: movements.index(main)], 0.0)
        onset = movement_onset(person, _time_of_rest((main,), 0.0))
        plan = _Plan(movements, (), onset - before, onset)
    else:
        plan = _Plan(movements, (), start, start)
    rest_s = _time_of_rest(movements, plan.begin) if slug == "grabbing" else inf
    return _add_shuffles(person, plan, rest_s)


def _plan_rise(person: Person) -> _Plan:
    """Plan rising, and the walk after it."""
    timing, duration = person.timing, person.timing.rise_duration_s
    rise, walk = person.activity.movements
    movements = _make(person, rise, duration), _make(person, walk, inf)
    begin = timing.rise_start_s
    if begin is None:
        begin = rise_onset(person, duration)
    start = begin + duration - timing.overlap_s
    if timing.walk_start_s is not None:
        start = timing.walk_start_s
    return _Plan(movements, (0.0, start - (begin + duration)), begin, start)


def _plan_stop(person: Person, physique: Physique) -> _Plan:
    """Plan a walk, and sitting down or falling after it."""
    timing = person.timing
    duration = timing.sit_duration_s
    if person.activity.usual_slug == "walking_to_falling":
        duration = timing.fall_duration_s
    walks_s = person.seconds if timing.walk_stop_s is None else timing.walk_stop_s
    walk: Any = _make(person, person.activity.movements[0], walks_s)
    walk = replace(walk, from_rest=False)
    second = _make(person, person.activity.movements[1], duration)
    begin, onset = 0.0, None
    if timing.walk_stop_s is None:  # a walk that begins as long before
        stopped = walk.part(physique, 0.0, person.seconds).end
        onset = stop_onset(person, duration)
        begin = onset + timing.overlap_s - stopped
    return _Plan((walk, second), (0.0, -timing.overlap_s), begin, onset)


def _add_steps(person: Person, movements: tuple[Movement, ...]) -> tuple[Movement, ...]:
    """Put a step before and after the movements, as the activity has them."""
    length = person.motion.transitions.step_m
    rng = person.stream("motion.step_m/ways")
    if not length:
        return movements
    steps: list[tuple[Movement, ...]] = []
    for ahead in MOVEMENTS[person.activity.usual_slug].steps:
        direction = 1 if rng.random() < (ahead or 0.0) else -1
        sideways = np.clip(rng.normal(), -2, 2)
        place = Place(direction * length, float(SHUFFLE_SIZES.left * sideways))
        step = StepTo(STEP_S + 0.5 * length, place, lift=STEP_LIFT)
        steps.append(() if ahead is None else (step,))
    return (*steps[0], *movements, *steps[1])


def _time_of_rest(movements: Iterable[Movement], begin: float) -> float:
    """Return the time at which a chain of movements from `begin` (s) on comes to rest, s."""
    for movement in movements:
        begin = movement.part(Physique(1.7), begin, begin).end
    return begin


def _plan_sequence(person: Person, physique: Physique) -> _Plan:
    """Plan the movements of a class that is a sequence."""
    sequence = person.own_class
    assert isinstance(sequence, SequenceConfig)
    steps = tuple(sequence.steps())
    if len(steps) == 1 and _duration_of(steps[0]) is None:
        begin = bout_onset(person)
        lasts = person.seconds if begin < 0 else inf
        return _Plan(_movements_of(person, steps, lasts), (steps[0].pause,), begin)
    plan = _Plan(_movements_of(person, steps), tuple(step.pause for step in steps))
    from_zero = HumanMotion(
        person=physique,
        movements=plan.movements,
        start=(0.0, 0.0),
        heading=0.0,
        begin=0.0,
        horizon=person.seconds,
        idle=_idle(person, physique, plan),
        pauses=plan.pauses,
    )
    return plan._replace(begin=sequence_onset(person, steps, from_zero))


def _duration_of(step: SequenceStep) -> float | None:
    """Duration of a step of a sequence, s; None for one that goes on."""
    return MOVEMENTS[step.name].seconds if step.duration is None else step.duration


def _movements_of(
    person: Person, steps: Sequence[SequenceStep], going_on: float = inf
) -> tuple[Movement, ...]:
    """Movements of the steps of a sequence; what goes on does so for `going_on` s."""
    movements = list[Movement]()
    for step in steps:
        movements.append(movement_of(person, step, movements, going_on))
    return tuple(movements)


def movement_of(
    person: Person, step: SequenceStep, previous: Sequence[Movement], going_on: float = inf
) -> Movement:
    """Movement of a step of a sequence, after the previous ones; what goes on does so that long."""
    duration = _duration_of(step)
    mover = SceneMover(person, going_on if duration is None else duration, step.place)
    return join_on_floor(previous, MOVEMENTS[step.name].make(mover))


def idle_of_stream(person: Person, physique: Physique, movements: tuple[Movement, ...]) -> Idle:
    """Sway, breath and fidgets of a person of a stream."""
    return _idle(person, physique, _Plan(movements))


def _idle(person: Person, physique: Physique, plan: _Plan) -> Idle:
    """Sway, breath and fidgets of a person."""
    subject = person.subject
    motion = person.motion
    idle_s = motion.idle.phase_s
    sway = Sway(
        low_pass_waves(motion.idle, subject.sway_ahead_m, _SWAY_HZ, 0.0),
        low_pass_waves(motion.idle, subject.sway_aside_m, _SWAY_HZ, 0.3),
    )
    breathing, pulse = subject.breathing_hz, subject.pulse_hz
    breath = Breath(
        chest=subject.chest_m,
        breathing=breathing,
        breathing_phase=2 * pi * (breathing * idle_s % 1),
        heart=subject.heart_m,
        pulse=pulse,
        pulse_phase=2 * pi * (pulse * idle_s % 1),
    )
    return Idle(physique, sway, breath, (*_fidgets(person), *_settling_fidgets(person, plan)))


def _poisson_instants(person: Person, rate: float, name: str, start: float) -> list[float]:
    """Instants (s) of a Poisson process from `start` (s) to the end; the rate in Hz."""
    rng = person.stream(name)
    instants = []
    instant = start
    while rate > 0 and (instant := instant + rng.exponential() / rate) < person.seconds:
        instants.append(instant)
    return instants


def _fidgets(person: Person) -> Iterable[Fidget]:
    """Fidgets that people make all the time."""
    motion = person.motion
    rng = person.stream("motion.fidget_size")
    for start_s in _poisson_instants(person, motion.idle.fidget_hz, "motion.fidget_hz/times", -1.0):
        yield _draw_fidget(rng, motion.idle.fidget_size, start_s, (0.5, 1.8))


def _settling_fidgets(person: Person, plan: _Plan) -> Iterable[Fidget]:
    """Small movements around the end of S4 to S6."""
    motion, slug = person.motion, person.activity.usual_slug
    if slug not in TRANSITIONS:
        return
    begin, movements = plan.begin, plan.movements
    if size := motion.transitions.settle_size:
        rng = person.stream("motion.settle_size/fidgets")
        count = next(
            n for n, movement in enumerate(movements, 1) if not isinstance(movement, StepTo)
        )
        end = _time_of_rest(movements[:count], begin)
        for channel, target, from_end, start, length in MOVEMENTS[slug].gestures:
            yield Fidget(channel, size * target, (end if from_end else begin) + start, length)
        for start_s in sorted(end + rng.uniform(-0.8, 1.2, SETTLING)):
            yield _draw_fidget(rng, size, float(start_s), (0.4, 1.0))


def _draw_fidget(
    rng: np.random.Generator, size: float, start_s: float, lengths: tuple[float, float]
) -> Fidget:
    """Draw a fidget that begins at `start_s`, of a `size` over the usual one."""
    channel = FIDGETS[rng.integers(len(FIDGETS))]
    target = size * FIDGET_SIZES[channel] * np.clip(rng.standard_normal(), -2, 2)
    if channel.endswith("elbow"):
        target = abs(target)  # no arm bends backwards
    return Fidget(channel, float(target), start_s, float(rng.uniform(*lengths)))


def _add_shuffles(person: Person, plan: _Plan, rest_s: float) -> _Plan:
    """Put steps to other stances after movements that end standing at `rest_s`."""
    if rest_s == inf:
        return plan
    rng = person.stream("motion.shuffle_hz/places")
    shuffles, pauses = list[Movement](), list[float]()
    for start_s in _poisson_instants(
        person, person.motion.idle.shuffle_hz, "motion.shuffle_hz/times", rest_s
    ):
        place = Place(*(np.array(SHUFFLE_SIZES) * np.clip(rng.standard_normal(3), -2, 2)).tolist())
        if start_s >= rest_s:
            shuffles.append(StepTo(SHUFFLE_S, place))
            pauses.append(start_s - rest_s)
            rest_s = start_s + SHUFFLE_S
    movements = (*plan.movements, *shuffles)
    return plan._replace(movements=movements, pauses=(*[0.0] * len(plan.movements), *pauses))
