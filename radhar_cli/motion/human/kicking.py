"""S3: front kicks with the right leg; the left one carries the body."""

from dataclasses import dataclass
from functools import cached_property
from math import acos, inf, radians

import numpy as np

from radhar_cli.motion.human.arms import arm_directions
from radhar_cli.motion.human.idle import IdleState
from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.pelvis import sway_displacement
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.pose import SIDES, Pose, axes
from radhar_cli.motion.human.repetitions import Striking, repetitions
from radhar_cli.motion.human.two_link import AHEAD, two_link
from radhar_cli.numerics.arrays import Float


@dataclass(frozen=True)
class Kick:
    """Kicks ahead with the right leg for `duration` s; angles in rad."""

    duration: float = inf
    frequency: float = 0.45  # Hz
    first: float = 0.3  # the first kick after the beginning, or after the stance is taken, s
    thigh: float = radians(78)  # flexion of the hip
    fold: float = radians(92)  # flexion of the knee before the kick
    snap: float = radians(100)  # extension of the knee in the kick
    refold: float = radians(75)  # flexion of the knee after it
    lean: float = radians(2)  # lean of the trunk ahead in the stance
    back: float = radians(14)  # lean of the trunk backwards in the kick
    bend: float = 0.985  # length of the standing legs in the stance, over thigh and shank
    entry: float = 0.5  # time to take the stance, and to leave it, s
    from_rest: bool = False  # whether the stance is taken at first
    # paces, sizes: time and size of each kick, over the usual ones
    paces: tuple[float, ...] = ()
    sizes: tuple[float, ...] = ()

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

    stance = "in stance"
    name = "kicking"

    @cached_property
    def _strike_steps(self) -> list[Step]:
        kick = self.strikes
        steps = []
        for start, pace, size in repetitions(
            self._first, 1 / kick.frequency, self._until, kick.paces, kick.sizes
        ):
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
        kick, rest = self.strikes, self.person.rest_lean
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
