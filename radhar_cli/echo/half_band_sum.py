"""The sum over the kept range bins, as a function of the beat frequency.

G(u) = sum_n D[n] exp(-j 2 pi (n - n0) u),  D[n] = sum_k exp(+j 2 pi k (n - n0)/N_FFT), k over the
kept bins, u = K tau/fs (docs/physics/engines.md). It depends on the radar alone. |G| has
period 1; G itself changes sign over a period where n0 is half-integer.
"""

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.processing.look import weights
from radhar_cli.radar.waveform import Waveform

MAX_CELLS = 2**22  # size of a table; a cell has 64 bytes


@dataclass(frozen=True, eq=False)
class HalfBandTable:
    """G tabulated over one period, read by cubic Hermite interpolation."""

    waveform: Waveform  # the radar
    # table points per fast-time sample; the root-mean-square relative error is about -48, -71, -95,
    # -118 dB for 4, 8, 16, 32
    oversampling: int
    single: bool = False  # whether values are complex64; places in the table are float64
    # coefficients of the cubic in each cell, lowest power first, an array for each
    cubics: tuple[Complex, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        dtype = np.complex64 if self.single else np.complex128
        cubics = tuple(part.astype(dtype) for part in self._tabulate())
        object.__setattr__(self, "cubics", cubics)

    def _tabulate(self) -> tuple[Complex, ...]:
        waveform, size = self.waveform, self.oversampling * self.waveform.n_adc
        n = np.arange(waveform.n_adc) - waveform.n0
        d = weights(waveform)
        # exp(-j 2 pi (n - n0) u) = exp(+j 2 pi n0 u) exp(-j 2 pi n u)
        reference = np.exp(2j * np.pi * waveform.n0 * np.arange(size) / size)
        value = np.fft.fft(d, size) * reference
        slope = np.fft.fft(-2j * np.pi * n * d, size) * reference / size
        sign = np.exp(2j * np.pi * waveform.n0)
        value_next, slope_next = np.roll(value, -1), np.roll(slope, -1)
        value_next[-1] *= sign
        slope_next[-1] *= sign
        rise = value_next - value
        square = 3 * rise - 2 * slope - slope_next
        cube = slope + slope_next - 2 * rise
        return value, slope, square, cube

    def __call__(self, u: Float) -> Complex:
        """Interpolate G(u) [...] at beat frequencies u [...], cycles per sample."""
        turns = np.floor(u)
        size = self.cubics[0].size
        place = (u - turns) * size
        cell = np.minimum(place.astype(np.intp), size - 1)
        part = (place - cell).astype(self.cubics[0].real.dtype)
        value: Complex = self.cubics[3].take(cell, mode="clip")  # which is faster than "raise"
        for coefficients in self.cubics[2::-1]:
            value *= part
            value += coefficients.take(cell, mode="clip")
        if self.waveform.n0 % 1:
            value *= (1 - 2 * np.mod(turns, 2)).astype(part.dtype)
        return value


@lru_cache(maxsize=4)
def half_band_table(waveform: Waveform, oversampling: int, single: bool = False) -> HalfBandTable:
    """Table of G of a radar, computed once."""
    return HalfBandTable(waveform, oversampling, single)
