"""A movement as a config knows it, and the person who makes it."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from typing import Protocol, TypeAlias, TypeVar

import numpy as np

from radhar_cli.motion.human.part import Movement
from radhar_cli.schema.section import Section

S = TypeVar("S", bound=Section)


class Mover(Protocol):
    """A person of a scene who is to make a movement: numbers of the scene, and random streams.

    Attributes:
        duration: Duration of the movement, s; infinity goes on.
        place: Place of the movement in its sequence, which names its random streams.
        seconds: Duration of the recording, s.
        stature: Height of the person, m.
        is_in_bed: Whether somebody who lies as the sequence begins lies in bed.
    """

    @property
    def duration(self) -> float: ...
    @property
    def place(self) -> int: ...
    @property
    def seconds(self) -> float: ...
    @property
    def stature(self) -> float: ...
    @property
    def is_in_bed(self) -> bool: ...

    def numbers(self, section: type[S]) -> S:
        """Numbers of a section of `motion`, which the file of a movement has as SECTION."""
        ...

    def stream(self, name: str) -> np.random.Generator:
        """Random stream of a name, for what this person does in this scene."""
        ...


Make: TypeAlias = Callable[[Mover], Movement]


@dataclass(frozen=True)
class MovementKind:
    """A movement that configs name.

    Attributes:
        name: Name in `activities` and in sequences.
        meaning: Meaning of a class of it, in a line.
        make: Makes the movement of a person, from rest.
        before: State of rest in which it usually begins.
        after: State in which it then ends.
        seconds: Usual duration, s; None for one that lasts as long as it is asked for.
        also: Further states in which it may begin, each with the state in which it then ends.
        like: Another movement, on whose keys it depends, too.
        in_place: Whether it leaves the torso within half a metre of where it was.
        rests: Whether it is rest, which need not be seen in a recording.
        uses: Keys of `motion` in sections that several movements share, `repeating.size_jitter`.
        rate: Repetitions per second of somebody who is under way as the recording begins.
        steps: Shares of the steps before and after it that go ahead, the others backwards, where
            such steps are drawn; None for no step.
        gestures: Fidgets that come with it, of size 1: channel, rad, whether after its end or its
            beginning, from when on and for how long, s.
        words: Other words for it, with spaces between them, as in the next three.
        manners: Words behind or before a word for it, which change nothing.
        nearby: Words of something that comes near it: suggested, but not taken for the same.
        with_key: {key that makes the difference, and how: words for it}.
    """

    name: str
    meaning: str
    make: Make
    before: str = "standing"
    after: str = "standing"
    seconds: float | None = None
    also: tuple[tuple[str, str], ...] = ()
    like: str | None = None
    in_place: bool = False
    rests: bool = False
    uses: tuple[str, ...] = ()
    rate: Callable[[Mover], float] | None = None
    steps: tuple[float | None, float | None] = (None, None)
    gestures: tuple[tuple[str, float, bool, float, float], ...] = ()
    words: str = ""
    manners: str = ""
    nearby: str = ""
    with_key: Mapping[str, str] = field(default_factory=dict)

    @property
    def states(self) -> dict[str, str]:
        """States in which it may begin, the usual one first, and in which it then ends."""
        return {self.before: self.after, **dict(self.also)}

    @property
    def keys(self) -> frozenset[str]:
        """Dotted keys of `uses`."""
        return frozenset(f"motion.{key}" for key in self.uses)
