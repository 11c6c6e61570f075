"""Cancellers of static echoes: moving target indication (paper, first equation of "RTM").

A canceller is anything linear along slow time. It commutes with range compression and with the sum
over bins, so that it may be applied to whichever of them is at hand.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from radhar_cli.numerics.accelerators import installed, machine_code
from radhar_cli.numerics.arrays import Complex, Float

MIN_SAMPLES = 2**19  # with fewer, numba takes longer to load than it saves


class Canceller(ABC):
    """Linear filter of a signal [..., M] to one [..., M - lost], the last axis being the pulses.

    Where it is not a `Fir`, an output depends on the whole recording, no pulse is lost, and its
    gain is at most 1: sum |y|^2 <= sum |s|^2. An error before it then bounds the error after it.
    """

    @property
    def lost(self) -> int:
        """Number of pulses by which the output is shorter than the input."""
        return 0

    @property
    def delay(self) -> float:
        """Number of pulse intervals by which an output lies after its first pulse."""
        return self.lost / 2

    @property
    @abstractmethod
    def removes_static(self) -> bool:
        """Whether a constant becomes exactly 0."""

    @abstractmethod
    def __call__(self, s: Complex) -> Complex:
        """Filter a signal [..., M]; the result is [..., M - lost]."""


@dataclass(frozen=True)
class Fir(Canceller):
    """Filter of few taps: y[..., m] = sum_k taps[k] s[..., m + k]."""

    # earliest pulse first; (-1, 1) is the first difference, (1, -2, 1) the three-pulse canceller,
    # (1,) none
    taps: tuple[float, ...]

    @property
    def lost(self) -> int:
        return len(self.taps) - 1

    @property
    def removes_static(self) -> bool:
        return sum(self.taps) == 0

    def __call__(self, s: Complex) -> Complex:
        if self.taps == (1,):
            return s
        if self.taps == (-1, 1):
            return np.diff(s, axis=-1)
        length = s.shape[-1] - self.lost
        y: Complex = self.taps[0] * s[..., :length]
        for k, tap in enumerate(self.taps[1:], 1):
            y += tap * s[..., k : k + length]
        return y


FIRST_DIFFERENCE = Fir((-1, 1))
NO_CANCELLER = Fir((1,))


@dataclass(frozen=True)
class MeanRemoval(Canceller):
    """Subtraction of the background: y = s less its mean over the recording."""

    @property
    def removes_static(self) -> bool:
        return True

    def __call__(self, s: Complex) -> Complex:
        y: Complex = s - s[..., :1]  # which leaves exactly nothing of a constant
        y -= y.mean(axis=-1, keepdims=True)
        return y


@dataclass(frozen=True)
class HighPass(Canceller):
    """A Butterworth high-pass that starts from rest."""

    order: int  # order of the filter; both ways it has the effect of twice that
    cutoff: float  # frequency where |H|^2 = 1/2, as a fraction of PRF/2
    # filter forwards and then backwards: the response is |H|^2, without delay
    zero_phase: bool = False
    # first take out the mean of the recording. Without it what stands still is switched on at the
    # first pulse and rings, as it does in MATLAB's `filter`
    remove_mean: bool = True

    @property
    def removes_static(self) -> bool:
        return self.remove_mean

    def __call__(self, s: Complex) -> Complex:
        sections = _butterworth(self.order, self.cutoff)
        y = _apply_sections(sections, MeanRemoval()(s) if self.remove_mean else s)
        if self.zero_phase:
            y = _apply_sections(sections, y[..., ::-1])[..., ::-1]
        return y


def _apply_sections(sections: Float, x: Complex) -> Complex:
    """Filter x [..., M] by second-order sections from rest, along the pulses."""
    if x.size < MIN_SAMPLES or installed("numba") is None:
        from scipy.signal import sosfilt  # slow to import

        return np.asarray(sosfilt(sections, x))
    y = np.array(x.reshape(-1, x.shape[-1]).T, np.result_type(x, sections), order="C")
    machine_code(_filter_rows)(y, sections)
    return np.ascontiguousarray(y.T).reshape(x.shape)


def _filter_rows(y: Complex, sections: Float) -> None:
    """Filter y [pulses, rows] in place, pulse by pulse, as each needs the previous one."""
    state = np.zeros((len(sections), 2, y.shape[1]), y.dtype)
    for m in range(len(y)):
        for s in range(len(sections)):
            b0, b1, b2, _, a1, a2 = sections[s]
            for r in range(y.shape[1]):
                v = y[m, r]
                w = b0 * v + state[s, 0, r]
                state[s, 0, r] = b1 * v - a1 * w + state[s, 1, r]
                state[s, 1, r] = b2 * v - a2 * w
                y[m, r] = w


@lru_cache(maxsize=8)
def _butterworth(order: int, cutoff: float) -> Float:
    """Second-order sections [S, 6] of a high-pass; cutoff as a fraction of PRF/2."""
    from scipy.signal import butter

    sections: Float = butter(order, cutoff, "highpass", output="sos")
    return sections
