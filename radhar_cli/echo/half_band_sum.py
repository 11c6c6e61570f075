"""The sum over the kept range bins, as a function of the beat frequency.

G(u) = sum_n D[n] exp(-j 2 pi (n - n0) u),  D[n] = w[n] sum_k exp(+j 2 pi k (n - n0)/N_FFT), k over
the kept bins, u = K tau/fs (docs/physics/engines.md). It depends on the radar alone. |G| has
period 1; G itself changes sign over a period where n0 is half-integer.
"""

from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.processing.look import weights
from radhar_cli.radar.fmcw import Waveform

MAX_CELLS = 2**22  # size of a table; a cell has 64 bytes
REFERENCE_OVERSAMPLING = 32  # of quintics, which then err by -245 dB or less


@dataclass(frozen=True, eq=False)
class HalfBandTable:
    """G tabulated over one period, read by Hermite interpolation."""

    waveform: Waveform  # the radar
    # table points per fast-time sample; the root-mean-square relative error of cubics is about -48,
    # -71, -95, -118 dB for 4, 8, 16, 32
    oversampling: int
    single: bool = False  # whether values are complex64; places in the table are float64
    quintic: bool = False  # whether cells hold quintics, of G, G' and G'' at both ends, not cubics
    # coefficients of the polynomial in each cell, lowest power first, an array for each
    polynomials: tuple[Complex, ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        dtype = np.complex64 if self.single else np.complex128
        between = _quintics if self.quintic else _cubics
        polynomials = between(self._derivatives(3 if self.quintic else 2))
        object.__setattr__(self, "polynomials", tuple(part.astype(dtype) for part in polynomials))

    def _derivatives(self, count: int) -> Complex:
        """G and its derivatives by cells [count, cells + 1] at the ends of the cells."""
        waveform, size = self.waveform, self.oversampling * self.waveform.n_adc
        n = np.arange(waveform.n_adc) - waveform.n0
        terms = weights(waveform) * (-2j * np.pi * n / size) ** np.arange(count)[:, None]
        # exp(-j 2 pi (n - n0) u) = exp(+j 2 pi n0 u) exp(-j 2 pi n u)
        reference = np.exp(2j * np.pi * waveform.n0 * np.arange(size) / size)
        derivatives = np.fft.fft(terms, size) * reference
        after = derivatives[:, :1] * np.exp(2j * np.pi * waveform.n0)
        return np.concatenate([derivatives, after], axis=1)

    def __call__(self, u: Float) -> Complex:
        """Interpolate G(u) [...] at beat frequencies u [...], cycles per sample."""
        turns = np.floor(u)
        size = self.polynomials[0].size
        place = (u - turns) * size
        cell = np.minimum(place.astype(np.intp), size - 1)
        part = (place - cell).astype(self.polynomials[0].real.dtype)
        # mode="clip" is faster than "raise"
        value: Complex = self.polynomials[-1].take(cell, mode="clip")
        for coefficients in self.polynomials[-2::-1]:
            value *= part
            value += coefficients.take(cell, mode="clip")
        if self.waveform.n0 % 1:
            value *= (1 - 2 * np.mod(turns, 2)).astype(part.dtype)
        return value


def _cubics(derivatives: Complex) -> tuple[Complex, ...]:
    """Coefficients [cells] of the cubics with G and G' [2, cells + 1] at the ends of each cell."""
    (value, slope), (next_value, next_slope) = derivatives[:, :-1], derivatives[:, 1:]
    rise = next_value - value
    return value, slope, 3 * rise - 2 * slope - next_slope, slope + next_slope - 2 * rise


def _quintics(derivatives: Complex) -> tuple[Complex, ...]:
    """Coefficients [cells] of the quintics with G, G' and G'' [3, cells + 1] at the ends."""
    value, slope, curve = derivatives[:, :-1]
    # what the parabola at the first end leaves at the other one
    rise, turn, bend = derivatives[:, 1:] - (
        value + slope + curve / 2,
        slope + curve,
        curve,
    )
    return (
        value,
        slope,
        curve / 2,
        10 * rise - 4 * turn + bend / 2,
        -15 * rise + 7 * turn - bend,
        6 * rise - 3 * turn + bend / 2,
    )


@lru_cache(maxsize=4)
def half_band_table(waveform: Waveform, oversampling: int, single: bool = False) -> HalfBandTable:
    """Table of G of a radar, computed once."""
    return HalfBandTable(waveform, oversampling, single)


@lru_cache(maxsize=4)
def reference_table(waveform: Waveform) -> HalfBandTable:
    """Table of G against which sums are measured.

    It errs by the sixth power of the cell: by 2e-11 of sum |D[n]| at most, or 1.3e-9 with the phase
    reference at the start of the chirp, and usually by far less.
    """
    finest = max(1, MAX_CELLS // waveform.n_adc)
    return HalfBandTable(waveform, min(REFERENCE_OVERSAMPLING, finest), quintic=True)
