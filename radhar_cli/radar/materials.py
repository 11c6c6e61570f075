"""Permittivity of building materials: ITU-R P.2040-3, table 3."""

from math import pi
from typing import Literal

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float

EPSILON_0 = 8.8541878128e-12  # F/m

Material = Literal[
    "concrete",
    "brick",
    "plasterboard",
    "wood",
    "glass",
    "ceiling_board",
    "chipboard",
    "floorboard",
    "metal",
]
# a, c, d of eps = a - j sigma/(2 pi f eps_0), sigma = c f^d S/m at f GHz
NUMBERS = {
    "concrete": (5.24, 0.0462, 0.7822),
    "brick": (3.91, 0.0238, 0.16),
    "plasterboard": (2.73, 0.0085, 0.9395),
    "wood": (1.99, 0.0047, 1.0718),
    "glass": (6.31, 0.0036, 1.3394),
    "ceiling_board": (1.48, 0.0011, 1.0750),
    "chipboard": (2.58, 0.0217, 0.78),
    "floorboard": (3.66, 0.0044, 1.3515),
    "metal": (1.0, 1e7, 0.0),
}


def permittivity(material: str, f: Float) -> Complex:
    """Complex relative permittivity of a `Material` at frequencies f [...] (Hz)."""
    a, c, d = NUMBERS[material]
    conductivity = c * (f * 1e-9) ** d  # S/m
    eps: Complex = a - np.multiply(1j, conductivity) / (2 * pi * f * EPSILON_0)
    return eps
