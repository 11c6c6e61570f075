"""The activities: label, slug, class number and the movements of people each one consists of."""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING
from zlib import crc32

from radhar_cli.extensions import load_extensions
from radhar_cli.motion.activities.vocabulary import (
    advice_on,
    is_other_word,
    meaning_of,
    meanings_of,
    plain_word,
)
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.standing import NOBODY
from radhar_cli.schema.twelve import DEFAULT, MOVEMENTS_OF_TWELVE, TWELVE

if TYPE_CHECKING:
    from radhar_cli.motion.protocol import Motion


OR = " or "  # between states of which whoever begins a sequence has the choice


def state_after(name: str, state: str | None) -> str | None:
    """State in which a movement ends.

    Args:
        name: The movement.
        state: State in which it begins, or several joined by `OR` of which one will do; None where
            it is the first.

    Returns:
        The state, or several likewise; None where the movement cannot begin so.
    """
    states = MOVEMENTS[name].states
    befores = states if state is None else [one for one in state.split(OR) if one in states]
    return OR.join(dict.fromkeys(states[before] for before in befores)) or None


def first_states(names: Sequence[str]) -> tuple[str, ...]:
    """States in which a sequence of movements may begin, so that each joins the one before it."""
    firsts = []
    for first in MOVEMENTS[names[0]].states:
        state: str | None = first
        for name in names:
            state = None if state is None else state_after(name, state)
        if state is not None:
            firsts.append(first)
    return tuple(firsts)


@dataclass(frozen=True)
class Activity:
    """One activity of people, and class of data sets."""

    number: int  # 1 to 12, the paper's S number; 13 and more for user-defined classes
    slug: str  # name used in folders and on the command line
    # names in MOVEMENTS, one after the other; config keys say which of them use a number
    movements: tuple[str, ...] = ()
    # makes the motion of a `scene.Person`; None where `motion:` decides which does
    motion: "Callable[..., Motion] | None" = None
    # keys of `motion:` and `timing:` that such a motion depends on, besides the place
    uses: tuple[str, ...] = ()

    @property
    def label(self) -> str:
        """Label of the activity: the paper's name, ``S1`` to ``S12``, and so on."""
        return f"S{self.number}"

    @property
    def usual_slug(self) -> str:
        """Name of one of the twelve whatever it is called; of other classes the slug."""
        return ACTIVITIES[self.number - 1].slug if self.number <= len(ACTIVITIES) else self.slug

    @property
    def index(self) -> int:
        """Number that names the activity's random streams: 0 to 11 for the twelve.

        That of a class named as a movement follows from the name, so that its scenes are the same
        whatever other classes there are. It is no label of a data set: that is a place in the
        config's `activities`.
        """
        is_movement = self.number > len(ACTIVITIES) and self.slug in MOVEMENTS
        return crc32(self.slug.encode()) if is_movement else self.number - 1

    @property
    def is_movement(self) -> bool:
        """Whether the class is one movement, called so or by another word for it."""
        if not self.movements or self.movements[0] not in meanings_of(self.slug):
            return False
        return {*self.movements} <= {self.movements[0], MOVEMENTS[self.movements[0]].like}

    @property
    def is_nobody(self) -> bool:
        """Whether nobody is in scenes of the class."""
        return NOBODY in self.movements

    @property
    def stays_in_place(self) -> bool:
        """Whether all its movements, of which there are some, leave the torso in place."""
        return bool(self.movements) and all(MOVEMENTS[name].in_place for name in self.movements)

    @property
    def walks(self) -> bool:
        """Whether the torso moves along the motion angle."""
        return 8 <= self.number <= 12


ACTIVITIES = tuple(
    Activity(number, slug, movements)
    for number, (slug, movements) in enumerate(MOVEMENTS_OF_TWELVE.items(), 1)
)

STREAM = "stream"  # class of recordings of several activities one after the other


def _by_name(activities: Iterable[Activity]) -> dict[str, Activity]:
    """Activities by slug, and by label in lower case."""
    return {name: a for a in activities for name in (a.slug, a.label.lower())}


def activity_of_movements(slug: str, movements: tuple[str, ...], number: int) -> Activity:
    """Return the class of people who make movements one after the other.

    Args:
        slug: Name of the class.
        movements: Names in MOVEMENTS.
        number: Number of the class, 13 or more.
    """
    like = tuple(other for name in movements if (other := MOVEMENTS[name].like))
    return Activity(number, slug, (*movements, *like))


_BY_NAME = _by_name(ACTIVITIES)
_ADDED: dict[str, Activity] = {}


def add_activity(
    slug: str, motion: "Callable[..., Motion]", uses: tuple[str, ...] = ()
) -> Activity:
    """Make a class beyond the twelve known, under a slug that configs may name from then on.

    A config names it in `activities`; its place there is its label.

    Args:
        slug: Lower-case letters, digits and underscores.
        motion: Makes the motion of a `scene.Person` from their numbers. A data set built by several
            processes needs a function that can be pickled.
        uses: Keys of `motion:` and `timing:` beside the place; other numbers are not drawn.

    Raises:
        ValueError: The slug is taken or no slug.
    """
    if not is_new_slug(slug):
        raise ValueError(f"{slug!r} should be a new name of lower-case letters, digits and _")
    _ADDED[slug] = Activity(len(ACTIVITIES) + 1, slug, (), motion, uses)
    return _ADDED[slug]


def own_activities() -> tuple[Activity, ...]:
    """Classes that `add_activity` made known, here or in a module of RADHAR_EXTENSIONS."""
    load_extensions()
    return tuple(_ADDED.values())


def know_activities(activities: Iterable[Activity]) -> None:
    """Register the user-defined classes of another process that are not known here yet."""
    for activity in activities:
        if activity.motion is not None and activity not in own_activities():
            add_activity(activity.slug, activity.motion, activity.uses)


def is_new_slug(slug: str) -> bool:
    """Whether a user-defined class may have this name: not one of the twelve, fit for a folder."""
    is_reserved = slug in _BY_NAME or slug == DEFAULT
    return not is_reserved and slug.isascii() and slug.isidentifier() and slug == slug.lower()


def class_called(name: str, classes: Mapping[str, Activity]) -> Activity:
    """Find an activity as `activity_named`; one of the twelve has the name of another word for it.

    Args:
        name: as somebody wrote it.
        classes: {slug: activity} of a config's own classes, which keep their names.

    Raises:
        ValueError: No such activity.
    """
    activity, word = activity_named(name, classes), plain_word(name)
    is_of_twelve = activity.slug in TWELVE and activity.slug not in classes
    if is_of_twelve and is_other_word(name, activity.slug) and is_new_slug(word):
        return replace(activity, slug=word)
    return activity


def activity_named(name: str, classes: Mapping[str, Activity] | None = None) -> Activity:
    """Find an activity by slug, label, movement or another word for it, whatever the case.

    A movement's name is a class of that movement alone.

    Args:
        name: as somebody wrote it.
        classes: {slug: activity} of a config's own classes, known beside the twelve and those of
            `add_activity`.

    Raises:
        ValueError: No such activity; the message suggests what is meant, or lists the slugs.
    """
    added = {activity.slug: activity for activity in own_activities()}
    known = _BY_NAME | added | _by_name((classes or {}).values())
    plain_name = name.strip().lower()
    if plain_name in known:
        return known[plain_name]
    slugs = list(dict.fromkeys(a.slug for a in known.values()))
    slug = meaning_of(plain_name, (*slugs, *MOVEMENTS))
    if slug in known:
        return known[slug]
    if slug is not None:
        number = 1 + max(a.number for a in known.values())
        return activity_of_movements(slug, (slug,), number)
    names = list(dict.fromkeys((*slugs, *MOVEMENTS)))
    list_of_slugs = f"there are {', '.join(slugs)} and the movements of docs/reference/movements.md"
    hint = advice_on(plain_name, [*names, *known], list_of_slugs)
    completions = [slug for slug in names if len(plain_name) > 3 and slug.startswith(plain_name)]
    if hint == list_of_slugs and completions:
        hint = f"did you mean {completions[0]!r}?"
    raise ValueError(f"{name!r} is not an activity; {hint}")
