"""Share of held-out samples whose class a small forest tells, and the share by chance.

A number or a part of an image that has nothing to do with the movement should not tell the class: a
network finds such shortcuts first (R. Geirhos et al., "Shortcut learning in deep neural networks",
Nature Machine Intelligence 2, 2020). What a classifier gets from that part alone shows them, as
A. Torralba and A. A. Efros, "Unbiased look at dataset bias", CVPR 2011, named the data set of an
image, and G. Maguolo and L. Nanni, "A critic evaluation of methods for COVID-19 automatic detection
from X-ray images", Information Fusion 76, 2021, the diagnosis in images whose lungs were blacked
out.

The classifier is a random forest (L. Breiman, "Random forests", Machine Learning 45, 2001): it
needs no scaling and no choice of parameters, finds steps and islands as well as slopes, and takes
missing numbers as they are. Persons are held out whole, as S. Saeb et al., "The need to approximate
the use-case in clinical machine learning", GigaScience 6, 2017, ask: else a person's habits tell
the class. The share is the mean over classes of the share that is told right, so that chance is 1
over the number of classes, however many samples each has.
"""

from dataclasses import dataclass
from math import sqrt
from typing import NamedTuple

import numpy as np

from radhar_cli.learning.intervals import share_interval
from radhar_cli.numerics.arrays import Bool, Float, Index
from radhar_cli.numerics.randomness import TRAINING, stream
from radhar_cli.study.audit.marks import marked_places

# Times the variance of independent tests: folds share the samples that their forests learn from.
# So much was measured for logistic regression (tests/two_sample); forests need less.
SHARED = 1.7
MARKS = 32  # places, the surest of those that are marked
FEW_OF_A_CLASS = 20  # persons or recordings of one class each, of which few say little
LEAF = 3  # samples of a leaf, where classes have enough


@dataclass(frozen=True)
class Effort:
    """Amount of work of an audit.

    Attributes:
        trees: number of trees of a forest; a third of them where there is a single number.
        folds: largest number of parts of which each is held out once.
        permutations: number of permutations of the labels.
        seed: seed of folds, forests, permutations and of the draw of samples.
    """

    trees: int = 60
    folds: int = 5
    permutations: int = 1000
    seed: int = 1


class ClassShare(NamedTuple):
    """Share of held-out samples whose class is told, mean over classes."""

    share: float
    low: float  # of 95 %
    high: float
    chance: float  # 1 over the number of classes
    p: float  # of so large a share where labels are permuted
    accuracy: float  # share of all samples that is told right
    majority: float  # share of the most frequent class
    classes: int
    samples: int
    groups: int  # persons, recordings or samples that were held out whole
    # Whether each person or recording has several samples of one class, and few have each class:
    # what tells them apart tells their classes, in those held out, too, now and then.
    is_confounded: bool


def class_share(
    features: Float,
    label: Index,
    group: Index,
    effort: Effort,
    name: str,
    ranks: Float | None = None,
) -> ClassShare | None:
    """Measure how often the class is told from features alone.

    Args:
        features: [N, D]; NaN is missing, which a forest may use, too.
        label: [N] number of the class.
        group: [N] number of the person, recording or sample; those of a number are held out
            together.
        effort: size of the forest, number of folds and permutations, seed.
        name: name of the features, of which random streams are named.
        ranks: [N, D/2] of places of images (`marks`), by which the marked ones are chosen: features
            are differences of all places, then levels. None takes all features.

    Returns:
        The share; None where fewer than two classes have two groups each.
    """
    rows = _rows_of_classes_with_groups(label, group)
    if not rows.size:
        return None
    classes, truth = np.unique(label[rows], return_inverse=True)
    groups = np.unique(group[rows], return_inverse=True)[1]
    seed = int(stream(effort.seed, TRAINING, name=f"audit {name}").integers(2**31))
    predicted = _predict_held_out(
        _scaled(features[rows]), None if ranks is None else ranks[rows], truth, groups, effort, seed
    )
    correct = predicted == truth
    share = _mean_over_classes(correct, truth)
    low, high = share_interval(correct.astype(float), groups, truth, SHARED, seed)
    counts = np.bincount(truth)
    return ClassShare(
        share=share,
        low=low,
        high=high,
        chance=1 / classes.size,
        p=_p_value(predicted, truth, groups, effort.permutations, seed),
        accuracy=float(correct.mean()),
        majority=float(counts.max() / counts.sum()),
        classes=classes.size,
        samples=rows.size,
        groups=int(groups.max()) + 1,
        is_confounded=_is_confounded(truth, groups),
    )


def _is_confounded(truth: Index, groups: Index) -> bool:
    """Whether groups of several samples have one class each, and few have each class."""
    pairs = np.unique(np.stack([truth, groups]), axis=1)
    count = int(groups.max()) + 1
    is_pure = pairs.shape[1] == count
    return is_pure and count < truth.size and int(np.bincount(pairs[0]).min()) < FEW_OF_A_CLASS


def _rows_of_classes_with_groups(label: Index, group: Index) -> Index:
    """Rows of the classes that have two groups or more; none where there are not two such."""
    pairs = np.unique(np.stack([label, group]), axis=1)[0]
    numbers, counts = np.unique(pairs, return_counts=True)
    usable = numbers[counts >= 2]
    if usable.size < 2:
        return np.zeros(0, np.intp)
    return np.flatnonzero(np.isin(label, usable))


def _scaled(features: Float) -> Float:
    """Features [N, D] brought to -1 to 1, so that single precision tells them apart; NaN stays.

    What lies beyond 100 times the spread of most values is cut off there.
    """
    scaled = np.full(features.shape, np.nan)
    for column, values in enumerate(np.clip(features, -1e30, 1e30).T):
        known = ~np.isnan(values)
        if not known.any():
            continue
        low, middle, high = np.quantile(values[known], [0.05, 0.5, 0.95])
        centred = values[known] - middle
        if high > low:
            centred = np.clip(centred, -100 * (high - low), 100 * (high - low))
        scaled[known, column] = centred / (np.abs(centred).max() or 1.0)
    return scaled


def _predict_held_out(
    features: Float,
    ranks: Float | None,
    truth: Index,
    groups: Index,
    effort: Effort,
    seed: int,
) -> Index:
    """Predict the class [N] of each sample by a forest that learned from other groups.

    Of places with ranks it learns from those alone that are marked in the samples it learns from.
    """
    from sklearn.ensemble import RandomForestClassifier
    from sklearn.model_selection import StratifiedGroupKFold, StratifiedKFold

    pairs = np.unique(np.stack([truth, groups]), axis=1)[0]
    fewest = int(np.bincount(pairs).min())
    folds = min(effort.folds, fewest)
    if groups.max() + 1 == truth.size:  # each is a group of its own
        cut = StratifiedKFold(folds, shuffle=True, random_state=seed)
        parts = cut.split(features, truth)
    else:
        cut = StratifiedGroupKFold(folds, shuffle=True, random_state=seed)
        parts = cut.split(features, truth, groups)
    leaf = max(1, min(LEAF, int(np.bincount(truth).min()) // 4))
    trees = effort.trees if features.shape[1] > 1 else -(-effort.trees // 3)
    predicted = np.zeros(truth.size, np.intp)
    for learned, held_out in parts:
        forest = RandomForestClassifier(
            trees,
            min_samples_leaf=leaf,
            class_weight="balanced",
            random_state=seed,
            n_jobs=1,  # the same votes whatever the machine
        )
        if np.unique(truth[learned]).size < 2:
            predicted[held_out] = truth[learned][0]
            continue
        columns = np.arange(features.shape[1])
        if ranks is not None:
            marked = marked_places(ranks[learned], truth[learned])[:MARKS]
            columns = np.concatenate([marked, marked + ranks.shape[1]])
        if not columns.size:
            predicted[held_out] = truth[learned][0]
            continue
        forest.fit(features[np.ix_(learned, columns)], truth[learned])
        predicted[held_out] = forest.predict(features[np.ix_(held_out, columns)])
    return predicted


def _mean_over_classes(correct: Bool, truth: Index) -> float:
    """Mean over the classes of the share of their samples that is correct."""
    return float(np.mean(np.bincount(truth, correct) / np.bincount(truth)))


def _p_value(predicted: Index, truth: Index, groups: Index, count: int, seed: int) -> float:
    """Probability of so large a share where the labels of held-out samples are permuted.

    Labels change places within a person or recording of several classes; persons and recordings of
    one class each change theirs as a whole. Predictions stay: to fit forests anew for each
    permutation (M. Ojala and G. C. Garriga, "Permutation tests for studying classifier
    performance", JMLR 11, 2010) takes a thousand times as long. What that neglects, that folds
    share samples, is made good by a wider spread (SHARED).
    """
    rng, shares = stream(seed, TRAINING, name="permutations"), np.zeros(count)
    order = np.argsort(groups, kind="stable")
    sorted_groups, sorted_truth = groups[order], truth[order]
    starts = np.flatnonzero(np.r_[True, np.diff(sorted_groups) > 0])
    lengths = np.diff(np.r_[starts, truth.size])
    is_pure = np.minimum.reduceat(sorted_truth, starts) == np.maximum.reduceat(sorted_truth, starts)
    label_of_group, pure = sorted_truth[starts], np.flatnonzero(is_pure)
    is_pure_row = np.repeat(is_pure, lengths)
    for number in range(count):
        mixed = sorted_truth[np.lexsort((rng.random(truth.size), sorted_groups))]
        permuted_labels = label_of_group.copy()
        permuted_labels[pure] = label_of_group[rng.permutation(pure)]
        labels = np.where(is_pure_row, np.repeat(permuted_labels, lengths), mixed)
        counts = np.bincount(labels, minlength=truth.max() + 1)
        rights = np.bincount(labels, predicted[order] == labels, truth.max() + 1)
        shares[number] = np.mean(rights[counts > 0] / counts[counts > 0])
    share, middle = _mean_over_classes(predicted == truth, truth), shares.mean()
    spread = middle + sqrt(SHARED) * (shares - middle)
    return float((1 + np.count_nonzero(spread >= share - 1e-12)) / (1 + count))


def holm(values: Float) -> Float:
    """Adjust p values [N] for their number, after S. Holm, Scand. J. Statistics 6, 1979."""
    order = np.argsort(values, kind="stable")
    steps = values[order] * np.arange(values.size, 0, -1)
    adjusted = np.empty(values.size)
    adjusted[order] = np.minimum(np.maximum.accumulate(steps), 1)
    return adjusted
