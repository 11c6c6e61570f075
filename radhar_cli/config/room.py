"""The wall in front of people, and the room around them."""

from typing import Annotated, Any, Generic, Literal

from pydantic import Discriminator, Field, GetCoreSchemaHandler, Tag
from pydantic_core import CoreSchema

from radhar_cli.radar.materials import Material
from radhar_cli.schema.annotations import GIVEN, ByModel, NeedsKey
from radhar_cli.schema.number import (
    AT_LEAST_ONE,
    NOT_NEGATIVE,
    POSITIVE,
    uniform,
    within,
)
from radhar_cli.schema.section import Filled, N, Section, VectorOf, default_draw

SIZE = within(1e-6, 1e6, "m")


class LayerConfig(Section, Generic[N]):
    """A layer of a wall, of a material or of a permittivity."""

    thickness_m: Annotated[N, POSITIVE, SIZE] = default_draw(0.1)
    """Thickness of the layer."""
    material: Material | None = None
    """Material of ITU-R P.2040, whose permittivity depends on frequency; null takes eps_r."""
    eps_r: Annotated[N | None, AT_LEAST_ONE, within(1, 1e6)] = None
    """Relative permittivity of the layer, where no material is named."""
    loss_tangent: Annotated[N, NOT_NEGATIVE, within(0, 1e12)] = default_draw(0.0)
    """Loss tangent of the layer, used with eps_r."""


_NO_LAYERS = NeedsKey("wall.layers", None)


class WallConfig(Section, Generic[N]):
    """Centre, size along x, y, z, relative permittivity and loss tangent of the wall.

    `rays` and `fresnel` are optional physics; docs/physics/engines.md has the size of it.
    """

    center_m: VectorOf[N] = default_draw((1.0, 0.0, 1.25))
    """Middle of the wall: range, cross-range, height."""
    size_m: tuple[
        Annotated[N | None, POSITIVE, SIZE],
        Annotated[N, POSITIVE, SIZE],
        Annotated[N, POSITIVE, SIZE],
    ] = default_draw((0.24, 5.0, 2.5))
    """Extent of the wall in range, cross-range, height; with layers, whose thickness counts, [null,
    y, z]."""
    eps_r: Annotated[N, AT_LEAST_ONE, within(1, 1e6), _NO_LAYERS] = default_draw(6.0)
    """Relative permittivity of the wall."""
    loss_tangent: Annotated[N, NOT_NEGATIVE, within(0, 1e12), _NO_LAYERS] = default_draw(0.03)
    """Loss tangent of the wall's material."""
    rays: Annotated[
        Filled[Literal["straight", "plane", "refracted"]],
        ByModel(human="plane", paper="straight", file="plane"),
    ] = default_draw(None)
    """Path of a ray through the wall: the chord, a plane wave's at the same angle, or Snell's
    law."""
    fresnel: Literal["normal", "perpendicular", "parallel"] = "normal"
    """Loss of the wall's faces: at normal incidence, or at the ray's angle with the field
    perpendicular or parallel to its plane."""
    echoes: Literal["none", "exact"] = "none"
    """Reflections inside the wall: none, or exact over frequency, by radar.polarisation; exact
    needs engine.kind: cube or an impulse radar."""
    layers: Annotated[
        Annotated[tuple[LayerConfig[N], ...], Field(min_length=1, max_length=16)] | None,
        NeedsKey("wall.echoes", "exact"),
    ] = None
    """Layers of the wall, nearest first, with echoes: exact; null is one layer of size_m, eps_r and
    loss_tangent."""


class ReflectorConfig(Section, Generic[N]):
    """Something that stands in the room, with a residual motion along the line of sight."""

    position_m: VectorOf[N] = default_draw(
        (uniform(1.0, 6.0), uniform(-3.0, 3.0), uniform(0.0, 2.5))
    )
    """Position of the reflector: range, cross-range, height."""
    rcs_dbsm: Annotated[N, within(-120, 120, "dBsm")] = default_draw(uniform(-10.0, 10.0))
    """Radar cross-section of the reflector."""
    residual_m: Annotated[N, NOT_NEGATIVE, within(0, 0.01, "m")] = default_draw(uniform(5e-5, 5e-4))
    """Standard deviation of the reflector's small motion along the line of sight."""
    highest_hz: Annotated[N, POSITIVE, within(1e-3, 100, "Hz")] = default_draw(10.0)
    """Highest frequency of the reflector's small motion."""


MAX_REFLECTORS = 32


class DielectricConfig(Section, Generic[N]):
    """A material by its permittivity eps_r (1 - j loss_tangent)."""

    eps_r: Annotated[N, AT_LEAST_ONE, within(1, 1e6)] = default_draw(5.0)
    """Relative permittivity of the material."""
    loss_tangent: Annotated[N, NOT_NEGATIVE, within(0, 1e12)] = default_draw(0.0)
    """Loss tangent of the material."""


class BoxConfig(Section, Generic[N]):
    """Where the faces of a room are; the floor is at 0."""

    x: tuple[N, N] = default_draw((0.0, 6.0))
    """Ranges of the front and the back face, m."""
    y: tuple[N, N] = default_draw((-2.5, 2.5))
    """Cross-ranges of the right and the left face, m."""
    height: Annotated[N, POSITIVE] = default_draw(2.8)
    """Height of the ceiling, m."""


def _material_kind(value: Any) -> str:
    return "<dielectric>" if isinstance(value, (dict, DielectricConfig)) else "<material>"


_FACE = Annotated[
    Annotated[Material, Tag("<material>")] | Annotated[DielectricConfig, Tag("<dielectric>")],
    Discriminator(_material_kind),
]


class _Face:
    """Annotation of a material by name or by permittivity, which one function tells apart."""

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return handler.generate_schema(_FACE)


class FacesConfig(Section, Generic[N]):
    """What the faces of a room are made of: ITU-R P.2040's name, or {eps_r, loss_tangent}."""

    floor: Annotated[Material | DielectricConfig[N], _Face()] | None = None
    """Material of the floor: concrete, brick, plasterboard, wood, glass, ceiling_board, chipboard,
    floorboard, metal, or {eps_r, loss_tangent}; null does not reflect. The floor alone needs no
    room.box_m."""
    ceiling: Annotated[Material | DielectricConfig[N], _Face()] | None = None
    """Material of the ceiling, at the height of room.box_m."""
    left: Annotated[Material | DielectricConfig[N], _Face()] | None = None
    """Material of the face at the larger y of room.box_m."""
    right: Annotated[Material | DielectricConfig[N], _Face()] | None = None
    """Material of the face at the smaller y of room.box_m."""
    front: Annotated[Material | DielectricConfig[N], _Face()] | None = None
    """Material of the face at the smaller x of room.box_m."""
    back: Annotated[Material | DielectricConfig[N], _Face()] | None = None
    """Material of the face at the larger x of room.box_m."""

    @property
    def reflecting(self) -> dict[str, Material | DielectricConfig[N]]:
        """{name: material} of the faces that reflect."""
        return {
            name: material for name in type(self).model_fields if (material := getattr(self, name))
        }


class RoomConfig(Section, Generic[N]):
    """What stands in the room, what its faces echo, or a wall behind people."""

    box_m: Annotated[BoxConfig[N] | None, NeedsKey("room.faces", GIVEN)] = None
    """Places of the room's faces."""
    faces: FacesConfig[N] | None = None
    """Faces in which people are seen again; null is none."""
    order: Annotated[int, Field(ge=0, le=2, strict=True), NeedsKey("room.faces", GIVEN)] = 1
    """Largest number of bounces of a path, on the ways there and back together."""

    reflectors: Annotated[tuple[ReflectorConfig[N], ...], Field(max_length=MAX_REFLECTORS)] = ()
    """Things that stand in the room, up to 32 of {position_m, rcs_dbsm, residual_m, highest_hz};
    `[{}, {}]` is two default ones."""
    back_wall_m: Annotated[N, within(0, 1e4, "m")] | None = None
    """Range of a rear wall beyond people, which mirrors them (image source); null is none."""
    back_wall_reflection_db: Annotated[
        N, within(-120, 0, "dB"), NeedsKey("room.back_wall_m", GIVEN)
    ] = default_draw(-8.0)
    """Reflection loss of the rear wall, applied twice to the mirrored echo."""
