"""S7: the upper body turns from side to side over planted feet."""

from dataclasses import dataclass
from functools import cached_property
from math import ceil, isinf, pi, radians
from typing import Annotated, Generic

import numpy as np

from radhar_cli.motion.human.arms import arm_directions
from radhar_cli.motion.human.idle import IdleState
from radhar_cli.motion.human.minimum_jerk import Course, Step, minimum_jerk_integral
from radhar_cli.motion.human.part import STANDING
from radhar_cli.motion.human.pelvis import hip_joints, hip_point_with_sway, sway_displacement
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.pose import SIDES, Pose, axes
from radhar_cli.motion.human.two_link import AHEAD, two_link
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.repeating import (
    EACH,
    PHASE,
    Repeated,
    Repeating,
    draw_repetitions,
    nonzero_tuple,
)
from radhar_cli.numerics.arrays import Float
from radhar_cli.schema.annotations import PERSONAL, Paper, People
from radhar_cli.schema.number import ANGLE, FREQUENCY, NOT_NEGATIVE, vary
from radhar_cli.schema.section import B, ByActivity, Section, default_draw


class RotatingConfig(Section, Generic[B]):
    """Rotation of a body on the spot (S7)."""

    turn_deg: Annotated[
        B, ByActivity(ANGLE), People("body_rotating", -90, 90), Paper("S7"), PERSONAL
    ] = default_draw(vary(45.0, 0.2))
    """Angle through which a rotating body (S7) turns to each side."""
    rotation_hz: Annotated[
        B, ByActivity(NOT_NEGATIVE, FREQUENCY), People("body_rotating", 0, 1)
    ] = default_draw(vary(0.45, 0.2))
    """Turns of a rotating body (S7), to both sides, per second."""


SECTION = RotatingConfig


@dataclass(frozen=True)
class Turn(Repeated):
    """Turns the upper body from side to side for `duration` s; angles in rad."""

    frequency: float = 0.45  # Hz
    angle: float = radians(45)  # turn of the trunk to each side
    pelvis: float = 0.45  # turn of the pelvis over that of the trunk
    arms: float = radians(14)  # swing of the arms
    lag: float = radians(20)  # phase by which the arms follow the shoulders
    entry: float = 0.8  # time in which the turning begins, and ends, s
    from_rest: bool = False  # whether it begins from rest

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> "Turning":
        return Turning(person, self, begin, horizon)


class Turning(Repeating[Turn]):
    """The `part.Part` of a person who turns from side to side."""

    name = "turning"

    @property
    def before(self) -> str:
        return STANDING if self.movement.from_rest else "turning"

    @property
    def end(self) -> float:
        return self.begin + self.movement.duration

    @cached_property
    def course(self) -> Course:
        """Course of the turning's amplitude, 0 to 1, and of each turn's size over the usual one."""
        entry, sizes = self.movement.entry, self.movement.sizes
        steps = []
        if self.movement.from_rest:
            steps.append(Step("drive", 1.0, self.begin, entry))
        if not isinf(self.end):
            steps.append(Step("drive", -1.0, self.end - entry, entry))
        for start, size, next_size in zip(self._starts, sizes, sizes[1:], strict=False):
            steps.append(Step("size", next_size - size, start, 1 / self.movement.frequency))
        drive = 0.0 if self.movement.from_rest else 1.0
        return Course.of({"drive": drive, "size": sizes[0] if sizes else 1.0}, steps)

    @cached_property
    def _starts(self) -> Float:
        """Times at which turns to both sides begin [K], s, as long as one differs from the next."""
        f = self.movement.frequency
        count = max(len(self.movement.paces), len(self.movement.sizes)) - 1
        within = ceil(f * (min(self.horizon, self.end) - self.begin))
        starts: Float = self.begin + np.arange(max(0, min(count, within))) / (f or 1.0)
        return starts

    def _cycles(self, t: Float) -> Float:
        """Turns since the beginning [M] at times t [M], s; their frequency changes smoothly."""
        f, paces, starts = self.movement.frequency, self.movement.paces, self._starts
        rates = f / np.array((*paces[: starts.size + 1],) or (1.0,))
        if not f or rates.size == 1:
            return np.asarray(rates[0] * (t - self.begin))
        # Within each 1/f from `starts` on the frequency goes from one rate to the next.
        starts, cycles_before = (
            starts[: rates.size - 1],
            np.cumsum((rates[:-1] + rates[1:]) / (2 * f)),
        )
        k = np.maximum(np.searchsorted(starts, t, side="right") - 1, 0)
        since, gain = t - starts[k], (rates[k + 1] - rates[k]) / f
        cycles_before = np.concatenate([[0.0], cycles_before])[k]
        cycles: Float = cycles_before + rates[k] * since + gain * minimum_jerk_integral(f * since)
        return cycles

    @property
    def breakpoints(self) -> tuple[float, ...]:
        turns = tuple(self._starts.tolist())
        ends = tuple(start + 1 / self.movement.frequency for start in turns)
        return (*self.course.breakpoints, *turns, *ends)

    def pose(self, t: Float, idle: IdleState) -> Pose:
        body, turn, (drive, size) = self.person, self.movement, self.course(t)
        phase, drive = 2 * pi * self._cycles(t), drive * size
        yaw = drive * turn.angle * np.sin(phase)
        aside = hip_joints(body, turn.pelvis * yaw, np.zeros(t.size))
        ankles = np.array([np.zeros((2, 1)), body.hip * SIDES, np.full((2, 1), body.ankle)])
        ankles = np.broadcast_to(ankles, (3, 2, t.size))
        sway = sway_displacement(body.rest_height - body.ankle, idle.lean, idle.legs_roll)
        hip = hip_point_with_sway(body, body.tallest, np.zeros((2, t.size)), aside, ankles, sway)
        joints = hip[:, None] + aside
        knees = two_link(joints, ankles, body.leg, body.leg, AHEAD)
        trunk = axes(idle.pitch, yaw + idle.yaw, idle.roll)
        swing = -SIDES * drive * turn.arms * np.sin(phase - turn.lag)
        upper, fore = arm_directions(trunk, swing + idle.shoulders, body.elbow + idle.elbows)
        return Pose(hip, trunk, joints, knees, ankles, upper, fore, idle.breath)


def make_turns(mover: Mover) -> Turn:
    """Make a person turn the trunk to and fro, from rest."""
    rotating, (paces, sizes) = mover.numbers(RotatingConfig[float]), draw_repetitions(mover)
    return Turn(
        duration=mover.duration,
        frequency=rotating.rotation_hz,
        angle=radians(rotating.turn_deg),
        from_rest=True,
        paces=nonzero_tuple(paces),
        sizes=nonzero_tuple(sizes),
    )


MOVEMENTS = (
    MovementKind(
        "body_rotating",
        "stands and turns the trunk to and fro",
        make_turns,
        in_place=True,
        uses=(PHASE, *EACH),
        rate=lambda mover: mover.numbers(RotatingConfig[float]).rotation_hz,
        words="rotating twisting body_rotation",
        nearby="turning turn twist turn_left turn_right twist_left twist_right spin rotate",
    ),
)
