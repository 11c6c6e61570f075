"""Range compression with the conjugate kernel, and the sum over the kept bins."""

import numpy as np
import scipy.fft

from radhar_cli.arrays import Complex, Float
from radhar_cli.radar.waveform import Waveform


def range_compression(s: Complex, waveform: Waveform) -> Complex:
    """S[k, m] = sum_n s[n, m] exp(+j 2 pi k (n - n0)/N_FFT), k < N_FFT/2.

    The conjugate kernel puts a target at range bin k = R/range_step; n0 = N_ADC/2 refers the bins
    to mid-chirp (docs/model.md, "Where in the chirp the Doppler is read").

    Args:
        s: beat matrix [N_ADC, M].
        waveform: the radar.

    Returns:
        [N_FFT/2, M].
    """
    bins = range_bins(s, waveform)
    if waveform.n0:
        k = np.arange(waveform.n_bins)[:, None]
        bins = bins * np.exp(-2j * np.pi * np.mod(k * waveform.n0 / waveform.n_fft, 1))
    return bins


def range_bins(s: Complex, waveform: Waveform) -> Complex:
    """`range_compression` without its phase reference, which no power depends on: n0 = 0."""
    # The transform runs along contiguous memory where s is the transpose of [M, N_ADC].
    bins = scipy.fft.ifft(s.T, waveform.n_fft, axis=1, norm="forward")
    kept: Complex = bins[:, : waveform.n_bins].T
    return kept


def range_power(bins: Complex) -> Float:
    """|S[k, m]|^2 [N_FFT/2, M]: the range-time map."""
    power: Float = bins.real**2 + bins.imag**2
    return power


def half_band_signal(bins: Complex) -> Complex:
    """x[m] = sum over the kept bins of S[k, m] (paper, first equation of "DTMs Generation")."""
    x: Complex = bins.sum(axis=0)
    return x
