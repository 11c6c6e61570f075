"""Short-time Fourier transform (paper, last but one equation of "DTMs Generation")."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
import scipy.fft

from radhar_cli.arrays import Complex, Float
from radhar_cli.errors import RadharError
from radhar_cli.processing.frames import Frames


def exponent_of(x: Complex) -> int:
    """Binary exponent of the largest real or imaginary part of x.

    Raises:
        RadharError: one is an infinity or a NaN.
    """
    parts = x.real, x.imag
    largest = float(np.max([abs(f(part)) for part in parts for f in (np.min, np.max)]))
    if not np.isfinite(largest):
        raise RadharError(f"the signal should be finite; its largest part is {largest}")
    # 2^-exponent must be a double itself; denormal signals keep their digits at 2^1022.
    return max(int(np.frexp(largest)[1]), -1022)


def transform(x: Complex, frames: Frames, window: Float, bins: int, single: bool) -> Complex:
    """X[l, k] = sum_n x[l hop + n] g[n] exp(-j 2 pi k (n - L//2)/N) [frames of x, N].

    Args:
        x: [M].
        frames: window length L and hop.
        window: g [L].
        bins: N, at least L.
        single: whether to compute in complex64.
    """
    dtype: Any = np.complex64 if single else np.complex128
    cut = frames.cut(x.astype(dtype))
    g = window.astype(cut.real.dtype)
    middle = frames.length // 2
    # Sample L//2 comes first: that refers the phase to it.
    framed = np.zeros((len(cut), bins), dtype)
    np.multiply(cut[:, middle:], g[middle:], out=framed[:, : g.size - middle])
    np.multiply(cut[:, :middle], g[:middle], out=framed[:, bins - middle :])
    return np.asarray(scipy.fft.fft(framed, axis=1, overwrite_x=True))


@dataclass(frozen=True, eq=False)
class Spectra:
    """X[l, k] = sum_n x[l hop + n] g[n] exp(-j 2 pi k (n - L//2)/N), in blocks of frames.

    Iterating yields the blocks [some frames, N]. A recording of one block keeps it; those of a
    longer one are computed anew in every pass. Coefficients are those of 2^-exponent x, whose
    largest part is 1/2 to 1, so that no power of them overflows or vanishes, in float32 either.

    Attributes:
        x: slow-time signal [M].
        frames: window length L and hop.
        bins: N, at least L.
        single: whether coefficients are complex64; complex128 otherwise.
    """

    x: Complex
    frames: Frames
    bins: int
    single: bool = False

    @cached_property
    def exponent(self) -> int:
        """Binary exponent of the largest real or imaginary part of x."""
        return exponent_of(self.x)

    @property
    def count(self) -> int:
        """Number of frames."""
        return self.frames.count(self.x.size)

    @cached_property
    def blocks(self) -> list[slice]:
        """Frames of every block."""
        return self.frames.blocks(self.x.size, self.bins)

    def transform(self, block: slice, window: Float) -> Complex:
        """The sum above with another window [L], over a slice of frames."""
        part: Complex = self.x[self.frames.span(block)] * 2.0**-self.exponent
        return transform(part, self.frames, window, self.bins, self.single)

    @cached_property
    def _only(self) -> Complex:
        return self.transform(self.blocks[0], self.frames.window)

    def __iter__(self) -> Iterator[Complex]:
        if len(self.blocks) == 1:
            yield self._only
            return
        for block in self.blocks:
            yield self.transform(block, self.frames.window)


def power_blocks(spectra: Spectra) -> Iterator[Float]:
    """|X|^2 [some frames, frequency], the lowest frequency first, zero Doppler in the middle."""
    for x in spectra:
        power = np.abs(x)
        power *= power
        yield np.fft.fftshift(power, axes=1)
