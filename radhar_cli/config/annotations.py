"""What is said of a key beside its type and bounds, as annotations of its field in the schema.

Checks, draws, warnings and the tables of docs/reference are made of them.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from enum import Enum
from functools import cache
from types import MappingProxyType
from typing import Any, Literal, TypeVar, get_args, get_origin

from pydantic import BaseModel
from pydantic.fields import FieldInfo

from radhar_cli.config.number import MAX_NUMBER

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


GIVEN = object()


@dataclass(frozen=True)
class Needs:
    """The key has an effect only where another one has this value, or any (GIVEN)."""

    key: str
    value: object


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
