"""Config of the images of maps."""

from typing import Annotated, Generic, Literal, TypeAlias

from pydantic import BeforeValidator, Discriminator, Field, Tag, field_validator

from radhar_cli.config.acting import CADENCES, OVER_RANGE, RANGES, SPECTRA
from radhar_cli.errors import did_you_mean
from radhar_cli.processing.cfar_mask import CellAveraging
from radhar_cli.schema.annotations import NeedsKey
from radhar_cli.schema.number import (
    DECIBEL,
    POSITIVE,
    Number,
    Real,
    nominal,
    require,
    uniform,
    value_error,
    within,
)
from radhar_cli.schema.section import N, Section, default_draw, defaults_of

DEFAULT_COLOUR_MAP = "viridis"


MAX_SIDE_PX = 8192
LEAST_PX = 32  # of a side that follows from a radar: less, and networks have nothing to shrink
Pixels = Annotated[int, Field(ge=2, le=MAX_SIDE_PX, strict=True)]


Cells = Annotated[int, Field(ge=0, le=4096, strict=True)]


class CfarConfig(Section, Generic[N]):
    """Cell-averaging CFAR of `image.kind: cfar`; cells are pixels, (rows, columns) on each side.

    With `domain: decibel` the map's median is put at floor_db: a factor of decibels needs a zero.
    """

    guard: tuple[Cells, Cells] = (10, 2)
    """Guard cells on each side, [rows, columns] of pixels, left out of the average."""
    training: tuple[Cells, Cells] = (50, 10)
    """Training cells on each side, [rows, columns] of pixels, averaged."""
    pfa: Annotated[N, POSITIVE, within(1e-12, 0.999)] = default_draw(0.31)
    """False alarm rate in exponentially distributed power, which gives the threshold."""
    domain: Literal["power", "decibel"] = "decibel"
    """Quantity that is averaged and compared."""
    floor_db: Annotated[
        N, DECIBEL, within(0, 200, "dB"), NeedsKey("image.cfar.domain", "decibel")
    ] = default_draw(uniform(10.0, 30.0))
    """Level at which the map's median is put with `domain: decibel`: the threshold is then a factor
    of decibels."""
    edges: Literal["wrap", "shrink"] = "wrap"
    """Cells that stand for those beyond an edge: the ones at the opposite edge, or none."""

    def make_detector(self: "CfarConfig[Number]") -> CellAveraging:
        """Make the detector; numbers that are still to be drawn are taken at their middle."""
        return CellAveraging(
            guard=self.guard,
            training=self.training,
            pfa=nominal(self.pfa),
            decibel=self.domain == "decibel",
            floor_db=nominal(self.floor_db),
            wrap=self.edges == "wrap",
        )


class AbsoluteReference(Section):
    """Power of the brightest level, the same for all images."""

    dbm: Annotated[float, Field(ge=-300, le=100, strict=True)]
    """Power of level 255 as the cells of a map add it up, for radar.transmit_power_dbm."""


def _reference_kind(value: object) -> str:
    """Tag of a reference: a word, or a power."""
    return "<power>" if isinstance(value, dict | AbsoluteReference) else "<word>"


def _require_reference(value: object) -> object:
    """Refuse a value that is neither a word of a reference nor a mapping."""
    if value not in ("noise", "peak") and _reference_kind(value) == "<word>":
        raise value_error("should be noise, peak or {dbm: NUMBER}")
    return value


ImageReference: TypeAlias = Annotated[
    Annotated[Literal["noise", "peak"], Tag("<word>")]
    | Annotated[AbsoluteReference, Tag("<power>")],
    Discriminator(_reference_kind),
    BeforeValidator(_require_reference),
]


class ImageConfig(Section):
    """Size (height, width; one number means square), what pixels show, colour map, limits.

    Limits of the Doppler are speeds, positive approaching.
    """

    size_px: Annotated[
        tuple[Pixels, Pixels],
        BeforeValidator(
            lambda size: (size, size) if isinstance(size, int) else size,
            json_schema_input_type=Pixels | tuple[Pixels, Pixels],
        ),
    ] = (256, 256)
    """Image size [height, width]; one number is a square. Not given, images of a radar with frames
    have a row a Doppler bin and a column a frame, 32 to 256 of each, unless they are masks or a
    map is a sheet of frames."""
    kind: Literal["decibel", "cfar", "signed"] = "decibel"
    """Kind of pixels: grey levels of decibels; cfar, binary masks of what exceeds its background;
    or signed, the samples of an impulse radar's rtm, 0 in the middle."""
    clipped: Annotated[float, Field(ge=0, lt=1, strict=True), NeedsKey("image.kind", "signed")] = (
        0.02
    )
    """Share of the samples that are black or white."""
    dynamic_range_db: Annotated[float, Field(gt=0, le=300, strict=True)] = 50.0
    """Range of the grey levels (`kind: decibel`)."""
    reference: Annotated[ImageReference, NeedsKey("image.kind", "decibel")] = "noise"
    """Reference of the grey levels: noise, the image's noise floor, which is 0.4 dynamic_range_db
    above level 0, less where the image's peak would exceed level 255; peak, its largest power,
    level 255; or {dbm: NUMBER}, the power of a cell that is level 255 in all images: the received
    one in frame maps, in others with the gain of the sums over a window and over range
    (`largest_db` of output.power has their size)."""
    cfar: Annotated[CfarConfig, NeedsKey("image.kind", "cfar")] = defaults_of(CfarConfig)
    colour_map: str = DEFAULT_COLOUR_MAP
    """Colour map of PNGs and figures, any Matplotlib name; dataset.h5 holds grey levels."""
    doppler_limits_mps: Annotated[
        tuple[Real, Real] | None,
        require(lambda value: value[0] < value[1], "should be [low, high] with low < high"),
        SPECTRA,
    ] = None
    """Speeds [low, high] that Doppler maps show, approaching positive; null is all."""
    range_limits_m: Annotated[
        tuple[Real, Real] | None,
        require(lambda value: 0 <= value[0] < value[1], "should be [near, far], 0 <= near < far"),
        OVER_RANGE,
        RANGES,
    ] = None
    """Ranges [near, far] at the edges of images of rtm and of a board's frame maps, and over which
    angle-time maps sum; null is where people can be (model: human), or all."""

    cadence_limit_hz: Annotated[float, Field(gt=0, le=1000, strict=True), CADENCES] = 8.0
    """Highest cadence of the diagrams `_cadence`, Hz; half the windows a second bound it."""

    @field_validator("colour_map")
    @classmethod
    def _require_known_colour_map(cls, value: str) -> str:
        if value != DEFAULT_COLOUR_MAP:  # Matplotlib is slow to import
            from matplotlib import colormaps

            if value not in colormaps:
                hint = did_you_mean(value, colormaps, "viridis, gray, turbo, jet are some")
                raise value_error(f"should be a Matplotlib colour map; {hint}")
        return value
