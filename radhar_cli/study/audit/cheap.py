"""Leaks for `verify`: the scene number that tells the class best, without scikit-learn."""

from math import sqrt
from typing import NamedTuple

import numpy as np

from radhar_cli.config.data_set import Config
from radhar_cli.dataset.reading import Dataset
from radhar_cli.dataset.scene_fields import ONSET
from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.study.audit.held_out import SHARED
from radhar_cli.study.audit.scene_numbers import audited_numbers, varies

SOME = 0.2  # what is told beyond chance, over what chance leaves, that should be seen
BINS = 12  # of equally many samples
BEYOND = 4.0  # standard deviations of chance above which a share is none, of some fifty numbers


class NumberShare(NamedTuple):
    """Share of samples whose class one number tells, mean over classes."""

    key: str
    share: float
    chance: float


class TellingNumber(NamedTuple):
    """The scene number that tells the class best, and what could have been seen."""

    number: NumberShare | None  # None where none tells the class beyond chance
    limit: float  # share beyond which a number of all samples would have been found
    is_enough: bool  # whether there are samples enough to see that a number tells some of the class
    has_onset: bool  # whether samples say when the movement begins, which is left out


def most_telling_number(data: Dataset) -> TellingNumber | None:
    """Find the scene number, none of the movement's, that tells the class best and beyond chance.

    Each half of the samples is guessed by the most frequent class of the same twelfth of the
    numbers in the other half.

    Returns:
        The number, if any; None of recordings, which have no scene numbers.
    """
    if not isinstance(data.config, Config):
        return None
    label, best = data.label.astype(np.intp), None
    chance = 1 / np.unique(label).size
    limit = _limit(chance, label.size)
    is_enough = limit - chance < SOME * (1 - chance)
    numbers = audited_numbers(data)
    for key, values in numbers.items():
        if key == ONSET.key:  # follows from how long a movement takes; `radhar audit` lists it
            continue
        known = np.isfinite(values)
        if not varies(values) or np.unique(label[known]).size < 2:
            continue
        share, chance = binned_share(values[known], label[known])
        is_told = share > _limit(chance, int(np.count_nonzero(known)))
        if is_told and (best is None or share - chance > best.share - best.chance):
            best = NumberShare(key, share, chance)
    return TellingNumber(best, limit, is_enough, ONSET.key in numbers)


def _limit(chance: float, samples: int) -> float:
    """Share above which so many samples are told better than by chance."""
    return chance + BEYOND * sqrt(SHARED * chance * (1 - chance) / samples)


def binned_share(values: Float, label: Index) -> tuple[float, float]:
    """Share, mean over classes, that bins of a number [N] tell right, and chance."""
    classes, truth = np.unique(label, return_inverse=True)
    half = np.arange(truth.size) % 2  # samples of a class follow each other
    weights = 1 / np.bincount(truth)[truth]
    predicted = np.zeros_like(truth)
    for side in (0, 1):
        learned, held_out = half != side, half == side
        if not learned.any() or not held_out.any():
            return 0.0, 1 / classes.size
        edges = np.quantile(values[learned], np.linspace(0, 1, BINS + 1)[1:-1])
        bins = np.searchsorted(edges, values)
        cells = np.zeros((BINS, classes.size))
        np.add.at(cells, (bins[learned], truth[learned]), weights[learned])
        predicted[held_out] = cells.argmax(axis=1)[bins[held_out]]
    correct = np.bincount(truth, predicted == truth) / np.bincount(truth)
    return float(correct.mean()), 1 / classes.size
