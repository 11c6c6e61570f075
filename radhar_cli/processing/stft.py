"""Short-time Fourier transform (paper, last but one equation of "DTMs Generation")."""

import numpy as np
import scipy.fft

from radhar_cli.arrays import Complex, Float
from radhar_cli.processing.frames import Frames


def spectrum(x: Complex, frames: Frames, fft_length: int | None = None) -> Complex:
    """X[l, k] = sum_n x[l hop + n] g[n] exp(-j 2 pi k n/N), k = 0 .. N - 1.

    Args:
        x: slow-time signal [M].
        frames: window length and hop.
        fft_length: N, at least L; L unless given.

    Returns:
        [frames, N].
    """
    windowed = frames.cut(x) * frames.window
    return scipy.fft.fft(windowed, fft_length or frames.length, axis=1, overwrite_x=True)


def power_map(spectra: Complex) -> Float:
    """|X|^2 [frequency, time] with the lowest frequency first and zero Doppler in the middle."""
    power = spectra.real**2
    power += spectra.imag**2
    return np.fft.fftshift(power, axes=1).T
