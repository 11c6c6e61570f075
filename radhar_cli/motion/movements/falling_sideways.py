"""A fall to the side, from standing or a seat: legs tilt and give way, the hip meets the floor."""

from dataclasses import dataclass
from functools import cached_property
from math import acos, atan2, hypot, radians, sin

import numpy as np

from radhar_cli.motion.human.arms import arm_directions_near_floor
from radhar_cli.motion.human.idle import IdleState
from radhar_cli.motion.human.minimum_jerk import Course, Step
from radhar_cli.motion.human.part import SEATED, STANDING, Phase, Place
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import HAND, scale_steps
from radhar_cli.motion.human.pose import SIDES, Pose, axes, shoulder_points
from radhar_cli.motion.human.two_link import AHEAD, two_link
from radhar_cli.motion.movements.sitting import Seat
from radhar_cli.numerics.arrays import Float

ON_SIDE = "lying on the side"
# Places of hands on the floor over the stature: how far each is off the middle between them, the
# lower one towards the head; where those of who gets up are, ahead of and beside the ankles.
APART = 0.09
NEAR = 0.34, 0.13
CHANNELS = (
    *("legs", "behind", "length", "pelvis", "trunk"),
    *("curl", "arms", "elbows", "hands", "still", "near"),
)


@dataclass(frozen=True)
class FallSideways:
    """Falls to one side, from standing or off a seat, until the body lies on it; angles in rad."""

    duration: float = 1.1  # from the loss of balance to the impact of the shoulder, s
    side: float = 1.0  # 1 to the left, -1 to the right
    hip_height: float = 0.097  # height of the hip on the floor, over the stature
    bent: float = 0.78  # distance from hip to ankles at the end, over thigh and shank
    curled: float = 0.62  # the same distance after a fall off a seat
    tilt: float = radians(80)  # tilt of pelvis and trunk to the side at the end
    # by how much less the trunk tilts over hands that break the fall
    caught: float = 0.0
    curl: float = radians(8)  # pitch of the trunk at the end
    arms: float = radians(55)  # flexion of the shoulders as the hands look for the floor
    # place of the hands at the end, ahead of the ankles and beyond the hip, over the stature
    hands: tuple[float, float] = (0.20, 0.20)
    seat: Seat | None = None  # seat off which people fall; None for a fall from standing
    rising: float = 0.0  # time for which they rise from the seat first, s

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> "FallingSideways":
        return FallingSideways(person, self, begin)


@dataclass(frozen=True)
class FallingSideways:
    """The `part.Part` of a person who falls sideways."""

    person: Physique
    fall: FallSideways
    begin: float

    after = ON_SIDE
    place = Place()

    @property
    def before(self) -> str:
        return STANDING if self.fall.seat is None else SEATED

    @property
    def fall_start(self) -> float:
        """Time at which the balance is lost, s."""
        return self.begin + 0.75 * self.fall.rising

    @property
    def end(self) -> float:
        return self.fall_start + 1.1 * self.fall.duration

    @property
    def phases(self) -> tuple[Phase, ...]:
        rising = (Phase(self.begin, "standing up"),) if self.fall.rising else ()
        return (*rising, Phase(self.fall_start, "falling"), Phase(self.end, "lying"))

    @cached_property
    def course(self) -> Course:
        """Course of tilt and length of the legs, tilt of pelvis and trunk, and arms."""
        body, fall = self.person, self.fall
        length = body.rest_height - body.ankle
        bent = (fall.bent if fall.seat is None else fall.curled) * 2 * body.leg
        legs = acos((fall.hip_height * body.stature - body.ankle) / bent)
        risen = dict[str, float]()
        initial = {"length": length, "elbows": body.elbow}
        if fall.seat is not None:
            seated = fall.seat.posture(body)
            ahead = body.leg * (sin(seated["shank"]) + sin(seated["thigh"]))
            up = fall.seat.height * body.stature - body.ankle
            initial = {"behind": atan2(ahead, up), "length": hypot(ahead, up)}
            initial |= {"arms": seated["right_shoulder"], "elbows": seated["right_elbow"]}
            initial |= {"curl": seated["trunk"]}
            if fall.rising:
                risen = {"length": 0.06, "behind": -initial["behind"] / 3, "curl": radians(36)}
        steps = [
            Step("legs", legs, 0.0, 0.90, late=True),
            Step("behind", -initial.get("behind", 0.0), 0.1, 0.9, late=True),
            Step("length", bent - initial["length"], 0.10, 0.55),
            Step("pelvis", fall.tilt, 0.15, 0.75, late=True),
            Step("trunk", fall.tilt - fall.caught, 0.0, 1.0, late=True),
            Step("curl", fall.curl - initial.get("curl", 0.0), 0.2, 0.8),
            Step("arms", fall.arms - initial.get("arms", 0.0), 0.1, 0.6),
            Step("elbows", body.elbow - initial["elbows"], 0.1, 0.6),
            Step("hands", 1.0, 0.30, 0.70),
            Step("still", 1.0, 0.0, 0.6),
        ]
        steps += [Step(channel, -angle, 0.2, 0.8) for channel, angle in risen.items()]
        steps = scale_steps(steps, self.fall_start, fall.duration)
        steps += [Step(channel, angle, self.begin, fall.rising) for channel, angle in risen.items()]
        return Course.of(dict.fromkeys(CHANNELS, 0.0) | initial, steps)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        return self.course.breakpoints

    def pose(self, t: Float, idle: IdleState) -> Pose:
        body, fall = self.person, self.fall
        legs, behind, length, pelvis, trunk, *channels, still, near = self.course(t)
        curl, arms, elbows, share = channels
        idle_share, zero = 1 - still, np.zeros(t.size)
        sway_share = idle_share * (self.before != SEATED)  # who sits does not sway
        lean, roll = behind + sway_share * idle.lean, fall.side * legs + sway_share * idle.legs_roll
        hip = length * np.array(
            [np.sin(lean), np.cos(lean) * np.sin(roll), np.cos(lean) * np.cos(roll)]
        )
        hip[2] += body.ankle
        tilted = axes(zero, zero, fall.side * pelvis)
        joints = hip[:, None] + body.hip * SIDES * tilted.left[:, None]
        ankles = np.array([np.zeros((2, 1)), body.hip * SIDES, np.full((2, 1), body.ankle)])
        ankles = np.broadcast_to(ankles, (3, 2, t.size))
        knees = two_link(joints, ankles, body.leg, body.leg, AHEAD)
        upper_body = axes(
            curl + idle_share * idle.pitch,
            idle_share * idle.yaw,
            fall.side * trunk + idle_share * idle.roll,
        )
        flexion = (arms + idle_share * idle.shoulders, elbows + idle_share * idle.elbows)
        bent = fall.bent if fall.seat is None else fall.curled
        beyond = fall.side * (2 * bent * body.leg / body.stature + fall.hands[1]) + APART * SIDES
        beside = body.stature * (beyond + near * (NEAR[1] * SIDES - beyond))
        ahead = body.stature * (fall.hands[0] + near * (NEAR[0] - fall.hands[0]) + 0 * SIDES)
        floor = np.array([ahead, beside, np.full((2, t.size), HAND)])
        shoulders = shoulder_points(body, hip, upper_body)
        off_floor = np.array([[0.0, 0.0], [-0.35 * fall.side] * 2, [-1.0, -1.0]])
        upper, fore = arm_directions_near_floor(
            body, upper_body, shoulders, flexion, floor, share, off_floor
        )
        return Pose(hip, upper_body, joints, knees, ankles, upper, fore, idle.breath)


@dataclass(frozen=True)
class RiseFromSide:
    """Gets up from lying on the side, over a crouch above the feet, within `duration` s.

    A vain try lifts the trunk, which sinks back. The way is a guess.
    """

    fall: FallSideways
    duration: float = 3.0
    tries: bool = False

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> "RisingFromSide":
        return RisingFromSide(person, self.fall, begin, self)


@dataclass(frozen=True)
class RisingFromSide(FallingSideways):
    """The `part.Part` of a person who gets up from the side."""

    rise: RiseFromSide

    before = ON_SIDE

    @property
    def after(self) -> str:  # type: ignore[override]
        """State at the end: standing, or on the side again."""
        return ON_SIDE if self.rise.tries else STANDING

    @property
    def end(self) -> float:
        return self.begin + self.rise.duration

    @property
    def phases(self) -> tuple[Phase, ...]:
        after = "lying" if self.rise.tries else STANDING
        return (Phase(self.begin, "getting up"), Phase(self.end, after))

    @cached_property
    def course(self) -> Course:
        """Course of getting up: trunk and hands first, then the hip over the feet, then up."""
        body = self.person
        fall = FallingSideways(body, self.fall, 0.0)
        lying = fall.course.at(fall.end)
        if self.rise.tries:
            lift = {"trunk": -0.4 * lying["trunk"], "curl": radians(12), "pelvis": radians(-8)}
            steps = [Step(channel, angle, 0.0, 0.5) for channel, angle in lift.items()]
            steps += [Step(channel, -angle, 0.6, 0.4) for channel, angle in lift.items()]
        else:
            low, high = 0.6 * body.leg, body.rest_height - body.ankle
            steps = [
                Step("trunk", 0.4 * -lying["trunk"], 0.0, 0.40),
                Step("trunk", 0.6 * -lying["trunk"], 0.35, 0.40),
                Step("near", 1.0, 0.10, 0.45),
                Step("hands", -1.0, 0.50, 0.30),
                Step("length", low - lying["length"], 0.15, 0.40),
                Step("length", high - low, 0.58, 0.42),
                Step("curl", radians(52) - lying["curl"], 0.15, 0.45),
                Step("curl", radians(-52), 0.60, 0.40),
                Step("arms", radians(45) - lying["arms"], 0.2, 0.3),
                Step("arms", radians(-45), 0.60, 0.40),
                *(Step(channel, -lying[channel], 0.22, 0.40) for channel in ("legs", "pelvis")),
                Step("still", -1.0, 0.6, 0.4),
            ]
        return Course.of(lying, scale_steps(steps, self.begin, self.rise.duration))
