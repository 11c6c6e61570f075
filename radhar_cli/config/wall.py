"""`wall:` a homogeneous axis-aligned slab, or null for free space."""

from typing import Annotated, Literal, TypeAlias

from radhar_cli.config.number import AtLeastOne, NotNegative, Positive, Vector, within
from radhar_cli.config.section import Section

Size: TypeAlias = Annotated[Positive, within(1e-6, 1e6, "m")]


class WallConfig(Section):
    """Centre, size along x, y, z, relative permittivity and loss tangent of the wall.

    `rays` and `fresnel` are physics that one may add; docs/engines.md has their size.
    """

    center_m: Vector = (1.0, 0.0, 1.25)
    size_m: tuple[Size, Size, Size] = (0.24, 5.0, 2.5)
    eps_r: Annotated[AtLeastOne, within(1, 1e6)] = 6.0
    loss_tangent: Annotated[NotNegative, within(0, 1e12)] = 0.03
    rays: Literal["straight", "refracted"] = "straight"
    fresnel: Literal["normal", "perpendicular", "parallel"] = "normal"
