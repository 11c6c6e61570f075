"""The whole sweep: errors and times of every setting, put together into rows."""

from collections.abc import Sequence
from contextlib import suppress
from math import inf
from statistics import median, quantiles
from typing import Any, TypeAlias

from radhar_cli.errors import RadharError
from radhar_cli.processes.progress import Progress
from radhar_cli.tradeoff.measures import Errors, SceneErrors, Times, time_setting
from radhar_cli.tradeoff.settings import Scenes, Setting, sweep

ROUNDS = {True: 3, False: 7}
Record: TypeAlias = dict[str, Any]  # a setting in plain numbers, None where there is none


def run_sweep(scenes: Scenes, progress: Progress) -> list[Record]:
    """Measure errors and times; return a row for every setting.

    Args:
        scenes: scenes of the sweep.
        progress: receives the measurements done, and the settings that are left out.
    """
    settings, names, rounds = (
        allowed_settings(scenes, progress),
        scenes.names(),
        ROUNDS[scenes.quick],
    )
    errors_of: dict[Setting, list[Errors | None]] = {setting: [] for setting in settings}
    progress.stage("errors", len(names) * len(settings), 0)
    for slug in names:
        scene = SceneErrors(scenes, slug)
        for setting in settings:
            errors = None  # of a scene that is refused
            with suppress(RadharError):
                errors = scene.measure_errors(setting)
            errors_of[setting].append(errors)
            progress.advance(1)
    times: dict[Setting, list[Times]] = {setting: [] for setting in settings}
    possible = [setting for setting in settings if None not in errors_of[setting]]
    progress.stage("times", rounds * len(possible), 0)
    for turn in range(rounds):
        for setting in possible:
            times[setting].append(time_setting(scenes, setting, turn))
            progress.advance(1)
    return [_row(setting, times[setting], errors_of[setting]) for setting in settings]


def allowed_settings(scenes: Scenes, progress: Progress) -> list[Setting]:
    """Settings that the config allows; the others are named on `progress`, with the reason."""
    settings = []
    for setting in sweep(scenes.config()):
        try:
            for overrides in (setting.overrides, setting.compared, setting.exact):
                scenes.config(overrides)
        except RadharError as error:
            progress.say(f"left out: {setting.group} {setting.name}: {error}")
            continue
        settings.append(setting)
    return settings


def _row(setting: Setting, times: Sequence[Times], errors: Sequence[Errors | None]) -> Record:
    """Row of a setting: medians and quartiles over rounds, worst or median errors over scenes."""

    def known_values(name: str) -> list[float]:
        values = (getattr(scene, name) for scene in errors if scene is not None)
        return [value for value in values if value is not None]

    def worst(name: str) -> float | None:
        return max(known_values(name), default=None)

    signal = known_values("signal_error_db")
    quartiles = quantiles([one.ratio for one in times], n=4, method="inclusive") if times else None
    low, ratio, high = quartiles or (None, None, None)
    return {
        "group": setting.group,
        "setting": setting.name,
        "default": setting.is_default,
        "overrides": " ".join(setting.overrides),
        "time_over": setting.baseline_name,
        "sample_ms": median(one.sample_ms for one in times) if times else None,
        "time_ratio": ratio,
        "time_ratio_low": low,
        "time_ratio_high": high,
        "exact": worst("signal_error_db") == -inf,
        "signal_error_db": worst("signal_error_db"),
        "signal_error_median_db": median(signal) if signal else None,
        "ssim": min(known_values("ssim"), default=None),
        "pixels_changed": worst("pixels_changed"),
        "measured_error_db": worst("measured_error_db"),
        "scenes": len(errors),
        "refused": errors.count(None),
    }
