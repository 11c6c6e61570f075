"""Two-dimensional cell-averaging CFAR: a cell is set where it exceeds the mean around it.

Constant false alarm rate; M. A. Richards, Fundamentals of Radar Signal Processing, 2nd edition,
section 6.5.
"""

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from radhar_cli.numerics.arrays import Bool, Float, Levels

SET = 255  # level of a detected cell; all others are 0
FLOOR_DB = -300.0  # lowest level of a map scaled near 1


@dataclass(frozen=True)
class CellAveraging:
    """Detector of the cells of a map that exceed the mean around them."""

    guard: tuple[int, int]  # cells on each side that are left out, (rows, columns)
    training: tuple[int, int]  # cells on each side beyond those, whose mean is the background
    pfa: float  # false alarm rate in exponentially distributed power, which makes the threshold
    decibel: bool = False  # whether cells are compared in decibels; in power otherwise
    # where the median of a map in decibels is put, so that a factor means something
    floor_db: float = 0.0
    # whether training cells beyond an edge are those of the opposite edge; otherwise there are
    # fewer
    wrap: bool = False

    def levels(self, cells: Float) -> Levels:
        """Levels 0 and 255 [rows, columns] of a map in power, or in decibels with `decibel`."""
        if self.decibel:
            cells = cells - np.median(cells) + self.floor_db
        return np.where(self.is_set(cells), SET, 0).astype(np.uint8)

    def is_set(self, cells: Float) -> Bool:
        """Whether each cell [rows, columns] exceeds its threshold; never without training cells."""
        count = self.training_cells(cells.shape)
        mean = self._training_sum(cells.astype(float, copy=False)) / np.maximum(count, 1)
        level = mean * false_alarm_factor(self.pfa, np.maximum(count, 1))
        return (cells > level) & (count > 0)

    def training_cells(self, shape: tuple[int, ...]) -> Float:
        """Number of training cells of each cell [rows, columns]."""
        return _training_cells(shape, self.guard, self.training, self.wrap)

    def _training_sum(self, cells: Float) -> Float:
        """Sum over the training cells: the large box less the guard box.

        Running sums leave an error of some 1e-14 of the largest cell of the map.
        """
        both = tuple(g + t for g, t in zip(self.guard, self.training, strict=True))
        return _box_sum(cells, both, self.wrap) - _box_sum(cells, self.guard, self.wrap)


def false_alarm_factor(pfa: float, count: Float) -> Float:
    """Threshold N (P_fa^(-1/N) - 1) over the mean of N cells of exponentially distributed power.

    Richards, equation for cell averaging; `phased.CFARDetector2D` of MATLAB has the same.
    """
    factor: Float = count * np.expm1(-np.log(pfa) / count)
    return factor


def decibels_of(power: Float) -> Float:
    """Decibels 10 log10 P of a power P [...] of a scale near 1, at least FLOOR_DB."""
    level: Float = np.maximum(power, power.dtype.type(10 ** (FLOOR_DB / 10)), dtype=power.dtype)
    np.log10(level, out=level)
    level *= 10
    return level


@lru_cache(maxsize=8)  # the same for every map of a data set
def _training_cells(
    shape: tuple[int, ...], guard: tuple[int, int], training: tuple[int, int], wrap: bool
) -> Float:
    """Number of training cells of each cell [rows, columns]."""
    both = tuple(g + t for g, t in zip(guard, training, strict=True))
    ones = np.ones(shape)
    count: Float = np.rint(_box_sum(ones, both, wrap) - _box_sum(ones, guard, wrap))
    count.flags.writeable = False
    return count


def _box_sum(cells: Float, reach: tuple[int, ...], wrap: bool) -> Float:
    """Sum over the cells up to `reach` (rows, columns) away [rows, columns]."""
    from scipy.ndimage import uniform_filter1d  # slow to import

    for axis, far in enumerate(reach):
        size = 2 * far + 1
        cells = uniform_filter1d(cells, size, axis, mode="wrap" if wrap else "constant") * size
    return cells
