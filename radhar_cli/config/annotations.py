"""What is said of a key beside its type and bounds, as annotations of its field in the schema.

Checks, draws, warnings and the tables of docs/reference are made of them.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cache
from types import MappingProxyType
from typing import Any, Literal, TypeAlias, TypeVar, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from radhar_cli.config.number import MAX_NUMBER, Bounds, support

A = TypeVar("A")


class Mark(Enum):
    """PERSONAL numbers stay with a person whatever they do: they are drawn once a subject.

    UNSTEADY ones are sizes of what is not repeated exactly; they are 0 in nominal scenes.
    """

    PERSONAL = "drawn once a person"
    UNSTEADY = "0 in nominal scenes"


PERSONAL, UNSTEADY = Mark


@dataclass(frozen=True)
class Limits:
    """Bounds of every draw of a number under motion.model: human."""

    low: float
    high: float


@dataclass(frozen=True)
class People:
    """Movements, or S labels of classes, that use a number under motion.model: human; "": all.

    Other models make no use of it. Every draw lies from low to high.
    """

    names: str
    low: float = -MAX_NUMBER
    high: float = MAX_NUMBER


@dataclass(frozen=True)
class Paper:
    """S labels of the classes that use a number under motion.model: paper."""

    names: str


class Something(Enum):
    """What a key has to say for another one to act, where no single value is meant."""

    GIVEN = "one"
    ABOVE_ZERO = "a number above 0"


GIVEN, ABOVE_ZERO = Something
ValueAt: TypeAlias = Callable[[str], Any]  # what stands under a dotted key of a config


@dataclass(frozen=True)
class ActsIf:
    """The key acts only where another one has one of some values; all such annotations hold."""

    key: str
    values: tuple[object, ...]

    def __init__(self, key: str, *values: object) -> None:
        object.__setattr__(self, "key", key)
        object.__setattr__(self, "values", values)

    def holds(self, value_at: ValueAt) -> bool:
        """Whether the other key says so."""
        value = value_at(self.key)
        if GIVEN in self.values:
            return value not in (None, (), {})
        if ABOVE_ZERO in self.values:
            return value is not None and support(value)[1] > 0
        return value in self.values

    def entry(self, value_at: ValueAt) -> str:
        """What the other key says now."""
        return entry(self.key, value_at(self.key))

    @property
    def right(self) -> str:
        """What it should say."""
        if GIVEN in self.values:
            return f"{self.key}"
        if ABOVE_ZERO in self.values:
            return f"{self.key} above 0"
        return f"{self.key}: {' or '.join(map(value_text, self.values))}"


@dataclass(frozen=True)
class ActsIfAny:
    """The key acts only where one or more of these hold."""

    choices: tuple[ActsIf, ...]

    def __init__(self, *choices: ActsIf) -> None:
        object.__setattr__(self, "choices", choices)

    def holds(self, value_at: ValueAt) -> bool:
        """Whether one of them does."""
        return any(one.holds(value_at) for one in self.choices)

    def entry(self, value_at: ValueAt) -> str:
        """What their keys say now."""
        return ", ".join(dict.fromkeys(one.entry(value_at) for one in self.choices))

    @property
    def right(self) -> str:
        """What they should say."""
        return " or ".join(one.right for one in self.choices)


def entry(key: str, value: object) -> str:
    """A key and its value as a config has them; of long texts and of sections the key alone."""
    if isinstance(value, BaseModel) or (isinstance(value, str) and "\n" in value):
        return key
    return f"{key}: {value_text(value)}"


def value_text(value: object) -> str:
    """A value as YAML has it."""
    if isinstance(value, tuple):
        return f"[{', '.join(map(value_text, value))}]"
    if value is None or isinstance(value, bool):
        return {None: "null", True: "true", False: "false"}[value]
    if isinstance(value, BaseModel):
        value = value.model_dump(exclude_none=True)
    elif hasattr(value, "per_activity"):
        value = {"per_activity": value.per_activity}
    if isinstance(value, dict):
        inner = (f"{key}: {value_text(one)}" for key, one in value.items())
        return "{" + ", ".join(inner) + "}"
    return str(value)


@dataclass(frozen=True)
class OnlyMaps:
    """The key has an effect only on maps whose names contain this."""

    part: str


class ByModel:
    """What a null key stands for, by model of motion."""

    def __init__(self, **values: Any) -> None:
        self.values = values


@cache
def annotations(kind: type[BaseModel], prefix: str = "") -> Mapping[str, tuple[Any, ...]]:
    """{dotted key: annotations}, sections before what is in them, in the order of the schema."""
    found = dict[str, tuple[Any, ...]]()
    for name, field in kind.model_fields.items():
        found[prefix + name] = tuple(_flat(field))
        inner = section(field)
        if inner is not None and not getattr(inner, "REPEATS", False):
            found |= annotations(inner, f"{prefix}{name}.")
    return MappingProxyType(found)


@cache
def of_kind(kind: type[BaseModel], wanted: type[A]) -> tuple[tuple[str, A], ...]:
    """(dotted key, annotation) of all annotations of a class."""
    return tuple(
        (key, one)
        for key, found in annotations(kind).items()
        for one in found
        if isinstance(one, wanted)
    )


@cache
def conditions(kind: type[BaseModel], key: str) -> tuple[ActsIf | ActsIfAny, ...]:
    """What has to hold for a dotted key to act, of the sections that it lies in first.

    `radar.tx_m.0` is one of the numbers of `radar.tx_m`.
    """
    known, names, found = annotations(kind), key.split("."), list[ActsIf | ActsIfAny]()
    for count in range(1, len(names) + 1):
        about = known.get(".".join(names[:count]), ())
        found += [one for one in about if isinstance(one, ActsIf | ActsIfAny)]
    return tuple(found)


def at(config: BaseModel, key: str) -> Any:
    """What stands under a dotted key, such as `radar.tx_m.0`; None under what is null."""
    place: Any = config
    for name in key.split("."):
        if isinstance(place, tuple):
            place = place[int(name)]
        elif isinstance(place, dict):
            place = place[name]
        elif place is not None:
            place = getattr(place, name)
    return place


def range_of(kind: type[BaseModel], key: str) -> str:
    """From where to where a key's numbers may go, in words; "" where nothing says so."""
    low, high, unit = -MAX_NUMBER, MAX_NUMBER, ""
    for one in annotations(kind).get(key, ()):
        if isinstance(one, Bounds):
            low, high, unit = max(low, one.low), min(high, one.high), one.unit or unit
        for name in ("ge", "gt"):
            low = max(low, getattr(one, name, None) or low)
        for name in ("le", "lt"):
            high = min(high, getattr(one, name, high))
    if low <= -MAX_NUMBER or high >= MAX_NUMBER:
        return ""
    return f"from {low:g} to {high:g} {unit}".rstrip()


def section(field: FieldInfo) -> type[BaseModel] | None:
    """The section that a field holds, maybe instead of null; None of values, lists, mappings."""
    kinds = [field.annotation, *get_args(field.annotation)]
    if any(get_origin(kind) is Literal for kind in kinds):  # a value, or drawn
        return None
    found = (k for k in kinds if isinstance(k, type) and issubclass(k, BaseModel))
    return next((k for k in found if not k.__module__.endswith(".number")), None)


def _flat(about: Any) -> Iterator[Any]:
    """Annotations of a field, those inside of unions with null included."""
    for one in about.metadata if isinstance(about, FieldInfo) else about.__metadata__:
        yield from one.metadata if isinstance(one, FieldInfo) else (one,)
    inner = about.annotation if isinstance(about, FieldInfo) else about.__origin__
    for one in (inner, *get_args(inner)):
        if hasattr(one, "__metadata__"):
            yield from _flat(one)
