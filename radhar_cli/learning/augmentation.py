"""Changed copies of training images, drawn anew in every epoch.

A change keeps the class: maps shift and stretch in time, scale along Doppler, lose bands, gain
noise. There is no mirror image: a mirrored Doppler-time map is another activity.
"""

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from radhar_cli.learning.settings import AugmentConfig
from radhar_cli.numerics.arrays import Float, Levels
from radhar_cli.numerics.randomness import TRAINING, stream


@dataclass(frozen=True)
class Augmentation:
    """Changes that depend on seed, epoch and row alone, whichever process makes them."""

    config: AugmentConfig  # how far the changes go
    seed: int  # of the training run

    def __call__(self, levels: Levels, row: int, epoch: int) -> Levels:
        """Changed copy of grey levels.

        Args:
            levels: [H, W], row 0 the highest frequency.
            row: number of the image in its data set.
            epoch: number of the epoch.
        """
        c = self.config
        rng = stream(self.seed, TRAINING, epoch, row, name="augment")
        shift, stretch, scale, offset, contrast, noise_share = rng.uniform(-1, 1, 6)
        height, width = levels.shape
        values = _resampled(
            levels,
            scale=(np.exp(c.doppler_scale * scale), np.exp(c.time_stretch * stretch)),
            shift=(c.doppler_shift * offset * height, c.time_shift * shift * width),
        )
        if rng.random() < c.morphology:
            extreme_filter = (
                ndimage.maximum_filter if rng.random() < 0.5 else ndimage.minimum_filter
            )
            values = extreme_filter(values, size=((3, 1), (1, 3), (3, 3))[rng.integers(3)])
        values = 255 - (255 - values) * (1 + c.contrast * contrast)
        # Some pixels take the level of another place: noise, whatever the levels mean.
        sources, targets = rng.integers(
            levels.size, size=(2, int(c.noise * abs(noise_share) * levels.size))
        )
        flat = values.reshape(-1)
        flat[targets] = flat[sources]
        for axis, count in enumerate((c.doppler_bands, c.time_bands)):
            for _ in range(rng.integers(count + 1)):
                size = int(rng.uniform(0, c.band_width) * values.shape[axis])
                first = rng.integers(values.shape[axis] - size + 1)
                values[(slice(None),) * axis + (slice(first, first + size),)] = 0
        augmented: Levels = np.clip(values + 0.5, 0, 255).astype(np.uint8)
        return augmented


def _resampled(levels: Levels, scale: tuple[float, float], shift: tuple[float, float]) -> Float:
    """Levels [H, W] scaled about the centre, then shifted (px); level 0 comes in from outside."""
    factors = np.array(scale)
    centre = (np.array(levels.shape) - 1) / 2
    offset = centre - (centre + np.array(shift)) / factors
    values = levels.astype(np.float32)
    return np.asarray(ndimage.affine_transform(values, 1 / factors, offset, order=1))
