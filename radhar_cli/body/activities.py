"""Joint angles and torso displacement over time, activity by activity.

Equations: paper, section "Human Kinematic Model", as corrected in ../docs/model.md: theta_i turns
the link that ends at joint i; the seat keeps the feet where they are; the gait fades in and out.
"""

from collections.abc import Callable
from dataclasses import dataclass, field
from math import pi

import numpy as np

from radhar_cli.arrays import Float
from radhar_cli.body.progress import progress, progress_integral

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
    """What an activity asks of the body at times t [M].

    Attributes:
        angles: {joint name: theta [M]} in rad; joints left out do not turn.
        travelled: path of the torso along the motion angle [M], m.
        seated: fraction of the seat taken, 0 standing, 1 seated [M].
        pitch: global pitch about y [M], rad.
        lying: fraction of the way from standing height to lying height [M].
        twist: yaw beyond the motion angle [M], rad.
    """

    angles: dict[str, Float] = field(default_factory=dict)
    travelled: Float | float = 0.0
    seated: Float | float = 0.0
    pitch: Float | float = 0.0
    lying: Float | float = 0.0
    twist: Float | float = 0.0


def _stationary(t: Float, gait: Gait, timing: Timing) -> Posture:
    """S1."""
    return Posture()


def _punching(t: Float, gait: Gait, timing: Timing) -> Posture:
    """S2."""
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
    """S3."""
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
    """S5."""
    return Posture(seated=progress(t, timing.seat_start, timing.seat_duration))


def _standing_up(t: Float, gait: Gait, timing: Timing) -> Posture:
    """S6."""
    return Posture(seated=1 - progress(t, timing.seat_start, timing.seat_duration))


def _body_rotating(t: Float, gait: Gait, timing: Timing) -> Posture:
    """S7."""
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


_POSTURES: dict[int, Callable[[Float, Gait, Timing], Posture]] = {
    1: _stationary,
    2: _punching,
    3: _kicking,
    4: _grabbing,
    5: _sitting_down,
    6: _standing_up,
    7: _body_rotating,
    8: _walking,
    9: _sitting_to_walking,
    10: _walking_to_sitting,
    11: _falling_to_walking,
    12: _walking_to_falling,
}


def posture(number: int, t: Float, gait: Gait, timing: Timing) -> Posture:
    """Return what activity S`number` asks of the body at times t [M] (s)."""
    return _POSTURES[number](t, gait, timing)


def _phases(number: int, timing: Timing) -> list[tuple[float, float]]:
    """(start, duration) of every raised-cosine ramp in an activity."""
    seat = (timing.seat_start, timing.seat_duration)
    rise = [(timing.rise_start, timing.rise_duration), (timing.walk_start, timing.blend)]
    return {
        5: [seat],
        6: [seat],
        9: rise,
        10: [(timing.walk_stop, timing.sit_duration), (timing.walk_stop, timing.blend)],
        11: rise,
        12: [(timing.walk_stop, timing.fall_duration), (timing.walk_stop, timing.blend)],
    }.get(number, [])


def kinks(number: int, timing: Timing) -> tuple[float, ...]:
    """Instants (s) at which the acceleration, or more, jumps: both ends of every ramp."""
    return tuple(
        sorted({at for start, length in _phases(number, timing) for at in (start, start + length)})
    )


def highest_frequency(number: int, gait: Gait, timing: Timing) -> float:
    """Fundamental (Hz) of the fastest motion in an activity: the gait or the shortest ramp."""
    ramps = [0.5 / length for _, length in _phases(number, timing) if length > 0]
    swings = [gait.frequency] if number in (2, 3, 4, 7, 8, 9, 10, 11, 12) else []
    return max([0.0, *ramps, *swings])
