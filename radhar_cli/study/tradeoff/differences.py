"""Differences of two settings: pictures, points, and the signals behind them."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise
from math import inf, log10
from typing import Any, NamedTuple

import numpy as np

from radhar_cli.config.radar import CwRadar, ImpulseRadar
from radhar_cli.numerics.arrays import Bool, Complex, Float, Levels
from radhar_cli.processing.points import Cloud
from radhar_cli.study.tradeoff.samples import (
    BINS,
    WORDS,
    Raw,
    Shown,
    ShownMap,
    draw_shown,
    shown_names,
)

SSIM_WINDOW = 7
MOST_TILES = 16  # frames of a board's map whose SSIM is taken
STAYS_M = 0.01  # a point that moved by less stays
LOWEST_DB, HIGHEST_DB = -140, 0  # between which the error is sought that images show
VISIBLE = 0.01  # share of the pixels that differ by more than a level, or of points that move
SEED = 48


@dataclass(frozen=True)
class MapDifference:
    """Difference of a map from another one of the same scene."""

    changed: float  # share of the pixels whose level differs
    over_one: float  # share of those that differ by more than one level
    ssim: float | None  # SSIM; None below three pixels
    rms_levels: float  # root mean square of the difference, levels


@dataclass(frozen=True)
class PointDifference:
    """Difference of the points of a board from others of the same scene."""

    moved: float  # share of the points, of both, that have no other within STAYS_M in their frame
    # median way to the nearest of those that have one in their frame; None of none
    distance_m: float | None
    per_frame: float
    base_per_frame: float  # points a frame of the other cloud


class SceneDifference(NamedTuple):
    """Differences that a setting makes to one scene."""

    error_of: str  # signal whose error is measured, in words
    # its relative error, dB; -inf of none, None where there is none to compare
    error_db: float | None
    stated_db: float | None  # error that the engine states itself
    maps: Mapping[str, MapDifference]
    points: PointDifference | None


def compare_scene(raw: Raw, visible: Shown, base_raw: Raw, base: Shown) -> SceneDifference:
    """Compare what a setting makes of a scene, and shows of it, with its base."""
    name, error_db = signal_error(raw, base_raw)
    maps = {
        key: compare_pictures(picture, base.pictures[key])
        for key, picture in visible.pictures.items()
        if key in base.pictures
    }
    points = None
    if visible.cloud is not None and base.cloud is not None:
        points = compare_points(visible.cloud, base.cloud)
    return SceneDifference(WORDS.get(name, name), error_db, raw.stated_db, maps, points)


def relative_db(compared: Complex, exact: Complex, visible: Bool | None = None) -> float | None:
    """Relative L2 error of two signals in dB.

    Args:
        compared: signal whose error it is.
        exact: signal that it should be.
        visible: mask of the samples that count; None for all.

    Returns:
        -inf where the two are the same, None where the exact one is 0 or of another shape.
    """
    if compared.shape != exact.shape:
        return None
    if visible is not None:
        compared, exact = compared[visible], exact[visible]
    size = float(np.linalg.norm(exact))
    if size == 0:
        return None
    error = float(np.linalg.norm(compared - exact)) / size
    return 20 * log10(error) if error > 0 else -inf


def signal_error(compared: Raw, exact: Raw) -> tuple[str, float | None]:
    """Error of the first raw product that maps are drawn from: its name, and dB.

    Of a gate only the bins count that frames show.
    """
    name = next(iter(exact.values))
    visible = exact.needed if name == BINS else None
    other = compared.values.get(name)
    return name, None if other is None else relative_db(other, exact.values[name], visible)


def compare_pictures(compared: ShownMap, base: ShownMap) -> MapDifference:
    """Compare two pictures of a map, on the pixels of the base that both show."""
    values, visible = base_pixels(compared, base)
    difference = np.abs(values - base.levels)[visible]
    if difference.size == 0:
        return MapDifference(1.0, 1.0, None, 255.0)
    similar = _ssim(np.rint(values).astype(np.uint8), base.levels) if visible.all() else None
    return MapDifference(
        float(np.mean(difference >= 0.5)),
        float(np.mean(difference >= 1.5)),
        similar,
        float(np.sqrt(np.mean(difference**2))),
    )


def base_pixels(compared: ShownMap, base: ShownMap) -> tuple[Float, Bool]:
    """Levels of a picture at the pixels of another one, linear in between.

    Returns:
        The levels, and which of the pixels lie within the picture.
    """
    values = compared.levels.astype(float)
    visible = np.ones(base.levels.shape, bool)
    for axis, (source, other) in enumerate(zip(compared.axes, base.axes, strict=True)):
        step = (source[-1] - source[0]) / max(source.size - 1, 1) or 1.0
        places = (other - source[0]) / step
        if source.size == other.size and np.abs(places - np.arange(source.size)).max() < 0.5:
            continue  # such as a pulse less at the end
        low = np.clip(np.floor(places), 0, max(source.size - 2, 0)).astype(np.intp)
        share = np.clip(places - low, 0, 1)
        shape = [-1 if n == axis else 1 for n in range(values.ndim)]
        high = np.minimum(low + 1, source.size - 1)
        share = share.reshape(shape)
        values = values.take(low, axis) * (1 - share) + values.take(high, axis) * share
        visible &= ((places >= -0.5) & (places <= source.size - 0.5)).reshape(shape)
    return values, visible


def _ssim(compared: Levels, base: Levels) -> float | None:
    """SSIM of two pictures; frames of a board's map stand one above the other."""
    import skimage.metrics

    metrics: Any = skimage.metrics
    if base.ndim == 3:
        tiles = np.unique(np.linspace(0, len(base) - 1, min(len(base), MOST_TILES)).astype(int))
        compared, base = (volume[tiles].reshape(-1, volume.shape[2]) for volume in (compared, base))
    window = min(SSIM_WINDOW, *(side - 1 + side % 2 for side in base.shape))
    if window < 3:
        return None
    return float(metrics.structural_similarity(base, compared, data_range=255, win_size=window))


def compare_points(compared: Cloud, base: Cloud) -> PointDifference:
    """Compare the points of two clouds of a scene frame by frame.

    Frames of another number a second are compared with the base's nearest one.
    """
    moved, distances, points = 0, list[Float](), 0
    frames = _frames(compared), _frames(base)
    counts = [max(len(cloud), 1) for cloud in frames]
    for number, places in enumerate(frames[1]):
        other = frames[0][number * counts[0] // counts[1]] if frames[0] else places[:0]
        for source, others in ((places, other), (other, places)):
            points += len(source)
            nearest = _nearest_m(source, others)
            moved += int((nearest > STAYS_M).sum())
            distances.append(nearest[(nearest > STAYS_M) & np.isfinite(nearest)])
    ways = np.concatenate([np.empty(0), *distances])
    return PointDifference(
        moved / max(points, 1),
        float(np.median(ways)) if ways.size else None,
        len(compared.points) / counts[0],
        len(base.points) / counts[1],
    )


def _frames(cloud: Cloud) -> list[Float]:
    """Places [n, 3] of the points of each frame, m."""
    return [cloud.points[first:stop, :3].astype(float) for first, stop in pairwise(cloud.start)]


def _nearest_m(places: Float, others: Float) -> Float:
    """Way from each place [n, 3] to the nearest of others, m; inf without any."""
    if not len(others) or not len(places):
        return np.full(len(places), inf)
    ways: Float = np.linalg.norm(places[:, None] - others, axis=-1).min(axis=1)
    return ways


def visible_errors(raw: Raw) -> Iterator[tuple[str, int]]:
    """Yield the error of the signal, dB, from which on more than VISIBLE of a map changes.

    White errors of known size are added to the raw products of a sample with its noise; a bisection
    finds the least whole number of dB that shows. Of points it is the share that moves.

    Yields:
        Map and dB; HIGHEST_DB + 1 where none shows.
    """
    error = _unit_error(raw)
    for name in shown_names(raw.scene.config):
        base = draw_shown(raw, raw.noise, only=name)
        low, high = LOWEST_DB, HIGHEST_DB + 1
        while high - low > 1:
            middle = (low + high) // 2
            values = {key: x + 10 ** (middle / 20) * error[key] for key, x in raw.values.items()}
            visible = draw_shown(raw, raw.noise, values, name)
            difference = compare_scene(raw, visible, raw, base)
            points = difference.points
            share = points.moved if points else difference.maps[name].over_one
            low, high = (low, middle) if share > VISIBLE else (middle, high)
        yield name, high


def _unit_error(raw: Raw) -> dict[str, Complex]:
    """White error of the same L2 norm as each raw product; real where samples are."""
    rng, radar = np.random.default_rng(SEED), raw.scene.config.radar
    is_real = isinstance(radar, ImpulseRadar | CwRadar) and radar.output in ("rf", "real")
    errors = dict[str, Complex]()
    for name, x in raw.values.items():
        imaginary = np.zeros(x.shape) if is_real else rng.standard_normal(x.shape)
        error: Complex = rng.standard_normal(x.shape) + 1j * imaginary
        errors[name] = error * float(np.linalg.norm(x) / np.linalg.norm(error))
    return errors
