"""The beat at chosen pulses alone: all that a range-time map shows."""

import numpy as np

from radhar_cli.arrays import Complex, Index
from radhar_cli.echo.beat import beat_matrix
from radhar_cli.echo.paths import PathSource
from radhar_cli.radar.noise import circular_gaussian
from radhar_cli.radar.waveform import Waveform


def shown_pulses(count: int, width: int) -> Index:
    """Columns of a range-time map: m_j = floor((j + 1/2) count/width), all if count < width."""
    if count <= width:
        return np.arange(count)
    return (2 * np.arange(width) + 1) * count // (2 * width)


def beat_at(
    source: PathSource,
    waveform: Waveform,
    pulses: Index,
    sigma: float = 0.0,
    rng: np.random.Generator | None = None,
) -> Complex:
    """s_noisy[n, m] at `pulses` [N_ADC, len(pulses)], exact in float64.

    Args:
        source: the paths.
        waveform: the radar.
        pulses: pulse numbers.
        sigma: standard deviation of the noise per complex sample.
        rng: its stream, or None without noise.
    """
    paths = source(waveform.times(pulses.astype(float)))
    beat = beat_matrix(paths.delay, paths.amplitude, waveform)
    if rng is not None:
        beat = beat + sigma * circular_gaussian(rng, (pulses.size, waveform.n_adc)).T
    return beat
