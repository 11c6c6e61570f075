"""Receiver noise: circular white Gaussian (paper, last equations of "Radar Echo Model")."""

from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from radhar_cli.echo.receiver.impairment import Impairment
from radhar_cli.numerics.arrays import Complex
from radhar_cli.processing.look import Look, RangeBins

CHUNK = 2**17  # numbers drawn at once where range bins are correlated


def noise_variance(signal_power: float, snr_db: float) -> float:
    """Variance of the noise of a complex raw sample, sigma_n^2 = P_s/10^(SNR/10)."""
    return signal_power / 10 ** (snr_db / 10)


def circular_gaussian(
    rng: np.random.Generator, shape: tuple[int, ...], single: bool = False
) -> Complex:
    """Unit-variance circular Gaussian numbers: real and imaginary parts of variance 1/2.

    sqrt(-log u) exp(j 2 pi v) of uniform u and v (Box and Muller), computed in float32, whose
    logarithms and sines NumPy vectorises.
    """
    bits = rng.integers(2**64, size=shape, dtype=np.uint64)
    u, v = (half.astype(np.float32) * 2.0**-32 for half in (bits >> 32, bits & 0xFFFFFFFF))
    size, angle = np.sqrt(-np.log(u + 2.0**-33)), 2 * np.pi * v  # u may be 0
    z: Complex = np.empty(shape, np.complex64 if single else np.complex128)
    np.multiply(size, np.cos(angle), out=z.real)
    np.multiply(size, np.sin(angle), out=z.imag)
    return z


def white_noise(look: Look, rng: np.random.Generator, sigma: float = 1.0) -> Complex:
    """White noise of standard deviation sigma a raw sample, as a look shows it [K, M].

    Where no two columns share a pulse, they are independent, of variance sum taps^2, and drawn as
    such; else the pulses that they need are drawn and cancelled.
    """
    fast, rank, reach = look.fast, look.fast.rank, len(look.taps) - 1
    if reach == 0 and isinstance(fast, RangeBins) and _draws_bins(fast, look):
        return _correlated_noise(fast, look, rng, sigma)
    if look.spans is not None and fast.white:
        v = np.zeros((rank, look.count), complex)
        for row, span in zip(v, look.spans, strict=True):
            row[span] = circular_gaussian(rng, row[span].shape)
    elif look.count == 1 or reach == 0 or np.all(np.diff(look.pulses) > reach):
        v = circular_gaussian(rng, (look.count, rank)).T
        if reach:
            v *= np.sqrt(np.sum(np.square(look.taps)))
    else:
        needed = np.unique(np.asarray(look.pulses) + np.arange(reach + 1)[:, None])
        samples = circular_gaussian(rng, (needed.size, rank)).T
        v = look.after_taps(lambda pulses: samples[:, np.searchsorted(needed, pulses)])
    return fast.colour(v, sigma)


def _draws_bins(bins: RangeBins, look: Look) -> bool:
    """Whether correlated noise is drawn in the bins themselves, not as raw samples.

    So it is of a part of the bins, or of bins that count at a part of the pulses, that are fewer
    than the samples of a chirp.
    """
    is_partial = look.spans is not None or bins.bins is not None
    return is_partial and not bins.white and bins.rows < bins.waveform.n_adc


def _correlated_noise(
    bins: RangeBins, look: Look, rng: np.random.Generator, sigma: float
) -> Complex:
    """White noise of raw samples in range bins [K, M], correlated from bin to bin.

    It is drawn in single precision for one stretch of pulses after the other, in the bins that
    count there; elsewhere it is 0.
    """
    spans = look.spans or [slice(0, look.count)] * bins.rows
    begin, end = np.array([(span.start, span.stop) for span in spans]).T
    longest = max(1, CHUNK // bins.rows)
    edges = np.unique(np.concatenate([begin, end, np.arange(0, look.count, longest)]))
    x = np.zeros((bins.rows, look.count), complex)
    for start, stop in pairwise(edges.tolist()):
        rows = np.flatnonzero((begin <= start) & (stop <= end))
        if rows.size:
            first, last = int(rows[0]), int(rows[-1]) + 1
            part = bins.consecutive(first, last)
            v = circular_gaussian(rng, (part.rank, stop - start), single=True)
            x[first:last, start:stop] = part.colour(v, sigma)
    return x


@dataclass(frozen=True)
class WhiteNoise(Impairment):
    """White noise of a receive channel."""

    sigma: float  # standard deviation per complex raw sample
    stream: Callable[[str], np.random.Generator]  # makes the random stream of a name

    def apply(self, x: Complex, look: Look) -> Complex:
        """Add sigma v to x [K, M], v of covariance W W^H.

        Blocks of any length have the same raw samples. Where a look names its columns, the other
        pulses count by their sum alone: the first of them gets the noise of all.
        """
        rng = look.state_of(self, self.stream)
        if look.columns is not None and look.columns.size < look.count:
            summed = np.setdiff1d(np.arange(look.count), look.columns)
            noisy_pulses = np.append(look.columns, summed[0])
            v = circular_gaussian(rng, (noisy_pulses.size, look.fast.rank)).T
            v[:, -1] *= np.sqrt(summed.size)
            x[:, noisy_pulses] += look.fast.colour(v, self.sigma)
            return x
        noisy = white_noise(look, rng, self.sigma)
        noisy += x
        return noisy

    def added_to(self, cube: Complex, name: str) -> Complex:
        """Raw samples with noise: that of `apply`, in the precision of the cube.

        Args:
            cube: Raw samples [frame, ...] without noise.
            name: Name of the random stream, from which noise is drawn frame by frame.
        """
        rng, noisy = self.stream(name), np.empty_like(cube)
        for frame, samples in enumerate(cube):
            noisy[frame] = circular_gaussian(rng, samples.shape, single=True)
            noisy[frame] *= np.float32(self.sigma)
            noisy[frame] += samples
        return noisy
