"""Images of maps: resized power turned into grey levels, or into masks."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TypeAlias

from radhar_cli.config.data_set import AnyConfig
from radhar_cli.config.image import AbsoluteReference
from radhar_cli.numerics.arrays import Float
from radhar_cli.processing.doppler_power import DopplerPower
from radhar_cli.processing.image import (
    Reduced,
    binary_exponent,
    reduced,
    reduced_map,
    signed_levels,
    unclipped,
)
from radhar_cli.processing.power_map import MapImage, PowerMap
from radhar_cli.processing.scale import CfarMask, DecibelScale, Reference, Scale
from radhar_cli.schema.number import nominal

# Resizes a function of the power, or for None the power itself.
Resize: TypeAlias = Callable[[Callable[[Float], Float] | None], Reduced]


@dataclass(frozen=True)
class ImageForm:
    """Size and contents of the images of a data set.

    Attributes:
        size_px: height and width, pixels.
        has_decibels: whether unclipped decibels are stored beside the levels.
        clipped: share of the samples of signed maps that is black or white.
    """

    size_px: tuple[int, int]
    has_decibels: bool = False
    clipped: float = 0.0

    @classmethod
    def of(cls, config: AnyConfig) -> "ImageForm":
        """Read `image` and `output.power` of a config."""
        image = config.image
        return cls(image.size_px, config.output.power is not None, image.clipped)


def scale_of(config: AnyConfig) -> Scale:
    """Scale of the images of a config; numbers still to be drawn are taken at their middle."""
    if config.image.kind == "cfar":
        return CfarMask(config.image.cfar.make_detector())
    return level_scale_of(config)


def level_scale_of(config: AnyConfig) -> DecibelScale:
    """Scale of grey levels of a config, which frame maps have whatever images show."""
    image = config.image
    if isinstance(image.reference, AbsoluteReference):
        transmitted_dbm = nominal(config.radar.transmit_power_dbm)
        return DecibelScale(image.dynamic_range_db, image.reference.dbm - transmitted_dbm)
    return DecibelScale(image.dynamic_range_db, Reference(image.reference))


def draw_measured_map(config: AnyConfig, power_map: PowerMap) -> MapImage:
    """Draw the image of a measured map as a data set of a config has it."""
    return draw_map(power_map, scale_of(config), ImageForm.of(config))


def draw_map(power_map: PowerMap, scale: Scale, form: ImageForm) -> MapImage:
    """Resize a map and turn its power, or its samples with their sign, into grey levels."""
    if power_map.real is not None:
        grey = signed_levels(power_map.real, form.size_px, form.clipped, power_map.image_rows)
        return MapImage(grey, power_map.entropy, power_map.extent)
    resize = partial(reduced_map, power_map.power, form.size_px, rows=power_map.image_rows)
    image_exponent = binary_exponent(power_map.power)
    return _draw_resized(resize, power_map.extent, image_exponent, scale, form.has_decibels)


def draw_doppler_image(power: DopplerPower, scale: Scale, form: ImageForm) -> MapImage:
    """Resize a Doppler-time map, block by block, and turn its power into grey levels."""

    def resize(function: Callable[[Float], Float] | None) -> Reduced:
        return reduced(power.blocks(), power.frames, form.size_px, function)

    return _draw_resized(resize, power.extent, 2 * power.exponent, scale, form.has_decibels)


def _draw_resized(
    resize: Resize,
    extent: tuple[float, float, float, float],
    exponent: int,
    scale: Scale,
    has_decibels: bool,
) -> MapImage:
    """Draw a map by its resized power.

    Args:
        resize: resizes a function of the power, or for None the power itself.
        extent: edges of the map, (left, right, low, high).
        exponent: the power is in units of 2^exponent.
        scale: law from power to levels.
        has_decibels: whether unclipped decibels are stored, too.
    """
    small = resize(scale.before_resizing)
    image = MapImage(scale.levels(small.cells, exponent), small.entropy, extent)
    if not has_decibels:
        return image
    power = small.cells if scale.before_resizing is None else resize(None).cells
    decibels, largest_db = unclipped(power, exponent)
    return replace(image, decibels=decibels, largest_db=largest_db)
