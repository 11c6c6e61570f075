"""Marks at fixed places of images, which tell a class by what somebody drew there or cut off.

A time stamp, an axis, a colour bar, a border or a crop differs from what is beside it, and does so
at the same place of every image of a class. A body differs from what is beside it, too, but not at
one time rather than another, as long as onsets vary. So each place is ranked by how far it stands
out among the places of its rows in the same image: without a mark every rank is as frequent,
however loud, noisy or busy the images of a class are. Where the mean ranks of classes differ there
is a mark, and the class is guessed from how bright that place is and how far it stands out.
R. Geirhos et al. (`held_out`) tell of a network that knew a hospital by a token on its X-rays.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.ndimage import correlate1d
from scipy.special import chdtrc
from scipy.stats import rankdata

from radhar_cli.numerics.arrays import Float, Index, Levels
from radhar_cli.study.audit.evidence import Evidence, EvidencePart

ROWS, COLUMNS = (1, 2, 4), (1, 2)  # widths of borders, compared with as many beside them
PEERS = 4  # part of the rows, from a side on, among which its border is ranked
# Side (first, last rows, first, last columns) and width of each border.
BORDERS = [(side, w) for side, widths in enumerate((ROWS, ROWS, COLUMNS, COLUMNS)) for w in widths]
SIDES = ("first rows", "last rows", "first columns", "last columns")
GRID = 32  # rows and columns of cells, of each of which the sharpest place counts
BESIDE = np.array([1, 1, 1, 0, 0, 0, 1, 1, 1], float)  # cells that a place is compared with
SMALLEST = 2.0  # levels of a difference that is no rounding
CHANCE = 0.005  # probability that any border without a mark is taken for one; that any place is
LEAST = 0.01  # variance of the mean ranks of classes, of 1/12 at the most, of a mark


class MarkFeatures(NamedTuple):
    """Contrasts of borders, columns and places [P] of one image to the places beside them."""

    differences: Float  # grey levels
    levels: Float  # of the place itself
    ranks: Float  # of the difference, among places that are alike without a mark, 0 to 1


def mark_features(levels: Levels) -> MarkFeatures:
    """Measure how far borders, columns and places of levels [H, W] stand out."""
    values = levels.astype(float)
    sides = (values, values[::-1], values.T, values.T[::-1])
    borders = [_border(sides[side], width) for side, width in BORDERS]
    parts = [MarkFeatures(*map(np.array, zip(*borders, strict=True)))]
    parts += [_columns(values), _places(values)]
    return MarkFeatures(*(np.concatenate(of_parts) for of_parts in zip(*parts, strict=True)))


def _border(values: Float, width: int) -> tuple[float, float, float]:
    """Measure the contrast of the first rows of values [H, W] to the next, its level and rank."""
    rows = values[: max(len(values) // PEERS, 4 * width)].mean(axis=1)
    if len(rows) < 4 * width:
        return 0.0, 0.0, 0.5
    sums = np.convolve(rows, np.full(width, 1 / width), "valid")
    differences = sums[:-width] - sums[width:]
    return float(differences[0]), float(sums[0]), float(_ranks(differences)[0])


def _columns(values: Float) -> MarkFeatures:
    """Measure the sharpest contrast of columns of values [H, W] to those beside, a cell each."""
    means = values.mean(axis=0)
    sharpest, level = _sharpest(_stands_out(means, 0), means, _starts(means.size), 0)
    return MarkFeatures(sharpest, level, _ranks(sharpest))


def _places(values: Float) -> MarkFeatures:
    """Measure the contrast of the sharpest place of each cell of values [H, W] to its neighbours.

    A place counts as far as it stands out of its row and of its column, whichever is less: a steady
    line, as a body's, does not stand out of its row.
    """
    across, along = (_stands_out(values, axis) for axis in (0, 1))
    least = np.minimum(np.abs(along), np.abs(across))
    signed = np.where(along * across > 0, np.sign(along) * least, 0)
    rows, columns = (_starts(length) for length in values.shape)
    sharpest, level = _sharpest(*_sharpest(signed, values, rows, 0), columns, 1)
    return MarkFeatures(sharpest.ravel(), level.ravel(), _ranks(sharpest).ravel())


def _stands_out(values: Float, axis: int) -> Float:
    """Subtract from each of the values the mean of those beside it along an axis."""
    count = correlate1d(np.ones(values.shape), BESIDE, axis, mode="constant")
    return values - correlate1d(values, BESIDE, axis, mode="constant") / np.maximum(count, 1)


def _sharpest(differences: Float, levels: Float, starts: Index, axis: int) -> tuple[Float, Float]:
    """The difference that is farthest from 0 in each part of an axis, and its level.

    That is the highest level of the part of one above those beside it, else the lowest.
    """
    (highest, brightest), (lowest, darkest) = (
        [extreme.reduceat(values, starts, axis) for values in (differences, levels)]
        for extreme in (np.maximum, np.minimum)
    )
    is_above = highest > -lowest
    return np.where(is_above, highest, lowest), np.where(is_above, brightest, darkest)


def _starts(length: int) -> Index:
    """First row or column of each cell."""
    return np.unique(np.arange(GRID) * length // GRID).astype(np.intp)


def _ranks(values: Float) -> Float:
    """Place of each value among those of its row, 0 to 1; equal ones are in their middle."""
    return np.asarray((rankdata(values, axis=-1) - 0.5) / values.shape[-1])


def marked_places(ranks: Float, truth: Index) -> Index:
    """Places [P] whose ranks differ from class to class, the surest first.

    Without a mark a rank has the variance 1/12 at the most, so that the variance of the means of
    classes over that is chi-squared.

    Args:
        ranks: [N, P] of each image.
        truth: [N] number of its class.
    """
    counts = np.bincount(truth)
    sums = np.zeros((counts.size, ranks.shape[1]))
    np.add.at(sums, truth, ranks - ranks.mean(axis=0))
    between = 12 * (sums**2 / np.maximum(counts, 1)[:, None]).sum(axis=0)
    freedom = int(np.count_nonzero(counts)) - 1
    is_border = np.arange(ranks.shape[1]) < len(BORDERS)
    count = np.where(is_border, len(BORDERS), ranks.shape[1])
    is_sure = chdtrc(max(freedom, 1), between) < CHANCE / count
    sure = np.flatnonzero(is_sure & (between > 12 * LEAST * len(ranks)))
    return np.asarray(sure[np.argsort(-between[sure], kind="stable")])


def mark_evidence(
    features: Sequence[MarkFeatures], truth: Index, size: tuple[int, int]
) -> Evidence:
    """Evidence of the marks of images, with the clearest place in its cure.

    A mark at a border is no movement; one within may be a body that is always there.

    Args:
        features: of each image [N].
        truth: [N] class of each.
        size: (H, W) of an image.
    """
    differences, levels, ranks = (np.stack(of_all) for of_all in zip(*features, strict=True))
    marked = marked_places(ranks, truth)
    means = [differences[truth == label][:, marked].mean(axis=0) for label in np.unique(truth)]
    order = np.argsort(-np.ptp(means, axis=0), kind="stable")  # beside a mark it is seen, too
    described = [_describe_place(int(place), size) for place in marked[order][:1]]
    return Evidence(
        EvidencePart.MARGINS,
        "marks at fixed places",
        np.concatenate([differences, levels], axis=1),
        cure=f"look at {' '.join(text for text, _ in described)} of some images of each class, and "
        "cut off or blank what is no echo",
        may_be_movement=not any(is_border for _, is_border in described),
        ranks=ranks,
    )


def _describe_place(place: int, size: tuple[int, int]) -> tuple[str, bool]:
    """Describe a place in words, and return whether it is at a border."""
    if place < len(BORDERS):
        return f"the {SIDES[BORDERS[place][0]]}", True
    rows, columns = (np.append(_starts(length), length).tolist() for length in size)
    place -= len(BORDERS)
    if place < len(columns) - 1:
        at_side = place in (0, len(columns) - 2)
        return f"columns {columns[place]} to {columns[place + 1] - 1}", at_side
    row, column = divmod(place - len(columns) + 1, len(columns) - 1)
    at_side = row in (0, len(rows) - 2) or column in (0, len(columns) - 2)
    where = f"rows {rows[row]} to {rows[row + 1] - 1}, columns {columns[column]} to "
    return f"{where}{columns[column + 1] - 1}", at_side
