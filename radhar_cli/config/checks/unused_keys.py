"""Keys of a config that have no effect, because of another key."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from functools import partial
from operator import eq
from typing import Any

from pydantic import BaseModel

from radhar_cli.config.data_set import Config
from radhar_cli.config.motion import FALL, USUAL_SPEEDS, MotionConfig
from radhar_cli.config.paths import numbers
from radhar_cli.config.range_zone import range_zone
from radhar_cli.config.room import WallConfig
from radhar_cli.motion.activities.activity import Activity
from radhar_cli.schema.annotations import (
    OnlyMaps,
    annotations,
    at,
    conditions,
    entry,
    of_kind,
)
from radhar_cli.schema.number import support
from radhar_cli.schema.section import PerActivity
from radhar_cli.schema.twelve import DEFAULT

_OF_PEOPLE = ("subject.", "motion.", "timing.")


def unused_keys(config: Config) -> list[str]:
    """Warn of keys that have no effect, although their values are not the defaults."""
    fixed = all(isinstance(number, int | float) for _, number in numbers(config))
    same = _drawn_from if fixed else eq
    without = {"recordings": "the scenes of a config; it needs radhar generate --recordings"}
    without |= dict(_of_nobody(config, config.chosen_activities, config.activities))
    without |= dict([*_of_other_maps(config), *_without_condition(config)])
    _forget_usual_speeds(without, fixed)
    if fixed or "range_limits_m" not in config.image.model_fields_set:
        without.pop("image.range_limits_m", None)  # which follows from where people can be
    lines = _describe_unused(config, without, same)
    lines += _describe_idle_entries(config, config.chosen_activities, config.activities)
    for number, person in enumerate(config.people, 1):
        person_config, activities = config.of_person(number), config.activities_of(number)
        without = dict(_of_nobody(person_config, activities, person.names))
        unmet = _without_condition(person_config)
        without |= {key: why for key, why in unmet if key.startswith(_OF_PEOPLE)}
        _forget_usual_speeds(without, fixed)
        person_lines = _describe_unused(person_config, without, same)
        person_lines += _describe_idle_entries(person_config, activities, person.names)
        lines += [f"people.{number - 1}.{line}" for line in person_lines]
    return lines


def _forget_usual_speeds(without: dict[str, str], is_scene: bool) -> None:
    """Leave out of a scene's unused keys the speeds that follow the stature: nobody wrote them."""
    for key in USUAL_SPEEDS if is_scene else ():
        without.pop(key, None)


def _describe_unused(
    config: Config, without: Mapping[str, str], same: Callable[[Any, Any], bool]
) -> list[str]:
    """Describe keys {key: reason} whose values are not the defaults."""
    usual = _left_out(config)
    return [
        f"{key} has no effect with {why}"
        for key, why in without.items()
        if not same(at(config, key), at(usual, key))
    ]


def _left_out(config: Config) -> Config:
    """Return the defaults under the same radar, model of motion, duration, stream and wall."""
    radar = config.radar
    needed = {
        "waveform",
        *({"device"} & type(radar).model_fields.keys()),  # which the noise figure follows
        *(name for name, f in type(radar).model_fields.items() if f.is_required()),
    }
    required = {name: getattr(radar, name) for name in needed}
    wall = config.wall and WallConfig.model_construct({"layers"}, layers=config.wall.layers)
    usual = Config.model_construct(
        motion=MotionConfig(model=config.motion.model),
        duration_s=config.duration_s,
        stream=config.stream,
        radar=type(radar).model_construct(needed, **required),
        wall=wall,
    ).filled()
    if config.motion.model != "human":
        return usual
    limits = {"range_limits_m": range_zone(config)}
    return usual.model_copy(update={"image": usual.image.model_copy(update=limits)})


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
        if not set(only.names) & set(config.maps):
            yield key, entry("maps", config.maps)


def _of_nobody(
    config: Config, activities: Sequence[Activity], chosen: str | tuple[str, ...]
) -> Iterator[tuple[str, str]]:
    """(key, reason) of numbers of people that no activity uses.

    Args:
        config: config whose numbers are those of the people.
        activities: activities of these people.
        chosen: the same as the config says it, for the reason.
    """
    for key in _keys_of_people(config):
        if not any(config.depends_on(one, key) for one in activities):
            yield key, _why_nobody(config, activities, key, entry("activities", chosen))


def _describe_idle_entries(
    config: Config, activities: Sequence[Activity], chosen: str | tuple[str, ...]
) -> list[str]:
    """Describe entries of `per_activity` for activities that are not there, or do not use them.

    Args:
        config: config whose numbers are those of the people.
        activities: activities of these people.
        chosen: the same as the config says it, for the reason.
    """
    usual, lines = _left_out(config), list[str]()
    for key in _keys_of_people(config):
        value, default = at(config, key), at(usual, key)
        users = {one.slug for one in activities if config.depends_on(one, key)}
        if not users or not isinstance(value, PerActivity):
            continue
        others = default.per_activity if isinstance(default, PerActivity) else {DEFAULT: default}
        idle = [
            slug
            for slug, number in value.per_activity.items()
            if slug not in (*users, DEFAULT) and number != others.get(slug, others.get(DEFAULT))
        ]
        names = idle[0] if len(idle) == 1 else f"{{{', '.join(idle)}}}"
        if idle:
            doing = entry("activities", chosen)
            line = f"{key}.per_activity.{names} has no effect with {doing}: nobody uses it"
            lines.append(line)
    return lines


def _keys_of_people(config: Config) -> Iterator[str]:
    keys = (*(key for key, _ in numbers(config)), FALL)
    return (key for key in keys if key.startswith(_OF_PEOPLE))


def _why_nobody(config: Config, activities: Sequence[Activity], key: str, doing: str) -> str:
    """Return why no activity uses a number of people, with the activities that would."""
    if all(one.motion is not None or config.files_of(one) is not None for one in activities):
        return f"{doing}, whose motion no model makes"
    users = config.users_of(key)
    if not users:
        return entry("motion.model", config.motion.model)
    names = " or ".join([", ".join(users[:-1]), users[-1]] if users[1:] else users)
    return f"{doing}; it needs {names}"


def _drawn_from(value: Any, default: Any) -> bool:
    """Whether a value of a scene is the default, or was drawn from it."""
    if value == default or not isinstance(default, BaseModel | PerActivity):
        return bool(value == default)
    if isinstance(default, BaseModel) and not isinstance(value, int | float):
        return all(
            _drawn_from(getattr(value, name), getattr(default, name))
            for name in type(default).model_fields
        )
    number: Any = default
    forms = number.per_activity.values() if isinstance(number, PerActivity) else (number,)
    return any(support(form)[0] <= value <= support(form)[1] for form in forms)
