"""The beat matrix s_b[n, m] (paper, last but one equation of "Radar Echo Model")."""

from math import isqrt

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.numerics.phasor import unit_phasor
from radhar_cli.radar.fmcw import Waveform

BLOCK_SAMPLES = 2**18  # size of a block of the beat matrix
BLOCK = 2**11  # start phasors per block; some forty follow from each


def start_phase(delay: Float, waveform: Waveform, frequency: float) -> Float:
    """Phases [...] (cycles) of delays [...] (s) at a frequency f (Hz).

    They are f tau, less K tau^2/2 if the residual video phase is kept.
    """
    cycles = frequency * delay
    if waveform.residual_video_phase:
        cycles -= 0.5 * waveform.slope * delay * delay
    return cycles


def powers(w: Complex, count: int) -> Complex:
    """Powers w^0 .. w^(count - 1) [count, ...] of unit phasors w [...], by doubling."""
    out = np.empty((count, *w.shape), dtype=w.dtype)
    out[0] = 1
    done, factor = 1, w
    while done < count:
        more = min(done, count - done)
        np.multiply(out[:more], factor, out=out[done : done + more])
        done += more
        factor = factor * factor
    return out


def beat_matrix(delay: Float, amplitude: Float, waveform: Waveform) -> Complex:
    """Beat matrix s_b[n, m] = sum_i A_i exp(-j 2 pi (fc tau_i + K tau_i n/fs)) [N_ADC, M].

    With n = a fine + b the exponential is a product of one in a and one in b, so the sum over the
    paths is, pulse by pulse, a product of two small matrices: the same numbers to rounding, with
    two exponentials a path instead of N_ADC.

    Args:
        delay: Delays tau [I, M], s.
        amplitude: Amplitudes A [I, M].
    """
    coarse = isqrt(waveform.n_adc - 1) + 1
    fine = -(-waveform.n_adc // coarse)
    beat = np.empty((delay.shape[1], coarse, fine), dtype=complex)
    length = max(1, BLOCK // max(len(delay), 1))
    for start in range(0, len(beat), length):  # so that it stays in the cache
        block = slice(start, start + length)
        tau = delay[:, block].T  # [M, I]
        turn = waveform.slope / waveform.adc_rate * tau
        first = unit_phasor(start_phase(tau, waveform, waveform.fc)) * amplitude[:, block].T
        fast = powers(unit_phasor(turn), fine + 1)  # [fine + 1, M, I]
        slow = powers(fast[fine], coarse)  # [coarse, M, I]
        slow *= first
        np.matmul(slow.transpose(1, 0, 2), fast[:fine].transpose(1, 2, 0), out=beat[block])
    return beat.reshape(len(beat), coarse * fine)[:, : waveform.n_adc].T
