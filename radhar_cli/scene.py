"""(config, class, index) -> one scene: a config with nothing left to draw."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cached_property, lru_cache, partial
from math import nan
from typing import Any, TypeAlias, cast

import numpy as np

from radhar_cli.activities.activity import Activity
from radhar_cli.config.annotations import Mark, of_kind
from radhar_cli.config.data_set import AnyConfig, Config
from radhar_cli.config.number import Choice, Distribution, Number, is_fixed, nominal, quantile
from radhar_cli.config.paths import at, changed, each_number
from radhar_cli.config.people import FALLS, Falls, PersonConfig
from radhar_cli.config.radar import SceneRadar
from radhar_cli.config.section import PerActivity, Section, for_activity
from radhar_cli.motion.skeleton import default_weight
from radhar_cli.numerics.randomness import PERSON, SCENE, stream

# The keys of a config whose numbers may be drawn, scene by scene.
SCENE_KEYS = (
    "duration_s",
    "radar",
    "subject",
    "motion",
    "timing",
    "classes",
    "wall",
    "room",
    "snr_db",
    "receiver",
    "image.cfar",
)
# Keys of what stays with a person whatever they do, and of what is not repeated exactly.
PERSONAL, UNSTEADY = (
    tuple(key for key, key_mark in of_kind(Config, Mark) if key_mark is mark) for mark in Mark
)
# Redrawing a scene outside the model changes what the person does, not the radar or the person.
REDRAWN = ("motion.", "timing.", "classes.")
FALL = "motion.fall"
# What a walk may overlap, by at most MAX_OVERLAP of its duration, as low down no legs are long
# enough for a step; falls to the side not at all, as their feet are not planted.
OVERLAPPED = {
    "sitting_to_walking": "rise_duration_s",
    "walking_to_sitting": "sit_duration_s",
    "falling_to_walking": "rise_duration_s",
    "walking_to_falling": "fall_duration_s",
}
MAX_OVERLAP = 0.3
MAX_PLACES = 100  # drawn for a person who comes too near to others
Draw: TypeAlias = Callable[[str], float]
OfOther: TypeAlias = Callable[[int, str], float]


class Numbers:
    """A section of a scene's config, with its numbers as floats.

    Raises:
        TypeError: of a number that is still to be drawn, when it is read.
    """

    def __init__(self, section: Section) -> None:
        self._section = section

    def __getattr__(self, name: str) -> Any:
        return _plain(getattr(self._section, name))


def _plain(value: Any) -> Any:
    """A value of a section with its numbers as floats; sections in it are `Numbers`."""
    if isinstance(value, (int, float)) and not isinstance(value, bool):
        return float(value)
    if isinstance(value, (Distribution, PerActivity)):
        raise TypeError(f"{value!r} should have been drawn; this is not the config of a scene")
    if isinstance(value, tuple):
        return tuple(map(_plain, value))
    return Numbers(value) if isinstance(value, Section) else value


def _section(name: str) -> cached_property[Any]:
    """Property of an object with a `config`: that section of it, with its numbers as floats."""
    return cached_property(lambda self: _plain(getattr(self.config, name)))


@dataclass(frozen=True)
class Person:
    """One person of a scene.

    Attributes:
        scene: the scene they are in.
        activity: what they do.
        config: config whose `subject`, `motion`, `timing` and `classes` are theirs.
        number: 0 for the sample's main person, else their place in `people`, from 1 on.
        held: what was made of them and is needed again, by name.
        subject, motion, timing: sections of the config, with their numbers as floats.
    """

    scene: "Scene"
    activity: Activity
    config: Config
    number: int = 0
    held: dict[str, Any] = field(default_factory=dict, init=False, compare=False, repr=False)

    subject, motion, timing = map(_section, ("subject", "motion", "timing"))

    @property
    def prefix(self) -> str:
        """Prefix of the names of the person's random streams and keys."""
        return f"people.{self.number}." if self.number else ""

    @property
    def seconds(self) -> float:
        """Duration of the recording, s."""
        return float(self.scene.seconds)

    @cached_property
    def own_class(self) -> Any:
        """Section of `classes` for the person's activity, with its numbers as floats."""
        return _plain(self.config.classes[self.activity.slug])

    def stream(self, name: str) -> np.random.Generator:
        """Random stream of a name, for what this person does in this scene."""
        seed, index, name = self.scene.config.seed, self.scene.index, self.prefix + name
        return stream(seed, SCENE, self.scene.activity.index, index, 0, name=name)

    def own_stream(self, name: str) -> np.random.Generator:
        """Random stream of a name, for the body: the same in all scenes of a named person."""
        scene, name = self.scene, self.prefix + name
        if scene.subject is not None and not self.number:
            return stream(scene.config.seed, PERSON, scene.subject, name=name)
        return stream(scene.config.seed, SCENE, scene.activity.index, scene.index, name=name)


def fixed_radar(config: AnyConfig) -> SceneRadar:
    """Return the radar of a config in which nothing of it is left to draw."""
    return cast(SceneRadar, config.radar)


@dataclass(frozen=True)
class Scene:
    """One recording to be simulated.

    Attributes:
        config: config with every number of SCENE_KEYS fixed. Written to YAML and simulated again
            with the same activity and index, it gives the same recording.
        activity: what the sample's main person does.
        index: number of the sample within its class; names its noise, with the seed and the class.
        subject: number of the person, or None where every sample is a person of its own.
        attempt: how often the scene was redrawn (`on_invalid: redraw`).
        radar, wall, room, receiver, seconds, snr_db: sections and numbers of the config, as floats.
    """

    config: Config
    activity: Activity
    index: int
    subject: int | None = None
    attempt: int = 0

    wall, room, receiver = map(_section, ("wall", "room", "receiver"))
    seconds, snr_db = map(_section, ("duration_s", "snr_db"))

    @property
    def radar(self) -> SceneRadar:
        """Radar of the scene."""
        return fixed_radar(self.config)

    @property
    def name(self) -> str:
        """Name of the sample in messages, such as walking/3."""
        return f"{self.activity.slug}/{self.index}"

    @cached_property
    def people(self) -> tuple[Person, ...]:
        """Everybody in the scene, the sample's main person first."""
        scene = replace(self)  # a twin: with the scene itself, motions would be freed late
        others = (
            Person(
                scene, self.config.activities_of(number)[0], self.config.of_person(number), number
            )
            for number, one in enumerate(self.config.people, 1)
            if one.share > 0
        )
        return (Person(scene, self.activity, self.config), *others)


def draw_scene(
    config: Config,
    activity: Activity,
    index: int,
    attempt: int = 0,
    people_attempts: tuple[int, ...] = (),
) -> Scene:
    """Draw every number of one sample, each from its own stream.

    Persons come from (seed, subject, field), the rest from (seed, class, index, field): no draw
    depends on another, on the maps, on the engine, or on the order of work.

    Args:
        config: config of the data set.
        activity: class of the sample.
        index: number of the sample within its class.
        attempt: number of draws before that were outside the model.
        people_attempts: number of draws before, of each of `people`, in which they did not fit;
            empty for none.
    """
    subject = subject_of(config, index)

    def at_share(key: str) -> float:
        if subject is not None and key in PERSONAL:
            return stream(config.seed, PERSON, subject, name=key).random()
        redrawn = attempt if key.startswith(REDRAWN) else 0
        return stream(config.seed, SCENE, activity.index, index, redrawn, name=key).random()

    def of_other(number: int, key: str) -> float:
        attempts = people_attempts[number - 1] if people_attempts else 0
        redrawn = attempts if key.startswith(REDRAWN) else 0
        name = f"people.{number}.{key}"
        return stream(config.seed, SCENE, activity.index, index, redrawn, name=name).random()

    fixed = _draw_config(config, activity, at_share, subject)
    if config.people:
        fixed = changed(fixed, {"people": _draw_people(config, of_other)})
    return Scene(fixed, activity, index, subject, attempt)


def nominal_scene(config: Config, activity: Activity) -> Scene:
    """Make the scene with every number at its middle, and nothing that people do not repeat."""
    fixed = _draw_config(config, activity, None, None)
    if config.people:
        fixed = changed(fixed, {"people": _draw_people(config, None)})
    return Scene(fixed, activity, 0)


def _draw_config(
    config: Config, activity: Activity, at_share: Draw | None, subject: int | None
) -> Config:
    """Draw the config of one person's scene.

    Args:
        config: config in which the person's numbers are at the top level.
        activity: what the person does.
        at_share: share, 0 to 1, of the distribution of a key at which its number lies; None for the
            middle of all, and nothing unsteady.
        subject: number of the person, or None without named persons.
    """

    def draw(key: str, number: Number) -> float:
        return nominal(number) if at_share is None else quantile(number, at_share(key))

    fixed = _fix_numbers(config, activity, draw)
    if at_share is None:
        fixed = changed(fixed, dict.fromkeys(UNSTEADY, 0.0))
    if isinstance(fixed.motion.fall, Falls):
        fixed = changed(fixed, {FALL: fixed.motion.fall.drawn(at_share(FALL) if at_share else 0.5)})
    if config.files_of(activity) is not None:
        share = at_share(f"classes.{activity.slug}.file") if at_share else 0.5
        fixed = _with_file(fixed, activity, share, subject)
    return _with_possible_overlap(fixed, activity)


def _draw_people(config: Config, at_share: OfOther | None) -> tuple[PersonConfig, ...]:
    """Draw `people`, with nothing left to draw; who is not there has a share of 0."""
    drawn = []
    for number, person in enumerate(config.people, 1):
        share = partial(at_share, number) if at_share else None
        activities = config.activities_of(number)
        place = min(
            int((share("activity") if share else 0.5) * len(activities)), len(activities) - 1
        )
        activity = activities[place]
        present = person.share > (share("share") if share else 0.5 - 1e-9)
        fixed = _draw_config(_of_person(ByIdentity(config), number), activity, share, None)
        own_classes = {slug: c for slug, c in fixed.classes.items() if slug == activity.slug}
        drawn.append(
            PersonConfig.model_construct(
                activity=activity.slug,
                share=float(present),
                subject=fixed.subject,
                motion=fixed.motion,
                timing=fixed.timing,
                classes=own_classes or None,
            )
        )
    return tuple(drawn)


def _with_possible_overlap(config: Config, activity: Activity) -> Config:
    """Cut the overlap of S9 to S12's movements to what legs are long enough for."""
    timing: Any = config.timing
    key = OVERLAPPED.get(activity.slug)
    if key is None or config.motion.model != "human":
        return config
    sideways = activity.slug == "walking_to_falling" and config.motion.fall == "sideways"
    most = 0.0 if sideways else MAX_OVERLAP * getattr(timing, key)
    capped = {"timing.overlap_s": min(timing.overlap_s, most)}
    if key == "rise_duration_s" and timing.walk_start_s is not None:
        earliest = timing.rise_start_s + timing.rise_duration_s - most
        capped["timing.walk_start_s"] = max(timing.walk_start_s, earliest)
    return changed(config, capped)


def _with_file(config: Config, activity: Activity, u: float, subject: int | None) -> Config:
    """Choose the motion file of an activity, the one at a fraction u of the draws.

    Named persons have files of their own, as long as there are enough: then training and validation
    share none.
    """
    one = config.files_of(activity)
    if one is None or one.file is not None:
        return config
    files = range(len(one.files))
    if subject is not None:
        files = files[subject :: config.split.subjects] or files
    drawn = files[min(int(u * len(files)), len(files) - 1)]
    return changed(config, {f"classes.{activity.slug}.file": drawn})


def subject_of(config: Config, index: int) -> int | None:
    """Number of the person in sample `index` of any class, or None without named persons."""
    return None if config.split.subjects is None else index % config.split.subjects


def numbers(config: Config) -> list[tuple[str, Any]]:
    """List all numbers of a config that may be drawn, as (dotted key, number or PerActivity).

    They are in the order of the schema. Vectors come as `radar.tx_m.0` and so on; keys that are
    null are left out.
    """
    drawable: list[tuple[str, Any]] = []

    def add(key: str, number: Any) -> Any:
        drawable.append((key, number))
        return number

    for key in SCENE_KEYS:
        each_number(at(config, key), key, add)
    return drawable


def number_at(scene: Scene, key: str) -> float:
    """Number of a scene under a dotted key, such as `radar.tx_m.0` or `people.0.motion.range_m`.

    It is NaN where the scene does not depend on such a number. `motion.fall` is its place in FALLS.
    """
    config, activity = scene.config, scene.activity
    if key.startswith("people."):
        _, place, key = key.split(".", 2)
        other = next((p for p in scene.people if p.number == int(place) + 1), None)
        if other is None:
            return nan
        config, activity = other.config, other.activity
    number = at(config, key)
    if number is None or not config.depends_on(activity, key):
        return nan
    return float(FALLS.index(number)) if key == FALL else float(number)


def keys_of_people(config: Config) -> list[str]:
    """Dotted keys of the numbers of all of `people`, such as `people.0.motion.range_m`."""
    keys_found = []
    for number in range(1, len(config.people) + 1):
        person_config, activities = config.of_person(number), config.activities_of(number)
        keys = [*(key for key, _ in numbers(person_config)), FALL]
        keys_found += [
            f"people.{number - 1}.{key}"
            for key in keys
            if key.startswith(("subject.", "motion.", "timing."))
            and any(person_config.depends_on(activity, key) for activity in activities)
        ]
    return keys_found


def file_keys(config: Config) -> tuple[str, ...]:
    """Dotted keys, one for each class of files, of the number of the file that a scene uses."""
    return tuple(
        f"classes.{slug}.file" for slug, one in config.classes.items() if hasattr(one, "files")
    )


def scene_numbers(scene: Scene) -> dict[str, float]:
    """Numbers that a scene depends on, {dotted key: number}, in the units of the keys.

    `motion.fall` is its place in FALLS.
    """
    keys = (*(key for key, _ in numbers(scene.config)), FALL, *file_keys(scene.config))
    used = (key for key in keys if scene.config.depends_on(scene.activity, key))
    values = {key: number_at(scene, key) for key in (*used, *keys_of_people(scene.config))}
    return {key: number for key, number in values.items() if number == number}


class ByIdentity:
    """A config as a key of a cache: equal to itself alone, whatever it holds."""

    def __init__(self, config: Any) -> None:
        self.config = config

    def __hash__(self) -> int:
        return id(self.config)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, ByIdentity) and self.config is other.config


@lru_cache(maxsize=64)
def _of_person(same: ByIdentity, number: int) -> Config:
    """Config of a person, the same object for all scenes: draws are cached by its identity."""
    config: Config = same.config
    return config.of_person(number)


@lru_cache(maxsize=64)
def _fixed_and_drawn(same: ByIdentity, activity: Activity) -> tuple[Config, dict[str, Any]]:
    """Config of an activity with all numbers at their middle, and {dotted key: number to draw}."""
    config, drawn = same.config, dict[str, Any]()

    def fix(key: str, number: Any) -> float:
        of_activity = for_activity(number, activity)
        if config.depends_on(activity, key) and not is_fixed(of_activity):
            drawn[key] = of_activity
        return nominal(of_activity)

    sections = {key: each_number(at(config, key), key, fix) for key in SCENE_KEYS}
    return changed(config, sections | {"activities": (activity.slug,)}), drawn


class Redrawn(Enum):
    """Kinds of numbers that are drawn again for a scene outside the model."""

    NOTHING = "nothing"
    NUMBERS = "numbers between bounds"
    CHOICES = "one of a list, too"


def redrawn(config: Config, activity: Activity) -> Redrawn:
    """Kind of numbers that another attempt at a scene of an activity may change."""
    drawn = _fixed_and_drawn(ByIdentity(config), activity)[1]
    drawn_again = [
        one for key, one in drawn.items() if key.startswith(REDRAWN) and key not in PERSONAL
    ]
    personal = [one for key, one in drawn.items() if key.startswith(REDRAWN) and key in PERSONAL]
    drawn_again += personal if config.split.subjects is None else []
    files = config.files_of(activity)
    listed = files is not None and files.file is None and len(files.files) > 1
    if listed or isinstance(config.motion.fall, Falls):
        return Redrawn.CHOICES
    if not drawn_again:
        return Redrawn.NOTHING
    chosen = any(isinstance(one, Choice) for one in drawn_again)
    return Redrawn.CHOICES if chosen else Redrawn.NUMBERS


def _fix_numbers(
    config: Config, activity: Activity, draw: Callable[[str, Number], float]
) -> Config:
    """Fix the numbers of a config; those that its activity does not depend on at their middle."""
    fixed, drawn = _fixed_and_drawn(ByIdentity(config), activity)
    values = {key: draw(key, number) for key, number in drawn.items()}
    if fixed.subject.weight_kg is None:
        height: Any = values.get("subject.height_m", fixed.subject.height_m)
        values["subject.weight_kg"] = default_weight(height)
    return changed(fixed, values)
