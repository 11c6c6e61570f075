"""Fourier synchrosqueezed transform: STFT coefficients moved to their instantaneous frequency."""

from collections.abc import Iterator

import numpy as np

from radhar_cli.arrays import Complex, Float
from radhar_cli.processing.stft import Stft


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


def power_blocks(stft: Stft, threshold: float) -> Iterator[Float]:
    """|T|^2 summed over the channels of a signal of one row [some frames, frequency].

    Args:
        stft: of the signal, with N = L.
        threshold: coefficients below it times the largest |V| of the whole map are dropped.
    """
    rows, frames = stft.signal.x[:, 0], stft.frames

    def coefficients(block: slice) -> list[Complex]:
        return [stft.transform(x, block, frames.window) for x in rows]

    kept = [coefficients(block) for block in stft.blocks[:1]] if len(stft.blocks) == 1 else None
    least = 0.0
    if threshold:
        passes = kept or map(coefficients, stft.blocks)
        least = threshold * max(float(np.abs(v).max()) for block in passes for v in block)
    for number, block in enumerate(stft.blocks):
        total: Float | None = None
        each = kept[number] if kept else coefficients(block)
        for x, v in zip(rows, each, strict=True):
            power, imag = synchrosqueeze(v, stft.transform(x, block, frames.window_slope), least)
            power *= power
            imag *= imag
            power += imag
            total = power if total is None else total + power
        assert total is not None
        yield np.fft.fftshift(total.astype(each[0].real.dtype), axes=1)
