"""A power map with its axes, and its image."""

import hashlib
from dataclasses import dataclass, field, replace
from math import nan

import numpy as np

from radhar_cli.numerics.arrays import Float, Half, Levels
from radhar_cli.processing.entropy import entropy_bits

ROUNDING = 1e-6  # share of a cell by which a limit may miss its edge


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

    def cells_within(self, limits: tuple[float, float]) -> slice:
        """Numbers of the cells that lie within limits, in whole or in part; one at least."""
        low, high = self.edges
        places = (np.array(limits) - low) * (self.values.size / (high - low))
        first = int(np.clip(np.floor(places[0] + ROUNDING), 0, self.values.size - 1))
        stop = int(np.clip(np.ceil(places[1] - ROUNDING), first + 1, self.values.size))
        return slice(first, stop)

    def only(self, cells: slice) -> "Axis":
        """Axis of some of the cells, which keep their width."""
        low, high = self.edges
        return replace(self, values=self.values[cells], cell=(high - low) / self.values.size)

    def within_edges(self, limits: tuple[float, float]) -> tuple[float, float]:
        """Limits, cut where the axis ends; the edges of the axis where nothing is left of them."""
        low, high = max(limits[0], self.edges[0]), min(limits[1], self.edges[1])
        return (low, high) if low < high else self.edges

    def places_of(self, limits: tuple[float, float]) -> tuple[float, float]:
        """Places of limits on the axis, in cells from the outer edge of the first."""
        low, high = self.edges
        places = (np.array(limits) - low) * (self.values.size / (high - low))
        first, last = np.clip(places, 0, self.values.size).tolist()
        return first, last


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
    # outer edges of the rows of its image, in their unit; None for those of the first and last row
    limits: tuple[float, float] | None = None

    def within(self, limits: tuple[float, float] | None) -> "PowerMap":
        """Map of the rows within limits, which are the edges of its image; None for all rows."""
        if limits is None:
            return self
        rows = self.rows.cells_within(limits)
        real = None if self.real is None else self.real[rows]
        axis = self.rows.only(rows)
        return PowerMap(self.power[rows], axis, self.columns, real, axis.within_edges(limits))

    @property
    def image_rows(self) -> tuple[float, float] | None:
        """Places in the rows where its image begins and ends; None for all of them."""
        return None if self.limits is None else self.rows.places_of(self.limits)

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
        """Outer edges of its image (columns from, columns to, rows from, rows to)."""
        return (*self.columns.edges, *(self.limits or self.rows.edges))


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
