"""A power map with its axes, and its image."""

import hashlib
from dataclasses import dataclass, field
from math import nan

from radhar_cli.numerics.arrays import Float, Half, Levels
from radhar_cli.processing.entropy import entropy_bits


@dataclass(frozen=True)
class Axis:
    """Quantity, unit and values of the rows or the columns of a map."""

    name: str  # frequency, range, time, ...
    unit: str  # Hz, m, s, ...
    values: Float = field(repr=False)  # value of every row or column, even, lowest first
    cell: float = 0.0  # width of the cell of a single value; several have their spacing

    @property
    def edges(self) -> tuple[float, float]:
        """Outer edges of the first and the last cell, in the unit of the axis."""
        several = self.values.size > 1
        half = 0.5 * (float(self.values[1] - self.values[0]) if several else self.cell)
        return float(self.values[0] - half), float(self.values[-1] + half)


@dataclass(frozen=True)
class PowerMap:
    """A map of power for unit transmit power.

    Time runs along the columns of every map of a data set.
    """

    power: Float = field(repr=False)  # [rows, columns], lowest first
    rows: Axis
    columns: Axis
    # the samples with their sign [rows, columns], where those are shown
    real: Float | None = field(default=None, repr=False)

    @property
    def shown(self) -> Float:
        """Values [rows, columns] of the image: samples with their sign if known, else power."""
        return self.power if self.real is None else self.real

    @property
    def entropy(self) -> float:
        """Entropy of the power, bits."""
        return entropy_bits(self.power)

    @property
    def extent(self) -> tuple[float, float, float, float]:
        """Outer edges (columns from, columns to, rows from, rows to)."""
        return (*self.columns.edges, *self.rows.edges)


@dataclass(frozen=True)
class MapImage:
    """Image of a map."""

    levels: Levels = field(repr=False)  # grey levels [height, width], row 0 at the top
    entropy: float  # of the power map, bits; NaN where it is not requested
    # outer edges of the map (columns from, columns to, rows from, rows to)
    extent: tuple[float, float, float, float]
    # decibels of the resized power below its largest, float16 [height, width], or None where they
    # are not requested
    decibels: Half | None = field(default=None, repr=False)
    largest_db: float = nan  # largest resized power, dB for unit transmit power

    @property
    def sha256(self) -> str:
        """Checksum of the levels, row by row, in hex."""
        return hashlib.sha256(self.levels.tobytes()).hexdigest()
