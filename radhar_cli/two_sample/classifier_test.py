"""The classifier two-sample test: can a small classifier tell two samples apart?

D. Lopez-Paz and M. Oquab, "Revisiting classifier two-sample tests", ICLR 2017: accuracy on what was
held out is 1/2 where both are drawn from one distribution. The classifier is logistic regression.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from radhar_cli.arrays import Bool, Float, Index
from radhar_cli.learning.metrics import wilson

FOLDS = 5
SHARED = 1.7  # times the variance of independent tests: the folds' classifiers share samples
PENALTY = 10.0  # of the squared weights, relative to the sum of losses


@dataclass(frozen=True)
class Tested:
    """What was found of some samples when they were held out."""

    truth: Bool  # [N] whether each is of the first kind
    score: Float  # [N] log-odds of that

    @property
    def right(self) -> int:
        """How many are told rightly; a score of 0 is half right."""
        sign = np.where(self.truth, 1, -1) * np.sign(self.score)
        return int((sign > 0).sum() + (sign == 0).sum() // 2)


def held_out(features: Float, truth: Bool, group: Index, rng: np.random.Generator) -> Tested | None:
    """Test every sample by a classifier that has learned from others.

    Args:
        features: [N, D]; what is not finite counts as the mean.
        truth: [N] kind of each.
        group: [N]; samples of one kind and group are held out together.

    Returns:
        None where a kind has fewer than two groups.
    """
    from sklearn.impute import SimpleImputer
    from sklearn.linear_model import LogisticRegression
    from sklearn.model_selection import StratifiedGroupKFold, cross_val_predict
    from sklearn.pipeline import make_pipeline
    from sklearn.preprocessing import StandardScaler

    count = min(FOLDS, *(np.unique(group[truth == kind]).size for kind in (True, False)))
    if count < 2:
        return None
    known = np.where(np.isfinite(features), features, np.nan)
    score = cross_val_predict(
        make_pipeline(
            SimpleImputer(keep_empty_features=True),
            StandardScaler(),
            LogisticRegression(C=1 / PENALTY, max_iter=1000),
        ),
        known,
        truth,
        groups=2 * group + truth,
        cv=StratifiedGroupKFold(count, shuffle=True, random_state=int(rng.integers(2**31))),
        method="decision_function",
    )
    return Tested(truth, np.asarray(score))


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
