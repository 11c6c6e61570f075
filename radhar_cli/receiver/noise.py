"""Receiver noise: circular white Gaussian (paper, last equations of "Radar Echo Model")."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from radhar_cli.arrays import Complex, Index
from radhar_cli.echo.half_band_sum import noise_gain
from radhar_cli.processing.canceller import Canceller
from radhar_cli.processing.range_compression import range_bins
from radhar_cli.radar.waveform import Waveform
from radhar_cli.receiver.impairment import Impairment


def noise_variance(signal_power: float, snr_db: float) -> float:
    """sigma_n^2 = P_s/10^(SNR/10) per complex raw sample."""
    return signal_power / 10 ** (snr_db / 10)


def circular_gaussian(rng: np.random.Generator, shape: tuple[int, ...]) -> Complex:
    """Unit-variance circular Gaussian numbers: real and imaginary parts of variance 1/2."""
    pairs = rng.standard_normal((*shape, 2))
    pairs *= np.sqrt(0.5)
    return pairs.view(np.complex128)[..., 0]


@dataclass(frozen=True)
class WhiteNoise(Impairment):
    """White noise of one recording, in the form in which each engine needs it.

    Attributes:
        sigma: standard deviation per complex raw sample.
        waveform: the radar.
        stream: makes the random stream of a name.
    """

    sigma: float
    waveform: Waveform
    stream: Callable[[str], np.random.Generator]

    def beat(self, blocks: Iterator[Complex]) -> Iterator[Complex]:
        """Noise on every sample, drawn pulse by pulse: blocks of any length give the same."""
        rng = self.stream("beat")
        for block in blocks:
            yield block + self.sigma * circular_gaussian(rng, block.shape[::-1]).T

    def slow_time(self, y: Complex) -> Complex:
        """White noise of variance sigma^2 sum_n |D[n]|^2: what compression and sum make of it."""
        v = circular_gaussian(self.stream("slow_time"), y.shape)
        v *= self.sigma * np.sqrt(noise_gain(self.waveform))
        v += y
        return v

    def range_bins(self, bins: Complex, pulses: Index, canceller: Canceller) -> Complex:
        """Noise of the kept bins. Unpadded, a transform of white noise is white: they are drawn."""
        rng, w = self.stream("range_profiles"), self.waveform
        if w.n_fft == w.n_adc:
            noise = self.sigma * np.sqrt(w.n_adc) * noise_at(rng, w.n_bins, pulses, canceller)
        else:
            noise = range_bins(self.sigma * noise_at(rng, w.n_adc, pulses, canceller), w)
        noisy: Complex = bins + noise
        return noisy


def noise_at(rng: np.random.Generator, length: int, pulses: Index, canceller: Canceller) -> Complex:
    """White unit noise [length, M] after a canceller, at `pulses` [length, len(pulses)].

    Where no two outputs share a pulse they are white of variance sum taps^2, and drawn as such;
    else the pulses they need are drawn and cancelled, which gives them the right correlation.
    """
    if pulses.size == 1 or np.all(np.diff(pulses) > canceller.lost):
        scale = np.sqrt(np.sum(np.square(canceller.taps)))
        w: Complex = circular_gaussian(rng, (pulses.size, length)).T
        return w if scale == 1 else scale * w
    needed = np.unique(pulses + np.arange(canceller.lost + 1)[:, None])
    w = circular_gaussian(rng, (needed.size, length)).T
    own: Complex = np.zeros((length, pulses.size), dtype=complex)
    for k, tap in enumerate(canceller.taps):
        own += tap * w[:, np.searchsorted(needed, pulses + k)]
    return own
