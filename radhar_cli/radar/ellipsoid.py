"""Echo of an ellipsoid: cross section, nearest point, and the shadow behind it.

Seen along a unit vector with the components u, v, w along the semi-axes c, a, b, the tangent plane
nearest to the observer is h in front of the centre, h^2 = (a v)^2 + (b w)^2 + (c u)^2. Optics gives
sigma = |Gamma|^2 pi a^2 b^2 c^2/h^4 (Mahafza, Radar Systems Analysis and Design, section "RCS of
simple objects", ellipsoid), from the point that is h nearer than the centre. Here a = r f aside and
b = r/f, r the mean radius across and f the flatness, 1 for an ellipsoid of revolution.
Seen from two antennas, the bisector of the legs takes the place of the line of sight.
"""

from math import pi
from typing import NamedTuple

import numpy as np

from radhar_cli.arrays import Float

LEFT_IN_SHADOW = 0.03  # field deep in the shadow of a body, relative to none
PENUMBRA = 0.4  # width of the edge of a shadow over sqrt(wavelength * 1 m)
BEHIND, BEHIND_WIDTH = 0.06, 0.03  # start of a shadow behind its occluder, and transition, m


class View(NamedTuple):
    """A vector towards the observer, of any length."""

    # along, aside: its components along the axis, and across where flat bodies are wide
    along: Float
    aside: Float
    square: Float  # of its length


def square_height(
    view: View, radius: Float | float, half: Float | float, flatness: Float | float = 1.0
) -> Float:
    """h^2 (m^2), times the square of the viewing vector's length; semi-axes in m, f 1 or more."""
    along, aside = view.along * view.along, view.aside * view.aside
    depth = radius / flatness
    height: Float = depth * depth * (view.square - along - aside) + half * half * along
    height += (radius * flatness) ** 2 * aside
    return height


def cross_section(
    square_height: Float, radius: Float | float, half: Float | float, reflectance: float
) -> Float:
    """sigma = |Gamma|^2 pi r^4 c^2/h^4, m^2, r across (mean), c along, h for a unit vector."""
    size = pi * reflectance * radius**4 * half**2
    return size / (square_height * square_height)


def shadow(clearance: Float, behind: Float, radius: Float | float, wavelength: float) -> Float:
    """Field left (1) of a path whose ray passes an occluder and ends `behind` (m) it.

    A logistic edge of width w, half the field at the edge, a tenth at 2.2 w behind it: as a knife
    edge 0.4 m in front has it, w = 2.5 cm at 77 GHz and 15 cm at 2 GHz. `clearance` is (distance of
    the ray from the occluder's centre over the way to its surface there)^2: 1 at the edge.
    """
    edge = 2 * PENUMBRA * np.sqrt(wavelength)
    # 1/(1 + exp(-x)) = (1 + tanh(x/2))/2, in a third of the time of scipy.special.expit
    covered = 1 + np.tanh((1 - clearance) * (radius / (2 * edge)))
    left: Float = covered * (1 + np.tanh((behind - BEHIND) / (2 * BEHIND_WIDTH)))
    left *= (LEFT_IN_SHADOW - 1) / 4
    left += 1
    return left
