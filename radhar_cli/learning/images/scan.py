"""One pass over all images: digests, mean and deviation of the levels, and early errors."""

import hashlib
import json
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from radhar_cli.learning.images.image_set import ImageSet
from radhar_cli.numerics.arrays import Float, Index


@dataclass(frozen=True)
class Scan:
    """Digests and statistics of some images."""

    digests: tuple[str, ...]  # [rows] of each image's pixels
    mean: tuple[float, ...]  # of each channel, levels from 0 to 1; of all frames of a sequence
    sd: tuple[float, ...]  # standard deviation of each channel, 1 where it is constant


def scan(images: ImageSet, rows: Sequence[int] | Index) -> Scan:
    """Read some images once; a damaged one is found here.

    Numbers with a unit, as clouds have them, have no statistics.
    """
    channels = images.channels if images.is_pictures else 1
    digests, histogram = list[str](), np.zeros((channels, 256), dtype=np.int64)
    for row in rows:
        values = images.pixels.read(int(row))
        digest = hashlib.blake2b(values.tobytes(), digest_size=8)
        if images.joints:
            digest.update(images.skeletons[int(row)].tobytes())
        digests.append(digest.hexdigest())
        if values.dtype == np.uint8:
            for counts, channel in zip(histogram, values.reshape(-1, channels).T, strict=True):
                counts += np.bincount(channel, minlength=256)
    levels = np.arange(256, dtype=np.int64)
    count = np.maximum(histogram.sum(axis=1), 1)
    mean: Float = histogram @ levels / (count * 255)
    spread = np.sqrt(np.maximum(histogram @ levels**2 / (count * 255**2) - mean**2, 0))
    sd = np.where(spread > 1e-6, spread, 1.0)
    return Scan(tuple(digests), tuple(mean.tolist()), tuple(sd.tolist()))


def content_hash(images: ImageSet, rows: Index, digests: Sequence[str] | None = None) -> str:
    """SHA-256 of the data that a training run depends on: classes, labels, splits, pixels.

    Args:
        images: images of a data set.
        rows: rows of `images` that count.
        digests: [len(rows)] digests of their pixels; None has `scan` compute them.
    """
    digests = scan(images, rows).digests if digests is None else digests
    split = None if images.samples.split is None else images.samples.split[rows].tolist()
    about = [images.classes, images.samples.label[rows].tolist(), split, list(digests)]
    if images.samples.activities is not None:
        about.append([images.samples.activities[row] for row in rows])
    text = json.dumps(about)
    return hashlib.sha256(text.encode()).hexdigest()
