"""Crawling on hands and knees: planted knees and hands, swung in turn, diagonal limbs together.

Adults and infants move diagonal limbs together, the less so the slower they are (Patrick, Noah and
Yang, J. Neurophysiol. 101 (2009) 603), in the lateral sequence: after a knee comes the hand of its
side (Righetti et al., Front. Neurol. 6 (2015) 17, of infants, whose arms are stretched and reach
far ahead). Adults were measured at 0.28 to 0.69 m/s (Ma et al., Sensors 17 (2017) 692). Stride
length, share of the stance and lifts are guesses.

A thigh is as long as it is: the hip joint is on a circle about the planted knee, so the pelvis
rises and sinks with each stride, and rolls as a knee is lifted. Feet trail behind the knees.
"""

from dataclasses import dataclass
from functools import cached_property
from math import ceil, inf, sqrt

import numpy as np

from radhar_cli.motion.human.arms import UPWARDS, arm_directions_to_hands
from radhar_cli.motion.human.idle import IdleState, motionless
from radhar_cli.motion.human.kneeling import CRAWLING
from radhar_cli.motion.human.minimum_jerk import Course, Step, minimum_jerk_integral
from radhar_cli.motion.human.part import ON_FOURS, Phase, Place
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import Planted
from radhar_cli.motion.human.pose import SIDES, Pose, axes, shoulder_points
from radhar_cli.numerics.arrays import Float

# Length of a stride at 0.5 m/s of who is 1.75 m tall, and the longest that thighs allow, over the
# stature.
STRIDE, LONGEST = 0.36, 0.5
SWING_SHARE = 0.36, 0.12  # share of a stride in which a limb swings: at rest, and more per m/s
# By how much of a stride a hand is ahead of the knee across: at rest, and less per m/s.
LEAD, LEAD_LOSS = 0.14, 0.10
LIFTS = 0.018, 0.032  # of a swinging knee and hand, over the stature
ARM = 0.96  # length of an arm on which the trunk rests at most, over upper arm and forearm
SOFTNESS = 60.0  # of that bound, 1/m
TRUNK_ROLL, TRUNK_YAW = -0.3, 0.10  # of the pelvis's roll, and of the turn that hands ask for
KNEES, HANDS = ("right_knee", "left_knee"), ("right_hand", "left_hand")


@dataclass(frozen=True)
class Crawl:
    """Crawls ahead for `duration` s, then comes to rest on hands and knees."""

    speed: float = 0.5  # m/s
    duration: float = inf
    stride: float = 1.0  # length of a stride over the usual one
    misses: tuple[float, ...] = ()  # how far each foothold is off its place, over the stride

    def part(self, person: Physique, begin: float, horizon: float) -> "Crawling":
        return Crawling(person, self, begin, horizon)


@dataclass(frozen=True)
class Crawling:
    """The `part.Part` of a person who crawls."""

    person: Physique
    crawl: Crawl
    begin: float
    horizon: float

    before = ON_FOURS
    after = ON_FOURS

    @cached_property
    def period(self) -> float:
        """Duration of a stride, s."""
        body, crawl = self.person, self.crawl
        pace = crawl.speed / 0.5 * sqrt(1.75 / body.stature)
        stride = crawl.stride * STRIDE * sqrt(pace)
        stride /= (1 + (stride / LONGEST) ** 6) ** (1 / 6)
        period: float = stride * body.stature / crawl.speed
        return period

    @property
    def _stops(self) -> float:
        """When the body begins to slow down, s."""
        last = max(self.horizon, self.begin) + 2 * self.period
        return min(self.begin + self.crawl.duration, last)

    @property
    def place(self) -> Place:
        """Place where the body comes to rest."""
        return Place(float(self._way(np.array([self._stops + 9 * self.period]))[0]))

    @property
    def end(self) -> float:
        """When the last limb has come down, s; infinity for who goes on."""
        if self.crawl.duration == inf:
            return inf
        course = self.course
        return float((course.starts + course.lengths).max())

    @property
    def phases(self) -> tuple[Phase, ...]:
        """Names of what is under way, and from when on."""
        end = self.end
        rest = () if end == inf else (Phase(end, "kneeling"),)
        return (Phase(self.begin, "crawling"), *rest)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Instants at which a position is not smooth, s."""
        ramps = [start + k * self.period for start in (self.begin, self._stops) for k in (0, 1)]
        return (*self.course.breakpoints, *ramps)

    def _way(self, t: Float) -> Float:
        """How far the body has come at times t [M] (s), m."""
        up, down = ((t - start) / self.period for start in (self.begin, self._stops))
        strides = minimum_jerk_integral(up) - minimum_jerk_integral(down)
        return self.crawl.speed * self.period * strides

    @cached_property
    def rest(self) -> Pose:
        """Pose at rest, of a body that holds its breath [1]."""
        course, t = Course.of(CRAWLING.posture(self.person), ()), np.zeros(1)
        return Planted(self.person, course, 0.0, 0.0, ()).pose(t, motionless(self.person)(t))

    @cached_property
    def course(self) -> Course:
        """Course of how far each limb is ahead of where it is at rest, and of its lift, m."""
        speed, period, body = self.crawl.speed, self.period, self.person
        swing = SWING_SHARE[0] + SWING_SHARE[1] * speed
        lead = max(LEAD - LEAD_LOSS * speed, 0.0)
        phases = dict(zip((*KNEES, *HANDS), (0.0, 0.5, 0.5 - lead, 1 - lead), strict=True))
        count = ceil((self._stops - self.begin) / period) + 3
        misses = iter(np.resize(self.crawl.misses or (0.0,), 4 * count).tolist())
        steps = list[Step]()
        for limb, phase in phases.items():
            lift = LIFTS[limb in HANDS] * body.stature
            starts = self.begin + (np.arange(count) + phase) * period
            targets = self._way(starts + (1 + swing) / 2 * period)
            place = 0.0
            for start, target in zip(starts.tolist(), targets.tolist(), strict=True):
                goes_on = target < self.place.ahead - 1e-9
                target += next(misses) * speed * period * goes_on
                change = target - place
                if abs(change) < 1e-6:
                    continue
                height = lift * min(1.0, 2 * abs(change) / (speed * period))
                half = swing * period / 2
                steps += [
                    Step(limb, change, start, 2 * half),
                    Step(f"{limb}_up", height, start, half),
                    Step(f"{limb}_up", -height, start + half, half),
                ]
                place = target
        channels = (*KNEES, *HANDS, *(f"{limb}_up" for limb in (*KNEES, *HANDS)))
        return Course.of(dict.fromkeys(channels, 0.0), steps)

    def pose(self, t: Float, idle: IdleState) -> Pose:
        """Pose of the body at times t [M] (s)."""
        body, rest = self.person, self.rest
        course, zero = self.course(t), np.zeros((2, t.size))
        distance = self._way(t)
        knees = rest.knees + np.array([course[:2], zero, course[4:6]])
        hip, joints, roll = self._pelvis(knees, rest.hip[0] + distance)
        down = joints - knees
        level = np.sqrt(body.leg**2 - down[0] ** 2 - down[1] ** 2)
        knees = np.array([knees[0], knees[1], joints[2] - level])
        drop = knees[2] - body.ankle
        trailing = np.sqrt(body.leg**2 - drop**2)
        ankles = np.array([knees[0] - trailing, knees[1], zero + body.ankle])
        hands = self._resting_hands + np.array([course[2:4], zero, course[6:8]])
        yaw = -TRUNK_YAW * (hands[0, 1] - hands[0, 0]) / (2 * body.shoulder)
        trunk = axes(self._pitch(hip, hands, yaw), yaw, TRUNK_ROLL * roll)
        shoulders = shoulder_points(body, hip, trunk)
        frame = np.array([trunk.ahead, trunk.left, trunk.up])
        reached = np.einsum("axm,xim->aim", frame, hands - shoulders)
        poles = np.broadcast_to(UPWARDS[:, :, None], reached.shape)
        upper, fore = arm_directions_to_hands(trunk, reached, poles, body.arm)
        return Pose(hip, trunk, joints, knees, ankles, upper, fore, idle.breath)

    def _pelvis(self, knees: Float, ahead: Float) -> tuple[Float, Float, Float]:
        """Hip point [3, M], hip joints [3, 2, M] (m) and roll to the left [M] (rad) over knees."""
        body = self.person
        off = ahead - knees[0]
        heights = knees[2] + np.sqrt(body.leg**2 - off * off)
        rise = (heights[0] - heights[1]) / (2 * body.hip)
        roll = np.arcsin(rise / (1 + rise**8) ** 0.125)
        hip = np.array([ahead, 0 * ahead, heights.mean(axis=0)])
        left = np.array([0 * ahead, np.cos(roll), -np.sin(roll)])
        return hip, hip[:, None] + body.hip * SIDES * left[:, None], roll

    @cached_property
    def _resting_hands(self) -> Float:
        """Hands at rest [3, 2, 1], m."""
        p = np.empty((3, 13, 1))
        self.rest.joints(self.person, p)
        hands: Float = p[:, 4:8:3].copy()
        return hands

    def _pitch(self, hip: Float, hands: Float, yaw: Float) -> Float:
        """Pitch of the trunk [M] (rad) at which both arms reach the floor.

        The middle between the shoulders is as high as at rest, softly no higher than either arm
        lets it be.
        """
        length = self.person.trunk + self.person.shoulder
        high = self.rest.hip[2] + length * self.rest.trunk.up[2]
        height = high - self._sinking(hip, hands, yaw) + self._sinking_at_rest
        pitch: Float = np.arccos((height - hip[2]) / length)
        return pitch

    @cached_property
    def _sinking_at_rest(self) -> Float:
        """Sinking [1] (m) at rest, where the shoulders are as high as they are."""
        return self._sinking(self.rest.hip, self._resting_hands, np.zeros(1))

    def _sinking(self, hip: Float, hands: Float, yaw: Float) -> Float:
        """Distance [M] (m) by which the shoulders are lower so that arms reach the floor."""
        body = self.person
        length = body.trunk + body.shoulder
        up = self.rest.trunk.up
        high = self.rest.hip[2] + length * up[2]
        ahead = hip[0] + length * up[0] - body.shoulder * SIDES * np.sin(yaw)
        beside = hip[1] + body.shoulder * SIDES * np.cos(yaw) + length * up[0] * np.sin(yaw)
        apart = (hands[0] - ahead) ** 2 + (hands[1] - beside) ** 2
        reach = ARM * 2 * body.arm
        limits = hands[2] + np.sqrt(np.maximum(reach**2 - apart, 0.0))
        sinking: Float = np.log1p(np.exp(SOFTNESS * (high - limits)).sum(axis=0)) / SOFTNESS
        return sinking
