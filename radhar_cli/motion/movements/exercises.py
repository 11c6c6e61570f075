"""Exercises that are repeated on the spot: squats, lunges, jumps, arms and legs raised.

Each is a table of minimum-jerk steps within one repetition. Feet that are not moved stay where they
are, and the pelvis is as high as both legs allow. In the air a body follows g alone.

Usual times are of measured people: squats, lunges, arms and legs 2.7 to 3.3 s a repetition (MARS,
An and Ogras 2021), jumps 0.9 s and jumping jacks 1.2 to 1.8 s (RadHAR, Singh et al. 2019).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property, partial
from math import inf, isinf, radians
from typing import TYPE_CHECKING, Annotated, Generic, NamedTuple

import numpy as np

from radhar_cli.motion.human.arms import raised_arm_directions
from radhar_cli.motion.human.idle import IdleState
from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.pelvis import (
    LegBound,
    hip_joints,
    hip_point_with_sway,
    sway_displacement,
)
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.pose import SIDES, Pose, axes
from radhar_cli.motion.human.two_link import AHEAD, two_link
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.repeating import (
    EACH,
    Repeated,
    Repeating,
    Repetition,
    draw_repetitions,
    nonzero_tuple,
)
from radhar_cli.numerics.arrays import Float
from radhar_cli.schema.annotations import People
from radhar_cli.schema.number import NOT_NEGATIVE, RATIO, uniform
from radhar_cli.schema.section import B, ByActivity, Section, default_draw


class ExercisesConfig(Section, Generic[B]):
    """Exercises: squats, jumps, lunges and the like."""

    period: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(None, 0.6, 1.8)] = default_draw(
        uniform(0.8, 1.3)
    )
    """Duration of a repetition of an exercise, relative to the usual one."""
    size: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(None, 0.5, 1.1)] = default_draw(
        uniform(0.75, 1.05)
    )
    """Extent of the movements of an exercise, relative to the usual one."""


SECTION = ExercisesConfig


if TYPE_CHECKING:
    from scipy.interpolate import BPoly

G = 9.81  # m/s^2
ANKLES_S = 0.1  # for which the ankles stretch before the feet leave the floor, and bend after, s
CROUCH_S = 0.35  # to the first crouch, and from the last, s
SIDE = ("right", "left")
# Channels of each side: the foot ahead, outwards and up of where it rests, over the stature; the
# straight leg raised outwards, the arm ahead and outwards, rad.
LIMBS = ("ahead", "out", "up", "leg", "forwards", "sideways")
# Channels of the body: the hip ahead, to the left and down, over the stature; the trunk ahead and
# to the left, rad; and whether the legs are ready to move.
BODY = ("hip_ahead", "hip_left", "drop", "pitch", "lean", "ready")

REST = (0.0, 0.0, 0.0)
Knot = tuple[float, tuple[float, float, float]]  # time, and a value with two derivatives
Span = tuple[float, float]  # from, to; shares of the period
IN_THE_AIR = None  # span of a hop: the first one for `out`, the second for `back`


class Move(NamedTuple):
    """A change of a channel within a repetition, and the change back."""

    channel: str
    change: float
    out: Span | None
    back: Span | None


def moves_of_both_sides(channel: str, *change_and_spans: object) -> tuple[Move, ...]:
    """One move in a channel of the right and of the left side."""
    return tuple(Move(f"{side}_{channel}", *change_and_spans) for side in SIDE)  # type: ignore[arg-type]


def _smooth(knots: Sequence[Knot]) -> "BPoly[np.float64]":
    """Quintic curve through knots, twice continuously differentiable."""
    times, values = np.array([time for time, _ in knots]), np.array([value for _, value in knots])
    from scipy.interpolate import BPoly  # slow to import

    return BPoly.from_derivatives(times, values)


@dataclass(frozen=True)
class Exercise(Repeated):
    """Repeats an exercise for `duration` s, from rest to rest."""

    name: str  # name of its phase
    moves: tuple[Move, ...]
    period: float  # duration of a repetition, s
    hops: tuple[float, ...] = ()  # when feet leave the floor, shares of the period
    flight: float = 0.0  # time in the air of a hop, s
    crouch: float = 0.0  # depth of the crouch before and after a hop, over the stature
    first: float = 0.5  # time before the first repetition, s
    entry: float = 0.2  # time of rest at the end, s

    fastest_hz = 4.0

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> "Exercising":
        return Exercising(person, self, begin, horizon)


class Exercising(Repeating[Exercise]):
    """The `part.Part` of a person who exercises."""

    @property
    def name(self) -> str:
        return self.movement.name

    @property
    def end(self) -> float:
        return self._end + self.movement.entry

    @cached_property
    def _repetitions(self) -> list[Repetition]:
        """Repetitions within the duration and the recording, at least one."""
        start = self.begin + self.movement.first
        return self.repeat(start, self.movement.period, start + self.movement.duration)

    @cached_property
    def _steps(self) -> list[Step]:
        """Steps of all repetitions, and of getting ready for them."""
        steps = [Step("ready", 1.0, self.begin, self.movement.first)]
        if not isinf(self._end):
            steps.append(Step("ready", -1.0, self._end, self.movement.entry))
        hops, flights = self.movement.hops, iter(self._flights)
        for start, pace, size in self._repetitions:
            period, in_air = pace * self.movement.period, [next(flights) for _ in hops]
            for channel, change, *spans in self.movement.moves:
                for hop, (sign, span) in enumerate(zip((1, -1), spans, strict=True)):
                    if span is IN_THE_AIR:
                        begin, length = in_air[hop]
                    else:
                        begin, length = start + period * span[0], period * (span[1] - span[0])
                    steps.append(Step(channel, sign * size * change, begin, length))
        return steps

    @property
    def _end(self) -> float:
        """Time at which the body has done the last repetition, s; infinity for what goes on."""
        start, pace, _ = self._repetitions[-1]
        end = start + pace * self.movement.period
        return inf if self.movement.duration == inf else end + CROUCH_S * bool(self.movement.hops)

    @cached_property
    def course(self) -> Course:
        """Course of the channels of both sides and of the body."""
        limbs = [f"{side}_{channel}" for channel in LIMBS for side in SIDE]
        return Course.of(dict.fromkeys((*limbs, *BODY), 0.0), self._steps)

    @cached_property
    def _flights(self) -> list[tuple[float, float]]:
        """Times at which the feet leave the floor, and durations in the air, s."""
        exercise = self.movement
        take_offs = [
            (start + pace * exercise.period * hop, exercise.flight * size**0.5)
            for start, pace, size in self._repetitions
            for hop in exercise.hops
        ]
        next_take_offs = [take_off for take_off, _ in take_offs[1:]] + [inf]
        # Whoever hops faster hops less high: the feet are on the floor in between.
        return [
            (take_off, max(min(flight, next_take_off - take_off - 2.5 * ANKLES_S), 0.01))
            for (take_off, flight), next_take_off in zip(take_offs, next_take_offs, strict=False)
        ]

    @cached_property
    def _hop(self) -> "tuple[BPoly[np.float64], BPoly[np.float64]] | None":
        """Curves over time of feet and hip above their course, m; None without hops."""
        if not self._flights:
            return None
        feet, hip = list[Knot](), list[Knot]()
        crouch = self.movement.crouch * self.person.stature
        landed = None
        for take_off, flight in self._flights:
            speed = G * flight / 2
            height = speed * ANKLES_S / 2
            bottom = take_off - CROUCH_S / 2 if landed is None else (landed + take_off) / 2
            rate = 1.5 * speed / (take_off - bottom)
            if landed is None:
                hip.append((bottom - CROUCH_S, REST))
            hip.append((bottom, (-crouch, 0.0, rate)))
            leave, land = (take_off, (height, speed, -G)), (take_off + flight, (height, -speed, -G))
            feet += [(take_off - ANKLES_S, REST), leave, land, (take_off + flight + ANKLES_S, REST)]
            hip += [leave, land]
            landed = take_off + flight
        assert landed is not None
        hip.append((landed + CROUCH_S / 2, (-crouch, 0.0, rate)))
        hip.append((landed + 1.5 * CROUCH_S, REST))
        return _smooth(feet), _smooth(hip)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        knots = (
            [] if self._hop is None else [knot for curve in self._hop for knot in curve.x.tolist()]
        )
        return (*self.course.breakpoints, *knots)

    def pose(self, t: Float, idle: IdleState) -> Pose:
        body = self.person
        values = iter(self.course(t))
        limbs = {channel: np.array([next(values), next(values)]) for channel in LIMBS}
        ahead, left, drop, pitch, lean, ready = values
        feet, hop = self._hop_heights(t)
        swing = limbs["leg"]
        out = body.stature * limbs["out"] + body.reach * np.sin(swing)
        up = body.stature * limbs["up"] + body.reach * (1 - np.cos(swing)) + feet
        ankles = np.array(
            [body.stature * limbs["ahead"], SIDES * (body.hip + out), body.ankle + up]
        )
        aside = hip_joints(body, np.zeros(t.size), np.zeros(t.size))
        sway = sway_displacement(body.rest_height - body.ankle, idle.lean, idle.legs_roll)
        standing = body.tallest - body.stature * drop + hop
        place = body.stature * np.array([ahead, left])
        bound = LegBound.at_rest(body).towards(LegBound.under_way(body), ready)
        hip = hip_point_with_sway(body, standing, place, aside, ankles, sway, bound)
        joints = hip[:, None] + aside
        knees = two_link(joints, ankles, body.leg, body.leg, AHEAD)
        trunk = axes(pitch + idle.pitch, idle.yaw, idle.roll + lean)
        upper, fore = raised_arm_directions(
            trunk, limbs["forwards"] + idle.shoulders, body.elbow + idle.elbows, limbs["sideways"]
        )
        return Pose(hip, trunk, joints, knees, ankles, upper, fore, idle.breath)

    def _hop_heights(self, t: Float) -> tuple[Float, Float]:
        """Heights of feet and hip above their course at times t [M] (s), each [M], m."""
        if self._hop is None:
            return np.zeros(t.size), np.zeros(t.size)
        feet, hip = (curve(np.clip(t, curve.x[0], curve.x[-1])) for curve in self._hop)
        return feet, hip


OUT, BACK = (0.0, 0.42), (0.5, 0.92)
ARM, LEG = radians(160), radians(38)


def _lunging_exercises(side: str) -> Iterator[tuple[str, Exercise]]:
    """(name, exercise) of the lunges of one side."""
    other = SIDE[side == "right"]
    foot = (0.02, 0.34), (0.58, 0.90)
    lift = [Move(f"{side}_up", 0.04, (a, (a + b) / 2), ((a + b) / 2, b)) for a, b in foot]
    weight, deep = ((0.06, 0.42), (0.52, 0.88)), ((0.16, 0.46), (0.5, 0.8))
    ahead = (
        Move(f"{side}_ahead", 0.40, *foot),
        Move("hip_ahead", 0.22, *weight),
        Move("drop", 0.10, *deep),
        Move(f"{other}_up", 0.045, *deep),
        Move("pitch", radians(6), *deep),
    )
    yield f"{side}_lunge", Exercise("lunging", (*lift, *ahead), 3.0)
    towards = 1.0 if side == "left" else -1.0
    aside = (
        Move(f"{side}_out", 0.30, *foot),
        Move("hip_left", towards * 0.20, *weight),
        Move("drop", 0.09, *deep),
        Move("hip_ahead", -0.05, *deep),
        Move("pitch", radians(24), *deep),
        *moves_of_both_sides("forwards", radians(50), *deep),
    )
    yield f"{side}_side_lunge", Exercise("lunging", (*lift, *aside), 3.0)


def _raising_exercises(side: str) -> Iterator[tuple[str, Exercise]]:
    """(name, exercise) in which arm and leg of one side are raised."""
    away = -1.0 if side == "left" else 1.0  # to the left
    arm = Move(f"{side}_sideways", ARM, OUT, BACK)
    leg = (
        Move(f"{side}_leg", LEG, OUT, BACK),
        Move("hip_left", away * 0.045, (0.0, 0.3), (0.62, 0.92)),
        Move("lean", away * radians(7), OUT, BACK),
    )
    yield f"raising_{side}_arm", Exercise("raising", (arm,), 3.0)
    yield f"raising_{side}_leg", Exercise("raising", leg, 3.0)
    yield f"raising_{side}_arm_and_leg", Exercise("raising", (arm, *leg), 3.0)


EXERCISES = {
    "squatting": Exercise(
        "squatting",
        (
            Move("drop", 0.26, (0.0, 0.46), (0.5, 0.96)),
            Move("hip_ahead", -0.045, (0.0, 0.46), (0.5, 0.96)),
            Move("pitch", radians(16), (0.0, 0.46), (0.5, 0.96)),
            *moves_of_both_sides("forwards", radians(50), (0.0, 0.4), (0.56, 0.96)),
        ),
        2.7,
    ),
    "jumping": Exercise(
        "jumping",
        (
            *moves_of_both_sides("forwards", radians(14), (0.05, 0.45), (0.5, 0.95)),
            Move("pitch", radians(7), (-0.36, -0.04), (0.0, 0.28)),
            Move("hip_ahead", -0.012, (-0.36, -0.04), (0.0, 0.28)),
        ),
        0.9,
        hops=(0.3,),
        flight=0.36,
        crouch=0.10,
    ),
    "jumping_jacks": Exercise(
        "jumping",
        (
            *moves_of_both_sides("out", 0.15, IN_THE_AIR, IN_THE_AIR),
            *moves_of_both_sides("sideways", radians(150), (0.0, 0.4), (0.5, 0.9)),
        ),
        1.3,
        hops=(0.08, 0.58),
        flight=0.22,
        crouch=0.04,
    ),
    "raising_arms": Exercise("raising", moves_of_both_sides("sideways", ARM, OUT, BACK), 3.0),
    "raising_arms_ahead": Exercise("raising", moves_of_both_sides("forwards", ARM, OUT, BACK), 3.0),
    **{
        name: exercise
        for side in SIDE
        for name, exercise in (*_lunging_exercises(side), *_raising_exercises(side))
    },
}


def _make_exercise(mover: Mover, name: str) -> Exercise:
    """Make the exercise of a name of a person, from rest."""
    exercises, (paces, sizes) = mover.numbers(ExercisesConfig[float]), draw_repetitions(mover)
    return replace(
        EXERCISES[name],
        duration=mover.duration,
        period=exercises.period * EXERCISES[name].period,
        paces=nonzero_tuple(paces),
        sizes=nonzero_tuple(exercises.size * np.minimum(sizes, 1.05)),
    )


def _kind(
    name: str, meaning: str, words: str = "", nearby: str = "", manners: str = ""
) -> MovementKind:
    """Describe an exercise to configs."""
    return MovementKind(
        name,
        meaning,
        partial(_make_exercise, name=name),
        in_place=True,
        uses=(*EACH, "exercises.period", "exercises.size"),
        words=words,
        nearby=nearby,
        manners=manners,
    )


def _kinds_of_side(side: str) -> Iterator[MovementKind]:
    """Describe the exercises of one side."""
    yield _kind(
        f"{side}_lunge",
        f"lunges forward with the {side} leg, again and again",
        f"{side}_front_lunge lunge_{side} lunge_toward_{side}_front",
        "lunge lunges lunging" * (side == "right"),
    )
    yield _kind(
        f"{side}_side_lunge", f"lunges to the {side}, again and again", f"lunge_toward_{side}_side"
    )
    hands = "raise_arm arm_raise raise_hand raising_hand hand_raising" * (side == "right")
    yield _kind(
        f"raising_{side}_arm",
        f"raises the {side} arm, again and again",
        f"raise_{side}_arm raising_{side}_hand raise_{side}_hand raising_hand_{side}",
        f"{hands} {side}_upper_limb_extension",
    )
    yield _kind(f"raising_{side}_leg", f"raises the {side} leg, again and again")
    yield _kind(
        f"raising_{side}_arm_and_leg",
        f"raises the {side} arm and leg, again and again",
        nearby=f"{side}_limb_extension limb_extension_{side}",
    )


MOVEMENTS = (
    _kind(
        "squatting",
        "squats, again and again",
        "squat squats squat_down",
        "crouch crouching",
        "exercise",
    ),
    _kind(
        "jumping",
        "jumps, again and again",
        "jump jumps jump_up jumping_up springen",
        "hopping hop leaping leap jump_rope rope_skipping skipping_rope",
        "exercise up_and_down",
    ),
    _kind(
        "jumping_jacks",
        "jumps with arms and legs apart, and together again",
        "jumping_jack star_jumps star_jump jumping_jacks_exercise",
        "jack jacks",
        "exercise",
    ),
    _kind(
        "raising_arms",
        "raises both arms to the sides, again and again",
        "arms_up raising_both_arms both_hands_up hands_up",
        "both_upper_limb_extension hand_up",
    ),
    _kind("raising_arms_ahead", "raises both arms ahead, again and again"),
    *_kinds_of_side("right"),
    *_kinds_of_side("left"),
)
