"""Fourier synchrosqueezed transform: STFT coefficients moved to their instantaneous frequency."""

from collections.abc import Iterator
from functools import lru_cache

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.processing.stft import Stft


def synchrosqueeze(v: Complex, slope: Complex, least: float) -> Complex:
    """Synchrosqueezed transform T: V[l, k] added up at bin k + round(Im(-V'/V) L/(2 pi)) modulo L.

    Both transforms have their phase referenced to sample L//2 of the frame, so that
    sum_k T = L g[L//2] x[l hop + L//2] where nothing is dropped.

    Args:
        v: Transform V [frames, L], which is overwritten.
        slope: Transform V' with the slope of the window [frames, L].
        least: Magnitude below which coefficients are dropped, as are those whose square is 0.

    Returns:
        T [frames, L].
    """
    frames, length = v.shape
    power = v.real**2
    power += v.imag**2
    dropped = power < max(least**2, float(np.finfo(power.dtype).tiny))
    power[dropped] = 1
    turn = slope.conj()
    turn *= v
    k = turn.imag / power  # Im(-V'/V) = Im(V conj V')/|V|^2
    k *= length / (2 * np.pi)
    k += 0.5
    np.floor(k, out=k)
    np.clip(k, -(2.0**52), 2.0**52, out=k)  # shifts beyond the digits of a double
    target = k.astype(np.intp)
    target += np.arange(length)
    outside = target.view(np.uintp) >= length  # or less than 0
    target[outside] %= length
    target += length * np.arange(frames)[:, None]
    v[dropped] = 0
    squeezed = np.zeros(v.size, v.dtype)
    np.add.at(squeezed, target.ravel(), v.ravel())
    return squeezed.reshape(v.shape)


def power_blocks(stft: Stft, threshold: float, single: bool = False) -> Iterator[Float]:
    """Yield |T|^2, summed over the channels, of blocks of frames [frames, frequency].

    Powers may be float32 (`single`); the coefficients are not, as one within float32's rounding of
    the border between two bins would move its power to another pixel.

    Args:
        stft: Transform of a signal of one row.
        threshold: Magnitude over the largest |V| of the map below which coefficients are dropped.
        single: Whether powers are float32.
    """
    rows, frames = stft.signal.x[:, 0], stft.frames

    @lru_cache(maxsize=1)  # of which there is often but one
    def coefficients(number: int) -> list[Complex]:
        return [stft.transform(x, stft.blocks[number], frames.window) for x in rows]

    passes = map(coefficients, range(len(stft.blocks) if threshold else 0))
    least = threshold * max((float(np.abs(v).max()) for block in passes for v in block), default=0)
    for number, block in enumerate(stft.blocks):
        each = coefficients(number)
        total = np.zeros(each[0].shape, np.float32 if single else float)
        for x, v in zip(rows, each, strict=True):
            t = synchrosqueeze(v, stft.transform(x, block, frames.window_slope), least)
            total += t.real**2 + t.imag**2
        yield np.fft.fftshift(total, axes=1)
