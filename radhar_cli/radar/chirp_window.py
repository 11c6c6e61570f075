"""Windows over the samples of a chirp, or the steps of a sweep, before range compression.

F. J. Harris, "On the use of windows for harmonic analysis with the discrete Fourier transform",
Proceedings of the IEEE 66, 1978, has the windows and what they cost.
"""

from dataclasses import dataclass
from functools import lru_cache
from math import acosh, ceil, pi
from typing import Any, Literal, TypeAlias

import numpy as np

from radhar_cli.numerics.arrays import Float

WindowName: TypeAlias = Literal[
    "rectangular", "hann", "hamming", "blackman", "blackmanharris", "taylor", "chebyshev"
]

# a_p of sum_p (-1)^p a_p cos(2 pi p n/(N - 1)) (Harris 1978)
COSINES: dict[str, tuple[float, ...]] = {
    "hann": (0.5, 0.5),
    "hamming": (0.54, 0.46),
    "blackman": (0.42, 0.5, 0.08),
    "blackmanharris": (0.35875, 0.48829, 0.14128, 0.01168),
}
FEWEST = 3  # samples that a window has a shape of


@dataclass(frozen=True)
class ChirpWindow:
    """A window over fast time, whose energy is that of none: sum_n w[n]^2 = N.

    So white noise has the same power in every range bin whatever the window, and a steady echo
    loses N sum w^2/(sum w)^2, 1.8 dB by Hann's.
    """

    name: WindowName = "rectangular"
    sidelobes_db: float = 60.0  # level of the sidelobes below the peak, of taylor and chebyshev

    @property
    def is_rectangular(self) -> bool:
        """Whether all samples count alike."""
        return self.name == "rectangular"

    def weights(self, samples: int) -> Float:
        """Weights w[n] [samples], symmetric about their middle."""
        return _weights(self, samples)

    def gain(self, samples: int) -> float:
        """Gain (sum w)^2/sum w^2 of a steady echo over white noise."""
        return float(self.weights(samples).sum() ** 2 / samples)


RECTANGULAR = ChirpWindow()


@lru_cache(maxsize=16)
def _weights(window: ChirpWindow, samples: int) -> Float:
    """Weights of a window [samples], of mean square 1; they are shared, and not to be changed."""
    shape = _shape(window, samples) if samples >= FEWEST else np.ones(samples)
    weights: Float = shape / np.sqrt(np.mean(shape**2))
    weights.flags.writeable = False
    return weights


def _shape(window: ChirpWindow, samples: int) -> Float:
    """Weights of a window [samples], 1 in the middle or near it."""
    if window.is_rectangular:
        return np.ones(samples)
    if window.name in COSINES:
        angle = 2 * np.pi * np.arange(samples) / (samples - 1)
        terms = (a * np.cos(p * (angle - np.pi)) for p, a in enumerate(COSINES[window.name]))
        return sum(terms, np.zeros(samples))
    from scipy.signal import windows  # slow to import

    if window.name == "taylor":
        level: Any = window.sidelobes_db  # which need not be whole, whatever the stubs say
        taylor: Float = windows.taylor(samples, _nearly_constant_sidelobes(level), level)
        return taylor
    chebyshev: Float = windows.chebwin(samples, window.sidelobes_db)
    return chebyshev


def _nearly_constant_sidelobes(level_db: float) -> int:
    """Fewest sidelobes n of Taylor's window that may be alike, n >= 2 A^2 + 1/2.

    A = acosh(10^(level/20))/pi; of fewer the first ones are higher than the level (T. T. Taylor,
    "Design of line-source antennas for narrow beamwidth and low side lobes", IRE Transactions on
    Antennas and Propagation 3, 1955).
    """
    return max(ceil(2 * (acosh(10 ** (level_db / 20)) / pi) ** 2 + 0.5), 2)
