"""Fourier synchrosqueezed transform: STFT coefficients moved to their instantaneous frequency."""

from collections.abc import Iterator

import numpy as np
import scipy.fft

from radhar_cli.arrays import Complex, Float
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.stft import Spectra


def synchrosqueeze(
    x: Complex, v: Complex, frames: Frames, threshold: float, largest: float | None = None
) -> Complex:
    """T[l, k]: V[l, k] added up at bin k + round(Im(-V'/V) L/(2 pi)) modulo L.

    V' is the transform with the window's slope. Coefficients below `threshold` times the map's
    largest |V|, and those exactly zero, are dropped. V and T have their phase referenced to
    sample L//2 of the frame, so that with threshold 0 sum_k T = L g[L//2] x[l hop + L//2].

    Args:
        x: slow-time signal [M].
        v: its `spectrum` [frames, L] over the same frames.
        frames: window length and hop.
        threshold: relative to the largest |V|.
        largest: |V| of the whole map, where v is a part of it.

    Returns:
        [frames, L].
    """
    length = frames.length
    slope = scipy.fft.fft(frames.cut(x) * frames.window_slope, axis=1, overwrite_x=True)
    magnitude = np.abs(v)
    if largest is None:
        largest = magnitude.max(initial=0.0)
    row, k = np.nonzero((magnitude >= threshold * largest) & (magnitude > 0))
    kept = v[row, k]
    with np.errstate(over="ignore", invalid="ignore"):  # V may be denormal where V' is not
        shift = np.imag(-slope[row, k] / kept) * (length / (2 * np.pi))
    shift[~np.isfinite(shift)] = 0
    # A shift is only needed modulo L; reduced before the cast, it cannot overflow an integer.
    target = row * length + (k + np.mod(np.floor(shift + 0.5), length).astype(np.intp)) % length
    centred = kept * np.exp(2j * np.pi * ((k * (length // 2)) % length) / length)
    size = v.shape[0] * length
    squeezed = np.empty(size, dtype=complex)
    squeezed.real = np.bincount(target, weights=centred.real, minlength=size)
    squeezed.imag = np.bincount(target, weights=centred.imag, minlength=size)
    return squeezed.reshape(v.shape)


def power_blocks(x: Complex, spectra: Spectra, frames: Frames, threshold: float) -> Iterator[Float]:
    """Power maps [frequency, frames] of consecutive blocks of frames.

    The threshold refers to the whole map: more than one block takes a first pass for its largest
    coefficient, unless the threshold is 0.

    Args:
        x: slow-time signal [M].
        spectra: over the same frames, of length L.
        frames: window length and hop.
        threshold: relative to the largest |V|.
    """
    largest: float | None = None
    if len(spectra) > 1:
        largest = max(float(np.abs(v).max()) for v in spectra) if threshold > 0 else 0.0
    first = 0
    for v in spectra:
        span = frames.span(slice(first, first + len(v)))
        yield power_map(synchrosqueeze(x[span], v, frames, threshold, largest))
        first += len(v)


def power_map(squeezed: Complex) -> Float:
    """|T|^2 [frequency, time], laid out as the map of the STFT."""
    power = squeezed.real**2
    power += squeezed.imag**2
    return np.fft.fftshift(power, axes=1).T
