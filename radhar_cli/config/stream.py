"""Long recordings of several activities one after the other: `stream` of a config."""

from bisect import bisect_right
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import accumulate
from typing import Annotated, Generic, Literal, Protocol, cast

from pydantic import Field, model_validator

from radhar_cli.config.classes import ClassConfig
from radhar_cli.config.sequence import MIN_MOVEMENT_S, Chance, SequenceConfig, SequenceStep
from radhar_cli.motion.activities.activity import Activity, first_states, state_after
from radhar_cli.motion.activities.links import links_between
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.schema.number import (
    NOT_NEGATIVE,
    RATIO,
    SECONDS,
    Number,
    Share,
    uniform,
    value_error,
    within,
)
from radhar_cli.schema.section import N, Section, default_draw, defaults_of

Metres = Annotated[float, Field(ge=-1000, le=1000, strict=True)]
MIN_ZONE_M = 2.5  # side of a zone, for each person: a walker turns within 1.5 m


class ZoneConfig(Section):
    """Part of the floor in which the torsos of people stay; with several people, a strip each."""

    range_m: tuple[Metres, Metres] = (2.0, 7.0)
    """Nearest and farthest place ahead of the radar."""
    cross_range_m: tuple[Metres, Metres] = (-2.5, 2.5)
    """Places farthest to the right and to the left."""

    @model_validator(mode="after")
    def _require_room(self) -> "ZoneConfig":
        for low, high in (self.range_m, self.cross_range_m):
            if high - low < MIN_ZONE_M:
                raise value_error(f"should have [from, to] at least {MIN_ZONE_M} m apart")
        return self

    def strips(self, count: int) -> list["ZoneConfig"]:
        """Strips for so many people, side by side along the longer side, 0.6 m apart."""
        sides = {"range_m": self.range_m, "cross_range_m": self.cross_range_m}
        key = max(sides, key=lambda name: sides[name][1] - sides[name][0])
        low, high = sides[key]
        width = (high - low - 0.6 * (count - 1)) / count
        starts = [low + number * (width + 0.6) for number in range(count)]
        return [self.model_copy(update={key: (start, start + width)}) for start in starts]


class StreamConfig(Section, Generic[N]):
    """Recordings of `duration_s` in which people do one of `activities` after the other.

    Before each bout there is a pause at rest, and links where states differ: people who lie get up
    before they walk.
    """

    count: Annotated[int, Field(ge=1, le=1_000_000, strict=True)] = 20
    """Number of recordings."""
    column_s: Annotated[float, Field(ge=1e-4, le=60, strict=True)] = 0.1
    """Time step of the columns of images, which decides their width; labels are by column."""
    order: Literal["drawn", "rounds"] = "drawn"
    """Order of the activities: drawn one by one, by their weights; or rounds, in each of which all
    come once, in an order that is drawn."""
    weights: dict[str, Annotated[float, Field(ge=0, le=1e6, strict=True)]] = {}
    """Weights of the activities that are drawn, {slug: weight}; others have 1."""
    bout_s: Annotated[N, within(0.3, 600, "s")] = default_draw(uniform(3.0, 8.0))
    """Duration of a bout of what goes on as long as it is asked for, such as walking; drawn anew
    for each bout, as the next three are."""
    pace: Annotated[N, within(0.5, 2), RATIO] = default_draw(uniform(0.85, 1.25))
    """Duration of what has a usual one, such as sitting down, relative to that."""
    pause_s: Annotated[N, NOT_NEGATIVE, SECONDS] = default_draw(uniform(0.0, 3.0))
    """Time at rest before a bout, and before the links that it needs."""
    turn_share: Share = 0.5
    """Share of the bouts from standing before which people turn to another direction; they always
    do where they would leave the zone."""
    zone: ZoneConfig = defaults_of(ZoneConfig)
    """Part of the floor in which people stay; motion.range_m and the like have no effect."""

    def columns_of(self, seconds: float) -> int:
        """Number of columns of an image of so many seconds."""
        return round(seconds / self.column_s)


# At rest in these states people do what these classes are: pauses are then labelled so.
STILL = {
    "standing": ("stationary", "standing"),
    "seated": ("sitting",),
    "lying": ("lying",),
    "in_bed": ("lying",),
    "kneeling": ("kneeling",),
}
PAUSE, TRANSITION = "pause", "transition"  # labels beside the classes


def frame_classes(activities: Iterable[Activity]) -> tuple[str, ...]:
    """Names of the labels of frames: the activities, then PAUSE and TRANSITION."""
    return (*(activity.slug for activity in activities), PAUSE, TRANSITION)


def label_of_pause(state: str, classes: Iterable[str]) -> str:
    """Label of a pause in a state of rest: the class of keeping still there, if there is one."""
    names = set(classes)
    return next((name for name in STILL.get(state, ()) if name in names), PAUSE)


def label_of_link(
    name: str, activities: Iterable[Activity], classes: Mapping[str, ClassConfig]
) -> str:
    """Label of a linking movement: the class that consists of it alone, if there is one."""
    for activity in activities:
        if _written(activity, classes) == (name,):
            return activity.slug
    return TRANSITION


class StreamChance(Chance, Protocol):
    """Random choices and numbers, each by its key."""

    def number(self, key: str, number: Number) -> float:
        """Draw a number."""


@dataclass(frozen=True)
class _Bout:
    """Movements of an activity in one bout."""

    names: tuple[str, ...]
    durations: tuple[Number | None, ...]  # those that its own class says
    pauses: tuple[Number, ...]


MAX_BOUTS = 1000  # of a stream
LEAD_S = 5.0  # a stream has begun by up to so much before its recording
MARGIN_S = 15.0  # by which a drawn stream is longer than its recording
TURN = "turning_around"


def draw_stream(
    stream: StreamConfig,
    seconds: float,
    activities: Sequence[Activity],
    classes: Mapping[str, ClassConfig],
    chance: StreamChance,
) -> SequenceConfig:
    """Draw the movements of a stream, with the label of each.

    Args:
        stream: order and pauses of the activities.
        seconds: duration of the recording, s.
        classes: classes of one's own, whose sequences are drawn for each bout.
        chance: random choices and numbers.
    """
    time, number, rest = 0.0, 0, list[Activity]()
    state: str | None = None
    steps = list[SequenceStep]()
    while time < seconds + LEAD_S + MARGIN_S and number < MAX_BOUTS:
        key = f"stream.{number}"
        rest = rest or list(activities)
        possible = [a for a in rest if linked(state, a, classes) is not None]
        if not possible:  # of this round
            possible = [a for a in activities if linked(state, a, classes) is not None]
        activity, number = _draw_activity(stream, possible, key, chance), number + 1
        if stream.order == "rounds" and activity in rest:
            rest.remove(activity)
        elif stream.order == "drawn":
            rest.clear()
        bout = _draw_bout(activity, classes, key, chance)
        linking = links_to_all(state, bout.names)
        if linking is None:  # a choice of parts to which no link leads: another bout
            continue
        added = [
            SequenceStep(name, _pace(name, stream, f"{key}.link.{place}", chance), 0.0, label)
            for place, name in enumerate(linking)
            for label in (label_of_link(name, activities, classes),)
        ]
        if MOVEMENTS[bout.names[0]].before == "standing" and chance.happens(
            f"{key}.turn", stream.turn_share
        ):
            added.append(SequenceStep(TURN, None, 0.0, TRANSITION))
        added += _steps_of(bout, activity.slug, stream, key, chance)
        pause = chance.number(f"{key}.pause_s", stream.pause_s)
        added[0] = added[0]._replace(pause=added[0].pause + pause)
        steps += added
        time += sum(step.pause + (step.duration or 0.0) for step in added)
        state = state or first_states(bout.names)[0]
        for name in (*linking, *bout.names):
            state = state_after(name, state)
    return SequenceConfig(
        sequence=tuple(step.name for step in steps),
        durations_s=tuple(step.duration for step in steps),
        pauses_s=tuple(step.pause for step in steps),
        labels=tuple(step.label for step in steps),
    )


def linked(
    state: str | None, activity: Activity, classes: Mapping[str, ClassConfig]
) -> tuple[str, ...] | None:
    """Links from a state of rest to the beginning of an activity; None where there are none."""
    return links_to_all(state, _written(activity, classes)[:1])


def links_to_all(state: str | None, names: Sequence[str]) -> tuple[str, ...] | None:
    """Links from a state of rest to where a sequence usually begins; None where there are none.

    Another state in which it may begin needs no link.
    """
    firsts = first_states(names)
    if state is None or state in firsts:
        return ()
    return links_between(state, firsts[0]) if firsts else None


def _written(activity: Activity, classes: Mapping[str, ClassConfig]) -> tuple[str, ...]:
    """Movements of an activity as they are written."""
    section = classes.get(activity.slug)
    return section.written if isinstance(section, SequenceConfig) else activity.movements


def _draw_activity(
    stream: StreamConfig, activities: Sequence[Activity], key: str, chance: StreamChance
) -> Activity:
    """Draw one of some activities, by their weights."""
    weights = [stream.weights.get(activity.slug, 1.0) for activity in activities]
    if not any(weights):
        weights = [1.0] * len(weights)
    level = chance.number(f"{key}.activity", uniform(0.0, 1.0)) * sum(weights)
    sums = list(accumulate(weights))
    return activities[min(bisect_right(sums, level), len(sums) - 1)]


def _draw_bout(
    activity: Activity, classes: Mapping[str, ClassConfig], key: str, chance: StreamChance
) -> _Bout:
    """Draw the movements of an activity in one bout."""
    section = classes.get(activity.slug)
    if not isinstance(section, SequenceConfig):
        count = len(activity.movements)
        return _Bout(activity.movements, (None,) * count, (0.0,) * count)
    order = section.draw_order(f"{key}.sequence", chance)
    drawn = section.model_copy(update={"order": order})
    steps = [*drawn.steps()]
    return _Bout(
        tuple(step.name for step in steps),
        tuple(cast(Number | None, step.duration) for step in steps),
        tuple(cast(Number, step.pause) for step in steps),
    )


def _steps_of(
    bout: _Bout, label: str, stream: StreamConfig, key: str, chance: StreamChance
) -> Iterator[SequenceStep]:
    """Movements of a bout, with durations and pauses that are drawn."""
    for place, (name, duration, pause) in enumerate(
        zip(bout.names, bout.durations, bout.pauses, strict=True)
    ):
        own_key = f"{key}.{place}"
        drawn = (
            _pace(name, stream, own_key, chance)
            if duration is None
            else chance.number(f"{own_key}.duration_s", duration)
        )
        yield SequenceStep(name, drawn, chance.number(f"{own_key}.pause_s", pause), label)


def _pace(name: str, stream: StreamConfig, key: str, chance: StreamChance) -> float:
    """Draw the duration of a movement, s."""
    usual = MOVEMENTS[name].seconds
    if usual is None:
        return chance.number(f"{key}.bout_s", stream.bout_s)
    return max(MIN_MOVEMENT_S, usual * chance.number(f"{key}.pace", stream.pace))
