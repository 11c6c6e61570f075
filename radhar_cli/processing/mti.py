"""Moving target indication (paper, first equation of "RTM Generation")."""

import numpy as np

from radhar_cli.arrays import Complex


def mti(s: Complex) -> Complex:
    """First difference over the pulses, s[..., m + 1] - s[..., m]: [..., M] -> [..., M - 1]."""
    return np.diff(s, axis=-1)
