"""What a setting costs: errors of signal and image, against exact data; time of a sample."""

from functools import cache, partial
from math import inf, log10
from time import process_time
from typing import Any, NamedTuple

import numpy as np

from radhar_cli.echo.direct import Accuracy
from radhar_cli.numerics.arrays import Complex, Levels
from radhar_cli.products.run import record, run
from radhar_cli.products.table import plan_images
from radhar_cli.tradeoff.settings import Scenes, Setting

QUIET = ("snr_db=null", "receiver.noise_figure_db=null")
# How long a setting is timed in a round, at most this and one scene more.
SECONDS = 0.6
SSIM_WINDOW = 7


class Errors(NamedTuple):
    """Errors of a setting's data of a scene against exact ones, None where they say nothing."""

    measured_error_db: float | None  # what the direct engine measured itself; None of the cube
    signal_error_db: float | None
    ssim: float | None
    pixels_changed: float


def relative_db(compared: Complex, exact: Complex) -> float | None:
    """Relative L2 error of two signals in dB.

    Returns:
        -inf where the two are the same, None where the exact one is 0 or of another length.
    """
    size = float(np.linalg.norm(exact))
    if compared.shape != exact.shape or size == 0:
        return None
    error = float(np.linalg.norm(compared - exact)) / size
    return 20 * log10(error) if error > 0 else -inf


def image_scores(compared: Levels, exact: Levels) -> tuple[float | None, float]:
    """SSIM of two images of one size, and share of pixels whose level differs.

    SSIM has a window of 7 pixels, of 3 or 5 in smaller images, and is None below 3.
    """
    import skimage.metrics

    metrics: Any = skimage.metrics
    window = min(SSIM_WINDOW, *(side - 1 + side % 2 for side in exact.shape))
    similar = None
    if window >= 3:
        similar = float(
            metrics.structural_similarity(exact, compared, data_range=255, win_size=window)
        )
    return similar, float(np.mean(compared != exact))


class SettingData(NamedTuple):
    """Signal and image of one scene under one setting."""

    signal: Complex  # x [M] after the canceller
    levels: Levels  # of the first map of the config
    # the error that the direct engine measured itself, dB; None of the cube
    engine_db: float | None


class SceneErrors:
    """Errors of settings in one scene; data that several of them refer to are made once."""

    def __init__(self, scenes: Scenes, slug: str) -> None:
        self._sample = cache(partial(_simulate_sample, scenes, slug))

    def measure_errors(self, setting: Setting) -> Errors:
        """Errors of a setting's data against its exact data, without noise unless it is noisy."""
        quiet = () if setting.noisy else QUIET
        compared = self._sample((*setting.compared, *quiet))
        exact = self._sample((*setting.exact, *quiet))
        return Errors(
            compared.engine_db,
            relative_db(compared.signal, exact.signal),
            *image_scores(compared.levels, exact.levels),
        )


def _simulate_sample(scenes: Scenes, slug: str, overrides: tuple[str, ...]) -> SettingData:
    config = scenes.config(overrides)
    name = config.maps[0]
    wanted_products = ["signal", f"image:{name}"] + ["accuracy"] * (config.engine.kind == "direct")
    products = record(scenes.draw(slug, config), wanted_products).products
    accuracy = products.get("accuracy")
    return SettingData(
        products["signal"].x[0, 0],
        products[f"image:{name}"].levels,
        accuracy.error_db if isinstance(accuracy, Accuracy) else None,
    )


class Times(NamedTuple):
    """Times of one round of one setting."""

    sample_ms: float  # from scene to levels and entropy, a sample
    ratio: float  # over that of the baseline


def time_setting(scenes: Scenes, setting: Setting, turn: int) -> Times:
    """Time a setting and its baseline in turns, scene by scene, for a fraction of a second.

    Args:
        scenes: scenes of the sweep.
        setting: setting with its baseline.
        turn: number of the round, which decides with which scene it begins.
    """
    names = scenes.names()
    setting_s = baseline_s = 0.0
    for step in range(turn, turn + len(names)):
        slug = names[step % len(names)]
        if step % 2:
            baseline_s += _cpu_seconds(scenes, slug, setting.baseline)
        setting_s += _cpu_seconds(scenes, slug, setting.overrides)
        if not step % 2:
            baseline_s += _cpu_seconds(scenes, slug, setting.baseline)
        if setting_s + baseline_s > SECONDS:
            break
    return Times(1e3 * setting_s / (step - turn + 1), setting_s / baseline_s)


def _cpu_seconds(scenes: Scenes, slug: str, overrides: tuple[str, ...]) -> float:
    config = scenes.config(overrides)
    scene, plan = scenes.draw(slug, config), plan_images(config)
    start = process_time()
    run(plan, {"scene": scene})
    return process_time() - start
