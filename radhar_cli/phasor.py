"""Unit phasors of phases in cycles."""

import numpy as np

from radhar_cli.arrays import Complex, Float


def unit_phasor(cycles: Float) -> Complex:
    """exp(-j 2 pi cycles), the whole turns removed first."""
    angle = (cycles - np.rint(cycles)) * (-2 * np.pi)
    out = np.empty(cycles.shape, dtype=complex)
    np.cos(angle, out=out.real)
    np.sin(angle, out=out.imag)
    return out
