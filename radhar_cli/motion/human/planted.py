"""Movements on planted feet, both legs alike: angles from the ankles up, no inverse kinematics.

knee = ankle + l (sin, cos)(shank), hip = knee + l (sin, cos)(thigh), angles from the vertical,
positive ahead; a seated thigh is at about -90 degrees.
"""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np

from radhar_cli.motion.human.arms import (
    ALONG_FLOOR,
    UPWARDS,
    arm_directions,
    arm_directions_near_floor,
)
from radhar_cli.motion.human.idle import IdleState
from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.part import STANDING, Phase, Place
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.pose import SIDES, Axes, Pose, axes, shoulder_points
from radhar_cli.numerics.arrays import Float

LEGS_AND_TRUNK = ("shank", "thigh", "trunk")
SHOULDERS = ("right_shoulder", "left_shoulder")
ELBOWS = ("right_elbow", "left_elbow")
HAND = 0.03  # height of the hand point on the floor, m

Posture = Mapping[str, float]


def posture(
    shank: float,
    thigh: float,
    trunk: float,
    shoulder: float,
    elbow: float,
    standing: float = 0.0,
    upright: float = 1.0,
) -> dict[str, float]:
    """Channels of a posture on planted feet; both sides alike, hands off the floor.

    Args:
        shank: Angle of the shanks from the vertical, positive ahead, rad; likewise thigh and trunk.
        thigh: rad.
        trunk: rad.
        shoulder: Flexion of the shoulders, rad.
        elbow: Flexion of the elbows, rad.
        standing: Share of the sway that the legs follow, 0 to 1.
        upright: Share of it that the trunk follows, 0 to 1.

    Returns:
        {channel: value}; with "hands", how far the hands are on the floor, at "hands_ahead" and
        "hands_beside" (m), and how far their elbows point outwards along it, "splayed";
        "heels", how far the shanks of a person on the knees are lifted (rad); "feet", how far the
        feet have slid ahead (m).
    """
    return {
        "shank": shank,
        "thigh": thigh,
        "trunk": trunk,
        "right_shoulder": shoulder,
        "left_shoulder": shoulder,
        "right_elbow": elbow,
        "left_elbow": elbow,
        "standing": standing,
        "upright": upright,
        "hands": 0.0,
        "hands_ahead": 0.0,
        "hands_beside": 0.0,
        "splayed": 0.0,
        "heels": 0.0,
        "feet": 0.0,
    }


def resting_channels(person: Physique) -> dict[str, float]:
    """Posture from which and to which standing people move, by channel."""
    return posture(person.rest_lean, -person.rest_lean, 0.0, 0.0, person.elbow, standing=1.0)


def steps_of_both_sides(
    channels: tuple[str, str], change: float, start: float, length: float
) -> list[Step]:
    """One step in each of two channels, those of the right and of the left side."""
    return [Step(channel, change, start, length) for channel in channels]


def scale_steps(steps: Iterable[Step], begin: float, unit: float) -> list[Step]:
    """Steps in s of those in units of a duration (`unit`, s) that begins at `begin` (s)."""
    return [
        step._replace(start=begin + unit * step.start, length=unit * step.length) for step in steps
    ]


@dataclass(frozen=True)
class Planted:
    """The `part.Part` of a movement on planted feet: a course of the channels of `posture`."""

    person: Physique
    course: Course
    begin: float
    end: float
    phases: tuple[Phase, ...]
    before: str = STANDING
    after: str = STANDING

    @property
    def place(self) -> Place:
        """Place where the feet are at the end: they stay where they are, unless they slide."""
        return Place(self.course.at(self.end)["feet"])

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return self.course.breakpoints

    def pose(self, t: Float, idle: IdleState) -> Pose:
        body = self.person
        shank, thigh, trunk, *channels, heels, feet = self.course(t)
        *arms, standing, upright, share, far, beside, splayed = channels
        ankle = np.array([np.zeros((2, 1)), body.hip * SIDES, np.full((2, 1), body.ankle)])
        ankles = np.broadcast_to(ankle, (3, 2, t.size))
        knee, hip = legs(body, shank, thigh, standing * idle.lean, standing * idle.legs_roll)
        if heels.any():
            up = shank + heels
            lifted = knee - body.leg * np.array([np.sin(up), np.zeros(t.size), np.cos(up)])
            ankles = ankles + np.where(heels, lifted, 0.0)[:, None]
        if feet.any():
            slid = np.array([feet, 0 * feet, 0 * feet])
            ankles, knee, hip = ankles + slid[:, None], knee + slid, hip + slid
        hip[2] += body.ankle
        tilted = axes(trunk + upright * idle.pitch, upright * idle.yaw, upright * idle.roll)
        shoulder = np.array(arms[:2]) + upright * idle.shoulders
        elbow = np.array(arms[2:]) + upright * idle.elbows
        hands = share, far, beside, splayed
        upper, fore = arms_of_posture(body, hip, tilted, (shoulder, elbow), hands)
        return Pose(
            hip=hip,
            trunk=tilted,
            hip_joints=hip[:, None] + np.array([0.0 * SIDES, body.hip * SIDES, 0.0 * SIDES]),
            knees=ankle + knee[:, None],
            ankles=ankles,
            upper_arms=upper,
            forearms=fore,
            breath=idle.breath,
        )


def legs(
    person: Physique, shank: Float, thigh: Float, lean: Float, roll: Float
) -> tuple[Float, Float]:
    """Knee and hip [3, M] above the ankle, m.

    Args:
        person: Person with the legs, both alike.
        shank: Angle from the vertical, positive ahead [M], rad.
        thigh: Angle from the vertical [M], rad.
        lean: Lean of both ahead [M], rad.
        roll: Lean of both to the left [M], rad.
    """
    s, h = shank + lean, thigh + lean
    up, left = np.cos(roll), np.sin(roll)
    x, z = person.leg * np.sin(s), person.leg * np.cos(s)
    knee = np.array([x, z * left, z * up])
    x, z = x + person.leg * np.sin(h), z + person.leg * np.cos(h)
    return knee, np.array([x, z * left, z * up])


def arms_of_posture(
    person: Physique,
    hip: Float,
    trunk: Axes,
    flexion: tuple[Float, Float],
    hands: tuple[Float, Float, Float, Float],
) -> tuple[Float, Float]:
    """Unit vectors of upper arms and forearms [3, 2, M] of which the hands may be on the floor.

    Args:
        hip: Hip point [3, M], m.
        flexion: Flexion of shoulders and of elbows, each [2, M], rad.
        hands: How far the hands are on the floor, how far ahead there and beside the middle (m),
            and how far their elbows point outwards along it, each [M].
    """
    share, far, beside, splayed = hands
    if not share.any():
        return arm_directions(trunk, *flexion)
    shoulders = shoulder_points(person, hip, trunk)
    floor = np.array([far + 0 * SIDES, beside * SIDES, HAND + 0 * (far + SIDES)])
    elbows = UPWARDS
    if splayed.any():
        over, along = UPWARDS[:, :, None], ALONG_FLOOR[:, :, None]
        elbows = over + splayed * (along - over)
    return arm_directions_near_floor(person, trunk, shoulders, flexion, floor, share, elbows)
