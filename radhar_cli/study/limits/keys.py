"""Numbers of a config that may be drawn or set and that have an effect there."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

from pydantic import BaseModel

from radhar_cli.config.checks.people import HUMAN_LIMITS
from radhar_cli.config.data_set import Config
from radhar_cli.schema.annotations import OnlyMaps, annotations, at, conditions, of_kind
from radhar_cli.schema.number import MAX_NUMBER, Bounds, Distribution, nominal, support
from radhar_cli.schema.section import PerActivity, Section

# What counts, names or stores samples, and is of no sample.
NOT_OF_A_SAMPLE = ("seed", "samples_per_class", "stream.count", "split.", "output.", "recordings.")
OF_PEOPLE = ("subject.", "motion.", "timing.")
PEOPLE = "people"  # as a number: how many others are in the scene


@dataclass(frozen=True)
class NumberKey:
    """A number of a config."""

    key: str  # dotted key, `radar.tx_m.0` for one of a vector
    value: Any  # the number, distribution, or PerActivity of them, that the config has
    low: float  # least number that the schema accepts
    high: float  # largest number that the schema accepts
    unit: str = ""  # unit of both; "" where none is known
    is_whole: bool = False

    @property
    def section(self) -> str:
        """Section of the config that the key is in."""
        return self.key.partition(".")[0]

    @property
    def range(self) -> tuple[float, float]:
        """Least and largest number that the config has now."""
        ends = [support(number) for number in self._numbers]
        return min(low for low, _ in ends), max(high for _, high in ends)

    @property
    def middles(self) -> tuple[float, ...]:
        """Middles of what the config has now, the default's first."""
        return tuple(dict.fromkeys(nominal(number) for number in self._numbers))

    @property
    def _numbers(self) -> list[Any]:
        if not isinstance(self.value, PerActivity):
            return [self.value]
        numbers = self.value.per_activity
        listed = [number for number in numbers.values() if number is not None]
        return sorted(listed, key=lambda number: number is not numbers.get("default"))


def acting_numbers(config: Config) -> list[NumberKey]:
    """Numbers of a config that have an effect on its samples, in the order of the schema."""
    numbers = list[NumberKey]()
    for key, value in _numbers_below(config, ""):
        if not key.startswith(NOT_OF_A_SAMPLE) and acts(config, key):
            numbers.append(_number_key(key, value, config.motion.model == "human"))
            if not numbers[-1]._numbers:
                numbers.pop()
    if config.motion.model == "human" and config.stream is None:
        numbers.append(NumberKey(PEOPLE, len(config.people), 0, 10, is_whole=True))
    return numbers


def _numbers_below(value: Any, key: str) -> Iterator[tuple[str, Any]]:
    """(dotted key, number) of everything below a part of a config that is a number."""
    if isinstance(value, Section):
        names = getattr(value, "NUMBERS", type(value).model_fields)
        for name in names:
            yield from _numbers_below(getattr(value, name), f"{key}.{name}" if key else name)
    elif isinstance(value, tuple):
        for place, part in enumerate(value):
            yield from _numbers_below(part, f"{key}.{place}")
    elif isinstance(value, (int, float, Distribution, PerActivity)) and not isinstance(value, bool):
        yield key, value


def acts(config: Config, key: str) -> bool:
    """Whether a number has an effect on the samples of a config, as its annotations say it."""
    if key.startswith(f"{PEOPLE}."):
        if not _is_written(config, key):
            return False
        _, number, inner = key.split(".", 2)
        person, activities = (
            config.of_person(int(number) + 1),
            config.activities_of(int(number) + 1),
        )
        return not inner.startswith(OF_PEOPLE) or any(
            person.depends_on(activity, inner) for activity in activities
        )
    plain = _without_places(key)
    if not all(condition.holds(partial(at, config)) for condition in conditions(Config, plain)):
        return False
    for section, only in of_kind(Config, OnlyMaps):
        if f"{plain}.".startswith(f"{section}.") and not set(only.names) & set(config.maps):
            return False
    return not key.startswith(OF_PEOPLE) or any(
        config.depends_on(activity, key) for activity in config.chosen_activities
    )


def _is_written(config: Config, key: str) -> bool:
    """Whether a number stands in the file, so that it is not the default, or another person's."""
    holder, _, name = key.rpartition(".")
    return name in at(config, holder).model_fields_set


def _without_places(key: str) -> str:
    return ".".join(name for name in key.split(".") if not name.isdecimal())


def _number_key(key: str, value: Any, is_human: bool) -> NumberKey:
    """Find the bounds of a number in the schema, those of people's motion included."""
    plain = _without_places(key).removeprefix(f"{PEOPLE}.")
    low, high, unit = -MAX_NUMBER, MAX_NUMBER, ""
    if is_human or key.startswith(f"{PEOPLE}."):
        low, high = HUMAN_LIMITS.get(plain, (low, high))
    for annotation in annotations(Config).get(plain, ()):
        if isinstance(annotation, Bounds):
            low, high = max(low, annotation.low), min(high, annotation.high)
            unit = annotation.unit or unit
        for name in ("ge", "gt"):
            if (bound := getattr(annotation, name, None)) is not None:
                low = max(low, bound)
        for name in ("le", "lt"):
            if (bound := getattr(annotation, name, None)) is not None:
                high = min(high, bound)
    return NumberKey(key, value, low, high, unit, isinstance(value, int))


def with_number(
    values: Mapping[str, Any], config: Config, key: str, number: float
) -> dict[str, Any]:
    """Plain values of a config with a number in place of a key's, whatever is drawn there.

    Args:
        values: plain values, which stay as they are.
        config: the config that they make.
        key: dotted key; that of one number of a vector changes it alone, `people` is their count.
        number: the number; a whole one where the config has such.
    """
    if key == PEOPLE:
        others = list(values.get(PEOPLE) or [])
        count = int(number)
        return {**values, PEOPLE: (others + [others[-1] if others else {}] * count)[:count]}
    holder, _, place = key.rpartition(".")
    now = at(config, key)
    new: Any = int(number) if isinstance(now, int) and number == int(number) else float(number)
    changed_key, part = key, new
    if place.isdecimal():
        vector = [_plain(one) for one in at(config, holder)]
        vector[int(place)] = new
        changed_key, part = holder, vector
    return dict[str, Any](_replaced(values, changed_key, part))


def _plain(value: Any) -> Any:
    return value.model_dump(exclude_none=True) if isinstance(value, BaseModel) else value


def _replaced(values: Any, key: str, new: Any) -> Any:
    """A copy of plain values with another one under a dotted key."""
    name, _, rest = key.partition(".")
    if isinstance(values, list):
        place = int(name)
        items = list(values)
        items[place] = _replaced(items[place], rest, new) if rest else new
        return items
    inner = dict(values) if isinstance(values, Mapping) else {}
    inner[name] = _replaced(inner.get(name), rest, new) if rest else new
    return inner
