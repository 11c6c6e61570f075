"""Bulk Doppler compensation by a torso-delay track (paper, section "DTMs Generation")."""

import numpy as np

from radhar_cli.arrays import Complex, Float
from radhar_cli.phasor import unit_phasor

CHUNK = 2**18


def compensate(x: Complex, torso_delay: Float, f0: float) -> Complex:
    """Multiply x[m] by exp(+j 2 pi f0 (tau[m'] - tau[0])), m' the later pulse of an MTI pair.

    Args:
        x: slow-time signal [M - 1] after MTI, or [M] without it.
        torso_delay: delay track tau [M], s, whoever measured it.
        f0: frequency at which the Doppler is read, Hz.
    """
    later = torso_delay[torso_delay.size - x.size :]
    out = np.empty(x.size, dtype=complex)
    for start in range(0, x.size, CHUNK):
        part = slice(start, start + CHUNK)
        out[part] = x[part] * np.conj(unit_phasor(f0 * (later[part] - torso_delay[0])))
    return out
