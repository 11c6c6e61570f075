"""What really moved: positions, radial velocities, and which movement is under way."""

from dataclasses import dataclass

import numpy as np

from radhar_cli.arrays import Float, Levels
from radhar_cli.body.activities import Timing
from radhar_cli.body.pose import Body
from radhar_cli.pipeline.body_paths import BodyPaths
from radhar_cli.radar.waveform import SPEED_OF_LIGHT, Waveform

RATE_STEP_S = 1e-5

MOVEMENTS = (
    "the whole activity",
    "seated",
    "standing up",
    "standing",
    "walking",
    "sitting down",
    "lying",
    "getting up",
    "falling",
)


@dataclass(frozen=True)
class Truth:
    """Kinematics at every pulse.

    Attributes:
        time: t_m [M], s.
        positions: [M, 13, 3], m.
        radial_velocity: half the rate of the two-way path [M, 13], m/s, positive receding.
        doppler: -f0 dtau/dt [M, 13], Hz, the wall's delay included, before aliasing.
        phase_label: number in MOVEMENTS of the movement under way [M].
    """

    time: Float
    positions: Float
    radial_velocity: Float
    doppler: Float
    phase_label: Levels


def truth(paths: BodyPaths, waveform: Waveform) -> Truth:
    """Evaluate the kinematics of all 13 scatterers at every pulse."""
    t = waveform.times(np.arange(waveform.n_pulses, dtype=float))
    body = paths.body
    through_air = BodyPaths(body, paths.antennas, paths.fc, None)
    everything = BodyPaths(body, paths.antennas, paths.fc, paths.wall)
    return Truth(
        time=t,
        positions=np.ascontiguousarray(body.positions(t).transpose(2, 1, 0)),
        radial_velocity=SPEED_OF_LIGHT / 2 * _rate(through_air, t),
        doppler=-waveform.f0 * _rate(everything, t),
        phase_label=movement(body, t),
    )


def _rate(paths: BodyPaths, t: Float) -> Float:
    """d tau/dt [M, I] by a central difference."""
    ahead, behind = paths(t + RATE_STEP_S).delay, paths(t - RATE_STEP_S).delay
    rate: Float = (ahead - behind).T / (2 * RATE_STEP_S)
    return rate


def movement(body: Body, t: Float) -> Levels:
    """Number in MOVEMENTS of what is under way at times t [M]."""
    changes = _changes(body.number, body.timing)
    label = np.zeros(t.size, dtype=np.uint8)
    for start, name in changes:
        label[t >= start] = MOVEMENTS.index(name)
    return label


def _changes(number: int, timing: Timing) -> list[tuple[float, str]]:
    start = -np.inf
    risen, stopped = timing.rise_start + timing.rise_duration, timing.walk_stop
    return {
        9: [
            (start, "seated"),
            (timing.rise_start, "standing up"),
            (risen, "standing"),
            (timing.walk_start, "walking"),
        ],
        10: [
            (start, "walking"),
            (stopped, "sitting down"),
            (stopped + max(timing.sit_duration, timing.blend), "seated"),
        ],
        11: [
            (start, "lying"),
            (timing.rise_start, "getting up"),
            (risen, "standing"),
            (timing.walk_start, "walking"),
        ],
        12: [
            (start, "walking"),
            (stopped, "falling"),
            (stopped + max(timing.fall_duration, timing.blend), "lying"),
        ],
    }.get(number, [])
