"""`radhar compare`: statistics, distances and the classifier test of two data sets."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from radhar_cli.arrays import Float, Index
from radhar_cli.progress import Progress
from radhar_cli.randomness import TRAINING, stream
from radhar_cli.two_sample.classifier_test import Tested, held_out, interval
from radhar_cli.two_sample.description import Described, Scale, describe, span
from radhar_cli.two_sample.distances import Difference, difference, uncovered
from radhar_cli.two_sample.map_statistics import STATISTICS
from radhar_cli.two_sample.sides import Side, open_sides

DIFFERENT = 0.02  # of edges, over their span
FARTHEST = 5.0  # standard deviations of a statistic


@dataclass(frozen=True)
class Options:
    """What is asked for."""

    map_name: str | None = None  # which map; the first of each if None
    # {class in one of the sets: common name, or None to leave it out}
    names: Mapping[str, str | None] | None = None
    resize: bool = False  # bring all images to the size of the measured ones
    most: int = 200  # maps of a class and side, drawn at random where there are more
    seed: int = 1  # of what is drawn
    # half the width of the line at zero Doppler, Hz or rows; None for 5 % of the largest
    zero: float | None = None
    pictures: int = 6  # in a row of a figure


@dataclass(frozen=True)
class ClassCompared:
    """One class."""

    name: str
    simulated: Described
    measured: Described
    differences: dict[str, Difference]  # {statistic: difference}, the largest first
    # the classifier test, of as many maps of either side; None where a side has fewer than two
    # persons or maps
    tested: Tested | None
    surest: Index  # rows of simulated maps, what is told from measured ones most surely first
    uncovered: Float  # [measured] how far from anything simulated each is
    far: Index  # rows of measured maps, what is least like simulated ones first
    typical: tuple[Index, Index]  # rows of simulated and of measured maps, from the middle outwards


@dataclass(frozen=True)
class Comparison:
    """Two data sets compared."""

    sides: tuple[Side, Side]  # simulated, measured
    scale: Scale
    shown: tuple[float, float]  # share of the rows, from the top, that pictures show
    classes: tuple[ClassCompared, ...]
    warnings: tuple[str, ...]  # what a reader should know
    options: Options

    def numbers(self) -> dict[str, Any]:
        """What report.json holds."""
        simulated, measured = self.sides
        tests = [one.tested for one in self.classes if one.tested is not None]
        return {
            "simulated": _about(simulated),
            "measured": _about(measured),
            "map": simulated.images.map or measured.images.map,
            "seed": self.options.seed,
            "most_per_class": self.options.most,
            "units": self.scale.units(),
            "warnings": list(self.warnings),
            "test": interval(tests) if tests else None,
            "coverage": float(np.mean(np.concatenate([c.uncovered for c in self.classes]) <= 1)),
            "classes": {one.name: self._of_class(one) for one in self.classes},
        }

    def _of_class(self, one: ClassCompared) -> dict[str, Any]:
        names = [side.images.names for side in self.sides]
        return {
            "simulated": len(one.simulated.rows),
            "measured": len(one.measured.rows),
            "test": None if one.tested is None else interval([one.tested]),
            "coverage": float(np.mean(one.uncovered <= 1)),
            "statistics": {
                name: {
                    "words": STATISTICS[name].words,
                    "unit": self.scale.unit(name),
                    **difference._asdict(),
                    "simulated": difference.simulated._asdict(),
                    "measured": difference.measured._asdict(),
                }
                for name, difference in one.differences.items()
            },
            "surest_simulated": [names[0][row] for row in one.surest[: self.options.pictures]],
            "least_covered": [names[1][row] for row in one.far[: self.options.pictures]],
        }


def _about(side: Side) -> dict[str, Any]:
    return {
        "path": str(side.where),
        "images": int(sum(rows.size for rows in side.classes.values())),
        "left_out": side.left_out,
        "masks": side.masks,
        "persons_known": side.persons,
        "dynamic_range_db": side.dynamic_range_db,
    }


def compare(simulated: Path, measured: Path, options: Options, progress: Progress) -> Comparison:
    """Compare two data sets class by class.

    Raises:
        FolderError: one cannot be read, or they do not fit each other.
        RadharError: the line at zero is too wide.
    """
    sides = open_sides(simulated, measured, options.map_name, options.names or {}, options.resize)
    scale = Scale.of(sides, options.zero)
    scale.refuse_zero(sides)
    names = [*sides[0].classes]
    drawn = {
        name: [_drawn(side, name, n, options) for n, side in enumerate(sides)] for name in names
    }
    progress.stage("measuring", sum(rows.size for both in drawn.values() for rows in both), 0)
    described: dict[str, tuple[Described, Described]] = {}
    for name, both in drawn.items():
        one, other = (describe(side, rows, scale) for side, rows in zip(sides, both, strict=True))
        described[name] = one, other
        progress.advance(one.rows.size + other.rows.size)
    shown = span([one for both in described.values() for one in both])
    classes = tuple(
        _class(name, described[name], sides, scale, shown, options.seed) for name in names
    )
    fine = described[names[0]][0].fine.shape[1]
    return Comparison(
        sides,
        scale,
        (shown.start / fine, shown.stop / fine),
        classes,
        tuple(_warnings(sides, scale, drawn, classes)),
        options,
    )


def _drawn(side: Side, name: str, number: int, options: Options) -> Index:
    rows = side.classes[name]
    if rows.size <= options.most:
        return rows
    rng = stream(options.seed, TRAINING, number, name=f"compare {name}")
    return np.sort(rng.choice(rows, options.most, replace=False))


def _class(
    name: str,
    both: tuple[Described, Described],
    sides: tuple[Side, Side],
    scale: Scale,
    shown: slice,
    seed: int,
) -> ClassCompared:
    rng = stream(seed, TRAINING, name=f"compare test {name}")
    count = min(len(one.rows) for one in both)
    some = [np.sort(rng.permutation(len(one.rows))[:count]) for one in both]
    features = [one.features(shown) for one in both]
    truth = np.repeat([True, False], count)
    group = np.concatenate(
        [side.group[one.rows[part]] for side, one, part in zip(sides, both, some, strict=True)]
    )
    equal = np.concatenate([one[part] for one, part in zip(features, some, strict=True)])
    tested = held_out(equal, truth, group, rng)
    surest = both[0].rows[some[0]]
    if tested is not None:
        surest = surest[np.argsort(-tested.score[truth], kind="stable")]
    near = [_comparable(one, features[1], len(scale.names)) for one in features]
    open_ = uncovered(*near)
    far = both[1].rows[np.argsort(-open_, kind="stable")]
    distances = {
        key: difference(*(one.statistics[:, column] for one in both))
        for column, key in enumerate(scale.names)
    }
    order = sorted(distances, key=lambda key: -np.nan_to_num(distances[key].distance, nan=-1))
    typical = []  # from the middle outwards
    for one, here in zip(both, near, strict=True):
        away = ((here - np.median(here, axis=0)) ** 2).sum(axis=1)
        typical.append(one.rows[np.argsort(away, kind="stable")])
    return ClassCompared(
        name,
        *both,
        {key: distances[key] for key in order},
        tested,
        surest,
        open_,
        far,
        (typical[0], typical[1]),
    )


def _comparable(features: Float, measured: Float, statistics: int) -> Float:
    """Features [N, D] in the spread of the measured ones: all statistics weigh as much as pixels.

    Statistics end at 5 standard deviations; what is not known is the mean.
    """
    known = np.ma.masked_invalid(measured)
    mean, variance = known.mean(axis=0).filled(0), known.var(axis=0).filled(0)
    away = np.nan_to_num(features - mean, nan=0.0)
    sd = np.sqrt(variance[:statistics])
    numbers = np.clip(away[:, :statistics] / np.where(sd > 0, sd, 1), -FARTHEST, FARTHEST)
    pixels = away[:, statistics:] / max(np.sqrt(variance[statistics:].sum()), 1e-6)
    return np.hstack([numbers / np.sqrt(statistics), pixels])


def _warnings(
    sides: tuple[Side, Side],
    scale: Scale,
    drawn: dict[str, list[Index]],
    classes: tuple[ClassCompared, ...],
) -> list[str]:
    """What a reader should know, in words."""
    warnings = []
    for side in sides:
        if side.left_out:
            lost = ", ".join(f"{name} ({n})" for name, n in side.left_out.items())
            warnings.append(f"{side.where}: left out, as it alone has them: {lost}")
    simulated, measured = sides
    if simulated.masks != measured.masks:
        kinds = ["masks" if side.masks else "grey levels" for side in sides]
        warnings.append(
            f"{simulated.where} has {kinds[0]}, {measured.where} {kinds[1]}: a classifier can use "
            "that alone"
        )
    unknown = [side for side in sides if not side.masks and side.dynamic_range_db is None]
    warnings += [f"{side.where}: dynamic range unknown, 40 dB assumed" for side in unknown]
    spans = [side.dynamic_range_db for side in sides]
    if None not in spans and spans[0] != spans[1]:
        warnings.append(
            f"levels span {spans[0]:g} dB in {simulated.where}, {spans[1]:g} dB in "
            f"{measured.where}: should be the same"
        )
    if not scale.axes:
        without = ", ".join(str(side.where) for side in sides if side.extent is None)
        middle = "" if scale.ranges else "; zero Doppler is taken to be the middle row"
        warnings.append(f"{without}: has no axes, so all is counted in px{middle}")
    else:
        warnings += _different_axes(sides, scale, drawn)
    drawn_too = {h for one in classes for h in one.simulated.hashes if h is not None}
    same = sum(h in drawn_too for one in classes for h in one.measured.hashes)
    if same:
        every = sum(len(one.measured.hashes) for one in classes)
        warnings.append(
            f"{same} of {every} images of {measured.where} are the same, pixel by pixel, in "
            f"{simulated.where}: the sides should share none"
        )
    for one in classes:
        if one.tested is None:
            warnings.append(f"{one.name}: no test; each side should have two persons or maps")
    return warnings


def _different_axes(
    sides: tuple[Side, Side], scale: Scale, drawn: dict[str, list[Index]]
) -> list[str]:
    warnings = []
    for name, rows in drawn.items():
        edges = [
            np.median([scale.edges(side, int(row)) for row in some], axis=0)
            for side, some in zip(sides, rows, strict=True)
        ]
        left, right, bottom, top = edges[1]
        size = np.array([right - left, right - left, top - bottom, top - bottom])
        if (np.abs(edges[0] - edges[1]) > DIFFERENT * size).any():
            told = [
                f"{e[1] - e[0]:.4g} s, {e[2]:.4g} to {e[3]:.4g} {scale.units()['rows']}"
                for e in edges
            ]
            warnings.append(f"{name}: axes differ, {told[0]} simulated, {told[1]} measured")
    return warnings
