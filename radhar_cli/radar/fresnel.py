"""Transmission of a face at an angle: Fresnel's equations (Born and Wolf, 1.5.2 and 14.2).

Faces at normal incidence: `wall.field_factor`; all reflections within layers: `layers.Layers`.
"""

from typing import Literal

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.radar.wall import Crossing, Wall, faces_met

Polarisation = Literal["perpendicular", "parallel"]


def reflection(cosine: Float, eps: complex, polarisation: Polarisation) -> Complex:
    """Reflection coefficient Gamma(theta) [...] of a face between air and a medium.

    With w = sqrt(eps - sin^2 theta): (cos - w)/(cos + w) for a field perpendicular to the plane of
    incidence (TE, s), (w - eps cos)/(w + eps cos) for a parallel one (TM, p).

    Args:
        cosine: Cosines [...] of the angle theta in air.
        eps: Complex relative permittivity of the medium.
        polarisation: Direction of the field against the plane of incidence.
    """
    w, x = _medium(cosine, eps), _air(cosine, eps, polarisation)
    return (x - w) / (x + w) if polarisation == "perpendicular" else (w - x) / (w + x)


def face_factor(cosine: Float, eps: complex, polarisation: Polarisation) -> Float:
    """Field sqrt(1 - |Gamma(theta)|^2) [...] that passes one face; arguments of `reflection`."""
    w, x = _medium(cosine, eps), _air(cosine, eps, polarisation)
    # |x + w|^2 - |x - w|^2 = 4 Re(x conj(w)): no cancellation at grazing incidence.
    return 2 * np.sqrt(np.real(x * np.conj(w))) / np.abs(x + w)


def faces_factor(
    p: Float,
    antenna: tuple[float, float, float],
    wall: Wall,
    crossed: Crossing,
    tangent: Float | None,
) -> Float:
    """Field [I, M] that passes the faces of the wall on the way from an antenna to p.

    Args:
        p: Positions [3, I, M], m.
        antenna: Position of the antenna, m.
        wall: The wall, whose `fresnel` is a polarisation.
        crossed: Chords and numbers of faces of the rays.
        tangent: Tangents [I, M] of the angle outside where a ray is refracted, NaN where it is
            straight; None where all are straight.
    """
    assert wall.fresnel != "normal"
    step = np.abs([p[axis] - antenna[axis] for axis in range(3)])
    length = np.sqrt((step * step).sum(axis=0))
    factor = np.ones(crossed.faces.shape)
    for number, axes in enumerate(faces_met(p, antenna, wall)):
        passes = crossed.faces > number
        along = np.take_along_axis(step, axes[None], axis=0)[0]
        cosine = along[passes] / length[passes]
        if tangent is not None:
            t = tangent[passes]
            cosine = np.where(np.isnan(t), cosine, 1 / np.sqrt(1 + t * t))
        factor[passes] *= face_factor(cosine, wall.permittivity, wall.fresnel)
    return factor


def _medium(cosine: Float, eps: complex) -> Complex:
    """Wave number w = sqrt(eps - sin^2) along the normal inside, in units of k0."""
    w: Complex = np.sqrt((eps - 1) + cosine * cosine + 0j)
    return w


def _air(cosine: Float, eps: complex, polarisation: Polarisation) -> Complex:
    """Wave number along the normal outside, in units of k0, times eps for a parallel field."""
    return np.asarray(cosine * (eps if polarisation == "parallel" else 1), dtype=np.complex128)
