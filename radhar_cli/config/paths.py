"""Dotted keys: their values in a config, and configs in which they are changed."""

from collections.abc import Callable, Mapping
from typing import Any, TypeVar, cast

from radhar_cli.schema.annotations import at as at
from radhar_cli.schema.section import Section

T = TypeVar("T")

# The keys of a config whose numbers may be drawn, scene by scene.
SCENE_KEYS = (
    "duration_s",
    "radar",
    "subject",
    "motion",
    "timing",
    "classes",
    "wall",
    "room",
    "snr_db",
    "receiver",
    "image.cfar",
)


def changed(value: T, parts: Mapping[str, Any]) -> T:
    """Copy a config, or part of one, with other values under some dotted keys.

    Args:
        value: a section, or a mapping or tuple inside of one; it stays as it is.
        parts: {dotted key as seen from there: new value}; new values are not validated.
    """
    inside = dict[str, dict[str, Any]]()
    for key, part in parts.items():
        name, _, rest = key.partition(".")
        inside.setdefault(name, {})[rest] = part

    def other(name: str, old: Any) -> Any:
        new = inside.get(name)
        return old if new is None else new[""] if "" in new else changed(old, new)

    copy: Any
    if isinstance(value, Section):
        copy = value.model_copy(update={n: other(n, getattr(value, n)) for n in inside})
    elif isinstance(value, dict):
        copy = {name: other(name, old) for name, old in value.items()}
    else:
        assert isinstance(value, tuple)
        copy = tuple(other(str(place), old) for place, old in enumerate(value))
    return cast(T, copy)


def each_number(value: Any, key: str, change: Callable[[str, Any], Any]) -> Any:
    """Copy a value of a config with another number in place of every one that may be drawn.

    Args:
        value: a section, mapping, tuple or number; whole numbers, texts and null stay.
        key: its dotted key.
        change: makes the new number, of (dotted key, number).
    """
    if value is None or isinstance(value, (int, str)):  # whole numbers are no quantities
        return value
    if isinstance(value, tuple):
        return tuple(each_number(one, f"{key}.{axis}", change) for axis, one in enumerate(value))
    if isinstance(value, dict):
        return {name: each_number(one, f"{key}.{name}", change) for name, one in value.items()}
    if isinstance(value, Section):
        fields = getattr(value, "NUMBERS", type(value).model_fields)
        return value.model_copy(
            update={
                name: each_number(getattr(value, name), f"{key}.{name}", change) for name in fields
            }
        )
    return change(key, value)


def numbers(config: Section) -> list[tuple[str, Any]]:
    """List all numbers of a config that may be drawn, as (dotted key, number or PerActivity).

    They are in the order of the schema. Vectors come as `radar.tx_m.0` and so on; keys that are
    null are left out.
    """
    drawable: list[tuple[str, Any]] = []

    def add(key: str, number: Any) -> Any:
        drawable.append((key, number))
        return number

    for key in SCENE_KEYS:
        each_number(at(config, key), key, add)
    return drawable
