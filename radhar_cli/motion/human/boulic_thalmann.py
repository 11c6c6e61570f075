"""Movements of pelvis, trunk and arms in a stride, u in 0..1 from right heel strike to the next.

Boulic, Magnenat-Thalmann and Thalmann, The Visual Computer 6 (1990) 344; Chen, The Micro-Doppler
Effect in Radar (2011). Relative speed Rv = v/h, h the height of the hip (1/s); gaits a: Rv < 0.5,
b: < 1.3, c: above. Points are interpolated by PCHIP and kept to 8 harmonics, without corners.
"""

from functools import cache
from math import pi, radians, sqrt

import numpy as np

from radhar_cli.numerics.arrays import Float

HARMONICS = 8
_SAMPLES = 256
Points = tuple[tuple[float, float], ...]


def cycle_duration(rv: float) -> float:
    """Duration of a stride, s: T = Rc/Rv with the relative stride Rc = 1.346 sqrt(Rv).

    A stride is v T = Rc h long.
    """
    return 1.346 / sqrt(rv)


def support(duration: float) -> float:
    """Fraction of a stride of T s at which the foot leaves the floor: (0.752 T - 0.143 s)/T."""
    return 0.752 - 0.143 / duration


def basis(u: Float) -> Float:
    """Harmonics [17, M] of phases u [M]: 1, then cos 2 pi k u, then sin 2 pi k u for k = 1..8."""
    b = np.empty((2 * HARMONICS + 1, u.size))
    b[0] = 1
    turn = np.exp(2j * pi * u)
    power = turn.copy()
    for k in range(1, HARMONICS + 1):
        b[k], b[HARMONICS + k] = power.real, power.imag
        if k < HARMONICS:
            power *= turn
    return b


def harmonic(k: int, amplitude: float, delay: float = 0.0) -> Float:
    """Coefficients [17] of amplitude cos 2 pi k (u - delay)."""
    c = np.zeros(2 * HARMONICS + 1)
    c[k] = amplitude * np.cos(2 * pi * k * delay)
    c[HARMONICS + k] = amplitude * np.sin(2 * pi * k * delay)
    return c


def half_a_stride_later(c: Float) -> Float:
    """Coefficients [17] of the same curve for the other side: u + 1/2 for u."""
    k = np.arange(1, HARMONICS + 1)
    shifted: Float = c * np.concatenate([[1.0], (-1.0) ** k, (-1.0) ** k])
    return shifted


def pelvis_yaw(rv: float) -> Float:
    """Coefficients [17] of the pelvis's turn, right hip ahead, rad."""
    return harmonic(1, radians(4 * rv))


def pelvis_roll(rv: float) -> Float:
    """Coefficients [17] of the pelvis's roll, left hip down, rad."""
    return radians(1.66 * rv) * _roll_shape()


def thorax_yaw(rv: float) -> Float:
    """Coefficients [17] of the thorax's turn, right shoulder back, rad."""
    return radians(rv / 3) * _thorax_shape()


def shoulder(rv: float, swing: float) -> Float:
    """Coefficients [17] of the right shoulder's flexion, rad; `swing` scales its amplitude."""
    a = radians(9.88 * rv) * swing
    c = harmonic(1, -a)
    c[0] = radians(3) - 0.5 * a
    return c


def elbow(rv: float) -> Float:
    """Coefficients [17] of the right elbow's flexion, rad."""
    if rv < 0.5:
        points: Points = ((0.05, 6 * rv + 3), (0.5, 34 * rv + 3), (0.9, 10 * rv + 3))
    elif rv < 1.3:
        p = (rv - 0.5) / 0.8
        points = ((0.05, 8 * p + 6), (0.5 + 0.01 * p, 24 * p + 20), (0.9, 9 * p + 8))
    else:
        q = (rv - 1.3) / 1.7
        points = ((0.05, 14 - 6 * q), (0.51 + 0.04 * q, 44 + 26 * q), (0.9 - 0.1 * q, 17 - 6 * q))
    return np.deg2rad(_periodic(points))


@cache
def _thorax_shape() -> Float:
    return _periodic(((0.1, 4.0), (0.4, -4.5), (0.6, -4.0), (0.9, 4.5)))


@cache
def _roll_shape() -> Float:
    """1 - cos over the load's change from leg to leg, 1 + cos while one leg swings."""
    u = np.arange(_SAMPLES) / _SAMPLES
    half = u % 0.5
    up = 1 - np.cos(2 * pi * 10 * half / 3)
    down = 1 + np.cos(2 * pi * 10 * (half - 0.15) / 7)
    return _coefficients(np.where(half < 0.15, up, down) * np.where(u < 0.5, 1, -1))


def _periodic(points: Points) -> Float:
    """Coefficients [17] of the periodic PCHIP curve through points (u, value).

    Fritsch and Butland, SIAM J. Sci. Stat. Comput. 5 (1984) 300; SciPy's PCHIP is slow to import.
    """
    x, y = np.array(points).T
    x, y = np.concatenate([x - 1, x, x + 1]), np.tile(y, 3)
    h, rise = np.diff(x), np.diff(y) / np.diff(x)
    product, widths = rise[:-1] * rise[1:], h[:-1] + h[1:]
    weighed = (widths + h[1:]) * rise[1:] + (widths + h[:-1]) * rise[:-1]
    slope = np.zeros(x.size)  # 0 at peaks
    np.divide(3 * widths * product, weighed, out=slope[1:-1], where=product > 0)
    u = np.arange(_SAMPLES) / _SAMPLES
    i = np.searchsorted(x, u, "right") - 1
    s, start, end, mean = (u - x[i]) / h[i], slope[i], slope[i + 1], rise[i]
    slope_change = 3 * mean - 2 * start - end + s * (start + end - 2 * mean)
    return _coefficients(y[i] + s * h[i] * (start + s * slope_change))


def _coefficients(curve: Float) -> Float:
    """Coefficients [17] of a curve that is sampled over one stride."""
    spectrum = np.fft.rfft(curve)[: HARMONICS + 1] / curve.size
    return np.concatenate([spectrum.real[:1], 2 * spectrum.real[1:], -2 * spectrum.imag[1:]])
