"""S7: the upper body turns from side to side over planted feet."""

from dataclasses import dataclass
from functools import cached_property
from math import inf, isinf, pi, radians

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.motion.human.arms import swung
from radhar_cli.motion.human.idle import IdleState
from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.part import STANDING, Phase, Place
from radhar_cli.motion.human.pelvis import hip_joints, swayed, swayed_hip
from radhar_cli.motion.human.person import Person
from radhar_cli.motion.human.pose import SIDES, Pose, axes
from radhar_cli.motion.human.two_link import AHEAD, two_link


@dataclass(frozen=True)
class Turn:
    """Turns for `duration` s; angles in rad.

    Attributes:
        frequency: Hz.
        angle: of the trunk to each side.
        pelvis: what the pelvis does of it.
        arms: how far the arms swing.
        lag: phase by which they follow the shoulders.
        entry: time in which the turning begins, and ends, s.
        from_rest: whether it begins from rest.
    """

    duration: float = inf
    frequency: float = 0.45
    angle: float = radians(45)
    pelvis: float = 0.45
    arms: float = radians(14)
    lag: float = radians(20)
    entry: float = 0.8
    from_rest: bool = False

    def part(self, person: Person, begin: float, horizon: float = 0.0) -> "Turning":
        """The movement from `begin` (s) on."""
        return Turning(person, self, begin)


@dataclass(frozen=True)
class Turning:
    """A person who turns; see `part.Part`."""

    person: Person
    turn: Turn
    begin: float

    after = STANDING
    place = Place()

    @property
    def before(self) -> str:
        """Standing, or turning."""
        return STANDING if self.turn.from_rest else "turning"

    @property
    def end(self) -> float:
        """When the body is at rest again, s."""
        return self.begin + self.turn.duration

    @property
    def phases(self) -> tuple[Phase, ...]:
        """Turning, then standing."""
        turning = Phase(self.begin, "turning")
        return (turning,) if isinf(self.end) else (turning, Phase(self.end, "standing"))

    @cached_property
    def course(self) -> Course:
        """How much of its amplitude the turning has."""
        entry, steps = self.turn.entry, []
        if self.turn.from_rest:
            steps.append(Step("drive", 1.0, self.begin, entry))
        if not isinf(self.end):
            steps.append(Step("drive", -1.0, self.end - entry, entry))
        return Course.of({"drive": 0.0 if self.turn.from_rest else 1.0}, steps)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Both ends of the entry and of the exit, s."""
        return self.course.breakpoints

    def pose(self, t: Float, idle: IdleState) -> Pose:
        """The body at times t [M] (s)."""
        body, turn, drive = self.person, self.turn, self.course(t)[0]
        phase = 2 * pi * turn.frequency * (t - self.begin)
        yaw = drive * turn.angle * np.sin(phase)
        aside = hip_joints(body, turn.pelvis * yaw, np.zeros(t.size))
        ankles = np.stack([np.zeros((2, 1)), body.hip * SIDES, np.full((2, 1), body.ankle)])
        ankles = np.broadcast_to(ankles, (3, 2, t.size))
        sway = swayed(body.rest_height - body.ankle, idle.lean, idle.legs_roll)
        hip = swayed_hip(
            body, body.tallest, np.zeros((2, t.size)), aside, ankles, body.softness, sway
        )
        joints = hip[:, None] + aside
        knees = two_link(joints, ankles, body.leg, body.leg, AHEAD)
        trunk = axes(idle.pitch, yaw + idle.yaw, idle.roll)
        swing = -SIDES * drive * turn.arms * np.sin(phase - turn.lag)
        upper, fore = swung(trunk, swing + idle.shoulders, body.elbow + idle.elbows)
        return Pose(hip, trunk, joints, knees, ankles, upper, fore, idle.breath)
