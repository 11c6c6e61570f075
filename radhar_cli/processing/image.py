"""Power map -> grey levels: resize the linear power, then decibels (docs/physics/model.md)."""

from collections.abc import Callable, Iterable, Iterator
from functools import lru_cache
from math import ceil, floor, log, log10, nan
from typing import Any, NamedTuple, TypeAlias

import numpy as np

from radhar_cli.errors import RadharError
from radhar_cli.numerics.arrays import Float, Half, Levels
from radhar_cli.processing.cfar_mask import FLOOR_DB
from radhar_cli.processing.entropy import EntropySum, largest_power

BAND = 64  # rows or columns per matrix product, besides the overlap
FLOOR_SHARE = 0.25  # of the rows of a map, whose medians are its noise floor
Span: TypeAlias = tuple[float, float]  # where it begins and ends


class Reduced(NamedTuple):
    """A resized power map and its entropy.

    Attributes:
        cells: The map, or a function of it, [height, width] in float32, in the scale of the map;
            row 0 is the highest frequency or the farthest range.
        entropy: Entropy of the map, bits; NaN where it was not asked for.
    """

    cells: Float
    entropy: float


def reduced(
    blocks: Iterable[Float],
    columns: int,
    size: tuple[int, int],
    of: Callable[[Float], Float] | None = None,
    entropy: bool = True,
    rows: Span | None = None,
) -> Reduced:
    """Resize a power map that comes in blocks of columns, and sum up its entropy.

    Resizing is Pillow's BILINEAR with antialiasing, a weighted sum over rows and then columns.
    Row r of `height` has its centre (r + 1/2)/height of the way through `rows`.

    Args:
        blocks: Blocks [columns, rows] of a scale near 1, the lowest row first, in the order of
            time.
        columns: Number of columns of all blocks.
        size: (height, width) of the result.
        of: Function of the power that is resized instead of it, such as its decibels.
        entropy: Whether the entropy is computed.
        rows: Places in the rows where the result begins and ends, the outer edge of the first row
            being 0; None for all of them.

    Raises:
        RadharError: The map has an infinity or a NaN.
    """
    height, width = size
    cells, entropy_sum, first = np.zeros(size, np.float32), EntropySum(), 0
    for block in blocks:
        if entropy:
            entropy_sum.add(block)
        block = block if of is None else of(block)
        low = np.zeros((len(block), height), block.dtype)
        count, span = block.shape[1], rows or (0.0, float(block.shape[1]))
        for band, pixels, weights in _bands(0, count, count, height, low.dtype, span):
            low[:, pixels] += block[:, band] @ weights
        every = (0.0, float(columns))
        for band, pixels, weights in _bands(first, len(block), columns, width, low.dtype, every):
            cells[:, pixels] += low[band].T @ weights
        first += len(block)
    total = entropy_sum.total if entropy else float(cells.sum())
    if not np.isfinite(total):
        raise RadharError(f"the power map should be finite; it adds up to {total}")
    return Reduced(cells[::-1], entropy_sum.bits if entropy else nan)


def reduced_map(
    power: Float,
    size: tuple[int, int],
    of: Callable[[Float], Float] | None = None,
    entropy: bool = True,
    rows: Span | None = None,
) -> Reduced:
    """Resize a whole map [frequency or range, time] of any scale, as `reduced` does."""
    scaled = np.ldexp(power.T, -binary_exponent(power))
    return reduced([scaled], power.shape[1], size, of, entropy, rows)


def binary_exponent(power: Float) -> int:
    """Exponent of the power of two by which a map has a scale of 1/2 to 1."""
    return int(np.frexp(largest_power(power))[1])


def unclipped(power: Float, exponent: int) -> tuple[Half, float]:
    """Decibels [height, width] of a power below its largest value, and that value in dB.

    Args:
        power: Power [height, width] in units of 2^exponent.
        exponent: Binary exponent of the unit.
    """
    level = decibels(power.astype(float), -FLOOR_DB)
    largest = max(largest_power(power), 10 ** (FLOOR_DB / 10))
    return level.astype(np.float16), 10 * (log10(largest) + exponent * log10(2))


def levels(power: Float, dynamic_range_db: float, white: float | None = None) -> Levels:
    """Grey levels 0 to 255 of resized power: from dynamic_range_db below white to white, rounded.

    A map of zeros is level 0 everywhere.

    Args:
        power: power [...], in the unit of `white`.
        dynamic_range_db: range of the levels, dB.
        white: power of level 255, and of all that is larger; None for the largest of the map.
    """
    if not power.any():
        return np.zeros(power.shape, np.uint8)
    grey = decibels(power, dynamic_range_db, white)
    grey *= 255 / max(dynamic_range_db, 1e-30)
    grey += 255.5
    return grey.astype(np.uint8)


def signed_levels(
    x: Float, size: tuple[int, int], clipped: float, rows: Span | None = None
) -> Levels:
    """Grey levels round(127.5 (1 + clip(x/q, -1, 1))) of resized real samples.

    Args:
        x: Samples [range, time]; zeros have the level 128.
        size: (height, width) of the result.
        clipped: Share of the samples that is clipped: q is the quantile 1 - clipped of |x|.
        rows: Places in the rows where the result begins and ends; None for all of them.
    """
    scaled = np.ldexp(x.T, -binary_exponent(np.abs(x)))
    cells = reduced([scaled], x.shape[1], size, entropy=False, rows=rows).cells.astype(float)
    q = max(float(np.quantile(np.abs(cells), 1 - clipped)), np.finfo(float).tiny)
    return np.rint(127.5 * (1 + np.clip(cells / q, -1, 1))).astype(np.uint8)


def decibels(power: Float, dynamic_range_db: float, reference: float | None = None) -> Float:
    """Decibels 10 log10(P/reference) of powers P [...], clipped to [-dynamic_range_db, 0].

    Args:
        power: power, in the unit of `reference`; zeros are at -dynamic_range_db.
        reference: power of 0 dB; None for the largest of the map.
    """
    reference = largest_power(power) if reference is None else reference
    if reference == 0:
        return np.full_like(power, -dynamic_range_db)
    level: Float = np.minimum(power / reference, 1)
    below = level < 10 ** (-dynamic_range_db / 10)  # float32 may round that to 1
    level[below] = 1
    np.log(level, out=level)
    level *= 10 / log(10)
    level[below] = -dynamic_range_db
    return level


def noise_floor(power: Float) -> float:
    """Level of the noise of a map, as a power: where most of its rows have their median.

    Medians over time leave out what passes through a row; of their decibels the shortest interval
    that holds a quarter of all rows is taken, and its middle (Andrews et al., Robust Estimates of
    Location, 1972: the shorth). Rows that a canceller has emptied, and those of people, whose
    levels scatter, are outside of it.

    Args:
        power: power [..., rows, columns], the columns over time or over what else a row repeats.

    Returns:
        The floor, in the unit of the power; 0 where a quarter of the rows is 0.
    """
    medians = np.median(np.moveaxis(power, -2, 0).reshape(power.shape[-2], -1), axis=1)
    medians = np.sort(medians.astype(float))
    count = ceil(len(medians) * FLOOR_SHARE)
    low, high = medians[: len(medians) - count + 1], medians[count - 1 :]
    if low[0] <= 0:
        return 0.0
    shortest = int((high / low).argmin())
    return float(np.exp(np.log(medians[shortest : shortest + count]).mean()))


def _bands(
    first: int, count: int, inputs: int, outputs: int, dtype: np.dtype[Any], span: Span
) -> Iterator[tuple[slice, slice, Float]]:
    """Yield the weights that resize `count` inputs from `first` on: y[pixels] += x[band] @ weights.

    Every weight reaches but a few outputs: in bands there is little to multiply with zero.
    """
    step = BAND + 4 * ceil(inputs / outputs)
    for start in range(0, count, step):
        stop = min(start + step, count)
        pixels, weights = _triangles(first + start, first + stop, inputs, outputs, dtype, span)
        if pixels.stop > pixels.start:
            yield slice(start, stop), pixels, weights


@lru_cache(maxsize=256)
def _triangles(
    start: int, stop: int, inputs: int, outputs: int, dtype: np.dtype[Any], span: Span
) -> tuple[slice, Float]:
    """Outputs that inputs start .. stop - 1 reach, and weights [stop - start, those outputs].

    Output j is the mean of the inputs under a triangle around a + (j + 1/2) s, s = (b - a)/outputs,
    whose half width is s or 1, the larger, with the span [a, b] of the outputs.
    """
    begin, scale = span[0], (span[1] - span[0]) / outputs
    reach = max(scale, 1.0)
    low = max(floor((start - begin - reach) / scale - 0.5), 0)
    high = min(ceil((stop - begin + reach) / scale + 0.5), outputs)
    if high <= low:
        return slice(0, 0), np.empty((stop - start, 0), dtype)
    centre = begin + (np.arange(low, high) + 0.5) * scale
    first = min(max(floor(centre[0] - reach), 0), start)
    last = max(min(ceil(centre[-1] + reach), inputs), stop)
    weights = np.maximum(0, 1 - np.abs(np.arange(first, last)[:, None] + 0.5 - centre) / reach)
    weights /= weights.sum(axis=0)
    return slice(low, high), weights[start - first : stop - first].astype(dtype)
