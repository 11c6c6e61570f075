"""Receiver noise: circular white Gaussian (paper, last equations of "Radar Echo Model")."""

import numpy as np

from radhar_cli.arrays import Complex


def noise_variance(signal_power: float, snr_db: float) -> float:
    """sigma_n^2 = P_s/10^(SNR/10) per complex raw sample."""
    return signal_power / 10 ** (snr_db / 10)


def circular_gaussian(rng: np.random.Generator, shape: tuple[int, ...]) -> Complex:
    """Unit-variance circular Gaussian numbers: real and imaginary parts of variance 1/2."""
    pairs = rng.standard_normal((*shape, 2))
    pairs *= np.sqrt(0.5)
    return pairs.view(np.complex128)[..., 0]
