"""Power of Doppler-time maps, made block by block, so that a map may be larger than memory."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from radhar_cli.numerics.arrays import Float
from radhar_cli.processing import fsst
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.gate import Gate
from radhar_cli.processing.power_map import Axis, PowerMap
from radhar_cli.processing.signal import Signal
from radhar_cli.processing.stft import Stft
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT


@dataclass(frozen=True)
class DopplerPower:
    """Power P[l, q] of a Doppler-time map, frame l and Doppler bin q.

    `blocks()` starts anew at each call. Powers are in units of 2^(2 exponent), where float32
    neither overflows nor vanishes.

    Attributes:
        compute: yields blocks of frames [frames, N] in the order of time.
        bins: the bins of N that the map shows.
        exponent: binary exponent of the unit of the signal.
        frequency: axis of the Doppler bins that are shown, Hz.
        time: axis of the middles of the frames, s.
    """

    compute: Callable[[], Iterator[Float]]
    bins: slice
    exponent: int
    frequency: Axis
    time: Axis

    def blocks(self) -> Iterator[Float]:
        """Yield the bins that are shown, in blocks [frames, bins] in the order of time."""
        return (block[:, self.bins] for block in self.compute())

    @property
    def frames(self) -> int:
        """Number of frames."""
        return self.time.values.size

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Outer edges (from, to of the time, s; from, to of the frequency, Hz)."""
        return (*self.time.edges, *self.frequency.edges)

    def hold_power(self) -> "DopplerPower":
        """Compute the power here and now, and hold it for all that is made of it."""
        blocks = [*self.compute()]
        return replace(self, compute=partial(iter, blocks))

    def as_map(self) -> PowerMap:
        """Map of the whole power [bins, frames] in float64, for unit transmit power."""
        power = np.concatenate(list(self.blocks()), dtype=float)
        np.ldexp(power, 2 * self.exponent, out=power)
        return PowerMap(power.T, self.frequency, self.time)


def compute_stft_power(
    signal: Signal,
    frames: Frames,
    gate: Gate | None = None,
    fft_length: int | None = None,
    sums_magnitudes: bool = False,
    limits_mps: tuple[float, float] | None = None,
    single: bool = False,
) -> DopplerPower:
    """Compute the power of the short-time Fourier transform of a signal.

    Args:
        signal: signal; powers of its channels and rows are added up.
        frames: windows.
        gate: range bins of each window that are added up; None for all rows of the signal.
        fft_length: number N of Doppler bins; None for one a pulse of the window.
        sums_magnitudes: whether magnitudes of rows are added up, and squared, instead of powers.
        limits_mps: lowest and highest speed that is shown, m/s; None for all.
        single: whether coefficients are complex64.
    """
    stft = Stft(signal, frames, fft_length, single, gate, sums_magnitudes)
    return _within_limits(stft, stft.power_blocks, limits_mps)


def compute_fsst_power(
    signal: Signal,
    frames: Frames,
    threshold: float,
    limits_mps: tuple[float, float] | None = None,
    single: bool = False,
) -> DopplerPower:
    """Compute the power of the Fourier synchrosqueezed transform of a signal.

    Args:
        signal: signal of one row; powers of its channels are added up.
        frames: windows.
        threshold: magnitude over the largest of the map below which coefficients are dropped.
        limits_mps: lowest and highest speed that is shown, m/s; None for all.
        single: whether coefficients are complex64.
    """
    stft = Stft(signal, frames, single=single)
    return _within_limits(stft, partial(fsst.power_blocks, stft, threshold), limits_mps)


def _within_limits(
    stft: Stft,
    compute: Callable[[], Iterator[Float]],
    limits_mps: tuple[float, float] | None,
) -> DopplerPower:
    """Show the Doppler bins whose middle lies within limits of the speed."""
    bins, frequency = slice(None), stft.frequency
    if limits_mps is not None:
        limits_hz = np.array(limits_mps) * 2 * stft.signal.f0 / SPEED_OF_LIGHT
        limits_hz += 1e-9 * np.array([-1, 1]) * stft.signal.prf
        bins = slice(*np.searchsorted(frequency.values, limits_hz).tolist())
    frequency = replace(frequency, values=frequency.values[bins])
    return DopplerPower(compute, bins, stft.exponent, frequency, stft.time)
