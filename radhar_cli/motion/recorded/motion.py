"""A clip that somebody moves by: stature, place, heading, speed, section, mirror image."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import atan2, ceil, cos, floor, hypot, sin
from typing import TYPE_CHECKING

import numpy as np

from radhar_cli.motion import skeleton
from radhar_cli.motion.human.minimum_jerk import minimum_jerk, minimum_jerk_integral
from radhar_cli.motion.recorded.clip import Clip
from radhar_cli.motion.recorded.cycle import Cycle, carry, carry_between, repeated_carry
from radhar_cli.motion.skeleton import JOINTS, PARENTS, TORSO
from radhar_cli.numerics.arrays import Float

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
    """A `Motion` of a person who moves as in a clip."""

    clip: Clip
    stature: float  # m
    weight: float  # kg
    start: tuple[float, float]  # x and y of the floor point between the ankles at 0 s, m
    # direction in which the person goes, or faces at 0 s if they travel less than 0.5 m, rad from
    # the x axis
    heading: float
    seconds: float  # duration of the recording
    begin: float = 0.0  # second of the clip at 0 s
    end: float | None = None  # second of the clip beyond which nothing of it is used
    speed: float = 1.0  # seconds of the clip a second
    mirrored: bool = False  # left and right are exchanged
    # seconds that are repeated where the file is too short; None: people come to rest at its end
    cycle: Cycle | None = None

    names = JOINTS
    parents = PARENTS
    phases: tuple[tuple[float, str], ...] = ()
    landmarks = (*JOINTS, "right_hip", "left_hip")

    @property
    def highest_frequency(self) -> float:
        """Half of the 8 Hz that the low-pass filter leaves, at the speed of the playback, Hz."""
        return 4.0 * max(1.0, self.speed)

    @cached_property
    def _last_second(self) -> float:
        """Second of the clip at which its use ends."""
        seconds = self.clip.seconds
        return seconds if self.end is None else min(self.end, seconds)

    @property
    def end_used(self) -> float:
        """Second of the clip beyond which the recording uses nothing of it."""
        if self.cycle is not None:
            return self.cycle.end
        return min(self.begin + self.speed * self.seconds, self._last_second)

    @property
    def _ends_in_recording(self) -> bool:
        """Whether the clip ends before the recording does."""
        return self.begin + self.speed * self.seconds > self._last_second

    @cached_property
    def breakpoints(self) -> tuple[float, ...]:
        """Instants (s) at which the clip begins, or slows down at its end: derivatives jump."""
        ends = [-self.begin / self.speed]
        if self.cycle is None and not self._ends_in_recording:
            ends.append((self._last_second - self.begin) / self.speed)
        elif self.cycle is None:
            ends += [
                (self._last_second - self.begin + offset) / self.speed
                for offset in (-self._ease, self._ease)
            ]
        return tuple(end for end in ends if -1 < end < self.seconds + 1)

    @property
    def stops(self) -> bool:
        """Whether the clip ends within the recording while a joint still moves."""
        if self.cycle is not None or not self._ends_in_recording:
            return False
        velocity = self._spline(self._last_second, nu=1).reshape(-1, 3)[: len(JOINTS)]
        return bool(np.linalg.norm(velocity, axis=1).max() * self.speed > NOTICED)

    @property
    def slides(self) -> bool:
        """Whether the clip is repeated though its end is unlike its beginning."""
        return self.cycle is not None and self.cycle.gap * self.stature > SEAM

    @property
    def _ease(self) -> float:
        """Half of the time over which playback slows down, s."""
        return min(SLOWING, self._last_second - self.begin) * max(1.0, self.speed) / 2

    def positions(self, t: Float) -> Float:
        """Positions [3, 13, M] (m) of the joints at times t [M] (s)."""
        return self._positions_at(t, slice(0, len(JOINTS)))

    def torso(self, t: Float) -> Float:
        """Positions [3, 1, M] (m) of the torso alone at times t [M] (s)."""
        return self._positions_at(t, slice(TORSO, TORSO + 1))

    def hip_joints(self, t: Float) -> Float:
        """Positions [3, 2, M] (m) of the right and left hip joint; the hip where it has none."""
        return self._positions_at(t, slice(len(JOINTS), len(JOINTS) + 2))

    def cross_sections(self, t: Float) -> Float:
        """RCS of the joints [13, 1] (m^2): the same from everywhere, at all times."""
        return skeleton.cross_sections(self.stature, self.weight)[:, None]

    def landmark_positions(self, t: Float) -> Float:
        """Positions [3, 15, M] (m) of the joints and hip joints at times t [M] (s)."""
        return self._positions_at(t, slice(0, len(self.landmarks)))

    def _positions_at(self, t: Float, joints: slice) -> Float:
        """Positions [3, joints, M] (m) at times t [M] (s) of the recording."""
        u = self.begin + self.speed * t
        if self.cycle is not None:
            return self._cycle_positions(u, self.cycle, joints).transpose(2, 1, 0)
        if self._ends_in_recording:
            # Playback slows down from 1 to 0 by a minimum-jerk step and stops at the end.
            width = 2 * self._ease
            u = u - width * minimum_jerk_integral((u - self._last_second + self._ease) / width)
        return self._clip_positions(u, joints).transpose(2, 1, 0)

    def _clip_positions(self, u: Float, joints: slice) -> Float:
        """Positions [M, joints, 3] at seconds u [M] of the clip.

        What engines ask for within MARGIN of a recording, beyond the ends of its clip, lies on
        tangents.
        """
        spline = self._splines(joints)
        low, high = float(spline.t[0]), min(self._last_second, float(spline.t[-1]))
        inside = np.clip(u, low, high)
        p: Float = spline(inside)
        beyond = u - inside
        for end, is_beyond in ((low, beyond < 0), (high, beyond > 0)):
            if is_beyond.any():
                p[is_beyond] += beyond[is_beyond, None] * spline(end, nu=1)
        return p.reshape(u.size, -1, 3)

    def _cycle_positions(self, u: Float, cycle: Cycle, joints: slice) -> Float:
        """Positions [M, joints, 3] at seconds u [M] of a clip whose cycle goes on and on."""
        number = np.maximum(np.floor((u - cycle.begin) / cycle.period), 0).astype(int)
        second = u - number * cycle.period
        p = self._clip_positions(second, joints)
        for cycle_number in range(1, int(number.max(initial=0)) + 1):
            is_in_cycle = number == cycle_number
            if not is_in_cycle.any():
                continue
            turn, shift = self._carry
            p[is_in_cycle] = carry(p[is_in_cycle], *repeated_carry(turn, shift, cycle_number))
            is_in_seam = is_in_cycle & (second < cycle.begin + cycle.blend)
            if is_in_seam.any():
                previous = self._clip_positions(second[is_in_seam] + cycle.period, joints)
                previous = carry(previous, *repeated_carry(turn, shift, cycle_number - 1))
                share = minimum_jerk((second[is_in_seam] - cycle.begin) / cycle.blend)[
                    :, None, None
                ]
                p[is_in_seam] = (1 - share) * previous + share * p[is_in_seam]
        return p

    @cached_property
    def _carry(self) -> tuple[float, Float]:
        """Turn (rad) and shift [2] (m) in the room from each cycle to the next."""
        assert self.cycle is not None
        seam = self.cycle.begin + np.linspace(0, self.cycle.blend, SEAM_POINTS)
        every = slice(0, len(self.landmarks))
        late = self._clip_positions(seam + self.cycle.period, every)
        return carry_between(self._clip_positions(seam, every), late)

    @cached_property
    def _splines(self) -> "Callable[[slice], BSpline]":
        """Function that makes the spline of some joints, once for each slice of them."""
        from scipy.interpolate import BSpline

        spline_of_all, splines = self._spline, dict[tuple[int, int], BSpline]()

        def spline_of(joints: slice) -> BSpline:
            key = (joints.start, joints.stop)
            if key not in splines:
                columns = spline_of_all.c[:, 3 * joints.start : 3 * joints.stop]
                splines[key] = BSpline(
                    spline_of_all.t, np.ascontiguousarray(columns), spline_of_all.k
                )
            return splines[key]

        return spline_of

    @cached_property
    def _spline(self) -> "BSpline":
        """Quintic spline of all joints [3 * 15] in the room, over seconds of the clip."""
        from scipy.interpolate import make_interp_spline

        clip, cycle = self.clip, self.cycle
        begin, end = self.begin, min(self.begin + self.speed * self.seconds, self._last_second)
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
        p = self._place_in_room(clip.positions[frames], *ends)
        t = np.arange(frames.start, frames.start + len(p)) / clip.rate
        return make_interp_spline(t, p.reshape(len(p), -1), k=DEGREE)

    def _one_cycle_later(self, pose: Float, cycle: Cycle) -> Float:
        """Carry a pose [15, 3] of the clip to where it is a cycle later, over the stature."""
        clip = self.clip
        begin, blend, period = (
            round(s * clip.rate) for s in (cycle.begin, cycle.blend, cycle.period)
        )
        seam = slice(begin, begin + blend + 1), slice(begin + period, begin + period + blend + 1)
        return carry(pose, *carry_between(*(clip.positions[frames] for frames in seam)))

    def _place_in_room(self, p: Float, first: Float, last: Float) -> Float:
        """Positions [frames, 15, 3] of the clip where the person is in the room, m."""
        p, first, last = (self.stature * positions for positions in (p, first, last))
        ahead = (last - first)[JOINTS.index("hip"), :2]
        if hypot(*ahead) <= TRAVEL:
            left = (first[_LEFT] - first[_RIGHT])[:, :2].sum(axis=0)
            ahead = np.array([left[1], -left[0]])
        angle = -atan2(ahead[1], ahead[0])
        p = p - np.append(first[_ANKLES, :2].mean(axis=0), 0.0)
        p = p @ _about_z(angle).T
        if self.mirrored:
            p = p[:, _SWAPPED] * np.array([1.0, -1.0, 1.0])
        placed: Float = p @ _about_z(self.heading).T + np.array([*self.start, 0.0])
        return placed


def _about_z(angle: float) -> Float:
    c, s = cos(angle), sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
