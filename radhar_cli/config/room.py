"""The wall in front of people, and the room around them."""

from typing import Annotated, Any, Literal, TypeAlias

from pydantic import Discriminator, Field, Tag

from radhar_cli.config.annotations import GIVEN, ActsIf, ByModel
from radhar_cli.config.number import (
    AtLeastOne,
    NotNegative,
    Number,
    Positive,
    Vector,
    uniform,
    within,
)
from radhar_cli.config.section import Section
from radhar_cli.radar.materials import Material

Size: TypeAlias = Annotated[Positive, within(1e-6, 1e6, "m")]


class LayerConfig(Section):
    """A layer of a wall, of a material or of a permittivity."""

    thickness_m: Size = 0.1
    """Thickness of the layer."""
    material: Material | None = None
    """Material of ITU-R P.2040, whose permittivity depends on frequency; null takes eps_r."""
    eps_r: Annotated[AtLeastOne | None, within(1, 1e6)] = None
    """Relative permittivity of the layer, where no material is named."""
    loss_tangent: Annotated[NotNegative, within(0, 1e12)] = 0.0
    """Loss tangent of the layer, used with eps_r."""


_NO_LAYERS = ActsIf("wall.layers", None)


class WallConfig(Section):
    """Centre, size along x, y, z, relative permittivity and loss tangent of the wall.

    `rays` and `fresnel` are optional physics; docs/physics/engines.md has the size of it.
    """

    center_m: Vector = (1.0, 0.0, 1.25)
    """Middle of the wall: range, cross-range, height."""
    size_m: tuple[Size | None, Size, Size] = (0.24, 5.0, 2.5)
    """Extent of the wall in range, cross-range, height; with layers, whose thickness counts, [null,
    y, z]."""
    eps_r: Annotated[AtLeastOne, within(1, 1e6), _NO_LAYERS] = 6.0
    """Relative permittivity of the wall."""
    loss_tangent: Annotated[NotNegative, within(0, 1e12), _NO_LAYERS] = 0.03
    """Loss tangent of the wall's material."""
    rays: Annotated[
        Literal["straight", "plane", "refracted"] | None,
        ByModel(human="plane", paper="straight", file="plane"),
    ] = None
    """Path of a ray through the wall: the chord, a plane wave's at the same angle, or Snell's
    law."""
    fresnel: Literal["normal", "perpendicular", "parallel"] = "normal"
    """Loss of the wall's faces: at normal incidence, or at the ray's angle with the field
    perpendicular or parallel to its plane."""
    echoes: Literal["none", "exact"] = "none"
    """Reflections inside the wall: none, or exact over frequency, by radar.polarisation; exact
    needs engine.kind: cube or an impulse radar."""
    layers: Annotated[
        Annotated[tuple[LayerConfig, ...], Field(min_length=1, max_length=16)] | None,
        ActsIf("wall.echoes", "exact"),
    ] = None
    """Layers of the wall, nearest first, with echoes: exact; null is one layer of size_m, eps_r and
    loss_tangent."""


class ReflectorConfig(Section):
    """Something that stands in the room, with a residual motion along the line of sight."""

    position_m: Vector = (uniform(1.0, 6.0), uniform(-3.0, 3.0), uniform(0.0, 2.5))
    """Position of the reflector: range, cross-range, height."""
    rcs_dbsm: Annotated[Number, within(-120, 120, "dBsm")] = uniform(-10.0, 10.0)
    """Radar cross-section of the reflector."""
    residual_m: Annotated[NotNegative, within(0, 0.01, "m")] = uniform(5e-5, 5e-4)
    """Standard deviation of the reflector's small motion along the line of sight."""
    highest_hz: Annotated[Positive, within(1e-3, 100, "Hz")] = 10.0
    """Highest frequency of the reflector's small motion."""


MAX_REFLECTORS = 32


class DielectricConfig(Section):
    """A material by its permittivity eps_r (1 - j loss_tangent)."""

    eps_r: Annotated[AtLeastOne, within(1, 1e6)] = 5.0
    """Relative permittivity of the material."""
    loss_tangent: Annotated[NotNegative, within(0, 1e12)] = 0.0
    """Loss tangent of the material."""


class BoxConfig(Section):
    """Where the faces of a room are; the floor is at 0."""

    x: tuple[Number, Number] = (0.0, 6.0)
    """Ranges of the front and the back face, m."""
    y: tuple[Number, Number] = (-2.5, 2.5)
    """Cross-ranges of the right and the left face, m."""
    height: Positive = 2.8
    """Height of the ceiling, m."""


def _material_kind(value: Any) -> str:
    return "<dielectric>" if isinstance(value, (dict, DielectricConfig)) else "<material>"


_Face = Annotated[
    Annotated[Material, Tag("<material>")] | Annotated[DielectricConfig, Tag("<dielectric>")],
    Discriminator(_material_kind),
]


class FacesConfig(Section):
    """What the faces of a room are made of: ITU-R P.2040's name, or {eps_r, loss_tangent}."""

    floor: _Face | None = None
    """Material of the floor: concrete, brick, plasterboard, wood, glass, ceiling_board, chipboard,
    floorboard, metal, or {eps_r, loss_tangent}; null does not reflect. The floor alone needs no
    room.box_m."""
    ceiling: _Face | None = None
    """Material of the ceiling, at the height of room.box_m."""
    left: _Face | None = None
    """Material of the face at the larger y of room.box_m."""
    right: _Face | None = None
    """Material of the face at the smaller y of room.box_m."""
    front: _Face | None = None
    """Material of the face at the smaller x of room.box_m."""
    back: _Face | None = None
    """Material of the face at the larger x of room.box_m."""

    @property
    def given(self) -> dict[str, Material | DielectricConfig]:
        """{name: material} of the faces that reflect."""
        return {name: one for name in type(self).model_fields if (one := getattr(self, name))}


class RoomConfig(Section):
    """What stands in the room, what its faces echo, or a wall behind people."""

    box_m: Annotated[BoxConfig | None, ActsIf("room.faces", GIVEN)] = None
    """Places of the room's faces."""
    faces: FacesConfig | None = None
    """Faces in which people are seen again; null is none."""
    order: Annotated[int, Field(ge=0, le=2, strict=True), ActsIf("room.faces", GIVEN)] = 1
    """Largest number of bounces of a path, on the ways there and back together."""

    reflectors: Annotated[tuple[ReflectorConfig, ...], Field(max_length=MAX_REFLECTORS)] = ()
    """Things that stand in the room, up to 32 of {position_m, rcs_dbsm, residual_m, highest_hz};
    `[{}, {}]` is two default ones."""
    back_wall_m: Annotated[Number, within(0, 1e4, "m")] | None = None
    """Range of a rear wall beyond people, which mirrors them (image source); null is none."""
    back_wall_reflection_db: Annotated[
        Number, within(-120, 0, "dB"), ActsIf("room.back_wall_m", GIVEN)
    ] = -8.0
    """Reflection loss of the rear wall, applied twice to the mirrored echo."""
