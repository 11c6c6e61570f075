"""The classifier two-sample test: can a small classifier tell two samples apart?

D. Lopez-Paz and M. Oquab, "Revisiting classifier two-sample tests", ICLR 2017: accuracy on what was
held out is 1/2 where both are drawn from one distribution. The classifier is logistic regression.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.optimize import minimize
from scipy.special import expit

from radhar_cli.arrays import Bool, Float, Index
from radhar_cli.learning.metrics import wilson

FOLDS = 5
SHARED = 1.7  # times the variance of independent tests: the folds' classifiers share samples
PENALTY = 10.0  # of the squared weights, against the sum of losses of standardised features


@dataclass(frozen=True)
class Tested:
    """What was found of some samples when they were held out.

    Attributes:
        truth: [N] whether each is of the first kind.
        score: [N] log-odds of that.
    """

    truth: Bool
    score: Float

    @property
    def right(self) -> int:
        """How many are told rightly; a score of 0 is half right."""
        sign = np.where(self.truth, 1, -1) * np.sign(self.score)
        return int((sign > 0).sum() + (sign == 0).sum() // 2)


def held_out(features: Float, truth: Bool, group: Index, rng: np.random.Generator) -> Tested | None:
    """Test every sample by a classifier that has learned from others.

    Args:
        features: [N, D]; NaN is taken for the mean.
        truth: [N] kind of each.
        group: [N]; samples of one kind and group are held out together.
        rng: shares them out.

    Returns:
        None where a kind has fewer than two groups.
    """
    fold, count = folds(truth, group, rng)
    if count < 2:
        return None
    score = np.zeros(len(truth))
    for number in range(count):
        out = fold == number
        score[out] = Logistic.of(features[~out], truth[~out]).score(features[out])
    return Tested(truth, score)


def folds(truth: Bool, group: Index, rng: np.random.Generator) -> tuple[Index, int]:
    """Number of the fold [N] in which each sample is held out, of both kinds alike; and of folds.

    The groups of a kind go one after the other, the largest first and else in random order, to the
    fold that has the fewest samples of that kind.
    """
    kinds = [np.flatnonzero(truth == kind) for kind in (True, False)]
    count = min(FOLDS, *(np.unique(group[rows]).size for rows in kinds))
    fold = np.zeros(len(truth), np.intp)
    for rows in kinds:
        names, mine, sizes = np.unique(group[rows], return_inverse=True, return_counts=True)
        order = rng.permutation(names.size)
        filled = np.zeros(max(1, count), np.intp)
        for one in order[np.argsort(-sizes[order], kind="stable")]:
            here = int(filled.argmin())
            filled[here] += sizes[one]
            fold[rows[mine == one]] = here
    return fold, count


@dataclass(frozen=True)
class Logistic:
    """Logistic regression on standardised features, with a penalty on the squared weights.

    Attributes:
        mean, scale: [D] of what it learned from.
        weights: [D]; the last is the bias, [D + 1].
    """

    mean: Float
    scale: Float
    weights: Float

    @classmethod
    def of(cls, features: Float, truth: Bool) -> "Logistic":
        """Learn from features [N, D]."""
        known = np.isfinite(features)
        count = np.maximum(known.sum(axis=0), 1)
        clean = np.where(known, features, 0)
        mean = clean.sum(axis=0) / count
        scale = np.sqrt(np.where(known, (clean - mean) ** 2, 0).sum(axis=0) / count)
        scale[scale < 1e-9 * np.maximum(np.abs(mean), 1)] = 1
        blank = cls(mean, scale, np.zeros(features.shape[1] + 1))
        x, sign = blank.standardised(features), np.where(truth, 1.0, -1.0)

        def loss(weights: Float) -> tuple[float, Float]:
            margin = sign * (x @ weights[:-1] + weights[-1])
            slope = -sign * expit(-margin)
            penalty = PENALTY * weights[:-1]
            value = np.logaddexp(0, -margin).sum() + penalty @ weights[:-1] / 2
            return float(value), np.append(slope @ x + penalty, slope.sum())

        result = minimize(loss, blank.weights, jac=True, method="L-BFGS-B")
        return cls(mean, scale, result.x)

    def standardised(self, features: Float) -> Float:
        """Features [N, D] of mean 0 and deviation 1, 0 where they are not known."""
        return np.asarray(np.nan_to_num((features - self.mean) / self.scale, nan=0.0))

    def score(self, features: Float) -> Float:
        """Log-odds [N] of the first kind."""
        return np.asarray(self.standardised(features) @ self.weights[:-1] + self.weights[-1])


def interval(tested: Sequence[Tested]) -> dict[str, Any]:
    """Accuracy of some tests together, with Wilson's interval of 95 %.

    Samples are held out in turn, so that tests depend on each other: where nothing can be told,
    accuracy varies with 1.6 to 1.7 times the variance of as many independent ones
    (tests/two_sample). The interval is that of 1.7 times fewer.
    """
    right, count = sum(one.right for one in tested), sum(one.truth.size for one in tested)
    independent = round(count / SHARED)
    return {
        "images": count,
        "right": right,
        "accuracy": right / count,
        "accuracy_95": list(wilson(round(right / count * independent), independent)),
    }
