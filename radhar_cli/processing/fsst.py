"""Fourier synchrosqueezed transform: STFT coefficients moved to their instantaneous frequency."""

from collections.abc import Iterator
from functools import lru_cache
from math import sqrt
from typing import Any

import numpy as np

from radhar_cli.numerics.accelerators import installed, machine_code
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.processing.fourier import COEFFICIENTS, spectra_by_parts
from radhar_cli.processing.stft import Stft

MIN_COEFFICIENTS = 2**17  # of a map; with fewer, numba takes longer to load than 300 maps save
# Largest shift that has its digits, and integers that hold it, signed and not; 32 bits are quicker.
_OF_SINGLE: tuple[float, Any, Any] = 2.0**24, np.int32, np.uint32
_OF_DOUBLE: tuple[float, Any, Any] = 2.0**52, np.int64, np.uint64


def synchrosqueeze(v: Complex, slope: Complex, least: float) -> Complex:
    """Synchrosqueezed transform T: V[l, k] added up at bin k + round(Im(-V'/V) L/(2 pi)) modulo L.

    Both transforms have their phase referenced to sample L//2 of the frame, so that
    sum_k T = L g[L//2] x[l hop + L//2] where nothing is dropped.

    Args:
        v: Transform V [frames, L], complex64 or complex128, which is overwritten.
        slope: Transform V' with the slope of the window [frames, L], which is overwritten.
        least: Magnitude below which coefficients are dropped, as are those whose square is 0.

    Returns:
        T [frames, L].
    """
    length = v.shape[1]
    power = squared_magnitudes(v)
    dropped = power < max(least**2, float(np.finfo(power.dtype).tiny))
    power[dropped] = 1
    np.conjugate(slope, out=slope)
    slope *= v
    k = slope.imag / power  # Im(-V'/V) = Im(V conj V')/|V|^2
    k *= length / (2 * np.pi)
    k += 0.5
    np.floor(k, out=k)
    farthest, integer, unsigned = _OF_SINGLE if v.dtype == np.complex64 else _OF_DOUBLE
    np.clip(k, -farthest, farthest, out=k)
    target = k.astype(integer)
    target += np.arange(length, dtype=integer)
    outside = np.flatnonzero(target.view(unsigned) >= length)  # or less than 0
    target.ravel()[outside] %= length
    target += np.arange(0, v.size, length, dtype=integer)[:, None]
    v[dropped] = 0
    squeezed = np.zeros(v.size, v.dtype)
    np.add.at(squeezed, target.ravel(), v.ravel())
    return squeezed.reshape(v.shape)


def squared_magnitudes(z: Complex) -> Float:
    """|z|^2 of complex numbers, of any shape."""
    real: Any = z.real.dtype
    squares = np.square(z.view(real))
    power: Float = squares[..., ::2] + squares[..., 1::2]
    return power


def power_blocks(stft: Stft, threshold: float) -> Iterator[Float]:
    """Yield |T|^2, summed over the channels, of blocks of frames [frames, frequency].

    Of a transform in single precision powers are float32. One coefficient in 1e5 or fewer then lies
    within rounding of the border between two bins, and goes to the other one. numba, where it is
    installed, compiles the sums of those that are large.

    Args:
        stft: Transform of a signal of one row.
        threshold: Magnitude over the largest |V| of the map below which coefficients are dropped.
    """
    rows, frames = stft.signal.x[:, 0], stft.frames

    @lru_cache(maxsize=1)  # of which there is often but one
    def coefficients(number: int) -> list[Complex]:
        return [stft.transform(x, stft.blocks[number], frames.window) for x in rows]

    passes = map(coefficients, range(len(stft.blocks) if threshold else 0))
    largest = max((_largest_power(v) for block in passes for v in block), default=0.0)
    least = threshold * sqrt(largest)
    is_large = stft.single and stft.starts.size * stft.size >= MIN_COEFFICIENTS
    compiled = is_large and installed("numba") is not None
    add = _add_squeezed_power_compiled if compiled else _add_squeezed_power
    for number, block in enumerate(stft.blocks):
        each = coefficients(number)
        total = np.zeros(each[0].shape, each[0].real.dtype)
        for x, v in zip(rows, each, strict=True):
            segments = stft.segments(x, block)
            for part, slope in spectra_by_parts(segments, frames.window_slope, stft.size):
                add(total[part], v[part], slope, least)
        yield total


def _add_squeezed_power(total: Float, v: Complex, slope: Complex, least: float) -> None:
    """Add |T|^2, frequencies rising, to a total [frames, L]; arguments of `synchrosqueeze`."""
    middle, after = v.shape[1] // 2, -(-v.shape[1] // 2)
    power = squared_magnitudes(synchrosqueeze(v, slope, least))
    total[:, middle:] += power[:, :after]
    total[:, :middle] += power[:, after:]


def _add_squeezed_power_compiled(total: Float, v: Complex, slope: Complex, least: float) -> None:
    """Do as `_add_squeezed_power`, of complex64, in one pass over the coefficients."""
    least_power = np.float32(max(least**2, float(np.finfo(np.float32).tiny)))
    machine_code(_add_squeezed_rows)(total, v, slope, least_power)


def _add_squeezed_rows(total: Float, v: Complex, slope: Complex, least_power: np.float32) -> None:
    """Loops of `_add_squeezed_power_compiled`, for numba to compile.

    Args:
        total: Sum of |T|^2, frequencies rising [frames, L], float32, which is added to.
        v: Transform V [frames, L], complex64.
        slope: Transform V' with the slope of the window [frames, L], complex64.
        least_power: |V|^2 below which coefficients are dropped.
    """
    length = v.shape[1]
    bins, farthest = np.float32(length / (2 * np.pi)), np.float32(_OF_SINGLE[0])
    shift, squeezed = np.empty(length, np.int32), np.empty((length, 2), np.float32)
    for row in range(len(v)):
        for k in range(length):
            real, imag = v[row, k].real, v[row, k].imag
            cross = slope[row, k].real * imag - slope[row, k].imag * real
            power = max(real * real + imag * imag, least_power)
            turn = min(max(bins * (cross / power) + np.float32(0.5), -farthest), farthest)
            shift[k] = np.int32(np.floor(turn))
        squeezed[:] = 0
        for k in range(length):
            real, imag = v[row, k].real, v[row, k].imag
            if real * real + imag * imag >= least_power:
                target = k + shift[k]
                if target < 0 or target >= length:
                    target %= length
                squeezed[target, 0] += real
                squeezed[target, 1] += imag
        for k in range(length):
            rising = k + length // 2 if k < length - length // 2 else k - (length - length // 2)
            total[row, rising] += squeezed[k, 0] ** 2 + squeezed[k, 1] ** 2


def _largest_power(v: Complex) -> float:
    """Largest |V|^2 of a transform [frames, L], a few frames at a time."""
    count = max(1, COEFFICIENTS // v.shape[1])
    parts = (v[first : first + count] for first in range(0, len(v), count))
    return max(float(squared_magnitudes(part).max()) for part in parts)
