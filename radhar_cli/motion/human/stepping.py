"""Steps to another stance: a shuffle of some centimetres, a turn on the spot, or a fall caught.

The body goes to the new place by minimum jerk, the feet follow in turn; each step goes to where the
stance is a little later, the last two to where it ends.
"""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from radhar_cli.motion.human.arms import arm_directions
from radhar_cli.motion.human.idle import IdleState
from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.part import HERE, STANDING, Phase, Place
from radhar_cli.motion.human.pelvis import (
    LegBound,
    hip_joints,
    hip_point_with_sway,
    sway_displacement,
)
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import scale_steps
from radhar_cli.motion.human.pose import SIDES, Axes, Pose, axes, turned
from radhar_cli.motion.human.two_link import two_link
from radhar_cli.motion.segments import REFERENCE_STATURE
from radhar_cli.numerics.arrays import Float

RIGHT, LEFT = 0, 1
# Start and length, in shares of the duration, of the trunk's going ahead and coming back.
UPSET = (0.05, 0.35), (0.45, 0.55)


@dataclass(frozen=True)
class StepTo:
    """Steps to another stance within `duration` s."""

    duration: float = 0.9
    place: Place = HERE  # place of the new stance, seen from the old one
    steps: int = 2  # number of steps, at least 2
    lift: float = 0.03  # height of a stepping foot, m
    name: str = "stepping"  # name of its phase
    # how far trunk and arms go ahead and the trunk to the left on the way, rad; the hip down, m
    pitch: float = 0.0
    arms: float = 0.0
    lean: float = 0.0
    drop: float = 0.0
    hurry: float = 1.0  # share of the duration in which the body gets there

    def __post_init__(self) -> None:
        if self.steps < 2:
            raise ValueError(f"a stance is reached within at least 2 steps, not {self.steps}")

    def for_stature(self, stature: float) -> "StepTo":
        """Return the steps of a stature (m): shorter ones below 1.75 m."""
        scale, (ahead, left, turn) = min(stature / REFERENCE_STATURE, 1.0), self.place
        place = Place(scale * ahead, scale * left, turn)
        return replace(self, place=place, lift=scale * self.lift, drop=scale * self.drop)

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> "Stepping":
        return Stepping(person, self, begin)


@dataclass(frozen=True)
class Stepping:
    """The `part.Part` of a person who steps to another stance."""

    person: Physique
    step: StepTo
    begin: float

    before = STANDING
    after = STANDING

    @property
    def end(self) -> float:
        return self.begin + self.step.duration

    @property
    def place(self) -> Place:
        return self.step.place

    @property
    def phases(self) -> tuple[Phase, ...]:
        return (Phase(self.begin, self.step.name), Phase(self.end, "standing"))

    @cached_property
    def course(self) -> Course:
        """Course of the body's share of the way, its upset, and the share of each step."""
        slot = self.step.duration / self.step.steps
        channels = [f"step {n}" for n in range(self.step.steps)]
        steps = [
            Step("body", 1.0, 0.0, self.step.hurry),
            Step("upset", 1.0, *UPSET[0]),
            Step("upset", -1.0, *UPSET[1]),
        ]
        steps = scale_steps(steps, self.begin, self.step.duration)
        steps += [
            Step(channel, 1.0, self.begin + n * slot, slot) for n, channel in enumerate(channels)
        ]
        return Course.of(dict.fromkeys(("body", "upset", *channels), 0.0), steps)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return self.course.breakpoints

    def _ankles(self, shares: Float) -> Float:
        """Ankles [3, 2, M] (m) where each step has gone a share of its way [N, M]."""
        place, count = self.step.place, self.step.steps
        first = LEFT if place.turn > 0 or (place.turn == 0 and place.left > 0) else RIGHT
        ankles = np.zeros((3, 2, shares.shape[1]))
        ankles[1], ankles[2] = self.person.hip * SIDES, self.person.ankle
        stances = [self._stance(foot, 0.0) for foot in (RIGHT, LEFT)]
        for n, share in enumerate(shares):
            foot = (first + n) % 2
            target = self._stance(foot, min(1.0, (n + 1) / (count - 1)))
            ankles[:2, foot] += (target - stances[foot])[:, None] * share
            ankles[2, foot] += 4 * self.step.lift * share * (1 - share)
            stances[foot] = target
        return ankles

    def _stance(self, foot: int, share: float) -> Float:
        """Position x, y (m) of a foot in the stance at a share of the way."""
        place, beside = self.step.place, self.person.hip * SIDES[foot, 0]
        turn = share * place.turn
        return np.array(
            [
                share * place.ahead - beside * np.sin(turn),
                share * place.left + beside * np.cos(turn),
            ]
        )

    def pose(self, t: Float, idle: IdleState) -> Pose:
        body, place = self.person, self.step.place
        share, upset, *steps = self.course(t)
        turn = share * place.turn
        ankles = self._ankles(np.array(steps))
        joint_offsets = hip_joints(body, turn, np.zeros(t.size))
        sway = sway_displacement(body.rest_height - body.ankle, idle.lean, idle.legs_roll)
        hip_xy = share * np.array([[place.ahead], [place.left]])
        standing = body.tallest - self.step.drop * upset
        bound = LegBound.at_rest(body).towards(LegBound.under_way(body), 1 - (1 - upset) ** 4)
        hip = hip_point_with_sway(
            body, standing, hip_xy, joint_offsets, ankles, turned(sway, turn), bound
        )
        joints = hip[:, None] + joint_offsets
        ahead = np.array([np.cos(turn), np.sin(turn), np.zeros(t.size)])
        knees = two_link(joints, ankles, body.leg, body.leg, ahead[:, None])
        pitch, lean = self.step.pitch * upset, self.step.lean * upset
        upright = axes(idle.pitch + pitch, idle.yaw, idle.roll + lean)
        trunk = Axes(*(turned(axis, turn) for axis in vars(upright).values()))
        upper, fore = arm_directions(
            trunk,
            idle.shoulders + self.step.arms * upset,
            body.elbow + idle.elbows + 0.5 * self.step.arms * upset,
        )
        return Pose(hip, trunk, joints, knees, ankles, upper, fore, idle.breath)
