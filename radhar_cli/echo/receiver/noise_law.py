"""Laws for the strength of a receiver's white noise: by an SNR, thermal, or none at all."""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from math import inf, log10, sqrt

import numpy as np

from radhar_cli.echo.receiver.noise import noise_variance

BOLTZMANN_T0 = 1.380649e-23 * 290.0  # k T0, W/Hz
SMALLEST_POWER = float(np.finfo(float).tiny)  # below it squares lose their digits, or are 0


class NoiseLaw(ABC):
    """Law for the noise of a complex raw sample, for unit transmit power."""

    by_signal = False  # whether it follows from the power of the echo

    @abstractmethod
    def sigma(self, signal_power: float, bandwidth: float) -> float:
        """Standard deviation of a raw sample's noise.

        Args:
            signal_power: Mean power P_s of the echo of people in a raw sample, for unit
                transmit power; only a law that is `by_signal` reads it.
            bandwidth: Bandwidth from which the receiver takes noise, samples per second, Hz.

        Raises:
            ValueError: The power is one to which no noise can be related.
        """


@dataclass(frozen=True)
class Snr(NoiseLaw):
    """Noise at a ratio below the echo: sigma^2 = P_s/10^(SNR/10)."""

    decibels: float
    by_signal = True

    def sigma(self, signal_power: float, bandwidth: float) -> float:
        if not SMALLEST_POWER <= signal_power < inf:
            raise ValueError(
                f"the echo's power is {signal_power:g}; snr_db = {self.decibels:g} needs one from "
                f"{SMALLEST_POWER:.3g} on"
            )
        return sqrt(noise_variance(signal_power, self.decibels))


@dataclass(frozen=True)
class Thermal(NoiseLaw):
    """Noise of a receiver at 290 K: sigma^2 = k T0 fs F/P_t, for unit transmit power."""

    figure_db: float  # F
    transmit_power_dbm: float  # P_t

    def sigma(self, signal_power: float, bandwidth: float) -> float:
        thermal_db = 10 * log10(BOLTZMANN_T0 * bandwidth) + self.figure_db
        return float(10 ** ((thermal_db - self.transmit_power_dbm + 30) / 20))


@dataclass(frozen=True)
class Silent(NoiseLaw):
    """Law of a receiver without noise."""

    def sigma(self, signal_power: float, bandwidth: float) -> float:
        return 0.0
