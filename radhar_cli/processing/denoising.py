"""Savitzky-Golay smoothing of a complex slow-time signal (paper, section "DTMs Generation")."""

import numpy as np

from radhar_cli.arrays import Complex

CHUNK = 2**18


def savgol(x: Complex, order: int, frame: int) -> Complex:
    """Smooth real and imaginary part alike; SciPy's edge mode `interp`.

    Order 5, frame 11 is a low-pass at 0.32 of PRF/2.

    Args:
        x: [M].
        order: of the polynomial, below `frame`.
        frame: odd, at most M.
    """
    from scipy.signal import savgol_filter  # slow to import, and few maps are denoised

    smooth, chunk = np.empty(x.size, dtype=complex), max(CHUNK, frame)
    for start in range(0, x.size, chunk):
        # Half a frame more on both sides, and a whole one where the signal ends.
        stop = min(start + chunk, x.size)
        first = max(min(start - frame // 2, x.size - frame), 0)
        wide = x[first : stop + frame // 2]
        parts = savgol_filter(np.stack([wide.real, wide.imag]), frame, order, axis=1, mode="interp")
        own = slice(start - first, stop - first)
        smooth[start:stop] = parts[0, own] + 1j * parts[1, own]
    return smooth
