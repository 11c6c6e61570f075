"""The shadow that one person throws on another: an upright obstacle with soft edges.

Fitted to an absorbing screen (Kirchhoff's integral), whose fringes no interpolation in time could
follow. From 2 to 77 GHz half-power edges of an echo lie within 4 cm of the screen's, and in the
middle of the shadow it is 0.8 dB stronger to 10 dB weaker (tests/radar/test_person_shadow.py).
"""

import numpy as np

from radhar_cli.numerics.arrays import Float

HALF_WIDTH_M = 0.165  # half width of a person of usual thickness
LEAST = 0.03  # two-way field that gets around a person
EDGE = 0.3  # width of the edge over sqrt(wavelength * 1 m)
FAR = 25.0  # widths from an edge at which nothing is left of a shadow, 1e-11
BEYOND, BEYOND_WIDTH = 0.06, 0.03  # where a shadow begins behind a person, and how softly, m


def field_behind_person(
    p: Float,
    antenna: tuple[float, float, float],
    place: Float,
    half_width: float,
    top: float,
    wavelength: float,
) -> Float:
    """Field [I, M] of legs past a person, 1 with nobody between.

    Args:
        p: Positions [3, I, M] to which the legs lead, m.
        antenna: Position of the antenna, m.
        place: Position [3, 1, M] of the person, m; its height is not used.
        half_width: Half width of the person, m.
        top: Stature of the person, m.
        wavelength: Wavelength of the carrier, m.
    """
    from scipy.special import expit  # slow to import

    to_target = p[:2] - np.reshape(antenna[:2], (2, 1, 1))
    to_person = place[:2] - np.reshape(antenna[:2], (2, 1, 1))
    length = np.maximum(np.hypot(*to_target), np.finfo(float).tiny)
    before = (to_target[0] * to_person[0] + to_target[1] * to_person[1]) / length
    aside = (to_target[0] * to_person[1] - to_target[1] * to_person[0]) / length
    height = antenna[2] + (p[2] - antenna[2]) * before / length
    edge = EDGE * np.sqrt(wavelength)
    field = np.ones(length.shape)
    near = np.abs(aside) < half_width + FAR * edge
    near &= (before > BEYOND - FAR * BEYOND_WIDTH) & (length - before > BEYOND - FAR * BEYOND_WIDTH)
    u, h, d1, d2 = aside[near], height[near], before[near], (length - before)[near]
    hidden: Float = expit((half_width**2 - u * u) / (2 * half_width * edge))
    hidden *= expit((top - h) / edge)
    hidden *= expit((d1 - BEYOND) / BEYOND_WIDTH) * expit((d2 - BEYOND) / BEYOND_WIDTH)
    field[near] -= hidden
    return field


def limit_shadow(two_way_field: Float) -> Float:
    """Factor [I, M] of a path's amplitude from the product of the fields of its legs [I, M].

    It is 1 for 1, and about LEAST for 0, as some field gets around a person.
    """
    factor: Float = np.hypot(two_way_field, LEAST) / np.hypot(1, LEAST)
    return factor
