"""Joint angles and torso displacement over time, activity by activity.

Equations: paper, "Human Kinematic Model", as docs/physics/model.md corrects it: theta_i turns
the link that ends at joint i; the seat keeps the feet where they are; the gait fades in and out.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import inf, pi
from typing import TypeAlias

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.motion.paper.progress import progress, progress_integral

LYING_HEIGHT = 0.15


@dataclass(frozen=True)
class Gait:
    """How fast and how far the limbs swing: Hz, rad, m/s."""

    frequency: float
    thigh: float
    calf: float
    arm: float
    turn: float
    speed: float


@dataclass(frozen=True)
class Timing:
    """When phases begin and how long they last, all in s."""

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
    """What an activity asks of the body at times t [M]."""

    # {joint name: theta [M]} in rad; joints left out do not turn
    angles: dict[str, Float] = field(default_factory=dict)
    travelled: Float | float = 0.0  # path of the torso along the motion angle [M], m
    seated: Float | float = 0.0  # fraction of the seat taken, 0 standing, 1 seated [M]
    pitch: Float | float = 0.0  # global pitch about y [M], rad
    lying: Float | float = 0.0  # fraction of the way from standing height to lying height [M]
    twist: Float | float = 0.0  # yaw beyond the motion angle [M], rad


def _stationary(t: Float, gait: Gait, timing: Timing) -> Posture:
    return Posture()


def _punching(t: Float, gait: Gait, timing: Timing) -> Posture:
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


def _kicking(t: Float, gait: Gait, timing: Timing) -> Posture:
    swing = np.sin(2 * pi * gait.frequency * t)
    return Posture(
        angles={"right_knee": gait.thigh * swing, "right_ankle": pi / 6 + gait.calf * swing}
    )


def _grabbing(t: Float, gait: Gait, timing: Timing) -> Posture:
    """S4: the hip turns back by as much as the torso bends, so the feet stay planted."""
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


def _sitting_down(t: Float, gait: Gait, timing: Timing) -> Posture:
    return Posture(seated=progress(t, timing.seat_start, timing.seat_duration))


def _standing_up(t: Float, gait: Gait, timing: Timing) -> Posture:
    return Posture(seated=1 - progress(t, timing.seat_start, timing.seat_duration))


def _body_rotating(t: Float, gait: Gait, timing: Timing) -> Posture:
    return Posture(twist=gait.turn * np.sin(2 * pi * gait.frequency * t))


def _swing(t: Float, gait: Gait, strength: Float | float) -> dict[str, Float]:
    """Angles of S8, t counted from the start of the gait, scaled by `strength`."""
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


def _walking(t: Float, gait: Gait, timing: Timing) -> Posture:
    """S8."""
    return Posture(angles=_swing(t, gait, 1.0), travelled=gait.speed * t)


def _walk_from(t: Float, gait: Gait, timing: Timing, posture: Posture) -> Posture:
    """Add a gait whose time and ramp start at `walk_start` (S9, S11)."""
    on = progress(t, timing.walk_start, timing.blend)
    posture.angles = _swing(t - timing.walk_start, gait, on)
    posture.travelled = gait.speed * progress_integral(t, timing.walk_start, timing.blend)
    return posture


def _walk_until(t: Float, gait: Gait, timing: Timing, posture: Posture) -> Posture:
    """Add a gait that runs from t = 0 and fades out from `walk_stop` on (S10, S12)."""
    off = progress(t, timing.walk_stop, timing.blend)
    posture.angles = _swing(t, gait, 1 - off)
    posture.travelled = gait.speed * (t - progress_integral(t, timing.walk_stop, timing.blend))
    return posture


def _sitting_to_walking(t: Float, gait: Gait, timing: Timing) -> Posture:
    """S9."""
    risen = progress(t, timing.rise_start, timing.rise_duration)
    return _walk_from(t, gait, timing, Posture(seated=1 - risen))


def _walking_to_sitting(t: Float, gait: Gait, timing: Timing) -> Posture:
    """S10."""
    seated = progress(t, timing.walk_stop, timing.sit_duration)
    return _walk_until(t, gait, timing, Posture(seated=seated))


def _falling_to_walking(t: Float, gait: Gait, timing: Timing) -> Posture:
    """S11."""
    lying = 1 - progress(t, timing.rise_start, timing.rise_duration)
    return _walk_from(t, gait, timing, Posture(pitch=pi / 2 * lying, lying=lying))


def _walking_to_falling(t: Float, gait: Gait, timing: Timing) -> Posture:
    """S12."""
    lying = progress(t, timing.walk_stop, timing.fall_duration)
    return _walk_until(t, gait, timing, Posture(pitch=pi / 2 * lying, lying=lying))


Instants: TypeAlias = Callable[[Timing], tuple[tuple[float, float], ...]]
Phases: TypeAlias = Callable[[Timing], tuple[tuple[float, str], ...]]


@dataclass(frozen=True)
class PaperActivity:
    """How the paper moves a body in one activity."""

    posture: Callable[[Float, Gait, Timing], Posture]  # what it asks of the body at times t [M] (s)
    phases: Phases  # (start in s, name) of the movements within it (`motion.phases.PHASES`)
    ramps: Instants = lambda timing: ()  # (start, duration) in s of its raised-cosine ramps
    swings: bool = False  # whether limbs swing at the gait frequency

    def breakpoints(self, timing: Timing) -> tuple[float, ...]:
        """Instants (s) at which the acceleration, or more, jumps: both ends of every ramp."""
        ends = {at for start, length in self.ramps(timing) for at in (start, start + length)}
        return tuple(sorted(ends))

    def highest_frequency(self, gait: Gait, timing: Timing) -> float:
        """Fundamental (Hz) of the fastest motion: the gait or the shortest ramp."""
        ramps = [0.5 / length for _, length in self.ramps(timing) if length > 0]
        return max([0.0, *ramps, *([gait.frequency] if self.swings else [])])


def _always(name: str) -> Phases:
    return lambda timing: ((-inf, name),)


def _seat_phases(before: str, moving: str, after: str) -> Phases:
    return lambda timing: (
        (-inf, before),
        (timing.seat_start, moving),
        (timing.seat_start + timing.seat_duration, after),
    )


def _seat_ramp(timing: Timing) -> tuple[tuple[float, float], ...]:
    return ((timing.seat_start, timing.seat_duration),)


def _rise_ramps(timing: Timing) -> tuple[tuple[float, float], ...]:
    return (timing.rise_start, timing.rise_duration), (timing.walk_start, timing.blend)


def _rise_phases(before: str, rising: str) -> Phases:
    return lambda timing: (
        (-inf, before),
        (timing.rise_start, rising),
        (timing.rise_start + timing.rise_duration, "standing"),
        (timing.walk_start, "walking"),
    )


def _stop_ramps(length: Callable[[Timing], float]) -> Instants:
    return lambda timing: ((timing.walk_stop, length(timing)), (timing.walk_stop, timing.blend))


def _stop_phases(length: Callable[[Timing], float], moving: str, after: str) -> Phases:
    return lambda timing: (
        (-inf, "walking"),
        (timing.walk_stop, moving),
        (timing.walk_stop + max(length(timing), timing.blend), after),
    )


def _sit(timing: Timing) -> float:
    return timing.sit_duration


def _fall(timing: Timing) -> float:
    return timing.fall_duration


PAPER_ACTIVITIES: dict[str, PaperActivity] = {
    "stationary": PaperActivity(_stationary, _always("standing")),
    "punching": PaperActivity(_punching, _always("punching"), swings=True),
    "kicking": PaperActivity(_kicking, _always("kicking"), swings=True),
    "grabbing": PaperActivity(_grabbing, _always("picking up"), swings=True),
    "sitting_down": PaperActivity(
        _sitting_down, _seat_phases("standing", "sitting down", "seated"), _seat_ramp
    ),
    "standing_up": PaperActivity(
        _standing_up, _seat_phases("seated", "standing up", "standing"), _seat_ramp
    ),
    "body_rotating": PaperActivity(_body_rotating, _always("turning"), swings=True),
    "walking": PaperActivity(_walking, _always("walking"), swings=True),
    "sitting_to_walking": PaperActivity(
        _sitting_to_walking, _rise_phases("seated", "standing up"), _rise_ramps, swings=True
    ),
    "walking_to_sitting": PaperActivity(
        _walking_to_sitting,
        _stop_phases(_sit, "sitting down", "seated"),
        _stop_ramps(_sit),
        swings=True,
    ),
    "falling_to_walking": PaperActivity(
        _falling_to_walking, _rise_phases("lying", "getting up"), _rise_ramps, swings=True
    ),
    "walking_to_falling": PaperActivity(
        _walking_to_falling,
        _stop_phases(_fall, "falling", "lying"),
        _stop_ramps(_fall),
        swings=True,
    ),
}
