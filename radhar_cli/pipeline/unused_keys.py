"""Keys of a config that have no effect, because of what another key says."""

from collections.abc import Iterator
from operator import eq
from typing import Any

from pydantic import BaseModel

from radhar_cli.activity import ACTIVITIES
from radhar_cli.config.annotations import GIVEN, Needs, OnlyMaps, of_kind
from radhar_cli.config.number import support
from radhar_cli.config.paths import at
from radhar_cli.config.schema import Config, MotionConfig, PerActivity, class_activities
from radhar_cli.scene import FALL, numbers


def unused_keys(config: Config) -> list[str]:
    """Say which keys have no effect although their values are not the defaults."""
    default = Config.model_construct(motion=MotionConfig(model=config.motion.model)).filled()
    fixed = all(isinstance(number, int | float) for _, number in numbers(config))
    same = _drawn_from if fixed else eq
    found = dict.fromkeys(_without_effect(config))
    given = [(key, why) for key, why in found if not same(at(config, key), at(default, key))]
    return [f"{key} has no effect with {why}" for key, why in given]


def _without_effect(config: Config) -> Iterator[tuple[str, str]]:
    """(key, reason) of every key that has none."""
    sections = dict(of_kind(Config, Needs))
    if config.people:  # who shadow each other, whatever they are made of
        del sections["body.shadowing"]
    for key, needed in sections.items():
        whole = sections.get(key.rpartition(".")[0])  # a section without effect is said once
        if whole is not None and at(config, whole.key) != whole.value:
            continue
        there = at(config, needed.key)
        if needed.value is GIVEN and there is None:
            yield key, f"{needed.key}: null; it needs one"
        elif needed.value is not GIVEN and there != needed.value:
            yield key, f"{_entry(config, needed.key)}; it needs {needed.key}: {needed.value}"
    for key, only in of_kind(Config, OnlyMaps):
        if not any(only.part in name for name in config.maps):
            yield key, _entry(config, "maps")
    if config.room.faces is None and (config.wall is None or config.wall.echoes == "none"):
        yield "radar.polarisation", "neither room.faces nor wall.echoes: exact"
    if config.snr_db is None or config.wall is None:
        yield "snr_reference", _entry(config, "snr_db" if config.snr_db is None else "wall")
    model = _entry(config, "motion.model")
    reasons = {"receiver": "receiver.noise_corner_hz: 0"} | dict.fromkeys(
        ("subject", "motion", "timing"), model
    )
    own = class_activities(config.classes) | {a.slug: a for a in config.chosen_activities}
    activities = ({a.slug: a for a in ACTIVITIES} | own).values()
    for key in (*(key for key, _ in numbers(config)), FALL):
        reason = reasons.get(key.partition(".")[0])
        if reason and not any(config.depends_on(activity, key) for activity in activities):
            yield key, reason


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


def _entry(config: Config, key: str) -> str:
    value = at(config, key)
    if isinstance(value, tuple):
        return f"{key}: [{', '.join(map(str, value))}]"
    return f"{key}: {'null' if value is None else value}"
