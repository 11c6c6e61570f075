"""Coloured receiver noise: 1/f^a along slow time, on top of the white noise."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from radhar_cli.arrays import Complex, Float, Index
from radhar_cli.echo.half_band_sum import noise_gain
from radhar_cli.processing.canceller import Fir
from radhar_cli.processing.range_compression import range_bins
from radhar_cli.radar.waveform import Waveform
from radhar_cli.receiver.impairment import Impairment
from radhar_cli.receiver.noise import circular_gaussian, compressed_colour

POLES_A_DECADE = 2
ROWS = 8  # range bins or fast-time samples whose noise is made at once


@dataclass(frozen=True)
class FlickerNoise(Impairment):
    """Noise of the spectrum (corner/|f|)^a times that of the white noise, a = slope/10 dB.

    White over fast-time samples; along slow time a sum of first-order processes, two a decade from
    0.1/T to PRF/2, which meets the spectrum within 1 dB. Every fast-time sample has its own.

    Attributes:
        sigma: standard deviation of the white noise per complex raw sample.
        waveform: the radar.
        stream: makes the random stream of a name.
        corner: where both are equally strong, Hz.
        slope: dB per decade.
    """

    sigma: float
    waveform: Waveform
    stream: Callable[[str], np.random.Generator]
    corner: float
    slope: float

    @cached_property
    def processes(self) -> tuple[Float, Float]:
        """Pole and standard deviation of each process, for white noise of variance 1."""
        w = self.waveform
        return _processes(self.corner / w.prf, self.slope / 10, 1 / w.n_pulses)

    def beat(self, blocks: Iterator[Complex]) -> Iterator[Complex]:
        """Noise of every fast-time sample, pulse by pulse: blocks of any length give the same."""
        from scipy.signal import lfilter  # slow to import

        rngs = [self.stream(f"flicker beat {k}") for k in range(len(self.processes[0]))]
        state: list[Complex] = []
        for block in blocks:
            noisy = block.copy()
            for k, (rng, pole, sd) in enumerate(zip(rngs, *self.processes, strict=True)):
                if len(state) == k:  # from the stationary state
                    state.append(pole * circular_gaussian(rng, (1, len(block))).T)
                v = np.sqrt(1 - pole**2) * circular_gaussian(rng, block.shape[::-1]).T
                v, state[k] = lfilter([1.0], [1.0, -pole], v, axis=1, zi=state[k])
                noisy += self.sigma * sd * v
            yield noisy

    def slow_time(self, y: Complex) -> Complex:
        """What compression and sum make of it: the same along slow time, amplified as white is."""
        v = self._noise(self.stream("flicker slow_time"), 1, y.size)[0]
        noisy: Complex = y + np.sqrt(noise_gain(self.waveform)) * v
        return noisy

    def range_signals(
        self, x: Complex, bins: slice, spans: Sequence[slice] | None = None
    ) -> Complex:
        """Of range bins [K, M] of all pulses."""
        rng, w = self.stream("flicker range_signals"), self.waveform
        if w.n_fft == w.n_adc:
            noisy: Complex = x + np.sqrt(w.n_adc) * self._noise(rng, *x.shape)
            return noisy
        colour = compressed_colour(w, np.arange(w.n_bins)[bins])
        noisy = self._noise(rng, colour.shape[1], x.shape[1])
        return x + colour @ noisy

    def range_bins(self, bins: Complex, pulses: Index, canceller: Fir) -> Complex:
        """Of some pulses; noise is made of all of them, some rows at a time."""
        rng, w = self.stream("flicker range_profiles"), self.waveform
        padded = w.n_fft != w.n_adc
        length = w.n_adc if padded else w.n_bins
        kept = np.empty((length, pulses.size), complex)
        for first in range(0, length, ROWS):
            rows = min(ROWS, length - first)
            kept[first : first + rows] = canceller(self._noise(rng, rows, w.n_pulses))[:, pulses]
        noisy: Complex = bins + (range_bins(kept, w) if padded else np.sqrt(w.n_adc) * kept)
        return noisy

    def _noise(self, rng: np.random.Generator, rows: int, pulses: int) -> Complex:
        """[rows, pulses], from the stationary state."""
        from scipy.signal import lfilter  # slow to import

        total = np.zeros((rows, pulses), dtype=complex)
        for pole, sd in zip(*self.processes, strict=True):
            v = circular_gaussian(rng, (rows, pulses + 1))
            v[:, 1:] *= np.sqrt(1 - pole**2)
            total += self.sigma * sd * lfilter([1.0], [1.0, -pole], v, axis=1)[:, 1:]
        return total


@lru_cache(maxsize=8)
def _processes(corner: float, power: float, lowest: float) -> tuple[Float, Float]:
    """Poles and standard deviations; frequencies over the PRF. Least squares of the ratio to 1."""
    from scipy.optimize import nnls  # slow to import

    below = 0.1 * lowest  # where the steepest have their knee: they still rise at 1/T
    count = int(np.ceil(POLES_A_DECADE * np.log10(0.5 / below))) + 1
    knees = np.geomspace(below, 0.5, count)
    pole = np.exp(-2 * np.pi * knees)
    f = np.geomspace(lowest, 0.5, 16 * knees.size)[:, None]
    spectra = (1 - pole**2) / np.abs(1 - pole * np.exp(-2j * np.pi * f)) ** 2
    variance, _ = nnls(spectra / (corner / f) ** power, np.ones(f.size))
    return pole[variance > 0], np.sqrt(variance[variance > 0])
