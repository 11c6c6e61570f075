"""A clip that somebody moves by: stature, place, heading, speed, section, mirror image."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import atan2, ceil, cos, floor, hypot, sin
from typing import TYPE_CHECKING

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.motion import skeleton
from radhar_cli.motion.files.clip import Clip
from radhar_cli.motion.files.cycle import Cycle, carried, carried_often, carry_between
from radhar_cli.motion.human.minimum_jerk import minimum_jerk, minimum_jerk_integral
from radhar_cli.motion.skeleton import JOINTS, PARENTS, TORSO

if TYPE_CHECKING:
    from scipy.interpolate import BSpline

DEGREE = 5
MARGIN = 0.25  # s beyond the recording, which echo engines may ask for
MORE = 8  # frames
TRAVEL = 0.5  # m; who goes less far is turned by where they face
SEAM_POINTS = 33  # instants of a seam by which the next cycle is placed
SLOWING = 0.5  # s, in which a motion that ends comes to rest
NOTICED = 0.3  # m/s; who is slower at the end of a file has come to rest there
SEAM = 0.3  # m; a joint that is farther from where it goes on in the next cycle is warned of
_OTHER = {"right": "left", "left": "right"}
_SWAPPED = [  # number of each joint on the other side; hip joints last
    *(JOINTS.index("_".join(_OTHER.get(w, w) for w in name.split("_"))) for name in JOINTS),
    len(JOINTS) + 1,
    len(JOINTS),
]
_RIGHT = [JOINTS.index("right_shoulder"), len(JOINTS)]
_LEFT = [JOINTS.index("left_shoulder"), len(JOINTS) + 1]
_ANKLES = [JOINTS.index("right_ankle"), JOINTS.index("left_ankle")]


@dataclass(frozen=True)
class FileMotion:
    """The `Motion` of a clip."""

    clip: Clip  # of a person of 1 m
    stature: float  # m
    weight: float  # kg
    start: tuple[float, float]  # x and y of the floor point between the ankles at 0 s, m
    # to where the person goes, rad from the x axis; who travels less than 0.5 m faces there at 0 s
    heading: float
    seconds: float  # of the recording
    begin: float = 0.0  # second of the clip at 0 s
    end: float | None = None  # second of the clip beyond which nothing of it is used
    speed: float = 1.0  # seconds of the clip a second
    mirrored: bool = False  # left and right are exchanged
    # what is repeated where the file is too short; None: people come to rest at its end, and stay
    cycle: Cycle | None = None

    names = JOINTS
    parents = PARENTS
    phases: tuple[tuple[float, str], ...] = ()
    landmarks = (*JOINTS, "right_hip", "left_hip")

    @property
    def highest_frequency(self) -> float:
        """Half of the 8 Hz that the low-pass leaves, Hz, at the speed of the playback."""
        return 4.0 * max(1.0, self.speed)

    @cached_property
    def _last(self) -> float:
        seconds = self.clip.seconds
        return seconds if self.end is None else min(self.end, seconds)

    @property
    def end_used(self) -> float:
        """Second of the clip beyond which the recording uses nothing of it."""
        if self.cycle is not None:
            return self.cycle.end
        return min(self.begin + self.speed * self.seconds, self._last)

    @property
    def _ends_within(self) -> bool:
        return self.begin + self.speed * self.seconds > self._last

    @cached_property
    def breakpoints(self) -> tuple[float, ...]:
        """When the clip begins, and when it slows down at its end, s: derivatives jump there."""
        ends = [-self.begin / self.speed]
        if self.cycle is None and not self._ends_within:
            ends.append((self._last - self.begin) / self.speed)
        elif self.cycle is None:
            ends += [(self._last - self.begin + d) / self.speed for d in (-self._ease, self._ease)]
        return tuple(end for end in ends if -1 < end < self.seconds + 1)

    @property
    def stops(self) -> bool:
        """Whether the clip ends within the recording while a joint still moves."""
        if self.cycle is not None or not self._ends_within:
            return False
        velocity = self._spline(self._last, nu=1).reshape(-1, 3)[: len(JOINTS)]
        return bool(np.linalg.norm(velocity, axis=1).max() * self.speed > NOTICED)

    @property
    def slides(self) -> bool:
        """Whether the clip is repeated though its end is unlike its beginning."""
        return self.cycle is not None and self.cycle.gap * self.stature > SEAM

    @property
    def _ease(self) -> float:
        """Half of the seconds over which playback slows down."""
        return min(SLOWING, self._last - self.begin) * max(1.0, self.speed) / 2

    def positions(self, t: Float) -> Float:
        """Positions [3, 13, M] (m) of the joints at times t [M] (s)."""
        return self._at(t, slice(0, len(JOINTS)))

    def torso(self, t: Float) -> Float:
        """Positions [3, 1, M] (m) of the torso alone."""
        return self._at(t, slice(TORSO, TORSO + 1))

    def hip_joints(self, t: Float) -> Float:
        """Right and left hip joint [3, 2, M] (m); the hip where the file has none."""
        return self._at(t, slice(len(JOINTS), len(JOINTS) + 2))

    def cross_sections(self, t: Float) -> Float:
        """RCS [13, 1], m^2: the same from everywhere, at all times."""
        return skeleton.cross_sections(self.stature, self.weight)[:, None]

    def landmark_positions(self, t: Float) -> Float:
        """Positions [3, 15, M] (m) of joints and hip joints, between which limbs lie."""
        return self._at(t, slice(0, len(self.landmarks)))

    def _at(self, t: Float, joints: slice) -> Float:
        u = self.begin + self.speed * t
        if self.cycle is not None:
            return self._repeated(u, self.cycle, joints).transpose(2, 1, 0)
        if self._ends_within:
            # Playback slows down from 1 to 0 by a minimum-jerk step and stops at the end.
            width = 2 * self._ease
            u = u - width * minimum_jerk_integral((u - self._last + self._ease) / width)
        return self._played(u, joints).transpose(2, 1, 0)

    def _played(self, u: Float, joints: slice) -> Float:
        """Positions [M, joints, 3] at seconds u [M] of the clip.

        What engines ask for within MARGIN of a recording, beyond the ends of its clip, lies on
        tangents.
        """
        spline = self._splines(joints)
        low, high = float(spline.t[0]), min(self._last, float(spline.t[-1]))
        inside = np.clip(u, low, high)
        p: Float = spline(inside)
        beyond = u - inside
        for at, where in ((low, beyond < 0), (high, beyond > 0)):
            if where.any():
                p[where] += beyond[where, None] * spline(at, nu=1)
        return p.reshape(u.size, -1, 3)

    def _repeated(self, u: Float, cycle: Cycle, joints: slice) -> Float:
        """Positions [M, joints, 3] at seconds u [M] of a clip whose cycle goes on and on."""
        number = np.maximum(np.floor((u - cycle.begin) / cycle.period), 0).astype(int)
        inside = u - number * cycle.period
        p = self._played(inside, joints)
        for times in range(1, int(number.max(initial=0)) + 1):
            now = number == times
            if not now.any():
                continue
            turn, shift = self._carry
            p[now] = carried(p[now], *carried_often(turn, shift, times))
            seam = now & (inside < cycle.begin + cycle.blend)
            if seam.any():
                before = self._played(inside[seam] + cycle.period, joints)
                before = carried(before, *carried_often(turn, shift, times - 1))
                share = minimum_jerk((inside[seam] - cycle.begin) / cycle.blend)[:, None, None]
                p[seam] = (1 - share) * before + share * p[seam]
        return p

    @cached_property
    def _carry(self) -> tuple[float, Float]:
        """Turn (rad) and shift [2] (m) in the room from each cycle to the next."""
        assert self.cycle is not None
        seam = self.cycle.begin + np.linspace(0, self.cycle.blend, SEAM_POINTS)
        every = slice(0, len(self.landmarks))
        late = self._played(seam + self.cycle.period, every)
        return carry_between(self._played(seam, every), late)

    @cached_property
    def _splines(self) -> "Callable[[slice], BSpline]":
        from scipy.interpolate import BSpline

        whole, made = self._spline, dict[tuple[int, int], BSpline]()

        def some(joints: slice) -> BSpline:
            key = (joints.start, joints.stop)
            if key not in made:
                columns = whole.c[:, 3 * joints.start : 3 * joints.stop]
                made[key] = BSpline(whole.t, np.ascontiguousarray(columns), whole.k)
            return made[key]

        return some

    @cached_property
    def _spline(self) -> "BSpline":
        """Quintic spline of all joints [3 * 15] in the room, over seconds of the clip."""
        from scipy.interpolate import make_interp_spline

        clip, cycle = self.clip, self.cycle
        begin, end = self.begin, min(self.begin + self.speed * self.seconds, self._last)
        margin = MORE + ceil(MARGIN * self.speed * clip.rate)
        count = len(clip.positions)
        first, last = (
            min(floor(begin * clip.rate), count - 1),
            min(ceil(end * clip.rate), count - 1),
        )
        ends = clip.positions[first], clip.positions[last]
        if cycle is not None:
            begin, end = min(cycle.begin, begin), cycle.end
            ends = ends[0], self._one_cycle_later(ends[0], cycle)
        low, high = floor(begin * clip.rate) - margin, ceil(end * clip.rate) + margin
        frames = slice(max(0, min(low, count)), high + 1)
        p = self._placed(clip.positions[frames], *ends)
        t = np.arange(frames.start, frames.start + len(p)) / clip.rate
        return make_interp_spline(t, p.reshape(len(p), -1), k=DEGREE)

    def _one_cycle_later(self, pose: Float, cycle: Cycle) -> Float:
        """Where a pose [15, 3] of the clip is a cycle later, over the stature."""
        clip = self.clip
        begin, blend, period = (
            round(s * clip.rate) for s in (cycle.begin, cycle.blend, cycle.period)
        )
        seam = slice(begin, begin + blend + 1), slice(begin + period, begin + period + blend + 1)
        return carried(pose, *carry_between(*(clip.positions[frames] for frames in seam)))

    def _placed(self, p: Float, first: Float, last: Float) -> Float:
        """Positions [frames, 15, 3] of the clip where the person is in the room, m."""
        p, first, last = (self.stature * one for one in (p, first, last))
        ahead = (last - first)[JOINTS.index("hip"), :2]
        if hypot(*ahead) <= TRAVEL:
            left = (first[_LEFT] - first[_RIGHT])[:, :2].sum(axis=0)
            ahead = np.array([left[1], -left[0]])
        turned = -atan2(ahead[1], ahead[0])
        p = p - np.append(first[_ANKLES, :2].mean(axis=0), 0.0)
        p = p @ _about_z(turned).T
        if self.mirrored:
            p = p[:, _SWAPPED] * np.array([1.0, -1.0, 1.0])
        placed: Float = p @ _about_z(self.heading).T + np.array([*self.start, 0.0])
        return placed


def _about_z(angle: float) -> Float:
    c, s = cos(angle), sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
