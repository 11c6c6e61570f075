"""Running, and jogging on the spot: feet that are planted in turn, and flight between them.

In flight the hip follows g alone, at a constant speed ahead; on the floor the force on it rises
and falls as a parabola, near the half sine of Morin et al., J. Appl. Biomech. 21 (2005) 167, and
brakes first. A foot is planted, rolls over its ball, and swings by the length and the direction of
the leg, seen from the hip.

Steps per second: 2.75 at 3 m/s (Lieberman et al., J. Exp. Biol. 218 (2015) 3406), of which ours are
3 % fewer, 12 % more at 5.2 than at 3.5 m/s (Dorn, Schache and Pandy, J. Exp. Biol. 215 (2012)
1944). Time of contact: 39 % of a stride at 3.2 m/s, 36 % at 3.9 m/s, 22 % at 9 m/s (Novacheck, Gait
& Posture 7 (1998) 77); here 32 % at 3 and 27 % at 6 m/s, with which the pelvis rises and falls by
what is measured: some 95 mm at 2.5 to 3 m/s and 60 to 70 at 5 to 6 (from memory). Novacheck also
has the knee's flexion in the swing (90 degrees, 105 to 130 in a sprint), arms and trunk. How
the speed falls on landing: Cavanagh and Lafortune, J. Biomech. 13 (1980) 397, 0.18 m/s at 4.5 m/s.
Other statures have the same gait at equal Froude numbers v^2/(g H) (Alexander, Physiol. Rev. 69
(1989) 1199). Starts, stops, and jogging on the spot are guesses.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from math import ceil, inf, isinf, pi, radians, sqrt
from typing import Annotated, Generic, NamedTuple

import numpy as np

from radhar_cli.motion.human.arms import arm_directions
from radhar_cli.motion.human.idle import IdleState
from radhar_cli.motion.human.minimum_jerk import minimum_jerk
from radhar_cli.motion.human.part import STANDING, Phase, Place
from radhar_cli.motion.human.pelvis import hip_joints, sway_displacement
from radhar_cli.motion.human.physique import Physique
from radhar_cli.motion.human.pose import SIDES, Pose, axes
from radhar_cli.motion.human.quintics import Quintics
from radhar_cli.motion.human.two_link import AHEAD, two_link
from radhar_cli.motion.movements.kind import MovementKind, Mover
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.schema.annotations import PERSONAL, UNSTEADY, People
from radhar_cli.schema.number import ANGLE, NOT_NEGATIVE, RATIO, SPEED, normal, uniform
from radhar_cli.schema.section import B, ByActivity, Section, default_draw

RUNNING_SPEED = normal(3.3, 0.7, 2.5, 6.0)
RUNS = "running jogging_in_place"


class RunningConfig(Section, Generic[B]):
    """Running, and jogging on the spot."""

    speed_mps: Annotated[
        B, ByActivity(NOT_NEGATIVE, SPEED), People("running", 1.0, 7.0), PERSONAL
    ] = default_draw(RUNNING_SPEED)
    """Speed of a run. The default is that of people of 1.7 m; of others at the same Froude
    number."""
    cadence: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(RUNS, 0.85, 1.15), PERSONAL] = (
        default_draw(normal(1.0, 0.05, 0.9, 1.1))
    )
    """Steps per second of a run, relative to the usual ones at its speed."""
    trunk_pitch_deg: Annotated[B, ByActivity(ANGLE), People(RUNS, -5, 25), PERSONAL] = default_draw(
        normal(7.0, 3.0, 1.0, 15.0)
    )
    """Forward pitch of a runner's trunk."""
    arm_swing: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(RUNS, 0, 1.6), PERSONAL] = (
        default_draw(uniform(0.7, 1.3))
    )
    """Arm swing of a runner, relative to the usual one."""
    elbow_deg: Annotated[B, ByActivity(ANGLE), People(RUNS, 40, 120), PERSONAL] = default_draw(
        normal(90.0, 12.0, 65.0, 115.0)
    )
    """Mean flexion of a runner's elbows."""
    knee_deg: Annotated[B, ByActivity(ANGLE), People("jogging_in_place", 45, 115), PERSONAL] = (
        default_draw(uniform(60.0, 105.0))
    )
    """Largest flexion of the knees in jogging on the spot."""
    variation: Annotated[B, ByActivity(NOT_NEGATIVE, RATIO), People(RUNS, 0, 0.05), UNSTEADY] = (
        default_draw(uniform(0.0, 0.03))
    )
    """Relative standard deviation of the time and of the speed of a runner's steps."""


SECTION = RunningConfig


G = 9.81  # m/s^2
REFERENCE_STATURE = 1.75  # m, of the people whose steps are known
RIGHT, LEFT = 0, 1
SETTLING_S = 6  # row of `Footing.settling`
# Of a step on the floor, at most: slow runners hardly leave it.
LONGEST_CONTACT = 0.84
ON_THE_SPOT = 2.75, 0.72  # steps per second, and share of a step on the floor
AHEAD_OF_HIP = 0.36  # of the way over a foot, how much lies before it when it lands
HEEL_OFF = 0.3  # when the heel rises, share of the time on the floor
BRAKE = 0.021  # mean loss of speed on the floor, over the speed
# Length of a leg on the floor over thigh and shank together, at most; it gets still longer after it
# has left the floor, so that it is shorter by the speed then, s/m.
STRETCHED, SHORTER = 0.985, 0.0075
FIRST_SPEED, LAST_SPEED = 1.4, 1.0  # of the first step and before the last one, m/s
GAIN, LOSS = 3.0, 3.5  # of speed in starts and stops, m/s^2
FIRST_S, LAST_S = 0.55, 0.6  # duration of the first push, and of coming to rest, s
FIRST_FOOT = 0.4  # when the first foot leaves the floor, share of the first push
LAST_LIFT = 0.03  # height added to the swing of that foot, over the stature
LAST_SWING = 0.8  # when the other foot comes to stand, share of the time of coming to rest
# Exponents (p, q) of `_bump`: how a swinging leg is folded in its middle, shortened after it has
# left the floor, and bent before it lands.
FOLD, RELEASE, BEND = (3, 4), (3, 8), (8, 3)
FOLDED = 3 / 7  # when a swinging leg is shortest, share of the swing
LAG = radians(14)  # angle by which a folded leg is behind, at most
CAUGHT = 0.45  # when the last fall is caught, share of the time of coming to rest
LEVELLINGS = 4  # steps of the search for the height of the hip
LONGEST = 0.993  # of a swinging leg, likewise
RELEASED = 0.965  # length of a leg that has left the floor, over thigh and shank, unless it is more
CLEARANCE = 0.012  # of the ankle above where it stands before it lands, over the stature
FLAT = 0.14  # when a foot that lands has come to lie flat, share of the time on the floor
# Speed of the leg, seen from the hip, when the foot lands, over that when it is flat.
SETTLING = 0.4
YAW, ROLL = radians(6), radians(4)  # of the pelvis, amplitude
SIDEWARDS = 0.006  # of the hip to the foot on the floor, over the stature
NOD, TWIST = radians(2), radians(11)  # of the trunk ahead and to the sides, amplitude
# Amplitude of the shoulders' flexion, its growth by speed (rad/(m/s)), and how late it is, rad.
ARM, ARM_GAIN, ARM_LATE = radians(17), radians(4), radians(10)
NUDGE = 2e-5  # s, for derivatives of the leg at both ends of a swing


@dataclass(frozen=True)
class RunningGait:
    """Numbers of a run."""

    speed: float  # m/s; 0 is on the spot
    cadence: float = 1.0  # factor of the usual steps per second
    phase: float = 0.0  # phase of a steady run at its beginning, strides from right touch-down on
    arm_swing: float = 1.0  # factor of the arms' amplitude
    trunk_pitch: float = radians(7)  # lean of the trunk ahead, rad
    elbow: float = radians(90)  # mean flexion of the elbows, rad
    knee: float | None = None  # largest flexion of the swinging knee, rad; None for the usual one
    half_width: float = 0.014  # half the distance across between the feet, over the stature
    # time and speed of each step over the usual ones
    paces: tuple[float, ...] = ()
    speeds: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        if not self.speed >= 0:
            raise ValueError(f"a run has a speed of 0 m/s or more, not {self.speed:g} m/s")


@dataclass(frozen=True)
class GoRunning:
    """Runs for `duration` s, to the beginning of the last steps, from rest or steadily."""

    gait: RunningGait
    duration: float = inf
    from_rest: bool = True

    fastest_hz = 4.0

    def part(self, person: Physique, begin: float, horizon: float = 0.0) -> "Running":
        """Place a run in time: from `begin` (s) on, with steps until `horizon` (s)."""
        return Running(person, self.gait, begin, begin + self.duration, self.from_rest, horizon)


def step_times(speed: float, stature: float) -> tuple[float, float]:
    """Duration of a step, and of its time on the floor, s.

    Args:
        speed: m/s.
        stature: m.
    """
    scale = sqrt(stature / REFERENCE_STATURE)
    v = speed / scale
    if not v:
        return scale / ON_THE_SPOT[0], scale * ON_THE_SPOT[1] / ON_THE_SPOT[0]
    step = scale / (2.45 + 0.0245 * v * v)
    return step, min(scale * 0.43 * v**-0.542, LONGEST_CONTACT * step)


class Footing(NamedTuple):
    """One foot on the floor: when, where, and how far it rolls over its ball."""

    down: float  # from when on the foot lies flat, s
    heel: float  # when the heel rises, s
    off: float  # toe-off, s
    x: float  # foothold ahead, m
    y: float  # foothold to the left, m
    roll: float  # turn about the ball at toe-off, rad
    settling: float  # time from touch-down until it lies flat, s


class Contact(NamedTuple):
    """One foot on the floor: when, and the speed before and after it, m/s."""

    foot: int
    down: float
    off: float
    before: float
    after: float


@dataclass(frozen=True)
class Running:
    """The `part.Part` of a person who runs."""

    person: Physique
    gait: RunningGait
    begin: float
    stop: float  # when the speed begins to fall, s; infinity for never
    from_rest: bool
    horizon: float  # until when there are steps where the run does not stop, s

    before = STANDING
    after = STANDING

    @property
    def stops(self) -> bool:
        """Whether the run ends."""
        return not isinf(self.stop)

    @property
    def _scale(self) -> float:
        """Times and speeds of this person over those of the reference, at equal Froude numbers."""
        return sqrt(self.person.stature / REFERENCE_STATURE)

    def _times(self, speed: float, number: int) -> tuple[float, float]:
        """Duration of a step, and of its time on the floor, at a speed; s."""
        paces = self.gait.paces
        pace = (paces[number % len(paces)] if paces else 1.0) / self.gait.cadence
        step, contact = step_times(speed, self.person.stature)
        return pace * step, pace * contact

    def _speed(self, number: int) -> float:
        """Speed in flight of a step that is neither of the start nor of the stop, m/s."""
        speeds = self.gait.speeds
        step, contact = step_times(self.gait.speed, self.person.stature)
        in_flight = self.gait.speed / (1 - BRAKE * contact / step)
        return in_flight * (speeds[number % len(speeds)] if speeds else 1.0)

    @cached_property
    def _contacts(self) -> list[Contact]:
        """Feet on the floor in turn; the last one of a run that stops stays there."""
        scale = self._scale
        first, last = (min(self.gait.speed, v * scale) for v in (FIRST_SPEED, LAST_SPEED))
        contacts = list[Contact]()
        if self.from_rest:
            lift_off = self.begin + FIRST_S * scale
            contacts.append(Contact(LEFT, self.begin, lift_off, 0.0, first))
            foot, speed = RIGHT, first
        else:
            step, contact = self._times(self.gait.speed, 0)
            lift_off = self.begin - 2 * step * (self.gait.phase % 1 + 2) - (step - contact)
            foot, speed = RIGHT, self._speed(0)
        until = max(self.horizon, self.begin) + 4 * step_times(speed, self.person.stature)[0]
        while True:
            number = len(contacts)
            step, contact = self._times(speed, number)
            down = lift_off + step - contact
            if down > until and not self.stops:
                return contacts
            if down >= self.stop and speed <= last * 1.001:
                contacts.append(Contact(foot, down, down + LAST_S * scale, speed, 0.0))
                return contacts
            change = (LOSS if down >= self.stop else GAIN) * step
            target = last if down >= self.stop else self._speed(number)
            following = min(max(target, speed - change), speed + change)
            contact = self._times((speed + following) / 2, number)[1]
            contacts.append(Contact(foot, down, down + contact, speed, following))
            lift_off, foot, speed = down + contact, 1 - foot, following

    def _roll_at(self, speed: float) -> float:
        """Turn of a foot about its ball at toe-off, rad: less on the spot."""
        return radians(30) + radians(5.5) * min(speed / self._scale, 6.0)

    @cached_property
    def _path(self) -> tuple[Float, Float]:
        """Distance of the hip ahead at each touch-down and toe-off, each [K], m."""
        down, off, before, after = self._table
        over = (off - down) * ((before + after) / 2 - BRAKE * np.minimum(before, after))
        through_air = (down[1:] - off[:-1]) * after[:-1]
        landing = np.concatenate([[0.0], np.cumsum(over[:-1] + through_air)])
        if not self.from_rest:  # 0 at the beginning
            landing = landing - np.interp(self.begin, down, landing)
        return landing, landing + over

    @property
    def _table(self) -> Float:
        """Touch-down and toe-off (s), speed before and after (m/s) of all contacts [4, K]."""
        return np.array([contact[1:] for contact in self._contacts]).T

    @cached_property
    def _hip_curve(self) -> Quintics:
        """Hip ahead and up over time, m: as high as the legs on the floor reach."""
        levels = np.full(len(self._contacts), self.person.tallest)
        for _ in range(LEVELLINGS):
            levels = self._reached(levels)
        return self._hip_at(levels)

    def _hip_at(self, levels: Float) -> Quintics:
        """Hip ahead and up over time that lands and leaves the floor at heights [K], m."""
        down, off, before, after = self._table
        air = down[1:] - off[:-1]
        rising = np.diff(levels) / air + G * air / 2
        falling = np.concatenate([-rising[:1], rising - G * air])
        rising = np.concatenate([rising, -falling[-1:]])
        knots = np.zeros((2, down.size, 3, 2))  # touch-downs, toe-offs
        for event, (x, speed, climb) in enumerate(
            zip(self._path, (before, after), (falling, rising), strict=True)
        ):
            knots[event, :, 0] = np.stack([x, levels], axis=1)
            knots[event, :, 1] = np.stack([speed, climb], axis=1)
            knots[event, :, 2, 1] = -G
        at_rest = [self.person.rest_height, 0.0, 0.0]
        if self.from_rest:
            knots[0, 0, :, 1] = at_rest
        if self.stops:
            knots[1, -1, :, 1] = at_rest
        times, knots = np.stack([down, off], axis=1).ravel(), knots.swapaxes(0, 1).reshape(-1, 3, 2)
        if self.stops:  # the fall is caught before the hip comes to rest
            caught = down[-1] + CAUGHT * (off[-1] - down[-1])
            middle = Quintics(times[-2:], knots[-2:]).knot(caught)
            middle[:, 1] = levels[-1], 1.5 * (at_rest[0] - levels[-1]) / (off[-1] - caught), 0.0
            times = np.insert(times, -1, caught)
            knots = np.insert(knots, -1, middle, axis=0)
        return Quintics(times, knots)

    def _reached(self, levels: Float) -> Float:
        """Heights [K] (m) like `levels` at which each leg reaches the floor."""
        body, contacts = self.person, self._contacts
        down, off, _, after = self._table
        share = np.linspace(0.0, 1.0, 41)
        x, z = (
            row.reshape(down.size, -1)
            for row in self._hip_at(levels)((down[:, None] + np.outer(off - down, share)).ravel())
        )
        roll = np.array([self._roll_at(0.5 * (one.before + one.after)) for one in contacts])
        roll[-1] = 0.0 if self.stops else roll[-1]
        ahead, up = _rolled(body, _roll((share - HEEL_OFF) / (1 - HEEL_OFF), roll[:, None]))
        leaving = STRETCHED - SHORTER * np.minimum(after / self._scale, 6.0)[:, None]
        late = ((share - 0.75) / 0.25).clip(0.0)
        reach = 2 * body.leg * (STRETCHED + (leaving - STRETCHED) * late)
        far = self._footholds[:, None] + ahead - x
        limit = up + np.sqrt(np.maximum(reach**2 - far**2 - 0.25 * body.hip**2, 0.0))
        room = limit - (z - levels[:, None])
        if self.from_rest:  # the height at rest stays
            room[0, :20] = np.inf
        if self.stops:
            room[-1, 20:] = np.inf
        reached: Float = np.minimum(room.min(axis=1), body.tallest)
        return reached

    @cached_property
    def _footholds(self) -> Float:
        """Distances ahead at which the foot of each contact stands [K], m."""
        landing, leaving = self._path
        x: Float = landing + AHEAD_OF_HIP * (leaving - landing)
        if self.from_rest:
            x[0] = 0.0
        if self.stops:
            x[-1] = leaving[-1]
        return x

    @cached_property
    def _phase_curve(self) -> Quintics:
        """Phase of the stride over time, from right touch-down on."""
        down, off = self._table[:2]
        phase = 0.5 * (np.arange(down.size) + self._contacts[0].foot)
        step = np.diff(down)
        rate = 1 / (np.concatenate([step[:1], step]) + np.concatenate([step, step[-1:]]))
        times, knots = down, np.stack([phase, rate, 0 * phase], axis=1)
        if self.from_rest:
            knots[0, 1], knots[1, 1] = 0.0, 0.5 / step[min(1, step.size - 1)]
        if self.stops:
            rest = [phase[-1] + 0.5 * rate[-1] * (off[-1] - down[-1]), 0.0, 0.0]
            times, knots = np.append(times, off[-1]), np.concatenate([knots, [rest]])
        return Quintics(times, knots[:, :, None])

    @cached_property
    def _ramps(self) -> tuple[tuple[float, float] | None, tuple[float, float] | None]:
        """Beginning and duration of the speeding up, and of the slowing down, s; None without."""
        up = (self.begin, 1.6 * FIRST_S * self._scale) if self.from_rest else None
        if not self.stops:
            return up, None
        slowing = next(one.down for one in self._contacts if one.down >= self.stop)
        return up, (slowing, self.end - slowing)

    def share(self, t: Float) -> Float:
        """Share of running [M] at times t [M] (s): 0 at rest, 1 when under way."""
        up, down = self._ramps
        g: Float = np.ones(t.size)
        if up is not None:
            g = minimum_jerk((t - up[0]) / up[1])
        if down is not None:
            g = g * (1 - minimum_jerk((t - down[0]) / down[1]))
        return g

    @cached_property
    def end(self) -> float:
        return self._contacts[-1].off if self.stops else inf

    @property
    def place(self) -> Place:
        return Place(float(self._path[1][-1])) if self.stops else Place()

    @property
    def phases(self) -> tuple[Phase, ...]:
        under_way = Phase(self.begin, "running" if self.gait.speed else "jogging in place")
        return (under_way, Phase(self.end, "standing")) if self.stops else (under_way,)

    @cached_property
    def _stances(self) -> tuple[list[Footing], list[Footing]]:
        """Stances of the right and of the left foot, in their order."""
        body, contacts = self.person, self._contacts
        stances: tuple[list[Footing], list[Footing]] = ([], [])
        if self.from_rest:
            push = contacts[0].off - self.begin
            off = self.begin + FIRST_FOOT * push
            roll = 0.5 * self._roll_at(contacts[0].after)
            stances[RIGHT].append(Footing(-inf, self.begin, off, 0.0, -body.hip, roll, 0.0))
        for number, contact in enumerate(contacts):
            first = number == 0 and self.from_rest
            last = self.stops and number == len(contacts) - 1
            settling = FLAT * min(contact.off - contact.down, 0.3 * self._scale)
            width = body.hip if first or last else self.gait.half_width * body.stature
            stance = Footing(
                down=-inf if first else contact.down + settling,
                heel=contact.down + HEEL_OFF * (contact.off - contact.down),
                off=contact.off,
                x=float(self._footholds[number]),
                y=SIDES[contact.foot, 0] * width,
                roll=self._roll_at(0.5 * (contact.before + contact.after)),
                settling=settling,
            )
            if last:
                stance = stance._replace(heel=inf, off=inf)
                other = 1 - contact.foot
                later = contact.down + LAST_SWING * (contact.off - contact.down)
                beside = stance._replace(down=later, y=SIDES[other, 0] * width)
                stances[other].append(beside)
            stances[contact.foot].append(stance)
        return stances

    @property
    def breakpoints(self) -> tuple[float, ...]:
        times = {time for feet in self._stances for stance in feet for time in stance[:3]}
        times |= set(self._hip_curve.times.tolist()) | set(self._phase_curve.times.tolist())
        times |= {time for ramp in self._ramps if ramp for time in (ramp[0], sum(ramp))}
        return tuple(time for time in times if not isinf(time))

    def _pelvis(self, t: Float) -> tuple[Float, Float, Float]:
        """Hip [3, M] and hip joints about it [3, 2, M] (m), and the phase [M] of the stride."""
        x, z = self._hip_curve(t)
        phase, g = self._phase_curve(t)[0], self.share(t)
        middle = 2 * pi * (phase - self._duty / 2)
        aside = -SIDEWARDS * self.person.stature * g * np.cos(middle)
        offsets = hip_joints(
            self.person, g * YAW * np.cos(2 * pi * phase), g * ROLL * np.cos(middle)
        )
        return np.array([x, aside, z]), offsets, phase

    @cached_property
    def _duty(self) -> float:
        """Share of a stride that a foot is on the floor."""
        step, contact = self._times(self.gait.speed, 0)
        return contact / (2 * step)

    def _planted(self, foot: int, number: Index, t: Float) -> Float:
        """Ankle [3, M] (m) of a foot in its stances of some numbers [M] at times t [M] (s)."""
        _, heel, off, x, y, roll, _ = self._stance_table[foot][:, number]
        with np.errstate(invalid="ignore"):
            since = np.where(np.isinf(heel), 0.0, (t - heel) / (off - heel))
        ahead, up = _rolled(self.person, _roll(since, roll))
        return np.array([x + ahead, y, up])

    @cached_property
    def _stance_table(self) -> tuple[Float, Float]:
        """The numbers of `Footing` of both feet, each [7, N]."""
        right, left = (np.array(feet).T for feet in self._stances)
        return right, left

    @cached_property
    def _swings(self) -> tuple[tuple[Quintics, Float], tuple[Quintics, Float]]:
        """Length (m) and direction (rad) of the leg and the ankle's place to the left (m).

        The length is seen from the side, from hip joint to ankle. Each foot has its curves over
        time and, for each swing [4, N - 1], by how much the leg is folded at first, in its middle
        and late, and up to which length it is left as it is, m.
        """
        right, left = (self._swings_of(foot) for foot in (RIGHT, LEFT))
        return right, left

    def _swings_of(self, foot: int) -> tuple[Quintics, Float]:
        table = self._stance_table[foot]
        off, down = table[2, :-1], table[0, 1:]
        number = np.arange(off.size)
        start, end = (
            self._leg_and_derivatives(foot, stance, instant)
            for stance, instant in ((number, off), (number + 1, down))
        )
        settling = table[SETTLING_S, 1:][:, None]
        landing = _before(end, settling)
        curve = Quintics(
            np.stack([off, down - settling[:, 0], down], axis=1).ravel(),
            np.stack([start, landing, end], axis=1).reshape(-1, 3, 3),
        )
        speed = np.diff(table[3]) / (down - off)
        usual = np.radians(62) + np.radians(10) * np.minimum(speed / self._scale, 6.0)
        knee = usual if self.gait.knee is None else np.full(off.size, self.gait.knee)
        folded = 2 * self.person.leg * np.cos(knee / 2)
        air = down - settling[:, 0] - off
        release = self._release(curve, off, air)
        fold = np.maximum(
            curve(off + FOLDED * air)[0] - folded - release * _bump(FOLDED, RELEASE), 0.0
        )
        free = np.maximum(start[:, 0, 0], end[:, 0, 0]) + 1e-3 * self.person.leg
        return curve, np.array([release, fold, self._bend(foot, curve, off, air, fold), free])

    def _release(self, curve: Quintics, off: Float, air: Float) -> Float:
        """Shortening of a leg that has left the floor, in each swing [N], m."""
        share = np.linspace(0.06, 0.3, 9)[:, None]
        length = curve((off + share * air).ravel())[0].reshape(9, -1)
        longest = np.maximum(RELEASED * 2 * self.person.leg, curve(off)[0] + 0.02 * self.person.leg)
        release: Float = ((length - longest) / _bump(share, RELEASE)).max(axis=0, initial=0.0)
        return release

    def _bend(self, foot: int, curve: Quintics, off: Float, air: Float, fold: Float) -> Float:
        """Shortening of a leg late in each swing [N] that lets the foot clear the floor, m.

        Args:
            foot: RIGHT or LEFT.
            curve: Length and direction of the leg over time.
            off: Beginning of each swing [N], s.
            air: Duration of each swing [N], s.
            fold: By how much the leg is folded in its middle [N], m.
        """
        share = np.linspace(0.45, 0.95, 26)[:, None]
        t = (off + share * air).ravel()
        length, direction = (row.reshape(26, -1) for row in curve(t)[:2])
        hip, offsets, _ = self._pelvis(t)
        joint = (hip[2] + offsets[2, foot]).reshape(26, -1)
        cos = np.cos(direction - self._lag * _bump(share, FOLD))
        height = joint - (length - fold * _bump(share, FOLD)) * cos
        clear = self.person.ankle + CLEARANCE * self.person.stature * _bump(share, BEND)
        bend: Float = ((clear - height) / (cos * _bump(share, BEND))).max(axis=0, initial=0.0)
        return bend

    @property
    def _lag(self) -> float:
        """Angle by which a folded leg is behind, rad; none on the spot."""
        return LAG * min(1.0, self.gait.speed / (3 * self._scale))

    def _leg_and_derivatives(self, foot: int, number: Index, t: Float) -> Float:
        """Planted leg (`_leg`) with its velocity and acceleration [M, 3, 3]."""
        return _knots_of(lambda nudge: self._leg(foot, number, t + nudge))

    def _leg(self, foot: int, number: Index, t: Float) -> Float:
        """Length (m), direction (rad) and place to the left (m) of a planted leg [3, M]."""
        hip, offsets, _ = self._pelvis(t)
        x, _, z = self._planted(foot, number, t) - hip - offsets[:, foot]
        y = self._planted(foot, number, t)[1]
        return np.array([np.hypot(x, z), np.arctan2(x, -z), y])

    @cached_property
    def _last_swing(self) -> tuple[int, Quintics]:
        """Foot that comes to rest last, and its ankle's way there over time, m."""
        foot = 1 - self._contacts[-1].foot
        table = self._stance_table[foot]
        number, off, down = np.array([table.shape[1] - 2]), table[2, -2:-1], table[0, -1:]
        start = _knots_of(lambda nudge: self._planted(foot, number, off + nudge))
        rest = np.zeros((1, 3, 3))
        rest[0, 0] = self._planted(foot, number + 1, down)[:, 0]
        return foot, Quintics(np.concatenate([off, down]), np.concatenate([start, rest]))

    def _ankles(self, t: Float, joints: Float) -> Float:
        """Ankles [3, 2, M] (m) below hip joints [3, 2, M] (m) without sway at times t [M] (s)."""
        ankles = np.empty((3, 2, t.size))
        for foot in (RIGHT, LEFT):
            table = self._stance_table[foot]
            events = np.stack([table[2, :-1], table[0, 1:]], axis=1).ravel()
            event = np.searchsorted(events, t, side="right")
            swinging = event % 2 == 1
            ankles[:, foot] = self._planted(foot, event // 2, t)
            if swinging.any():
                curve, shorter = self._swings[foot]
                number, now = event[swinging] // 2, t[swinging]
                air = table[0, 1:] - table[SETTLING_S, 1:] - table[2, :-1]
                share = (now - table[2, number]) / air[number]
                length, direction, y = curve(now)
                release, fold, bend, free = shorter[:, number]
                length = length - release * _bump(share, RELEASE) - fold * _bump(share, FOLD)
                length = length - bend * _bump(share, BEND)
                length = _at_most(length, free, LONGEST * 2 * self.person.leg)
                direction = direction - self._lag * _bump(share, FOLD)
                joint = joints[:, foot, swinging]
                ankles[:, foot, swinging] = np.array(
                    [
                        joint[0] + length * np.sin(direction),
                        y,
                        joint[2] - length * np.cos(direction),
                    ]
                )
        if self.stops:
            foot, curve = self._last_swing
            off, down = curve.times
            swinging = (t > off) & (t < down)
            ankles[:, foot, swinging] = curve(t[swinging])
            lift = LAST_LIFT * self.person.stature
            ankles[2, foot, swinging] += lift * _bump((t[swinging] - off) / (down - off), FOLD)
        return ankles

    def pose(self, t: Float, idle: IdleState) -> Pose:
        body, g = self.person, self.share(t)
        hip, offsets, phase = self._pelvis(t)
        ankles = self._ankles(t, hip[:, None] + offsets)
        rest = 1 - g
        hip = hip + rest * sway_displacement(
            body.rest_height - body.ankle, idle.lean, idle.legs_roll
        )
        joints = hip[:, None] + offsets
        knees = two_link(joints, ankles, body.leg, body.leg, AHEAD)
        turn = 2 * pi * phase
        pitch = self.gait.trunk_pitch + NOD * np.cos(2 * (turn - pi * self._duty))
        twist = -TWIST * np.cos(turn)
        trunk = axes(g * pitch + rest * idle.pitch, g * twist + rest * idle.yaw, rest * idle.roll)
        speed = min(self.gait.speed / self._scale, 6.0)
        swing = self.gait.arm_swing * (ARM + ARM_GAIN * speed) * SIDES * np.cos(turn - ARM_LATE)
        bend = self.gait.elbow - body.elbow + 0.35 * swing
        upper, fore = arm_directions(
            trunk,
            g * (swing - 0.3 * ARM) + rest * idle.shoulders,
            body.elbow + g * bend + rest * idle.elbows,
        )
        return Pose(hip, trunk, joints, knees, ankles, upper, fore, idle.breath)


def _roll(share: Float, roll: Float | float) -> Float:
    """Turn of a foot about its ball (rad): roll (2 s^3 - s^4), s the share of its time [...]."""
    s = np.maximum(share, 0.0)
    beta: Float = roll * s**3 * (2 - s)
    return beta


def _rolled(body: Physique, beta: Float) -> tuple[Float, Float]:
    """Return an ankle's distance ahead of its foothold and its height, m, by the foot's turn."""
    cos, sin = np.cos(beta), np.sin(beta)
    return body.toes * (1 - cos) + body.ankle * sin, body.toes * sin + body.ankle * cos


def _bump(share: Float | float, exponents: tuple[int, int]) -> Float:
    """Curve s^p (1 - s)^q over its maximum, 0 to 1, of the share s of a swing [...]."""
    p, q = exponents
    share = np.clip(share, 0.0, 1.0)
    bump: Float = (p + q) ** (p + q) / (p**p * q**q) * share**p * (1 - share) ** q
    return bump


def _knots_of(curve: Callable[[float], Float]) -> Float:
    """Value, velocity and acceleration [M, 3, C] at 0 s of a curve [C, M] over time (s)."""
    earlier, now, later = (curve(nudge) for nudge in (-NUDGE, 0.0, NUDGE))
    speed, change = (later - earlier) / (2 * NUDGE), (later - 2 * now + earlier) / NUDGE**2
    return np.stack([now, speed, change]).transpose(2, 0, 1)


def _at_most(length: Float, free: Float, longest: float) -> Float:
    """Lengths [M] (m) of which those above `free` [M] are shortened, smoothly, below `longest`."""
    room = longest - free
    over = np.maximum(length - free, 0.0) / room
    limited: Float = np.minimum(length, free) + room * over / np.cbrt(1 + over**3)
    return limited


def _before(end: Float, duration: Float) -> Float:
    """Value, velocity and acceleration [N, 3, C] a `duration` [N, 1] (s) before those at an end.

    The velocity is SETTLING times as large then, and grows steadily.
    """
    value, velocity, acceleration = end[:, 0], end[:, 1], end[:, 2]
    earlier, change = SETTLING * velocity, (1 - SETTLING) * velocity / duration
    value = value - duration * (earlier + velocity) / 2 + duration**2 * (acceleration - change) / 12
    return np.stack([value, earlier, change], axis=1)


SHORTEST_STEP_S = 0.2


def _make_gait(mover: Mover, speed: float, knee: float | None = None) -> RunningGait:
    """Gait of a run, whose steps differ in time and speed.

    Args:
        mover: Person who runs.
        speed: m/s.
        knee: Largest flexion of the swinging knee, rad; None for the usual one.
    """
    running = mover.numbers(RunningConfig[float])
    count = ceil(mover.seconds / SHORTEST_STEP_S) + 8
    rng = mover.stream(f"motion.running.variation/{mover.place}")
    paces, speeds = 1 + np.clip(running.variation * rng.standard_normal((2, count)), -0.08, 0.08)
    return RunningGait(
        speed=speed,
        cadence=running.cadence,
        arm_swing=running.arm_swing,
        trunk_pitch=radians(running.trunk_pitch_deg),
        elbow=radians(running.elbow_deg),
        knee=knee,
        paces=tuple(paces.tolist()) if running.variation else (),
        speeds=tuple(speeds.tolist()) if running.variation else (),
    )


def make_run(mover: Mover) -> GoRunning:
    """Make a run of a person, from rest."""
    speed = mover.numbers(RunningConfig[float]).speed_mps
    return GoRunning(_make_gait(mover, speed), mover.duration)


def make_jogging_in_place(mover: Mover) -> GoRunning:
    """Make a person jog on the spot, from rest."""
    knee = radians(mover.numbers(RunningConfig[float]).knee_deg)
    return GoRunning(_make_gait(mover, 0.0, knee), mover.duration)


MOVEMENTS = (
    MovementKind(
        "running",
        "runs, with a flight in each step",
        make_run,
        words="run jogging jog sprinting sprint rennen",
        manners="around straight",
    ),
    MovementKind(
        "jogging_in_place",
        "jogs on the spot",
        make_jogging_in_place,
        in_place=True,
        words="run_in_place run_on_the_spot run_on_spot running_in_place running_on_the_spot "
        "running_on_spot jog_in_place jog_on_the_spot jog_on_spot jogging_on_the_spot "
        "jogging_on_spot",
        nearby="mark_time stepping_in_place marching_in_place high_knees stepping "
        "walking_in_place marching_on_the_spot",
    ),
)
