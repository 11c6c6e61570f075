"""Moving target indication (paper, first equation of "RTM Generation")."""

import numpy as np

from radhar_cli.arrays import Complex

FIRST_DIFFERENCE = (-1.0, 1.0)  # weights c of x[m] = sum_j c[j] y[m + j]
_CHUNK = 2**18


def mti(s: Complex) -> Complex:
    """First difference over the pulses, s[..., m + 1] - s[..., m]: [..., M] -> [..., M - 1]."""
    return np.diff(s, axis=-1)


def mti_in_place(s: Complex) -> Complex:
    """As `mti`, of a slow-time signal [M] and in its memory: what is returned is a view of it."""
    for start in range(0, s.size - 1, _CHUNK):
        stop = min(start + _CHUNK, s.size - 1)
        s[start:stop] = s[start + 1 : stop + 1] - s[start:stop]
    return s[:-1]
