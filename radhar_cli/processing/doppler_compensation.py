"""Bulk Doppler compensation by a torso-delay track (paper, section "DTMs Generation")."""

from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.numerics.phasor import unit_phasor


def compensate(x: Complex, torso_delay: Float, f0: float) -> Complex:
    """Multiply x[m] by exp(+j 2 pi f0 (tau[m'] - tau[0])), m' the later pulse of an MTI pair.

    Args:
        x: Signal [..., M - 1] after MTI, or [..., M] without it.
        torso_delay: Delays tau of the torso [M], s.
        f0: Frequency at which Doppler is read, Hz.
    """
    later = torso_delay[torso_delay.size - x.shape[-1] :]
    return unit_phasor(f0 * (torso_delay[0] - later)) * x
