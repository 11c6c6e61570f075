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


def beat_at(
    source: PathSource, waveform: Waveform, pulses: Index, canceller: tuple[float, ...] = (1.0,)
) -> Complex:
    """sum_j c[j] s_b[n, m + j] at pulses m [N_ADC, len(pulses)], c the canceller's weights.

    Exact in float64, without noise.
    """
    needed = np.unique(pulses + np.arange(len(canceller))[:, None])
    paths = source(waveform.times(needed.astype(float)))
    at = [np.searchsorted(needed, pulses + lag) for lag in range(len(canceller))]
    delay = np.concatenate([paths.delay[:, some] for some in at])
    amplitude = np.concatenate(
        [c * paths.amplitude[:, some] for c, some in zip(canceller, at, strict=True)]
    )
    if sum(canceller) == 0:  # a path that stands still cancels itself exactly
        moves = (paths.delay != paths.delay[:, :1]) | (paths.amplitude != paths.amplitude[:, :1])
        kept = np.tile(moves.any(axis=1), len(canceller))
        delay, amplitude = delay[kept], amplitude[kept]
    return beat_matrix(delay, amplitude, waveform)
