"""A map in numbers: its statistics, and its image in few pixels."""

from collections.abc import Sequence
from dataclasses import dataclass
from hashlib import sha256

import numpy as np
from PIL import Image

from radhar_cli.arrays import Float, Index, Levels
from radhar_cli.errors import RadharError
from radhar_cli.two_sample.map_statistics import (
    STATISTICS,
    DopplerMap,
    mask_statistics,
    power_statistics,
)
from radhar_cli.two_sample.sides import Side

COARSE = (16, 16)  # pixels of the image that a classifier sees
FINE = 128  # rows from which those that are used are cut
ZERO, BEYOND, NEAR = 0.05, 0.867, 0.025  # of the largest Doppler


@dataclass(frozen=True)
class Scale:
    """How maps are measured."""

    names: tuple[str, ...]  # of the statistics
    axes: bool  # whether edges of the images are used; else all is counted in rows and columns
    # half the width of the line at zero Doppler, Hz or rows; None of a range-time map
    zero: float | None
    ranges: bool  # whether it is a range-time map

    @classmethod
    def of(cls, sides: Sequence[Side], zero: float | None) -> "Scale":
        """What both sides allow; `zero` is 5 % of the largest Doppler if None."""
        ranges = any(side.images.map == "rtm" for side in sides)
        power = not ranges and all(side.dynamic_range_db is not None for side in sides)
        names = tuple(
            name
            for name, one in STATISTICS.items()
            if (one.of_range or not ranges) and (power or not one.of_power)
        )
        axes = all(side.extent is not None for side in sides)
        return cls(names, axes, zero, ranges)

    def edges(self, side: Side, row: int) -> tuple[float, float, float, float]:
        """Left, right, bottom, top of an image."""
        if self.axes:
            assert side.extent is not None
            left, right, bottom, top = map(float, side.extent[row])
            return left, right, bottom, top
        height, width = side.images.size
        bottom = 0.0 if self.ranges else -height / 2
        return 0.0, float(width), bottom, bottom + height

    def refuse_zero(self, sides: Sequence[Side]) -> None:
        """Refuse a line at zero that leaves no Doppler beside it, or has none.

        Raises:
            RadharError: names the value, and what would be right.
        """
        if self.zero is None:
            return
        if self.ranges:
            raise RadharError(f"--zero {self.zero:g}: is of Doppler-time maps; these show ranges")
        edges = [
            np.abs(self.edges(side, int(row))[2:]).max()
            for side in sides
            for rows in side.classes.values()
            for row in rows
        ]
        if not self.zero < (most := BEYOND * min(edges)):
            raise RadharError(
                f"--zero {self.zero:g}: should be below {most:.4g} {self.units()['rows']}, from "
                "where on there is noise alone"
            )

    def units(self) -> dict[str, str]:
        """{"rows", "columns": unit}."""
        if not self.axes:
            return {"rows": "px", "columns": "px"}
        return {"rows": "m" if self.ranges else "Hz", "columns": "s"}

    def unit(self, name: str) -> str:
        """Unit of a statistic."""
        unit = STATISTICS[name].unit
        return self.units().get(unit, unit)


@dataclass(frozen=True)
class Described:
    """Some maps of one side."""

    rows: Index  # [N] of the side
    statistics: Float  # [N, statistics]
    fine: Float  # [N, FINE, columns] mean levels 0 to 1
    hashes: tuple[bytes | None, ...]  # [N] of the levels; None of an image of one level

    def features(self, shown: slice) -> Float:
        """Statistics and few pixels [N, D] for a classifier; `shown` are rows of `fine`."""
        cut = [_boxes(one[shown], COARSE).ravel() for one in self.fine]
        return np.hstack([self.statistics, np.array(cut)])


def describe(side: Side, rows: Index, scale: Scale) -> Described:
    """Read and measure some maps of a side, one after the other.

    Raises:
        FolderError: one cannot be read.
    """
    statistics, fine, hashes = [], [], list[bytes | None]()
    for row in rows:
        levels = side.levels(int(row))
        values = measured(levels, side, int(row), scale)
        statistics.append([values[name] for name in scale.names])
        fine.append(_boxes(levels / np.float32(255), (FINE, COARSE[1])))
        blank = levels.min() == levels.max()
        hashes.append(None if blank else sha256(levels.tobytes()).digest())
    return Described(rows, np.array(statistics), np.array(fine, np.float32), tuple(hashes))


def measured(levels: Levels, side: Side, row: int, scale: Scale) -> dict[str, float]:
    """Statistics of a map."""
    left, right, bottom, top = scale.edges(side, row)
    height = (top - bottom) / len(levels)
    middle = top / height - 0.5  # where zero lies, in rows
    if not scale.ranges:  # on a row or between two, so that slightly other axes measure alike
        middle = round(2 * middle) / 2
    doppler = height * (middle - np.arange(len(levels)))
    largest = float(np.abs(doppler).max())
    zero = -1.0
    if not scale.ranges:
        zero = ZERO * largest if scale.zero is None else scale.zero
        zero = max(zero, 1.001 * height)  # has a row on either side
    if side.masks:
        return mask_statistics(levels >= 128, doppler, right - left, zero)
    one, beyond = DopplerMap(side.power(levels), doppler), BEYOND * largest
    values = mask_statistics(one.occupied(beyond), doppler, right - left, zero)
    if any(STATISTICS[name].of_power for name in scale.names):
        values |= power_statistics(one, zero, beyond, NEAR * largest, values["active"] > 0)
    return values


def span(some: Sequence[Described]) -> slice:
    """Rows of `fine` that hold 99 % of what stands out from its row's median, and a few more."""
    total = np.zeros(FINE)
    for one in some:
        profile = one.fine.mean(axis=(0, 2))
        total += np.maximum(profile - np.median(profile), 0) / max(1e-9, profile.sum())
    share = np.cumsum(total) / max(1e-12, total.sum())
    first, last = np.searchsorted(share, [0.005, 0.995])
    room = FINE // 32
    first, last = max(0, int(first) - room), min(FINE, int(last) + 1 + room)
    return slice(first, last) if last - first >= COARSE[0] else slice(0, FINE)


def _boxes(levels: Float, size: tuple[int, int]) -> Float:
    """Means over boxes: levels [H, W] brought to a size."""
    picture = Image.fromarray(np.asarray(levels, np.float32))
    return np.asarray(picture.resize(size[::-1], Image.Resampling.BOX))
