"""Savitzky-Golay smoothing of a complex slow-time signal (paper, section "DTMs Generation")."""

from functools import lru_cache

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float


def savgol(x: Complex, order: int, frame: int) -> Complex:
    """Smooth x [M]: every sample becomes the value of the polynomial fitted to its frame.

    The first and last half frame are read off the first and the last fit (SciPy's edge mode
    `interp`). Order 5, frame 11 is a low-pass at 0.32 of PRF/2.

    Args:
        x: Signal [M], M at least `frame`.
        order: Degree of the polynomials.
        frame: Odd number of samples of a frame.
    """
    basis, half = _polynomials(order, frame), frame // 2
    smooth = np.empty_like(x)
    smooth[half : x.size - half] = np.convolve(x, basis @ basis[half], mode="valid")
    smooth[:half] = basis[:half] @ (basis.T @ x[:frame])
    smooth[x.size - half :] = basis[half + 1 :] @ (basis.T @ x[x.size - frame :])
    return smooth


@lru_cache(maxsize=4)
def _polynomials(order: int, frame: int) -> Float:
    """Orthonormal polynomials [frame, order + 1]: Q Q^T x is the least-squares fit to x."""
    t = np.linspace(-1, 1, frame)
    return np.linalg.qr(np.polynomial.legendre.legvander(t, order))[0]
