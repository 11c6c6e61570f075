"""Dotted keys: what stands under them in a config, and configs in which they are changed."""

from collections.abc import Callable, Mapping
from typing import Any, TypeVar, cast

from radhar_cli.config.annotations import at as at
from radhar_cli.config.schema import Section

T = TypeVar("T")


def changed(value: T, parts: Mapping[str, Any]) -> T:
    """A config, or part of one, with other values under some of the dotted keys inside it."""
    inside = dict[str, dict[str, Any]]()
    for key, part in parts.items():
        name, _, rest = key.partition(".")
        inside.setdefault(name, {})[rest] = part

    def other(name: str, old: Any) -> Any:
        new = inside.get(name)
        return old if new is None else new[""] if "" in new else changed(old, new)

    found: Any
    if isinstance(value, Section):
        found = value.model_copy(update={n: other(n, getattr(value, n)) for n in inside})
    elif isinstance(value, dict):
        found = {name: other(name, old) for name, old in value.items()}
    else:
        assert isinstance(value, tuple)
        found = tuple(other(str(place), old) for place, old in enumerate(value))
    return cast(T, found)


def each_number(value: Any, key: str, change: Callable[[str, Any], Any]) -> Any:
    """A value of a config with change(dotted key, number) in place of every number."""
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
