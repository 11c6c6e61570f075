"""The shadow that one person throws on another: an upright obstacle with soft edges.

Fitted to an absorbing screen (Kirchhoff's integral), whose fringes no interpolation in time could
follow. From 2 to 77 GHz half-power edges of an echo lie within 4 cm of the screen's, and in the
middle of the shadow it is 0.8 dB stronger to 10 dB weaker (tests/radar/test_person_shadow.py).
"""

import numpy as np

from radhar_cli.arrays import Float

HALF_WIDTH_M = 0.165  # of a person of usual thickness
LEAST = 0.03  # field that gets around a person, of both legs
EDGE = 0.3  # width of the edge over sqrt(wavelength * 1 m)
FAR = 25.0  # widths from an edge at which nothing is left of a shadow, 1e-11
BEYOND, BEYOND_WIDTH = 0.06, 0.03  # where a shadow begins behind a person, and how softly, m


def light_past(
    p: Float,
    antenna: tuple[float, float, float],
    place: Float,
    half_width: float,
    top: float,
    wavelength: float,
) -> Float:
    """Field [I, M] of legs from an antenna to positions p [3, I, M] (m), 1 with nobody between.

    The person stands at `place` [3, 1, M] (m), whose height is not used; `top` is the stature, m.
    """
    from scipy.special import expit  # slow to import

    way = p[:2] - np.reshape(antenna[:2], (2, 1, 1))
    to = place[:2] - np.reshape(antenna[:2], (2, 1, 1))
    length = np.maximum(np.hypot(*way), np.finfo(float).tiny)
    before = (way[0] * to[0] + way[1] * to[1]) / length
    aside = (way[0] * to[1] - way[1] * to[0]) / length
    height = antenna[2] + (p[2] - antenna[2]) * before / length
    edge, left = EDGE * np.sqrt(wavelength), np.ones(length.shape)
    near = np.abs(aside) < half_width + FAR * edge
    near &= (before > BEYOND - FAR * BEYOND_WIDTH) & (length - before > BEYOND - FAR * BEYOND_WIDTH)
    u, h, d1, d2 = aside[near], height[near], before[near], (length - before)[near]
    hidden: Float = expit((half_width**2 - u * u) / (2 * half_width * edge))
    hidden *= expit((top - h) / edge)
    hidden *= expit((d1 - BEYOND) / BEYOND_WIDTH) * expit((d2 - BEYOND) / BEYOND_WIDTH)
    left[near] -= hidden
    return left


def left_of(both_legs: Float) -> Float:
    """Factor of a path's amplitude, of the product of what is left of its legs."""
    left: Float = np.hypot(both_legs, LEAST) / np.hypot(1, LEAST)
    return left
