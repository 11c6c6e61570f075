"""Crawling on hands and knees: planted knees and hands, swung in turn, diagonal limbs together.

Adults and infants move diagonal limbs together, the less so the slower they are (Patrick, Noah and
Yang, J. Neurophysiol. 101 (2009) 603), in the lateral sequence: after a knee comes the hand of its
side (Righetti et al., Front. Neurol. 6 (2015) 17, of infants, whose arms are stretched and reach
far ahead, and whose elbows hardly bend on the floor). Adults were measured at 0.28 to 0.69 m/s (Ma
et al., Sensors 17 (2017) 692). Stride length, shares of swings, their speeds and lifts are guesses:
knees are dragged, so they get 2.5 times the body's speed, which is the least where one of both
bears it at any time.

A thigh is as long as it is: the hip joint is on a circle about the planted knee, so the pelvis
rises and sinks with each stride, and rolls as a knee is lifted. Feet trail behind the knees.
"""

from dataclasses import dataclass
from functools import cached_property
from math import ceil, inf, sqrt
from typing import Annotated, Generic

import numpy as np

from radhar_cli.motion.human.arms import UPWARDS, arm_directions_to_hands
from radhar_cli.motion.human.idle import IdleState, motionless
from radhar_cli.motion.human.minimum_jerk import Course, minimum_jerk, minimum_jerk_integral
from radhar_cli.motion.human.part import ON_FOURS, Phase, Place
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import Planted
from radhar_cli.motion.human.pose import SIDES, Axes, Pose, axes, shoulder_points
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.kneeling import CRAWLING
from radhar_cli.motion.movements.words import ON_FLOOR
from radhar_cli.numerics.arrays import Float
from radhar_cli.schema.annotations import UNSTEADY, People
from radhar_cli.schema.number import NOT_NEGATIVE, RATIO, SPEED, normal, uniform
from radhar_cli.schema.section import B, ByActivity, Section, default_draw


class CrawlingConfig(Section, Generic[B]):
    """Crawling on hands and knees."""

    speed_mps: Annotated[B, ByActivity(NOT_NEGATIVE, SPEED), People("crawling", 0.2, 1.0)] = (
        default_draw(normal(0.5, 0.12, 0.28, 0.9))
    )
    """Speed of crawling."""
    stride: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("crawling", 0.8, 1.2)] = (
        default_draw(normal(1.0, 0.07, 0.85, 1.15))
    )
    """Length of a crawling stride, relative to the usual one of the speed and stature."""
    variation: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("crawling", 0, 0.05), UNSTEADY
    ] = default_draw(uniform(0.0, 0.04))
    """Standard deviation of where hands and knees are put down, relative to the stride."""


SECTION = CrawlingConfig


# Length of a stride at 0.5 m/s of who is 1.75 m tall, and the longest that thighs allow, over the
# stature.
STRIDE, LONGEST = 0.36, 0.5
# Share of a stride in which a knee is dragged ahead, so that one of both bears the body, and in
# which a hand swings: at rest, and more per m/s.
KNEE_SWING, HAND_SWING = 0.5, (0.40, 0.08)
RAMPS = 0.2, 0.3  # share of a swing of knee and hand in which it gets its speed, and loses it
# By how much of a stride a hand is ahead of the knee across: at rest, and less per m/s.
LEAD, LEAD_LOSS = 0.14, 0.10
LIFTS = 0.018, 0.032  # of a swinging knee and hand, over the stature
STRAIGHT = 0.97  # distance of a shoulder from its planted hand, over upper arm and forearm
SHORTEST = 0.25  # square of the least height of a shoulder over its hand, over that of an arm
TRUNK_YAW = 0.10  # share of the turn that hands ask for that the trunk makes
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
        """Time at which the body begins to slow down, s."""
        last = max(self.horizon, self.begin) + 2 * self.period
        return min(self.begin + self.crawl.duration, last)

    @property
    def place(self) -> Place:
        return Place(float(self._way(np.array([self._stops + 9 * self.period]))[0]))

    @property
    def end(self) -> float:
        if self.crawl.duration == inf:
            return inf
        return max(swings.end for swings in self.swings.values())

    @property
    def phases(self) -> tuple[Phase, ...]:
        end = self.end
        rest = () if end == inf else (Phase(end, "kneeling"),)
        return (Phase(self.begin, "crawling"), *rest)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        ramps = [start + k * self.period for start in (self.begin, self._stops) for k in (0, 1)]
        swings = (t for swings in self.swings.values() for t in swings.breakpoints)
        return (*swings, *ramps)

    def _way(self, t: Float) -> Float:
        """Distance that the body has come at times t [M] (s), m."""
        up, down = ((t - start) / self.period for start in (self.begin, self._stops))
        strides = minimum_jerk_integral(up) - minimum_jerk_integral(down)
        return self.crawl.speed * self.period * strides

    def _under_way(self, t: Float) -> Float:
        """Share of crawling, not rest on hands and knees, at times t [M] (s), 0 to 1."""
        begin, stops = ((t - start) / self.period for start in (self.begin, self._stops))
        share: Float = minimum_jerk(begin) - minimum_jerk(stops)
        return share

    @cached_property
    def rest(self) -> Pose:
        """Pose at rest, of a body that holds its breath [1]."""
        course, t = Course.of(CRAWLING.posture(self.person), ()), np.zeros(1)
        return Planted(self.person, course, 0.0, 0.0, ()).pose(t, motionless(self.person)(t))

    @cached_property
    def swings(self) -> dict[str, "Swings"]:
        """Swings of each limb: how far it is ahead of where it is at rest, and how high, m."""
        speed, period, body = self.crawl.speed, self.period, self.person
        lead = max(LEAD - LEAD_LOSS * speed, 0.0)
        phases = dict(zip((*KNEES, *HANDS), (0.0, 0.5, 0.5 - lead, 1 - lead), strict=True))
        count = ceil((self._stops - self.begin) / period) + 3
        misses = iter(np.resize(self.crawl.misses or (0.0,), 4 * count).tolist())
        swings = {}
        for limb, phase in phases.items():
            share = HAND_SWING[0] + HAND_SWING[1] * speed if limb in HANDS else KNEE_SWING
            starts = self.begin + (np.arange(count) + phase) * period
            targets = self._way(starts + (1 + share) / 2 * period)
            rows, place = [], 0.0
            for start, target in zip(starts.tolist(), targets.tolist(), strict=True):
                goes_on = target < self.place.ahead - 1e-9
                target += next(misses) * speed * period * goes_on
                if abs(target - place) < 1e-6:
                    continue
                height = min(1.0, 2 * abs(target - place) / (speed * period))
                rows.append((start, place, target - place, LIFTS[limb in HANDS] * height))
                place = target
            rows = rows or [(self.begin, 0.0, 0.0, 0.0)]
            scale = np.array([[1.0], [1.0], [1.0], [body.stature]])
            starts, places, changes, lifts = np.array(rows).T * scale
            swings[limb] = Swings(
                starts, places, changes, lifts, share * period, RAMPS[limb in HANDS]
            )
        return swings

    def pose(self, t: Float, idle: IdleState) -> Pose:
        body, rest = self.person, self.rest
        zero, distance = np.zeros((2, t.size)), self._way(t)
        swings = np.stack([self.swings[limb](t) for limb in (*KNEES, *HANDS)], axis=1)
        knees = rest.knees + np.array([swings[0, :2], zero, swings[1, :2]])
        hip, joints = self._pelvis(knees, rest.hip[0] + distance)
        down = joints - knees
        level = np.sqrt(body.leg**2 - down[0] ** 2 - down[1] ** 2)
        knees = np.array([knees[0], knees[1], joints[2] - level])
        drop = knees[2] - body.ankle
        trailing = np.sqrt(body.leg**2 - drop**2)
        ankles = np.array([knees[0] - trailing, knees[1], zero + body.ankle])
        hands = self._resting_hands + np.array([swings[0, 2:], zero, 0 * zero])
        yaw = -TRUNK_YAW * (hands[0, 1] - hands[0, 0]) / (2 * body.shoulder)
        trunk = self._trunk(hip, hands, yaw, self._under_way(t))
        hands[2] += swings[1, 2:]
        shoulders = shoulder_points(body, hip, trunk)
        frame = np.array([trunk.ahead, trunk.left, trunk.up])
        reached = np.einsum("axm,xim->aim", frame, hands - shoulders)
        poles = np.broadcast_to(UPWARDS[:, :, None], reached.shape)
        upper, fore = arm_directions_to_hands(trunk, reached, poles, body.arm)
        return Pose(hip, trunk, joints, knees, ankles, upper, fore, idle.breath)

    def _pelvis(self, knees: Float, ahead: Float) -> tuple[Float, Float]:
        """Hip point [3, M] and hip joints [3, 2, M] (m) over knees."""
        body = self.person
        off = ahead - knees[0]
        heights = knees[2] + np.sqrt(body.leg**2 - off * off)
        rise = (heights[0] - heights[1]) / (2 * body.hip)
        roll = np.arcsin(rise / (1 + rise**8) ** 0.125)
        hip = np.array([ahead, 0 * ahead, heights.mean(axis=0)])
        left = np.array([0 * ahead, np.cos(roll), -np.sin(roll)])
        return hip, hip[:, None] + body.hip * SIDES * left[:, None]

    @cached_property
    def _resting_hands(self) -> Float:
        """Hands at rest [3, 2, 1], m."""
        p = np.empty((3, 13, 1))
        self.rest.joints(self.person, p)
        hands: Float = p[:, 4:8:3].copy()
        return hands

    def _trunk(self, hip: Float, hands: Float, yaw: Float, under_way: Float) -> Axes:
        """Axes of the trunk of which both shoulders are an arm's length from hands on the floor.

        Arms are as long as at rest, then nearly straight. Where the shoulders are ahead is taken
        from the axes at rest, then from those that follow, which leaves less than a millimetre.
        """
        body = self.person
        length = body.trunk + body.shoulder
        resting = shoulder_points(body, self.rest.hip, self.rest.trunk)
        arm = ((resting - self._resting_hands) ** 2).sum(axis=0)
        arm = arm + under_way * ((STRAIGHT * 2 * body.arm) ** 2 - arm)
        trunk = self.rest.trunk
        for _ in range(2):
            across = (hands - shoulder_points(body, hip, trunk))[:2]
            apart = across[0] ** 2 + across[1] ** 2
            heights = hands[2] + np.sqrt(np.maximum(arm - apart, SHORTEST * arm))
            roll = np.arcsin((heights[0] - heights[1]) / (2 * body.shoulder * np.cos(yaw)))
            lean, aside = np.cos(roll), np.sin(yaw) * np.sin(roll)
            rise = (heights.mean(axis=0) - hip[2]) / length
            pitch = np.arccos(rise / np.hypot(lean, aside)) - np.arctan2(aside, lean)
            trunk = axes(pitch, yaw, roll)
        return trunk


@dataclass(frozen=True)
class Swings:
    """Swings of one limb: nearly even ahead, up and down by minimum jerk."""

    # starts: s; places before each, changes and lifts: m; all [K], in their order
    starts: Float
    places: Float
    changes: Float
    lifts: Float
    length: float  # duration of each, s
    ramp: float  # share of it in which the limb gets its speed, and likewise loses it

    @property
    def end(self) -> float:
        return float(self.starts[-1]) + self.length

    @property
    def breakpoints(self) -> tuple[float, ...]:
        shares = 0.0, self.ramp, 0.5, 1 - self.ramp, 1.0
        return tuple(t for share in shares for t in (self.starts + share * self.length).tolist())

    def __call__(self, t: Float) -> Float:
        """Places and heights [2, M] (m) at times t [M] (s)."""
        swing = (np.searchsorted(self.starts, t, side="right") - 1).clip(0)
        x = ((t - self.starts[swing]) / self.length).clip(0.0, 1.0)
        up, down = minimum_jerk_integral(x / self.ramp), (x - 1) / self.ramp + 1
        share = self.ramp / (1 - self.ramp) * (up - minimum_jerk_integral(down))
        height = minimum_jerk(2 * x) - minimum_jerk(2 * x - 1)
        return np.array(
            [self.places[swing] + self.changes[swing] * share, self.lifts[swing] * height]
        )


MISSES = 397  # how many footholds of a person who crawls are drawn, before they come again


def make_crawl(mover: Mover) -> Crawl:
    """Make a person crawl."""
    crawling = mover.numbers(CrawlingConfig[float])
    misses = mover.stream(f"motion.crawling.variation/{mover.place}").standard_normal(MISSES)
    misses = crawling.variation * np.clip(misses, -1.6, 1.6)
    return Crawl(
        crawling.speed_mps,
        mover.duration,
        crawling.stride,
        tuple(misses.tolist()) if crawling.variation else (),
    )


MOVEMENTS = (
    MovementKind(
        "crawling",
        "crawls on hands and knees",
        make_crawl,
        "on_fours",
        "on_fours",
        words="crawl creeping kriechen",
        manners=f"{ON_FLOOR} on_hands_and_knees on_all_fours army baby",
    ),
)
