"""S8: walking on planted feet, with or without a start from rest and a stop.

Feet stand where the body will be above them, the pelvis surges over them at a height that its legs
can reach, trunk and arms follow Boulic and Thalmann's curves.
"""

from dataclasses import dataclass, field
from functools import cached_property
from math import ceil, inf, isinf, pi, radians
from typing import Annotated, Generic, NamedTuple

import numpy as np

from radhar_cli.motion.human import boulic_thalmann as curves
from radhar_cli.motion.human.aids import (
    Aid,
    HeldLoad,
    elbow_directions,
    hands_of_aid,
    limit_to_reach,
)
from radhar_cli.motion.human.arms import arm_directions_to_hands, hanging_hands
from radhar_cli.motion.human.footsteps import Footfalls, FootTrack
from radhar_cli.motion.human.idle import IdleState, Waves
from radhar_cli.motion.human.lane import Lane, WalkTimes, place_half_turns, position_along_lane
from radhar_cli.motion.human.minimum_jerk import Course, Step, minimum_jerk, minimum_jerk_integral
from radhar_cli.motion.human.part import STANDING, Phase, Place
from radhar_cli.motion.human.pelvis import LegBound, hip_height, hip_joints, hip_point_with_sway
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.planted import (
    ELBOWS,
    SHOULDERS,
    Planted,
    arms_of_posture,
    legs,
    resting_channels,
    scale_steps,
)
from radhar_cli.motion.human.pose import Axes, Pose, axes, shoulder_points, turned
from radhar_cli.motion.human.two_link import AHEAD, two_link
from radhar_cli.motion.movements.idle import IdleConfig, low_pass_waves
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.motion.movements.repeating import PHASE, RepeatingConfig, nonzero_tuple
from radhar_cli.numerics.arrays import Float
from radhar_cli.schema.annotations import (
    ABOVE_ZERO,
    PERSONAL,
    UNSTEADY,
    ByModel,
    NeedsKey,
    Paper,
    People,
    Unless,
)
from radhar_cli.schema.number import (
    ANGLE,
    COORDINATE,
    NOT_NEGATIVE,
    RATIO,
    SECONDS,
    SPEED,
    normal,
    uniform,
)
from radhar_cli.schema.section import B, ByActivity, Section, default_draw

WALKING_SPEED = normal(1.3, 0.18, 0.7, 2.0)


class WalkingConfig(Section, Generic[B]):
    """Walking (motion.model: human); the paper's gait takes the speed alone."""

    speed_mps: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, SPEED, null=True),
        People("walking", 0.3, 2.8),
        Paper("S8 S9 S10 S11 S12"),
        PERSONAL,
        ByModel(human=WALKING_SPEED, paper=1.5),
    ] = default_draw(None)
    """Walking speed. The default is that of people of 1.7 m; of others at the same Froude
    number."""
    period_scale: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("walking", 0.85, 1.05), PERSONAL
    ] = default_draw(normal(0.95, 0.04, 0.85, 1.05))
    """Stride time relative to Boulic and Thalmann's."""
    arm_swing: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("walking", 0, 2), PERSONAL] = (
        default_draw(uniform(0.6, 1.3))
    )
    """Arm swing of a walker, relative to Boulic and Thalmann's."""
    trunk_pitch_deg: Annotated[B, ByActivity(ANGLE), People("walking", -5, 15), PERSONAL] = (
        default_draw(normal(3.0, 2.0, -2.0, 8.0))
    )
    """Forward pitch of a walker's trunk."""
    step_width: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("walking", 0.02, 0.1), PERSONAL
    ] = default_draw(normal(0.063, 0.011, 0.03, 0.1))
    """Distance across between a walker's feet, relative to the stature."""
    speed_variation: Annotated[
        B, ByActivity(NOT_NEGATIVE, RATIO), People("walking", 0, 0.06), UNSTEADY
    ] = default_draw(uniform(0.0, 0.06))
    """Standard deviation of a walker's speed over time, relative to the speed; that of the stride
    times is half as much, that of the step width a third, in metres."""
    lane_m: Annotated[
        B,
        Unless("places_people", "stream, whose zone says where people are"),
        ByActivity(COORDINATE),
        People("walking", 0, 1000),
    ] = default_draw(0.0)
    """Length of the lane after which walkers turn round, again and again; 0 is never."""
    lane_start: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, RATIO),
        People("walking", 0, 1),
        NeedsKey("motion.walking.lane_m", ABOVE_ZERO),
    ] = default_draw(uniform(0.0, 1.0))
    """Share of the first lane that lies behind a walker at 0 s."""
    speed_up: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People("walking", 0.4, 2)] = (
        default_draw(0.6)
    )
    """Strides in which a walker gains speed from rest; more above half of gravity."""


class WalkingTiming(Section, Generic[B]):
    """Beginnings and ends of walks before and after other movements."""

    walk_begin_s: Annotated[
        B | None, ByActivity(NOT_NEGATIVE, SECONDS, null=True), People("S8", 0, 600)
    ] = default_draw(None)
    """Beginning of the walk of S8, after standing; null is by timing.onset, before or after 0 s."""
    walk_start_s: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, SECONDS, null=True),
        People("S9 S11", 0, 600),
        Paper("S9 S11"),
        ByModel(paper=2.0),
    ] = default_draw(None)
    """Beginning of the walk after rising; null of people is the end of rising, less overlap_s."""
    walk_stop_s: Annotated[
        B,
        ByActivity(NOT_NEGATIVE, SECONDS, null=True),
        People("S10 S12", 0.5, 600),
        Paper("S10 S12"),
        ByModel(paper=2.0),
    ] = default_draw(None)
    """Time at which the walk before sitting down or falling begins to end; null of people is by
    timing.onset, the beginning of sitting down or falling."""
    overlap_s: Annotated[B, ByActivity(NOT_NEGATIVE, SECONDS), People("S9 S10 S11 S12", 0, 0.8)] = (
        default_draw(0.0)
    )
    """Time by which the second movement starts before the first ends, unless walk_start_s says
    when. A scene gets at most 0.3 of the duration of rising, sitting down or falling, and nothing
    of a fall to the side: its number is what it got."""


SECTION, TIMING = WalkingConfig, WalkingTiming


START_PHASE = 0.5  # of the stride: the right foot goes first
EARLIEST_SWING = 0.3
PUSH = 0.5 * 9.81  # largest mean acceleration from rest, m/s^2: half the weight, as shoes grip
FIRST_SIZE = 0.55  # roll and lift of a foot's first swing from rest over those of its length
HIP = 0.997  # height h of the hip in Rv = v/h above the ankles, over thigh and shank together
# Times in which knees bend at the beginning of a walk, and straighten at its end, over those of
# gaining speed and of a stride.
UNLOCKING, LOCKING = 0.5, 0.4
FIRST_LIFT = 0.3  # of the time in which an aid is off the floor, that may be missing at first
MAX_LIMP = 0.25
STANCE = 0.62  # share of a stride that a foot is on the floor, of which a limp takes its share
SHORTER_STEP = 0.3  # how much later than half a stride a limper's other foot is stepped over
# The hip is fastest here, in double support, for a short time, and slow for longer (CMU motion
# capture, subject 02: 0.88 to 1.14 times the walking speed at 1.2 m/s).
SURGE_PHASE, SHARPNESS = 0.04, 0.08
# Steps of a trip, in strides: the trunk pitches and comes back over quick steps. Old people who
# fell bent more, and later loaded the other leg (Pavol et al., J. Gerontol. 56A (2001) M428): the
# sizes are guesses.
TRIP = Step("phase", 0.3, 0.0, 1.2), Step("upset", 1.0, 0.05, 0.4), Step("upset", -1.0, 0.5, 0.7)


@dataclass(frozen=True)
class Gait:
    """Numbers of a walk; phases are fractions of a stride from right heel strike on."""

    speed: float  # m/s
    period_scale: float = 1.0  # factor of the stride's duration after Boulic and Thalmann
    phase: float = 0.0  # phase of a steady walk at t = 0
    arm_swing: float = 1.0  # factor of the arms' amplitude
    trunk_pitch: float = radians(3)  # lean of the trunk ahead, rad
    half_width: float = 0.0315  # half the width of the stance, fraction of the stature
    surge: float = 0.125  # speed of the hip's surge, twice a stride, over the speed
    sidewards: float = 0.018  # amplitude of the hip from side to side, m
    sink: float = 0.003  # loss of standing height while walking, fraction of the stature
    # of walking legs, as `Physique` has them of legs at rest
    straightest: float = 0.9985
    softness: float = 170.0
    # touch_down, heel_off: phases between which the foot lies flat
    touch_down: float = 0.085
    heel_off: float = 0.42
    below: float = 0.25  # phase at which the body is above the foothold
    roll: float = radians(52)  # turn of the foot about its ball until toe-off, rad
    lift: float = 0.048  # height of the swinging foot, over the length of a stride
    # distance of the foot in mid-swing behind a smooth course, over the length of the step
    lag: float = 0.21
    ramp: float = 0.6  # time in which a walk gains and loses its speed, in strides
    # time in which it gains its speed from rest, in strides; None for `ramp`
    start: float | None = None
    ragged: Waves = field(default_factory=Waves)  # relative deviation of the speed over time
    # by how much the phase is ahead after each stride, fractions of a stride
    jitter: tuple[float, ...] = ()
    widths: tuple[float, ...] = ()  # addition to the half width in each stride, m
    lane: Lane | None = None  # where the walker turns round; None for never
    # angle by which the trunk goes ahead where the walker trips half way and catches the fall, rad
    trip: float = 0.0
    # share by which the painful leg stands shorter and the other one longer, its side (-1: right),
    # and the angle by which the trunk leans over it while it stands, rad
    limp: float = 0.0
    limp_side: float = -1.0
    limp_lean: float = 0.0
    held: HeldLoad | Aid | None = None  # what the hands hold, from where the walk begins to its end
    name: str = "walking"  # name of its phase

    def __post_init__(self) -> None:
        if not self.speed > 0:
            raise ValueError(f"who walks has a speed above 0 m/s, not {self.speed:g} m/s")
        if not 0 <= self.limp <= MAX_LIMP:
            raise ValueError(f"a limp is from 0 to {MAX_LIMP}, not {self.limp:g}")


@dataclass(frozen=True)
class Walk:
    """Walks for `duration` s, to the beginning of the last steps, from rest or steadily."""

    gait: Gait
    duration: float = inf
    from_rest: bool = True

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> "Walking":
        """Place a walk in time: from `begin` (s) on, with steps until `horizon` (s)."""
        return Walking(person, self.gait, begin, begin + self.duration, self.from_rest, horizon)


class BodyChannels(NamedTuple):
    """Hip and angles of a walker at M instants; angles in rad.

    Attributes:
        hip: Hip ahead and to the left of the path [2, M], m.
        pelvis_yaw: Turn of the pelvis to the left [M].
        pelvis_roll: Lean of the pelvis to the left [M].
        pitch: Lean of the trunk ahead [M].
        twist: Turn of the trunk to the left [M].
        lean: Lean of the trunk to the left [M].
        shoulders: Flexion of the right and left shoulder [2, M].
        elbows: Flexion of the right and left elbow [2, M].
        hands: How far the hands are on the floor, how far ahead and beside (m), and how far their
            elbows point outwards, each [M].
    """

    hip: Float
    pelvis_yaw: Float
    pelvis_roll: Float
    pitch: Float
    twist: Float
    lean: Float
    shoulders: Float
    elbows: Float
    hands: tuple[Float, Float, Float, Float]


class Stance(NamedTuple):
    """Additions of a stance to the channels of a walk at M instants, named as in `BodyChannels`.

    `sway` is the displacement of the hip [3, M] (m) by posture and sway of the legs.
    """

    sway: Float
    pitch: Float
    twist: Float
    lean: Float
    shoulders: Float
    elbows: Float
    hands: tuple[Float, Float, Float, Float]


@dataclass(frozen=True)
class Walking:
    """The `part.Part` of a person who walks."""

    person: Physique
    gait: Gait
    begin: float  # when the walk begins; x and the strides are counted from here, s
    stop: float  # when the speed begins to fall, s; infinity for never
    from_rest: bool  # whether the walk begins from rest
    horizon: float  # until when there are steps where the walk does not stop, s
    # movements on planted feet that have not ended when the walk begins, or begin before it ends
    planted: tuple[Planted, ...] = ()

    before = STANDING
    after = STANDING

    @cached_property
    def relative_speed(self) -> float:
        """Relative speed Rv = v/h, 1/s; of children as of grown-ups at their Froude number."""
        height = self.person.ankle + HIP * 2 * self.person.leg
        return self.gait.speed / height * self.person.quickness

    @cached_property
    def stride(self) -> float:
        """Duration of a stride, s."""
        return self._usual_stride * self.gait.period_scale

    @property
    def _usual_stride(self) -> float:
        """Duration of a usual stride, s; children's are as short as their legs (Froude)."""
        return curves.cycle_duration(self.relative_speed) * self.person.quickness

    @cached_property
    def ramp(self) -> float:
        """Duration of gaining speed, and of losing it, s."""
        return self.gait.ramp * self.stride

    @cached_property
    def start(self) -> float:
        """Duration of gaining speed from rest, s; over by the end of a walk that is shorter.

        Feet slide when they push too hard, and legs are left behind by a body that is too quick:
        the mean acceleration is at most `PUSH`.
        """
        if self.gait.start is None:
            return self.ramp
        until_rest = self.stop - self.begin + self.ramp
        return min(max(self.gait.start * self.stride, self.gait.speed / PUSH), until_rest)

    @property
    def stops(self) -> bool:
        """Whether the walk ends."""
        return not isinf(self.stop)

    def drive(self, t: Float) -> Float:
        """Share g [M] of the walk at times t [M] (s): 0 at rest, 1 when walking."""
        g: Float = np.ones(t.size)
        if self.from_rest:
            g = minimum_jerk((t - self.begin) / self.start)
        if self.stops:
            g *= 1 - minimum_jerk((t - self.stop) / self.ramp)
        return g

    def _bent(self, t: Float) -> Float:
        """Compute the share [M] of a walker's bend that legs have at times t [M] (s); 0 at rest."""
        share: Float = np.ones(t.size)
        if self.from_rest:
            share = minimum_jerk((t - self.begin) / self._unlocking)
        if self.stops:
            share = share * (1 - minimum_jerk((t - self.end) / self._locking + 1))
        return share

    @property
    def _unlocking(self) -> float:
        """Time in which knees bend at the beginning, s."""
        return UNLOCKING * self.start

    @property
    def _locking(self) -> float:
        """Time in which knees straighten at the end, s."""
        return LOCKING * self.stride

    @cached_property
    def _initial_lead(self) -> Float | float:
        """Integral of the speed's deviation at 0 s, which counts as no lead, s."""
        return 0.0 if self.from_rest else self.gait.ragged.integral(np.zeros(1))

    def _lead(self, t: Float, g: Float | None = None) -> Float | float:
        """Distance of a ragged walker ahead of the mean path at times t [M], m; g from `drive`."""
        if not self.gait.ragged.amplitudes:
            return 0.0
        lead_s = self.gait.ragged.integral(t) - self._initial_lead
        return self.gait.speed * (self.drive(t) if g is None else g) * lead_s

    def path(self, t: Float, lead: Float | float | None = None) -> Float:
        """Distance X(t) [M] (m) that the body has gone, above its feet on average.

        Args:
            t: Times [M], s.
            lead: `_lead` at these times, if it is known, m.
        """
        v, ramp = self.gait.speed, self.ramp
        if self.from_rest:
            x = v * self.start * minimum_jerk_integral((t - self.begin) / self.start)
        else:
            x = v * (t - self.begin)
        if self.stops:
            x -= v * ramp * minimum_jerk_integral((t - self.stop) / ramp)
        x += self._lead(t) if lead is None else lead
        if self._slow_spans.size:
            x -= self._distance_lost(t)
        return x

    def _position_at(self, s: Float) -> tuple[Float, Float, Float | None]:
        """Position x, y (m) and heading (rad), None for 0, of a walker who has gone s [M], m."""
        if not self._turn_starts.size:
            return s, np.zeros_like(s), None
        assert self.gait.lane is not None
        return position_along_lane(s, self._turn_starts, self._arc, self.gait.lane.side)

    @cached_property
    def _arc(self) -> float:
        """Length of a half turn, m; fast walkers turn in a wide arc."""
        lane = self.gait.lane
        return 0.0 if lane is None else pi * lane.radius * max(1.0, self.gait.speed / 1.4)

    @cached_property
    def _turn_starts(self) -> Float:
        """Distances at which half turns begin [K], m."""
        if self.gait.lane is None:
            return np.empty(0)
        times = WalkTimes(
            begin=self.begin,
            end=self.stop if self.stops else max(self.horizon, self.begin),
            stops=self.stops,
            start_up=self.start if self.from_rest else 0.0,
            ramp=self.ramp,
            stride=self.stride,
        )
        return place_half_turns(self.gait.lane, self.gait.speed, self._arc, times)

    @cached_property
    def _slow_spans(self) -> Float:
        """Times at which the walker begins and ends to go slower in each half turn [2, K], s."""
        lane, v = self.gait.lane, self.gait.speed
        if lane is None or not self._turn_starts.size:
            return np.empty((2, 0))
        turn_duration = self._arc / (v * (1 - lane.slow))
        distance_lost = np.arange(self._turn_starts.size) * lane.slow * v * turn_duration
        begin = self.begin + (self._turn_starts + distance_lost) / v - self.ramp / 2
        if self.from_rest:
            begin += (self.start - self.ramp) / 2
        return np.array([begin, begin + turn_duration])

    def _distance_lost(self, t: Float) -> Float:
        """Distance [M] (m) by which half turns have held a walker up until times t [M], s."""
        assert self.gait.lane is not None
        begins, ends = self._slow_spans  # each turn's ramps end before the next turn's begin
        number = np.maximum(np.searchsorted(begins, t, side="right") - 1, 0)
        before = np.concatenate([[0.0], np.cumsum((ends - begins) / self.ramp)])
        slow, fast = (
            minimum_jerk_integral((t - ramp[number]) / self.ramp) for ramp in (begins, ends)
        )
        ramp_distance = self.gait.lane.slow * self.gait.speed * self.ramp
        lost: Float = ramp_distance * (before[number] + slow - fast)
        return lost

    def _times_at_distance(self, s: Float) -> Float:
        """Times [N] (s) at which the walker has gone distances s [N], m."""
        t = self.begin + s / self.gait.speed
        for _ in range(60):
            t = t - (self.path(t) - s) / self.gait.speed
        return t

    def phase(self, t: Float, lead: Float | float | None = None) -> Float:
        """Phase u(t) [M] of the stride; a ragged walker changes stride and cadence alike."""
        u = (START_PHASE if self.from_rest else self.gait.phase) + (t - self.begin) / self.stride
        ahead = self._lead(t) if lead is None else lead
        u += ahead / (2 * self.gait.speed * self.stride)
        if self._slow_spans.size:
            u -= self._distance_lost(t) / (2 * self.gait.speed * self.stride)
        if self._jitter is not None:
            u += self._jitter(t)[0]
        return u

    @property
    def _trip_start(self) -> float:
        """Time at which the walker trips, s."""
        return self.begin + min(self.stop - self.begin, 5.0) / 2

    @cached_property
    def _jitter(self) -> Course | None:
        """Course of the phase gained by each stride and of a trip's upset, if there are any."""
        if not self.gait.jitter and not self.gait.trip:
            return None
        gains = np.diff(self.gait.jitter, prepend=0.0)
        steps = [
            Step("phase", float(gain), self.begin + k * self.stride, self.stride)
            for k, gain in enumerate(gains)
        ]
        if self.gait.trip:
            steps += scale_steps(TRIP, self._trip_start, self.stride)
        return Course.of({"phase": 0.0, "upset": 0.0}, steps)

    def _times_of_phases(self, u: Float) -> Float:
        """Times [N] (s) at which the stride has phases u [N]."""
        t = self.begin + (u - self.phase(np.full(1, self.begin))) * self.stride
        if self.gait.ragged.amplitudes or self._jitter is not None or self._slow_spans.size:
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
        tracks = (*self._foot_tracks, self._aid_track)
        last_touch_down = max(float(track.falls.down[-1]) for track in tracks if track is not None)
        return max(last_touch_down, self.stop + self.ramp)

    @cached_property
    def place(self) -> Place:
        if not self.stops:
            return Place()
        x, y, heading = self._position_at(np.array([self._total_distance]))
        return Place(float(x[0]), float(y[0]), 0.0 if heading is None else float(heading[0]))

    @cached_property
    def _total_distance(self) -> float:
        """Distance to where the feet come to rest, m."""
        return float(self.path(np.array([self.stop + 2 * self.ramp]))[0])

    @property
    def phases(self) -> tuple[Phase, ...]:
        walking = [Phase(self.begin, self.gait.name)]
        if self.gait.trip:
            walking.append(Phase(self._trip_start, "stumbling"))
            walking.append(Phase(self._trip_start + 1.2 * self.stride, "walking"))
        return (*walking, Phase(self.end, "standing")) if self.stops else tuple(walking)

    @property
    def breakpoints(self) -> tuple[float, ...]:
        tracks = (*self._foot_tracks, self._aid_track)
        ends = [track.breakpoints for track in tracks if track is not None]
        if self.from_rest:
            ends.append(self.begin + np.array([0.0, self._unlocking, self.start]))
        if self.stops:
            ends.append(np.array([self.stop, self.stop + self.ramp]))
            ends.append(np.array([self.end - self._locking, self.end]))
        if self._jitter is not None:
            ends.append(np.array(self._jitter.breakpoints))
        if self._turn_starts.size:
            ends += [self._slow_spans.ravel(), self._slow_spans.ravel() + self.ramp]
            ends += [
                self._times_at_distance(self._turn_starts),
                self._times_at_distance(self._turn_starts + self._arc),
            ]
        return tuple(np.concatenate(ends).tolist())

    @cached_property
    def _foot_tracks(self) -> tuple[FootTrack, FootTrack]:
        """Courses of the right and the left foot, whose stride is half a stride later."""
        gait, events = self.gait, [self._event_phases(delay) for delay in (0.0, 0.5)]
        # All instants at once: each look at the phase costs as much for few as for many.
        times = self._times_of_phases(np.concatenate([u.ravel() for u in events]))
        times_of_both = np.split(times, [events[0].size])
        right, left = (
            FootTrack(
                self.person,
                self._footfalls(times_of_foot.reshape(4, -1), side),
                gait.roll,
                gait.lift * gait.speed * self.stride,
                gait.lag,
            )
            for times_of_foot, side in zip(times_of_both, (-1.0, 1.0), strict=True)
        )
        return right, left

    def _event_phases(self, delay: float) -> Float:
        """Phases of the events of a foot.

        Args:
            delay: Delay of its stride to the right foot's, fraction of a stride.

        Returns:
            Phases [4, N + 1] of heel-off, toe-off, touch-down, and of the body above the foothold;
            the last column ends the last swing.
        """
        gait, margin = self.gait, 2 * self.stride
        later, longer, below = self._limp_of(delay)
        delay += later
        earliest = min(EARLIEST_SWING, gait.heel_off + longer - 0.02)
        first = earliest if self.from_rest else self._phase_at(self.begin - margin)
        until = self.stop + self.ramp if self.stops else max(self.horizon, self.begin) + margin
        last = self._phase_at(until)
        heel_off = delay + gait.heel_off + longer
        k = np.arange(np.ceil(first - heel_off), np.ceil(last - heel_off) + 1)
        off = k + heel_off
        of_grown_ups = self._usual_stride / self.person.quickness
        toe_off_phase = np.clip(curves.support(of_grown_ups), 0.58, 0.66)
        toe = k + delay + toe_off_phase + longer
        if self.from_rest:
            off = np.maximum(off, START_PHASE)
            toe = np.maximum(toe, off + 0.12)
        above = k + delay + gait.below + below
        return np.array([off, toe, k + delay + 1 + gait.touch_down, above])

    def _limp_of(self, delay: float) -> tuple[float, float, float]:
        """Changes of a foot's stride by a limp, fractions of a stride.

        Args:
            delay: Delay of the foot's stride to the right one's without a limp.

        Returns:
            How much later it touches down, how much longer it stands, and how much later the body
            is above its foothold.
        """
        shift = STANCE * self.gait.limp
        is_painful = (delay > 0) == (self.gait.limp_side > 0)
        later = (shift if is_painful else -shift) if delay else 0.0
        if is_painful:
            return later, -shift, -shift / 2
        return later, shift, shift / 2 - SHORTER_STEP * shift

    def _footfalls(self, times: Float, side: float) -> Footfalls:
        """Swings of one foot (side -1 or 1) whose events happen at `times` [4, N + 1] (s)."""
        gait = self.gait
        off, toe, down, above = times
        usual_width = side * gait.half_width * self.person.stature
        resting_width = side * self.person.hip
        distances = self.path(above)
        half_widths = np.full(above.size, usual_width)
        smallness = self.person.smallness
        widths = side * smallness * np.array(gait.widths[: half_widths.size])
        half_widths[: widths.size] += widths
        if self.from_rest:
            distances[0], half_widths[0] = 0.0, resting_width
        if self.stops:
            distances[-1], half_widths[-1] = self._total_distance, resting_width
        x, y, heading = self._position_at(distances)
        if heading is None:
            heading = np.zeros_like(distances)
        footholds = np.array([x - half_widths * np.sin(heading), y + half_widths * np.cos(heading)])
        # The last step of a person who comes to a stop may go back; that foot is lifted too.
        size = np.minimum(1.0, np.abs(np.diff(distances)) / (gait.speed * self.stride))
        if self.from_rest:
            size[:1] *= FIRST_SIZE
        return Footfalls(
            off=off[:-1],
            toe=toe[:-1],
            down=down[:-1],
            before=footholds[:, :-1],
            after=footholds[:, 1:],
            heading=heading[:-1],
            size=size,
        )

    def _phase_at(self, t: float) -> float:
        """Phase of the stride at one time t, s."""
        return float(self.phase(np.array([t]))[0])

    @cached_property
    def _curves(self) -> Float:
        """Coefficients [9, 17] in the harmonics of the stride, of the rows of `_gait_channels`."""
        gait, rv = self.gait, self.relative_speed
        cycle = gait.speed * self.stride / (2 * pi)
        surge = sum(
            curves.harmonic(k, share * cycle / k, SURGE_PHASE + 1 / (4 * k))
            for k, share in ((2, gait.surge), (4, SHARPNESS * gait.surge))
        )
        arm, bend = curves.shoulder(rv, gait.arm_swing), curves.elbow(rv)
        bend[0] -= self.person.elbow
        return np.array(
            [
                surge,
                curves.harmonic(1, -gait.sidewards * self.person.smallness, 0.03 + 1 / 4),
                curves.pelvis_yaw(rv),
                curves.pelvis_roll(rv),
                -curves.thorax_yaw(rv),
                arm,
                curves.half_a_stride_later(arm),
                bend,
                curves.half_a_stride_later(bend),
            ]
        )

    def _planted_channels(self, t: Float, distance: Float) -> dict[str, Float]:
        """Channels [M] of a planted posture at rest, changed by movements that overlap the walk.

        Args:
            t: Times [M], s.
            distance: Distance that the walker, from whom the hands are seen, has gone [M], m.
        """
        rest = resting_channels(self.person)
        channels = {channel: np.full(t.size, value) for channel, value in rest.items()}
        for movement in self.planted:
            for channel, value in zip(movement.course.channels, movement.course(t), strict=True):
                channels[channel] += value - rest[channel]
            channels["hands_ahead"] += (
                self._total_distance if movement.begin > self.begin else 0.0
            ) - distance
        return channels

    def _gait_channels(self, u: Float, g: Float) -> BodyChannels:
        """Channels of a walk at phases u [M] of the stride, scaled by its share g [M]."""
        rows = self._curves @ curves.basis(u)
        rows *= g
        surge, aside, yaw, roll, twist, *arms = rows
        zero = np.zeros(u.size)
        return BodyChannels(
            hip=np.array([surge, aside]),
            pelvis_yaw=yaw,
            pelvis_roll=roll,
            pitch=self.gait.trunk_pitch * g,
            twist=twist,
            lean=self._limping_lean(u) * g if self.gait.limp else zero,
            shoulders=np.array(arms[:2]),
            elbows=np.array(arms[2:]) + self.person.elbow,
            hands=(zero, zero, zero, zero),
        )

    def _stance(self, t: Float, distance: Float, idle: IdleState, share: Float) -> Stance:
        """Channels of the stance before and after the walk.

        Args:
            t: Times [M], s.
            distance: Distance that the walker, from whom the hands are seen, has gone [M], m.
            idle: The body's own movements at these times.
            share: Share of standing [M]: 1 at rest, 0 where only the walk is left.
        """
        body, planted = self.person, self._planted_channels(t, distance)
        standing, upright = share * planted["standing"], share * planted["upright"]
        lean, roll = standing * idle.lean, standing * idle.legs_roll
        _, sway = legs(body, planted["shank"], planted["thigh"], lean, roll)
        sway[2] -= body.rest_height - body.ankle
        elbows = np.array([planted[channel] for channel in ELBOWS]) - body.elbow
        return Stance(
            sway=sway,
            pitch=planted["trunk"] + upright * idle.pitch,
            twist=upright * idle.yaw,
            lean=upright * idle.roll,
            shoulders=upright * idle.shoulders + np.array([planted[c] for c in SHOULDERS]),
            elbows=upright * idle.elbows + elbows,
            hands=(
                planted["hands"],
                planted["hands_ahead"],
                planted["hands_beside"],
                planted["splayed"],
            ),
        )

    def _ankles(self, t: Float, x: Float, y: Float, heading: Float | None) -> Float:
        """Ankles [3, 2, M] (m) at times t [M] (s), seen by the walker at x, y (m) and heading."""
        ankles = np.stack([track(t) for track in self._foot_tracks], axis=1)
        ankles[0] -= x
        ankles[1] -= y
        return ankles if heading is None else turned(ankles, -heading)

    def _limping_lean(self, u: Float) -> Float:
        """Lean of a limper's trunk to the left (rad) at phases u [M]: over the painful leg."""
        delay = 0.5 if self.gait.limp_side > 0 else 0.0
        later, longer, _ = self._limp_of(delay)
        middle = delay + later + (STANCE + longer) / 2
        lean: Float = self.gait.limp_side * self.gait.limp_lean * np.cos(2 * pi * (u - middle))
        return lean

    @cached_property
    def _aid_track(self) -> FootTrack | None:
        """Course of the aid on the floor ahead; None without one."""
        aid = self.gait.held
        if not isinstance(aid, Aid) or aid.down is None:
            return None
        first = START_PHASE if self.from_rest else self._phase_at(self.begin - 2 * self.stride)
        until = self.stop + self.ramp if self.stops else max(self.horizon, self.begin)
        last = self._phase_at(until + (0.0 if self.stops else 2 * self.stride))
        lifted = aid.down + aid.up
        # From rest it goes ahead with the first foot, if there is time to set it down.
        earliest = first - FIRST_LIFT * (1 - aid.up) if self.from_rest else first
        k = np.arange(np.ceil(earliest - lifted), max(np.ceil(last - lifted), 1.0) + 1)
        off = np.maximum(k + lifted, first) if self.from_rest else k + lifted
        phases = np.array([off, off + 0.02, k + 1 + aid.down, k + aid.down + aid.up / 2])
        times: Float = self._times_of_phases(phases.ravel()).reshape(4, -1)
        off, toe, down, above = times
        distances = self.path(above)
        if self.from_rest:
            distances[0] = 0.0
        if self.stops:
            distances[-1] = self._total_distance
        x, y, turn = self._position_at(distances)
        heading: Float = np.zeros(x.size) if turn is None else turn
        ahead = aid.ahead * self.person.stature
        places = np.array([x + ahead * np.cos(heading), y + ahead * np.sin(heading)])
        size = np.ones(off.size - 1)
        falls = Footfalls(
            off[:-1], toe[:-1], down[:-1], places[:, :-1], places[:, 1:], heading[:-1], size
        )
        return FootTrack(self.person, falls, 0.0, aid.lift * self.person.stature, 0.0)

    def _held_place(self, t: Float, x: Float, y: Float, heading: Float | None) -> Float | None:
        """Place [3, M] (m) of the aid on the floor, seen by the walker at x, y and heading."""
        if self._aid_track is None:
            return None
        place = self._aid_track(t)
        place[0] -= x
        place[1] -= y
        place[2] -= self.person.ankle
        return place if heading is None else turned(place, -heading)

    def _arms_that_hold(
        self,
        trunk: Axes,
        shoulders: Float,
        flexion: tuple[Float, Float],
        place: Float | None,
        hip_ahead: Float,
        g: Float,
    ) -> tuple[Float, Float]:
        """Unit vectors of upper arms and forearms [3, 2, M] of which some hold something.

        Args:
            shoulders: Right and left shoulder [3, 2, M], m.
            flexion: Flexion of shoulders and elbows of arms that swing, each [2, M], rad.
            place: Place of an aid on the floor [3, M], m.
            hip_ahead: Distance of the hip ahead [M], m.
            g: Share of the walk [M]: at rest the arms hang.
        """
        held, body = self.gait.held, self.person
        assert held is not None
        hands, poles = hanging_hands(body, *flexion)
        if isinstance(held, HeldLoad):
            targets: Float = held.hands(body) + 0 * hands
        else:
            frame = np.array([trunk.ahead, trunk.left, trunk.up])
            aim = hands_of_aid(held, body, place, hip_ahead)
            targets = limit_to_reach(body, np.einsum("axm,xim->aim", frame, aim - shoulders))
        sides = list(held.sides)
        elbows = elbow_directions(held)[:, sides, None]
        hands[:, sides] += g * (targets[:, sides] - hands[:, sides])
        poles[:, sides] += g * (elbows - poles[:, sides])
        return arm_directions_to_hands(trunk, hands, poles, body.arm)

    def _trip_pitch(self, t: Float, g: Float) -> Float | float:
        """Angle (rad) by which a trip pitches the trunk ahead at times t [M] (s), 0 without one."""
        if not self.gait.trip or self._jitter is None:
            return 0.0
        upset: Float = self.gait.trip * g * self._jitter(t)[1]
        return upset

    def pose(self, t: Float, idle: IdleState) -> Pose:
        """Pose at times t [M] (s): worked out as seen by the walker, then put in its place."""
        body, g = self.person, self.drive(t)
        lead = self._lead(t, g)
        distance = self.path(t, lead)
        x, y, heading = self._position_at(distance)
        channels = self._gait_channels(self.phase(t, lead), g)
        ankles = self._ankles(t, x, y, heading)
        joint_offsets = hip_joints(body, channels.pelvis_yaw, channels.pelvis_roll)
        height = body.tallest - self.gait.sink * body.stature * g
        walking = LegBound(self.gait.straightest * 2 * body.leg, self.gait.softness / body.stature)
        bound = LegBound.at_rest(body).towards(walking, self._bent(t))
        if self.from_rest or self.stops:
            stance = self._stance(t, distance, idle, 1 - g)
            hip = hip_point_with_sway(
                body, height, channels.hip, joint_offsets, ankles, stance.sway, bound
            )
            channels = blend(channels, stance)
        else:
            z = hip_height(body, height, channels.hip, joint_offsets, ankles, bound)
            hip = np.array([*channels.hip, z])
        upset = self._trip_pitch(t, g)
        trunk = axes(channels.pitch + upset, channels.twist, channels.lean)
        flexion = channels.shoulders + 1.5 * upset, channels.elbows + 1.5 * upset
        if self.gait.held is None:
            upper, fore = arms_of_posture(body, hip, trunk, flexion, channels.hands)
        else:
            shoulders = shoulder_points(body, hip, trunk)
            place = self._held_place(t, x, y, heading)
            upper, fore = self._arms_that_hold(trunk, shoulders, flexion, place, hip[0], g)
        joints = hip[:, None] + joint_offsets
        knees = two_link(joints, ankles, body.leg, body.leg, AHEAD)
        pose = Pose(hip, trunk, joints, knees, ankles, upper, fore, idle.breath)
        return pose.at(x, y, heading)


def blend(walk: BodyChannels, stance: Stance) -> BodyChannels:
    """Channels of a walk and of the stance it begins or ends in, each with its share, together."""
    return walk._replace(
        pitch=walk.pitch + stance.pitch,
        twist=walk.twist + stance.twist,
        lean=walk.lean + stance.lean,
        shoulders=walk.shoulders + stance.shoulders,
        elbows=walk.elbows + stance.elbows,
        hands=stance.hands,
    )


RAGGED_HZ = (0.1, 0.25, 0.4)
MIN_STRIDE_S = 0.5  # no stride is shorter


def make_gait(mover: Mover) -> Gait:
    """Make the usual gait of a person, whose strides differ."""
    walking = mover.numbers(WalkingConfig[float])
    variation = walking.speed_variation
    strides = ceil(mover.seconds / MIN_STRIDE_S) + 8
    rng = mover.stream(f"motion.speed_variation/{mover.place}")
    # The duration of a stride is the difference of two deviations.
    jitter, widths = (
        share * variation * rng.standard_normal(strides) for share in (8**-0.5, 1 / 3)
    )
    return Gait(
        speed=walking.speed_mps,
        period_scale=walking.period_scale,
        phase=mover.numbers(RepeatingConfig[float]).cycle_phase,
        arm_swing=walking.arm_swing,
        trunk_pitch=radians(walking.trunk_pitch_deg),
        half_width=walking.step_width / 2,
        start=walking.speed_up,
        ragged=low_pass_waves(mover.numbers(IdleConfig[float]), variation, RAGGED_HZ, 0.7),
        jitter=nonzero_tuple(np.clip(jitter, -0.03, 0.03)),
        widths=nonzero_tuple(np.clip(widths, -0.02, 0.03)),
        lane=_draw_lane(mover, walking),
    )


def _draw_lane(mover: Mover, walking: WalkingConfig[float]) -> Lane | None:
    """Lane of a walker who turns round, a part of which may lie behind them; or None."""
    if not (length := walking.lane_m):
        return None
    to_left = mover.stream(f"motion.lane_m/side/{mover.place}").random() < 0.5
    first = (1 - walking.lane_start) * length
    return Lane(length, first, side=1.0 if to_left else -1.0)


def make_walk(mover: Mover) -> Walk:
    """Make a walk of a person, from rest."""
    return Walk(make_gait(mover), mover.duration)


MOVEMENTS = (
    MovementKind(
        "walking",
        "walks",
        make_walk,
        uses=(PHASE,),
        words="walk strolling pacing normal_walking gehen",
        manners="around about in_room indoors normally straight free regular",
        nearby="marching short_steps walking_slowly walking_fast laufen walking_slow slow_walking "
        "fast_walking brisk_walking march treadmill short_step ambulation back_and_forth",
        with_key={
            "motion.angle_deg: 180, towards the radar": "walking_towards walk_towards towards_walk "
            "walking_towards_radar approaching",
            "motion.angle_deg: 0, away from the radar": "walking_away walk_away "
            "walking_away_from_radar departing",
            "motion.angle_deg: 90, across the line of sight": "walking_sideways walking_across "
            "walking_tangentially",
        },
    ),
)
