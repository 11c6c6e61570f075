"""Intervals of shares and means of samples that vary together: persons and recordings drawn anew.

Windows of one recording overlap, and images of one person are alike, so that a hundred of them say
less than a hundred independent ones. How much less is seen where whole persons or recordings are
drawn anew (bootstrap; B. Efron and R. J. Tibshirani, "An introduction to the bootstrap", 1993). The
interval is Wilson's of as many independent samples as would vary so, fewer by Student's t where
groups are few (E. L. Korn and B. I. Graubard, "Confidence intervals for proportions with small
expected number of positive counts estimated from survey data", Survey Methodology 24, 1998).
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from statistics import NormalDist
from typing import Any

import numpy as np
from scipy.special import gammaincinv, stdtrit

from radhar_cli.numerics.arrays import Float, Index
from radhar_cli.numerics.randomness import TRAINING, stream

BOOTSTRAPS = 400
BLOCK = 100  # of them, drawn at once
FEWEST_GROUPS = 5  # persons or recordings from which on an interval is given
NORMAL = NormalDist().inv_cdf(0.975)


def wilson(correct: float, count: float) -> tuple[float, float]:
    """Wilson's interval (low, high) of 95 % of the share correct/count; (0, 1) where count is 0."""
    if count == 0:
        return 0.0, 1.0
    z2 = NORMAL**2
    share = correct / count
    middle = share + z2 / (2 * count)
    half = math.sqrt(z2 * (share * (1 - share) + z2 / (4 * count)) / count)
    low, high = ((middle + side) / (1 + z2 / count) for side in (-half, half))
    return max(0.0, min(low, share)), min(1.0, max(high, share))


@dataclass(frozen=True)
class Groups:
    """Groups of samples that vary together."""

    number: Index  # [N] of the person, recording, scene or sample
    kind: str  # which of these, in words

    @property
    def count(self) -> int:
        """Number of groups."""
        return int(np.unique(self.number).size)


def share_interval(
    right: Float, group: Index, stratum: Index | None = None, spread: float = 1.0, seed: int = 1
) -> tuple[float, float]:
    """Interval (low, high) of 95 % of a share, where samples of a group vary together.

    Args:
        right: [N] 1 of a sample that counts, 0 of another.
        group: [N] number of the person, recording or sample that is drawn anew as a whole.
        stratum: [N] class of each sample, over which the share is a mean; None is one class.
        spread: factor of the variance, where samples share more than their group.
        seed: seed of the draws.
    """
    stratum = np.zeros(right.size, np.intp) if stratum is None else stratum
    groups, number = np.unique(group, return_inverse=True)
    strata = int(stratum.max()) + 1
    independent, share = right.size / spread, _mean_over_strata(right, stratum)
    if groups.size == right.size and strata == 1:
        return wilson(share * independent, independent)
    pairs = np.unique(np.stack([number, stratum]), axis=1).shape[1]
    variance = spread * variance_over_groups(right, number, stratum, seed)
    if variance > 0:
        independent = min(independent, share * (1 - share) / variance)
    else:  # all alike: they may be so within every group, class by class
        independent = min(independent, pairs)
    independent *= _shrinkage(groups.size - (strata if pairs == groups.size else 1))
    independent = max(1.0, independent)
    return wilson(share * independent, independent)


def mean_interval(values: Float, group: Index, seed: int = 1) -> tuple[float, float]:
    """Interval (low, high) of 95 % of the mean of values [N] whose groups [N] vary together."""
    groups, number = np.unique(group, return_inverse=True)
    stratum = np.zeros(values.size, np.intp)
    variance = variance_over_groups(values, number, stratum, seed)
    half = NORMAL * float(np.sqrt(variance / _shrinkage(groups.size - 1)))
    mean = float(values.mean())
    return mean - half, mean + half


def rate_interval(
    count: Float, exposure: Float, group: Index, seed: int = 1
) -> tuple[float, float]:
    """Interval (low, high) of 95 % of a rate, where counts of a group vary together.

    It is that of F. Garwood ("Fiducial limits for the Poisson distribution", Biometrika 28, 1936)
    of as much exposure as would vary so.

    Args:
        count: [N] number of events.
        exposure: [N] such as hours, above 0 in sum.
        group: [N] number of the person or recording that is drawn anew as a whole.
        seed: seed of the draws.
    """
    groups, number = np.unique(group, return_inverse=True)
    total, rate = float(exposure.sum()), float(count.sum() / exposure.sum())
    by_group = [np.bincount(number, values) for values in (count, exposure)]
    rng = stream(seed, TRAINING, name="bootstrap")
    weights = rng.multinomial(groups.size, np.full(groups.size, 1 / groups.size), BOOTSTRAPS)
    counts, exposures = (weights @ values for values in by_group)
    rates = counts[exposures > 0] / exposures[exposures > 0]
    variance = float(np.var(rates)) * groups.size / max(1, groups.size - 1)
    if variance > 0:
        total = min(total, rate / variance)
    total *= _shrinkage(groups.size - 1)
    low = float(gammaincinv(rate * total, 0.025)) / total if rate else 0.0
    return low, float(gammaincinv(rate * total + 1, 0.975)) / total


def variance_over_groups(values: Float, number: Index, stratum: Index, seed: int) -> float:
    """Variance of the mean over strata of the means of values, where groups are drawn anew.

    Args:
        values: [N].
        number: [N] number of the group, from 0.
        stratum: [N] number of the stratum, from 0.
        seed: seed of the draws.
    """
    shape = (int(number.max()) + 1, int(stratum.max()) + 1)
    cells = number * shape[1] + stratum
    sums, counts = (
        np.bincount(cells, weights, shape[0] * shape[1]).reshape(shape)
        for weights in (values.astype(float), np.ones(values.size))
    )
    rng, means = stream(seed, TRAINING, name="bootstrap"), list[Float]()
    for _ in range(BOOTSTRAPS // BLOCK):
        weights = rng.multinomial(shape[0], np.full(shape[0], 1 / shape[0]), BLOCK)
        drawn = weights @ counts
        of_stratum = np.where(drawn > 0, weights @ sums / np.maximum(drawn, 1), np.nan)
        means.append(np.nanmean(of_stratum, axis=1))
    # Drawn from few, a mean varies less than among all by this factor.
    groups = np.maximum(np.count_nonzero(counts, axis=0), 2)
    few = float(np.mean(groups / (groups - 1)))
    return few * float(np.var(np.concatenate(means)))


def _mean_over_strata(values: Float, stratum: Index) -> float:
    """Mean over the strata [N] that occur of the means of their values [N]."""
    counts = np.bincount(stratum)
    return float(np.mean((np.bincount(stratum, values) / np.maximum(counts, 1))[counts > 0]))


def _shrinkage(freedom: int) -> float:
    """Return the factor (z / t)^2 on a number of samples whose variance is that of few groups."""
    return float((NORMAL / stdtrit(max(1, freedom), 0.975)) ** 2)


def numbers_of_share(key: str, right: Float, groups: Groups) -> dict[str, Any]:
    """Interval of a share by its keys in report.json and metrics.json; null of too few groups.

    Args:
        key: key of the share, such as accuracy.
        right: [N] 1 where right, 0 where wrong, or shares.
        groups: groups of them that vary together.
    """
    interval = None if _are_too_few(groups) else list(share_interval(right, groups.number))
    return {f"{key}_95": interval, **_over(groups)}


def numbers_of_mean(key: str, values: Float, groups: Groups) -> dict[str, Any]:
    """Interval of a mean of values [N], as `numbers_of_share` gives that of a share."""
    interval = None if _are_too_few(groups) else list(mean_interval(values, groups.number))
    return {f"{key}_95": interval, **_over(groups)}


def numbers_of_rate(key: str, count: Float, exposure: Float, groups: Groups) -> dict[str, Any]:
    """Interval of a rate of counts [N] per exposure [N], as `numbers_of_share` of a share."""
    too_few = _are_too_few(groups)
    interval = None if too_few else list(rate_interval(count, exposure, groups.number))
    return {f"{key}_95": interval, **_over(groups)}


def _over(groups: Groups) -> dict[str, Any]:
    return {"interval_over": {"kind": groups.kind, "count": groups.count}}


def _are_too_few(groups: Groups) -> bool:
    """Whether groups of several samples are too few to say how they vary."""
    return groups.count < min(FEWEST_GROUPS, groups.number.size)


def interval_in_words(interval: Sequence[float] | None, over: Mapping[str, Any]) -> str:
    """An interval of a share, 0 to 1, as `ends_in_words` says it, in per cent."""
    percent = None if interval is None else [100 * end for end in interval]
    return ends_in_words(percent, "%", over)


def ends_in_words(ends: Sequence[float] | None, unit: str, over: Mapping[str, Any]) -> str:
    """An interval in brackets, with the unit that was drawn anew unless it was single samples.

    Args:
        ends: low and high end; None of too few groups.
        unit: of both.
        over: kind and count of the groups, as in report.json.
    """
    count, kind = over["count"], over["kind"]
    groups = f"{count} {kind}{'' if count == 1 else 's'}"
    if ends is None:
        return f"(no interval: {groups} {'is' if count == 1 else 'are'} too few)"
    low, high = ends
    return f"({low:.2f} to {high:.2f} {unit}{'' if kind == 'sample' else f' over {groups}'})"
