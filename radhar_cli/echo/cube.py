"""The exact reference: the whole beat matrix in float64."""

from collections.abc import Iterator

import numpy as np

from radhar_cli.arrays import Complex
from radhar_cli.echo.beat import BLOCK_SAMPLES, beat_matrix
from radhar_cli.echo.motion_in_chirp import moving_beat_matrix
from radhar_cli.echo.paths import PathSource
from radhar_cli.radar.waveform import Waveform

CHUNK_PULSES = 2**15


def signal_power(source: PathSource, waveform: Waveform) -> float:
    """P_s = mean over the pulses of sum_i A_i^2."""
    total = 0.0
    for start in range(0, waveform.n_pulses, BLOCK_SAMPLES):
        power = np.empty(min(BLOCK_SAMPLES, waveform.n_pulses - start))
        for first in range(0, power.size, CHUNK_PULSES):
            part = power[first : first + CHUNK_PULSES]
            pulses = np.arange(start + first, start + first + part.size, dtype=float)
            a = source(waveform.times(pulses)).amplitude
            part[:] = np.einsum("im,im->m", a, a)
        total += float(power.sum())
    return total / waveform.n_pulses


def beat_blocks(
    source: PathSource, waveform: Waveform, motion_in_chirp: bool = False
) -> Iterator[Complex]:
    """Yield s_b[n, m] [N_ADC, block] of consecutive blocks of pulses, without noise.

    Args:
        source: the paths.
        waveform: the radar.
        motion_in_chirp: whether paths go on moving during a chirp, instead of stop-and-hop.
    """
    length = max(2, min(BLOCK_SAMPLES // waveform.n_adc, CHUNK_PULSES))
    for start in range(0, waveform.n_pulses, length):
        pulses = np.arange(start, min(start + length, waveform.n_pulses), dtype=float)
        if motion_in_chirp:
            yield moving_beat_matrix(source, waveform, pulses)
        else:
            paths = source(waveform.times(pulses))
            yield beat_matrix(paths.delay, paths.amplitude, waveform)
