"""Lying on the floor or in a bed: on the back, on a side, on the belly, and turning over.

The body turns about its long axis by a roll: 0 on the back, 90 degrees on the left side, 180 on the
belly, -90 on the right side. Limbs are curves of the roll, a + b cos(roll) + c cos(2 roll) + d
sin(roll), through these four postures, so that turning over goes through all between them.
Thighs and trunk rest on the surface at the thickness of the body's ellipsoids
(`radhar_cli.motion.segments`); where the limbs are is a guess. In bed people spend 54 % of the time
on a side, 38 % on the back, 7 % on the belly, and shift 1.6 times an hour (Skarpsno et al., Nat.
Sci. Sleep 9 (2017) 267). Turning rolls shoulders and pelvis one after the other, the arm reaching
across and the knee drawn up, as adults most often do (Richter, VanSant and Newton, Phys. Ther. 69
(1989) 63); how long it takes is a guess.

Breathing moves the chest ahead (Kaneko and Horie, Respir. Care 57 (2012) 1442, of people on the
back): upwards on the back, level on a side. The belly cannot move into the
surface, so the back rises; that it does so as far as a chest is a guess.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import cos, inf, pi, radians, sin
from typing import Annotated, Generic

import numpy as np

from radhar_cli.motion.human.idle import IdleState
from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.part import LYING, Phase, Place
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import scale_steps
from radhar_cli.motion.human.pose import Axes, Pose, shoulder_points
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.words import ON_FLOOR
from radhar_cli.motion.segments import unit
from radhar_cli.numerics.arrays import Float
from radhar_cli.schema.annotations import People
from radhar_cli.schema.number import ANGLE, NOT_NEGATIVE, RATIO, Choice, normal, uniform
from radhar_cli.schema.section import B, ByActivity, Section, default_draw


class LyingConfig(Section, Generic[B]):
    """Lying on the floor or in bed, lying down, turning over and getting up from bed."""

    roll_deg: Annotated[B, ByActivity(ANGLE), People(None, -180, 180)] = default_draw(
        Choice(choice=(0.0, 90.0, -90.0, 180.0), weights=(3, 2, 2, 1))
    )
    """Side that a lying person rests on: 0 the back, 90 the left, -90 the right, 180 the belly."""
    turn_deg: Annotated[B, ByActivity(ANGLE), People("turning_over", -180, 180)] = default_draw(
        Choice(choice=(90.0, -90.0, 180.0, -180.0))
    )
    """Angle of a turn over, to the left or, below 0, to the right."""
    bed: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("lying turning_over", 0, 1)] = (
        default_draw(Choice(choice=(0.0, 1.0)))
    )
    """Whether a person who lies at first is in bed: above 0.5 in bed, else on the floor."""
    bed_height: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(None, 0.19, 0.3)] = (
        default_draw(normal(0.25, 0.02, 0.2, 0.29))
    )
    """Height of the mattress under a person, relative to the stature."""
    head_deg: Annotated[B, ByActivity(ANGLE), People("lying turning_over", -360, 360)] = (
        default_draw(uniform(-180.0, 180.0))
    )
    """Direction of a lying person's head at first, from where people head (angle_deg)."""
    hands: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(None, 0, 1)] = default_draw(
        uniform(0.0, 1.0)
    )
    """Place of the hands of a person on the back: 0 beside the body, 1 on the belly."""


SECTION = LyingConfig
# Keys of a person who lies, in bed or on the floor.
REST = ("lying.roll_deg", "lying.bed_height", "lying.hands")


IN_BED = "in bed"
LEFT_SIDE = pi / 2
# Lengths below are fractions of the stature. Heights above the surface on the back, on a side and
# on the belly: of the hip, and of the middle between the shoulders, on a pillow.
HIP, CHEST = (0.062, 0.097, 0.062), (0.072, 0.136, 0.070)
SHOULDERS = 5 / 18  # distance of that middle from the hip
# Directions of thigh, shank, upper arm and forearm, which need not be unit vectors: ahead, outwards
# and up of either side on the back and on the belly; ahead, to the left and up of the right and of
# the left one on the left side.
THIGHS = (0.18, 0.04, -1.0), ((0.75, 0.06, -0.7), (0.35, 0.0, -0.95)), (0.04, 0.06, -1.0)
SHANKS = (-0.26, 0.04, -1.0), ((-0.45, 0.03, -0.85), (-0.17, 0.0, -1.0)), (-0.03, 0.06, -1.0)
ARMS = (-0.12, 0.30, -1.0), ((0.50, 0.05, -0.20), (1.07, 0.0, 0.19)), (-0.08, 0.45, 0.77)
FOREARMS = (0.30, -0.10, -0.95), ((1.50, 0.95, 1.90), (1.78, 0.0, 1.20)), (-0.05, -0.50, 1.25)
# Arms of whose hands are on the belly, who lies on the back.
ARM_ON_BELLY, FOREARM_ON_BELLY = (-0.10, 0.35, -0.95), (0.50, -0.75, -0.50)
# Where a knee that is drawn up, and an arm that reaches across, have thigh, shank, arm and forearm:
# ahead, to the other side and up.
DRAWN = (0.85, 0.04, -0.5), (-0.65, 0.0, -0.75)
REACH = (0.9, 0.45, 0.15), (0.7, 0.7, 0.2)
# Heights above the surface below which knees, ankles, elbows and hands do not get, and toes.
LOWEST = {"thigh": 0.035, "shank": 0.030, "arm": 0.026, "forearm": 0.024}
HAND = 1.5  # length of a forearm with the hand over that of the forearm
TOES, TOES_HEIGHT = 0.12, 0.02
DROP = radians(35)  # by how much the feet of a person who lies hang from a right angle to the shank
EDGE = {"thigh": 0.04, "shank": 0.04, "arm": 0.12, "forearm": 0.12}  # rounds those bounds, rad
FIDGET = 0.5  # share of a standing person's turns of the trunk that who lies makes
# z of the direction ahead of a chest at which its rising becomes that of the back, and how fast.
TURNING, SHARPNESS = -0.5, 0.15
CLENCH = 0.5  # by how much a fidget of 1 rad of the elbow bends the forearm back
Vector = tuple[float, float, float]
Sides = tuple[Vector, tuple[Vector, Vector], Vector]


def _curve(supine: Float, left: Float, prone: Float, right: Float) -> Float:
    """Coefficients [4, ...] of 1, cos(roll), cos(2 roll), sin(roll) through four postures."""
    mean = (supine + prone + left + right) / 4
    twice = (supine + prone - left - right) / 4
    return np.array([mean, (supine - prone) / 2, twice, (left - right) / 2])


def _height_curve(heights: Vector) -> Float:
    """Curve [4] of heights on the back, on a side and on the belly."""
    back, side, belly = (np.array(height) for height in heights)
    return _curve(back, side, belly, side)


MIRROR = np.array([1.0, -1.0, 1.0])


def _limb_curve(sides: Sides) -> Float:
    """Curve [4, 3, 2] of a right and a left limb in axes (ahead, left, up)."""
    supine, (right, left), prone = sides

    def both(outwards: Vector) -> Float:
        return np.array([MIRROR * outwards, np.array(outwards)]).T

    on_left = np.array([right, left]).T
    on_right = MIRROR[:, None] * on_left[:, ::-1]
    return _curve(both(supine), on_left, both(prone), on_right)


_HIP, _CHEST = _height_curve(HIP), _height_curve(CHEST)
_LIMBS = {"thigh": THIGHS, "shank": SHANKS, "arm": ARMS, "forearm": FOREARMS}
_CURVES = {name: _limb_curve(sides) for name, sides in _LIMBS.items()}
_ON_BELLY = {
    "arm": _limb_curve((ARM_ON_BELLY, *ARMS[1:])),
    "forearm": _limb_curve((FOREARM_ON_BELLY, *FOREARMS[1:])),
}
LEG, ARM = ("thigh", "shank"), ("arm", "forearm")
GESTURES = ("drawn_right", "drawn_left", "reach_right", "reach_left")  # shares of a turn's


def _at_roll(curve: Float, roll: Float) -> Float:
    """Values [..., M] of a curve [4, ...] at rolls [M], rad."""
    waves = np.array([np.ones_like(roll), np.cos(roll), np.cos(2 * roll), np.sin(roll)])
    values: Float = np.tensordot(curve, waves, axes=(0, 0))
    return values


@dataclass(frozen=True)
class Rest:
    """Rest of somebody who lies; lengths over the stature, angles in rad."""

    roll: float = 0.0  # 0 on the back, pi/2 on the left side, pi on the belly
    surface: float = 0.0  # height of the surface, 0 for the floor
    hands: float = 0.0  # how far the hands of who lies on the back are on the belly, 0 to 1
    bed: bool = False

    @property
    def state(self) -> str:
        """State of rest, which only the same way of lying has."""
        where = IN_BED if self.bed else "on the floor"
        return f"{LYING} {where}, {self.surface:.6g}, rolled {self.roll % (2 * pi):.6g}"


def rolled_axes(yaw: Float | float, pitch: Float, roll: Float) -> Axes:
    """Axes of a body whose up points to the head: turned by `roll` about it, leaned, then turned.

    R_z(yaw) R_y(pitch) R_z(roll): with a pitch of -pi/2 and a yaw of pi the head points along x.
    """
    cy, sy, cp, sp = np.cos(yaw), np.sin(yaw), np.cos(pitch), np.sin(pitch)
    cr, sr = np.cos(roll), np.sin(roll)
    zero = np.zeros_like(cp)
    up = np.array([cy * sp, sy * sp, cp])
    forth, aside = np.array([cy * cp, sy * cp, -sp]), np.array([-sy + zero, cy + zero, zero])
    return Axes(cr * forth + sr * aside, cr * aside - sr * forth, up)


def in_room(frame: Axes, vectors: Float) -> Float:
    """Vectors [3, 2, M] of a body's axes (ahead, left, up) in the room's."""
    v = vectors
    room: Float = (
        v[0] * frame.ahead[:, None] + v[1] * frame.left[:, None] + v[2] * frame.up[:, None]
    )
    return room


Limbs = dict[str, Float]  # directions of thigh, shank, arm, forearm in a body's axes [3, 2, M]


def lying_limbs(hands: float, trunk_roll: Float, pelvis_roll: Float) -> Limbs:
    """Limbs of a lying person, at rolls [M] (rad) of trunk and pelvis; `hands` as of `Rest`."""
    arms = {name: _CURVES[name] + hands * (_ON_BELLY[name] - _CURVES[name]) for name in ARM}
    return {
        **{name: unit(_at_roll(_CURVES[name], pelvis_roll)) for name in LEG},
        **{name: unit(_at_roll(curve, trunk_roll)) for name, curve in arms.items()},
    }


def blend_limbs(first: Limbs, second: Limbs, legs: Float, arms: Float) -> Limbs:
    """Limbs a share [..., M] of the way from `first` to `second`, of the legs and of the arms."""
    return {
        name: first[name] + (legs if name in LEG else arms) * (second[name] - first[name])
        for name in first
    }


def hip_height(person: Physique, roll: Float) -> Float:
    """Height of the hip above the surface [M], m, at rolls [M] (rad) of the pelvis."""
    return person.stature * _at_roll(_HIP, roll)


def trunk_lift(trunk_roll: Float, pelvis_roll: Float) -> Float:
    """Angle by which the trunk rises towards the head [M], rad, at rolls [M] (rad)."""
    rise = _at_roll(_CHEST, trunk_roll) - _at_roll(_HIP, pelvis_roll)
    lift: Float = np.arcsin(rise / SHOULDERS)
    return lift


@dataclass(frozen=True)
class Surface:
    """Surface under a body: its height [M] (m), and how far legs and arms heed it [M], 0 to 1."""

    height: Float
    legs: Float
    arms: Float


def _level(direction: Float, lowest: Float, share: Float, edge: float = 0.04) -> Float:
    """Unit vectors [3, ..., M] that, as far as the share [M] says, point no lower than a bound.

    Args:
        direction: Directions.
        lowest: Their least z [..., M].
        share: 0 to 1.
        edge: Rounds the bound, rad.
    """
    towards = unit(direction)
    z = towards[2]
    bound = np.arcsin(lowest / (1 + lowest**8) ** 0.125)  # which is above no leg's reach
    above = np.arcsin(np.clip(z, -1.0, 1.0)) - bound
    up = share * 0.5 * (np.sqrt(above * above + edge**2) - above)
    up *= 1 - np.maximum(z, 0.0) ** 8  # nothing turns over the vertical
    cosine = np.sqrt(np.maximum(1 - z * z, 1e-12))
    level = np.cos(up) - np.sin(up) * z / cosine
    return np.concatenate([level * towards[:2], (z * np.cos(up) + cosine * np.sin(up))[None]])


def body_pose(
    person: Physique,
    hip: Float,
    pelvis: Axes,
    trunk: Axes,
    limbs: Limbs,
    surface: Surface,
    breath: Float,
) -> Pose:
    """Pose of a body of which hip, axes and limbs are known, above a surface.

    Args:
        hip: Hip point [3, M], m.
        limbs: Limbs in these axes.
        surface: Height that knees, ankles, elbows and hands stay above.
        breath: Displacement of the chest [M], m.
    """
    points = {}
    joints = hip[:, None] + person.hip * np.stack([-pelvis.left, pelvis.left], axis=1)
    shoulders = shoulder_points(person, hip, trunk)
    for names, start, frame, length, share in (
        (LEG, joints, pelvis, person.leg, surface.legs),
        (ARM, shoulders, trunk, person.arm, surface.arms),
    ):
        point = start
        for name in names:
            lowest = surface.height + LOWEST[name] * person.stature - point[2]
            beyond = HAND if name == "forearm" else 1.0
            limb = in_room(frame, limbs[name])
            direction = _level(limb, lowest / (beyond * length), share, EDGE[name])
            point = point + length * direction
            points[name] = direction, point
    shank, ankles = points["shank"]
    upwards = np.tanh((trunk.ahead[2] - TURNING) / SHARPNESS)
    return Pose(
        hip,
        trunk,
        joints,
        points["thigh"][1],
        ankles,
        points["arm"][0],
        points["forearm"][0],
        breath * (1 + surface.arms * (upwards - 1)),
        _toes(person, pelvis, shank, ankles, surface),
    )


def _toes(person: Physique, pelvis: Axes, shank: Float, ankles: Float, surface: Surface) -> Float:
    """Directions [3, 2, M] from ankles to toes that hang, or lie on the surface."""
    left = np.broadcast_to(pelvis.left[:, None], shank.shape)
    ahead = np.cross(shank, left, axis=0)  # up, of a person who lies on the back
    hanging = cos(DROP) * ahead + sin(DROP) * shank
    lowest = surface.height + TOES_HEIGHT * person.stature - ankles[2]
    return _level(hanging, lowest / (TOES * person.stature), np.ones_like(surface.legs))


@dataclass(frozen=True)
class Lie:
    """Lies for `duration` s."""

    rest: Rest = field(default_factory=Rest)
    duration: float = inf
    head: float = 0.0  # direction of the head from where the person would head, rad

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> "Lying":
        phases = (Phase(begin, "lying"),)
        course = Course.of(resting_channels(self.rest), ())
        end = begin + self.duration
        return Lying(person, self.rest, self.rest, course, begin, end, phases, self.head)


def resting_channels(rest: Rest) -> dict[str, float]:
    """Channels of `Lying` at rest: rolls of trunk and pelvis, and what a turn adds to them."""
    return {"trunk": rest.roll, "pelvis": rest.roll, **dict.fromkeys(GESTURES, 0.0)}


@dataclass(frozen=True)
class Lying:
    """The `part.Part` of a person who lies or turns over.

    Local axes: x from the hip to the head, the origin on the floor below the hip.
    """

    person: Physique
    rest: Rest  # how the person lies at first
    rest_after: Rest  # how the person lies at the end
    course: Course
    begin: float
    end: float
    phases: tuple[Phase, ...]
    head: float = 0.0

    @property
    def before(self) -> str:
        return self.rest.state

    @property
    def after(self) -> str:
        return self.rest_after.state

    @property
    def place(self) -> Place:
        return Place(turn=self.head)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return self.course.breakpoints

    def pose(self, t: Float, idle: IdleState) -> Pose:
        body, zero = self.person, np.zeros(t.size)
        trunk_roll, pelvis_roll, *gestures = self.course(t)
        limbs = lying_limbs(self.rest.hands, trunk_roll, pelvis_roll)
        limbs = with_gestures(limbs, np.array(gestures), pelvis_roll)
        limbs["forearm"] = limbs["forearm"] - CLENCH * idle.elbows * limbs["arm"]
        yaw, flat = pi + self.head, zero - pi / 2
        pelvis = rolled_axes(yaw, flat, pelvis_roll)
        lift = trunk_lift(trunk_roll, pelvis_roll)
        trunk = rolled_axes(yaw, flat + lift, trunk_roll + FIDGET * idle.yaw)
        height = zero + body.stature * self.rest.surface
        hip = np.array([zero, zero, height + hip_height(body, pelvis_roll)])
        surface = Surface(height, zero + 1, zero + 1)
        return body_pose(body, hip, pelvis, trunk, limbs, surface, idle.breath)


def with_gestures(limbs: Limbs, gestures: Float, pelvis_roll: Float) -> Limbs:
    """Limbs of which knees are drawn up and arms reach across.

    Args:
        limbs: Limbs without that.
        gestures: Share of the right and left knee, then of the right and left arm [4, M]; less of
            both of a person who lies on the belly.
        pelvis_roll: [M], rad.
    """
    knees, arms = 0.5 * (1 + np.cos(pelvis_roll)) * gestures.reshape(2, 2, -1)
    across = np.array([[1.0, 1.0], [1.0, -1.0], [1.0, 1.0]])[..., None]  # to the left, to the right
    vectors = dict(zip((*LEG, *ARM), (*DRAWN, *REACH), strict=True))
    targets = {name: across * np.array(v)[:, None, None] for name, v in vectors.items()}
    return blend_limbs(limbs, targets, knees, arms)


@dataclass(frozen=True)
class TurnOver:
    """Turns over from one way of lying to another within `duration` s."""

    rest: Rest = field(default_factory=Rest)
    by: float = pi / 2  # roll to the left, rad
    duration: float = 5.0
    head: float = 0.0  # as of `Lie`

    @property
    def after(self) -> Rest:
        return replace(self.rest, roll=wrap_angle(self.rest.roll + self.by))

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Lying:
        course = Course.of(
            resting_channels(self.rest), scale_steps(self._steps(), begin, self.duration)
        )
        end = begin + self.duration
        phases = (Phase(begin, "turning over"), Phase(end, "lying"))
        return Lying(person, self.rest, self.after, course, begin, end, phases, self.head)

    def _steps(self) -> Sequence[Step]:
        """Steps in units of the duration: the arm and the leg that lead, shoulders, pelvis."""
        leading = "right" if self.by > 0 else "left"
        size = min(1.0, abs(self.by) / (pi / 2))
        return [
            Step("trunk", self.by, 0.06, 0.84),
            Step("pelvis", self.by, 0.14, 0.86),
            Step(f"drawn_{leading}", size, 0.0, 0.4),
            Step(f"drawn_{leading}", -size, 0.42, 0.45),
            Step(f"reach_{leading}", size, 0.0, 0.5),
            Step(f"reach_{leading}", -size, 0.5, 0.5),
        ]


def wrap_angle(angle: float) -> float:
    """Return the same angle between -pi and pi, rad."""
    return float(np.arctan2(sin(angle), cos(angle)))


def make_rest(mover: Mover) -> Rest:
    """Make the way in which a person lies in bed."""
    lying = mover.numbers(LyingConfig[float])
    return Rest(radians(lying.roll_deg), lying.bed_height, lying.hands, bed=True)


def _make_first_rest(mover: Mover) -> Rest:
    """Make the way in which a person lies at first, in bed or on the floor."""
    rest = make_rest(mover)
    return rest if mover.is_in_bed else replace(rest, surface=0.0, bed=False)


def make_lying(mover: Mover) -> Lie:
    """Make a person lie still."""
    head = radians(mover.numbers(LyingConfig[float]).head_deg)
    return Lie(_make_first_rest(mover), mover.duration, head)


def make_turn_over(mover: Mover) -> TurnOver:
    """Make a person who lies turn over."""
    lying, rest = mover.numbers(LyingConfig[float]), _make_first_rest(mover)
    return TurnOver(rest, radians(lying.turn_deg), mover.duration, radians(lying.head_deg))


MOVEMENTS = (
    MovementKind(
        "lying",
        "lies still",
        make_lying,
        LYING,
        LYING,
        also=(("in_bed", "in_bed"),),
        rests=True,
        uses=REST,
        words="sleeping sleep lying_still laying resting lie liegen",
        manners=f"{ON_FLOOR} on_bed in_bed still flat",
        nearby="fallen",
    ),
    MovementKind(
        "turning_over",
        "lies and turns over",
        make_turn_over,
        LYING,
        LYING,
        5.0,
        also=(("in_bed", "in_bed"),),
        uses=REST,
        words="turn_over rolling_over rolling roll_over turn_over_in_bed rolling_in_bed",
        nearby="roll",
    ),
)
