"""Scales of images: grey levels of decibels, or masks of what exceeds its background."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TypeAlias

from radhar_cli.numerics.arrays import Float, Levels
from radhar_cli.processing.cfar import CellAveraging, decibels_of
from radhar_cli.processing.image import levels


@dataclass(frozen=True)
class DecibelScale:
    """Grey levels of decibels.

    Attributes:
        range_db: range of the levels below the largest power, dB.
    """

    range_db: float

    @property
    def before_resizing(self) -> None:
        """Power is resized as it is."""

    def levels(self, cells: Float) -> Levels:
        """Grey levels 0 to 255 of resized power [height, width]."""
        return levels(cells, self.range_db)


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

    def levels(self, cells: Float) -> Levels:
        """Levels 0 and 255 of resized cells [height, width]."""
        return self.detector.levels(cells)


Scale: TypeAlias = DecibelScale | CfarMask
