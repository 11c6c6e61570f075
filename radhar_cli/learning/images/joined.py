"""Several sets of images as one."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np

from radhar_cli.arrays import Float, Index
from radhar_cli.errors import FolderError
from radhar_cli.learning.images.image_set import Chosen, ImageSet, class_order


def joined(sets: Sequence[ImageSet]) -> ImageSet:
    """One set of all images, classes matched by name."""
    if len(sets) == 1:
        return sets[0]
    for one, other in pairwise(sets):
        if (one.size, one.channels, one.joints) != (other.size, other.channels, other.joints):
            raise FolderError(
                f"{other.where}: images are {other.shape}, those of {one.where} {one.shape}; "
                "should be of one size"
            )
    several = any(one.everybody for one in sets)
    classes = class_order({name for one in sets for name in one.classes})
    numbers = [np.array([classes.index(name) for name in one.classes]) for one in sets]
    source = np.repeat(np.arange(len(sets)), [len(one) for one in sets])
    rows = np.concatenate([np.arange(len(one)) for one in sets])
    scenes = [one.scenes or ("",) * len(one) for one in sets]
    return replace(
        sets[0],
        classes=classes,
        label=np.concatenate([n[one.label] for n, one in zip(numbers, sets, strict=True)]),
        split=np.concatenate([one.split for one in sets if one.split is not None]),
        names=tuple(name for one in sets for name in one.names),
        scenes=tuple(scene for each in scenes for scene in each),
        pixels=Chosen(tuple(one.pixels for one in sets), source, rows),
        snr_db=sets[0].snr_db if len({one.snr_db for one in sets}) == 1 else None,
        left_out={name: n for one in sets for name, n in one.left_out.items()},
        source=source,
        persons=None,
        everybody=tuple(names for one in sets for names in one.done) if several else None,
    )


def sampling_weights(
    images: ImageSet, rows: Index, of_sets: Sequence[float] | None, balanced: bool
) -> Float:
    """How often an epoch shows each of these rows on average [rows].

    Args:
        of_sets: weight of every joined set; 1 each if None.
        balanced: every class as often as the others, the epoch's length unchanged.
    """
    weights = np.ones(rows.size)
    if of_sets is not None:
        weights = np.array(of_sets, dtype=float)[images.source[rows]]
    if balanced:
        label = images.label[rows]
        mass = np.bincount(label, weights, len(images.classes))
        weights = weights * (mass.sum() / np.count_nonzero(mass) / np.maximum(mass, 1e-9))[label]
    return weights
