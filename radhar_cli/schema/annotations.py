"""Annotations of config keys: where they act, whose they are, the limits of people.

Checks, draws, warnings and the tables of docs/reference are made of them.
"""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cache
from types import MappingProxyType
from typing import Any, Literal, TypeAlias, TypeGuard, TypeVar, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from radhar_cli.schema.number import MAX_NUMBER, Bounds, support

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

    Other models make no use of it. Every draw lies from low to high. Names are None for a key that
    movements of several files share: each says so itself (`MovementKind.uses`).
    """

    names: str | None
    low: float = -MAX_NUMBER
    high: float = MAX_NUMBER


@dataclass(frozen=True)
class Paper:
    """S labels of the classes that use a number under motion.model: paper."""

    names: str


class Presence(Enum):
    """Condition on another key that holds for more than single values."""

    GIVEN = "one"
    ABOVE_ZERO = "a number above 0"


GIVEN, ABOVE_ZERO = Presence
ValueAt: TypeAlias = Callable[[str], Any]  # what stands under a dotted key of a config


@dataclass(frozen=True)
class NeedsKey:
    """The key acts only where another one has one of some values; all such annotations hold."""

    key: str
    values: tuple[object, ...]

    def __init__(self, key: str, *values: object) -> None:
        object.__setattr__(self, "key", key)
        object.__setattr__(self, "values", values)

    def holds(self, value_at: ValueAt) -> bool:
        """Whether the other key has one of the values.

        Args:
            value_at: returns the value under a dotted key of a config.
        """
        value = value_at(self.key)
        if GIVEN in self.values:
            return value not in (None, (), {})
        if ABOVE_ZERO in self.values:
            forms = getattr(value, "per_activity", {"": value}).values()
            return any(one is not None and support(one)[1] > 0 for one in forms)
        return value in self.values

    def entry(self, value_at: ValueAt) -> str:
        """The other key and its present value, as YAML."""
        return entry(self.key, value_at(self.key))

    @property
    def right(self) -> str:
        """The other key and the values under which this one would act, in words."""
        if GIVEN in self.values:
            return f"{self.key}"
        if ABOVE_ZERO in self.values:
            return f"{self.key} above 0"
        return f"{self.key}: {' or '.join(map(value_text, self.values))}"


@dataclass(frozen=True)
class NeedsAnyKey:
    """The key acts only where one or more of these hold."""

    choices: tuple[NeedsKey, ...]

    def __init__(self, *choices: NeedsKey) -> None:
        object.__setattr__(self, "choices", choices)

    def holds(self, value_at: ValueAt) -> bool:
        """Whether one of the conditions holds."""
        return any(one.holds(value_at) for one in self.choices)

    def entry(self, value_at: ValueAt) -> str:
        """Keys of the conditions with their present values, as YAML."""
        return ", ".join(dict.fromkeys(one.entry(value_at) for one in self.choices))

    @property
    def right(self) -> str:
        """Keys and values under which this one would act, in words."""
        return " or ".join(one.right for one in self.choices)


@dataclass(frozen=True)
class Unless:
    """The key acts unless a property of a section holds, which is called by these words."""

    key: str
    words: str

    def holds(self, value_at: ValueAt) -> bool:
        """Whether the property does not hold."""
        return not value_at(self.key)

    def entry(self, value_at: ValueAt) -> str:
        """Return the words for the property that holds."""
        return self.words

    @property
    def right(self) -> str:
        """Words for the remedy: none of it."""
        return "none"


@dataclass(frozen=True)
class NeedsNullKey:
    """The key acts only where another one is null, for some activities at least."""

    key: str

    def holds(self, value_at: ValueAt) -> bool:
        """Whether the other key is null for an activity."""
        value = value_at(self.key)
        return value is None or "default" not in getattr(value, "per_activity", {"default": value})

    def entry(self, value_at: ValueAt) -> str:
        """The other key and its present value, as YAML."""
        return entry(self.key, value_at(self.key))

    @property
    def right(self) -> str:
        """Value that the other key should have, in words."""
        return f"{self.key}: null"


# {kind of a radar with frames: the key that tells it}
_KEYS_OF_FRAMES = {
    "board": "radar.cfg",
    **dict.fromkeys(("frames", "sfcw_frames", "cw_frames"), "radar.frame"),
}


@dataclass(frozen=True)
class OfRadar:
    """The key acts only with radars of some kinds."""

    kinds: tuple[str, ...]

    def __init__(self, *kinds: str) -> None:
        object.__setattr__(self, "kinds", kinds)

    def holds(self, value_at: ValueAt) -> bool:
        """Whether the radar is of one of the kinds."""
        return value_at("radar.kind") in self.kinds

    def entry(self, value_at: ValueAt) -> str:
        """Return the name of the radar's kind."""
        return str(value_at("radar.named"))

    @property
    def right(self) -> str:
        """Keys that choose one of the kinds, in words."""
        waveforms = [kind for kind in self.kinds if kind not in _KEYS_OF_FRAMES]
        words = [f"radar.waveform: {' or '.join(waveforms)}"] if waveforms else []
        words += [_KEYS_OF_FRAMES[kind] for kind in self.kinds if kind in _KEYS_OF_FRAMES]
        return " or ".join(dict.fromkeys(words))


Condition: TypeAlias = NeedsKey | NeedsAnyKey | NeedsNullKey | Unless | OfRadar


def entry(key: str, value: object) -> str:
    """A key and its value as YAML, `maps: [rtm]`; the key alone for sections and long texts."""
    if isinstance(value, BaseModel) or (isinstance(value, str) and "\n" in value):
        return key
    return f"{key}: {value_text(value)}"


def value_text(value: object) -> str:
    """A value as YAML in one line."""
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
    """The key has an effect on the maps of these names only."""

    names: tuple[str, ...]


class ByModel:
    """Default of a key that is null, by model of motion.

    Args:
        values: {model: default}, as `human=..., paper=...`.
    """

    def __init__(self, **values: Any) -> None:
        self.values = values


@cache
def annotations(kind: type[BaseModel], prefix: str = "") -> Mapping[str, tuple[Any, ...]]:
    """Annotations of every key below a section, {dotted key: annotations}.

    Sections come before what is in them, in the order of the schema; those that repeat (`people`)
    are not entered.

    Args:
        kind: the section, or root of a config.
        prefix: dotted key of the section, with its last dot; "" for a root.
    """
    by_key = dict[str, tuple[Any, ...]]()
    for name, field in kind.model_fields.items():
        by_key[prefix + name] = tuple(_flat(field))
        for inner in sections(field):
            if not getattr(inner, "REPEATS", False):
                about = annotations(inner, f"{prefix}{name}.")
                by_key |= {key: about[key] for key in about if key not in by_key}
    return MappingProxyType(by_key)


@cache
def of_kind(kind: type[BaseModel], wanted: type[A]) -> tuple[tuple[str, A], ...]:
    """Annotations of one class below a section, as (dotted key, annotation)."""
    return tuple(
        (key, one)
        for key, found in annotations(kind).items()
        for one in found
        if isinstance(one, wanted)
    )


@cache
def conditions(kind: type[BaseModel], key: str) -> tuple[Condition, ...]:
    """Conditions under which a dotted key acts, those of the sections around it first.

    `radar.tx_m.0` is one of the numbers of `radar.tx_m`.
    """
    known, names, unmet = annotations(kind), key.split("."), list[Condition]()
    for count in range(1, len(names) + 1):
        about = known.get(".".join(names[:count]), ())
        unmet += [one for one in about if isinstance(one, Condition)]
    return tuple(unmet)


def at(config: BaseModel, key: str) -> Any:
    """Value under a dotted key, such as `radar.tx_m.0`; None below what is null, or a word.

    Raises:
        AttributeError, KeyError, IndexError: the config has no such key.
    """
    place: Any = config
    for name in key.split("."):
        if isinstance(place, tuple):
            place = place[int(name)]
        elif isinstance(place, dict):
            place = place[name]
        elif isinstance(place, str):  # a word in the place of a section
            place = None
        elif place is not None:
            place = None if _is_of_alternative(place, name) else getattr(place, name)
    return place


def _is_of_alternative(section: Any, name: str) -> bool:
    """Whether not this section but another that may stand in its place has a key."""
    others = getattr(section, "ALTERNATIVES", ())
    return not hasattr(section, name) and any(name in other.model_fields for other in others)


def range_of(kind: type[BaseModel], key: str) -> str:
    """Bounds of the numbers of a key, in words: "from 0 to 5 m"; "" where a bound is missing.

    Args:
        kind: root of the config.
        key: dotted key, without places in lists.
    """
    low, high, unit = -MAX_NUMBER, MAX_NUMBER, ""
    for annotation in annotations(kind).get(key, ()):
        if isinstance(annotation, Bounds):
            low, high, unit = (
                max(low, annotation.low),
                min(high, annotation.high),
                annotation.unit or unit,
            )
        for name in ("ge", "gt"):
            low = max(low, getattr(annotation, name, None) or low)
        for name in ("le", "lt"):
            high = min(high, getattr(annotation, name, high))
    if low <= -MAX_NUMBER or high >= MAX_NUMBER:
        return ""
    return f"from {low:g} to {high:g} {unit}".rstrip()


def sections(field: FieldInfo) -> tuple[type[BaseModel], ...]:
    """Sections of which a field holds one, maybe instead of null; none of other fields."""
    kinds = [field.annotation, *get_args(field.annotation)]
    if any(get_origin(kind) is Literal for kind in kinds):  # a value, or drawn
        return ()
    members = [getattr(kind, "__origin__", None) for kind in get_args(field.annotation)]
    alternatives = [kind for kind in members if _is_section(kind)]
    if alternatives and len(alternatives) == len(members):
        return (*alternatives,)
    return (*[kind for kind in kinds if _is_section(kind)][:1],)


def section(field: FieldInfo) -> type[BaseModel] | None:
    """The section that a field holds by default, maybe instead of null; None of other fields."""
    return next(iter(sections(field)), None)


def _is_section(kind: Any) -> TypeGuard[type[BaseModel]]:
    is_model = isinstance(kind, type) and issubclass(kind, BaseModel)
    return is_model and not kind.__module__.endswith(".number")


def _flat(about: Any) -> Iterator[Any]:
    """Annotations of a field, those inside of unions with null included."""
    for annotation in about.metadata if isinstance(about, FieldInfo) else about.__metadata__:
        inner = (
            annotation.metadata
            if isinstance(annotation, FieldInfo)
            else getattr(annotation, "bounds", (annotation,))
        )
        yield from inner
    inner = about.annotation if isinstance(about, FieldInfo) else about.__origin__
    for annotation in (inner, *get_args(inner)):
        if hasattr(annotation, "__metadata__"):
            yield from _flat(annotation)
