"""Receiver noise: circular white Gaussian (paper, last equations of "Radar Echo Model")."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from radhar_cli.arrays import Complex, Index
from radhar_cli.echo.half_band_sum import noise_gain
from radhar_cli.processing.canceller import Fir
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

    def range_bins(self, bins: Complex, pulses: Index, canceller: Fir) -> Complex:
        """Noise of the kept bins. Unpadded, a transform of white noise is white: they are drawn."""
        rng, w = self.stream("range_profiles"), self.waveform
        if w.n_fft == w.n_adc:
            noise = self.sigma * np.sqrt(w.n_adc) * noise_at(rng, w.n_bins, pulses, canceller)
        else:
            noise = range_bins(self.sigma * noise_at(rng, w.n_adc, pulses, canceller), w)
        noisy: Complex = bins + noise
        return noisy

    def range_signals(
        self, x: Complex, bins: slice, spans: Sequence[slice] | None = None
    ) -> Complex:
        """White in slow time, and over the bins too unless the FFT is padded."""
        rng, w = self.stream("range_signals"), self.waveform
        if w.n_fft == w.n_adc:
            v = np.zeros(x.shape, complex)
            for row, span in enumerate(spans or [slice(None)] * len(x)):
                part = circular_gaussian(rng, x[row, span].shape)
                part *= self.sigma * np.sqrt(w.n_adc)
                np.add(part, x[row, span], out=v[row, span])
            return v
        colour = self.sigma * compressed_colour(w, np.arange(w.n_bins)[bins])
        v = colour @ circular_gaussian(rng, (colour.shape[1], x.shape[1]))
        v += x
        return v


def compressed_colour(waveform: Waveform, k: Index) -> Complex:
    """L [K, at most N_ADC] with L L^H the covariance of bins k for unit white noise per sample.

    C[k, k'] = sum_n exp(j 2 pi (k - k')(n - n0)/N_FFT) = F F^H; with F^H = Q R it is R^H R.
    """
    n = np.arange(waveform.n_adc) - waveform.n_adc / 2
    f = np.exp(2j * np.pi * np.mod(np.outer(k, n) / waveform.n_fft, 1))
    colour: Complex = np.linalg.qr(f.conj().T).R.conj().T
    return colour


def noise_at(rng: np.random.Generator, length: int, pulses: Index, canceller: Fir) -> Complex:
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
