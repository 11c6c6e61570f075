"""Where the torso is, found in range-Doppler maps of a recording.

Frame by frame the strongest peaks of the power over range and Doppler are candidates. Dynamic
programming (Viterbi) chooses the ridge: candidates that are strong and lie where range and radial
velocity of the one before lead to, with an acceleration that a torso can have; limbs are faster and
change faster. Frames without a candidate that fits are bridged. A Kalman filter with the smoother
of Rauch, Tung and Striebel (AIAA Journal 3, 1965) then weighs ranges and velocities of the ridge.
"""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import scipy.fft
from scipy.ndimage import maximum_filter, uniform_filter
from scipy.special import gammainccinv

from radhar_cli.arrays import Complex, Float, Index
from radhar_cli.radar.waveform import SPEED_OF_LIGHT

CANDIDATES = 8
ACCELERATION = 4.0  # standard deviation of a torso's, m/s^2: the ripple of a gait
CHANGE_MPS = 1.5  # standard deviation of the change of velocity after any time
MAX_SPEED_MPS = 3.0  # of a torso
MAX_GAP_S = 1.0  # longest gap that is bridged
RANGE_SD_M = 0.1  # of a peak about the middle of a torso, in addition to the resolution
SMOOTHED_MPS = 0.1  # half width of the smoothing over velocity: a torso is extended
NEAR_M = 1.0  # within this distance of the track a peak is of the person
FALSE_ALARMS = 1e-6  # probability per cell of white noise
MIN_FRAMES, MIN_SHARE = 2, 0.05  # frames of a ridge, and their share of all
MISS = 3.0  # cost of a frame without a candidate on the ridge: that of a jump by 2.4 deviations
REWARD_DB = 5.0  # decibels that outweigh a jump by 1.4 deviations
MAX_DB = 60.0


class Peaks(NamedTuple):
    """Candidates of a frame, strongest first, each [C].

    Attributes:
        range: m.
        velocity: radial, receding, m/s.
        snr: power over the floor.
    """

    range: Float
    velocity: Float
    snr: Float


@dataclass(frozen=True)
class TorsoTrack:
    """The way of the torso.

    Attributes:
        time: middles of the frames [F], s.
        range: m [F].
        velocity: radial, receding, m/s [F].
        confidence: 0 to 1 [F]: the share of what moves in the frame, above the floor, that lies
            within a metre of the track; 0 in a frame that was bridged.
    """

    time: Float
    range: Float
    velocity: Float
    confidence: Float

    def ranges(self, t: Float) -> Float:
        """Range (m) at times t (s): cubic between frames, straight on beyond them."""
        from scipy.interpolate import CubicHermiteSpline

        if self.time.size == 1:
            straight: Float = self.range[0] + self.velocity[0] * (t - self.time[0])
            return straight
        inside = np.clip(t, self.time[0], self.time[-1])
        found: Float = CubicHermiteSpline(self.time, self.range, self.velocity)(inside)
        edge = np.where(t < self.time[0], self.velocity[0], self.velocity[-1])
        return np.asarray(found + edge * (t - inside), dtype=float)

    def delays(self, t: Float) -> Float:
        """Delay (s) there and back at times t (s)."""
        delays: Float = self.ranges(t) * (2 / SPEED_OF_LIGHT)
        return delays


class RangeDoppler(NamedTuple):
    """Power of one frame.

    Attributes:
        power: [range, velocity], summed over receivers.
        time: its middle, s.
    """

    power: Float
    time: float


def hann_in_range(bins: Complex) -> Complex:
    """Range bins [..., bin, pulse] as Hann's window over the chirp would have made them.

    x_k/2 - (x_(k-1) + x_(k+1))/4, of bins referred to the chirp's start and not padded: without it
    the sidelobes of a strong torso are candidates all along the range.
    """
    out = 0.5 * bins
    out[..., 1:, :] -= 0.25 * bins[..., :-1, :]
    out[..., :-1, :] -= 0.25 * bins[..., 1:, :]
    return out


def range_doppler(bins: Complex, window: Float, time: float) -> RangeDoppler:
    """Power over range and radial velocity of one frame of range bins [receiver, bin, pulse]."""
    spectrum = scipy.fft.fft(bins * window, axis=2)
    power = np.square(np.abs(spectrum)).sum(axis=0)
    # Approaching is positive Doppler, receding positive velocity: the axis is turned round.
    return RangeDoppler(np.fft.fftshift(power, axes=1)[:, ::-1], time)


def velocities(pulses: int, prf: float, f0: float) -> Float:
    """Radial velocities (m/s, receding) of the columns of `range_doppler`, rising."""
    doppler = np.fft.fftshift(np.fft.fftfreq(pulses, 1 / prf))[::-1]
    return np.asarray(-doppler * SPEED_OF_LIGHT / (2 * f0))


def peaks(power: Float, ranges: Float, speeds: Float, looks: int = 1) -> Peaks:
    """The strongest peaks of a frame's power over its floor, the median of all cells.

    Args:
        power: [range, velocity], the sum of so many `looks`.
        ranges, speeds: of rows and columns.
        looks: receivers, whose noise is independent.
    """
    step = speeds[1] - speeds[0] if speeds.size > 1 else 1.0
    wide = 2 * round(SMOOTHED_MPS / step) + 1
    smooth = uniform_filter(power, (1, min(wide, speeds.size)), mode=("nearest", "wrap"))
    floor = float(np.median(smooth))
    # Of white noise a mean of n cells has a gamma distribution; Hann's window halves n.
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
    # A velocity is known but for multiples of PRF lambda/2.
    turns = round(MAX_SPEED_MPS / (step * speeds.size) + 0.5)
    velocity = np.add.outer(np.arange(-turns, turns + 1) * step * speeds.size, speeds[columns])
    turn, peak = np.nonzero(np.abs(velocity) <= MAX_SPEED_MPS)
    return Peaks((ranges[rows] + between * spacing)[peak], velocity[turn, peak], snr[peak])


def _vertex(power: Float, rows: Index, columns: Index) -> Float:
    """Of the parabola through the decibels of each peak and its neighbours in range, in rows."""
    last, least = len(power) - 1, np.finfo(float).tiny
    low, mid, high = (
        np.log(np.maximum(power[np.clip(rows + shift, 0, last), columns], least))
        for shift in (-1, 0, 1)
    )
    curve = low - 2 * mid + high
    inside = (rows > 0) & (rows < last) & (curve < 0)
    shift = np.where(inside, 0.5 * (low - high) / np.where(curve < 0, curve, 1), 0)
    return np.clip(shift, -0.5, 0.5)


def find_torso(
    frames: Iterable[RangeDoppler], ranges: Float, speeds: Float, looks: int = 1
) -> TorsoTrack | None:
    """Track the torso through the frames of a recording; None where nothing moves.

    Args:
        frames: in the order of time.
        ranges: of the rows, m, evenly spaced.
        speeds: of the columns, m/s.
        looks: receivers, whose powers a frame adds up.
    """
    found, time, profiles = list[Peaks](), list[float](), list[Float]()
    for frame in frames:
        found.append(peaks(frame.power, ranges, speeds, looks))
        time.append(frame.time)
        floor = np.median(frame.power)
        profiles.append(np.maximum(frame.power - 2 * floor, 0).sum(axis=1))
    times = np.array(time)
    spacing = float(ranges[1] - ranges[0]) if ranges.size > 1 else RANGE_SD_M
    ridge = _ridge(found, times, float(np.hypot(spacing / 2, RANGE_SD_M)))
    if np.count_nonzero(ridge >= 0) < max(MIN_FRAMES, MIN_SHARE * ridge.size):
        return None
    measured = np.array(
        [
            (p.range[c], p.velocity[c]) if c >= 0 else (np.nan, np.nan)
            for p, c in zip(found, ridge, strict=True)
        ]
    )
    sd = np.hypot(spacing / 2, RANGE_SD_M), max(float(speeds[1] - speeds[0]) / 2, 0.02)
    position, velocity = _smoothed(measured, times, sd)
    share = [_share(p, ranges, r) for p, r in zip(profiles, position, strict=True)]
    return TorsoTrack(times, position, velocity, np.where(ridge >= 0, share, 0.0))


def _share(profile: Float, ranges: Float, at: float) -> float:
    total = profile.sum()
    return float(profile[np.abs(ranges - at) <= NEAR_M].sum() / total) if total > 0 else 0.0


def _ridge(found: list[Peaks], time: Float, range_sd: float) -> Index:
    """Number of the chosen candidate of each frame [F], -1 where it is bridged."""
    scores: list[Float] = []
    came: list[list[tuple[int, int]]] = []
    best, at = 0.0, (-1, -1)
    for f, now in enumerate(found):
        reward = np.minimum(10 * np.log10(np.maximum(now.snr, 1)), MAX_DB) / REWARD_DB
        score = reward.copy()  # the ridge may begin here
        previous = [(-1, -1)] * reward.size
        for back in range(f - 1, -1, -1):
            dt = time[f] - time[back]
            if dt > MAX_GAP_S and back < f - 1:
                break
            before = found[back]
            if not before.range.size or not reward.size:
                continue
            cost = _cost(before, now, dt, range_sd) + MISS * (f - 1 - back)
            total = scores[back][:, None] - cost
            chosen = total.argmax(axis=0)
            through = total[chosen, np.arange(reward.size)] + reward
            for c in np.flatnonzero(through > score).tolist():
                score[c], previous[c] = through[c], (back, int(chosen[c]))
        scores.append(score)
        came.append(previous)
        for c, value in enumerate(score.tolist()):
            if value > best:
                best, at = value, (f, c)
    ridge = np.full(len(found), -1)
    while at[0] >= 0:
        ridge[at[0]] = at[1]
        at = came[at[0]][at[1]]
    return ridge


def _cost(before: Peaks, now: Peaks, dt: float, range_sd: float) -> Float:
    """Half the squared deviations in range and velocity [before, now], in standard deviations.

    Farther than anybody walks is no way at all.
    """
    change = now.velocity - before.velocity[:, None]
    mean = before.velocity[:, None] + change / 2
    way = now.range - before.range[:, None]
    off = way - mean * dt
    faster = min(ACCELERATION * dt, CHANGE_MPS)
    spread = np.hypot(range_sd, faster * dt / 2)
    cost: Float = (off / spread) ** 2 + (change / np.hypot(faster, 0.1)) ** 2
    too_far = np.abs(way) > MAX_SPEED_MPS * dt + 3 * range_sd
    return np.where(too_far, np.inf, cost / 2)


def _smoothed(measured: Float, time: Float, sd: tuple[float, float]) -> tuple[Float, Float]:
    """(range, velocity) [F] by filter and smoother; rows of NaN were not measured."""
    count = len(time)
    first = int(np.flatnonzero(np.isfinite(measured[:, 0]))[0])
    state = np.array([measured[first, 0], measured[first, 1]])
    spread = np.diag([1.0, 1.0])
    noise = np.diag(np.square(sd))
    states, spreads, ahead, ahead_spreads = [], [], [], []
    for f in range(count):
        dt = time[f] - time[f - 1] if f else 0.0
        step = np.array([[1.0, dt], [0.0, 1.0]])
        grown = ACCELERATION**2 * np.array([[dt**4 / 4, dt**3 / 2], [dt**3 / 2, dt**2]])
        if f > first:
            state, spread = step @ state, step @ spread @ step.T + grown
        ahead.append(state)
        ahead_spreads.append(spread)
        if np.isfinite(measured[f, 0]):
            gain = spread @ np.linalg.inv(spread + noise)
            state = state + gain @ (measured[f] - state)
            spread = (np.eye(2) - gain) @ spread
        states.append(state)
        spreads.append(spread)
    for f in range(count - 2, -1, -1):
        if f < first:
            dt = time[f + 1] - time[f]
            states[f] = np.array([states[f + 1][0] - dt * states[f + 1][1], states[f + 1][1]])
            continue
        dt = time[f + 1] - time[f]
        step = np.array([[1.0, dt], [0.0, 1.0]])
        gain = spreads[f] @ step.T @ np.linalg.inv(ahead_spreads[f + 1])
        states[f] = states[f] + gain @ (states[f + 1] - ahead[f + 1])
    track = np.array(states)
    return track[:, 0], track[:, 1]
