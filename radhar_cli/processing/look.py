"""Looks at an echo: a functional W of fast time, at some pulses of slow time.

    x[k, m] = sum_n W[k, n] sum_j taps[j] s[n, p_m + j]

of the beat matrix s. W [K, N_ADC] has one row for the coherent sum over range, one a bin for range
bins, and is the identity for a raw recording. White noise of unit variance a raw sample has the
covariance W W^H in x.
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import Any, TypeVar

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float, Index
from radhar_cli.processing.range_compression import range_compression
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.impulse import Impulse

State = TypeVar("State")
BLOCK = 2**13  # pulses of a slow-time process made at once


class FastTime(ABC):
    """A linear functional of fast time: W [rows, N_ADC]."""

    waveform: Waveform

    @property
    @abstractmethod
    def rows(self) -> int:
        """Number K of rows of x."""

    @property
    def white(self) -> bool:
        """Whether rows of W are orthogonal, so that white noise is independent from row to row."""
        return True

    @property
    def rank(self) -> int:
        """Number of independent processes that white noise consists of in x."""
        return self.rows

    @abstractmethod
    def __call__(self, s: Complex) -> Complex:
        """Product W s [K, M] with a beat matrix s [N_ADC, M]."""

    @abstractmethod
    def colour(self, v: Complex, scale: float = 1.0) -> Complex:
        """Colour white noise as W does: scale L v [K, M], L L^H = W W^H.

        Args:
            v: White noise [rank, M] of variance 1, which may be overwritten.
            scale: Factor.
        """


@dataclass(frozen=True)
class RawSamples(FastTime):
    """Raw samples: W is the identity."""

    waveform: Waveform

    @property
    def rows(self) -> int:
        return self.waveform.n_adc

    def __call__(self, s: Complex) -> Complex:
        return s

    def colour(self, v: Complex, scale: float = 1.0) -> Complex:
        v *= scale
        return v


@dataclass(frozen=True)
class RangeSum(FastTime):
    """The coherent sum over the kept range bins: W = D[n], one row."""

    waveform: Waveform

    @property
    def rows(self) -> int:
        return 1

    def __call__(self, s: Complex) -> Complex:
        return weights(self.waveform)[None] @ s

    def colour(self, v: Complex, scale: float = 1.0) -> Complex:
        v *= scale * np.sqrt(noise_gain(self.waveform))
        return v


@dataclass(frozen=True)
class RangeBins(FastTime):
    """Range bins, all that are kept or some consecutive ones, referred to as the waveform is."""

    waveform: Waveform  # the radar
    bins: slice | None = None  # some of the N_FFT/2 bins; None for all

    @property
    def rows(self) -> int:
        return len(range(self.waveform.n_bins)[self._bins])

    @property
    def white(self) -> bool:
        """Whether the transform is orthogonal: neither padded nor windowed."""
        return self.waveform.orthogonal

    @property
    def rank(self) -> int:
        if self.white:
            return self.rows
        return self.waveform.n_adc if self.bins is None else min(self.rows, self.waveform.n_adc)

    def __call__(self, s: Complex) -> Complex:
        return range_compression(s, self.waveform, self._bins)

    def colour(self, v: Complex, scale: float = 1.0) -> Complex:
        if self.white:
            v *= scale * np.sqrt(self.waveform.n_adc)
            return v
        if self.rank == self.waveform.n_adc:  # as many numbers as samples: these themselves
            v *= scale
            return self(v)
        assert self.bins is not None
        real: Any = v.real.dtype
        factor = _colour_factor(self.waveform, self.rows, real)
        coloured = (factor @ np.ascontiguousarray(v).view(real)).view(v.dtype)
        middle = (self.waveform.n_adc - 1) / 2 - self.waveform.n0
        k = np.arange(self.bins.start, self.bins.stop)[:, None]
        turned: Complex = coloured * (
            scale * np.exp(2j * np.pi * np.mod(k * middle / self.waveform.n_fft, 1))
        )
        return turned

    def consecutive(self, first: int, stop: int) -> "RangeBins":
        """Range bins of the rows first .. stop - 1 of these."""
        begin = self._bins.start or 0
        return replace(self, bins=slice(begin + first, begin + stop))

    @property
    def _bins(self) -> slice:
        return slice(None) if self.bins is None else self.bins


@dataclass(frozen=True)
class ProfileSamples(RangeBins):
    """Samples over range, real or complex, as an impulse radar takes them: W is the identity."""

    waveform: Impulse

    @property
    def white(self) -> bool:
        return True

    def __call__(self, s: Complex) -> Complex:
        return s

    def colour(self, v: Complex, scale: float = 1.0) -> Complex:
        """Make noise of variance scale^2 of v: real noise where the samples are real."""
        if self.waveform.is_iq:
            v *= scale
            return v
        v.real *= scale * np.sqrt(2)
        v.imag = 0
        return v


def _colour_factor(waveform: Waveform, count: int, real: Any) -> Float:
    """Factor L [count, count] of the covariance of consecutive bins, fewer than samples.

    Referred to the middle of the samples it is the real L L^T = sum_n w[n]^2 cos(2 pi (k - k') (n -
    (N_ADC - 1)/2)/N_FFT), wherever the bins are. L is lower triangular, so that the factor of fewer
    bins is a part of it.
    """
    size = max(16, 1 << (count - 1).bit_length())  # so that few are worked out
    return _lower_factor(waveform, size, real)[:count, :count]


@lru_cache(maxsize=8)
def _lower_factor(waveform: Waveform, count: int, real: Any) -> Float:
    """Factor L [count, 2 N_ADC or less] of `_colour_factor`."""
    n = np.arange(waveform.n_adc)[:, None] - (waveform.n_adc - 1) / 2
    angle = 2 * np.pi * np.mod(n * np.arange(count) / waveform.n_fft, 1)
    waves = np.concatenate([np.cos(angle), np.sin(angle)])
    waves *= np.tile(waveform.window.weights(waveform.n_adc), 2)[:, None]
    upper: Any = np.linalg.qr(waves, mode="r")
    factor: Float = upper.T.astype(real)
    return factor


@lru_cache(maxsize=4)
def weights(waveform: Waveform) -> Complex:
    """Weights D[n] = w[n] sum_k exp(+j 2 pi k (n - n0)/N_FFT) [N_ADC], k over the kept bins."""
    n = np.arange(waveform.n_adc) - waveform.n0
    # A geometric series; its ratio is 1 where n - n0 = 0 mod N_FFT.
    angle = np.pi * n / waveform.n_fft
    is_pole = np.isclose(np.sin(angle), 0, atol=1e-12)
    with np.errstate(invalid="ignore", divide="ignore"):
        series = np.exp(1j * (waveform.n_bins - 1) * angle) * (
            np.sin(waveform.n_bins * angle) / np.sin(angle)
        )
    weighted: Complex = np.where(is_pole, waveform.n_bins, series)
    weighted *= waveform.window.weights(waveform.n_adc)
    return weighted


def noise_gain(waveform: Waveform) -> float:
    """Variance gain sum_n |D[n]|^2 of white noise through compression and the sum over bins."""
    return float(np.sum(np.abs(weights(waveform)) ** 2))


@dataclass(frozen=True, eq=False)
class Look:
    """Samples x[k, m] of an echo after a canceller: which of fast time, and at which pulses."""

    name: str  # name of the look, and of its random streams
    fast: FastTime  # W
    pulses: Index | range  # p_m [M], rising
    taps: tuple[float, ...] = (1.0,)  # taps of the canceller
    # where rows are drawn one after the other, the pulses of each that count
    spans: Sequence[slice] | None = None
    # of all pulses of a recording those that are looked at once its mean is taken out: the others
    # count by their sum alone
    columns: Index | None = None
    # state of each impairment from one block of pulses to the next, by its id
    _states: dict[int, tuple[object, Any]] = field(default_factory=dict, repr=False)

    @classmethod
    def of_all(
        cls,
        name: str,
        fast: FastTime,
        taps: tuple[float, ...] = (1.0,),
        spans: Sequence[slice] | None = None,
    ) -> "Look":
        """Look at all pulses of the waveform."""
        return cls(name, fast, range(fast.waveform.n_pulses - len(taps) + 1), taps, spans)

    @property
    def count(self) -> int:
        """Number M of pulses."""
        return len(self.pulses)

    def state_of(self, impairment: object, start: Callable[[str], State]) -> State:
        """State of an impairment from one block of pulses to the next.

        Args:
            impairment: The impairment that asks.
            start: Makes the first state from a name for random streams: that of the look, for the
                second and later impairments of the same class with their number.

        Returns:
            What `start` made, the same for all parts of a look.
        """
        if id(impairment) not in self._states:
            earlier = sum(type(other) is type(impairment) for other, _ in self._states.values())
            name = f"{self.name} {earlier + 1}" if earlier else self.name
            self._states[id(impairment)] = impairment, start(name)
        state: State = self._states[id(impairment)][1]
        return state

    def part(self, first: int, stop: int) -> "Look":
        """Look at the pulses first .. stop - 1 of this one, with the same states of impairments."""
        return replace(self, pulses=self.pulses[first:stop])

    def after_taps(self, process: Callable[[Index], Complex]) -> Complex:
        """Process v after the canceller: sum_j taps[j] v[..., p_m + j] [..., M].

        Args:
            process: Makes v [..., pulses] at any numbers of pulses.
        """
        pulses = np.asarray(self.pulses)
        cancelled: Complex = self.taps[0] * process(pulses)
        for lag, tap in enumerate(self.taps[1:], 1):
            cancelled += tap * process(pulses + lag)
        return cancelled

    def after_taps_streamed(self, following: Callable[[int], Complex]) -> Complex:
        """Process v after the canceller [rank, M], where v is made pulse by pulse.

        Args:
            following: Makes the next few pulses of v [rank, pulses], of a given number.
        """
        pulses, reach = np.asarray(self.pulses), len(self.taps) - 1
        if reach == 0 and self.count == pulses[-1] - pulses[0] + 1:
            return following(self.count)
        x = np.zeros((self.fast.rank, self.count), complex)
        buffer, stop = np.empty((len(x), 0), complex), int(pulses[-1]) + reach + 1
        for first in range(0, stop, BLOCK):
            buffer = np.concatenate([buffer, following(min(BLOCK, stop - first))], axis=1)
            begin = min(first + BLOCK, stop) - buffer.shape[1]
            columns = slice(*np.searchsorted(pulses, [begin, begin + buffer.shape[1] - reach]))
            for lag, tap in enumerate(self.taps):
                x[:, columns] += tap * buffer[:, pulses[columns] - begin + lag]
            buffer = buffer[:, buffer.shape[1] - reach :]
        return x
