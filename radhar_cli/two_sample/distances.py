"""How far two samples of numbers, or of features, are apart."""

from math import ceil
from typing import NamedTuple

import numpy as np
from scipy.spatial.distance import cdist
from scipy.stats import ks_2samp, wasserstein_distance

from radhar_cli.arrays import Float

NEIGHBOURS = 5
FEWEST = 5  # known values of a side, where it has as many maps
ROUNDING = 1e-9  # of the largest value: a standard deviation below is none


class Spread(NamedTuple):
    """Mean and standard deviation of some numbers, NaN of none, and how many there are."""

    mean: float
    sd: float
    known: int

    @classmethod
    def of(cls, values: Float) -> "Spread":
        """Of values [N]."""
        mean, sd = (values.mean(), values.std()) if values.size else (np.nan, np.nan)
        return cls(float(mean), float(sd), values.size)


class Difference(NamedTuple):
    """Two samples of a number."""

    simulated: Spread
    measured: Spread
    # Wasserstein distance (the mean of how far quantiles are apart) over the root of the mean of
    # both variances; of all together where these are 0
    distance: float
    ks: float  # largest difference of the two distribution functions (Kolmogorov and Smirnov)
    p: float  # of it, where both were drawn from one distribution


def difference(simulated: Float, measured: Float) -> Difference:
    """Compare values [N] and [M]; NaN are left out, and all is NaN where fewer than 5 are left."""
    x, y = (values[np.isfinite(values)] for values in (simulated, measured))
    spreads = Spread.of(x), Spread.of(y)
    if x.size < min(FEWEST, simulated.size) or y.size < min(FEWEST, measured.size):
        return Difference(*spreads, np.nan, np.nan, np.nan)
    scale = float(np.hypot(spreads[0].sd, spreads[1].sd) / np.sqrt(2))
    every = np.concatenate([x, y])
    if scale <= ROUNDING * np.abs(every).max():
        scale = Spread.of(every).sd or 1.0
    test = ks_2samp(x, y)
    distance = float(wasserstein_distance(x, y)) / scale
    return Difference(*spreads, distance, float(test.statistic), float(test.pvalue))


def uncovered(simulated: Float, measured: Float) -> Float:
    """How far from anything simulated each measured sample is [M], 1 at the edge of being covered.

    Distance of its nearest simulated neighbour over that of its measured neighbour number 5 M/N.
    The share that is not above 1 is the coverage of M. F. Naeem et al., "Reliable fidelity and
    diversity metrics for generative models", ICML 2020: 97 % or more of samples from one
    distribution.

    Args:
        simulated: [N, D].
        measured: [M, D].
    """
    neighbour = ceil(NEIGHBOURS * len(measured) / len(simulated))
    among = np.sort(cdist(measured, measured), axis=1)
    radius = among[:, min(neighbour, len(measured) - 1)]
    nearest = cdist(measured, simulated).min(axis=1)
    return np.asarray(nearest / np.maximum(radius, 1e-12))
