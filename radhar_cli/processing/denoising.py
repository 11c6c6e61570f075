"""Savitzky-Golay smoothing of a complex slow-time signal (paper, section "DTMs Generation")."""

import numpy as np

from radhar_cli.arrays import Complex


def savgol(x: Complex, order: int, frame: int) -> Complex:
    """Smooth real and imaginary part alike; SciPy's edge mode `interp`.

    Order 5, frame 11 is a low-pass at 0.32 of PRF/2.

    Args:
        x: [M].
        order: of the polynomial, below `frame`.
        frame: odd, at most M.
    """
    from scipy.signal import savgol_filter  # slow to import, and few maps are denoised

    parts = savgol_filter(np.stack([x.real, x.imag]), frame, order, axis=1, mode="interp")
    smooth: Complex = parts[0] + 1j * parts[1]
    return smooth
