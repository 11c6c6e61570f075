"""The beat matrix of paths that go on moving during a chirp: tau(t_m + n/fs), A(t_m + n/fs).

Paths are evaluated exactly at five Chebyshev points of each chirp; the samples between are on the
polynomial of degree four through them. With L = (N_ADC - 1)/fs it errs by at most
|tau^(5)| L^5/61440. For 0.1 m at 15 Hz, faster than any limb, that is 6e-16 cycles at 77 GHz in
40 us (6e-9 in 1 ms), where rounding of fc tau makes 1e-13. Where a position or the way through a
wall has a kink within a chirp, that chirp alone gets the smooth curve.
"""

from functools import lru_cache

import numpy as np

from radhar_cli.echo.beat import start_phase
from radhar_cli.echo.dispersion import WallTransfer
from radhar_cli.echo.interpolation import lagrange_basis
from radhar_cli.echo.paths import PathSource
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.numerics.phasor import unit_phasor
from radhar_cli.radar.fmcw import Waveform

NODES = 5


def chebyshev_nodes() -> Float:
    """Zeros of T_5 in -1 .. 1, rising [NODES]."""
    return -np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)


@lru_cache(maxsize=4)
def chirp_weights(count: int) -> Float:
    """Weights [NODES, count] of the nodes at `count` equispaced samples from -1 to 1."""
    return lagrange_basis(chebyshev_nodes(), np.linspace(-1, 1, count))


def moving_beat_matrix(source: PathSource, waveform: Waveform, pulses: Float) -> Complex:
    """Beat matrix sum_i A_i exp(-j 2 pi (fc tau_i + K tau_i n/fs)) [N_ADC, M].

    A and tau are those at t_m + n/fs.
    """
    sample = np.arange(waveform.n_adc) / waveform.adc_rate
    within = (chebyshev_nodes() + 1) / 2 * sample[-1]
    t = waveform.times(pulses)[:, None] + within
    paths = source(t.ravel())
    beat = np.zeros((pulses.size, waveform.n_adc), dtype=complex)
    wall = None if paths.through is None else WallTransfer(paths.through, waveform)
    for path, (delay, amplitude) in enumerate(zip(paths.delay, paths.amplitude, strict=True)):
        tau = _at_samples(delay.reshape(t.shape), waveform.n_adc)
        cycles = start_phase(tau, waveform, waveform.fc)
        tau *= waveform.slope * sample
        cycles += tau
        turning = unit_phasor(cycles)
        turning *= _at_samples(amplitude.reshape(t.shape), waveform.n_adc)
        for cosine in [] if paths.through is None else paths.through.cosine[:, path]:
            assert wall is not None
            at_nodes = wall(cosine.reshape(t.shape))
            turning *= np.einsum("nmk,kn->mn", at_nodes, chirp_weights(waveform.n_adc))
        beat += turning
    return beat.T


def _at_samples(at_nodes: Float, count: int) -> Float:
    """Interpolate [M, NODES] to [M, count]; what does not change stays as it is to the last bit."""
    first = at_nodes[:, :1]
    dense: Float = (at_nodes[:, 1:] - first) @ chirp_weights(count)[1:]
    dense += first
    return dense
