"""S2 and S3: punches from a guard, right and left in turn, and front kicks with the right leg.

A hand goes straight from the guard to a point ahead of its shoulder and back; trunk and pelvis turn
into the punch. In a kick the left leg carries the body.
"""

from dataclasses import dataclass
from functools import cached_property
from math import acos, inf, isinf, radians
from typing import Annotated, Generic, TypeVar

import numpy as np

from radhar_cli.motion.human.arms import (
    OUTWARDS,
    arm_directions,
    arm_directions_to_hands,
    hanging_hands,
)
from radhar_cli.motion.human.idle import IdleState
from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.part import STANDING
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
    PHASE,
    Repeated,
    Repeating,
    Repetition,
    draw_repetitions,
    nonzero_tuple,
)
from radhar_cli.numerics.arrays import Float
from radhar_cli.schema.annotations import PERSONAL, People
from radhar_cli.schema.number import FREQUENCY, NOT_NEGATIVE, RATIO, normal, vary
from radhar_cli.schema.section import B, ByActivity, Section, default_draw

REFERENCE_STATURE = 1.75  # of the lengths below
ENTRY = {"right_foot": (0.0, 0.6), "left_foot": (0.4, 0.6), "guard": (0.0, 1.0)}


class StrikingConfig(Section, Generic[B]):
    """Punches and kicks."""

    punch_hz: Annotated[B, ByActivity(NOT_NEGATIVE, FREQUENCY), People("punching", 0.05, 1.1)] = (
        default_draw(vary(0.7, 0.15))
    )
    """Pairs of punches, right and left, per second."""
    kick_hz: Annotated[B, ByActivity(NOT_NEGATIVE, FREQUENCY), People("kicking", 0.05, 0.6)] = (
        default_draw(vary(0.45, 0.1))
    )
    """Kicks per second."""
    strike_scale: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("punching kicking", 0.8, 1.25), PERSONAL
    ] = default_draw(normal(1.0, 0.12, 0.8, 1.25))
    """Duration of a punch or kick, relative to the usual one."""


SECTION = StrikingConfig


@dataclass(frozen=True)
class Strikes(Repeated):
    """Blow after blow, from a stance that is taken first."""

    frequency: float = 0.5  # Hz
    first: float = 0.1  # the first blow after the beginning, or after the stance is taken, s
    entry: float = 0.5  # time to take the stance, and to leave it, s
    from_rest: bool = False  # whether the stance is taken at first; else the person stands in it


K = TypeVar("K", bound=Strikes)


@dataclass(frozen=True)
class Striking(Repeating[K]):
    """The `part.Part` of a person who strikes; subclasses have the blows and the pose."""

    stance = "in stance"

    @property
    def before(self) -> str:
        return STANDING if self.movement.from_rest else self.stance

    def _blows(self, period: float) -> list[Repetition]:
        """Blows within the duration and the recording, one in each `period` (s)."""
        strikes = self.movement
        first = self.begin + strikes.first + (strikes.entry if strikes.from_rest else 0.0)
        return self.repeat(first, period, first + strikes.duration, least=0)

    @cached_property
    def _strike_steps(self) -> list[Step]:
        """Steps of all blows."""
        raise NotImplementedError

    @cached_property
    def _stance_end_s(self) -> float:
        """Time at which the last blow has ended and the stance begins to be left, s."""
        if isinf(self.movement.duration):
            return inf
        return max((step.start + step.length for step in self._strike_steps), default=self.begin)

    def _stance_steps(
        self, channel: str, change: float, delay: float = 0.0, share: float = 1.0
    ) -> list[Step]:
        """Steps that take and leave the stance, `delay` late and within a `share` of the entry."""
        entry = self.movement.entry
        steps = []
        if self.movement.from_rest:
            steps.append(Step(channel, change, self.begin + delay * entry, share * entry))
        if not isinf(self._stance_end_s):
            steps.append(Step(channel, -change, self._stance_end_s + delay * entry, share * entry))
        return steps

    @property
    def end(self) -> float:
        return self._stance_end_s + self.movement.entry


@dataclass(frozen=True)
class Punch(Strikes):
    """Punches in turn, right and left, for `duration` s; lengths in m for 1.75 m, angles in rad."""

    frequency: float = 0.7  # of a right and a left punch together, Hz
    entry: float = 0.9
    # out, hold, back: the hand goes out within `out`, begins its way back after `hold` and takes
    # `back`, s
    out: float = 0.28
    hold: float = 0.31
    back: float = 0.40
    reach: float = 0.96  # reach of a punch, over the arm's length
    # place of a hand in guard: ahead of the shoulder, inwards and up
    guard: tuple[float, float, float] = (0.24, 0.04, 0.05)
    # how far the left foot is ahead and the right one behind, and both beside
    stance: tuple[float, float] = (0.18, 0.11)
    turn: float = radians(28)  # turn of the trunk into a punch
    pelvis: float = 0.35  # turn of the pelvis over that of the trunk
    thrust: float = 0.05  # displacement of the hip ahead in a punch
    # pitch, bow: lean of the trunk ahead in guard, and further in a punch
    pitch: float = radians(6)
    bow: float = radians(4)
    lift: float = 0.03  # height of the feet as they step into the stance

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> "Punching":
        return Punching(person, self, begin, horizon)


class Punching(Striking[Punch]):
    """The `part.Part` of a person who punches."""

    stance = "in guard"
    name = "punching"

    @cached_property
    def _strike_steps(self) -> list[Step]:
        punch = self.movement
        steps = []
        for number, (start, pace, size) in enumerate(self._blows(0.5 / punch.frequency)):
            hand = ("right", "left")[number % 2]
            steps.append(Step(hand, size, start, pace * punch.out))
            steps.append(Step(hand, -size, start + pace * punch.hold, pace * punch.back))
        return steps

    @cached_property
    def course(self) -> Course:
        """Course of how far the hands are out, the feet in their stance, and the guard taken."""
        steps = list(self._strike_steps)
        initial = 0.0 if self.movement.from_rest else 1.0
        for channel, (start, length) in ENTRY.items():
            steps += self._stance_steps(channel, 1.0, start, length)
        return Course.of({"right": 0.0, "left": 0.0, **dict.fromkeys(ENTRY, initial)}, steps)

    def pose(self, t: Float, idle: IdleState) -> Pose:
        body, punch = self.person, self.movement
        scale = body.stature / REFERENCE_STATURE
        right, left, *feet, guard = self.course(t)
        ankles = self._ankles(np.array(feet))
        out_of_guard, yaw = 1 - guard, punch.turn * (right - left)
        joint_offsets = hip_joints(body, punch.pelvis * yaw, np.zeros(t.size))
        hip = ankles.mean(axis=1)
        hip[0] += scale * punch.thrust * (right + left)
        legs_roll = idle.roll + out_of_guard * (idle.legs_roll - idle.roll)
        sway = sway_displacement(body.rest_height - body.ankle, idle.lean, legs_roll)
        bound = LegBound.at_rest(body).towards(LegBound.under_way(body), guard)
        hip = hip_point_with_sway(body, body.tallest, hip, joint_offsets, ankles, sway, bound)
        pitch = punch.pitch * guard + punch.bow * (right + left)
        pitch += idle.lean + out_of_guard * (idle.pitch - idle.lean)
        trunk = axes(pitch, yaw + out_of_guard * idle.yaw, idle.roll)
        hands, poles = hanging_hands(
            body, out_of_guard * idle.shoulders, body.elbow + out_of_guard * idle.elbows
        )
        x, y, z = punch.guard
        guard_hands = scale * np.array([np.full((2, 1), x), -y * SIDES, np.full((2, 1), z)])
        ahead = np.array([trunk.ahead[0], trunk.left[0], trunk.up[0]])[:, None]  # the room's x axis
        target = punch.reach * 2 * body.arm * ahead
        hands += guard * (guard_hands - hands) + np.array([right, left]) * (target - guard_hands)
        poles += guard * (OUTWARDS[:, :, None] - poles)
        joints = hip[:, None] + joint_offsets
        knees = two_link(joints, ankles, body.leg, body.leg, AHEAD)
        arms = arm_directions_to_hands(trunk, hands, poles, body.arm)
        return Pose(hip, trunk, joints, knees, ankles, *arms, idle.breath)

    def _ankles(self, feet: Float) -> Float:
        """Ankles [3, 2, M] (m) of feet that have gone shares [2, M] of the way to their stance."""
        scale = self.person.stature / REFERENCE_STATURE
        ahead, beside = scale * self.movement.stance[0], scale * self.movement.stance[1]
        y = SIDES * (self.person.hip + (beside - self.person.hip) * feet)
        lift = 4 * self.movement.lift * feet * (1 - feet)
        return np.array([SIDES * ahead * feet, y, self.person.ankle + lift])


@dataclass(frozen=True)
class Kick(Strikes):
    """Kicks ahead with the right leg for `duration` s; angles in rad."""

    frequency: float = 0.45
    first: float = 0.3
    thigh: float = radians(78)  # flexion of the hip
    fold: float = radians(92)  # flexion of the knee before the kick
    snap: float = radians(100)  # extension of the knee in the kick
    refold: float = radians(75)  # flexion of the knee after it
    lean: float = radians(2)  # lean of the trunk ahead in the stance
    back: float = radians(14)  # lean of the trunk backwards in the kick
    bend: float = 0.985  # length of the standing legs in the stance, over thigh and shank

    fastest_hz = 4.0

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> "Kicking":
        return Kicking(person, self, begin, horizon)

    def steps(self) -> list[Step]:
        """Steps of one kick that begins at 0 s."""
        return [
            Step("thigh", self.thigh, 0.0, 0.42),
            Step("thigh", -self.thigh, 0.72, 0.55),
            Step("knee", self.fold, 0.0, 0.34),
            Step("knee", -self.snap, 0.34, 0.20),
            Step("knee", self.refold, 0.58, 0.22),
            Step("knee", self.snap - self.fold - self.refold, 0.80, 0.50),
            Step("trunk", -self.back, 0.15, 0.35),
            Step("trunk", self.back, 0.70, 0.50),
        ]


class Kicking(Striking[Kick]):
    """The `part.Part` of a person who kicks."""

    name = "kicking"

    @cached_property
    def _strike_steps(self) -> list[Step]:
        kick = self.movement
        steps = []
        for start, pace, size in self._blows(1 / kick.frequency):
            free = [Step("free", 1 / size, 0.0, 0.25), Step("free", -1 / size, 1.05, 0.25)]
            steps += [
                step._replace(
                    change=size * step.change,
                    start=start + pace * step.start,
                    length=pace * step.length,
                )
                for step in kick.steps() + free
            ]
        return steps

    @cached_property
    def course(self) -> Course:
        """Course of the right leg beyond the stance, the trunk, and both standing legs, rad."""
        kick, rest = self.movement, self.person.rest_lean
        steps, stance = (
            list(self._strike_steps),
            {"bend": acos(kick.bend) - rest, "trunk": kick.lean},
        )
        initial = dict.fromkeys(("thigh", "knee", "trunk", "free", "bend"), 0.0)
        initial["bend"] = rest
        for channel, change in stance.items():
            initial[channel] += 0.0 if kick.from_rest else change
            steps += self._stance_steps(channel, change)
        return Course.of(initial, steps)

    def pose(self, t: Float, idle: IdleState) -> Pose:
        body = self.person
        thigh, knee, pitch, free, bend = self.course(t)
        height = 2 * body.leg * np.cos(bend)
        sway = sway_displacement(height, idle.lean, idle.legs_roll)
        hip = sway + np.array([np.zeros(t.size), np.zeros(t.size), body.ankle + height])
        joints = hip[:, None] + np.array([np.zeros((2, 1)), body.hip * SIDES, np.zeros((2, 1))])
        flexed = np.array([bend + thigh, thigh - bend - knee])
        ahead, down = body.leg * np.sin(flexed), -body.leg * np.cos(flexed)
        foot = np.array(
            [ahead.sum(axis=0), np.full(t.size, -body.hip), body.ankle + height + down.sum(axis=0)]
        )
        foot += free * sway  # in the air the foot goes with the hip
        standing = np.broadcast_to([[0.0], [body.hip], [body.ankle]], (3, t.size))
        ankles = np.stack([foot, standing], axis=1)
        planted = (1 - free) * idle.legs_roll  # the leg's plane rolls while it stands
        thigh_line = np.array([ahead[0], down[0] * np.sin(planted), down[0] * np.cos(planted)])
        poles = np.stack([thigh_line, np.broadcast_to(AHEAD[:, 0], (3, t.size))], axis=1)
        knees = two_link(joints, ankles, body.leg, body.leg, poles)
        trunk = axes(pitch + idle.pitch, idle.yaw, idle.roll)
        upper, fore = arm_directions(trunk, idle.shoulders, body.elbow + idle.elbows)
        return Pose(hip, trunk, joints, knees, ankles, upper, fore, idle.breath)


def _make_strikes(mover: Mover, kind: type[K], frequency: float, largest: float = inf) -> K:
    """Make the blows of a person, from rest, none larger than `largest` times the usual one."""
    scale, (paces, sizes) = (
        mover.numbers(StrikingConfig[float]).strike_scale,
        draw_repetitions(mover),
    )
    return kind(
        duration=mover.duration,
        frequency=scale * frequency,
        from_rest=True,
        paces=nonzero_tuple(scale * paces),
        sizes=nonzero_tuple(np.minimum(sizes, largest)),
    )


def make_punches(mover: Mover) -> Punch:
    """Make the punches of a person, from rest; no arm gets longer than usual."""
    return _make_strikes(mover, Punch, mover.numbers(StrikingConfig[float]).punch_hz, largest=1.0)


def make_kicks(mover: Mover) -> Kick:
    """Make the kicks of a person, from rest."""
    return _make_strikes(mover, Kick, mover.numbers(StrikingConfig[float]).kick_hz)


MOVEMENTS = (
    MovementKind(
        "punching",
        "stands and punches, one arm after the other",
        make_punches,
        in_place=True,
        uses=(PHASE, *EACH),
        rate=lambda mover: mover.numbers(StrikingConfig[float]).punch_hz,
        words="boxing box punch shadow_boxing boxen",
        manners="in_air",
        nearby="hitting striking jab uppercut punch_slap",
    ),
    MovementKind(
        "kicking",
        "stands and kicks, again and again",
        make_kicks,
        in_place=True,
        uses=(PHASE, *EACH),
        rate=lambda mover: mover.numbers(StrikingConfig[float]).kick_hz,
        words="kick front_kick",
        nearby="side_kick roundhouse roundhouse_kick kicking_something kicking_toward_left "
        "kicking_toward_right",
    ),
)
