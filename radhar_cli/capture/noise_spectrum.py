"""Colour and lines of a receiver's noise, from range bins in which nobody is.

Of bins normalised by their own white floor, flicker noise has the spectrum 1 + (f_c/|f|)^a, and a
line of power a^2 in every raw sample adds a^2 L/sigma^2 in a window of L pulses, over all ranges.
"""

from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
import scipy.fft
from scipy.ndimage import median_filter

from radhar_cli.arrays import Bool, Complex, Float

WINDOW_S = 1.0
LOWEST = 2  # Doppler bins next to zero, which Hann's window mixes with the removed mean
A_DECADE = 12  # points of the spectrum that the colour is fitted to
SURE_BIC = 20.0  # by which the Bayesian information criterion has to favour coloured noise
MIN_RISE_DB = 1.0  # rise of the noise at the lowest frequency, and of a line over the noise
DEVIATIONS = 6.0  # of a line over the noise beside it
BESIDE = 31  # Doppler bins that tell this noise
MAX_LINES = 16
SLOPES = (1.0, 20.0)  # dB per decade
BLOCK_S = 0.1  # of pulses, in which a line is looked for
CLEAR = 12.0  # deviations of a block's noise by which a line is seen to come and go


class Colour(NamedTuple):
    """Noise of the spectrum white (1 + (corner/|f|)^(slope/10)); a corner of 0 is white noise.

    Attributes:
        white: over what the bins were normalised by.
        corner: Hz.
        slope: dB per decade.
    """

    white: float
    corner: float
    slope: float

    def __call__(self, f: Float) -> Float:
        """The spectrum at frequencies f (Hz)."""
        if self.corner == 0:
            return np.full(f.shape, self.white)
        raised: Float = (self.corner / np.abs(f)) ** (self.slope / 10)
        return self.white * (1 + raised)


WHITE = Colour(1.0, 0.0, SLOPES[0])


class FoundLine(NamedTuple):
    """A narrow line at all ranges.

    Attributes:
        doppler: Hz.
        level: power over the white noise, of a raw sample, while it is there.
        on, off: mean times for which it is there and is not, s; always there where off is 0.
    """

    doppler: float
    level: float
    on: float = 1.0
    off: float = 0.0

    @property
    def share(self) -> float:
        """Of the time for which it is there."""
        return self.on / (self.on + self.off)


@dataclass
class NoiseSpectrum:
    """Mean power over Doppler of the range bins from which the person is away.

    Attributes:
        length: L, pulses of a window.
        prf: Hz.
        power: sum over the windows [K, L].
        count: windows in which nobody was in a bin [K].
        left_out: bins with something that moves by itself [K].
    """

    length: int
    prf: float
    power: Float = field(default_factory=lambda: np.zeros((0, 0)))
    count: Float = field(default_factory=lambda: np.zeros(0))
    left_out: Bool = field(default_factory=lambda: np.zeros(0, bool))

    @property
    def window(self) -> Float:
        """Hann's [L]."""
        return np.hanning(self.length + 2)[1:-1]

    @property
    def frequency(self) -> Float:
        """Of the columns, Hz [L]."""
        return np.fft.fftfreq(self.length, 1 / self.prf)

    def add(self, bins: Complex, away: Bool) -> None:
        """Take in a stretch of pulses.

        Args:
            bins: [K, M] without what stands still.
            away: [K, M] whether nobody is there.
        """
        if not self.power.size:
            self.power, self.count = np.zeros((len(bins), self.length)), np.zeros(len(bins))
            self.left_out = np.zeros(len(bins), bool)
        window = self.window
        for first in range(0, bins.shape[1] - self.length + 1, max(self.length // 2, 1)):
            part = slice(first, first + self.length)
            rows = np.flatnonzero(away[:, part].all(axis=1))
            spectrum = scipy.fft.fft(bins[rows, part] * window, axis=1)
            self.power[rows] += np.abs(spectrum) ** 2
            self.count[rows] += 1

    def slow_db(self, highest: float) -> float | None:
        """Mean power up to that Doppler (Hz) over the white noise, of all bins, dB.

        None where the person is in all of them.
        """
        rows, slow = np.flatnonzero(self.count > 0), np.abs(self.frequency) <= highest
        if not rows.size:
            return None
        power = self.power[rows] / self.count[rows, None]
        white = float(np.median(power[:, np.abs(self.frequency) > self.prf / 4]))
        return 10 * float(np.log10(power[:, slow].mean() / white))

    def over_all_ranges(self) -> tuple[Float, Float, Float] | None:
        """Mean, median and lower quartile [L] of the bins, each over its white floor, 1 on the
        average.

        What lies at some ranges only, such as a fan, is in neither of the latter two. None where
        there are few bins or pulses.
        """
        rows = np.flatnonzero((self.count > 0) & ~self.left_out)
        if rows.size < 4 or self.length < 4 * BESIDE:
            return None
        power = self.power[rows] / self.count[rows, None]
        high = np.abs(self.frequency) > self.prf / 4
        power /= np.median(power[:, high], axis=1, keepdims=True)
        mean, half, quarter = (
            one / np.median(one[high])
            for one in (power.mean(axis=0), *np.quantile(power, (0.5, 0.25), axis=0))
        )
        return mean, half, quarter


def lines(spectrum: NoiseSpectrum) -> list[FoundLine]:
    """Narrow lines that are there at all ranges, the strongest first, not within 3 Doppler bins of
    zero."""
    both = spectrum.over_all_ranges()
    if both is None:
        return []
    mean, median, _ = both
    background, base = (median_filter(one, BESIDE, mode="wrap") for one in (median, mean))
    ratio = median / background
    spread = 1.4826 * float(np.median(np.abs(ratio - np.median(ratio))))
    least = max(1 + DEVIATIONS * spread, 10 ** (MIN_RISE_DB / 10))
    f, length = spectrum.frequency, spectrum.length
    found: list[FoundLine] = []
    taken = np.zeros(length, bool)
    taken[np.abs(np.fft.fftfreq(length, 1 / length)) <= LOWEST] = True
    for peak in np.argsort(-ratio, kind="stable").tolist():
        if ratio[peak] <= least or len(found) == MAX_LINES:
            break
        near = (peak + np.arange(-LOWEST, LOWEST + 1)) % length
        if not taken[near].any():
            excess = (mean - base)[near]
            total = float(excess.sum())
            if total > 0:
                step = float(excess @ np.arange(-LOWEST, LOWEST + 1)) / total
                level = total / length
                found.append(FoundLine(float(f[peak]) + step * spectrum.prf / length, level))
        taken[near] = True
    return found


def colour(spectrum: NoiseSpectrum, found: list[FoundLine]) -> Colour:
    """Fit coloured noise to the spectrum beside the lines; white where that says as much.

    Least squares of decibels, at points that are as many in every decade.
    """
    from scipy.optimize import least_squares  # slow to import

    both = spectrum.over_all_ranges()
    if both is None:
        return WHITE
    f, step = np.abs(spectrum.frequency), spectrum.prf / spectrum.length
    kept = f >= (LOWEST - 0.5) * step
    for line in found:
        kept &= np.abs(spectrum.frequency - line.doppler) > (LOWEST + 1.5) * step
    edges = np.arange(np.log10(LOWEST * step), np.log10(spectrum.prf / 2), 1 / A_DECADE)
    group = np.digitize(np.log10(np.maximum(f, step)), edges + 1e-9)
    at, level = [], []
    for number in np.unique(group[kept]).tolist():
        some = kept & (group == number)
        at.append(np.exp(np.log(f[some]).mean()))
        level.append(10 * np.log10(both[2][some].mean()))
    x, y = np.array(at), np.array(level)
    if x.size < 8:
        return WHITE

    def off(parameters: Float) -> Float:
        model = Colour(10 ** (parameters[0] / 10), 10 ** parameters[1], parameters[2])
        return np.asarray(10 * np.log10(model(x)) - y)

    high = float(np.log10(spectrum.prf / 2))
    bounds = ([-20, -3, SLOPES[0]], [20, high, SLOPES[1]])
    start = [y[-4:].mean(), float(np.log10(np.sqrt(x[0] * x[-1]))), 10.0]
    best = least_squares(off, start, bounds=bounds).x
    squares = [float(np.sum(r**2)) for r in (y - y.mean(), off(best))]
    gain = x.size * np.log(squares[0] / max(squares[1], 1e-12)) - 2 * np.log(x.size)
    rise = 10 * np.log10(1 + (10 ** best[1] / x[0]) ** (best[2] / 10))
    if gain < SURE_BIC or rise < MIN_RISE_DB:
        return WHITE
    return Colour(*(float(one) for one in (10 ** (best[0] / 10), 10 ** best[1], best[2])))


class OnOff:
    """How long a line is there and is not, from its power block by block.

    Exponential times that are cut off by the ends of what was looked at: the mean is the whole time
    over the number of ends that were seen.
    """

    def __init__(self, line: FoundLine, prf: float) -> None:
        self.line, self.prf = line, prf
        self.length = max(round(BLOCK_S * prf), 1)
        self.parts: list[Float] = []
        self.rows: list[int] = []

    def add(self, bins: Complex, away: Bool, white: float) -> None:
        """Take in a stretch, as `NoiseSpectrum.add` does; `white` is its noise's variance."""
        count = bins.shape[1] // self.length
        tone = np.exp(-2j * np.pi * self.line.doppler / self.prf * np.arange(count * self.length))
        shape = (len(bins), count, self.length)
        sums = (bins[:, : tone.size] * tone).reshape(shape).sum(axis=2)
        free = away[:, : tone.size].reshape(shape).all(axis=2)
        rows = free.sum(axis=0)
        if not count or not rows.all():
            return
        power = np.where(free, np.abs(sums) ** 2, 0).sum(axis=0) / rows
        self.parts.append(power / (white * self.length))
        self.rows.append(int(rows.min()))

    def line_with_times(self) -> FoundLine:
        """The line, with its level while it is on."""
        if not self.parts:
            return self.line
        strong = float(np.quantile(np.concatenate(self.parts), 0.95)) - 1
        if strong < CLEAR * np.sqrt(2 / min(self.rows)):  # neighbouring bins are not independent
            return self.line
        on = [median_filter(part > 1 + strong / 4, 3) for part in self.parts]
        share = float(np.concatenate(on).mean())
        ends = sum(int(np.count_nonzero(one[:-1] & ~one[1:])) for one in on)
        starts = sum(int(np.count_nonzero(~one[:-1] & one[1:])) for one in on)
        if not (ends and starts):
            return self.line
        seconds = sum(one.size for one in on) * self.length / self.prf
        off = (1 - share) * seconds / starts
        return FoundLine(self.line.doppler, self.line.level / share, share * seconds / ends, off)
