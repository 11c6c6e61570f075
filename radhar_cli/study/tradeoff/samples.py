"""Samples that settings are compared on: their raw signals without noise, and what those show."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from radhar_cli.config import load_config
from radhar_cli.config.data_set import Config
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.echo.direct import Accuracy
from radhar_cli.numerics.arrays import Bool, Complex, Float
from radhar_cli.processing.canceller import Fir
from radhar_cli.processing.frame_maps import FRAME_MAP_KINDS, FrameMaps
from radhar_cli.processing.points import Cloud
from radhar_cli.processing.power_map import MapImage
from radhar_cli.processing.signal import Signal
from radhar_cli.scene.checks.drawing import draw_valid_scene
from radhar_cli.scene.products.images import level_scale_of
from radhar_cli.scene.products.maps import image_name
from radhar_cli.scene.products.plan import plan
from radhar_cli.scene.products.run import record
from radhar_cli.scene.products.table import products
from radhar_cli.scene.scene import Scene
from radhar_cli.schema.number import nominal
from radhar_cli.study.tradeoff.settings import Overrides

# What differs most: a standing person's arms, a walk, a fall.
QUICK = ("punching", "walking", "walking_to_falling")
FEWEST_SCENES = 3
POINTS, CLOUD, CUBE, BINS = "points", "cloud", "cube", "range_signals"
# Raw products, in the order in which one stands for all, and their names in sentences.
WORDS = {
    CUBE: "the cube",
    BINS: "the gate's bins",
    "signal": "the signal",
    "range_profiles": "the range profiles",
}


@dataclass(frozen=True)
class Scenes:
    """Scenes of a sweep: samples 0 of the activities of a config file."""

    path: Path  # config file
    overrides: Overrides  # of the command line; those of a setting come after them
    quick: bool  # whether three scenes are enough

    def config(self, further: Sequence[str] = ()) -> Config:
        """Config under further overrides.

        Raises:
            ConfigError: the overrides do not fit it.
        """
        return _config(self.path, (*self.overrides, *further))

    def samples(self) -> list["ScenePlace"]:
        """Samples of which the scenes are: of every activity, or three of boards or where `quick`.

        Cubes of boards of twelve scenes would fill the memory.
        """
        config = self.config()
        counts = {a.slug: config.samples_of(a) for a in config.chosen_activities}
        slugs = list(counts)
        if self.quick or isinstance(config.radar, ArrayRadar):
            slugs = [slug for slug in slugs if slug in QUICK] or slugs[:FEWEST_SCENES]
        further = [(slug, n) for n in range(1, FEWEST_SCENES) for slug in slugs if n < counts[slug]]
        numbered = [(slug, 0) for slug in slugs]
        numbered += further[: max(0, FEWEST_SCENES - len(slugs))]
        return [ScenePlace(self, *place) for place in numbered]


@cache
def _config(path: Path, overrides: Overrides) -> Config:
    return load_config(path, overrides)


class ShownMap(NamedTuple):
    """Grey levels with the values of their axes, evenly spaced, one axis a dimension."""

    levels: NDArray[np.uint8]
    axes: tuple[Float, ...]


class Shown(NamedTuple):
    """Pictures and points of a sample, as people and networks see them."""

    pictures: dict[str, ShownMap]  # {map: picture}
    cloud: Cloud | None  # points of a board's frames


class Raw(NamedTuple):
    """Raw products of a sample, without noise, from which all that is shown is drawn."""

    scene: Scene
    values: dict[str, Complex]  # {product: samples}
    signals: dict[str, Signal]  # {product: signal} of those which are no cube
    noise: dict[str, Complex]  # what the receiver adds to them, by product; {} where nobody asked
    needed: Bool | None = None  # samples of the gate's bins that frames show; None for all
    # error that the engine itself states, dB; None where it states none
    stated_db: float | None = None


class ScenePlace(NamedTuple):
    """Sample of the config, drawn and simulated anew under each setting."""

    scenes: Scenes
    slug: str  # of its activity
    number: int = 0  # within that

    def draw(self, overrides: Overrides = ()) -> Scene:
        """Draw the scene; settings of engine, maps and image do not change it."""
        config = self.scenes.config(overrides)
        activity = next(a for a in config.chosen_activities if a.slug == self.slug)
        return draw_valid_scene(config, activity, self.number)[0]

    def simulate(self, overrides: Overrides, with_noise: bool = False) -> Raw:
        """Make the raw products of the sample, without noise, and the noise where it is wanted.

        Raises:
            RadharError: the scene cannot be simulated so.
        """
        scene = self.draw(overrides)
        config = scene.config
        if isinstance(config.radar, ArrayRadar):  # whose noise costs little, and is always there
            results = record(scene, ["echo", CUBE, "accuracy"])
            cube = results["echo"].cube
            noise = {CUBE: results[CUBE] - cube}
            return Raw(scene, {CUBE: cube}, {}, noise, None, _stated_db(results["accuracy"]))
        steps = plan(products(config), shown_names(config).values(), ["scene"])
        names = [name for name in WORDS if name in steps and name != CUBE]
        quiet = self.draw((*overrides, *_quiet(config))) if config.has_noise else scene
        raw = _simulate_channel(quiet, names)._replace(scene=scene)
        if with_noise and quiet is not scene:
            noisy = record(scene, names)
            raw = raw._replace(noise={name: noisy[name].x - raw.values[name] for name in names})
        return raw


def shown_names(config: Config) -> dict[str, str]:
    """{map: product} of the maps of a config's data set."""
    names = {name: name if name in FRAME_MAP_KINDS else image_name(name) for name in config.maps}
    return {**names, POINTS: CLOUD} if POINTS in names else names


def _quiet(config: Config) -> Overrides:
    """Overrides by which a config has no noise, and nothing that is relative to it."""
    tones = ("receiver.tones=[]",) if config.receiver.tones else ()
    corner = ("receiver.noise_corner_hz=0",) if nominal(config.receiver.noise_corner_hz) else ()
    return ("snr_db=null", "receiver.noise_figure_db=null", *tones, *corner)


def _simulate_channel(scene: Scene, names: Sequence[str]) -> Raw:
    """Simulate raw products of one channel of a scene without noise."""
    is_gated = BINS in names and scene.config.processing.range_sum == "gated"
    further = ["accuracy"] * scene.config.has_error + ["gate", "frames", "canceller"] * is_gated
    results = record(scene, [*names, *further]).products
    signals: dict[str, Signal] = {name: results[name] for name in names}
    values = {name: signal.x for name, signal in signals.items()}
    needed = _needed_bins(results, values[BINS]) if is_gated else None
    return Raw(scene, values, signals, {}, needed, _stated_db(results.get("accuracy")))


def _needed_bins(results: Mapping[str, Any], bins: Complex) -> Bool | None:
    """Which samples [channel, bin, pulse] frames of a gate show; None where all count."""
    numbers = np.arange(results["gate"].bins.start, results["gate"].bins.stop)[:, None]
    if not isinstance(results["canceller"], Fir) or len(numbers) != bins.shape[1]:
        return None
    low, high = results["gate"].needed(results["frames"], bins.shape[-1], 0)
    return np.broadcast_to((low <= numbers) & (numbers < high), bins.shape)


def _stated_db(accuracy: object) -> float | None:
    return accuracy.error_db if isinstance(accuracy, Accuracy) else None


def draw_shown(
    raw: Raw,
    noise: Mapping[str, Complex] | None = None,
    values: Mapping[str, Complex] | None = None,
    only: str | None = None,
) -> Shown:
    """Draw what a sample shows from raw products.

    Args:
        raw: raw products without noise.
        noise: noise that is added to them, by product; None for none, but for that of a board's
            points, which are not found without.
        values: other samples instead of those of `raw`.
        only: name of the map that is drawn; None for all.
    """
    samples, config = values or raw.values, raw.scene.config
    names = {name: p for name, p in shown_names(config).items() if only in (None, name)}
    noisy = {name: x + (noise or {}).get(name, 0) for name, x in samples.items()}
    inputs: dict[str, Any] = {
        name: raw.signals[name].with_samples(x) if name in raw.signals else x
        for name, x in noisy.items()
    }
    cloud = None
    if names.pop(POINTS, None):
        cube = samples[CUBE] + (raw.noise if noise is None else noise)[CUBE]
        cloud = record(raw.scene, [CLOUD], cube=cube)[CLOUD]
    results = record(raw.scene, [*names.values()], **inputs).products if names else {}
    return Shown({name: _picture(results[p], config) for name, p in names.items()}, cloud)


def _picture(result: MapImage | FrameMaps, config: Config) -> ShownMap:
    """Picture of an image, or of all frames of a board's map."""
    if isinstance(result, FrameMaps):
        frames = result.shown
        axes = (frames.times, frames.rows.values, frames.columns.values)
        return ShownMap(level_scale_of(config).levels(frames.power), axes)
    left, right, low, high = result.extent
    height, width = result.levels.shape
    rows = high - (np.arange(height) + 0.5) * (high - low) / height
    columns = left + (np.arange(width) + 0.5) * (right - left) / width
    return ShownMap(result.levels, (rows, columns))
