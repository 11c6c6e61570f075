"""The exact reference: the whole beat matrix, noise on every sample, in float64."""

from collections.abc import Iterator

import numpy as np

from radhar_cli.arrays import Complex
from radhar_cli.echo.beat import BLOCK_SAMPLES, beat_matrix
from radhar_cli.echo.motion_in_chirp import moving_beat_matrix
from radhar_cli.echo.paths import PathSource
from radhar_cli.radar.noise import circular_gaussian
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
    source: PathSource,
    waveform: Waveform,
    sigma: float = 0.0,
    rng: np.random.Generator | None = None,
    motion_in_chirp: bool = False,
) -> Iterator[tuple[int, Complex]]:
    """Yield (first pulse, s_noisy[n, m] [N_ADC, block]) for consecutive blocks of pulses.

    Consecutive blocks share one pulse, so that differences over pulses miss none. Noise is drawn
    pulse by pulse: the numbers do not depend on the block length.

    Args:
        source: the paths.
        waveform: the radar.
        sigma: standard deviation of the noise per complex sample.
        rng: its stream, unless sigma is 0.
        motion_in_chirp: whether paths go on moving during a chirp, instead of stop-and-hop.
    """
    length = max(2, min(BLOCK_SAMPLES // waveform.n_adc, CHUNK_PULSES))
    carried: Complex | None = None
    for start in range(0, waveform.n_pulses, length):
        pulses = np.arange(start, min(start + length, waveform.n_pulses), dtype=float)
        if motion_in_chirp:
            beat = moving_beat_matrix(source, waveform, pulses)
        else:
            paths = source(waveform.times(pulses))
            beat = beat_matrix(paths.delay, paths.amplitude, waveform)
        if rng is not None:
            beat = beat + sigma * circular_gaussian(rng, (len(pulses), waveform.n_adc)).T
        if carried is not None:
            beat = np.concatenate([carried, beat], axis=1)
        carried = beat[:, -1:].copy()
        first = start if start == 0 else start - 1
        yield first, beat
