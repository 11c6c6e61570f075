"""Frames of points and targets, in radhar's axes: x ahead, y left, z up, approaching positive."""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np

from radhar_cli.numerics.arrays import Float
from radhar_cli.processing.points import COLUMNS
from radhar_cli.radar.frame_timing import FrameTiming

TARGET_COLUMNS = ("track", "x", "y", "z", "vx", "vy", "vz", "ax", "ay", "az", "confidence")
NO_TRACK = -1
FEWEST_TRACKS_OF_NOBODY = 253  # 253 to 255: too weak, outside, noise
LARGEST = 1e6  # m, m/s, dB or bins; what is larger is no measurement


@dataclass(frozen=True)
class RadarSteps:
    """Steps of a board, by which bins of a message are ranges and speeds, and the reverse.

    Attributes:
        range_m: Range bin, m; None where it is unknown.
        speed_mps: Doppler bin, m/s; None where it is unknown.
        bias_m: What the firmware takes off ranges, m.
    """

    range_m: float | None = None
    speed_mps: float | None = None
    bias_m: float = 0.0

    @classmethod
    def of_frames(cls, timing: FrameTiming, bias_m: float = 0.0) -> "RadarSteps":
        """Return the steps that TI's demos take for those of a board.

        The speed of a Doppler bin is that at the frequency where a ramp starts, as the firmware
        has it, and not at the middle of the sampled band: one or two percent larger.
        """
        return cls(timing.range_step_m, timing.doppler_step_mps(timing.start_hz), bias_m)

    def range_bins(self, ranges: Float) -> Float:
        """Range bins [n] of ranges [n], m; NaN where the step is unknown."""
        if self.range_m is None:
            return np.full(len(ranges), np.nan)
        return np.round((ranges + self.bias_m) / self.range_m)

    def doppler_bins(self, speeds: Float) -> Float:
        """Doppler bins [n] of speeds [n], m/s; NaN where the step is unknown."""
        if self.speed_mps is None:
            return np.full(len(speeds), np.nan)
        return np.round(speeds / self.speed_mps)


class PointFrame(NamedTuple):
    """Points of a frame, or of a subframe.

    Attributes:
        number: Number of the frame, as the board counts.
        points: Points [n, 8], columns as COLUMNS; NaN is what the message does not say.
        track: Number of the track that each point belongs to [n]; NO_TRACK for none.
        targets: What the tracker follows [t, 11], columns as TARGET_COLUMNS.
        time: Time on somebody's clock, s; None where nothing says it.
        joints: Places of the thirteen joints [13, 3] in the axes of the points, m, as another
            sensor saw them; None where there was none.
    """

    number: int
    points: Float
    track: Float
    targets: Float
    time: float | None = None
    joints: Float | None = None


@dataclass(frozen=True)
class TiPoints:
    """Points as TI has them: x to the right, y ahead, z up (m), Doppler receding positive (m/s).

    Attributes:
        places: Places [n, 3].
        doppler: Speeds [n].
        intensity: Magnitudes [n], in units of their firmware.
        snr_db: Powers over the noise [n], dB.
        bins: Range bin and receding Doppler bin [n, 2]; None where the message has none.
        track: Number of the track of each [n].
    """

    places: Float
    doppler: Float
    intensity: Float
    snr_db: Float
    bins: Float | None = None
    track: Float = field(default_factory=lambda: np.empty(0))

    @classmethod
    def empty(cls) -> "TiPoints":
        """No points."""
        none = np.empty(0)
        return cls(np.empty((0, 3)), none, none, none)

    def rows(self, steps: RadarSteps) -> Float:
        """Points [n, 8] in radhar's axes; bins of ranges and speeds where the message has none."""
        doppler = -self.doppler
        if self.bins is None:
            range_bins = steps.range_bins(np.linalg.norm(self.places, axis=1))
            doppler_bins = steps.doppler_bins(doppler)
        else:
            range_bins, doppler_bins = self.bins[:, 0], -self.bins[:, 1]
        columns = (in_radhar_axes(self.places), doppler, self.intensity, self.snr_db, range_bins)
        rows = np.column_stack([*columns, doppler_bins]) + 0.0  # never -0
        assert rows.shape[1] == len(COLUMNS)
        return rows

    def tracks(self) -> Float:
        """Number of the track of each point [n], NO_TRACK where none is named."""
        if len(self.track) != len(self.doppler):
            return np.full(len(self.doppler), float(NO_TRACK))
        return tracks_of(self.track)


def tracks_of(numbers: Float) -> Float:
    """Numbers of tracks [n] of those of a message, in which 253 to 255 are nobody."""
    known = (numbers >= 0) & (numbers < FEWEST_TRACKS_OF_NOBODY)
    return np.where(known, numbers, NO_TRACK)


def in_radhar_axes(vectors: Float) -> Float:
    """Vectors [n, 3] of TI's axes (right, ahead, up) in radhar's (ahead, left, up)."""
    return np.column_stack([vectors[:, 1], -vectors[:, 0], vectors[:, 2]]) + 0.0


def make_targets(
    track: Float, place: Float, velocity: Float, acceleration: Float, confidence: Float
) -> Float:
    """Targets [t, 11] of TARGET_COLUMNS.

    Args:
        track: Numbers [t].
        place: Places [t, 3] in TI's axes, m.
        velocity: Velocities [t, 3] in TI's axes, m/s.
        acceleration: Accelerations [t, 3] in TI's axes, m/s^2.
        confidence: Confidences [t]; NaN where the message has none.
    """
    vectors = (in_radhar_axes(vector) for vector in (place, velocity, acceleration))
    return np.column_stack([track, *vectors, confidence])


def no_targets() -> Float:
    """Targets of a frame without any [0, 11]."""
    return np.empty((0, len(TARGET_COLUMNS)))


def amplitude_of(power_db: Float) -> Float:
    """Magnitudes of powers in dB."""
    amplitude: Float = 10 ** (power_db / 20)
    return amplitude


def decibels_of(ratio: Float) -> Float:
    """Ratios of powers in dB; NaN where they are not positive, or unknown."""
    decibels: Float = 10 * np.log10(np.where(ratio > 0, ratio, np.nan))
    return decibels


def are_measurements(values: Float) -> bool:
    """Whether no number is infinite or beyond LARGEST; NaN is unknown."""
    return not (np.abs(values) > LARGEST).any()
