"""Signals of one channel for tests of the processing."""

import numpy as np

from radhar_cli.processing.signal import Signal
from radhar_cli.radar.pulse_times import PulseTimes


def signal(x: np.ndarray, prf: float = 1.0, f0: float = 1e9, step: float = 0.5) -> Signal:
    """A sum over range [M], or range bins [K, M] that are `step` (m) apart, from 0 s on."""
    times = PulseTimes.even(x.shape[-1], prf)
    if x.ndim == 1:
        return Signal(x[None, None], times, f0)
    return Signal(x[None], times, f0, np.arange(len(x)) * step)
