"""Short-time Fourier transform (paper, last but one equation of "DTMs Generation")."""

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias

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


@dataclass(frozen=True, eq=False)
class LongSpectra:
    """Spectra too long to hold: every iteration makes the blocks [frames, N] anew, in order.

    Attributes:
        x: slow-time signal [M].
        frames: window length and hop.
        bins: N, at least L.
    """

    x: Complex
    frames: Frames
    bins: int

    @cached_property
    def blocks(self) -> list[slice]:
        """Frames of every block."""
        return self.frames.blocks(self.x.size, self.bins)

    def __len__(self) -> int:
        return len(self.blocks)

    def __iter__(self) -> Iterator[Complex]:
        for block in self.blocks:
            yield spectrum(self.x[self.frames.span(block)], self.frames, self.bins)


Spectra: TypeAlias = tuple[Complex] | LongSpectra


def spectra(x: Complex, frames: Frames, fft_length: int | None = None) -> Spectra:
    """`spectrum` in blocks of frames: of an ordinary recording one, which is held."""
    long = LongSpectra(x, frames, fft_length or frames.length)
    return long if len(long) > 1 else (spectrum(x, frames, fft_length),)


def power_map(spectra: Complex) -> Float:
    """|X|^2 [frequency, time] with the lowest frequency first and zero Doppler in the middle."""
    power = spectra.real**2
    power += spectra.imag**2
    return np.fft.fftshift(power, axes=1).T
