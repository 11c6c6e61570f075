"""Joint angles and torso displacement over time, activity by activity.

Equations: paper, "Human Kinematic Model", as docs/physics/model.md corrects it: theta_i turns
the link that ends at joint i; the seat keeps the feet where they are; the gait fades in and out.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import inf, pi
from typing import TypeAlias

import numpy as np

from radhar_cli.motion.paper.progress import progress, progress_integral
from radhar_cli.numerics.arrays import Float

LYING_HEIGHT = 0.15


@dataclass(frozen=True)
class PaperGait:
    """Speed and swings of the limbs of the paper's model."""

    frequency: float  # Hz
    # thigh, calf, arm: amplitudes of the joint angles, rad
    thigh: float
    calf: float
    arm: float
    turn: float  # amplitude of the body's turn in S7, rad
    speed: float  # m/s


@dataclass(frozen=True)
class Timing:
    """Beginnings and durations of the phases of an activity, s."""

    seat_start: float
    seat_duration: float
    rise_start: float
    rise_duration: float
    walk_start: float
    walk_stop: float
    sit_duration: float
    fall_duration: float
    blend: float


@dataclass
class Posture:
    """Posture of the body in an activity at times t [M]."""

    # {joint name: theta [M]} in rad; joints that are not named do not turn
    angles: dict[str, Float] = field(default_factory=dict)
    travelled: Float | float = 0.0  # path of the torso along the motion angle [M], m
    seated: Float | float = 0.0  # fraction of the seat taken, 0 standing, 1 seated [M]
    pitch: Float | float = 0.0  # global pitch about y [M], rad
    lying: Float | float = 0.0  # fraction of the way from standing height to lying height [M]
    twist: Float | float = 0.0  # yaw beyond the motion angle [M], rad


def _punching(t: Float, gait: PaperGait, timing: Timing) -> Posture:
    phase = 2 * pi * gait.frequency * t
    swing, stretch = gait.arm * np.sin(phase), gait.calf * np.cos(phase)
    return Posture(
        angles={
            "right_elbow": -pi / 4 - swing,
            "right_hand": -pi / 2 - stretch,
            "left_elbow": -pi / 4 + swing,
            "left_hand": -pi / 2 + stretch,
        }
    )


def _kicking(t: Float, gait: PaperGait, timing: Timing) -> Posture:
    swing = np.sin(2 * pi * gait.frequency * t)
    return Posture(
        angles={"right_knee": gait.thigh * swing, "right_ankle": pi / 6 + gait.calf * swing}
    )


def _grabbing(t: Float, gait: PaperGait, timing: Timing) -> Posture:
    """Posture of S4: the hip turns back by as much as the torso bends, so the feet stay planted."""
    bow = 1 - np.cos(2 * pi * gait.frequency * t)
    return Posture(
        angles={
            "torso": pi / 2 * bow,
            "right_elbow": -pi / 2 * bow,
            "left_elbow": -pi / 3 * bow,
            "left_hand": -pi / 12 * bow,
            "hip": -pi / 2 * bow,
        }
    )


def _body_rotating(t: Float, gait: PaperGait, timing: Timing) -> Posture:
    return Posture(twist=gait.turn * np.sin(2 * pi * gait.frequency * t))


def _swing(t: Float, gait: PaperGait, strength: Float | float) -> dict[str, Float]:
    """Joint angles {joint: [M]} of S8, rad; t [M] counts from the start of the gait."""
    phase = 2 * pi * gait.frequency * t
    thigh = strength * gait.thigh * np.sin(phase)
    calf = strength * gait.calf * np.sin(phase + pi / 4)
    arm = strength * gait.arm * np.sin(phase + pi)
    return {
        "right_knee": thigh,
        "left_knee": -thigh,
        "right_ankle": calf,
        "left_ankle": -calf,
        "right_elbow": arm,
        "left_elbow": -arm,
    }


def _walking(t: Float, gait: PaperGait, timing: Timing) -> Posture:
    """Posture of S8: all limbs swing and the torso goes on at the same speed."""
    return Posture(angles=_swing(t, gait, 1.0), travelled=gait.speed * t)


Postures: TypeAlias = Callable[[Float, PaperGait, Timing], Posture]
Instants: TypeAlias = Callable[[Timing], tuple[tuple[float, float], ...]]
Phases: TypeAlias = Callable[[Timing], tuple[tuple[float, str], ...]]


@dataclass(frozen=True)
class PaperActivity:
    """Posture, phases and ramps of one activity in the paper's model."""

    posture: Postures  # what it asks of the body at times t [M] (s)
    phases: Phases  # (start in s, name) of the movements within it (`motion.phases.PHASES`)
    ramps: Instants = lambda timing: ()  # (start, duration) in s of its raised-cosine ramps
    swings: bool = False  # whether limbs swing at the gait frequency

    def breakpoints(self, timing: Timing) -> tuple[float, ...]:
        """Instants (s) at which the acceleration, or more, jumps: both ends of every ramp."""
        ends = {end for start, length in self.ramps(timing) for end in (start, start + length)}
        return tuple(sorted(ends))

    def highest_frequency(self, gait: PaperGait, timing: Timing) -> float:
        """Fundamental of the fastest motion, Hz: the gait or the shortest ramp."""
        ramps = [0.5 / length for _, length in self.ramps(timing) if length > 0]
        return max([0.0, *ramps, *([gait.frequency] if self.swings else [])])


def _repeating_activity(posture: Postures, phase: str, swings: bool = True) -> PaperActivity:
    """S1 to S4, S7 and S8, in which the body does the same all the time."""
    return PaperActivity(posture, lambda timing: ((-inf, phase),), swings=swings)


def _seat_activity(leaves: bool, before: str, moving: str, after: str) -> PaperActivity:
    """S5 and S6, in which the body takes a seat or leaves it."""

    def posture(t: Float, gait: PaperGait, timing: Timing) -> Posture:
        share = progress(t, timing.seat_start, timing.seat_duration)
        return Posture(seated=1 - share if leaves else share)

    def phases(timing: Timing) -> tuple[tuple[float, str], ...]:
        start, end = timing.seat_start, timing.seat_start + timing.seat_duration
        return (-inf, before), (start, moving), (end, after)

    return PaperActivity(posture, phases, lambda t: ((t.seat_start, t.seat_duration),))


def _rising_activity(down: Callable[[Float], Posture], before: str, moving: str) -> PaperActivity:
    """S9 and S11: up from seat or floor into a gait whose time and ramp start at `walk_start`."""

    def posture(t: Float, gait: PaperGait, timing: Timing) -> Posture:
        body = down(1 - progress(t, timing.rise_start, timing.rise_duration))
        share = progress(t, timing.walk_start, timing.blend)
        body.angles = _swing(t - timing.walk_start, gait, share)
        body.travelled = gait.speed * progress_integral(t, timing.walk_start, timing.blend)
        return body

    def phases(timing: Timing) -> tuple[tuple[float, str], ...]:
        risen = timing.rise_start + timing.rise_duration
        rising = (timing.rise_start, moving), (risen, "standing")
        return (-inf, before), *rising, (timing.walk_start, "walking")

    def ramps(timing: Timing) -> tuple[tuple[float, float], ...]:
        return (timing.rise_start, timing.rise_duration), (timing.walk_start, timing.blend)

    return PaperActivity(posture, phases, ramps, swings=True)


def _stopping_activity(
    down: Callable[[Float], Posture], takes: Callable[[Timing], float], moving: str, after: str
) -> PaperActivity:
    """S10 and S12: a gait that fades out from `walk_stop` on, onto the seat or the floor."""

    def posture(t: Float, gait: PaperGait, timing: Timing) -> Posture:
        body = down(progress(t, timing.walk_stop, takes(timing)))
        share = progress(t, timing.walk_stop, timing.blend)
        body.angles = _swing(t, gait, 1 - share)
        body.travelled = gait.speed * (t - progress_integral(t, timing.walk_stop, timing.blend))
        return body

    def phases(timing: Timing) -> tuple[tuple[float, str], ...]:
        end = timing.walk_stop + max(takes(timing), timing.blend)
        return (-inf, "walking"), (timing.walk_stop, moving), (end, after)

    def ramps(timing: Timing) -> tuple[tuple[float, float], ...]:
        return (timing.walk_stop, takes(timing)), (timing.walk_stop, timing.blend)

    return PaperActivity(posture, phases, ramps, swings=True)


def _seated(share: Float) -> Posture:
    return Posture(seated=share)


def _lying(share: Float) -> Posture:
    return Posture(pitch=pi / 2 * share, lying=share)


PAPER_ACTIVITIES: dict[str, PaperActivity] = {
    "stationary": _repeating_activity(lambda *_: Posture(), "standing", swings=False),
    "punching": _repeating_activity(_punching, "punching"),
    "kicking": _repeating_activity(_kicking, "kicking"),
    "grabbing": _repeating_activity(_grabbing, "picking up"),
    "sitting_down": _seat_activity(False, "standing", "sitting down", "seated"),
    "standing_up": _seat_activity(True, "seated", "standing up", "standing"),
    "body_rotating": _repeating_activity(_body_rotating, "turning"),
    "walking": _repeating_activity(_walking, "walking"),
    "sitting_to_walking": _rising_activity(_seated, "seated", "standing up"),
    "walking_to_sitting": _stopping_activity(
        _seated, lambda timing: timing.sit_duration, "sitting down", "seated"
    ),
    "falling_to_walking": _rising_activity(_lying, "lying", "getting up"),
    "walking_to_falling": _stopping_activity(
        _lying, lambda timing: timing.fall_duration, "falling", "lying"
    ),
}
