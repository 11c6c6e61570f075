"""A fall to the side: the legs tilt and give way, hip and shoulder meet the floor."""

from dataclasses import dataclass
from functools import cached_property
from math import acos, radians

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.motion.human.arms import supported
from radhar_cli.motion.human.idle import IdleState
from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.part import STANDING, Phase, Place
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import HAND, timed
from radhar_cli.motion.human.pose import SIDES, Pose, axes, shoulder_points
from radhar_cli.motion.human.two_link import AHEAD, two_link


@dataclass(frozen=True)
class FallSideways:
    """From standing to lying on one side; angles in rad."""

    duration: float = 1.1  # from the loss of balance to the impact of the shoulder, s
    side: float = 1.0  # 1 to the left, -1 to the right
    hip_height: float = 0.097  # of the hip on the floor, over the stature
    bent: float = 0.78  # distance from hip to ankles at the end, over thigh and shank
    tilt: float = radians(80)  # of pelvis and trunk to the side at the end
    curl: float = radians(8)  # pitch of the trunk at the end
    arms: float = radians(55)  # flexion of the shoulders as the hands look for the floor
    # where they end, ahead of the ankles and beyond the hip, over the stature
    hands: tuple[float, float] = (0.20, 0.20)

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> "FallingSideways":
        """The movement from `begin` (s) on."""
        return FallingSideways(person, self, begin)


@dataclass(frozen=True)
class FallingSideways:
    """A fall of a person; see `part.Part`."""

    person: Physique
    fall: FallSideways
    begin: float

    before = STANDING
    after = "lying on the side"
    place = Place()

    @property
    def end(self) -> float:
        """When the body lies, s."""
        return self.begin + 1.1 * self.fall.duration

    @property
    def phases(self) -> tuple[Phase, ...]:
        """Falling, then lying."""
        return (Phase(self.begin, "falling"), Phase(self.end, "lying"))

    @cached_property
    def course(self) -> Course:
        """Tilt and length of the legs, tilt of pelvis and trunk, arms."""
        body, fall = self.person, self.fall
        standing, bent = body.rest_height - body.ankle, fall.bent * 2 * body.leg
        legs = acos((fall.hip_height * body.stature - body.ankle) / bent)
        steps = [
            Step("legs", legs, 0.0, 0.90, late=True),
            Step("length", bent - standing, 0.10, 0.55),
            Step("pelvis", fall.tilt, 0.15, 0.75, late=True),
            Step("trunk", fall.tilt, 0.0, 1.0, late=True),
            Step("curl", fall.curl, 0.2, 0.8),
            Step("arms", fall.arms, 0.1, 0.6),
            Step("hands", 1.0, 0.30, 0.70),
            Step("still", 1.0, 0.0, 0.6),
        ]
        channels = ("legs", "length", "pelvis", "trunk", "curl", "arms", "hands", "still")
        initial = dict.fromkeys(channels, 0.0) | {"length": standing}
        return Course.of(initial, timed(steps, self.begin, fall.duration))

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Both ends of every step, s."""
        return self.course.breakpoints

    def pose(self, t: Float, idle: IdleState) -> Pose:
        """The body at times t [M] (s)."""
        body, fall = self.person, self.fall
        legs, length, pelvis, trunk, curl, arms, share, still = self.course(t)
        own, nothing = 1 - still, np.zeros(t.size)
        lean, roll = own * idle.lean, fall.side * legs + own * idle.legs_roll
        hip = length * np.stack(
            [np.sin(lean), np.cos(lean) * np.sin(roll), np.cos(lean) * np.cos(roll)]
        )
        hip[2] += body.ankle
        tilted = axes(nothing, nothing, fall.side * pelvis)
        joints = hip[:, None] + body.hip * SIDES * tilted.left[:, None]
        ankles = np.stack([np.zeros((2, 1)), body.hip * SIDES, np.full((2, 1), body.ankle)])
        ankles = np.broadcast_to(ankles, (3, 2, t.size))
        knees = two_link(joints, ankles, body.leg, body.leg, AHEAD)
        upper_body = axes(
            curl + own * idle.pitch, own * idle.yaw, fall.side * trunk + own * idle.roll
        )
        flexion = (arms + own * idle.shoulders, body.elbow + own * idle.elbows)
        lies = body.leg * 2 * fall.bent + fall.hands[1] * body.stature
        floor = np.array([[fall.hands[0] * body.stature], [fall.side * lies], [HAND]])[:, None]
        floor = np.broadcast_to(floor, (3, 2, t.size))
        shoulders = shoulder_points(body, hip, upper_body)
        off_floor = np.array([[0.0, 0.0], [-0.35 * fall.side] * 2, [-1.0, -1.0]])
        upper, fore = supported(body, upper_body, shoulders, flexion, floor, share, off_floor)
        return Pose(hip, upper_body, joints, knees, ankles, upper, fore, idle.breath)
