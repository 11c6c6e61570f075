"""What stands in a room: returns that are there while nobody is near, and how little they move.

A return at range R is A exp(-j 4 pi (R + d(t))/lambda): its modulus tells A, its phase d(t).
Additive noise, white or coloured, shakes modulus and phase alike, a movement the phase alone; so
noise is taken off by what the modulus shows.
"""

from typing import NamedTuple

import numpy as np
import scipy.fft
from scipy.ndimage import maximum_filter1d, minimum_filter1d

from radhar_cli.arrays import Bool, Complex, Float, Index
from radhar_cli.radar.waveform import SPEED_OF_LIGHT, Waveform

SIDELOBES_DB = 120.0  # of the window over the chirp: leakage may be that much stronger
MAIN_LOBE = 5.0  # cells c/(2 B) from its middle to its first zero
BLOCK_S = 0.01  # of pulses that are averaged; slower movements are seen
MIN_SEEN_S = 1.0  # that a range bin has to be seen for
QUARTILE = 0.25
OVER_NOISE = 10.0  # in power: what is no return
OVER_OTHERS = 100.0  # over the lower tenth of all bins: noise that drifts slowly is in all of them
SURE = 4.0  # variance of the phase over that of the modulus from which on something moves
SHARE = 0.95  # of the movement's variance that lies below its highest frequency


class Returns(NamedTuple):
    """What stands still in each range bin [K], NaN where somebody always is near.

    Attributes:
        power: A^2 of a raw sample.
        residual: standard deviation of d, m; 0 where nothing is seen to move.
        highest: frequency below which d moves, Hz; NaN where it does not.
    """

    power: Float
    residual: Float
    highest: Float


def range_window(samples: int) -> Float:
    """Dolph and Chebyshev's window over the chirp [N_ADC], of sum 1."""
    from scipy.signal.windows import chebwin  # slow to import

    window = chebwin(samples, SIDELOBES_DB)
    return np.asarray(window / window.sum())


def returns(bins: Complex, away: Bool, first: Index, prf: float, f0: float) -> Returns:
    """Power and small motion of what stands still.

    Args:
        bins: range bins [K, M] that a path of amplitude A has A in.
        away: whether nobody is near [K, M].
        first: pulse at which each stretch without a gap begins.
        prf: pulses per second within it, Hz.
        f0: frequency at which the Doppler is read, Hz.
    """
    length = max(round(BLOCK_S * prf), 1)
    stops = np.append(first[1:], bins.shape[1])
    starts = np.concatenate(
        [np.arange(a, b - length + 1, length) for a, b in zip(first, stops, strict=True)]
    )
    within = starts[:, None] + np.arange(length)
    z = bins[:, within].mean(axis=2)
    free: Bool = away[:, within].min(axis=2)
    rate, gaps = prf / length, np.diff(starts) != length
    metres = SPEED_OF_LIGHT / (4 * np.pi * f0)
    found = np.full((3, len(bins)), np.nan)
    for k in range(len(bins)):
        if np.count_nonzero(free[k]) < MIN_SEEN_S * rate:
            continue
        found[0, k] = np.quantile(np.abs(z[k, free[k]]) ** 2, QUARTILE)
        there = _longest(free[k], gaps)
        if there.stop - there.start >= MIN_SEEN_S * rate:
            found[1:, k] = _movement(z[k, there], rate)
    return Returns(found[0], metres * found[1], found[2])


def _longest(free: Bool, gaps: Bool) -> slice:
    """The longest run of blocks that are free, with no gap between them."""
    breaks = np.flatnonzero(gaps) + 1
    edges = np.union1d(np.flatnonzero(np.diff(free)) + 1, breaks)
    bounds = np.concatenate([[0], edges, [free.size]])
    lengths = np.diff(bounds) * free[bounds[:-1]]
    best = int(lengths.argmax())
    return slice(int(bounds[best]), int(bounds[best + 1]))


def _movement(z: Complex, rate: float) -> tuple[float, float]:
    """Standard deviation of the phase, rad, and its highest frequency, Hz."""
    modulus = np.log(np.maximum(np.abs(z), 1e-300))
    both = np.stack([np.unwrap(np.angle(z)), modulus])
    both -= both.mean(axis=1, keepdims=True)
    phase, noise = both.var(axis=1).tolist()
    if phase <= SURE * noise:
        return 0.0, np.nan
    spectra = np.abs(scipy.fft.rfft(both * np.hanning(z.size), axis=1)) ** 2
    rising = np.cumsum(spectra[0] - spectra[1])
    highest = int(np.argmax(rising >= SHARE * rising[-1]))
    return float(np.sqrt(phase - noise)), max(highest, 1) * rate / z.size


class Return(NamedTuple):
    """One return.

    Attributes:
        range: m.
        power: A^2 of a raw sample over the white noise.
        residual: standard deviation of its movement, m.
        highest: frequency of that, Hz; NaN where it does not move.
    """

    range: float
    power: float
    residual: float
    highest: float


def peaks(together: Returns, noise: float, w: Waveform) -> list[Return]:
    """The returns of a profile, from near to far; what is closer than 5 cells is one.

    Args:
        together: of all parts.
        noise: power of the white noise in a block.
        w: the radar.
    """
    power = together.power
    seen = np.isfinite(power)
    if not seen.any():
        return []
    strongest = float(power[seen].max())
    least = max(
        OVER_NOISE * noise,
        OVER_OTHERS * float(np.quantile(power[seen], 0.1)),
        strongest * 10 ** ((10 - SIDELOBES_DB) / 10),
    )
    decibels = 10 * np.log10(np.where(seen, np.maximum(power, 1e-300), 1e-300))
    inside = minimum_filter1d(seen, 3, mode="constant", cval=False)  # an edge proves no peak
    top = (decibels == maximum_filter1d(decibels, 5)) & inside & (power > least)
    found = []
    for k in np.flatnonzero(top).tolist():
        shift, level = _vertex(*decibels[k - 1 : k + 2].tolist())
        found.append(
            Return(
                (k + shift) * w.range_step,
                float(10 ** ((decibels[k] + level) / 10)),
                float(together.residual[k]),
                float(together.highest[k]),
            )
        )
    return found


def _vertex(low: float, mid: float, high: float) -> tuple[float, float]:
    """Of the parabola through a peak and its neighbours, dB: bins beside it, and dB above it."""
    curve = low - 2 * mid + high
    shift = 0.5 * (low - high) / curve if curve < 0 else 0.0  # three equal ones have none
    return shift, -0.25 * (low - high) * shift
