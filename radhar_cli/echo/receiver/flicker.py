"""Coloured receiver noise: 1/f^a along slow time, on top of the white noise."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from radhar_cli.echo.receiver.impairment import Impairment
from radhar_cli.echo.receiver.noise import circular_gaussian
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.processing.look import Look
from radhar_cli.radar.fmcw import Waveform

POLES_A_DECADE = 2


@dataclass(frozen=True)
class FlickerNoise(Impairment):
    """Noise of the spectrum (corner/|f|)^a times that of the white noise, a = slope/10 dB.

    White over fast-time samples; along slow time a sum of first-order processes, two a decade from
    0.1/T to PRF/2, which meets the spectrum within 1 dB. Every fast-time sample has its own.
    """

    sigma: float  # standard deviation of the white noise per complex raw sample
    stream: Callable[[str], np.random.Generator]  # makes the random stream of a name
    corner: float  # frequency where both are equally strong, Hz
    slope: float  # dB per decade

    def apply(self, x: Complex, look: Look) -> Complex:
        """Add sigma v to x [K, M]; over fast time v is white: its covariance is W W^H."""

        def start_processes(name: str) -> _Processes:
            poles = self.processes(look.fast.waveform)
            rngs = [self.stream(f"flicker {name} {k}") for k in range(len(poles[0]))]
            return _Processes(rngs, *poles, look.fast.rank)

        noisy = look.fast.colour(
            look.after_taps_streamed(look.state_of(self, start_processes)), self.sigma
        )
        noisy += x
        return noisy

    def processes(self, waveform: Waveform) -> tuple[Float, Float]:
        """Poles and standard deviations [processes], for white noise of variance 1."""
        return _processes(self.corner / waveform.prf, self.slope / 10, 1 / waveform.n_pulses)


class _Processes:
    """Sums of first-order processes [rows], from the stationary state, drawn pulse by pulse."""

    def __init__(
        self, rngs: list[np.random.Generator], poles: Float, deviations: Float, rows: int
    ) -> None:
        self._parts = list(zip(rngs, poles, deviations, strict=True))
        self.state = [pole * circular_gaussian(rng, (1, rows)).T for rng, pole, _ in self._parts]

    def __call__(self, count: int) -> Complex:
        """The next pulses [rows, count]."""
        from scipy.signal import lfilter  # slow to import

        total = np.zeros((len(self.state[0]), count), complex)
        for k, (rng, pole, sd) in enumerate(self._parts):
            v = np.sqrt(1 - pole**2) * circular_gaussian(rng, (count, len(total))).T
            v, self.state[k] = lfilter([1.0], [1.0, -pole], v, axis=1, zi=self.state[k])
            total += sd * v
        return total


@lru_cache(maxsize=8)
def _processes(corner: float, power: float, lowest: float) -> tuple[Float, Float]:
    """Poles and standard deviations [processes] whose spectrum has the least relative error.

    Args:
        corner: Frequency where both noises are equally strong, over the PRF.
        power: Exponent a of the spectrum.
        lowest: Lowest frequency, over the PRF.
    """
    from scipy.optimize import nnls  # slow to import

    below = 0.1 * lowest  # where the steepest have their knee: they still rise at 1/T
    count = int(np.ceil(POLES_A_DECADE * np.log10(0.5 / below))) + 1
    knees = np.geomspace(below, 0.5, count)
    pole = np.exp(-2 * np.pi * knees)
    f = np.geomspace(lowest, 0.5, 16 * knees.size)[:, None]
    spectra = (1 - pole**2) / np.abs(1 - pole * np.exp(-2j * np.pi * f)) ** 2
    variance, _ = nnls(spectra / (corner / f) ** power, np.ones(f.size))
    return pole[variance > 0], np.sqrt(variance[variance > 0])
