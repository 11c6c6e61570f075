"""The beat at chosen pulses alone: all that a range-time map shows."""

import numpy as np

from radhar_cli.arrays import Complex, Index
from radhar_cli.echo.beat import beat_matrix
from radhar_cli.echo.paths import PathSource
from radhar_cli.radar.waveform import Waveform


def shown_pulses(count: int, width: int) -> Index:
    """Columns of a range-time map: m_j = floor((j + 1/2) count/width), all if count < width."""
    if count <= width:
        return np.arange(count)
    return (2 * np.arange(width) + 1) * count // (2 * width)


def beat_at(source: PathSource, waveform: Waveform, pulses: Index, mti: bool) -> Complex:
    """s_b[n, m], or with mti s_b[n, m + 1] - s_b[n, m], at `pulses`: [N_ADC, len(pulses)].

    Exact in float64, without noise.
    """
    needed = np.union1d(pulses, pulses + 1) if mti else pulses
    paths = source(waveform.times(needed.astype(float)))
    if not mti:
        return beat_matrix(paths.delay, paths.amplitude, waveform)
    late, early = np.searchsorted(needed, pulses + 1), np.searchsorted(needed, pulses)
    delay = np.concatenate([paths.delay[:, late], paths.delay[:, early]])
    amplitude = np.concatenate([paths.amplitude[:, late], -paths.amplitude[:, early]])
    moves = (paths.delay != paths.delay[:, :1]) | (paths.amplitude != paths.amplitude[:, :1])
    kept = np.tile(moves.any(axis=1), 2)  # a path that stands still cancels itself exactly
    return beat_matrix(delay[kept], amplitude[kept], waveform)
