"""The exact reference: W times the whole beat matrix in float64, block by block."""

from collections.abc import Callable, Iterator, Sequence

import numpy as np

from radhar_cli.echo.beat import BLOCK_SAMPLES, beat_matrix
from radhar_cli.echo.dispersion import beat_of, power_of
from radhar_cli.echo.motion_in_chirp import moving_beat_matrix
from radhar_cli.echo.paths import Paths, PathSource
from radhar_cli.echo.receiver.impairment import Impairment
from radhar_cli.numerics.arrays import Complex, Float, Index
from radhar_cli.processing.canceller import Fir
from radhar_cli.processing.look import Look, RawSamples
from radhar_cli.radar.fmcw import Waveform

CHUNK_PULSES = 2**15


def signal_power(source: PathSource, waveform: Waveform) -> float:
    """Mean P_s over the pulses of sum_i A_i^2, with the loss of a layered wall."""
    total = 0.0
    for start in range(0, waveform.n_pulses, BLOCK_SAMPLES):
        power = np.empty(min(BLOCK_SAMPLES, waveform.n_pulses - start))
        for first in range(0, power.size, CHUNK_PULSES):
            part = power[first : first + CHUNK_PULSES]
            pulses = np.arange(start + first, start + first + part.size, dtype=float)
            part[:] = power_of(source(waveform.times(pulses)), waveform)
        total += float(power.sum())
    return total / waveform.n_pulses


def beat_blocks(
    source: PathSource,
    waveform: Waveform,
    receiver: Sequence[Impairment] = (),
    motion_in_chirp: bool = False,
) -> Iterator[Complex]:
    """Yield s_b[n, m] [N_ADC, block] of consecutive blocks of pulses, after the receiver.

    Args:
        source: The paths.
        receiver: Impairments, in order.
        motion_in_chirp: Whether paths go on moving during a chirp.
    """
    raw = Look.of_all("beat", RawSamples(waveform))
    length = max(2, min(BLOCK_SAMPLES // waveform.n_adc, CHUNK_PULSES))
    for start in range(0, waveform.n_pulses, length):
        pulses = np.arange(start, min(start + length, waveform.n_pulses), dtype=float)
        if motion_in_chirp:
            beat = moving_beat_matrix(source, waveform, pulses)
        else:
            paths = source(waveform.times(pulses))
            beat = beat_of(paths, waveform)
        look = raw.part(start, start + pulses.size)
        for impairment in receiver:
            beat = impairment.apply(beat, look)
        yield beat


def exact_echo(
    source: PathSource,
    looks: Sequence[Look],
    receiver: Sequence[Impairment] = (),
    static: bool = True,
    motion_in_chirp: bool = False,
) -> list[Complex]:
    """Signals x [K, M] of several looks at one echo, in one pass through its beat matrix.

    Looks are of one waveform, with the same taps. Where static echoes do not matter
    (`static`), the first pulse is taken out of every one: of an echo that does not move, however
    strong, nothing is left to round.
    """
    waveform, taps = looks[0].fast.waveform, looks[0].taps
    signals = [np.empty((look.fast.rows, look.count), complex) for look in looks]
    canceller, first, still = Fir(taps), 0, None
    carried: Complex = np.empty((waveform.n_adc, 0), complex)
    for block in beat_blocks(source, waveform, receiver, motion_in_chirp):
        if not static:
            still = block[:, :1] if still is None else still
            block = block - still
        extended = np.concatenate([carried, block], axis=1) if carried.size else block
        carried = extended[:, extended.shape[1] - canceller.lost :]
        if extended.shape[1] <= canceller.lost:
            continue
        cancelled = canceller(extended)
        for look, x in zip(looks, signals, strict=True):
            if isinstance(look.pulses, range):
                x[:, first : first + cancelled.shape[1]] = look.fast(cancelled)
                continue
            columns = slice(*np.searchsorted(look.pulses, [first, first + cancelled.shape[1]]))
            x[:, columns] = look.fast(cancelled[:, look.pulses[columns] - first])
        first += cancelled.shape[1]
    return signals


def beat_at(
    source: Callable[[Float], Paths],
    waveform: Waveform,
    pulses: Index,
    canceller: tuple[float, ...] = (1.0,),
) -> Complex:
    """Sum of c[j] s_b[n, m + j] over j at pulses m [N_ADC, pulses], c the canceller's weights.

    Exact in float64, without noise.
    """
    needed = np.unique(pulses + np.arange(len(canceller))[:, None])
    paths = source(waveform.times(needed.astype(float)))
    if sum(canceller) == 0:  # a path that stands still cancels itself exactly
        moves = (paths.delay != paths.delay[:, :1]) | (paths.amplitude != paths.amplitude[:, :1])
        paths = paths.only(moves.any(axis=1))
    columns = [np.searchsorted(needed, pulses + lag) for lag in range(len(canceller))]
    delay = np.concatenate([paths.delay[:, some] for some in columns])
    amplitude = np.concatenate(
        [c * paths.amplitude[:, some] for c, some in zip(canceller, columns, strict=True)]
    )
    return beat_matrix(delay, amplitude, waveform)
