"""Layered walls over frequency: transfer matrices of plane waves, reflections inside included.

With cos = |dx|/R of the straight ray, k0 = 2 pi f/c, and of each layer q = sqrt(eps - 1 + cos^2),
u = k0 d q and the admittance Y = q (perpendicular) or eps/q (parallel), Y0 = cos or 1/cos outside,

    M = [[cos u, j sin u/Y], [j Y sin u, cos u]],  (e, h) = M_1 ... M_L (1, Y0),
    T = 2 Y0/(Y0 e + h),  R = (Y0 e - h)/(Y0 e + h)

(Born and Wolf, Principles of Optics, section 1.6). Each M is computed without its factor exp(j u),
which overflows in thick metal.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT
from radhar_cli.radar.materials import permittivity


class Layer(NamedTuple):
    """A homogeneous layer: thickness (m), and eps = eps_r (1 - j tan delta) or a material."""

    thickness: float
    material: complex | str

    def eps(self, f: Float) -> Complex:
        """Relative permittivity at frequencies f [...] (Hz)."""
        if isinstance(self.material, str):
            return permittivity(self.material, f)
        return np.full(f.shape, self.material)


class ScatteringCoefficients(NamedTuple):
    """Coefficients of the field behind a wall and of that back from it, for 1 in front of it."""

    transmitted: Complex  # T
    reflected: Complex  # R


@dataclass(frozen=True)
class Layers:
    """A wall of layers, nearest first."""

    layers: tuple[Layer, ...]
    parallel: bool  # whether the field lies in the plane of incidence (TM), or across it (TE)

    @property
    def depth(self) -> float:
        """Thickness of all layers, m."""
        return sum(layer.thickness for layer in self.layers)

    def scattering_coefficients(self, f: Float, cosine: Float) -> ScatteringCoefficients:
        """Coefficients T and R of plane waves (Born and Wolf, section 1.6).

        Args:
            f: Frequencies, Hz, which broadcast with the cosines.
            cosine: Cosines of the angle of incidence.
        """
        outside = 1 / cosine if self.parallel else cosine
        e, h = np.ones_like(outside, complex), outside.astype(complex)
        phases: Complex = np.ones_like(outside, complex)
        for layer in reversed(self.layers):
            eps = layer.eps(f)
            q = np.sqrt(eps - 1 + cosine * cosine)  # Im <= 0: the wave decays
            y = eps / q if self.parallel else q
            layer_phase = np.exp(-2j * np.pi / SPEED_OF_LIGHT * layer.thickness * f * q)
            even, odd = (1 + layer_phase * layer_phase) / 2, (1 - layer_phase * layer_phase) / 2
            e, h = even * e + odd * h / y, odd * y * e + even * h
            phases = phases * layer_phase
        return ScatteringCoefficients(
            2 * outside * phases / (outside * e + h), 1 - 2 * h / (outside * e + h)
        )

    def transfer_function(self, f: Float, cosine: Float) -> Complex:
        """Field H = T exp(j k0 D cos) that a leg keeps with the wall there instead of air.

        Args:
            f: Frequencies, Hz, which broadcast with the cosines.
            cosine: Cosines of the angle of incidence.
        """
        air = np.exp(2j * np.pi / SPEED_OF_LIGHT * self.depth * f * cosine)
        h: Complex = self.scattering_coefficients(f, cosine).transmitted * air
        return h
