"""S8: walking on planted feet, with or without a start from rest and a stop.

Feet stand where the body will be above them, the pelvis surges over them at a height that its legs
can reach, trunk and arms follow Boulic and Thalmann's curves.
"""

from dataclasses import dataclass, field
from functools import cached_property
from math import inf, isinf, pi, radians

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.motion.human import boulic_thalmann as curves
from radhar_cli.motion.human.footsteps import Footfalls, FootTrack
from radhar_cli.motion.human.idle import IdleState, Waves
from radhar_cli.motion.human.lane import Lane, along
from radhar_cli.motion.human.minimum_jerk import Course, Step, minimum_jerk, minimum_jerk_integral
from radhar_cli.motion.human.part import STANDING, Phase, Place
from radhar_cli.motion.human.pelvis import hip_height, hip_joints, swayed_hip
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import (
    ELBOWS,
    SHOULDERS,
    Planted,
    arms_down,
    at_rest,
    legs,
    timed,
)
from radhar_cli.motion.human.pose import Pose, axes, turned
from radhar_cli.motion.human.two_link import AHEAD, two_link

START_PHASE = 0.5  # of the stride: the right foot goes first
EARLIEST_SWING = 0.3
# The hip is fastest here, in double support, for a short time, and slow for longer (CMU motion
# capture, subject 02: 0.88 to 1.14 times the walking speed at 1.2 m/s).
SURGE_PHASE, SHARPNESS = 0.04, 0.08
# Of a trip, in strides: the trunk pitches and comes back over quick steps. Old people who fell
# bent more, and later loaded the other leg (Pavol et al., J. Gerontol. 56A (2001) M428): the sizes
# are guesses.
TRIP = Step("phase", 0.3, 0.0, 1.2), Step("upset", 1.0, 0.05, 0.4), Step("upset", -1.0, 0.5, 0.7)


@dataclass(frozen=True)
class Gait:
    """How somebody walks. Phases are fractions of a stride from right heel strike on."""

    speed: float  # m/s
    period_scale: float = 1.0  # of the stride's duration after Boulic and Thalmann
    phase: float = 0.0  # of a steady walk at t = 0
    arm_swing: float = 1.0  # of the arms' amplitude
    trunk_pitch: float = radians(3)  # rad ahead
    half_width: float = 0.0315  # of the stance, fraction of the stature
    surge: float = 0.125  # speed of the hip's surge, twice a stride, over the speed
    sidewards: float = 0.018  # of the hip from side to side, m
    sink: float = 0.003  # of the standing height while walking, fraction of the stature
    softness: float = 80.0  # of the pelvis's height (`Physique.softness`) while walking, 1/m
    # touch_down, heel_off: phases between which the foot lies flat
    touch_down: float = 0.085
    heel_off: float = 0.42
    below: float = 0.25  # phase at which the body is above the foothold
    roll: float = radians(52)  # of the foot about its ball until toe-off, rad
    lift: float = 0.10  # of the swinging foot, m
    # of the foot in mid-swing behind a smooth course, over the length of the step
    lag: float = 0.21
    ramp: float = 0.6  # in which a walk gains and loses its speed, fraction of a stride
    start: float | None = None  # in which it gains it from rest, likewise; as ramp if None
    ragged: Waves = field(default_factory=Waves)  # relative deviation of the speed over time
    # by how much the phase is ahead after each stride, fractions of a stride
    jitter: tuple[float, ...] = ()
    widths: tuple[float, ...] = ()  # further half width of each stride, m
    lane: Lane | None = None  # where the walker turns round; None for never
    # by how much trunk and arms go ahead where the walker trips half way and catches the fall, rad
    trip: float = 0.0

    def __post_init__(self) -> None:
        if not self.speed > 0:
            raise ValueError(f"who walks has a speed above 0 m/s, not {self.speed:g} m/s")


@dataclass(frozen=True)
class Walk:
    """Walking for `duration` s (to the beginning of the last steps), from rest or steadily."""

    gait: Gait
    duration: float = inf
    from_rest: bool = True

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> "Walking":
        """The movement from `begin` (s) on, with steps until `horizon` (s)."""
        return Walking(person, self.gait, begin, begin + self.duration, self.from_rest, horizon)


@dataclass(frozen=True)
class Walking:
    """A walk; see `part.Part`."""

    person: Physique
    gait: Gait
    begin: float  # from rest on, or from where x and the stride are counted, s
    stop: float  # when the speed begins to fall, s; infinity for never
    from_rest: bool  # whether the walk begins from rest
    horizon: float  # until when there are steps, s
    # movements on planted feet that have not ended when the walk begins, or begin before it ends
    planted: tuple[Planted, ...] = ()

    before = STANDING
    after = STANDING

    @cached_property
    def relative_speed(self) -> float:
        """Rv = v/h, 1/s."""
        return self.gait.speed / self.person.tallest

    @cached_property
    def stride(self) -> float:
        """Duration of a stride, s."""
        return curves.cycle_duration(self.relative_speed) * self.gait.period_scale

    @cached_property
    def ramp(self) -> float:
        """Duration of gaining speed, and of losing it, s."""
        return self.gait.ramp * self.stride

    @cached_property
    def start(self) -> float:
        """Duration of gaining speed from rest, s."""
        start = self.gait.start
        return self.ramp if start is None else start * self.stride

    @property
    def stops(self) -> bool:
        """Whether the walk ends."""
        return not isinf(self.stop)

    def drive(self, t: Float) -> Float:
        """g [M]: 0 at rest, 1 when walking."""
        g: Float = np.ones(t.size)
        if self.from_rest:
            g = minimum_jerk((t - self.begin) / self.start)
        if self.stops:
            g *= 1 - minimum_jerk((t - self.stop) / self.ramp)
        return g

    @cached_property
    def _ahead_at_first(self) -> Float | float:
        return 0.0 if self.from_rest else self.gait.ragged.integral(np.zeros(1))

    def _unsteady(self, t: Float, g: Float | None = None) -> Float | float:
        """How far a ragged walker is ahead of the mean path [M] (m), g from `drive`."""
        if not self.gait.ragged.amplitudes:
            return 0.0
        ahead = self.gait.ragged.integral(t) - self._ahead_at_first
        return self.gait.speed * (self.drive(t) if g is None else g) * ahead

    def path(self, t: Float, unsteady: Float | float | None = None) -> Float:
        """X(t) [M], m: where the body is above its feet on average."""
        v, ramp = self.gait.speed, self.ramp
        if self.from_rest:
            x = v * self.start * minimum_jerk_integral((t - self.begin) / self.start)
        else:
            x = v * (t - self.begin)
        if self.stops:
            x -= v * ramp * minimum_jerk_integral((t - self.stop) / ramp)
        x += self._unsteady(t) if unsteady is None else unsteady
        if self._slower.size:
            x -= self._lost(t)
        return x

    def _where(self, s: Float) -> tuple[Float, Float, Float | None]:
        """x and y (m), and the heading (rad) unless it is 0, of a walker who has gone s [M] (m)."""
        if not self._turns.size:
            return s, np.zeros_like(s), None
        assert self.gait.lane is not None
        return along(s, self._turns, self._arc, self.gait.lane.side)

    @cached_property
    def _arc(self) -> float:
        """Length of a half turn, m; of who walks fast a wide one."""
        lane = self.gait.lane
        return 0.0 if lane is None else pi * lane.radius * max(1.0, self.gait.speed / 1.4)

    @cached_property
    def _turns(self) -> Float:
        """Where half turns begin [K], m of the way."""
        lane, v, begins = self.gait.lane, self.gait.speed, [0.0][:0]
        if lane is None:
            return np.array(begins)
        least = v * self.ramp  # to change speed between turns
        at = max(lane.first, v * self.start if self.from_rest else 0.0)
        # Way of who does not slow down: a turn begins in it when the walker is slow.
        lost = lane.slow / (1 - lane.slow) * self._arc
        until, whole = max(self.horizon, self.begin) + self.stride, 0.0
        if self.stops:  # no walk ends in a turn
            until, whole = self.stop - self.ramp, self._arc + lost
        while (at + len(begins) * lost + whole) / v < until - self.begin:
            begins.append(at)
            at += self._arc + max(lane.length, least)
        return np.array(begins)

    @cached_property
    def _slower(self) -> Float:
        """From when to when the walker goes slower in each turn [2, K], s."""
        lane, v = self.gait.lane, self.gait.speed
        if lane is None or not self._turns.size:
            return np.empty((2, 0))
        takes = self._arc / (v * (1 - lane.slow))
        lost = np.arange(self._turns.size) * lane.slow * v * takes
        on = self.begin + (self._turns + lost) / v - self.ramp / 2
        if self.from_rest:
            on += (self.start - self.ramp) / 2
        return np.array([on, on + takes])

    def _lost(self, t: Float) -> Float:
        """Way [M] (m) that a walker has lost in turns."""
        assert self.gait.lane is not None
        on, off = self._slower  # each turn's ramps end before the next turn's begin
        turn = np.maximum(np.searchsorted(on, t, side="right") - 1, 0)
        before = np.concatenate([[0.0], np.cumsum((off - on) / self.ramp)])
        slow, fast = (minimum_jerk_integral((t - ramp[turn]) / self.ramp) for ramp in (on, off))
        way = self.gait.lane.slow * self.gait.speed * self.ramp
        lost: Float = way * (before[turn] + slow - fast)
        return lost

    def _passes(self, s: Float) -> Float:
        """Times [N] (s) at which the walker has gone s [N] (m)."""
        t = self.begin + s / self.gait.speed
        for _ in range(60):
            t = t - (self.path(t) - s) / self.gait.speed
        return t

    def phase(self, t: Float, unsteady: Float | float | None = None) -> Float:
        """u(t) [M]: of the stride; a ragged walker changes stride and cadence alike."""
        u = (START_PHASE if self.from_rest else self.gait.phase) + (t - self.begin) / self.stride
        ahead = self._unsteady(t) if unsteady is None else unsteady
        u += ahead / (2 * self.gait.speed * self.stride)
        if self._slower.size:
            u -= self._lost(t) / (2 * self.gait.speed * self.stride)
        if self._jitter is not None:
            u += self._jitter(t)[0]
        return u

    @property
    def _trips(self) -> float:
        return self.begin + min(self.stop - self.begin, 5.0) / 2

    @cached_property
    def _jitter(self) -> Course | None:
        """Phase gained, by minimum jerk from stride to stride, and how far a trip upsets."""
        if not self.gait.jitter and not self.gait.trip:
            return None
        gains = np.diff(self.gait.jitter, prepend=0.0)
        steps = [
            Step("phase", float(gain), self.begin + k * self.stride, self.stride)
            for k, gain in enumerate(gains)
        ]
        if self.gait.trip:
            steps += timed(TRIP, self._trips, self.stride)
        return Course.of({"phase": 0.0, "upset": 0.0}, steps)

    def _when(self, u: Float) -> Float:
        """Times [N] (s) of phases u [N]."""
        t = self.begin + (u - self.phase(np.full(1, self.begin))) * self.stride
        if self.gait.ragged.amplitudes or self._jitter is not None or self._slower.size:
            for _ in range(60):  # a contraction, by some hundredths; in turns by a quarter
                late = self.phase(t) - u
                t = t - late * self.stride
                if np.abs(late).max(initial=0.0) < 1e-14:
                    break
        return t

    @cached_property
    def end(self) -> float:
        if not self.stops:
            return inf
        last = max(float(track.falls.down[-1]) for track in self._feet)
        return max(last, self.stop + self.ramp)

    @cached_property
    def place(self) -> Place:
        if not self.stops:
            return Place()
        x, y, heading = self._where(np.array([self._way]))
        return Place(float(x[0]), float(y[0]), 0.0 if heading is None else float(heading[0]))

    @cached_property
    def _way(self) -> float:
        """All the way to where the feet come to rest, m."""
        return float(self.path(np.array([self.stop + 2 * self.ramp]))[0])

    @property
    def phases(self) -> tuple[Phase, ...]:
        walking = [Phase(self.begin, "walking")]
        if self.gait.trip:
            walking.append(Phase(self._trips, "stumbling"))
            walking.append(Phase(self._trips + 1.2 * self.stride, "walking"))
        return (*walking, Phase(self.end, "standing")) if self.stops else tuple(walking)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        """Events of both feet, ends of the ramps, and of strides where these differ, s."""
        ends = [track.breakpoints for track in self._feet]
        if self.from_rest:
            ends.append(np.array([self.begin, self.begin + self.start]))
        if self.stops:
            ends.append(np.array([self.stop, self.stop + self.ramp]))
        if self._jitter is not None:
            ends.append(np.array(self._jitter.breakpoints))
        if self._turns.size:
            ends += [self._slower.ravel(), self._slower.ravel() + self.ramp]
            ends += [self._passes(self._turns), self._passes(self._turns + self._arc)]
        return tuple(np.concatenate(ends).tolist())

    @cached_property
    def _feet(self) -> tuple[FootTrack, FootTrack]:
        """Right and left, whose stride is half a stride later."""
        gait, events = self.gait, [self._events(later) for later in (0.0, 0.5)]
        # All instants at once: each look at the phase costs as much for few as for many.
        times = self._when(np.concatenate([u.ravel() for u in events]))
        both = np.split(times, [events[0].size])
        right, left = (
            FootTrack(
                self.person,
                self._footfalls(at.reshape(4, -1), side),
                gait.roll,
                gait.lift,
                gait.lag,
            )
            for at, side in zip(both, (-1.0, 1.0), strict=True)
        )
        return right, left

    def _events(self, later: float) -> Float:
        """Phases [4, N + 1] of heel-off, toe-off, touch-down and of the body above the foothold.

        Of a foot whose stride is `later` than the right one's; the last column ends the last swing.
        """
        gait, margin = self.gait, 2 * self.stride
        first = EARLIEST_SWING if self.from_rest else self._phase_at(self.begin - margin)
        until = self.stop + self.ramp if self.stops else max(self.horizon, self.begin) + margin
        last = self._phase_at(until)
        heel_off = later + gait.heel_off
        k = np.arange(np.ceil(first - heel_off), np.ceil(last - heel_off) + 1)
        off = k + heel_off
        leaves = np.clip(curves.support(self.stride / gait.period_scale), 0.58, 0.66)
        toe = k + later + leaves
        if self.from_rest:
            off = np.maximum(off, START_PHASE)
            toe = np.maximum(toe, off + 0.12)
        return np.array([off, toe, k + later + 1 + gait.touch_down, k + later + gait.below])

    def _footfalls(self, times: Float, side: float) -> Footfalls:
        """Swings of a foot on one side, of which `_events` happen at `times` [4, N + 1] (s)."""
        gait = self.gait
        off, toe, down, above = times
        usual = side * gait.half_width * self.person.stature
        rest = side * self.person.hip
        way = self.path(above)
        sides = np.full(above.size, usual)
        widths = side * np.array(gait.widths[: sides.size])
        sides[: widths.size] += widths
        if self.from_rest:
            way[0], sides[0] = 0.0, rest
        if self.stops:
            way[-1], sides[-1] = self._way, rest
        x, y, heading = self._where(way)
        if heading is None:
            heading = np.zeros_like(way)
        footholds = np.array([x - sides * np.sin(heading), y + sides * np.cos(heading)])
        return Footfalls(
            off=off[:-1],
            toe=toe[:-1],
            down=down[:-1],
            before=footholds[:, :-1],
            after=footholds[:, 1:],
            heading=heading[:-1],
            size=np.minimum(1.0, np.diff(way) / (gait.speed * self.stride)),
        )

    def _phase_at(self, t: float) -> float:
        return float(self.phase(np.array([t]))[0])

    @cached_property
    def _curves(self) -> Float:
        """Rows [9, 17] in the harmonics of the stride: what `pose` names."""
        gait, rv = self.gait, self.relative_speed
        cycle = gait.speed * self.stride / (2 * pi)
        surge = sum(
            curves.harmonic(k, share * cycle / k, SURGE_PHASE + 1 / (4 * k))
            for k, share in (
                (2, gait.surge),
                (4, SHARPNESS * gait.surge),
            )
        )
        arm, bend = curves.shoulder(rv, gait.arm_swing), curves.elbow(rv)
        bend[0] -= self.person.elbow
        return np.array(
            [
                surge,
                curves.harmonic(1, -gait.sidewards, 0.03 + 1 / 4),
                curves.pelvis_yaw(rv),
                curves.pelvis_roll(rv),
                -curves.thorax_yaw(rv),
                arm,
                curves.half_a_stride_later(arm),
                bend,
                curves.half_a_stride_later(bend),
            ]
        )

    def _overlapping(self, t: Float, way: Float) -> dict[str, Float]:
        """Channels [M] of a planted posture: at rest, but for movements that overlap the walk.

        Seen from the walker who has gone `way` [M] (m).
        """
        rest = at_rest(self.person)
        now = {channel: np.full(t.size, value) for channel, value in rest.items()}
        for movement in self.planted:
            for channel, value in zip(movement.course.channels, movement.course(t), strict=True):
                now[channel] += value - rest[channel]
            now["hands_ahead"] += (self._way if movement.begin > self.begin else 0.0) - way
        return now

    def pose(self, t: Float, idle: IdleState) -> Pose:
        """The body at times t [M] (s); worked out as seen by the walker, then put in its place."""
        body, g = self.person, self.drive(t)
        unsteady = self._unsteady(t, g)
        gone = self.path(t, unsteady)
        x, y, heading = self._where(gone)
        rows = self._curves @ curves.basis(self.phase(t, unsteady))
        rows *= g
        (surge, side, yaw, roll, twist), arms = rows[:5], rows[5:].reshape(2, 2, t.size)
        aside = hip_joints(body, yaw, roll)
        ankles = np.stack([track(t) for track in self._feet], axis=1)
        ankles[0] -= x
        ankles[1] -= y
        if heading is not None:
            ankles = turned(ankles, -heading)
        way = np.array([surge, side])
        standing = body.tallest - self.gait.sink * body.stature * g
        softness = body.softness + (self.gait.softness - body.softness) * g
        pitch, lean = self.gait.trunk_pitch * g, np.zeros(t.size)
        arms[1] += body.elbow
        hands: tuple[Float, Float, Float] = (np.zeros(t.size),) * 3
        if self.from_rest or self.stops:
            still = 1 - g
            other = self._overlapping(t, gone)
            own = still * other["standing"]
            _, sway = legs(
                body, other["shank"], other["thigh"], own * idle.lean, own * idle.legs_roll
            )
            sway[2] -= body.rest_height - body.ankle
            hip = swayed_hip(body, standing, way, aside, ankles, softness, sway)
            own = still * other["upright"]
            pitch += other["trunk"] + own * idle.pitch
            twist += own * idle.yaw
            lean = own * idle.roll
            arms += own * np.array([idle.shoulders, idle.elbows])
            arms[0] += np.array([other[channel] for channel in SHOULDERS])
            arms[1] += np.array([other[channel] for channel in ELBOWS]) - body.elbow
            hands = other["hands"], other["hands_ahead"], other["hands_beside"]
        else:
            hip = np.array([*way, hip_height(body, standing, way, aside, ankles, softness)])
        if self.gait.trip and self._jitter is not None:
            upset = self.gait.trip * g * self._jitter(t)[1]
            pitch, arms = pitch + upset, arms + 1.5 * upset
        trunk = axes(pitch, twist, lean)
        upper, fore = arms_down(body, hip, trunk, (arms[0], arms[1]), *hands)
        joints = hip[:, None] + aside
        knees = two_link(joints, ankles, body.leg, body.leg, AHEAD)
        pose = Pose(hip, trunk, joints, knees, ankles, upper, fore, idle.breath)
        return pose.at(x, y, heading)
