"""Fourier transforms of windowed frames, by FFTW where pyfftw is installed, by scipy otherwise."""

from collections.abc import Callable
from functools import lru_cache, partial
from threading import Lock, get_ident
from typing import Any

import numpy as np

from radhar_cli.accelerators import installed, load
from radhar_cli.arrays import Complex, Float

COEFFICIENTS = 2**15  # of frames transformed at once, which stay in a processor's cache, by FFTW
PLANNING = Lock()  # one thread at a time forgets wisdom and plans


def fill_in_spectra(found: Float | Complex, frames: Complex, window: Float) -> None:
    """X[l, k] = sum_n x[l, n] g[n] exp(-j 2 pi k (n - L//2)/N), or |X| where `found` is real."""
    size, length, middle = found.shape[1], window.size, window.size // 2
    g, fast = window.astype(frames.real.dtype), installed("pyfftw") is not None
    rows = max(1, COEFFICIENTS // size) if fast else len(frames)
    for start in range(0, len(frames), rows):
        some, put = frames[start : start + rows], found[start : start + rows]
        if fast:
            enough = min(-(-len(some) // 8) * 8, rows)  # for fewer plans
            framed, transform = _planned(enough, size, length, frames.dtype, get_ident())
        else:
            import scipy.fft  # slow to import

            framed = np.zeros((len(some), size), frames.dtype)
            transform = partial(scipy.fft.fft, framed, axis=1, overwrite_x=True)
        # Sample L//2 comes first: that refers the phase to it.
        np.multiply(some[:, middle:], g[middle:], out=framed[: len(some), : length - middle])
        np.multiply(some[:, :middle], g[:middle], out=framed[: len(some), size - middle :])
        if np.iscomplexobj(found):
            put[:] = transform()[: len(some)]
        else:
            np.abs(transform()[: len(some)], out=put)


@lru_cache(maxsize=64)
def _planned(
    count: int, size: int, length: int, dtype: Any, thread: int
) -> tuple[Complex, Callable[[], Complex]]:
    """Where to put windowed frames, zero beyond their `length`, and what transforms them.

    FFTW counts operations to choose its way: with one that it measures, or remembers from before,
    or on arrays that are aligned otherwise, bytes would differ from process to process.
    """
    fftw = load("pyfftw")
    framed, found = (fftw.zeros_aligned((count, size), dtype) for _ in range(2))
    with PLANNING:
        fftw.forget_wisdom()
        return framed, fftw.FFTW(framed, found, axes=(1,), flags=("FFTW_ESTIMATE",))
