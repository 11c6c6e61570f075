"""Power map -> grey levels: resize the linear power, then decibels (docs/model.md, Image)."""

import numpy as np
from PIL import Image

from radhar_cli.arrays import Float, Levels


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
    picture = Image.fromarray(np.ascontiguousarray(scaled, dtype=np.float32))
    resized = np.asarray(picture.resize((width, height), Image.Resampling.BILINEAR))
    floor = 10 ** (-dynamic_range_db / 10)
    relative = np.maximum(resized / resized.max(), np.float32(floor)).astype(float)
    decibels = np.clip(10 * np.log10(relative), -dynamic_range_db, 0)
    grey: Levels = np.floor((decibels / dynamic_range_db + 1) * 255 + 0.5).astype(np.uint8)
    return grey
