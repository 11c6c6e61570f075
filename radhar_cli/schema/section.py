"""A section of a config, a number that differs by activity, and a mistake across keys.

Sections with numbers are generic over what a number is, for the type checker alone: in a config a
law of draws, in a scene a float (`WallConfig`, `WallConfig[float]`). At run time both are one
class, as generic models of pydantic cost 60 to 150 ms at every start.
"""

import ast
import inspect
from dataclasses import dataclass
from itertools import pairwise
from textwrap import dedent
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Generic, NamedTuple, Protocol, TypeAlias

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    GetCoreSchemaHandler,
    Tag,
)
from pydantic_core import CoreSchema
from typing_extensions import TypeVar

from radhar_cli.schema.number import COORDINATE, Bounds, Number, value_error
from radhar_cli.schema.twelve import DEFAULT, TWELVE

Flag: TypeAlias = Annotated[bool, Field(strict=True)]
T = TypeVar("T")
N = TypeVar("N", default=Number)  # what a number of a section is: a law of draws, or a float

VectorOf: TypeAlias = tuple[
    Annotated[N, COORDINATE], Annotated[N, COORDINATE], Annotated[N, COORDINATE]
]

if TYPE_CHECKING:
    Filled: TypeAlias = Annotated[T, "null in a file; filled in by the model of motion"]
else:

    class Filled:
        """`Filled[N]` may be null in a file, where a default by model takes its place."""

        def __class_getitem__(cls, kind: Any) -> Any:
            """Return the type of the file."""
            return kind | None


def default_draw(number: Any) -> Any:
    """Return the default of a number: Any, as its field takes what its section is generic over."""
    return number


class Section(BaseModel):
    """Base of all config models."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        validate_default=True,
        allow_inf_nan=False,
        defer_build=True,  # a validator is built for the section that is validated, and no other
    )
    ALTERNATIVES: ClassVar[tuple[type["Section"], ...]] = ()  # sections that may stand in its place

    if not TYPE_CHECKING:

        def __class_getitem__(cls, number: Any) -> Any:
            """Return the class itself: one model at run time, several types for the checker."""
            return cls

    @classmethod
    def descriptions(cls) -> dict[str, str]:
        """Read the texts below the fields in the source, as Pydantic would do at every start."""
        texts: dict[str, str] = {}
        for kind in reversed(cls.__mro__):
            if kind is not Section and issubclass(kind, Section):
                texts |= _texts_below_fields(kind)
        return texts


S = TypeVar("S", bound=Section)


def defaults_of(kind: type[S]) -> S:
    """Return a section with its defaults, for the default of a field.

    It is not validated: pydantic would build a validator for each section when it is imported,
    which doubles the time to start. A test compares it with one that is.
    """
    return kind.model_construct()


def _texts_below_fields(kind: type[Section]) -> dict[str, str]:
    """{field: text below it in the source} of the fields that a class itself defines."""
    body = ast.parse(dedent(inspect.getsource(kind))).body[0]
    assert isinstance(body, ast.ClassDef)
    return {
        ast.unparse(field.target): inspect.cleandoc(text.value.value)
        for field, text in pairwise(body.body)
        if isinstance(field, ast.AnnAssign)
        and isinstance(text, ast.Expr)
        and isinstance(text.value, ast.Constant)
        and isinstance(text.value.value, str)
    }


def _by_slug(value: dict[str, Any]) -> dict[str, Any]:
    numbers = dict[str, Any]()
    for name, number in value.items():
        slug = TWELVE.get(name.strip().lower(), name)
        if slug in numbers:
            raise value_error(f"should name {slug} once")
        numbers[slug] = number
    if not numbers:
        raise value_error("should name one activity or more, or `default`")
    return numbers


@dataclass(frozen=True)
class PerActivity(Generic[T]):
    """``{per_activity: {default: 2.0, walking: 1.0, S9: 1.0}}``: a number by activity.

    Without a default, the activities that are not named keep that of the key, or of its model.
    Names that are none of the twelve's are a config's own classes, which `Config` knows.
    """

    per_activity: Annotated[dict[str, T], AfterValidator(_by_slug)]

    __pydantic_config__ = ConfigDict(extra="forbid")


def _kind(value: Any) -> str:
    several = "per_activity" in value if isinstance(value, dict) else isinstance(value, PerActivity)
    return "<per_activity>" if several else "<same>"


# A number that may also differ by activity.
By: TypeAlias = Annotated[
    Annotated[T, Tag("<same>")] | Annotated[PerActivity[T], Tag("<per_activity>")],
    Discriminator(_kind),
]


B = TypeVar("B", default=By[Number])  # what such a number is: a law by activity, or a float


@dataclass(frozen=True)
class ByActivity:
    """Annotation of a number that may differ by activity, and lies within bounds for each.

    Attributes:
        bounds: Bounds of every draw.
        null: Whether it may be null in a file.
    """

    bounds: tuple[Bounds, ...]
    null: bool = False

    def __init__(self, *bounds: Bounds, null: bool = False) -> None:
        object.__setattr__(self, "bounds", bounds)
        object.__setattr__(self, "null", null)

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        number: Any = By[Annotated[(Number, *self.bounds)]]  # type: ignore[misc]
        return handler.generate_schema(number | None if self.null else number)


def by_activity(default: Number, **others: Number) -> PerActivity[Number]:
    """A number for every activity, and others for those named."""
    return PerActivity({DEFAULT: default, **others})


class ClassOfPeople(Protocol):
    """A class as numbers that differ by activity see it (`activities.activity.Activity`).

    Attributes:
        slug: Name of the class.
        movements: Movements that it consists of.
        is_movement: Whether it is one movement.
    """

    @property
    def slug(self) -> str: ...
    @property
    def movements(self) -> tuple[str, ...]: ...
    @property
    def is_movement(self) -> bool: ...


def for_activity(value: Any, activity: ClassOfPeople) -> Any:
    """Return the number that holds for one activity; None where it has none and no default."""
    if isinstance(value, PerActivity):
        numbers = value.per_activity
        names = activity.slug, *activity.movements[:1] * activity.is_movement, DEFAULT
        return next((numbers[name] for name in names if name in numbers), None)
    return value


class Problem(NamedTuple):
    """A mistake that spans several keys: dotted key, its value, and what would be right."""

    key: str
    value: object
    right: str
