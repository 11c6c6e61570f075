"""Samples of chirps with many beats, by way of a grid of frequencies; compiled by numba.

Each beat exp(-j 2 pi x n), of any frequency x (cycles a sample), is spread over WIDTH points of a
grid of M >= 2 N frequencies, with a window w. Of the transform of the grid the window's own is
divided out (A. Dutt, V. Rokhlin, "Fast Fourier transforms for nonequispaced data", 1993); w is
exp(beta (sqrt(1 - z^2) - 1)) (A. H. Barnett, J. Magland, L. af Klinteberg, "A parallel nonuniform
fast Fourier transform library based on an exponential of semicircle kernel", 2019). What WIDTH
points leave out is below the rounding of single precision.
"""

from functools import lru_cache
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.polynomial import Polynomial

from radhar_cli.echo.compiled import COSINE, SINE
from radhar_cli.numerics.accelerators import machine_code
from radhar_cli.numerics.arrays import Complex, Float, Index

WIDTH, DEGREE = 8, 8  # points of the grid that a beat is spread over; degree of their weights
BETA = 2.3 * WIDTH
OVERSAMPLING = 2
Coefficients: TypeAlias = tuple[np.floating, ...]
POWERS = 6  # coefficients of delays and amplitudes within a frame


class Chirps(NamedTuple):
    """Chirps of a frame, and how their beats follow from delays.

    Attributes:
        places: Time of each loop of each channel [V, L], -1 to 1 within the frame.
        to_powers: Matrix from the values at nodes to coefficients of powers of that time
            [POWERS, nodes]; it is of no use for constants, whose coefficients are known.
        frequency: Frequency at sample N//2, Hz.
        rate: Beat of a delay, cycles a sample and second.
        samples: Number N of samples of a chirp.
    """

    places: Float
    to_powers: Float
    frequency: float
    rate: float
    samples: int


def powers_from_nodes(instants: Float) -> Float:
    """Matrix [POWERS, nodes] from values at instants [POWERS] of -1 to 1 to coefficients."""
    inverse: Float = np.linalg.inv(np.vander(instants, POWERS, increasing=True))
    return inverse


def gridded_sum(delay: Float, amplitude: Float, chirps: Chirps) -> tuple[Complex, float]:
    """Sum up the beats of all paths in the chirps of a frame.

    Args:
        delay: Delays [I, V, POWERS] (s) of the paths at the nodes.
        amplitude: Amplitudes [I, V, POWERS] there, with their signs.

    Returns:
        Samples [V, L, N], in single precision, and the sum of all squared amplitudes.
    """
    from scipy.fft import fft  # slow to import

    n, (channels, loops) = chirps.samples, chirps.places.shape
    size = _grid_size(n)
    unit = float(np.abs(amplitude).max(initial=0.0)) or 1.0  # whatever the power, no overflow
    weights, correction = _window(n)
    grid = np.zeros((size + WIDTH, 2, loops), np.float32)
    samples: Complex = np.empty((channels, loops, n), np.complex64)
    folded = np.empty((size, loops), np.complex64)
    series = tuple(SINE.astype(np.float32)), tuple(COSINE.astype(np.float32))
    scale = chirps.frequency, chirps.rate, size, 1 / unit
    power, spread = 0.0, machine_code(_spread, *CALLED)
    for v in range(channels):
        grid[:] = 0
        paths = delay[:, v], amplitude[:, v]
        power += spread(paths, scale, chirps.to_powers, chirps.places[v], weights, series, grid)
        grid[:WIDTH] += grid[size:]
        folded.real, folded.imag = grid[:size, 0], grid[:size, 1]
        # The first point of the grid stands WIDTH/2 - 1 before the frequency 0: in the correction.
        transformed = fft(folded, axis=0, overwrite_x=True)
        half = n // 2
        np.multiply(transformed[size - half :].T, correction[:half], out=samples[v, :, :half])
        np.multiply(transformed[: n - half].T, correction[half:], out=samples[v, :, half:])
    samples *= np.float32(unit)
    return samples, power


@lru_cache(maxsize=16)
def _grid_size(samples: int) -> int:
    """Number M of frequencies of the grid: one that transforms are fast for."""
    from scipy.fft import next_fast_len

    return int(next_fast_len(OVERSAMPLING * max(samples, WIDTH)))


def _kernel(z: Float) -> Float:
    """Window w [...] at distances z [...] in points of the grid, up to WIDTH/2."""
    inside = np.maximum(1 - (2 * z / WIDTH) ** 2, 0)
    return np.exp(BETA * (np.sqrt(inside) - 1))


@lru_cache(maxsize=16)
def _window(samples: int) -> tuple[tuple[Coefficients, ...], Complex]:
    """Weights of the points, and factors that undo the window for each sample.

    Returns:
        Coefficients [WIDTH, DEGREE + 1] of the powers of the place of a beat between two points,
        -1/2 to 1/2; and factors [N] of the transform, for samples from N//2 before the middle on.
    """
    place = 0.5 * np.cos(np.pi * (np.arange(64) + 0.5) / 64)
    weights = []
    for j in range(WIDTH):
        fit = Polynomial.fit(place, _kernel(j - (WIDTH - 1) / 2 - place), DEGREE)
        weights.append(tuple(fit.convert().coef.astype(np.float32)))
    nodes, quadrature = np.polynomial.legendre.leggauss(200)
    z = nodes * WIDTH / 2
    cycles = (np.arange(samples) - samples // 2) / _grid_size(samples)
    transform = np.cos(2 * np.pi * np.outer(cycles, z)) @ (quadrature * _kernel(z) * WIDTH / 2)
    shift = np.exp(2j * np.pi * cycles * (WIDTH // 2 - 1))
    factors = (shift / transform).astype(np.complex64)
    return tuple(weights), factors


def _spread(
    paths: tuple[Float, Float],
    scale: tuple[float, float, int, float],
    to_powers: Float,
    places: Float,
    weights: tuple[Coefficients, ...],
    series: tuple[Coefficients, Coefficients],
    grid: Float,
) -> float:
    """Spread the beats of paths [I, nodes] over the grids of the chirps of a channel.

    Args:
        paths: Delays (s) and amplitudes at the nodes.
        scale: Frequency (Hz), cycles a sample and second, number of points, factor of amplitudes.
        to_powers: As in `Chirps`.
        places: Times of the loops [L].
        weights: As of `_window`.
        series: Coefficients of the sine and of the cosine.
        grid: Real and imaginary parts [M + WIDTH, 2, L], to which the beats are added.

    Returns:
        Sum of the squared amplitudes.
    """
    delay, amplitude = paths
    frequency, rate, size, factor = scale
    s0, s1, s2, s3, s4, s5, s6 = series[0]
    c0, c1, c2, c3, c4, c5, c6 = series[1]
    loops, power = places.size, 0.0
    cell, within = np.empty(loops, np.int64), np.empty(loops, np.float32)
    re, im = np.empty(loops, np.float32), np.empty(loops, np.float32)
    spread = np.empty((WIDTH, loops), np.float32)
    d, b = np.empty(POWERS), np.empty(POWERS)
    for i in range(delay.shape[0]):
        _fit(delay[i], to_powers, d)
        _fit(amplitude[i], to_powers, b)
        d0, d1, d2, d3, d4, d5 = d[0], d[1], d[2], d[3], d[4], d[5]
        b0, b1, b2, b3, b4, b5 = b[0], b[1], b[2], b[3], b[4], b[5]
        for m in range(loops):
            t = places[m]
            tau = d0 + t * (d1 + t * (d2 + t * (d3 + t * (d4 + t * d5))))
            value = b0 + t * (b1 + t * (b2 + t * (b3 + t * (b4 + t * b5))))
            power += value * value
            phase = frequency * tau
            r = np.float32(phase - np.rint(phase))
            turn = rate * tau
            x = (turn - np.floor(turn)) * size
            lower = np.floor(x)
            cell[m] = np.int64(lower)
            within[m] = np.float32(x - lower - 0.5)
            u = r * r
            a = np.float32(value * factor)
            s = r * (s0 + u * (s1 + u * (s2 + u * (s3 + u * (s4 + u * (s5 + u * s6))))))
            c = c0 + u * (c1 + u * (c2 + u * (c3 + u * (c4 + u * (c5 + u * c6)))))
            re[m] = a * c
            im[m] = -a * s
        _weigh(within, weights, spread)
        _add(cell, spread, re, im, grid)
    return power


def _fit(values: Float, to_powers: Float, coefficients: Float) -> None:
    """Fill in the coefficients [POWERS] of a polynomial through values; 0 but one of a constant."""
    for n in range(POWERS):
        coefficients[n] = 0.0
        for k in range(POWERS):
            coefficients[n] += to_powers[n, k] * (values[k] - values[0])
    coefficients[0] += values[0]


def _weigh(within: Float, weights: tuple[Coefficients, ...], spread: Float) -> None:
    """Fill in the weights [WIDTH, L] of beats at places [L] between two points of the grid."""
    for m in range(within.size):
        f = within[m]
        spread[0, m] = _polynomial(f, weights[0])
        spread[1, m] = _polynomial(f, weights[1])
        spread[2, m] = _polynomial(f, weights[2])
        spread[3, m] = _polynomial(f, weights[3])
        spread[4, m] = _polynomial(f, weights[4])
        spread[5, m] = _polynomial(f, weights[5])
        spread[6, m] = _polynomial(f, weights[6])
        spread[7, m] = _polynomial(f, weights[7])


def _add(cell: Index, spread: Float, re: Float, im: Float, grid: Float) -> None:
    """Add beats [L] to the grid: together those of loops in which they are between the same points.

    Args:
        cell: First point that each is spread over.
        spread: Weights [WIDTH, L] of the points.
        re: Real parts.
        im: Imaginary parts.
        grid: As of `_spread`.
    """
    start = 0
    while start < cell.size:
        end = start + 1
        while end < cell.size and cell[end] == cell[start]:
            end += 1
        a_re, a_im = re[start:end], im[start:end]
        for j in range(WIDTH):
            w = spread[j, start:end]
            to_re = grid[cell[start] + j, 0, start:end]
            to_im = grid[cell[start] + j, 1, start:end]
            for m in range(end - start):
                to_re[m] += w[m] * a_re[m]
            for m in range(end - start):
                to_im[m] += w[m] * a_im[m]
        start = end


def _polynomial(x: Any, coefficients: Coefficients) -> Any:
    """Polynomial of degree DEGREE, which is a straight line of code once compiled."""
    c0, c1, c2, c3, c4, c5, c6, c7, c8 = coefficients
    return c0 + x * (c1 + x * (c2 + x * (c3 + x * (c4 + x * (c5 + x * (c6 + x * (c7 + x * c8)))))))


CALLED = tuple((one, one) for one in (_fit, _weigh, _add, _polynomial))  # by `_spread`
