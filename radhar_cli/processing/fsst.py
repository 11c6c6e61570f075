"""Fourier synchrosqueezed transform: STFT coefficients moved to their instantaneous frequency."""

from collections.abc import Iterator

import numpy as np

from radhar_cli.arrays import Complex, Float
from radhar_cli.processing.stft import Spectra


def synchrosqueeze(v: Complex, slope: Complex, least: float) -> tuple[Float, Float]:
    """T[l, k]: V[l, k] added up at bin k + round(Im(-V'/V) L/(2 pi)) modulo L.

    V' is the transform with the window's slope. Both have their phase referenced to sample L//2
    of the frame, so that sum_k T = L g[L//2] x[l hop + L//2] where nothing is dropped.

    Args:
        v, slope: V and V' [frames, L].
        least: coefficients below this magnitude are dropped, and those whose square is zero.

    Returns:
        Real and imaginary part of T, each [frames, L] in float64.
    """
    length = v.shape[1]
    power = np.abs(v).ravel()
    power *= power
    kept = np.flatnonzero(power >= max(least**2, float(np.finfo(power.dtype).tiny)))
    a, b = v.ravel()[kept], slope.ravel()[kept]
    # Im(-V'/V) = Im(V conj V')/|V|^2
    shift = b.real * a.imag
    shift -= b.imag * a.real
    shift /= power[kept]
    shift *= length / (2 * np.pi)
    shift += 0.5
    np.floor(shift, out=shift)
    row = kept // length * length
    k = shift.astype(np.intp)
    k += kept - row
    k -= k // length * length
    k += row
    real = np.bincount(k, a.real, minlength=v.size).reshape(v.shape)
    imag = np.bincount(k, a.imag, minlength=v.size).reshape(v.shape)
    return real.astype(float, copy=False), imag.astype(float, copy=False)


def power_blocks(spectra: Spectra, threshold: float) -> Iterator[Float]:
    """|T|^2 [some frames, frequency], laid out as the map of the STFT.

    Args:
        spectra: of the signal, with N = L.
        threshold: coefficients below it times the largest |V| of the whole map are dropped.
    """
    least = threshold * max(float(np.abs(v).max()) for v in spectra) if threshold else 0.0
    for block, v in zip(spectra.blocks, spectra, strict=True):
        slope = spectra.transform(block, spectra.frames.window_slope)
        power, imag = synchrosqueeze(v, slope, least)
        power *= power
        imag *= imag
        power += imag
        yield np.fft.fftshift(power.astype(v.real.dtype), axes=1)
