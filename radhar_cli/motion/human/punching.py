"""S2: punches in turn, right and left, from a guard.

The hand goes straight from the guard to a point ahead of its shoulder and back; trunk and pelvis
turn into the punch.
"""

from dataclasses import dataclass
from functools import cached_property
from math import inf, radians

import numpy as np

from radhar_cli.motion.human.arms import OUTWARDS, arm_directions_to_hands, hanging_hands
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
from radhar_cli.motion.human.repetitions import Striking, repetitions
from radhar_cli.motion.human.two_link import AHEAD, two_link
from radhar_cli.numerics.arrays import Float

REFERENCE_STATURE = 1.75  # of the lengths below
ENTRY = {"right_foot": (0.0, 0.6), "left_foot": (0.4, 0.6), "guard": (0.0, 1.0)}


@dataclass(frozen=True)
class Punch:
    """Punches in turn, right and left, for `duration` s; lengths in m for 1.75 m, angles in rad."""

    duration: float = inf
    frequency: float = 0.7  # of a right and a left punch together, Hz
    first: float = 0.1  # the first punch after the beginning, or after the guard is taken, s
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
    entry: float = 0.9  # time to take the guard, and to leave it, s
    lift: float = 0.03  # height of the feet as they step into the stance
    from_rest: bool = False  # whether the guard is taken at first
    # paces, sizes: time and size of each punch, over the usual ones
    paces: tuple[float, ...] = ()
    sizes: tuple[float, ...] = ()

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> "Punching":
        return Punching(person, self, begin, horizon)


class Punching(Striking[Punch]):
    """The `part.Part` of a person who punches."""

    stance = "in guard"
    name = "punching"

    @cached_property
    def _strike_steps(self) -> list[Step]:
        punch = self.strikes
        steps = []
        punches = repetitions(
            self._first, 0.5 / punch.frequency, self._until, punch.paces, punch.sizes
        )
        for number, (start, pace, size) in enumerate(punches):
            hand = ("right", "left")[number % 2]
            steps.append(Step(hand, size, start, pace * punch.out))
            steps.append(Step(hand, -size, start + pace * punch.hold, pace * punch.back))
        return steps

    @cached_property
    def course(self) -> Course:
        """Course of how far the hands are out, the feet in their stance, and the guard taken."""
        steps = list(self._strike_steps)
        initial = 0.0 if self.strikes.from_rest else 1.0
        for channel, (start, length) in ENTRY.items():
            steps += self._stance_steps(channel, 1.0, start, length)
        return Course.of({"right": 0.0, "left": 0.0, **dict.fromkeys(ENTRY, initial)}, steps)

    def pose(self, t: Float, idle: IdleState) -> Pose:
        body, punch = self.person, self.strikes
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
        ahead, beside = scale * self.strikes.stance[0], scale * self.strikes.stance[1]
        y = SIDES * (self.person.hip + (beside - self.person.hip) * feet)
        lift = 4 * self.strikes.lift * feet * (1 - feet)
        return np.array([SIDES * ahead * feet, y, self.person.ankle + lift])
