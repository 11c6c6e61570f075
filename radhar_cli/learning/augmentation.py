"""Changed copies of training images, drawn anew in every epoch.

A change keeps the class: maps shift and stretch in time, scale along Doppler, lose bands, gain
noise. There is no mirror image: a mirrored Doppler-time map is another activity.
"""

from dataclasses import dataclass

import numpy as np
from scipy import ndimage

from radhar_cli.arrays import Float, Levels
from radhar_cli.learning.settings import AugmentConfig
from radhar_cli.randomness import TRAINING, stream


@dataclass(frozen=True)
class Augmentation:
    """Changes that depend on seed, epoch and row alone, whichever process makes them."""

    config: AugmentConfig  # how far the changes go
    seed: int  # of the training run

    def __call__(self, levels: Levels, row: int, epoch: int) -> Levels:
        """A changed copy of grey levels [H, W], row 0 the highest frequency."""
        c = self.config
        rng = stream(self.seed, TRAINING, epoch, row, name="augment")
        shift, stretch, scale, offset, contrast, share = rng.uniform(-1, 1, 6)
        height, width = levels.shape
        changed = _resampled(
            levels,
            scale=(np.exp(c.doppler_scale * scale), np.exp(c.time_stretch * stretch)),
            shift=(c.doppler_shift * offset * height, c.time_shift * shift * width),
        )
        if rng.random() < c.morphology:
            grow = ndimage.maximum_filter if rng.random() < 0.5 else ndimage.minimum_filter
            changed = grow(changed, size=((3, 1), (1, 3), (3, 3))[rng.integers(3)])
        changed = 255 - (255 - changed) * (1 + c.contrast * contrast)
        # Some pixels take the level of another place: noise, whatever the levels mean.
        there, here = rng.integers(levels.size, size=(2, int(c.noise * abs(share) * levels.size)))
        flat = changed.reshape(-1)
        flat[here] = flat[there]
        for axis, count in enumerate((c.doppler_bands, c.time_bands)):
            for _ in range(rng.integers(count + 1)):
                size = int(rng.uniform(0, c.band_width) * changed.shape[axis])
                first = rng.integers(changed.shape[axis] - size + 1)
                changed[(slice(None),) * axis + (slice(first, first + size),)] = 0
        new: Levels = np.clip(changed + 0.5, 0, 255).astype(np.uint8)
        return new


def _resampled(levels: Levels, scale: tuple[float, float], shift: tuple[float, float]) -> Float:
    """Levels [H, W] scaled about the centre, then shifted (px); level 0 comes in from outside."""
    change = np.array(scale)
    centre = (np.array(levels.shape) - 1) / 2
    offset = centre - (centre + np.array(shift)) / change
    single = levels.astype(np.float32)
    return np.asarray(ndimage.affine_transform(single, 1 / change, offset, order=1))
