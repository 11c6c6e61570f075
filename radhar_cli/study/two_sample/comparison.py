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

from radhar_cli.learning.images.sequences import CLOUDS
from radhar_cli.learning.intervals import wilson
from radhar_cli.numerics.arrays import Bool, Float, Index
from radhar_cli.numerics.randomness import TRAINING, stream
from radhar_cli.processes.progress import Progress
from radhar_cli.study.two_sample.cloud_statistics import (
    CHAMFER,
    centred_places,
    chamfer_distances,
    cloud_statistics,
)
from radhar_cli.study.two_sample.cloud_statistics import STATISTICS as CLOUD_STATISTICS
from radhar_cli.study.two_sample.map_statistics import (
    STATISTICS,
    DopplerMap,
    mask_statistics,
    power_statistics,
)
from radhar_cli.study.two_sample.sides import ASSUMED_DB, Pair, Side, open_sides

ALL_STATISTICS = STATISTICS | CLOUD_STATISTICS
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
    """Comparison of a number between two samples."""

    simulated: Spread
    measured: Spread
    # Wasserstein distance (mean distance of the quantiles) over the root of the mean of both
    # variances, or over the standard deviation of all values where these are 0
    distance: float
    p: float  # of the test of Kolmogorov and Smirnov, where both were drawn from one distribution


@dataclass(frozen=True)
class ClassComparison:
    """Comparison of the maps of one class."""

    name: str
    rows: tuple[Index, Index]  # drawn maps, as many simulated as measured
    differences: dict[str, Difference]  # {statistic: difference}, the largest first
    # (correct predictions, maps) of the classifier; None where a side has fewer than two persons or
    # maps
    tested: tuple[int, int] | None


@dataclass(frozen=True)
class Comparison:
    """Comparison of two data sets, class by class."""

    pair: Pair
    classes: tuple[ClassComparison, ...]
    warnings: tuple[str, ...]  # differences that a reader should know

    def unit(self, statistic: str) -> str:
        """Unit of a statistic, in the axes of these maps."""
        unit = ALL_STATISTICS[statistic].unit
        return self.pair.units.get(unit, unit)

    def numbers(self) -> dict[str, Any]:
        """Plain numbers by their keys in report.json."""
        simulated, measured = (side.images for side in self.pair.sides)
        tests = [
            class_comparison.tested
            for class_comparison in self.classes
            if class_comparison.tested is not None
        ]
        return {
            "simulated": str(simulated.where),
            "measured": str(measured.where),
            "map": simulated.map or measured.map,
            "units": self.pair.units,
            "warnings": list(self.warnings),
            "test": interval(tests),
            "classes": {
                class_comparison.name: self._of_class(class_comparison)
                for class_comparison in self.classes
            },
        }

    def _of_class(self, comparison: ClassComparison) -> dict[str, Any]:
        return {
            "maps": comparison.rows[0].size,
            "test": interval([] if comparison.tested is None else [comparison.tested]),
            "statistics": {
                name: {
                    "words": ALL_STATISTICS[name].words,
                    "unit": self.unit(name),
                    **difference._asdict(),
                    "simulated": difference.simulated._asdict(),
                    "measured": difference.measured._asdict(),
                }
                for name, difference in comparison.differences.items()
            },
        }


def compare(
    simulated: Path,
    measured: Path,
    progress: Progress,
    map_name: str | None = None,
    names: Mapping[str, str | None] | None = None,
    max_maps: int = 200,
    seed: int = 1,
) -> Comparison:
    """Compare two data sets class by class.

    Args:
        simulated: data set, or tree of images.
        measured: data set, or tree of images.
        progress: receives the number of maps done.
        map_name: map that is compared; None is the first of each.
        names: {class in one of the sets: common name, or None to leave it out}.
        max_maps: largest number of maps of a class and side; where there are more, or the other
            side has fewer, they are drawn at random.
        seed: seed of the draws and of the classifier's folds.

    Raises:
        FolderError: data that cannot be used, of other maps, or without a common class.
    """
    pair = open_sides(simulated, measured, map_name, names or {})
    class_rows = {name: _draw_rows(pair, name, max_maps, seed) for name in pair.sides[0].classes}
    progress.stage(
        "measuring", 2 * sum(simulated_rows.size for simulated_rows, _ in class_rows.values()), 0
    )
    classes = []
    for name, rows in class_rows.items():
        classes.append(_compare_class(name, rows, pair, seed))
        progress.advance(2 * rows[0].size)
    return Comparison(pair, tuple(classes), tuple(_warnings(pair, classes)))


def _draw_rows(pair: Pair, name: str, max_maps: int, seed: int) -> tuple[Index, Index]:
    """Rows of a class, drawn at random, as many of either side."""
    rows = [side.classes[name] for side in pair.sides]
    count = min(max_maps, *(side_rows.size for side_rows in rows))
    rng = stream(seed, TRAINING, name=f"compare {name}")
    simulated, measured = (
        np.sort(rng.choice(side_rows, count, replace=False)) for side_rows in rows
    )
    return simulated, measured


def _compare_class(name: str, rows: tuple[Index, Index], pair: Pair, seed: int) -> ClassComparison:
    measure = _cloud_features if pair.clouds else _map_features
    names, features, tested_columns = measure(rows, pair, seed)
    differences = {key: difference(*features[:, :, column]) for column, key in enumerate(names)}
    order = sorted(differences, key=lambda key: -np.nan_to_num(differences[key].distance, nan=-1))
    correct = correct_predictions(
        np.concatenate(features[:, :, tested_columns]),
        np.repeat([True, False], rows[0].size),
        np.concatenate(
            [side.group[side_rows] for side, side_rows in zip(pair.sides, rows, strict=True)]
        ),
        int(stream(seed, TRAINING, name=f"compare test {name}").integers(2**31)),
    )
    tested = None if correct is None else (correct, 2 * rows[0].size)
    return ClassComparison(name, rows, {key: differences[key] for key in order}, tested)


def _map_features(
    rows: tuple[Index, Index], pair: Pair, seed: int
) -> tuple[list[str], Float, slice]:
    """Names of statistics, features [side, map, D] that begin with them, and the tested columns."""
    features = np.array(
        [
            [_features(side, row, pair) for row in side_rows]
            for side, side_rows in zip(pair.sides, rows, strict=True)
        ]
    )
    names = [key for key, statistic in STATISTICS.items() if pair.power or not statistic.of_power]
    return names, features, slice(None)


def _cloud_features(
    rows: tuple[Index, Index], pair: Pair, seed: int
) -> tuple[list[str], Float, Index]:
    """Names and values [side, sample, D] of statistics of clouds, and the columns that are tested.

    Statistics that a side never has, as the SNR of some boards, are not tested; nor is the distance
    to measured clouds, of which a measured one is set beside fewer.
    """
    rng, values, places = stream(seed, TRAINING, name="compare clouds"), [], list[list[Float]]()
    for side, side_rows in zip(pair.sides, rows, strict=True):
        assert side.clouds is not None
        products, clouds = side.clouds.data.products, list[Float]()
        statistics = []
        for row in side_rows.tolist():
            points = products[CLOUDS][row]
            statistics.append(
                [*cloud_statistics(points, products[f"{CLOUDS}_start"][row]).values()]
            )
            clouds.append(centred_places(points, rng))
        values.append(statistics)
        places.append(clouds)
    features, names = np.array(values, float), [*CLOUD_STATISTICS]
    column = names.index(CHAMFER)
    for number, clouds in enumerate(places):
        features[number, :, column] = chamfer_distances(clouds, places[1], same=number == 1)
    is_known = np.isfinite(features).any(1).all(0)
    is_known[column] = False
    return names, features, np.flatnonzero(is_known)


def _features(side: Side, row: int, pair: Pair) -> Float:
    """Features [D] of a map for the classifier: its statistics, then its image in few pixels."""
    levels = side.levels(row)
    left, right, bottom, top = pair.edges(side, row)
    height = (top - bottom) / len(levels)
    middle = top / height - 0.5  # where zero lies, in rows
    if not pair.ranges:  # on a row or between two, so that slightly other axes measure alike
        middle = round(2 * middle) / 2
    doppler = height * (middle - np.arange(len(levels)))
    largest = float(np.abs(doppler).max())
    zero = -1.0 if pair.ranges else max(ZERO * largest, 1.001 * height)  # a row on either side
    doppler_map, noise_above = DopplerMap(side.power(levels), doppler), BEYOND * largest
    is_signal = levels >= 128 if side.masks else doppler_map.signal_mask(noise_above)
    values = mask_statistics(is_signal, doppler, right - left, zero)
    if pair.power:
        values |= power_statistics(
            doppler_map, zero, noise_above, NEAR * largest, values["active"] > 0
        )
    statistics = [values[name] for name in STATISTICS if name in values]
    picture = Image.fromarray(levels.astype(np.float32) / 255)
    pixels = np.asarray(picture.resize(COARSE[::-1], Image.Resampling.BOX))
    return np.concatenate([statistics, pixels.ravel()])


def difference(simulated: Float, measured: Float) -> Difference:
    """Compare values [N] and [M]; NaN are left out.

    Distance and p are NaN where fewer than 5 values of a side are known, unless it has fewer.
    """
    x, y = (values[np.isfinite(values)] for values in (simulated, measured))
    spreads = _spread(x), _spread(y)
    if x.size < min(FEWEST, simulated.size) or y.size < min(FEWEST, measured.size):
        return Difference(*spreads, np.nan, np.nan)
    scale = float(np.hypot(spreads[0].sd, spreads[1].sd) / np.sqrt(2))
    pooled = np.concatenate([x, y])
    if scale <= ROUNDING * np.abs(pooled).max():
        scale = float(pooled.std()) or 1.0
    return Difference(*spreads, wasserstein_distance(x, y) / scale, float(ks_2samp(x, y).pvalue))


def _spread(values: Float) -> Spread:
    if not values.size:
        return Spread(np.nan, np.nan, 0)
    return Spread(float(values.mean()), float(values.std()), values.size)


def correct_predictions(features: Float, truth: Bool, group: Index, seed: int) -> int | None:
    """Number of samples whose kind is predicted correctly by a classifier that learned from others.

    Args:
        features: [N, D]; what is not finite counts as the mean.
        truth: [N] kind of each sample.
        group: [N]; samples of one kind and group are held out together.
        seed: seed of the folds.

    Returns:
        Number of the N samples, None where a kind has fewer than two groups.
    """
    from sklearn.impute import SimpleImputer
    from sklearn.linear_model import LogisticRegression
    from sklearn.model_selection import StratifiedGroupKFold, cross_val_predict
    from sklearn.pipeline import make_pipeline
    from sklearn.preprocessing import StandardScaler

    count = min(FOLDS, *(np.unique(group[truth == kind]).size for kind in (True, False)))
    if count < 2:
        return None
    predicted = cross_val_predict(
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
    return int((predicted == truth).sum())


def interval(tests: Sequence[tuple[int, int]]) -> dict[str, Any] | None:
    """Accuracy of several tests together, with Wilson's interval of 95 %; None without a test.

    Samples are held out in turn, so that tests depend on each other: where nothing can be told,
    accuracy varies with 1.6 to 1.7 times the variance of as many independent ones
    (tests/two_sample). The interval is that of 1.7 times fewer.

    Args:
        tests: (correct predictions, predictions) of each.
    """
    correct, count = sum(test[0] for test in tests), sum(test[1] for test in tests)
    if not count:
        return None
    independent = round(count / SHARED)
    return {
        "images": count,
        "right": correct,
        "accuracy": correct / count,
        "accuracy_95": list(wilson(round(correct / count * independent), independent)),
    }


def _warnings(pair: Pair, classes: Sequence[ClassComparison]) -> Iterator[str]:
    """Differences of the two data sets that a reader should know, a sentence each."""
    simulated, measured = pair.sides
    simulated_path, measured_path = (side.images.where for side in pair.sides)
    for side in pair.sides:
        if side.left_out:
            left_out = ", ".join(f"{name} ({n})" for name, n in side.left_out.items())
            yield f"{side.images.where}: left out, as it alone has them: {left_out}"
        if pair.clouds:
            continue
        if not side.masks and side.dynamic_range_db is None:
            yield f"{side.images.where}: dynamic range unknown, {ASSUMED_DB:g} dB assumed"
        if side.images.size != side.size:
            sizes = ["{} x {} px".format(*size) for size in (side.images.size, side.size)]
            yield f"{side.images.where}: images of {sizes[0]} are brought to {sizes[1]}"
    for comparison in classes:
        if comparison.tested is None:
            yield f"{comparison.name}: no test; each side should have two persons or maps"
    if pair.clouds:
        if any(np.isnan(c.differences["snr"].distance) for c in classes):
            yield "the SNR is not compared, as a side does not have it"
        return
    if simulated.masks != measured.masks:
        kinds = ["masks" if side.masks else "grey levels" for side in pair.sides]
        kinds_in_words = f"{simulated_path} has {kinds[0]}, {measured_path} {kinds[1]}"
        yield f"{kinds_in_words}: a classifier can use that alone"
    spans = [side.dynamic_range_db for side in pair.sides]
    if None not in spans and spans[0] != spans[1]:
        ranges = f"{spans[0]:g} dB in {simulated_path}, {spans[1]:g} dB in {measured_path}"
        yield f"levels span {ranges}: should be alike"
    if not pair.axes:
        paths = ", ".join(str(s.images.where) for s in pair.sides if s.extent is None)
        middle = "" if pair.ranges else "; zero Doppler is taken to be the middle row"
        yield f"{paths}: has no axes, so all is counted in px{middle}"
    for comparison in classes:
        edges = [
            np.median([pair.edges(side, int(row)) for row in rows], axis=0)
            for side, rows in zip(pair.sides, comparison.rows, strict=True)
        ]
        size = np.repeat(np.diff(edges[1])[[0, 2]], 2)
        if pair.axes and (np.abs(edges[0] - edges[1]) > DIFFERENT * size).any():
            spans_in_words = [
                f"{e[1] - e[0]:.4g} s, {e[2]:.4g} to {e[3]:.4g} {pair.units['rows']}" for e in edges
            ]
            axes_in_words = f"{spans_in_words[0]} simulated, {spans_in_words[1]} measured"
            yield f"{comparison.name}: axes differ, {axes_in_words}"
