"""Receiver noise: circular white Gaussian (paper, last equations of "Radar Echo Model")."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from radhar_cli.arrays import Complex
from radhar_cli.processing.look import Look
from radhar_cli.receiver.impairment import Impairment


def noise_variance(signal_power: float, snr_db: float) -> float:
    """sigma_n^2 = P_s/10^(SNR/10) per complex raw sample."""
    return signal_power / 10 ** (snr_db / 10)


@dataclass(frozen=True)
class WhiteNoise(Impairment):
    """White noise of one receive channel.

    Attributes:
        sigma: standard deviation per complex raw sample.
        stream: makes the random stream of a name.
    """

    sigma: float
    stream: Callable[[str], np.random.Generator]

    def apply(self, x: Complex, look: Look) -> Complex:
        """x + sigma v, v of covariance W W^H: of raw samples blocks of any length give the same."""
        if "white noise" not in look.memory:
            look.memory["white noise"] = self.stream(look.name)
        noisy = look.white(look.memory["white noise"], self.sigma)
        noisy += x
        return noisy
