"""The beat matrix of paths through a layered wall, whose legs keep H(f) of their field.

s_b[n, m] = sum_i A_i H_tx,i(f_n) H_rx,i(f_n) exp(-j 2 pi (fc tau_i + K tau_i n/fs)),
f_n = fc + K n/fs. H is smooth in the cosine of the angle: it is computed at Chebyshev points of the
angles that there are, as many as leave 1e-13, and interpolated to the paths.
"""

from collections.abc import Iterator

import numpy as np
from numpy.polynomial import chebyshev

from radhar_cli.echo.beat import beat_matrix, powers, start_phase
from radhar_cli.echo.paths import Paths, Through
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.numerics.phasor import unit_phasor
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.layers import Layers

BLOCK = 2**16  # samples of all paths at once
ROUNDING = 1e-13
DEGREES = (16, 32, 64, 128, 256)
NARROW = 1e-6  # of cosines, below which they make no polynomial


def beat_of(paths: Paths, waveform: Waveform) -> Complex:
    """Beat matrix s_b[n, m] [N_ADC, M] of paths, through a layered wall or not."""
    if paths.through is None:
        return beat_matrix(paths.delay, paths.amplitude, waveform)
    wall = WallTransfer(paths.through, waveform)
    beat = np.empty((waveform.n_adc, paths.delay.shape[1]), complex)
    for block, field in wall.two_way_blocks(paths.through):
        tau = paths.delay[:, block]
        turn = unit_phasor(waveform.slope / waveform.adc_rate * tau)
        first = unit_phasor(start_phase(tau, waveform, waveform.fc)) * paths.amplitude[:, block]
        field *= powers(turn, waveform.n_adc)
        beat[:, block] = np.einsum("nim,im->nm", field, first)
    return beat


def power_of(paths: Paths, waveform: Waveform) -> Float:
    """Power sum_i A_i^2 [M], through a layered wall in the mean over a chirp."""
    a = paths.amplitude
    if paths.through is None:
        alone: Float = np.einsum("im,im->m", a, a)
        return alone
    wall = WallTransfer(paths.through, waveform)
    power = np.empty(a.shape[1])
    for block, field in wall.two_way_blocks(paths.through):
        power[block] = np.einsum("nim,im->m", np.abs(field) ** 2, a[:, block] ** 2)
    return power / waveform.n_adc


class WallTransfer:
    """Transfer function H of legs at the fast-time samples of a radar, by the cosine."""

    def __init__(self, through: Through, waveform: Waveform) -> None:
        cosines = through.cosine[np.isfinite(through.cosine)]
        self.low, self.high = cosines.min(initial=1.0), cosines.max(initial=0.0)
        self.low = min(self.low, self.high - NARROW)
        self.layers, self.f = through.layers, waveform.frequencies()
        self.coefficients = _polynomial(self.layers, self.f, self.low, self.high)

    def two_way_blocks(self, through: Through) -> Iterator[tuple[slice, Complex]]:
        """Yield slices of pulses, and H_tx H_rx [N_ADC, I, pulses] of their paths."""
        _, paths, pulses = through.cosine.shape
        length = max(1, BLOCK // (self.f.size * max(paths, 1)))
        for start in range(0, pulses, length):
            tx, rx = through.cosine[..., start : start + length]
            yield slice(start, start + length), self(tx) * self(rx)

    def __call__(self, cosine: Float) -> Complex:
        """Evaluate H [N_ADC, ...] at cosines [...]; it is 1 where they are NaN: beside the wall."""
        x = (2 * cosine - self.low - self.high) / (self.high - self.low)
        crossed = np.isfinite(x)
        if self.coefficients is None:
            f = self.f.reshape(-1, *(1,) * x.ndim)
            return np.where(
                crossed, self.layers.transfer_function(f, np.where(crossed, cosine, 1)), 1
            )
        terms = chebyshev.chebvander(np.where(crossed, x, 0).ravel(), len(self.coefficients) - 1)
        h = (terms @ self.coefficients.view(float)).view(complex).T.reshape(-1, *x.shape)
        return np.where(crossed, h, 1)


def _polynomial(layers: Layers, f: Float, low: float, high: float) -> Complex | None:
    """Coefficients [degree + 1, N] of Chebyshev polynomials in the cosine from low to high.

    There are none, None, for a wall that rings too sharply.
    """
    for degree in DEGREES:
        x = chebyshev.chebpts1(degree)
        cosine = low + (x + 1) * (high - low) / 2
        h = layers.transfer_function(f, cosine[:, None])
        fit = 2 / degree * chebyshev.chebvander(x, degree - 1).T @ h
        fit[0] /= 2
        small = np.abs(fit).max(axis=1) < ROUNDING * np.abs(fit).max()
        if small[-2:].all():
            return np.ascontiguousarray(fit[: np.flatnonzero(~small)[-1] + 1])
    return None
