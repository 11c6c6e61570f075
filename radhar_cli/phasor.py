"""Unit phasors of phases in cycles."""

from typing import Any

import numpy as np

from radhar_cli.arrays import Complex, Float


def unit_phasor(cycles: Float, dtype: Any = np.complex128) -> Complex:
    """exp(-j 2 pi cycles), the whole turns removed first, in the precision of dtype."""
    out: Complex = np.empty(cycles.shape, dtype)
    angle = (cycles - np.rint(cycles)).astype(out.real.dtype)
    angle *= -2 * np.pi
    np.cos(angle, out=out.real)
    np.sin(angle, out=out.imag)
    return out
