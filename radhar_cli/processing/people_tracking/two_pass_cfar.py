"""CFAR of a range-angle map in two passes, with the edges of TI's firmware.

A cell is a point if it exceeds the smaller mean of its two sides along range, and then along angle,
or is the largest of its neighbours in angle and not far below the largest of its bin. Sides that
leave the map go on at its other end or are mirrored; at the ends of the angles their sums have
other numbers of cells than they are divided by. Both as in `RADARDEMO_detectionCFAR`.
"""

from functools import lru_cache
from typing import NamedTuple, TypeAlias

import numpy as np

from radhar_cli.numerics.arrays import Bool, Float, Index
from radhar_cli.radar.people_tracking import TwoPassCfar

MAX_CELLS = 150  # of people tracking; the first, not the strongest
Side: TypeAlias = list[int]


class Cells(NamedTuple):
    """Detected cells of a map, in the order in which they become points.

    Attributes:
        angle: Number of the angle [n].
        bin: Number of the range bin [n].
        power: Power of the cell [n].
        noise: Mean of its neighbours along range [n].
    """

    angle: Index
    bin: Index
    power: Float
    noise: Float

    def where(self, chosen: Bool | Index | slice) -> "Cells":
        """Cells of a mask, of indices or of a slice."""
        return Cells(self.angle[chosen], self.bin[chosen], self.power[chosen], self.noise[chosen])


def detect_moving(power: Float, cfar: TwoPassCfar) -> Cells:
    """Detect cells of a map of moving echoes, angles ascending, and bins within an angle.

    Args:
        power: Power [angle, bin].
        cfar: Settings.
    """
    candidates = _above_range_noise(power, cfar)
    is_kept = np.zeros(candidates.power.size, bool)
    if cfar.second_pass:
        is_kept |= _is_above_angle_noise(power, candidates, cfar)
    if cfar.sidelobe is not None:
        largest = power.max(axis=0)[candidates.bin]
        is_kept |= _is_peak(power, candidates, axis=0) & (
            candidates.power > cfar.sidelobe * largest
        )
    return candidates.where(is_kept)


def detect_static(power: Float, cfar: TwoPassCfar) -> Cells:
    """Detect cells of a map of static echoes: maxima over angle and range."""
    candidates = _above_range_noise(power, cfar)
    is_kept = _is_peak(power, candidates, axis=0) & _is_peak(power, candidates, axis=1)
    if cfar.sidelobe is not None:
        is_kept &= candidates.power > cfar.sidelobe * power.max(axis=0)[candidates.bin]
    return candidates.where(is_kept)


def range_noise(power: Float, cfar: TwoPassCfar) -> Float:
    """Smaller mean of the two sides along range [angle, bin], of the bins that are not skipped.

    Args:
        power: Power [angle, bin].
        cfar: Settings.
    """
    count = power.shape[1]
    left, right = _range_sides(count, cfar.skip_range, cfar.window[0], cfar.guard[0])
    return np.minimum(power @ left, power @ right) / cfar.window[0]


def angle_noise(power: Float, cells: Cells, cfar: TwoPassCfar) -> Float:
    """Smaller mean of the two sides along angle [n] of detected cells."""
    sides = _angle_sides(power.shape[0], cfar.skip_angle[0], cfar.window[1], cfar.guard[1])
    padded = np.vstack([power, np.zeros((1, power.shape[1]))])
    sums = [padded[side[cells.angle], cells.bin[:, None]].sum(axis=1) for side in sides]
    noise: Float = np.minimum(*sums) / cfar.window[1]
    return noise


def _above_range_noise(power: Float, cfar: TwoPassCfar) -> Cells:
    """Cells that exceed the noise along range, angles ascending, and bins within an angle."""
    angles = slice(cfar.skip_angle[0], power.shape[0] - cfar.skip_angle[1])
    first = cfar.skip_range[0]
    bins = slice(first, power.shape[1] - cfar.skip_range[1])
    noise, level = range_noise(power, cfar)[angles], power[angles, bins]
    angle, column = np.nonzero(level > cfar.threshold[0] * noise)
    values = level[angle, column], noise[angle, column]
    return Cells(angle + cfar.skip_angle[0], column + first, *values)


def _is_above_angle_noise(power: Float, cells: Cells, cfar: TwoPassCfar) -> Bool:
    """Whether cells exceed the noise along angle [n]."""
    is_above: Bool = cells.power > cfar.threshold[1] * angle_noise(power, cells, cfar)
    return is_above


def _is_peak(power: Float, cells: Cells, axis: int) -> Bool:
    """Whether cells exceed both neighbours along an axis [n]; beyond an end there is none."""
    pads = [(0, 0), (0, 0)]
    pads[axis] = (1, 1)
    wide = np.pad(power, pads, constant_values=-np.inf)
    angle, column = cells.angle, cells.bin
    near, far = (
        (wide[angle, column], wide[angle + 2, column])
        if axis == 0
        else (wide[angle, column], wide[angle, column + 2])
    )
    is_peak: Bool = (cells.power > near) & (cells.power > far)
    return is_peak


@lru_cache(maxsize=16)
def _range_sides(bins: int, skip: tuple[int, int], window: int, guard: int) -> tuple[Float, Float]:
    """Cells of the sides along range, as 0 and 1 [bin, bin that is not skipped]."""
    first, last = skip[0], bins - skip[1]
    left, right = (np.zeros((bins, last - first)) for _ in range(2))
    for k in range(first, last):
        left[_left_side(k, first, window, guard), k - first] = 1
        right[_right_side(k, last, skip[1], window, guard), k - first] = 1
    return left, right


def _left_side(k: int, first: int, window: int, guard: int) -> Side:
    """Bins on the near side of bin k, mirrored where they would lie before the first."""
    reach = window + guard
    if k > first + reach:
        return [*range(k - reach, k - guard)]
    if k > first + guard:
        return [*range(first, k - guard), *range(k + guard, first + guard + reach)]
    return [*range(k + guard, k + reach)]


def _right_side(k: int, last: int, skip: int, window: int, guard: int) -> Side:
    """Bins on the far side of bin k; beyond the last those `skip` bins before the ones near k."""
    reach = window + guard
    if k < last - reach:
        return [*range(k + guard + 1, k + reach + 1)]
    mirrored = [j - skip for j in range(last - reach, k + 1)]
    return [*range(k + guard + 1, last), *mirrored[-window:]]


@lru_cache(maxsize=16)
def _angle_sides(angles: int, skip: int, window: int, guard: int) -> tuple[Index, Index]:
    """Cells of the sides along angle [angle, cell]; the number of angles stands for none."""
    pairs = [_sides_of_angle(i, angles, skip, window, guard) for i in range(angles)]
    tables = []
    for sides in zip(*pairs, strict=True):
        table = np.full((angles, max(map(len, sides))), angles)
        for i, side in enumerate(sides):
            table[i, : len(side)] = side
        tables.append(table)
    return tables[0], tables[1]


def _sides_of_angle(i: int, angles: int, skip: int, window: int, guard: int) -> tuple[Side, Side]:
    """Cells on both sides of angle i, which go on at the other end of the angles."""
    right = range(i + guard + 1, i + guard + window + 1)
    if i < window + guard:
        missing = window + guard - i
        wrapped = range(angles - missing, min(angles - guard + skip, angles))
        return [*wrapped, *range(window - missing)], [*right]
    if i >= angles - window - guard:
        missing = max(0, window + 2 * guard + 1 + i - angles)
        return [*range(i - window, i)], [*range(missing), *range(i + guard + 1, angles)]
    return [*range(i - guard - window, i - guard)], [*right]
