"""Fourier transforms of windowed frames, by FFTW where pyfftw is installed, by scipy otherwise."""

import sys
from collections.abc import Callable
from functools import cache, lru_cache, partial
from threading import Lock, get_ident
from typing import Any

import numpy as np
import scipy.fft

from radhar_cli.accelerators import installed, load
from radhar_cli.arrays import Complex, Float

COEFFICIENTS = 2**15  # of frames transformed at once, which stay in a processor's cache
PLANNING = Lock()  # FFTW forgets in no thread while it plans in another


def fill_in_spectra(found: Float | Complex, frames: Complex, window: Float) -> None:
    """X[l, k] = sum_n x[l, n] g[n] exp(-j 2 pi k (n - L//2)/N), or |X| if `found` [F, N] is real.

    Frames x [F, L] are padded with zeros.
    """
    size, length, middle = found.shape[1], window.size, window.size // 2
    g, rows = window.astype(frames.real.dtype), max(1, COEFFICIENTS // size)
    transforms = _transforms(size, length, frames.dtype, get_ident())
    for start in range(0, len(frames), rows):
        some = frames[start : start + rows]
        framed, transform = transforms(len(some))
        # Sample L//2 comes first: that refers the phase to it.
        np.multiply(some[:, middle:], g[middle:], out=framed[:, : length - middle])
        np.multiply(some[:, :middle], g[:middle], out=framed[:, size - middle :])
        if np.iscomplexobj(found):
            found[start : start + rows] = transform()
        else:
            np.abs(transform(), out=found[start : start + rows])


@lru_cache(maxsize=8)
def _transforms(
    size: int, length: int, dtype: np.dtype[Any], thread: int
) -> Callable[[int], tuple[Complex, Callable[[], Complex]]]:
    """Of a count of frames: where to put them, windowed, and what transforms them.

    Frames are zero between their `length` samples and their `size`. FFTW estimates which of its
    ways is the fastest, by a count of operations: measuring would give other bytes at each start,
    and so would what it was told before or other alignments of the arrays.
    """
    shape = max(1, COEFFICIENTS // size), size
    if installed("pyfftw") is None:
        framed = np.zeros(shape, dtype)
        fft = partial(scipy.fft.fft, axis=1, overwrite_x=size == length)
        return lambda count: (framed[:count], partial(fft, framed[:count]))
    fftw = _fftw()
    framed, found = fftw.zeros_aligned(shape, dtype), fftw.empty_aligned(shape, dtype)

    @cache
    def of(count: int) -> tuple[Complex, Callable[[], Complex]]:
        here = framed[:count]
        with PLANNING:
            fftw.forget_wisdom()
            return here, fftw.FFTW(here, found[:count], axes=(1,), flags=("FFTW_ESTIMATE",))

    return of


@cache
def _fftw() -> Any:
    if "dask" in sys.modules:
        return load("pyfftw")
    # It would import dask, if that is installed, for an interface that is not used: 0.15 of 0.16 s.
    sys.modules["dask"] = None  # type: ignore[assignment]
    try:
        return load("pyfftw")
    finally:
        del sys.modules["dask"]
