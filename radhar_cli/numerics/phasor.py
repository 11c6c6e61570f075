"""Unit phasors of phases in cycles."""

from typing import Any

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float


def unit_phasor(cycles: Float, dtype: Any = np.complex128) -> Complex:
    """exp(-j 2 pi cycles) for phases of any shape, in the precision of dtype.

    Whole turns are removed first, in the precision of `cycles`.
    """
    out: Complex = np.empty(cycles.shape, dtype)
    angle = (cycles - np.rint(cycles)).astype(out.real.dtype, copy=False)
    angle *= -2 * np.pi
    # Sines straight into every other number take twice as long.
    out.real = np.cos(angle)
    out.imag = np.sin(angle, out=angle)
    return out
