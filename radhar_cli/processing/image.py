"""Power map -> grey levels: resize the linear power, then decibels (docs/model.md, Image)."""

import hashlib
from dataclasses import dataclass

import numpy as np
from PIL import Image

from radhar_cli.arrays import Float, Levels


@dataclass(frozen=True)
class MapImage:
    """The image of a map.

    Attributes:
        levels: grey levels [height, width], row 0 at the top.
        entropy: of the power map, bits.
        extent: outer edges of the map (columns from, columns to, rows from, rows to).
    """

    levels: Levels
    entropy: float
    extent: tuple[float, float, float, float]

    @property
    def sha256(self) -> str:
        """Checksum of the levels, row by row, in hex."""
        return hashlib.sha256(self.levels.tobytes()).hexdigest()


AT_ONCE = 2**20  # weights, or pixels of columns reduced in height


def levels(power: Float, size: tuple[int, int], dynamic_range_db: float) -> Levels:
    """Levels 0 to 255 [height, width] of a power map [frequency or range, time].

    The linear power is resized (Pillow, mode F, BILINEAR with antialiasing), divided by the new
    maximum, turned into dB, clipped to [-dynamic_range_db, 0] and scaled to 0..255. Row 0 is the
    top: the highest Doppler, the farthest range. An all-zero map is level 0 everywhere.

    Raises:
        ValueError: the map has an infinity or a NaN.
    """
    height, width = size
    largest = float(power.max(initial=0.0))
    if largest == 0:
        return np.zeros(size, np.uint8)
    if not np.isfinite(largest):
        raise ValueError(f"the power map should be finite; its largest value is {largest}")
    # A power of two brings any map into the range of float32 without changing a digit.
    scaled = np.ldexp(power[::-1], -int(np.frexp(largest)[1]))
    resized = _resized(scaled, height, width)
    return _grey(resized, dynamic_range_db)


class ColumnSum:
    """The resized power of a map that comes in blocks of columns, to float32 rounding.

    Pillow reduces the columns of a block in height. In width they are summed up with the weights
    of the same triangle, so that no more than the image is held. Powers refer to 2^e, e that of
    the largest so far.
    """

    def __init__(self, size: tuple[int, int], columns: int) -> None:
        self._size, self._columns = size, columns
        self._seen, self._exponent = 0, 0
        self._sum = np.zeros(size)
        self._weight = np.zeros(size[1])

    def add(self, power: Float) -> None:
        """Take in the next columns [frequency, columns]."""
        most = max(1, AT_ONCE // max(self._size))
        for first in range(0, power.shape[1], most):
            self._add(power[:, first : first + most])

    def _add(self, power: Float) -> None:
        weights = self._triangle(power.shape[1])
        self._seen += power.shape[1]
        self._weight += weights.sum(axis=0)
        largest = float(power.max(initial=0.0))
        if largest == 0:
            return
        exponent = int(np.frexp(largest)[1])
        narrow = _resized(np.ldexp(power[::-1], -exponent), self._size[0], power.shape[1])
        highest = max(exponent, self._exponent) if self._sum.any() else exponent
        self._sum = np.ldexp(self._sum, self._exponent - highest)
        self._sum += np.ldexp(narrow.astype(float), exponent - highest) @ weights
        self._exponent = highest

    def levels(self, dynamic_range_db: float) -> Levels:
        """`levels` of all columns together."""
        if not self._sum.any():
            return np.zeros(self._size, np.uint8)
        return _grey((self._sum / self._weight).astype(np.float32), dynamic_range_db)

    def _triangle(self, count: int) -> Float:
        """Weights [count, width] of the next columns, before they are normalised."""
        scale = self._columns / self._size[1]
        centre = (np.arange(self._size[1]) + 0.5) * scale
        at = self._seen + np.arange(count)[:, None] + 0.5
        weights: Float = np.maximum(0.0, 1 - np.abs(at - centre) / max(scale, 1.0))
        return weights


def _resized(power: Float, height: int, width: int) -> Float:
    """Pillow, mode F, BILINEAR with antialiasing: [height, width] in float32."""
    picture = Image.fromarray(np.ascontiguousarray(power, dtype=np.float32))
    return np.asarray(picture.resize((width, height), Image.Resampling.BILINEAR))


def _grey(resized: Float, dynamic_range_db: float) -> Levels:
    """Resized power -> decibels below its maximum -> levels."""
    floor = 10 ** (-dynamic_range_db / 10)
    relative = np.maximum(resized / resized.max(), np.float32(floor)).astype(float)
    decibels = np.clip(10 * np.log10(relative), -dynamic_range_db, 0)
    grey: Levels = np.floor((decibels / dynamic_range_db + 1) * 255 + 0.5).astype(np.uint8)
    return grey
