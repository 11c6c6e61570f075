"""`radhar compare`: statistics, distances and the classifier test of two data sets.

The test is that of D. Lopez-Paz and M. Oquab, "Revisiting classifier two-sample tests", ICLR 2017:
accuracy on what was held out is 1/2 where both are drawn from one distribution. The classifier is
logistic regression.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from PIL import Image
from scipy.stats import ks_2samp, wasserstein_distance

from radhar_cli.arrays import Bool, Float, Index
from radhar_cli.learning.metrics import wilson
from radhar_cli.progress import Progress
from radhar_cli.randomness import TRAINING, stream
from radhar_cli.two_sample.map_statistics import (
    STATISTICS,
    DopplerMap,
    mask_statistics,
    power_statistics,
)
from radhar_cli.two_sample.sides import ASSUMED_DB, Pair, Side, open_sides

DIFFERENT = 0.02  # of edges, over their span
FEWEST = 5  # known values of a side, where it has as many maps
ROUNDING = 1e-9  # of the largest value: a standard deviation below is none
ZERO, BEYOND, NEAR = 0.05, 0.867, 0.025  # of the largest Doppler
COARSE = (32, 16)  # rows and columns of the image that the classifier sees
FOLDS = 5
SHARED = 1.7  # times the variance of independent tests: the folds' classifiers share samples
PENALTY = 10.0  # of the squared weights, relative to the sum of losses


class Spread(NamedTuple):
    """Mean and standard deviation of some numbers, NaN of none, and how many there are."""

    mean: float
    sd: float
    known: int


class Difference(NamedTuple):
    """Two samples of a number."""

    simulated: Spread
    measured: Spread
    # Wasserstein distance (the mean of how far quantiles are apart) over the root of the mean of
    # both variances; of all together where these are 0
    distance: float
    p: float  # of the test of Kolmogorov and Smirnov, where both were drawn from one distribution


@dataclass(frozen=True)
class ClassComparison:
    """One class."""

    name: str
    rows: tuple[Index, Index]  # of as many simulated and measured maps, drawn
    differences: dict[str, Difference]  # {statistic: difference}, the largest first
    # how many of how many maps are told rightly; None where a side has fewer than two persons or
    # maps
    tested: tuple[int, int] | None


@dataclass(frozen=True)
class Comparison:
    """Two data sets compared."""

    pair: Pair
    classes: tuple[ClassComparison, ...]
    warnings: tuple[str, ...]  # what a reader should know

    def unit(self, statistic: str) -> str:
        """Unit of a statistic."""
        unit = STATISTICS[statistic].unit
        return self.pair.units.get(unit, unit)

    def numbers(self) -> dict[str, Any]:
        """What report.json holds."""
        simulated, measured = (side.images for side in self.pair.sides)
        tests = [one.tested for one in self.classes if one.tested is not None]
        return {
            "simulated": str(simulated.where),
            "measured": str(measured.where),
            "map": simulated.map or measured.map,
            "units": self.pair.units,
            "warnings": list(self.warnings),
            "test": interval(tests),
            "classes": {one.name: self._of_class(one) for one in self.classes},
        }

    def _of_class(self, one: ClassComparison) -> dict[str, Any]:
        return {
            "maps": one.rows[0].size,
            "test": interval([] if one.tested is None else [one.tested]),
            "statistics": {
                name: {
                    "words": STATISTICS[name].words,
                    "unit": self.unit(name),
                    **difference._asdict(),
                    "simulated": difference.simulated._asdict(),
                    "measured": difference.measured._asdict(),
                }
                for name, difference in one.differences.items()
            },
        }


def compare(
    simulated: Path,
    measured: Path,
    progress: Progress,
    map_name: str | None = None,
    names: Mapping[str, str | None] | None = None,
    most: int = 200,
    seed: int = 1,
) -> Comparison:
    """Compare two data sets class by class.

    Args:
        map_name: which map; the first of each if None.
        names: {class in one of the sets: common name, or None to leave it out}.
        most: maps of a class and side; where there are more, or the other side has fewer, they
            are drawn at random.
    """
    pair = open_sides(simulated, measured, map_name, names or {})
    drawn = {name: _draw_rows(pair, name, most, seed) for name in pair.sides[0].classes}
    progress.stage("measuring", 2 * sum(one.size for one, _ in drawn.values()), 0)
    classes = []
    for name, rows in drawn.items():
        classes.append(_compare_class(name, rows, pair, seed))
        progress.advance(2 * rows[0].size)
    return Comparison(pair, tuple(classes), tuple(_warnings(pair, classes)))


def _draw_rows(pair: Pair, name: str, most: int, seed: int) -> tuple[Index, Index]:
    """Rows of a class, as many of either side."""
    rows = [side.classes[name] for side in pair.sides]
    count = min(most, *(some.size for some in rows))
    rng = stream(seed, TRAINING, name=f"compare {name}")
    first, second = (np.sort(rng.choice(some, count, replace=False)) for some in rows)
    return first, second


def _compare_class(name: str, rows: tuple[Index, Index], pair: Pair, seed: int) -> ClassComparison:
    both = list(zip(pair.sides, rows, strict=True))
    features = np.array([[_features(side, row, pair) for row in some] for side, some in both])
    names = [key for key, one in STATISTICS.items() if pair.power or not one.of_power]
    found = {key: difference(*features[:, :, column]) for column, key in enumerate(names)}
    order = sorted(found, key=lambda key: -np.nan_to_num(found[key].distance, nan=-1))
    right = correct_predictions(
        np.concatenate(features),
        np.repeat([True, False], rows[0].size),
        np.concatenate([side.group[some] for side, some in both]),
        int(stream(seed, TRAINING, name=f"compare test {name}").integers(2**31)),
    )
    tested = None if right is None else (right, 2 * rows[0].size)
    return ClassComparison(name, rows, {key: found[key] for key in order}, tested)


def _features(side: Side, row: int, pair: Pair) -> Float:
    """Statistics of a map, then its image in few pixels."""
    levels = side.levels(row)
    left, right, bottom, top = pair.edges(side, row)
    height = (top - bottom) / len(levels)
    middle = top / height - 0.5  # where zero lies, in rows
    if not pair.ranges:  # on a row or between two, so that slightly other axes measure alike
        middle = round(2 * middle) / 2
    doppler = height * (middle - np.arange(len(levels)))
    largest = float(np.abs(doppler).max())
    zero = -1.0 if pair.ranges else max(ZERO * largest, 1.001 * height)  # a row on either side
    one, beyond = DopplerMap(side.power(levels), doppler), BEYOND * largest
    occupied = levels >= 128 if side.masks else one.occupied(beyond)
    values = mask_statistics(occupied, doppler, right - left, zero)
    if pair.power:
        values |= power_statistics(one, zero, beyond, NEAR * largest, values["active"] > 0)
    statistics = [values[name] for name in STATISTICS if name in values]
    picture = Image.fromarray(levels.astype(np.float32) / 255)
    few = np.asarray(picture.resize(COARSE[::-1], Image.Resampling.BOX))
    return np.concatenate([statistics, few.ravel()])


def difference(simulated: Float, measured: Float) -> Difference:
    """Compare values [N] and [M]; NaN are left out, and all is NaN where fewer than 5 are left."""
    x, y = (values[np.isfinite(values)] for values in (simulated, measured))
    spreads = _spread(x), _spread(y)
    if x.size < min(FEWEST, simulated.size) or y.size < min(FEWEST, measured.size):
        return Difference(*spreads, np.nan, np.nan)
    scale = float(np.hypot(spreads[0].sd, spreads[1].sd) / np.sqrt(2))
    every = np.concatenate([x, y])
    if scale <= ROUNDING * np.abs(every).max():
        scale = float(every.std()) or 1.0
    return Difference(*spreads, wasserstein_distance(x, y) / scale, float(ks_2samp(x, y).pvalue))


def _spread(values: Float) -> Spread:
    if not values.size:
        return Spread(np.nan, np.nan, 0)
    return Spread(float(values.mean()), float(values.std()), values.size)


def correct_predictions(features: Float, truth: Bool, group: Index, seed: int) -> int | None:
    """How many samples a classifier that has learned from others tells rightly.

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
    found = cross_val_predict(
        make_pipeline(
            SimpleImputer(keep_empty_features=True),
            StandardScaler(),
            LogisticRegression(C=1 / PENALTY, max_iter=1000),
        ),
        np.where(np.isfinite(features), features, np.nan),
        truth,
        groups=2 * group + truth,
        cv=StratifiedGroupKFold(count, shuffle=True, random_state=seed),
    )
    return int((found == truth).sum())


def interval(tests: Sequence[tuple[int, int]]) -> dict[str, Any] | None:
    """Accuracy of some tests (right, of how many) together, with Wilson's interval of 95 %.

    Samples are held out in turn, so that tests depend on each other: where nothing can be told,
    accuracy varies with 1.6 to 1.7 times the variance of as many independent ones
    (tests/two_sample). The interval is that of 1.7 times fewer.
    """
    right, count = sum(one[0] for one in tests), sum(one[1] for one in tests)
    if not count:
        return None
    independent = round(count / SHARED)
    return {
        "images": count,
        "right": right,
        "accuracy": right / count,
        "accuracy_95": list(wilson(round(right / count * independent), independent)),
    }


def _warnings(pair: Pair, classes: Sequence[ClassComparison]) -> Iterator[str]:
    """What a reader should know, in words."""
    simulated, measured = pair.sides
    here, there = (side.images.where for side in pair.sides)
    for side in pair.sides:
        if side.left_out:
            lost = ", ".join(f"{name} ({n})" for name, n in side.left_out.items())
            yield f"{side.images.where}: left out, as it alone has them: {lost}"
        if not side.masks and side.dynamic_range_db is None:
            yield f"{side.images.where}: dynamic range unknown, {ASSUMED_DB:g} dB assumed"
        if side.images.size != side.size:
            sizes = ["{} x {} px".format(*size) for size in (side.images.size, side.size)]
            yield f"{side.images.where}: images of {sizes[0]} are brought to {sizes[1]}"
    if simulated.masks != measured.masks:
        kinds = ["masks" if side.masks else "grey levels" for side in pair.sides]
        yield f"{here} has {kinds[0]}, {there} {kinds[1]}: a classifier can use that alone"
    spans = [side.dynamic_range_db for side in pair.sides]
    if None not in spans and spans[0] != spans[1]:
        yield f"levels span {spans[0]:g} dB in {here}, {spans[1]:g} dB in {there}: should be alike"
    if not pair.axes:
        without = ", ".join(str(s.images.where) for s in pair.sides if s.extent is None)
        middle = "" if pair.ranges else "; zero Doppler is taken to be the middle row"
        yield f"{without}: has no axes, so all is counted in px{middle}"
    for one in classes:
        edges = [
            np.median([pair.edges(side, int(row)) for row in some], axis=0)
            for side, some in zip(pair.sides, one.rows, strict=True)
        ]
        size = np.repeat(np.diff(edges[1])[[0, 2]], 2)
        if pair.axes and (np.abs(edges[0] - edges[1]) > DIFFERENT * size).any():
            told = [
                f"{e[1] - e[0]:.4g} s, {e[2]:.4g} to {e[3]:.4g} {pair.units['rows']}" for e in edges
            ]
            yield f"{one.name}: axes differ, {told[0]} simulated, {told[1]} measured"
        if one.tested is None:
            yield f"{one.name}: no test; each side should have two persons or maps"
