"""The wall in front of people, and the room around them."""

from collections.abc import Iterator, Sequence
from math import inf
from typing import Annotated, Any, Generic, Literal

import numpy as np
from pydantic import Discriminator, Field, GetCoreSchemaHandler, Tag
from pydantic_core import CoreSchema

from radhar_cli.motion.reflectors import TONES, Reflectors
from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.layers import Layer, Layers
from radhar_cli.radar.materials import Material, permittivity
from radhar_cli.radar.room import FACES, Box, Face, Leg, reflected_legs
from radhar_cli.radar.wall import Wall
from radhar_cli.schema.annotations import GIVEN, ByModel, NeedsKey
from radhar_cli.schema.number import (
    AT_LEAST_ONE,
    NOT_NEGATIVE,
    POSITIVE,
    Number,
    nominal,
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

    def make_layer(self: "LayerConfig[Number] | LayerConfig[float]") -> Layer:
        """Make the layer; numbers that are still to be drawn are taken at their middle."""
        thickness = nominal(self.thickness_m)
        if self.material is not None:
            return Layer(thickness, self.material)
        assert self.eps_r is not None  # refused where the config is read
        return Layer(thickness, nominal(self.eps_r) * (1 - 1j * nominal(self.loss_tangent)))


def mean_slab(layers: Sequence[Layer], hz: float) -> tuple[float, float, float]:
    """Depth (m), eps_r and loss tangent of one layer with the mean refractive index of several.

    A wave of frequency `hz` is delayed and absorbed in it as in all of them.
    """
    depth = sum(layer.thickness for layer in layers)
    n = sum(layer.thickness * np.sqrt(layer.eps(np.array(hz))) for layer in layers) / depth
    eps = complex(n * n)
    return depth, eps.real, -eps.imag / eps.real


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

    def make_wall(self: "WallConfig[float]", middle_hz: float, polarisation: str) -> Wall:
        """Make the wall; layers are one slab of their mean refractive index besides.

        Args:
            middle_hz: middle of the radar's band, at which that index is taken.
            polarisation: vertical or horizontal.
        """
        depth, width, height = self.size_m
        eps_r, loss_tangent = self.eps_r, self.loss_tangent
        if self.layers is None:
            assert depth is not None  # refused where the config is read
            layers: tuple[Layer, ...] = (Layer(depth, eps_r * (1 - 1j * loss_tangent)),)
        else:
            layers = tuple(layer.make_layer() for layer in self.layers)
            depth, eps_r, loss_tangent = mean_slab(layers, middle_hz)
        exact = Layers(layers, parallel=polarisation == "horizontal")
        return Wall(
            center=self.center_m,
            size=(depth, width, height),
            eps_r=eps_r,
            loss_tangent=loss_tangent,
            rays=self.rays,
            fresnel=self.fresnel,
            layers=exact if self.echoes == "exact" else None,
        )


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
    """Places of the faces of a room; the floor is at 0."""

    x: tuple[N, N] = default_draw((0.0, 6.0))
    """Ranges of the front and the back face, m."""
    y: tuple[N, N] = default_draw((-2.5, 2.5))
    """Cross-ranges of the right and the left face, m."""
    height: Annotated[N, POSITIVE] = default_draw(2.8)
    """Height of the ceiling, m."""

    def make_box(self: "BoxConfig[float]") -> Box:
        """Make the box of the faces."""
        return Box(self.x, self.y, self.height)


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
    """Materials of the faces of a room: ITU-R P.2040's name, or {eps_r, loss_tangent}."""

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

    def make_faces(
        self: "FacesConfig[float]", box: Box | None, middle_hz: float, polarisation: str
    ) -> Iterator[Face]:
        """Make the faces that reflect.

        Args:
            box: box of the faces; None for a floor alone.
            middle_hz: middle of the radar's band, at which permittivities are taken.
            polarisation: vertical or horizontal.
        """
        face_offsets = {"floor": 0.0} if box is None else box.face_offsets
        normal = FACES["floor" if polarisation == "vertical" else "left"]
        for name, material in self.reflecting.items():
            parallel, reflection_coefficient = FACES[name] != normal, None
            if material == "metal":
                reflection_coefficient = -1.0 if parallel else 1.0
            if isinstance(material, str):
                eps = complex(permittivity(material, np.array(middle_hz)))
            else:
                eps = complex(material.eps_r * (1 - 1j * material.loss_tangent))
            offset = face_offsets[name]
            yield Face(name, FACES[name], offset, eps, parallel, reflection_coefficient)


class RoomConfig(Section, Generic[N]):
    """Objects in the room, echoes of its faces, or a wall behind people."""

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

    def make_box(self: "RoomConfig[float]") -> Box | None:
        """Make the box of the faces; None without faces, or for a floor alone."""
        return None if self.faces is None or self.box_m is None else self.box_m.make_box()

    def find_ways(
        self: "RoomConfig[float]", nearest_m: float, middle_hz: float, polarisation: str
    ) -> list[tuple[Leg, Leg]]:
        """Find the ways of the transmitter's and the receiver's leg by faces, or by a back wall.

        Args:
            nearest_m: least x of an antenna; before the front face a radar looks into the room.
            middle_hz: middle of the radar's band, at which permittivities are taken.
            polarisation: vertical or horizontal.
        """
        if self.back_wall_m is not None:
            reflection = 10 ** (self.back_wall_reflection_db / 20)
            face = Face("back", FACES["back"], self.back_wall_m, constant_reflection=reflection)
            return [(Leg((face,)), Leg((face,)))]
        if self.faces is None:
            return []
        box = self.make_box()
        faces = [*self.faces.make_faces(box, middle_hz, polarisation)]
        is_outside = nearest_m < (-inf if box is None else box.x[0])
        return list(reflected_legs(faces, self.order, is_outside))

    def make_reflectors(
        self: "RoomConfig[float]", towards: Float, rng: np.random.Generator
    ) -> Reflectors:
        """Make the reflectors that stand in the room.

        Args:
            towards: middle of the antennas [3], m, along the line of sight to which they move.
            rng: draws their small motions.
        """
        each = self.reflectors
        return Reflectors(
            places=np.array([one.position_m for one in each]),
            rcs=10 ** (np.array([one.rcs_dbsm for one in each]) / 10),
            sd=np.array([one.residual_m for one in each]),
            fastest=np.array([one.highest_hz for one in each]),
            fractions=rng.random((len(each), TONES)),
            phases=rng.random((len(each), TONES)),
            towards=towards,
        )
