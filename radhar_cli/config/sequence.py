"""A class that is a sequence of movements, whose order and parts may be drawn.

A part is a movement, several in a list, `{choice: [...]}`, `{optional: ..., share: 0.5}` or
`{shuffled: [...]}`. What a sequence can be drawn as is checked in every order; a scene has one.
"""

from collections.abc import Iterator, Mapping
from itertools import accumulate
from typing import Annotated, Any, ClassVar, Generic, NamedTuple, Protocol, TypeAlias, cast

from pydantic import Discriminator, Field, Tag, field_validator, model_validator

from radhar_cli.motion.activities.activity import OR, state_after
from radhar_cli.motion.activities.links import links_to
from radhar_cli.motion.activities.vocabulary import advice_on, is_other_word, meaning_of
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.standing import NOBODY
from radhar_cli.schema.number import NOT_NEGATIVE, SECONDS, Number, Share, support, value_error
from radhar_cli.schema.section import Flag, N, Section

MIN_MOVEMENT_S = 0.3
UNKNOWN_MOVEMENT = (
    "docs/reference/movements.md lists them; motion files have others (docs/guide/motion_files.md)"
)
BY_ITSELF = f"activities: [{NOBODY}, ...]"
MAX_MOVEMENTS = 4096  # of a sequence, as streams of ten minutes have


class Chance(Protocol):
    """Random choices, each by its key."""

    def index(self, key: str, count: int) -> int:
        """Draw one of `count` things, from 0 on."""

    def happens(self, key: str, probability: float) -> bool:
        """Draw whether something of a probability happens."""


def _kind(value: Any) -> str:
    for kind, name in ((ChosenPart, "choice"), (OptionalPart, "optional"), (Shuffled, "shuffled")):
        if isinstance(value, kind) or (isinstance(value, dict) and name in value):
            return f"<{name}>"
    return "<group>" if isinstance(value, (list, tuple)) else "<movement>"


Group: TypeAlias = Annotated[tuple[str, ...], Field(min_length=1, max_length=16)]
_Movement: TypeAlias = Annotated[str, Tag("<movement>")]
_Group: TypeAlias = Annotated[Group, Tag("<group>")]
Plain: TypeAlias = Annotated[_Movement | _Group, Discriminator(_kind)]


class ChosenPart(Section):
    """``{choice: [walking, [sitting_down, standing_up]]}``: one of them, equally likely."""

    choice: Annotated[tuple[Plain, ...], Field(min_length=1, max_length=64)]
    """Movements, or lists of movements, of which one is made."""


_Chosen: TypeAlias = Annotated[ChosenPart, Tag("<choice>")]


class OptionalPart(Section):
    """``{optional: grabbing, share: 0.5}``: a part that some of the recordings have."""

    optional: Annotated[_Movement | _Group | _Chosen, Discriminator(_kind)]
    """Movement, list of movements, or choice."""
    share: Share = 0.5
    """Share of the recordings that have it."""


_Optional: TypeAlias = Annotated[OptionalPart, Tag("<optional>")]


class Shuffled(Section):
    """``{shuffled: [grabbing, punching]}``: parts in an order that is drawn."""

    shuffled: Annotated[
        tuple[
            Annotated[_Movement | _Group | _Chosen | _Optional, Discriminator(_kind)],
            ...,
        ],
        Field(min_length=1, max_length=8),
    ]
    """Parts, at most eight, which come in any order."""


Part: TypeAlias = Annotated[
    _Movement | _Group | _Chosen | _Optional | Annotated[Shuffled, Tag("<shuffled>")],
    Discriminator(_kind),
]
PART_TAGS = ("<movement>", "<group>", "<choice>", "<optional>", "<shuffled>")
AnyPart: TypeAlias = "str | tuple[AnyPart, ...] | ChosenPart | OptionalPart | Shuffled"


class SequenceStep(NamedTuple):
    """One movement of a sequence with nothing left to draw."""

    name: str
    duration: float | None  # s; None is the usual one
    pause: float  # time at rest before it, s
    label: str = ""  # class of the movement in a stream
    place: int = 0  # names the random streams of the movement


def inner_parts(part: AnyPart) -> tuple[AnyPart, ...]:
    """Parts of a part, in the order in which they are written; none of a movement."""
    match part:
        case str():
            return ()
        case ChosenPart():
            return part.choice
        case OptionalPart():
            return (part.optional,)
        case Shuffled():
            return part.shuffled
    return part


def written_movements(part: AnyPart) -> tuple[str, ...]:
    """Names of the movements of a part, in the order in which they are written."""
    if isinstance(part, str):
        return (part,)
    return tuple(name for inner in inner_parts(part) for name in written_movements(inner))


def rename_movements(part: AnyPart, names: Mapping[str, str]) -> AnyPart:
    """Return a part whose movements have other names, {name: other name}."""
    if isinstance(part, str):
        return names[part]
    inner = tuple(rename_movements(one, names) for one in inner_parts(part))
    match part:
        case ChosenPart():
            return part.model_copy(update={"choice": inner})
        case OptionalPart():
            return part.model_copy(update={"optional": inner[0]})
        case Shuffled():
            return part.model_copy(update={"shuffled": inner})
    return inner


def movement_named(word: str) -> str:
    """Name of the movement that a word of a file means."""
    name = meaning_of(word, MOVEMENTS)
    if name is None:
        hint = advice_on(word, MOVEMENTS, UNKNOWN_MOVEMENT)
        raise value_error(f"{word!r} is not a movement; {hint}")
    return name


def draw_part(part: AnyPart, first: int, key: str, chance: Chance) -> list[int]:
    """Draw a part.

    Args:
        first: place of its first movement among all that are written.
        key: its dotted key, which names the choices.
        chance: random choices.

    Returns:
        Places of the movements that are made, in their order.
    """
    if isinstance(part, str):
        return [first]
    inner, places = inner_parts(part), list[int]()
    firsts = [*accumulate((len(written_movements(one)) for one in inner), initial=first)]
    numbers = list(range(len(inner)))
    if isinstance(part, OptionalPart) and not chance.happens(f"{key}.optional", part.share):
        return []
    if isinstance(part, ChosenPart):
        numbers = [chance.index(f"{key}.choice", len(inner))]
    if isinstance(part, Shuffled):  # Fisher and Yates
        for last in range(len(inner) - 1, 0, -1):
            other = chance.index(f"{key}.shuffled.{last}", last + 1)
            numbers[last], numbers[other] = numbers[other], numbers[last]
    for number in numbers:
        places += draw_part(inner[number], firsts[number], f"{key}.{number}", chance)
    return places


# States of rest in which the body may be, each with the movement that led there; None for any.
States: TypeAlias = Mapping[str | None, str]
ANY_STATE: States = {None: ""}


def states_after(part: AnyPart, states: States, links: bool) -> States:
    """States in which a body may be after a part, whatever is drawn.

    Args:
        states: states in which it may begin.
        links: whether linking movements are put in where states differ.

    Raises:
        ValueError: some draw is not joined at rest.
    """
    if isinstance(part, str):
        for state, previous in states.items():
            _require_joined(part, state, previous, links)
        befores = (_state_before(part, state) for state in states)
        return {cast(str, state_after(part, before)): part for before in befores}
    inner = inner_parts(part)
    if isinstance(part, OptionalPart):
        return {**states_after(inner[0], states, links), **states}
    if isinstance(part, ChosenPart):
        return {s: n for one in inner for s, n in states_after(one, states, links).items()}
    if isinstance(part, Shuffled):
        return _states_after_any_order(inner, states, links)
    for inner_part in inner:
        states = states_after(inner_part, states, links)
    return states


def _states_after_any_order(parts: tuple[AnyPart, ...], states: States, links: bool) -> States:
    """States after parts in any order, by the sets of those that came already."""
    reached: dict[int, States] = {0: states}
    for done in range(2 ** len(parts) - 1):
        for number, part in enumerate(parts):
            if not done >> number & 1:
                after = states_after(part, reached[done], links)
                now = done | 1 << number
                reached[now] = {**reached.get(now, {}), **after}
    return reached[2 ** len(parts) - 1]


def _state_before(name: str, state: str | None) -> str | None:
    """State in which a movement begins that is joined, by links or not, to a state."""
    for link in () if state is None else links_to(state, name) or ():
        state = state_after(link, state)
    return state


def _require_joined(name: str, state: str | None, previous: str, links: bool) -> None:
    """Refuse a movement that does not begin in the state in which the one before it ends."""
    if state is None or state_after(name, state) is not None:
        return
    linked = links_to(state, name)
    if links and linked is not None:
        return
    cure = ""
    if not links and linked is not None:
        cure = f"; links: true would put {', '.join(linked)} between them"
    begins = OR.join(MOVEMENTS[name].states)
    raise value_error(
        f"should be joined at rest: {name} begins {begins}, {previous} ends {state}{cure}"
    )


def _ends_of(part: AnyPart) -> set[int]:
    """Places, from the part's first movement on, of those that nothing of the part follows."""
    if isinstance(part, str):
        return {0}
    inner = inner_parts(part)
    firsts = [*accumulate((len(written_movements(one)) for one in inner), initial=0)]
    if isinstance(part, Shuffled) and len(inner) > 1:
        return set()
    numbers = range(len(inner)) if isinstance(part, ChosenPart) else (len(inner) - 1,)
    return {firsts[n] + place for n in numbers for place in _ends_of(inner[n])}


class SequenceConfig(Section, Generic[N]):
    """A class of your own: movements one after the other, joined at rest."""

    sequence: Annotated[tuple[Part, ...], Field(min_length=1, max_length=MAX_MOVEMENTS)]
    """Movements of the class in order, by their names (docs/guide/motion.md); parts may be drawn:
    lists, {choice: [...]}, {optional: ...}, {shuffled: [...]} (docs/guide/streams.md)."""
    durations_s: tuple[Annotated[N | None, NOT_NEGATIVE, SECONDS], ...] = ()
    """Duration of each movement that is written; null is the usual one, and of the last movement
    until the recording ends."""
    pauses_s: tuple[Annotated[N, NOT_NEGATIVE, SECONDS], ...] = ()
    """Time at rest before each movement; left out, there is none."""
    links: Flag = False
    """Whether linking movements are put in where states differ, such as standing_up after
    sitting_down; false refuses a sequence that some draw does not join at rest."""
    order: tuple[Annotated[int, Field(ge=0, strict=True)], ...] | None = None
    """Places of the movements that a scene has, in their order, filled in for a scene."""
    labels: tuple[str, ...] = ()
    """Class that each movement is labelled with, filled in for a scene of a stream."""

    NUMBERS: ClassVar = ("durations_s", "pauses_s")
    _other_words: dict[str, str] = {}  # {word of the file: movement that it means}

    def take_other_words(self) -> dict[str, str]:
        """Return {word of the file: movement that it means}, and forget it."""
        words, self._other_words = self._other_words, {}
        return words

    @property
    def written(self) -> tuple[str, ...]:
        """Movements as they are written, all alternatives included."""
        return written_movements(self.sequence)

    @property
    def is_drawn(self) -> bool:
        """Whether parts of the sequence are drawn, or its order."""
        return not all(isinstance(part, str) for part in self.sequence)

    @property
    def possible_movements(self) -> tuple[str, ...]:
        """Movements that a recording may have, links included."""
        written = self.written
        if not self.links:
            return tuple(dict.fromkeys(written))
        ends = sorted({end for name in written for end in MOVEMENTS[name].states.values()})
        ways = (links_to(end, name) or () for end in ends for name in sorted(set(written)))
        return tuple(dict.fromkeys((*written, *(name for way in ways for name in way))))

    def draw_order(self, key: str, chance: Chance) -> tuple[int, ...]:
        """Draw the places of the movements that a scene has, in their order."""
        return tuple(draw_part(self.sequence, 0, key, chance))

    def steps(self) -> Iterator[SequenceStep]:
        """Movements of a scene one after the other, links included; nothing is left to draw."""
        written, state = self.written, None
        labels = self.labels or ("",) * len(written)
        for place in range(len(written)) if self.order is None else self.order:
            name, pause = written[place], cast(float, self.pauses_s[place])
            linking: tuple[str, ...] = ()
            if self.links and state is not None:
                linking = links_to(state, name) or ()
            for number, link in enumerate(linking, 1):
                # Streams of links have numbers of their own beside those of the places.
                yield SequenceStep(link, None, 0.0, "", MAX_MOVEMENTS * number + place)
            duration = cast(float | None, self.durations_s[place])
            yield SequenceStep(name, duration, pause, labels[place], place)
            for movement in (*linking, name):
                state = state_after(movement, state)

    @field_validator("sequence", mode="before")
    @classmethod
    def _require_movements(cls, value: object) -> object:
        if value in ([], ()):
            raise value_error(f"should have movements; a room with nobody is {BY_ITSELF}")
        return value

    @model_validator(mode="after")
    def _require_joined_movements(self) -> "SequenceConfig[N]":
        names = {word: movement_named(word) for word in self.written}
        self._other_words = {word: n for word, n in names.items() if is_other_word(word, n)}
        renamed = tuple(rename_movements(part, names) for part in self.sequence)
        object.__setattr__(self, "sequence", renamed)
        written = self.written
        count = len(written)
        if not self.durations_s:
            object.__setattr__(self, "durations_s", (None,) * count)
        if not self.pauses_s:
            object.__setattr__(self, "pauses_s", (0.0,) * count)
        if not len(self.durations_s) == len(self.pauses_s) == count:
            raise value_error("should have as many durations_s, and pauses_s, as movements")
        if NOBODY in written and self.sequence != (NOBODY,):
            raise value_error(
                f"should be without {NOBODY}, which is a class by itself: {BY_ITSELF}"
            )
        if all(isinstance(part, OptionalPart) for part in self.sequence):
            raise value_error("should have a part that is not optional")
        states_after(self.sequence, ANY_STATE, self.links)
        ends = _ends_of(self.sequence)
        for place, (name, duration) in enumerate(zip(written, self.durations_s, strict=True)):
            if duration is not None and not support(cast(Number, duration))[0] >= MIN_MOVEMENT_S:
                raise value_error(f"should have durations_s from {MIN_MOVEMENT_S} s on")
            if MOVEMENTS[name].seconds is None and duration is None and place not in ends:
                raise value_error(f"should have a duration of {name}, which something follows")
        if any(place >= count for place in self.order or ()):
            raise value_error(f"should have an order of places below {count}")
        if self.labels and len(self.labels) != count:
            raise value_error("should have as many labels as movements")
        return self
