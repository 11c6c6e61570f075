"""Track of the torso, from range-Doppler maps of a recording.

The strongest peaks of each frame's power over range and Doppler are candidates. Dynamic programming
(Viterbi) chooses the ridge: strong candidates, each within reach of the one before by its range and
radial velocity, with an acceleration that a torso can have; limbs are faster and change faster.
Frames without such a candidate are bridged. A Kalman filter with the smoother of Rauch, Tung and
Striebel (AIAA Journal 3, 1965) then weighs ranges and velocities of the ridge.
"""

from dataclasses import dataclass
from math import inf, sqrt
from typing import NamedTuple

import numpy as np
import scipy.fft
from scipy.ndimage import maximum_filter, uniform_filter
from scipy.special import gammaincc, gammainccinv, gammaincinv

from radhar_cli.numerics.arrays import Bool, Complex, Float, Index
from radhar_cli.processing.track import Track
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT, Waveform
from radhar_cli.radar.pulse_times import PulseTimes

WINDOW_S = 0.16  # of the tracker's frames
OVERLAP = 0.5
CANDIDATES = 8
ACCELERATION = 4.0  # standard deviation of a torso's, m/s^2: the ripple of a gait
CHANGE_MPS = 1.5  # standard deviation of the change of velocity after any time
MAX_SPEED_MPS = 3.0  # of a torso
MAX_GAP_S = 1.0  # longest gap that is bridged
RANGE_SD_M = 0.1  # of a peak about the middle of a torso, in addition to the resolution
SMOOTHED_MPS = 0.1  # half width of the smoothing over velocity: a torso is extended
NEAR_M = 1.0  # distance from the track within which power counts as the person's
FALSE_ALARMS = 1e-6  # probability per cell of white noise
MIN_FRAMES, MIN_SHARE = 2, 0.05  # frames of a ridge, and their share of all
MISS = 3.0  # cost of a frame without a candidate on the ridge: that of a jump by 2.4 deviations
REWARD_DB = 5.0  # decibels that outweigh a jump by 1.4 deviations
MAX_DB = 60.0  # of the strongest candidate of a frame: others are below it by their power
SURE = 0.5  # confidence from which a frame's range is taken for the person's
MAX_UNSURE = 0.25  # share of unsure frames of a reliable track
HANN_CELLS = 35 / 18  # neighbours alike, of Hann's window along each of two axes
MIN_VELOCITY_SD_MPS = 0.02  # of a peak, however long the frame


class Peaks(NamedTuple):
    """Candidates of the torso in a frame, strongest first, each [C]."""

    range: Float  # m
    velocity: Float  # radial, receding, m/s
    snr: Float  # power relative to the floor


class PeakErrors(NamedTuple):
    """Standard deviations of a peak about the middle of a torso."""

    range_m: float
    velocity_mps: float  # half a Doppler cell, lambda/(4 T) of a frame of T seconds


@dataclass(frozen=True)
class TorsoTrack(Track):
    """Track of the torso through a recording."""

    time: Float  # middles of the frames [F], s
    range: Float  # m [F]
    velocity: Float  # radial, receding, m/s [F]
    # 0 to 1 [F]: the share of the frame's moving power, above the noise, within a metre of the
    # track; low where noise alone may have as much power, 0 in a frame that was bridged
    confidence: Float
    limits: tuple[float, float] = (0.0, inf)  # of the range axis, which the torso does not leave

    @property
    def is_sure(self) -> Bool:
        """Whether the confidence of each frame suffices [F]."""
        return self.confidence >= SURE

    @property
    def is_reliable(self) -> bool:
        """Whether the confidence suffices in most frames; if not, the person may be elsewhere."""
        return float(np.mean(~self.is_sure)) <= MAX_UNSURE

    def range_at(self, t: Float) -> Float:
        """Range (m) at times t (s): cubic between frames, straight beyond, within the limits."""
        from scipy.interpolate import CubicHermiteSpline

        inside = np.clip(t, self.time[0], self.time[-1])
        position = np.full(t.shape, self.range[0])
        if self.time.size > 1:
            position = CubicHermiteSpline(self.time, self.range, self.velocity)(inside)
        edge = np.where(t < self.time[0], self.velocity[0], self.velocity[-1])
        return np.asarray(np.clip(position + edge * (t - inside), *self.limits), dtype=float)

    def delay_at(self, t: Float) -> Float:
        """Two-way delay (s) at times t (s)."""
        return self.range_at(t) * (2 / SPEED_OF_LIGHT)


def without_static(bins: Complex) -> Complex:
    """Remove static echoes: range bins [..., pulse] less their mean over the pulses."""
    moving: Complex = bins - bins.mean(axis=-1, keepdims=True)
    return moving


def hann_in_range(bins: Complex) -> Complex:
    """Range bins [..., bin, pulse] as if Hann's window had been applied to the chirp.

    x_k/2 - (x_(k-1) + x_(k+1))/4, of bins referred to the chirp's start and not padded: without it
    the sidelobes of a strong torso are candidates all along the range.
    """
    out = 0.5 * bins
    out[..., 1:, :] -= 0.25 * bins[..., :-1, :]
    out[..., :-1, :] -= 0.25 * bins[..., 1:, :]
    return out


def track_torso(bins: Complex, segments: PulseTimes, waveform: Waveform) -> TorsoTrack | None:
    """Track the torso through a recording; None if nothing moves.

    Frames have 0.16 s, less where segments are shorter, and never cross a gap.

    Args:
        bins: range bins [receiver, bin, pulse] with static echoes removed.
        segments: times of the pulses.
        waveform: waveform; its range axis is that of the bins.
    """
    length = min(max(round(WINDOW_S * segments.prf), 8), int(segments.lengths.max()))
    if length < 2:  # a single pulse has no Doppler
        return None
    hop = max(round((1 - OVERLAP) * length), 1)
    window = np.hanning(length + 2)[1:-1]
    doppler = np.fft.fftshift(np.fft.fftfreq(length, 1 / segments.prf))[::-1]
    speeds = -doppler * SPEED_OF_LIGHT / (2 * waveform.f0)
    ranges = waveform.range_axis()
    peaks_of_frames, time = list[Peaks](), list[float]()
    profiles, least = list[Float](), list[float]()
    for part in segments.slices:
        for start in range(part.start, part.stop - length + 1, hop):
            frame = bins[:, :, start : start + length]
            frame = hann_in_range(frame) if waveform.orthogonal else frame
            power = np.square(np.abs(scipy.fft.fft(frame * window, axis=2))).sum(axis=0)
            # Approaching is positive Doppler, receding positive velocity: the axis is reversed.
            power = np.fft.fftshift(power, axes=1)[:, ::-1]
            peaks_of_frames.append(peaks(power, ranges, speeds, len(bins)))
            profiles.append(moving_power(power, len(bins)))
            least.append(least_power(power, len(bins)))
            time.append(float(segments.times(np.array(start))) + (length - 1) / 2 / segments.prf)
    times = np.array(time)
    spacing = float(ranges[1] - ranges[0]) if ranges.size > 1 else RANGE_SD_M
    cell = SPEED_OF_LIGHT * segments.prf / (2 * waveform.f0 * length)
    errors = PeakErrors(
        float(np.hypot(spacing / 2, RANGE_SD_M)), max(cell / 2, MIN_VELOCITY_SD_MPS)
    )
    ridge = _ridge(peaks_of_frames, times, errors)
    if np.count_nonzero(ridge >= 0) < max(MIN_FRAMES, MIN_SHARE * ridge.size):
        return None
    measured = np.full((ridge.size, 2), np.nan)
    for f in np.flatnonzero(ridge >= 0).tolist():
        measured[f] = peaks_of_frames[f].range[ridge[f]], peaks_of_frames[f].velocity[ridge[f]]
    position, velocity = _smooth_track(measured, times, errors)
    profile = np.array(profiles)
    near = np.where(np.abs(ranges - position[:, None]) <= NEAR_M, profile, 0).sum(axis=1)
    total = np.maximum(profile.sum(axis=1), least)
    share = np.where((ridge >= 0) & (total > 0), near / np.where(total > 0, total, 1), 0.0)
    share = np.clip(share, 0.0, 1.0)  # what noise leaves may be negative
    limits = max(float(ranges[0]), 0.0), float(ranges[-1])
    return TorsoTrack(times, np.clip(position, *limits), velocity, share, limits)


class Excess(NamedTuple):
    """Mean and deviation of what a cell of noise has above twice the median, per median."""

    mean: float
    deviation: float

    @classmethod
    def of_noise(cls, looks: int) -> "Excess":
        """Excess of noise of R receivers: x = max(p - 2 m, 0) of a gamma distribution of shape R.

        With q_n = Q(R + n, 2 m), E[x] = R q_1 - 2 m q_0 and
        E[x^2] = R (R + 1) q_2 - 4 m R q_1 + 4 m^2 q_0.
        """
        median = float(gammaincinv(looks, 0.5))
        q = [float(gammaincc(looks + n, 2 * median)) for n in range(3)]
        mean = looks * q[1] - 2 * median * q[0]
        square = looks * (looks + 1) * q[2] - 4 * median * looks * q[1] + 4 * median**2 * q[0]
        return cls(mean / median, sqrt(square - mean**2) / median)


def moving_power(power: Float, looks: int = 1) -> Float:
    """Power of a frame above its floor, over range [K]; that of white noise alone is 0 on average.

    Cells of more than twice the median of all cells count.

    Args:
        power: power [range, velocity], the sum of `looks` receivers.
        looks: number of receivers, whose noise is independent.
    """
    floor = float(np.median(power))
    of_noise = Excess.of_noise(looks).mean * floor * power.shape[1]
    profile: Float = np.maximum(power - 2 * floor, 0).sum(axis=1) - of_noise
    return profile


def least_power(power: Float, looks: int = 1) -> float:
    """Moving power of a frame that noise alone hardly has: three deviations of its sum.

    Hann's windows over range and pulses make neighbours alike, as if cells were fewer.

    Args:
        power: power [range, velocity], the sum of `looks` receivers.
        looks: number of receivers, whose noise is independent.
    """
    deviation = Excess.of_noise(looks).deviation * float(np.median(power))
    return 3 * deviation * HANN_CELLS * sqrt(power.size)


def peaks(power: Float, ranges: Float, speeds: Float, looks: int = 1) -> Peaks:
    """Find the strongest peaks of a frame's power, relative to its floor: the median of all cells.

    Args:
        power: power [range, velocity], the sum of `looks` receivers.
        ranges: ranges of the rows, m.
        speeds: velocities of the columns, m/s.
        looks: number of receivers, whose noise is independent.
    """
    step = speeds[1] - speeds[0] if speeds.size > 1 else 1.0
    wide = 2 * round(SMOOTHED_MPS / step) + 1
    smooth = uniform_filter(power, (1, min(wide, speeds.size)), mode=("nearest", "wrap"))
    floor = float(np.median(smooth))
    # The mean of n cells of white noise has a gamma distribution; Hann's window halves n.
    shape = looks * max(wide / 2, 1)
    least = floor * gammainccinv(shape, FALSE_ALARMS) / gammainccinv(shape, 0.5)
    top = (smooth == maximum_filter(smooth, (3, max(wide, 3)), mode=("nearest", "wrap"))) & (
        smooth > least
    )
    rows, columns = np.nonzero(top)
    order = np.argsort(smooth[rows, columns])[::-1][:CANDIDATES]
    rows, columns = rows[order], columns[order]
    between = _vertex(smooth, rows, columns)
    spacing = ranges[1] - ranges[0] if ranges.size > 1 else 0.0
    snr = smooth[rows, columns] / floor if floor > 0 else np.full(rows.size, 10 ** (MAX_DB / 10))
    # A velocity is known except for multiples of PRF lambda/2, and to half a cell.
    turns = round(MAX_SPEED_MPS / (step * speeds.size) + 0.5)
    velocity = np.add.outer(np.arange(-turns, turns + 1) * step * speeds.size, speeds[columns])
    turn, peak = np.nonzero(np.abs(velocity) <= MAX_SPEED_MPS + step / 2)
    chosen = np.clip(velocity[turn, peak], -MAX_SPEED_MPS, MAX_SPEED_MPS)
    return Peaks((ranges[rows] + between * spacing)[peak], chosen, snr[peak])


def _vertex(power: Float, rows: Index, columns: Index) -> Float:
    """Offset (rows) of the vertex of the parabola through each peak in dB and its neighbours."""
    last, least = len(power) - 1, np.finfo(float).tiny
    low, mid, high = (
        np.log(np.maximum(power[np.clip(rows + shift, 0, last), columns], least))
        for shift in (-1, 0, 1)
    )
    curve = low - 2 * mid + high
    inside = (rows > 0) & (rows < last) & (curve < 0)
    shift = np.where(inside, 0.5 * (low - high) / np.where(curve < 0, curve, 1), 0)
    return np.clip(shift, -0.5, 0.5)


def _rewards(snr: Float) -> Float:
    """Rewards of a frame's candidates [C], of which the strongest has that of MAX_DB at most.

    The others stay below it by the ratio of their powers. A foot that rests for a step is in the
    mean that was taken out as static, and stands ever after, or before, as a faint echo at rest.
    If each candidate had a limit of its own, in a recording without noise the echo would be worth
    as much as the torso, and is easier to follow.
    """
    decibels = 10 * np.log10(np.maximum(snr, 1))
    above = max(float(decibels.max(initial=0.0)) - MAX_DB, 0.0)
    rewards: Float = np.maximum(decibels - above, 0) / REWARD_DB
    return rewards


def _ridge(peaks_of_frames: list[Peaks], time: Float, errors: PeakErrors) -> Index:
    """Choose a candidate of each frame by dynamic programming [F], -1 where it is bridged."""
    scores: list[Float] = []
    predecessors: list[list[tuple[int, int]]] = []
    best_score = 0.0
    frame, candidate = -1, -1
    for f, now in enumerate(peaks_of_frames):
        reward = _rewards(now.snr)
        score = reward.copy()  # the ridge may begin here
        previous = [(-1, -1)] * reward.size
        for back in range(f - 1, -1, -1):
            dt = time[f] - time[back]
            if dt > MAX_GAP_S and back < f - 1:
                break
            before = peaks_of_frames[back]
            if not before.range.size or not reward.size:
                continue
            cost = _cost(before, now, dt, errors) + MISS * (f - 1 - back)
            total = scores[back][:, None] - cost
            chosen = total.argmax(axis=0)
            through = total[chosen, np.arange(reward.size)] + reward
            for c in np.flatnonzero(through > score).tolist():
                score[c], previous[c] = through[c], (back, int(chosen[c]))
        scores.append(score)
        predecessors.append(previous)
        for c, value in enumerate(score.tolist()):
            if value > best_score:
                best_score = value
                frame, candidate = f, c
    ridge = np.full(len(peaks_of_frames), -1)
    while frame >= 0:
        ridge[frame] = candidate
        frame, candidate = predecessors[frame][candidate]
    return ridge


def _cost(before: Peaks, now: Peaks, dt: float, errors: PeakErrors) -> Float:
    """Cost of a step [before, now]: half the squared normalised deviations in range and velocity.

    It is infinite where nobody walks that fast. The mean of two velocities, each wrong by half a
    Doppler cell, foretells the range no better than that: frames of 16 ms at 2 GHz have cells of
    4.7 m/s, and their velocities say nothing.
    """
    change = now.velocity - before.velocity[:, None]
    mean = before.velocity[:, None] + change / 2
    range_change = now.range - before.range[:, None]
    deviation = range_change - mean * dt
    velocity_sd = min(ACCELERATION * dt, CHANGE_MPS)
    spread = np.hypot(errors.range_m, np.hypot(velocity_sd / 2, errors.velocity_mps) * dt)
    change_sd = np.hypot(velocity_sd, max(sqrt(2) * errors.velocity_mps, 0.1))
    cost: Float = (deviation / spread) ** 2 + (change / change_sd) ** 2
    too_far = np.abs(range_change) > MAX_SPEED_MPS * dt + 3 * errors.range_m
    return np.where(too_far, np.inf, cost / 2)


def _smooth_track(measured: Float, time: Float, errors: PeakErrors) -> tuple[Float, Float]:
    """Smooth ranges and velocities by Kalman filter and Rauch-Tung-Striebel smoother.

    Args:
        measured: (range, velocity) [F, 2], m and m/s; NaN in frames without a measurement.
        time: middles of the frames [F], s.
        errors: standard deviations of a measured range and velocity.

    Returns:
        Range and velocity [F].
    """
    first = int(np.flatnonzero(np.isfinite(measured[:, 0]))[0])
    state, spread, noise = measured[first], np.eye(2), np.diag(np.square(errors))
    states, spreads, ahead, ahead_spreads, steps = [], [], [], [], []
    for f in range(first, len(time)):
        dt = time[f] - time[f - 1] if f > first else 0.0
        step = np.array([[1.0, dt], [0.0, 1.0]])
        grown = ACCELERATION**2 * np.array([[dt**4 / 4, dt**3 / 2], [dt**3 / 2, dt**2]])
        state, spread = step @ state, step @ spread @ step.T + grown
        steps.append(step)
        ahead.append(state)
        ahead_spreads.append(spread)
        if np.isfinite(measured[f, 0]):
            gain = spread @ np.linalg.inv(spread + noise)
            state = state + gain @ (measured[f] - state)
            spread = (np.eye(2) - gain) @ spread
        states.append(state)
        spreads.append(spread)
    for n in range(len(states) - 2, -1, -1):
        gain = spreads[n] @ steps[n + 1].T @ np.linalg.inv(ahead_spreads[n + 1])
        states[n] = states[n] + gain @ (states[n + 1] - ahead[n + 1])
    position, velocity = np.array(states).T
    before = position[0] + velocity[0] * (time[:first] - time[first])
    return np.append(before, position), np.append(np.full(first, velocity[0]), velocity)
