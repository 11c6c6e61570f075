"""Several sets of images as one."""

from collections import Counter
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from radhar_cli.arrays import Float, Index
from radhar_cli.errors import FolderError
from radhar_cli.learning.images.colours import in_colours
from radhar_cli.learning.images.image_set import Chosen, ImageSet


def joined(sets: Sequence[ImageSet]) -> ImageSet:
    """One set of all images, classes matched by name, colours brought to those of the first set.

    Raises:
        FolderError: they differ in map, kind, size or joints. A tree of images that does not say
            which map it shows goes with any.
    """
    if len(sets) == 1:
        return sets[0]
    _refuse_unlike(sets)
    colours = next((one.colours for one in sets if one.colours is not None), None)
    sets = [in_colours(one, colours) for one in sets]
    several = any(one.everybody for one in sets)
    classes = tuple(dict.fromkeys(name for one in sets for name in one.classes))
    numbers = [np.array([classes.index(name) for name in one.classes]) for one in sets]
    source = np.repeat(np.arange(len(sets)), [len(one) for one in sets])
    rows = np.concatenate([np.arange(len(one)) for one in sets])
    scenes = [one.scenes or ("",) * len(one) for one in sets]
    left_out = Counter[str]()
    for one in sets:
        left_out.update(one.left_out)
    return replace(
        sets[0],
        where=Path(" and ".join(str(one.where) for one in sets)),
        map=next((one.map for one in sets if one.map is not None), None),
        colours=colours,
        notes=tuple(dict.fromkeys(note for one in sets for note in one.notes)),
        classes=classes,
        label=np.concatenate([n[one.label] for n, one in zip(numbers, sets, strict=True)]),
        split=np.concatenate([one.split for one in sets if one.split is not None]),
        names=tuple(name for one in sets for name in one.names),
        scenes=tuple(scene for each in scenes for scene in each),
        pixels=Chosen(tuple(one.pixels for one in sets), source, rows),
        snr_db=sets[0].snr_db if len({one.snr_db for one in sets}) == 1 else None,
        left_out=dict(left_out),
        source=source,
        persons=None,
        everybody=tuple(names for one in sets for names in one.done) if several else None,
    )


def _refuse_unlike(sets: Sequence[ImageSet]) -> None:
    """Refuse sets that no network can read as one."""
    first = sets[0]
    named = next((one for one in sets if one.map is not None), first)
    for one in sets:
        if one.kind != first.kind:
            raise FolderError(
                f"{one.where}: has {one.kind}, {first.where} {first.kind}; should be of one kind"
            )
        if one.map not in (None, named.map):
            raise FolderError(
                f"{one.where}: its map is {one.map}, that of {named.where} {named.map}; --map "
                "should name one that all data sets have"
            )
        if (one.size, one.channels) != (first.size, first.channels):
            cure = "; --set frames=N makes sequences of one length" if first.frames > 1 else ""
            raise FolderError(
                f"{one.where}: images are {one.shape}, those of {first.where} {first.shape}; "
                f"should be of one size{cure}"
            )
        if one.joints != first.joints:
            raise FolderError(
                f"{one.where}: its skeletons have {len(one.joints)} joints, those of {first.where} "
                f"{len(first.joints)}; should be the same"
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
