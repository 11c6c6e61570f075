"""Scales of images: grey levels of decibels, or masks of what exceeds its background."""

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum
from math import log10
from typing import TypeAlias

from radhar_cli.numerics.arrays import Float, Levels
from radhar_cli.processing.cfar_mask import CellAveraging, decibels_of
from radhar_cli.processing.entropy import largest_power
from radhar_cli.processing.image import levels, noise_floor

NOISE_PLACE = 0.4  # of the range of levels, where the noise floor is
FLOAT32_DECADES = 30  # of powers that float32 holds, and their quotients


class Reference(Enum):
    """Power that the grey levels of an image are relative to.

    PEAK: its largest power, which is level 255.
    NOISE: its noise floor, which is two fifths of the range above level 0, as a canceller lowers
    the noise of slow bodies, and so what is seen of them, by some 20 dB. Of a map whose largest
    power is more than the other three fifths above it, the largest power is level 255, so that
    nothing is saturated.
    """

    PEAK = "peak"
    NOISE = "noise"


@dataclass(frozen=True)
class DecibelScale:
    """Grey levels of decibels.

    Attributes:
        range_db: range of the levels, dB.
        reference: reference of the levels; a number is the power of a cell of the map that
            is level 255, the same for all images, in dB for unit transmit power.
    """

    range_db: float
    reference: Reference | float = Reference.PEAK

    @property
    def before_resizing(self) -> None:
        """Power is resized as it is."""

    def levels(self, cells: Float, exponent: int = 0) -> Levels:
        """Grey levels 0 to 255 of resized power [..., height, width] in units of 2^exponent."""
        return levels(cells, self.range_db, self.white(cells, exponent))

    def white(self, cells: Float, exponent: int = 0) -> float:
        """Power of level 255 of resized power [..., height, width] in units of 2^exponent."""
        if isinstance(self.reference, float):
            decades = self.reference / 10 - exponent * log10(2)
            return float(10 ** min(max(decades, -FLOAT32_DECADES), FLOAT32_DECADES))
        largest = largest_power(cells)
        if self.reference is Reference.PEAK:
            return largest
        return max(largest, noise_floor(cells) * 10 ** ((1 - NOISE_PLACE) * self.range_db / 10))


@dataclass(frozen=True)
class CfarMask:
    """Binary masks of the cells that exceed the mean around them.

    Attributes:
        detector: detector of such cells, in power or in decibels.
    """

    detector: CellAveraging

    @property
    def before_resizing(self) -> Callable[[Float], Float] | None:
        """Function of the power that is resized instead of it; None for the power itself."""
        return decibels_of if self.detector.decibel else None

    def levels(self, cells: Float, exponent: int = 0) -> Levels:
        """Levels 0 and 255 of resized cells [height, width], whatever their unit."""
        return self.detector.levels(cells)


Scale: TypeAlias = DecibelScale | CfarMask
