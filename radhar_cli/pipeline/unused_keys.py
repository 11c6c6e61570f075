"""Keys of a config that have no effect, because of what another key says."""

from collections.abc import Iterator
from functools import partial
from operator import eq
from typing import Any

from pydantic import BaseModel

from radhar_cli.activity import ACTIVITIES
from radhar_cli.config.annotations import (
    OnlyMaps,
    annotations,
    at,
    conditions,
    entry,
    of_kind,
)
from radhar_cli.config.number import support
from radhar_cli.config.schema import (
    Config,
    MotionConfig,
    PerActivity,
    RadarConfig,
    WallConfig,
    class_activities,
)
from radhar_cli.scene import FALL, numbers

_OF_PEOPLE = ("subject.", "motion.", "timing.")


def unused_keys(config: Config) -> list[str]:
    """Say which keys have no effect although they say something else than if they were left out."""
    fixed = all(isinstance(number, int | float) for _, number in numbers(config))
    same = _drawn_from if fixed else eq
    usual = _left_out(config)
    without = {"recordings": "the scenes of a config; it needs radhar generate --recordings"}
    without |= dict([*_of_nobody(config), *_of_other_maps(config), *_without_condition(config)])
    found = [
        f"{key} has no effect with {why}"
        for key, why in without.items()
        if not same(at(config, key), at(usual, key))
    ]
    for number in range(1, len(config.people) + 1):
        theirs = config.of_person(number)
        usual = _left_out(theirs)
        found += [
            f"people.{number - 1}.{key} has no effect with {why}"
            for key, why in _of_nobody(theirs, config.activities_of(number))
            if not same(at(theirs, key), at(usual, key))
        ]
    return found


def _left_out(config: Config) -> Config:
    """What a config says where it says nothing, with the radar and the motion that it has."""
    stepped = ("steps", "dwell_s") if config.radar.waveform == "sfcw" else ()
    radar = {name: getattr(config.radar, name) for name in ("waveform", "cfg", *stepped)}
    wall = config.wall and WallConfig.model_construct({"layers"}, layers=config.wall.layers)
    return Config.model_construct(
        motion=MotionConfig(model=config.motion.model),
        duration_s=config.duration_s,
        radar=RadarConfig.model_construct(set(radar), **radar),
        wall=wall,
    ).filled()


def _without_condition(config: Config) -> Iterator[tuple[str, str]]:
    """(key, reason) of keys and sections whose conditions do not hold; a section is said once."""
    value_at = partial(at, config)
    for key in annotations(Config):
        failing = next((c for c in conditions(Config, key) if not c.holds(value_at)), None)
        above = conditions(Config, key.rpartition(".")[0])
        if failing is not None and failing not in above:
            yield key, f"{failing.entry(value_at)}; it needs {failing.right}"


def _of_other_maps(config: Config) -> Iterator[tuple[str, str]]:
    for key, only in of_kind(Config, OnlyMaps):
        if not any(only.part in name for name in config.maps):
            yield key, entry("maps", config.maps)


def _of_nobody(config: Config, activities: Any = None) -> Iterator[tuple[str, str]]:
    """(key, reason) of numbers of people that no activity uses under the model of motion."""
    if activities is None:
        own = class_activities(config.classes) | {a.slug: a for a in config.chosen_activities}
        activities = ({a.slug: a for a in ACTIVITIES} | own).values()
    for key in (*(key for key, _ in numbers(config)), FALL):
        of_people = key.startswith(_OF_PEOPLE)
        if of_people and not any(config.depends_on(activity, key) for activity in activities):
            yield key, entry("motion.model", config.motion.model)


def _drawn_from(value: Any, default: Any) -> bool:
    """Whether a value of a scene is the default, or was drawn from it."""
    if value == default or not isinstance(default, BaseModel | PerActivity):
        return bool(value == default)
    if isinstance(default, BaseModel) and not isinstance(value, int | float):
        return all(
            _drawn_from(getattr(value, name), getattr(default, name))
            for name in type(default).model_fields
        )
    given: Any = default
    forms = given.per_activity.values() if isinstance(given, PerActivity) else (given,)
    return any(support(form)[0] <= value <= support(form)[1] for form in forms)
