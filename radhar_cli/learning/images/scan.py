"""One pass over all pixels: digests, mean and deviation of the levels, and early errors."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from radhar_cli.arrays import Index
from radhar_cli.learning.images.image_set import ImageSet


@dataclass(frozen=True)
class Scan:
    """Digests and histogram of some images."""

    digests: tuple[str, ...]  # [rows] digest of each image's pixels
    histogram: NDArray[np.int64]  # [3, 256] how often each level occurs in each channel

    @property
    def mean(self) -> tuple[float, ...]:
        """Mean of each channel, of levels from 0 to 1."""
        return tuple(_moment(counts, 1) for counts in self.histogram)

    @property
    def sd(self) -> tuple[float, ...]:
        """Standard deviation of each channel, 1 where it is constant."""
        spread = (_moment(c, 2) - _moment(c, 1) ** 2 for c in self.histogram)
        return tuple(float(np.sqrt(s)) if s > 1e-12 else 1.0 for s in spread)


def _moment(counts: NDArray[np.int64], power: int) -> float:
    levels = np.arange(256, dtype=np.int64) ** power
    mean: float = int(counts @ levels) / (int(counts.sum()) * 255**power)
    return mean


def scan(images: ImageSet, rows: Sequence[int] | Index) -> Scan:
    """Read some images once: digests and histogram; a damaged one is found here.

    Raises:
        FolderError: an image cannot be read.
    """
    digests, histogram = [], np.zeros((3, 256), dtype=np.int64)
    for row in rows:
        rgb = images.pixels.read(int(row))
        digests.append(hashlib.blake2b(rgb.tobytes(), digest_size=8).hexdigest())
        for channel in range(3):
            histogram[channel] += np.bincount(rgb[..., channel].reshape(-1), minlength=256)
    return Scan(tuple(digests), histogram)


def content_hash(images: ImageSet, rows: Index, digests: Sequence[str] | None = None) -> str:
    """SHA-256 of what a training run depends on: classes, labels, splits, pixels (`scan`)."""
    digests = scan(images, rows).digests if digests is None else digests
    split = None if images.split is None else images.split[rows].tolist()
    text = json.dumps([images.classes, images.label[rows].tolist(), split, list(digests)])
    return hashlib.sha256(text.encode()).hexdigest()
