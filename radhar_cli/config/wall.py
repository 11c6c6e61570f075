"""`wall:` a homogeneous axis-aligned slab, or null for free space."""

from typing import Literal

from radhar_cli.config.number import AtLeastOne, NotNegative, Positive, Vector
from radhar_cli.config.section import Section


class WallConfig(Section):
    """Centre, size along x, y, z, relative permittivity and loss tangent of the wall.

    `rays` and `fresnel` are physics that one may add; docs/engines.md has their size.
    """

    center_m: Vector = (1.0, 0.0, 1.25)
    size_m: tuple[Positive, Positive, Positive] = (0.24, 5.0, 2.5)
    eps_r: AtLeastOne = 6.0
    loss_tangent: NotNegative = 0.03
    rays: Literal["straight", "refracted"] = "straight"
    fresnel: Literal["normal", "perpendicular", "parallel"] = "normal"
