"""Between a seat, or the floor after a fall, and lying: into bed, out of it, onto the belly.

A person who goes to bed sits down on its edge, lies down to the side of the pillow while the legs
swing up with the pelvis, and rolls over; getting up is the reverse: the log roll that nurses teach,
and one of the ways in which adults rise from a bed (Ford-Smith and VanSant, Phys. Ther. 73 (1993)
300). How long it takes differs with age and strength (Alexander et al., J. Rehabil. Res. Dev. 37
(2000) 633); the durations here, and the times within them, are guesses.
"""

from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from math import acos, atan2, cos, inf, pi, sin
from typing import NamedTuple, Protocol

import numpy as np

from radhar_cli.motion.human.idle import SWAYING, IdleState, motionless
from radhar_cli.motion.human.minimum_jerk import Course, Step, mirrored
from radhar_cli.motion.human.part import (
    HERE,
    STANDING,
    Part,
    Phase,
    Place,
    origin_seen_from,
    place_after,
)
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import scale_steps
from radhar_cli.motion.human.pose import Axes, Pose, feet
from radhar_cli.motion.movements.falling import PRONE
from radhar_cli.motion.movements.getting_up import GetUp, TryToGetUp
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.lying import (
    ARM,
    CLENCH,
    FIDGET,
    GESTURES,
    LEFT_SIDE,
    REST,
    Limbs,
    Rest,
    Surface,
    blend_limbs,
    body_pose,
    hip_height,
    in_room,
    lying_limbs,
    make_rest,
    rolled_axes,
    trunk_lift,
    with_gestures,
    wrap_angle,
)
from radhar_cli.motion.movements.sitting import LEAN, Rise, Seat, SitDown, StandUp, make_rise
from radhar_cli.motion.segments import unit
from radhar_cli.numerics.arrays import Float

FLESH = 0.047  # height of a seated hip above the bed, over the stature
EDGE = -0.05  # place of the bed's edge ahead of the ankles of who sits on it, over the stature
INWARDS = 0.06  # how far the hip goes away from it on lying down, over the stature
SIT, STAND = 0.32, 0.30  # share of the duration in which people sit down on the bed, and stand up
OVERLAP = 0.05  # share of it that both have in common with lying down and sitting up
ROLL = 4.0  # time in which who lies on the floor turns onto the belly before getting up, s
LONG_AGO = -1e6  # when what a body has done before began, s
IN_FRONT = 0.4  # how far arms go in front of the body on the way, over their direction
SHARES = ("trunk", "pelvis", "legs", "arms", "legs_over", "arms_over")


class Held(NamedTuple):
    """Angles of `lying.rolled_axes` of trunk and pelvis, rad."""

    trunk: tuple[float, float, float] = (0.0, 0.0, 0.0)  # yaw, pitch and roll
    pelvis: tuple[float, float, float] = (0.0, 0.0, 0.0)


def calm(idle: IdleState, share: Float) -> IdleState:
    """A body's own movements, of which a share [M] is left; breath and pulse stay."""
    calmed = IdleState(idle.idle, idle.t)
    for name in SWAYING:
        vars(calmed)[name] = share * getattr(idle, name)
    return calmed


@dataclass(frozen=True)
class Transfer:
    """The `part.Part` of a person who goes over from another part to lying, or back.

    Channels are the shares of the way to lying of trunk, pelvis, legs and arms, and of heeding the
    surface; rolls; x and y of the hip from where the other part has it (m).
    """

    person: Physique
    other: Part  # the seat, or what the body did before or does afterwards
    held: Held  # how the body is held in it
    rest: Rest  # how the person lies
    course: Course
    begin: float
    end: float
    phases: tuple[Phase, ...]
    before: str
    after: str
    place: Place
    origin: Place = HERE  # place of the other part's axes, seen from this one's

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return (*self.course.breakpoints, *self.other.breakpoints)

    def pose(self, t: Float, idle: IdleState) -> Pose:
        body = self.person
        of = dict(zip(self.course.channels, self.course(t), strict=True))
        other = self.other.pose(t, calm(idle, 1 - of["trunk"]))
        roll, pelvis_roll = of["trunk_roll"], of["pelvis_roll"]
        trunk, pelvis = self._axes(of, idle, other)
        limbs = blend_limbs(
            _limbs_of(body, other, rolled_axes(*(np.full(1, a) for a in self.held.pelvis))),
            lying_limbs(self.rest.hands, roll, pelvis_roll),
            of["legs"],
            of["arms"],
        )
        limbs["forearm"] -= of["arms"] * CLENCH * idle.elbows * limbs["arm"]
        for name in ARM:
            limbs[name][0] += IN_FRONT * 4 * of["arms"] * (1 - of["arms"])
        limbs = with_gestures(limbs, np.array([of[name] for name in GESTURES]), pelvis_roll)
        height = np.full(t.size, body.stature * self.rest.surface)
        hip = other.hip + np.array([of["x"], of["y"], np.zeros(t.size)])
        hip[2] += of["pelvis"] * (height + hip_height(body, pelvis_roll) - hip[2])
        surface = Surface(height, of["legs_over"], of["arms_over"])
        pose = body_pose(body, hip, pelvis, trunk, limbs, surface, idle.breath)
        assert pose.toes is not None
        standing = feet(body, pose)
        pose.toes = standing + of["legs_over"] * (pose.toes - standing)
        place = self.origin
        return pose.at(np.array(place.ahead), np.array(place.left), np.array(place.turn))

    def _axes(self, of: dict[str, Float], idle: IdleState, other: Pose) -> tuple[Axes, Axes]:
        """Axes of trunk and pelvis."""
        lift = trunk_lift(of["trunk_roll"], of["pelvis_roll"])
        yaw, pitch, _ = self.held.trunk
        pelvis_yaw, pelvis_pitch, _ = self.held.pelvis
        roll = of["trunk_roll"] + of["trunk"] * FIDGET * idle.yaw
        turned = rolled_axes(yaw, pitch + of["trunk"] * (lift - pi / 2 - pitch), roll)
        pelvis = rolled_axes(
            pelvis_yaw + of["pelvis"] * wrap_angle(yaw - pelvis_yaw),
            pelvis_pitch + of["pelvis"] * (-pi / 2 - pelvis_pitch),
            of["pelvis_roll"],
        )
        at_first = rolled_axes(*(np.full(1, angle) for angle in self.held.trunk))
        leaned = (_in_axes(at_first, axis) for axis in vars(other.trunk).values())
        return Axes(*(in_room(turned, axis[:, None])[:, 0] for axis in leaned)), pelvis


def _in_axes(frame: Axes, vectors: Float) -> Float:
    """Vectors [3, ..., M] of the room in a body's axes (ahead, left, up)."""
    rows = np.array([frame.ahead, frame.left, frame.up])
    inside: Float = np.array([sum(row[a] * vectors[a] for a in range(3)) for row in rows])
    return inside


def _limbs_of(person: Physique, pose: Pose, pelvis: Axes) -> Limbs:
    """Limbs of a pose, legs in the axes of the pelvis, arms in those of its trunk."""
    return {
        "thigh": _in_axes(pelvis, (pose.knees - pose.hip_joints) / person.leg),
        "shank": _in_axes(pelvis, (pose.ankles - pose.knees) / person.leg),
        "arm": _in_axes(pose.trunk, pose.upper_arms),
        "forearm": _in_axes(pose.trunk, pose.forearms),
    }


def _angles(frame: Axes) -> tuple[float, float, float]:
    """Yaw, pitch (0 or below) and roll of `lying.rolled_axes` of axes at one instant, rad."""
    ahead, _, up = (axis[:, 0] for axis in vars(frame).values())
    pitch, yaw = -acos(min(max(up[2], -1.0), 1.0)), atan2(-up[1], -up[0])
    forth = np.array([cos(yaw) * cos(pitch), sin(yaw) * cos(pitch), -sin(pitch)])
    aside = np.array([-sin(yaw), cos(yaw), 0.0])
    return yaw, pitch, atan2(float(ahead @ aside), float(ahead @ forth))


def _pose_at(person: Physique, part: Part, t: float) -> Pose:
    """Pose of a part at one time (s), of a body that holds its breath."""
    when = np.array([t])
    return part.pose(when, motionless(person)(when))


def _held(pose: Pose) -> Held:
    """Angles at which trunk and pelvis of a pose at one instant are held."""
    left = unit(pose.hip_joints[:, 1] - pose.hip_joints[:, 0])
    ahead = unit(np.cross(left, pose.trunk.up, axis=0))
    pelvis = Axes(ahead, left, np.cross(ahead, left, axis=0))
    return Held(_angles(pose.trunk), _angles(pelvis))


def _course(
    held: Held, steps: Iterable[Step], lying: bool = False, rolls: tuple[float, float] = (0.0, 0.0)
) -> Course:
    """Course of a `Transfer` that begins lying at `rolls` (rad), or held."""
    first = rolls if lying else (held.trunk[2], held.pelvis[2])
    initial = dict.fromkeys(SHARES, 1.0 if lying else 0.0)
    initial |= {"trunk_roll": first[0], "pelvis_roll": first[1], "x": 0.0, "y": 0.0}
    return Course.of(initial | dict.fromkeys(GESTURES, 0.0), steps)


def bed_seat(rest: Rest) -> Seat:
    """Seat on the edge of the bed in which people lie."""
    return Seat(height=rest.surface + FLESH)


@dataclass(frozen=True)
class GoToBed:
    """Sits down on a bed from standing, and lies down in it, within `duration` s."""

    rest: Rest = field(default_factory=lambda: Rest(surface=0.25, bed=True))
    side: float = 1.0  # 1 where the pillow is to the left of who sits on the bed, -1 to the right
    duration: float = 6.5
    rise: Rise = field(default_factory=Rise)

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Transfer:
        sit = SitDown(SIT * self.duration, bed_seat(self.rest), self.rise)
        seated = sit.part(person, begin)
        lies = begin + (SIT - OVERLAP) * self.duration
        held = _on_edge(self.side)
        steps = scale_steps(
            _lying_down(person, self.rest, self.side), lies, begin + self.duration - lies
        )
        phases = (
            *seated.phases[:1],
            Phase(lies, "lying down"),
            Phase(begin + self.duration, "lying"),
        )
        return Transfer(
            person=person,
            other=seated,
            held=held,
            rest=self.rest,
            course=_course(held, steps),
            begin=begin,
            end=begin + self.duration,
            phases=phases,
            before=STANDING,
            after=self.rest.state,
            place=_place_in_bed(person, self.rest, self.side),
        )


@dataclass(frozen=True)
class LeaveBed:
    """Sits up on the edge of the bed, and stands up, within `duration` s."""

    rest: Rest = field(default_factory=lambda: Rest(surface=0.25, bed=True))
    side: float = 1.0  # as of `GoToBed`
    duration: float = 6.0
    rise: Rise = field(default_factory=Rise)

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Transfer:
        length, end = (1 - STAND + OVERLAP) * self.duration, begin + self.duration
        stand = StandUp(STAND * self.duration, bed_seat(self.rest), self.rise)
        standing = stand.part(person, begin + (1 - STAND) * self.duration)
        held = _on_edge(self.side)
        down = _lying_down(person, self.rest, self.side)
        steps = scale_steps(mirrored(down, 1.0), begin, length)
        change = {c: sum(s.change for s in down if s.channel == c) for c in ("x", "trunk_roll")}
        roll = held.trunk[2] + change["trunk_roll"]
        course = _course(held, steps, lying=True, rolls=(roll, roll))
        course = replace(course, initial=course.initial + _column(course, "x", change["x"]))
        phases = (Phase(begin, "getting up"), Phase(end, "standing"))
        origin = origin_seen_from(_place_in_bed(person, self.rest, self.side))
        return Transfer(
            person=person,
            other=standing,
            held=held,
            rest=self.rest,
            course=course,
            begin=begin,
            end=end,
            phases=phases,
            before=self.rest.state,
            after=STANDING,
            place=place_after(origin, standing.place),
            origin=origin,
        )


def _column(course: Course, channel: str, value: float) -> Float:
    """Values [C, 1] of a course's channels, 0 of all but one."""
    return np.array([[value * (name == channel)] for name in course.channels])


def _on_edge(side: float) -> Held:
    """Hold of a person on the edge of a bed: on the way to one side."""
    upright = (-side * pi / 2, 0.0, side * LEFT_SIDE)
    return Held(upright, upright)


def _place_in_bed(person: Physique, rest: Rest, side: float) -> Place:
    """Place of a person in bed, from the ankles of the same person on its edge."""
    seated = _pose_at(person, SitDown(1.0, bed_seat(rest)).part(person, 0.0), 9.0)
    x, y = seated.hip[:2, 0].tolist()
    return Place(x - INWARDS * person.stature, y, side * pi / 2)


def _lying_down(person: Physique, rest: Rest, side: float) -> list[Step]:
    """Steps from sitting on the edge of a bed to lying in it, in units of the duration."""
    roll = wrap_angle(rest.roll - side * LEFT_SIDE)
    if abs(roll) > pi - 1e-6:  # over the back
        roll = -side * pi
    first = 0.42 - 0.22 * max(abs(roll) / (pi / 2) - 1, 0.0)  # who rolls farther begins earlier
    return [
        Step("trunk", 1.0, 0.0, 0.56),
        Step("pelvis", 1.0, 0.10, 0.50),
        Step("arms", 1.0, 0.05, 0.65),
        Step("legs", 1.0, 0.45, 0.45),
        Step("arms_over", 1.0, 0.10, 0.35),
        Step("legs_over", 1.0, 0.48, 0.30),
        Step("x", -INWARDS * person.stature, 0.25, 0.55),
        Step("trunk_roll", roll, first, 0.94 - first),
        Step("pelvis_roll", roll, first + 0.06, 0.94 - first),
    ]


@dataclass(frozen=True)
class Settle:
    """Turns over where a fall has ended, to the back, a side or the belly, within `duration` s."""

    fall: "Faller"  # the fall, or what else the person did on the floor before
    by: float = pi / 2  # roll to the left, rad, to the next of these four
    hands: float = 0.0  # as of `Rest`
    duration: float = 5.0

    def rest(self, person: Physique) -> Rest:
        """Rest in which the person lies at the end."""
        _, held, _ = self._fallen(person)
        roll = held.trunk[2] + self.by
        return Rest(wrap_angle(pi / 2 * round(roll / (pi / 2))), 0.0, self.hands)

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Transfer:
        fallen, held, origin = self._fallen(person)
        rest = self.rest(person)
        roll = rest.roll - held.trunk[2]
        roll += 2 * pi * round((self.by - roll) / (2 * pi))
        pelvis_roll = roll + held.trunk[2] - held.pelvis[2]
        pelvis_roll += 2 * pi * round((roll - pelvis_roll) / (2 * pi))
        steps = [
            *(Step(share, 1.0, 0.0, 0.5) for share in ("trunk", "pelvis")),
            Step("legs", 1.0, 0.0, 0.55),
            Step("arms", 1.0, 0.0, 0.6),
            Step("legs_over", 1.0, 0.0, 0.35),
            Step("arms_over", 1.0, 0.0, 0.2),
            Step("trunk_roll", roll, 0.12, 0.82),
            Step("pelvis_roll", pelvis_roll, 0.18, 0.82),
        ]
        end = begin + self.duration
        course = _course(held, scale_steps(steps, begin, self.duration))
        phases = (Phase(begin, "turning over"), Phase(end, "lying"))
        hip = _pose_at(person, fallen, begin).hip[:2, 0]
        under_hip = Place(float(hip[0]), float(hip[1]), held.trunk[0] - pi)
        return Transfer(
            person=person,
            other=fallen,
            held=held,
            rest=rest,
            course=course,
            begin=begin,
            end=end,
            phases=phases,
            before=fallen.after,
            after=rest.state,
            place=place_after(origin, under_hip),
            origin=origin,
        )

    def _fallen(self, person: Physique) -> tuple[Part, Held, Place]:
        """The fall's part, long over; how the body is held; and the fall's axes from its end."""
        fallen = self.fall.part(person, LONG_AGO, LONG_AGO)
        held = _held(_pose_at(person, fallen, 0.0))
        return fallen, held, origin_seen_from(fallen.place)


class Faller(Protocol):
    """A movement that ends on the floor."""

    def part(self, person: Physique, begin: float, horizon: float) -> Part: ...


@dataclass(frozen=True)
class LieStill:
    """Lies as a fall has left them, for `duration` s."""

    fall: Faller
    duration: float = inf

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> "Fallen":
        return Fallen(self.fall.part(person, LONG_AGO, LONG_AGO), begin, begin + self.duration)


@dataclass(frozen=True)
class Fallen:
    """The `part.Part` of a person who lies where a fall has ended."""

    fall: Part  # long over
    begin: float
    end: float

    place = HERE

    @property
    def before(self) -> str:
        return self.fall.after

    @property
    def after(self) -> str:
        return self.fall.after

    @property
    def phases(self) -> tuple[Phase, ...]:
        return (Phase(self.begin, "lying"),)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return ()

    def pose(self, t: Float, idle: IdleState) -> Pose:
        place = origin_seen_from(self.fall.place)
        pose = self.fall.pose(t, idle)
        return pose.at(np.array(place.ahead), np.array(place.left), np.array(place.turn))


@dataclass(frozen=True)
class RiseFromRest:
    """Gets up from lying on the floor, or tries to: onto the belly, then as after a fall."""

    rest: Rest
    getting_up: GetUp | TryToGetUp
    turning: float = ROLL  # time in which the person turns onto the belly, s

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> Transfer:
        belly = replace(self.getting_up, before=PRONE)
        rising = belly.part(person, begin + self.turning)
        prone = _pose_at(person, rising, begin)
        held = _held(prone)
        roll = wrap_angle(self.rest.roll - held.trunk[2])
        first = held.trunk[2] + roll
        steps = [
            *(Step(share, -1.0, 0.5, 0.5) for share in ("trunk", "pelvis")),
            *(Step(share, -1.0, 0.3, 0.7) for share in ("legs", "arms")),
            *(Step(share, -1.0, 0.65, 0.35) for share in ("legs_over", "arms_over")),
            Step("trunk_roll", -roll, 0.0, 0.85),
            Step("pelvis_roll", -roll, 0.05, 0.85),
        ]
        steps = scale_steps(steps, begin, self.turning)
        course = _course(held, steps, lying=True, rolls=(first, first))
        hip = prone.hip[:2, 0]
        lain = Place(float(hip[0]), float(hip[1]), held.trunk[0] - pi)
        origin = origin_seen_from(lain)
        phases = (Phase(begin, "getting up"), *rising.phases[-1:])
        return Transfer(
            person=person,
            other=rising,
            held=held,
            rest=self.rest,
            course=course,
            begin=begin,
            end=rising.end,
            phases=phases,
            before=self.rest.state,
            after=rising.after,
            place=place_after(origin, rising.place),
            origin=origin,
        )


def _draw_side(mover: Mover) -> float:
    """Draw the side on which the pillow is, seen by somebody who sits on the bed."""
    return 1.0 if mover.stream("motion.lying/side").random() < 0.5 else -1.0


def make_going_to_bed(mover: Mover) -> GoToBed:
    """Make a person go to bed."""
    return GoToBed(make_rest(mover), _draw_side(mover), mover.duration, make_rise(mover))


def make_leaving_bed(mover: Mover) -> LeaveBed:
    """Make a person get up from a bed."""
    return LeaveBed(make_rest(mover), _draw_side(mover), mover.duration, make_rise(mover))


MOVEMENTS = (
    MovementKind(
        "lying_down",
        "goes to bed: sits down on it and lies down",
        make_going_to_bed,
        STANDING,
        "in_bed",
        6.5,
        uses=(*REST, LEAN),
        words="lie_down going_to_bed go_to_bed laying_down lay_down hinlegen liedown stand_to_lie",
        manners="on_bed in_bed onto_bed to_bed",
        nearby="sit_to_lie",
    ),
    MovementKind(
        "getting_up_from_bed",
        "gets up from a bed",
        make_leaving_bed,
        "in_bed",
        STANDING,
        6.0,
        uses=(*REST, LEAN),
        words="get_out_of_bed leaving_bed getting_out_of_bed get_up_from_bed rise_from_bed",
        nearby="lie_to_sit sitting_up_in_bed",
    ),
)
