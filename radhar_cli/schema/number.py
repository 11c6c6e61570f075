"""A number of a scene: fixed, or drawn from a distribution.

Every form is read through its quantile function, so that one uniform variate per key decides the
draw: two distributions of a key give numbers of the same rank, sample by sample.
"""

from bisect import bisect_left, bisect_right
from collections.abc import Callable
from dataclasses import dataclass
from itertools import accumulate
from math import erfc, sqrt
from statistics import NormalDist
from typing import Annotated, Any, Self, TypeAlias

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Field,
    GetCoreSchemaHandler,
    GetJsonSchemaHandler,
    SerializerFunctionWrapHandler,
    TypeAdapter,
    model_serializer,
    model_validator,
)
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from radhar_cli.numerics.rounding import show_beside

MAX_NUMBER = 1e30
NORMAL_CUT = 6.0


def value_error(right: str) -> PydanticCustomError:
    """Make the error of a value that a validator refuses.

    Args:
        right: description of what would be right, "should be ..."; braces in it are kept.
    """
    return PydanticCustomError("wrong", "{what}", {"what": right})


def require(hold: Callable[[Any], bool], right: str) -> AfterValidator:
    """Annotation of a value that is refused unless a condition holds; null is accepted.

    Args:
        hold: the condition.
        right: the message, which says what would be right.
    """

    def check(value: Any) -> Any:
        if value is not None and not hold(value):
            raise value_error(right)
        return value

    return AfterValidator(check)


_FINITE = require(
    lambda value: abs(value) <= MAX_NUMBER, "should be a finite number of at most 1e30 in size"
)
Real = Annotated[float, Field(strict=True, allow_inf_nan=False), _FINITE]


class Distribution(BaseModel):
    """Distribution of a number; the classes below are the forms that a config may have."""

    model_config = ConfigDict(extra="forbid", frozen=True)

    @property
    def support(self) -> tuple[float, float]:
        """Smallest and largest value that can be drawn."""
        raise NotImplementedError

    @property
    def nominal(self) -> float:
        """Middle of the distribution, which nominal scenes have."""
        raise NotImplementedError

    def quantile(self, u: float) -> float:
        """Value below which a fraction u, 0 to 1, of the draws lie; uniform unless overridden."""
        low, high = self.support
        return min(low + (high - low) * u, high)


class Uniform(Distribution):
    """``{uniform: [low, high]}``: any value between the two, equally likely."""

    uniform: tuple[Real, Real]

    @model_validator(mode="after")
    def _require_order(self) -> "Uniform":
        if self.uniform[0] > self.uniform[1]:
            raise value_error("should be {uniform: [low, high]} with low <= high")
        return self

    @property
    def support(self) -> tuple[float, float]:
        return self.uniform

    @property
    def nominal(self) -> float:
        return 0.5 * (self.uniform[0] + self.uniform[1])


class Normal(Distribution):
    """``{normal: [mean, sd], min: a, max: b}``: Gaussian, cut at the bounds.

    Without a bound it is cut at 6 standard deviations.
    """

    normal: tuple[Real, Real]
    min: Real | None = None
    max: Real | None = None

    @model_validator(mode="after")
    def _require_sense(self) -> "Normal":
        if self.normal[1] < 0:
            raise value_error("should be {normal: [mean, sd]} with sd >= 0")
        low, high = self.support
        mean, sd = self.normal
        if not low <= high or low > mean + NORMAL_CUT * sd or high < mean - NORMAL_CUT * sd:
            raise value_error(
                "should have min <= max, both within 6 standard deviations of the mean"
            )
        return self

    @property
    def support(self) -> tuple[float, float]:
        mean, sd = self.normal
        low = mean - NORMAL_CUT * sd if self.min is None else self.min
        high = mean + NORMAL_CUT * sd if self.max is None else self.max
        return low, high

    @property
    def nominal(self) -> float:
        low, high = self.support
        return min(max(self.normal[0], low), high)

    def quantile(self, u: float) -> float:
        mean, sd = self.normal
        low, high = self.support
        if sd == 0:
            return self.nominal
        a, b = (low - mean) / sd, (high - mean) / sd
        side = -1 if a > 0 else 1  # keep the precision of the far upper tail
        start, end = (0.5 * erfc(-side * z / sqrt(2)) for z in (a, b))
        p = start + (end - start) * u
        z = side * NormalDist().inv_cdf(p) if 0 < p < 1 else b if u > 0.5 else a
        return min(max(mean + sd * z, low), high)


class Vary(Distribution):
    """``{vary: [nominal, fraction]}``: uniform within plus or minus a fraction of the nominal."""

    vary: tuple[Real, Real]

    @model_validator(mode="after")
    def _require_sense(self) -> "Vary":
        if not 0 <= self.vary[1] <= 1:
            raise value_error("should be {vary: [nominal, fraction]} with a fraction from 0 to 1")
        return self

    @property
    def support(self) -> tuple[float, float]:
        half = abs(self.vary[0]) * self.vary[1]
        return self.vary[0] - half, self.vary[0] + half

    @property
    def nominal(self) -> float:
        return self.vary[0]


def _part_of_choice(value: Any) -> Any:
    """Validate what a choice chooses from: a number, or another form of a distribution."""
    if isinstance(value, Choice) or (isinstance(value, dict) and "choice" in value):
        raise value_error("should choose from numbers and other distributions, not from a choice")
    if isinstance(value, (dict, Distribution)):
        return _number(value)
    return _FIXED.validate_python(value)


class _PartSchema:
    """Pydantic schema of what a choice chooses from."""

    def __get_pydantic_core_schema__(self, *_: object) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(_part_of_choice)

    def __get_pydantic_json_schema__(
        self, _: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        forms = [handler(kind.__pydantic_core_schema__) for kind in (Uniform, Normal, Vary)]
        return {"anyOf": [{"type": "number"}, *forms]}


class Weighted(BaseModel):
    """A choice among values, equally likely or as ``weights: [3, 2, 1]`` say."""

    choice: tuple[Any, ...]
    weights: tuple[Real, ...] | None = None

    @model_validator(mode="after")
    def _require_values(self) -> Self:
        if not self.choice:  # Field(min_length=1) also complains where all values are wrong
            raise value_error("should be {choice: [a, b, ...]} with 1 value or more")
        weights = self.weights
        if weights is not None and (
            len(weights) != len(self.choice) or min(weights) < 0 or max(weights) == 0
        ):
            raise value_error(
                "should be {choice: [a, b, ...], weights: [...]} with a weight of 0 or more for "
                "each value, and one above 0"
            )
        return self

    @model_serializer(mode="wrap")
    def _leave_out_equal_weights(self, handler: SerializerFunctionWrapHandler) -> dict[str, Any]:
        """Leave out weights that were not given, as files have always had it."""
        written: dict[str, Any] = handler(self)
        if self.weights is None:
            written.pop("weights", None)
        return written


class Choice(Weighted, Distribution):
    """``{choice: [a, b, c]}``: one of the values, equally likely, or as ``weights: [3, 2, 1]`` say.

    Some of them, or all, may be distributions: ``{choice: [{uniform: [-30, 30]}, 180]}``. The
    nominal value is then that of the first one.
    """

    choice: tuple[Annotated[float | Uniform | Normal | Vary, _PartSchema()], ...]

    @property
    def support(self) -> tuple[float, float]:
        ends = [support(part) for part in self.choice]
        return min(low for low, _ in ends), max(high for _, high in ends)

    @property
    def nominal(self) -> float:
        if any(isinstance(part, Distribution) for part in self.choice):
            return nominal(self.choice[0])
        return nominal(self._ordered[bisect_left(self._ends, 0.5)])

    @property
    def _ordered(self) -> tuple[float | Uniform | Normal | Vary, ...]:
        """The values and distributions by their middle, whichever was written first."""
        return tuple(sorted(self.choice, key=nominal))

    @property
    def _ends(self) -> list[float]:
        """Share of the draws that are of each of `_ordered` or of one before it."""
        weights = self.weights or (1.0,) * len(self.choice)
        by_middle = sorted(range(len(weights)), key=lambda number: nominal(self.choice[number]))
        sums = [*accumulate(weights[number] for number in by_middle)]
        return [part / sums[-1] for part in sums]

    def quantile(self, u: float) -> float:
        """Value of the part in which u lies, at its place there; parts are ordered by middle."""
        if self.weights is None:
            place = u * len(self.choice)
            number = min(int(place), len(self.choice) - 1)
            return quantile(self._ordered[number], min(place - number, 1.0))
        ends = self._ends
        number = min(bisect_right(ends, u), bisect_left(ends, 1.0))
        start = ends[number - 1] if number else 0.0
        return quantile(self._ordered[number], min((u - start) / (ends[number] - start), 1.0))


def uniform(low: float, high: float) -> Uniform:
    """Make ``{uniform: [low, high]}``."""
    return Uniform(uniform=(low, high))


def normal(mean: float, sd: float, low: float, high: float) -> Normal:
    """Make ``{normal: [mean, sd], min: low, max: high}``."""
    return Normal(normal=(mean, sd), min=low, max=high)


def vary(middle: float, fraction: float) -> Vary:
    """Make ``{vary: [middle, fraction]}``."""
    return Vary(vary=(middle, fraction))


FORMS = {kind.__name__.lower(): kind for kind in (Uniform, Normal, Choice, Vary)}
_FIXED = TypeAdapter(Real).validator


def _number(value: Any) -> Any:
    """Validate a fixed number, or a mapping that names the form of a distribution."""
    if isinstance(value, Distribution):
        return value
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return _FIXED.validate_python(value)
    forms = [form for form in FORMS if form in value] if isinstance(value, dict) else []
    if len(forms) != 1:
        raise value_error(
            "should be a number or one of {uniform: [low, high]}, {normal: [mean, sd]}, "
            "{choice: [a, b, ...]}, {vary: [nominal, fraction]}"
        )
    kind: type[BaseModel] = FORMS[forms[0]]
    return kind.model_validate(value)


class _NumberSchema:
    """Pydantic schema of a number: one function, where a union would be built anew for each key."""

    def __get_pydantic_core_schema__(self, *_: object) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(_number)

    def __get_pydantic_json_schema__(
        self, _: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        forms = [handler(kind.__pydantic_core_schema__) for kind in FORMS.values()]
        return {"anyOf": [{"type": "number"}, *forms]}


Number: TypeAlias = Annotated[float | Uniform | Normal | Choice | Vary, _NumberSchema()]


def support(number: Number | None) -> tuple[float, float]:
    """Return the smallest and the largest value that a number can take; null is not accepted."""
    assert number is not None
    return (number, number) if isinstance(number, (int, float)) else number.support


def nominal(number: Number | None) -> float:
    """Return the middle of a number: itself, a mid-point, a mean, the middle choice.

    Null is not accepted.
    """
    assert number is not None
    return float(number) if isinstance(number, (int, float)) else number.nominal


def is_fixed(number: Number) -> bool:
    """Whether every draw of this number is the same."""
    low, high = support(number)
    return low == high


def quantile(number: Number, u: float) -> float:
    """Return the value below which a fraction u (0 to 1) of the draws lie."""
    return float(number) if isinstance(number, (int, float)) else number.quantile(u)


@dataclass(frozen=True)
class Bounds:
    """Annotation of a Number, or null, every draw of which must lie from low to high.

    Attributes:
        unit: unit that messages and docs/reference/limits.md give.
        wording: wording of messages instead of "from low to high unit".
        open_low: whether `low` itself is refused, too.
    """

    low: float
    high: float
    unit: str = ""
    wording: str = ""
    open_low: bool = False

    def __get_pydantic_core_schema__(
        self, source: object, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_after_validator_function(self, handler(source))

    def __call__(self, number: Number | None) -> Number | None:
        if number is None:
            return None
        smallest, largest = support(number)
        if smallest < self.low or largest > self.high or (self.open_low and smallest <= self.low):
            wording = self.wording or f"from {self.low:g} to {self.high:g} {self.unit}".rstrip()
            reach = (
                ""
                if smallest == largest
                else f" (this one reaches from {show_beside(smallest, self.low)} to "
                f"{show_beside(largest, self.high)})"
            )
            raise value_error(f"should be {wording}{reach}")
        return number


within = Bounds  # (low, high, unit)
POSITIVE = Bounds(0, MAX_NUMBER, wording="above 0", open_low=True)
NOT_NEGATIVE = Bounds(0, MAX_NUMBER, wording="0 or more")
AT_LEAST_ONE = Bounds(1, MAX_NUMBER, wording="1 or more")
ANGLE = within(-360, 360, "degrees")
DECIBEL = within(-300, 300, "dB")
COORDINATE = Bounds(-1e6, 1e6, "m", wording="within 1e6 m of the origin")

Positive: TypeAlias = Annotated[Number, POSITIVE]
NotNegative: TypeAlias = Annotated[Number, NOT_NEGATIVE]
AtLeastOne: TypeAlias = Annotated[Number, AT_LEAST_ONE]
Angle: TypeAlias = Annotated[Number, ANGLE]
Decibel: TypeAlias = Annotated[Number, DECIBEL]
Coordinate: TypeAlias = Annotated[Number, COORDINATE]
Vector = tuple[Coordinate, Coordinate, Coordinate]
METRES = within(0, 1, "m")
RATE = within(0, 20, "Hz")
RATIO = within(0, 10)
SIGNED = within(-1, 1)
SPEED = within(0, 1e4, "m/s")
FREQUENCY = within(0, 1e3, "Hz")
SECONDS = within(0, 1e7, "s")
Share = Annotated[float, Field(ge=0, le=1, strict=True)]
