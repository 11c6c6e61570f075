"""What a sample shows under a setting: raw signals without noise, and pictures drawn from them."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from radhar_cli.config.data_set import Config
from radhar_cli.config.radar import ArrayRadar
from radhar_cli.echo.direct import Accuracy
from radhar_cli.numerics.arrays import Bool, Complex, Float
from radhar_cli.processing.canceller import Fir
from radhar_cli.processing.frame_maps import FRAME_MAP_KINDS, FrameMaps
from radhar_cli.processing.points import Cloud
from radhar_cli.processing.power_map import MapImage
from radhar_cli.processing.signal import Signal
from radhar_cli.scene.products.images import level_scale_of
from radhar_cli.scene.products.maps import image_name
from radhar_cli.scene.products.plan import plan
from radhar_cli.scene.products.run import record
from radhar_cli.scene.products.table import products
from radhar_cli.scene.scene import Scene
from radhar_cli.schema.number import nominal
from radhar_cli.study.tradeoff.scenes import Scenes, SweepSample
from radhar_cli.study.tradeoff.setting import Overrides

NO_NOISE = ("snr_db=null", "receiver.noise_figure_db=null")
POINTS, CLOUD, CUBE, BINS = "points", "cloud", "cube", "range_signals"
SIGNALS = (BINS, "signal", "range_profiles")
# Names of the raw products in sentences.
WORDS = {
    CUBE: "the cube",
    BINS: "the gate's bins",
    "signal": "the signal",
    "range_profiles": "the range profiles",
}


@dataclass(frozen=True)
class ShownMap:
    """Grey levels with the values of their axes, evenly spaced, one axis a dimension."""

    levels: NDArray[np.uint8]
    axes: tuple[Float, ...]


class Shown(NamedTuple):
    """What people and networks see of a sample."""

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


def shown_names(config: Config) -> dict[str, str]:
    """{map: product} of what a data set of a config shows."""
    names = {}
    for name in config.maps:
        product = name if name in FRAME_MAP_KINDS else image_name(name)
        names[name] = CLOUD if name == POINTS else product
    return names


def raw_names(config: Config) -> tuple[str, ...]:
    """Names of the raw products from which a config's maps are drawn."""
    if isinstance(config.radar, ArrayRadar):
        return (CUBE,)
    table = products(config)
    steps = plan(table, shown_names(config).values(), ["scene"])
    return tuple(name for name in SIGNALS if name in steps)


@dataclass(frozen=True)
class Recorder:
    """Simulates a sample under settings."""

    scenes: Scenes
    sample: SweepSample

    @cached_property
    def attempt(self) -> int:
        """Number of the draw that is valid under the config as it is."""
        return self.draw(()).attempt

    def draw(self, overrides: Overrides) -> Scene:
        """Draw the scene under overrides."""
        return self.scenes.draw(self.sample, self.scenes.config(overrides))

    def simulate(self, overrides: Overrides, with_noise: bool = False) -> Raw:
        """Make the raw products of the sample, without noise.

        Args:
            overrides: overrides of the setting.
            with_noise: whether the noise is wanted, too.

        Raises:
            RadharError: the scene cannot be simulated so.
        """
        scene = self.draw(overrides)
        if isinstance(scene.config.radar, ArrayRadar):
            return _simulate_board(scene)
        quiet = scene
        if scene.config.has_noise:
            quiet = self.draw((*overrides, *_quiet_overrides(scene.config)))
        names = raw_names(scene.config)
        raw = _simulate_channel(quiet, names)._replace(scene=scene)
        if with_noise and quiet is not scene:
            noisy = record(scene, names).products
            noise = {name: noisy[name].x - raw.values[name] for name in names}
            raw = raw._replace(noise=noise)
        return raw


def _quiet_overrides(config: Config) -> Overrides:
    """Overrides by which a config has no noise, and nothing that is relative to it."""
    tones = ("receiver.tones=[]",) if config.receiver.tones else ()
    corner = ("receiver.noise_corner_hz=0",) if nominal(config.receiver.noise_corner_hz) else ()
    return (*NO_NOISE, *tones, *corner)


def _simulate_board(scene: Scene) -> Raw:
    """Simulate the cube of a board; its noise costs little, and is always there."""
    results = record(scene, ["echo", CUBE, "accuracy"])
    cube, noisy = results["echo"].cube, results[CUBE]
    noise = {CUBE: noisy - cube}
    return Raw(scene, {CUBE: cube}, {}, noise, None, _stated_db(results["accuracy"]))


def _simulate_channel(scene: Scene, names: tuple[str, ...]) -> Raw:
    """Simulate raw products of one channel of a scene without noise."""
    config = scene.config
    further = ["accuracy"] * config.has_error
    is_gated = BINS in names and config.processing.range_sum == "gated"
    further += ["gate", "frames", "canceller"] * is_gated
    results = record(scene, [*names, *further])
    signals: dict[str, Signal] = {name: results[name] for name in names}
    values = {name: signal.x for name, signal in signals.items()}
    needed = _needed_bins(results.products, values[BINS]) if is_gated else None
    return Raw(scene, values, signals, {}, needed, _stated_db(results.products.get("accuracy")))


def _needed_bins(results: Mapping[str, Any], bins: Complex) -> Bool | None:
    """Which samples [channel, bin, pulse] frames of a gate show; None where all count."""
    gate = results["gate"]
    if (
        not isinstance(results["canceller"], Fir)
        or gate.bins.stop - gate.bins.start != bins.shape[1]
    ):
        return None
    low, high = gate.needed(results["frames"], bins.shape[-1], 0)
    numbers = np.arange(gate.bins.start, gate.bins.stop)[:, None]
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
    samples = raw.values if values is None else values
    names = shown_names(raw.scene.config)
    names = {only: names[only]} if only is not None else names
    noisy = {name: x + (noise or {}).get(name, 0) for name, x in samples.items()}
    inputs: dict[str, Any] = {
        name: raw.signals[name].with_samples(x) if name in raw.signals else x
        for name, x in noisy.items()
    }
    maps = [product for product in names.values() if product != CLOUD]
    results = record(raw.scene, maps, **inputs).products if maps else {}
    pictures = {
        name: _picture(results[product], raw.scene.config)
        for name, product in names.items()
        if product != CLOUD
    }
    cloud = None
    if POINTS in names:
        cube = samples[CUBE] + (raw.noise if noise is None else noise)[CUBE]
        cloud = record(raw.scene, [CLOUD], cube=cube)[CLOUD]
    return Shown(pictures, cloud)


def _picture(results: MapImage | FrameMaps, config: Config) -> ShownMap:
    """Picture of an image, or of all frames of a board's map."""
    if isinstance(results, FrameMaps):
        results = results.shown
        axes = (results.times, results.rows.values, results.columns.values)
        return ShownMap(level_scale_of(config).levels(results.power), axes)
    left, right, low, high = results.extent
    height, width = results.levels.shape
    rows = high - (np.arange(height) + 0.5) * (high - low) / height
    columns = left + (np.arange(width) + 0.5) * (right - left) / width
    return ShownMap(results.levels, (rows, columns))
