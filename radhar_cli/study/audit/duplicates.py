"""Images that are the same, or nearly, across splits and classes; persons across splits.

B. Barz and J. Denzler, "Do we train on test data? Purging CIFAR of near-duplicates", J. Imaging 6,
2020, found 3 and 10 % of two test sets among the images that are trained on.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from scipy.spatial import KDTree

from radhar_cli.numerics.arrays import Float, Index, Levels

NEAR = 1.5  # root mean square of the difference of two thumbnails, levels
RELATIVE = 0.05  # and at most so much of the spread of their levels
COARSE = 4  # rows and columns in which near images are looked for first
NEIGHBOURS = 6  # of each image that are compared
SHOWN = 20  # pairs in a report


@dataclass(frozen=True)
class Pairs:
    """Pairs of images that are alike."""

    count: int  # of images that have a twin
    across_splits: int  # of them, with a twin in another split
    across_classes: int  # of them, with a twin of another class
    examples: tuple[tuple[str, str], ...] = ()  # names of some

    @classmethod
    def of(cls, pairs: Index, label: Index, split: Levels | None, names: Sequence[str]) -> "Pairs":
        """Count pairs [P, 2] of rows, those across splits and classes first among the examples."""
        if not len(pairs):
            return cls(0, 0, 0)
        one_class = label[pairs[:, 0]] == label[pairs[:, 1]]
        one_split = np.ones(len(pairs), bool)
        if split is not None:
            one_split = split[pairs[:, 0]] == split[pairs[:, 1]]
        order = np.lexsort((one_split, one_class))
        return cls(
            np.unique(pairs).size,
            np.unique(pairs[~one_split]).size,
            np.unique(pairs[~one_class]).size,
            tuple((names[a], names[b]) for a, b in pairs[order[:SHOWN]].tolist()),
        )


@dataclass(frozen=True)
class Overlaps:
    """Images that several splits have in common, and images that are twice in a data set."""

    identical: Pairs
    near: Pairs  # nearly alike, the identical ones left out
    # {person, recording or scene: how many of these are in several splits}; None where not known
    across_splits: dict[str, int | None] = field(default_factory=dict)

    @property
    def sentences(self) -> list[str]:
        """Warnings of twins and of splits, in sentences; empty without any."""
        lines = []
        for pairs, how in ((self.identical, "identical"), (self.near, "nearly identical")):
            if pairs.count:
                lines.append(
                    f"{pairs.count} images have a twin that is {how}: {pairs.across_splits} in "
                    f"another split, {pairs.across_classes} of another class"
                )
        for kind, count in self.across_splits.items():
            if count:
                lines.append(f"{count} {kind}s are in several splits: split by {kind}")
        return lines


def identical_pairs(digests: Sequence[str]) -> Index:
    """Pairs [P, 2] of rows of one digest: each with the first of them, and with the one before."""
    first, before, pairs = dict[str, int](), dict[str, int](), set[tuple[int, int]]()
    for row, digest in enumerate(digests):
        if digest in first:
            pairs |= {(first[digest], row), (before[digest], row)}
        first.setdefault(digest, row)
        before[digest] = row
    return np.array(sorted(pairs), np.intp).reshape(-1, 2)


def near_pairs(thumbnails: Levels, digests: Sequence[str]) -> Index:
    """Pairs [P, 2] of rows whose thumbnails [N, side, side] hardly differ, though digests do.

    The mean over a coarse cell differs by no more than its pixels do in root mean square, so that
    a search among coarse images loses no pair; each image is compared with its nearest few.
    """
    count, side = len(thumbnails), thumbnails.shape[1]
    if count < 2:
        return np.zeros((0, 2), np.intp)
    cell = side // COARSE
    coarse = thumbnails.reshape(count, COARSE, cell, COARSE, cell).mean(axis=(2, 4))
    tree = KDTree(coarse.reshape(count, -1))
    neighbours = min(NEIGHBOURS + 1, count)
    _, nearest_rows = tree.query(
        coarse.reshape(count, -1), neighbours, distance_upper_bound=NEAR * COARSE, workers=1
    )
    nearest = np.asarray(nearest_rows).reshape(count, neighbours).tolist()
    pairs = [
        (row, other)
        for row in range(count)
        for other in nearest[row]
        if row < other < count
        and digests[row] != digests[other]
        and _is_near(thumbnails[row], thumbnails[other])
    ]
    return np.array(pairs, np.intp).reshape(-1, 2)


def _is_near(image: Levels, other: Levels) -> bool:
    """Whether two thumbnails hardly differ, relative to the spread of their levels, too."""
    difference: Float = image.astype(float) - other
    root = float(np.sqrt(np.mean(difference**2)))
    return root <= min(NEAR, RELATIVE * float(min(image.std(), other.std())))


def count_across_splits(names: Sequence[object] | None, split: Levels | None) -> int | None:
    """Number of names that occur in several splits; None where names or splits are not known."""
    if names is None or split is None:
        return None
    splits = dict[object, set[int]]()
    for name, number in zip(names, split.tolist(), strict=True):
        splits.setdefault(name, set()).add(number)
    return sum(len(numbers) > 1 for numbers in splits.values())
