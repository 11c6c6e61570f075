"""The whole sweep: what is measured once is kept, and put together into rows."""

import hashlib
import json
import shutil
from collections.abc import Callable, Sequence
from functools import partial
from math import inf
from pathlib import Path
from statistics import median, quantiles
from typing import Any, TypeAlias

from pydantic import TypeAdapter, ValidationError

from radhar_cli.config.schema import Config
from radhar_cli.dataset.files import write_whole
from radhar_cli.dataset.folder import checked_identity, refuse_differences, refuse_foreign_files
from radhar_cli.dataset.identity import differences, identity
from radhar_cli.dataset.layout import WORK
from radhar_cli.errors import FolderError, RadharError
from radhar_cli.progress import Progress
from radhar_cli.tradeoff.measures import SceneDifferences, Times, time_setting
from radhar_cli.tradeoff.settings import Scenes, Setting, sweep
from radhar_cli.untrusted import read_json

ROUNDS = {True: 3, False: 7}
NAME = "sweep.json"
Record: TypeAlias = dict[str, Any]  # a setting in plain numbers, None where there is none


def reserve(folder: Path, config: Config, overwrite: bool) -> None:
    """Make a folder, whose lock is held, this config's sweep, or refuse.

    Raises:
        FolderError: it holds something else, or the sweep of another config.
    """
    path = folder / WORK / NAME
    old = checked_identity(read_json(path), path) if path.exists() else None
    new = {"keys": identity(config)["keys"], "versions": identity(config)["versions"]}
    if old is None:
        refuse_foreign_files(folder, "sweep")
    elif overwrite:
        shutil.rmtree(folder / WORK / "measured", ignore_errors=True)
    else:
        refuse_differences(folder, "config's sweep", differences(old, new))
    write_whole(folder, path, json.dumps(new).encode())


def run_sweep(scenes: Scenes, folder: Path, progress: Progress) -> list[Record]:
    """Measure what has not been measured yet; return a row for every setting."""
    settings, names, rounds = possible(scenes, progress), scenes.names(), ROUNDS[scenes.quick]
    found: dict[Setting, list[dict[str, Any]]] = {setting: [] for setting in settings}
    progress.stage("errors", len(names) * len(settings), 0)
    for slug in names:
        scene = SceneDifferences(scenes, slug)
        for setting in settings:
            what, kind = f"difference {slug}", dict[str, float | str | None]
            found[setting].append(_once(folder, setting, what, partial(_of, scene, setting), kind))
            progress.advance(1)
    timed = [setting for setting in settings if not any("refused" in one for one in found[setting])]
    times: dict[Setting, list[Times]] = {setting: [] for setting in settings}
    progress.stage("times", rounds * len(timed), 0)
    for turn in range(rounds):
        for setting in timed:
            what, measure = f"time {turn} {names}", partial(time_setting, scenes, setting, turn)
            times[setting].append(_once(folder, setting, what, measure, Times))
            progress.advance(1)
    return [_row(setting, times[setting], found[setting]) for setting in settings]


def possible(scenes: Scenes, progress: Progress) -> list[Setting]:
    """The settings that the config allows; the others are named, with the reason."""
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


def _of(scene: SceneDifferences, setting: Setting) -> dict[str, Any]:
    try:
        return scene.of(setting)
    except RadharError as error:
        return {"refused": str(error)}


def _once(folder: Path, setting: Setting, what: str, measure: Callable[[], Any], kind: Any) -> Any:
    """What was measured before and lies in the folder, or is measured now and kept there."""
    key = hashlib.sha256(f"{what} {setting}".encode()).hexdigest()[:32]
    path = folder / WORK / "measured" / f"{key}.json"
    if not path.exists():
        write_whole(folder, path, json.dumps(measure()).encode())
    try:
        return TypeAdapter(kind).validate_python(read_json(path))
    except ValidationError as error:
        first = error.errors(include_url=False)[0]["msg"]
        raise FolderError(f"{path}: is damaged ({first}); delete it") from None


def _row(setting: Setting, times: Sequence[Times], found: Sequence[dict[str, Any]]) -> Record:
    """Medians and quartiles over the rounds, worst or median differences over the scenes."""

    def every(name: str) -> list[float]:
        return [float(one[name]) for one in found if one.get(name) is not None]

    def worst(name: str) -> float | None:
        return max(every(name), default=None)

    def quartiles(name: str) -> list[float | None]:
        values = [getattr(one, name) for one in times]
        if len(values) < 2:
            return 3 * (values or [None])
        return list(quantiles(values, n=4, method="inclusive"))

    errors = every("signal_error_db")
    (low, ratio, high), (echo_low, echo, echo_high) = quartiles("ratio"), quartiles("echo_ratio")
    return {
        "group": setting.group,
        "setting": setting.name,
        "default": setting.is_default,
        "overrides": " ".join(setting.overrides),
        "of_signal": setting.of_signal,
        "time_over": setting.baseline_name,
        "sample_ms": quartiles("sample_ms")[1],
        "time_ratio": ratio,
        "time_ratio_low": low,
        "time_ratio_high": high,
        "echo_ms": quartiles("echo_ms")[1],
        "echo_ratio": echo,
        "echo_ratio_low": echo_low,
        "echo_ratio_high": echo_high,
        "exact": worst("signal_error_db") == -inf,
        "signal_error_db": worst("signal_error_db"),
        "signal_error_median_db": median(errors) if errors else None,
        "map_error_db": worst("map_error_db"),
        "map_error_max_db": worst("map_error_max_db"),
        "ssim": min(every("ssim"), default=None),
        "psnr_db": min(every("psnr_db"), default=None),
        "pixels_changed": worst("pixels_changed"),
        "measured_error_db": worst("measured_error_db"),
        "scenes": len(found),
        "refused": sum("refused" in one for one in found),
    }
