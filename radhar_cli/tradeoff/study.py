"""The whole sweep: every unit of work measured once, kept, and put together into rows."""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import partial
from statistics import median, quantiles
from typing import Any

from radhar_cli.errors import RadharError
from radhar_cli.progress import Progress
from radhar_cli.tradeoff.differences import SceneDifferences
from radhar_cli.tradeoff.result_cache import ResultCache
from radhar_cli.tradeoff.scenes import Scenes
from radhar_cli.tradeoff.settings import Setting, sweep
from radhar_cli.tradeoff.timing import Times, time_setting

ROUNDS = {True: 3, False: 7}


@dataclass(frozen=True)
class Row:
    """One setting, measured.

    Attributes:
        setting: what was measured.
        times: round by round.
        differences: {activity: what differs from the reference}; a scene that the engine refused
            has the reason under `refused`.
    """

    setting: Setting
    times: list[Times] = field(default_factory=list)
    differences: dict[str, dict[str, Any]] = field(default_factory=dict)

    def middle(self, name: str) -> float | None:
        """Median of a column of `Times` over the rounds."""
        values = [getattr(times, name) for times in self.times]
        return median(values) if values else None

    def spread(self, name: str) -> tuple[float, float] | None:
        """First and third quartile of a column of `Times`."""
        values = [getattr(times, name) for times in self.times]
        if len(values) < 2:
            return (values[0], values[0]) if values else None
        first, _, third = quantiles(values, n=4, method="inclusive")
        return first, third

    def values(self, name: str) -> list[float]:
        """A difference in every scene that has it."""
        differences = [row.get(name) for row in self.differences.values()]
        return [float(value) for value in differences if value is not None]

    def worst(self, name: str) -> float | None:
        """The largest value of a difference over the scenes."""
        return max(self.values(name), default=None)

    def usual(self, name: str) -> float | None:
        """The median of a difference over the scenes."""
        values = self.values(name)
        return median(values) if values else None

    @property
    def refused(self) -> list[str]:
        """Why scenes could not be computed."""
        return [row["refused"] for row in self.differences.values() if "refused" in row]


def run_sweep(scenes: Scenes, cache: ResultCache, progress: Progress) -> list[Row]:
    """Measure what has not been measured yet; return all rows."""
    rows = [Row(setting) for setting in _possible(scenes, progress)]
    _differences(scenes, rows, cache, progress)
    _times(scenes, rows, cache, progress)
    return rows


def _possible(scenes: Scenes, progress: Progress) -> list[Setting]:
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


def _differences(
    scenes: Scenes, rows: Sequence[Row], cache: ResultCache, progress: Progress
) -> None:
    names = scenes.names()
    progress.stage("errors", len(names) * len(rows), 0)
    for slug in names:
        scene = SceneDifferences(scenes, slug)
        for row in rows:
            key = _key("difference", row.setting, slug)
            row.differences[slug] = _once(
                cache, key, partial(_of, scene, row), dict[str, float | str | None]
            )
            progress.advance(1)


def _of(scene: SceneDifferences, row: Row) -> dict[str, Any]:
    try:
        return scene.of(row.setting)
    except RadharError as error:
        return {"refused": str(error)}


def _times(scenes: Scenes, rows: Sequence[Row], cache: ResultCache, progress: Progress) -> None:
    rounds, names = ROUNDS[scenes.quick], " ".join(scenes.names())
    possible = [row for row in rows if not row.refused]
    progress.stage("times", rounds * len(possible), 0)
    for turn in range(rounds):
        for row in possible:
            key = _key("time", row.setting, f"{turn} {names}")
            measure = partial(time_setting, scenes, row.setting, turn)
            row.times.append(Times(*_once(cache, key, measure, tuple[float, float, float, float])))
            progress.advance(1)


def _once(cache: ResultCache, key: str, measure: Callable[[], Any], kind: Any) -> Any:
    result = cache.get(key, kind)
    if result is None:
        cache.put(key, measure())
        result = cache.get(key, kind)
    return result


def _key(kind: str, setting: Setting, what: str) -> str:
    parts = [kind, setting.group, setting.name, what]
    return json.dumps(
        [*parts, setting.overrides, setting.compared, setting.exact, setting.baseline]
    )
