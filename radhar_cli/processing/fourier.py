"""Fourier transforms of windowed frames, by FFTW where pyfftw is installed, by scipy otherwise."""

from collections.abc import Callable, Iterator
from functools import lru_cache, partial
from threading import Lock, get_ident
from typing import Any

import numpy as np

from radhar_cli.numerics.accelerators import installed, load
from radhar_cli.numerics.arrays import Complex, Float

COEFFICIENTS = 2**15  # of frames transformed at once, which stay in a processor's cache, by FFTW
PLANNING = Lock()  # one thread at a time forgets wisdom and plans


def fill_in_spectra(spectra: Float | Complex, frames: Complex, window: Float) -> None:
    """Fill in X[l, k] = sum_n x[l, n] g[n] exp(-j 2 pi k (n - L//2)/N), or |X|.

    Args:
        spectra: X or, where it is real, |X| [frames, N], which is filled in.
        frames: Frames x [frames, L].
        window: Window g [L].
    """
    for rows, spectrum in spectra_by_parts(frames, window, spectra.shape[1]):
        if np.iscomplexobj(spectra):
            spectra[rows] = spectrum
        else:
            np.abs(spectrum, out=spectra[rows])


def spectra_by_parts(frames: Complex, window: Float, size: int) -> Iterator[tuple[slice, Complex]]:
    """Yield X of a few frames at a time, and which: X may be overwritten, as the next one does.

    Args:
        frames: Frames x [frames, L].
        window: Window g [L].
        size: Number N of frequencies.
    """
    length, middle = window.size, window.size // 2
    g, by_fftw = window.astype(frames.real.dtype), installed("pyfftw") is not None
    rows = max(1, COEFFICIENTS // size) if by_fftw else len(frames)
    for start in range(0, len(frames), rows):
        block = frames[start : start + rows]
        if by_fftw:
            planned_rows = min(-(-len(block) // 8) * 8, rows)  # for fewer plans
            framed, transform = _planned(planned_rows, size, length, frames.dtype, get_ident())
        else:
            import scipy.fft  # slow to import

            framed = np.zeros((len(block), size), frames.dtype)
            transform = partial(scipy.fft.fft, framed, axis=1, overwrite_x=True)
        # Sample L//2 comes first: that refers the phase to it.
        np.multiply(block[:, middle:], g[middle:], out=framed[: len(block), : length - middle])
        np.multiply(block[:, :middle], g[:middle], out=framed[: len(block), size - middle :])
        yield slice(start, start + len(block)), transform()[: len(block)]


@lru_cache(maxsize=64)
def _planned(
    count: int, size: int, length: int, dtype: Any, thread: int
) -> tuple[Complex, Callable[[], Complex]]:
    """Buffer for windowed frames [count, size], zero beyond `length`, and its transform.

    FFTW counts operations to choose its way: with one that it measures, or remembers from before,
    or on arrays that are aligned otherwise, bytes would differ from process to process.
    """
    fftw = load("pyfftw")
    framed, spectrum = (fftw.zeros_aligned((count, size), dtype) for _ in range(2))
    with PLANNING:
        fftw.forget_wisdom()
        return framed, fftw.FFTW(framed, spectrum, axes=(1,), flags=("FFTW_ESTIMATE",))
