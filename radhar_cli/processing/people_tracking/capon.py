"""Capon's beamformer: P = 1/(a^H Q^-1 a) with a loaded covariance Q.

J. Capon, High-resolution frequency-wavenumber spectrum analysis, Proc. IEEE 57 (1969). With the
Cholesky factor L of Q, P = 1/|L^-1 a|^2: nothing can round below 0.
"""

import numpy as np

from radhar_cli.numerics.arrays import Bool, Complex, Float


def covariance(signals: Complex) -> Complex:
    """Covariance (1/L) sum_l y y^H [..., element, element] of signals y [..., element, loop]."""
    mean: Complex = signals @ signals.conj().swapaxes(-1, -2) / signals.shape[-1]
    return mean


def whitening(matrix: Complex, gamma: float) -> Complex:
    """Inverse L^-1 of the Cholesky factor of a covariance, loaded by gamma tr(Q)/n I.

    Args:
        matrix: Covariance Q [..., n, n].
        gamma: Share of the mean power that is added to the diagonal.

    Returns:
        L^-1 [..., n, n]; of a covariance that is 0 it is 0.
    """
    unit = np.eye(matrix.shape[-1])
    power = np.trace(matrix, axis1=-2, axis2=-1).real[..., None, None]
    load = np.where(power > 0, gamma * power / len(unit), 1) * unit
    inverse = np.linalg.inv(np.linalg.cholesky(matrix + load))
    return np.where(power > 0, inverse, 0).astype(complex, copy=False)


def spectrum(whitener: Complex, vectors: Complex) -> Float:
    """Power P over directions [..., direction]; 0 where the covariance is 0.

    Args:
        whitener: L^-1 [..., n, n] of `whitening`.
        vectors: Steering vectors [..., direction, n].
    """
    white = whitener @ vectors.swapaxes(-1, -2)
    square = white.real * white.real
    square += white.imag * white.imag
    norm = square.sum(axis=-2)
    is_empty: Bool = norm == 0
    return np.where(is_empty, 0, 1 / np.where(is_empty, 1, norm))


def weights(whitener: Complex, vectors: Complex) -> Complex:
    """Weights w = Q^-1 a [..., n] of steering vectors a [..., n]."""
    white = np.einsum("...mn,...n->...m", whitener, vectors)
    solved: Complex = np.einsum("...mn,...m->...n", whitener.conj(), white)
    return solved
