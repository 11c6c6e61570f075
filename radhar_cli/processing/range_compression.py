"""Range compression with the conjugate kernel."""

from typing import Any

import numpy as np

from radhar_cli.numerics.arrays import Complex
from radhar_cli.radar.fmcw import Waveform


def range_compression(s: Complex, waveform: Waveform, bins: slice = slice(None)) -> Complex:
    """Range bins S[k, m] = sum_n w[n] s[n, m] exp(+j 2 pi k (n - n0)/N_FFT), k < N_FFT/2.

    w is the window of the waveform. The conjugate kernel puts a target at range bin k =
    R/range_step; n0 = N_ADC/2 refers the bins to mid-chirp (docs/physics/model.md, "Where in the
    chirp the Doppler is read").

    Args:
        s: Beat matrix [N_ADC, M].
        bins: Range bins that are wanted, among those that are kept.

    Returns:
        S [K, M] of those bins.
    """
    if not waveform.window.is_rectangular:
        s = s * waveform.window.weights(waveform.n_adc)[:, None].astype(s.real.dtype)
    ifft: Any = np.fft.ifft
    if s.dtype == np.complex64:  # which scipy transforms faster, but it is slow to import
        from scipy.fft import ifft
    # The transform runs along contiguous memory where s is the transpose of [M, N_ADC].
    profile: Complex = ifft(s.T, waveform.n_fft, axis=1, norm="forward").T
    profile = profile[: waveform.n_bins][bins]
    if waveform.bin_gain != 1:
        profile = profile * waveform.bin_gain
    if waveform.n0:
        k = np.arange(waveform.n_bins)[bins, None]
        profile = profile * np.exp(-2j * np.pi * np.mod(k * waveform.n0 / waveform.n_fft, 1))
    return profile
