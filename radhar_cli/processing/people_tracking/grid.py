"""Steering vectors of directions, and the elements that an azimuth map has.

nu = cos(elevation) sin(azimuth), positive to the right, mu = sin(elevation), positive upwards.
"""

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float


def steering(right: Float, up: Float, nu: Float, mu: Float | float) -> Complex:
    """Steering vectors exp(-j pi (m nu + n mu)) [..., element] of TI's sign.

    Args:
        right: Places m of the elements to the right, half wavelengths [element].
        up: Places n upwards [element].
        nu: Direction cosines to the right [...].
        mu: Direction cosines upwards [...], of any shape that goes with that of nu.
    """
    across = np.exp(-1j * np.pi * np.multiply.outer(nu, right))
    vectors: Complex = across * np.exp(-1j * np.pi * np.multiply.outer(mu, up))
    return vectors


def row_of_map(up: Float) -> list[int]:
    """Elements of an azimuth map: the row with most of them, of equal ones that nearest to 0."""
    rows = sorted({float(height) for height in np.round(up, 6)}, key=lambda n: (abs(n), n))
    members = [[v for v, height in enumerate(up) if abs(height - n) < 1e-6] for n in rows]
    return max(members, key=len)
