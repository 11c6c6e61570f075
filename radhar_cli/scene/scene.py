"""(config, class, index) -> one scene: a config with nothing left to draw."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from enum import Enum
from functools import cached_property, lru_cache
from math import nan
from typing import Any, Protocol, cast

import numpy as np

from radhar_cli.config.classes import FilesConfig
from radhar_cli.config.data_set import AnyConfig, Config
from radhar_cli.config.motion import (
    EARLIER_KEYS,
    FALL,
    USUAL_SPEEDS,
    MotionConfig,
    TimingConfig,
)
from radhar_cli.config.paths import SCENE_KEYS, at, changed, each_number, numbers
from radhar_cli.config.people import PersonConfig, SubjectConfig
from radhar_cli.config.radar import SceneRadar
from radhar_cli.config.receiver import ReceiverConfig
from radhar_cli.config.room import RoomConfig, WallConfig
from radhar_cli.config.sequence import SequenceConfig
from radhar_cli.config.stream import draw_stream
from radhar_cli.motion.activities.activity import STREAM, Activity
from radhar_cli.motion.human.physique import froude_scale
from radhar_cli.motion.movements.falling import FALLS, Falls
from radhar_cli.motion.skeleton import default_weight
from radhar_cli.numerics.randomness import NOISE, PERSON, SCENE, stream
from radhar_cli.schema.annotations import Mark, of_kind
from radhar_cli.schema.number import Choice, Number, is_fixed, nominal, quantile, uniform
from radhar_cli.schema.section import for_activity

# Keys of what is a radar's own, where there are several.
RADAR_KEYS = ("radar.", "snr_db", "receiver.", "image.cfar.")
OTHER_RADARS = "other_radars"
# Keys of what stays with a person whatever they do, and of what is not repeated exactly.
PERSONAL, UNSTEADY = (
    tuple(key for key, key_mark in of_kind(Config, Mark) if key_mark is mark) for mark in Mark
)
# Redrawing a scene outside the model changes what the person does, not the radar or the person.
REDRAWN = ("motion.", "timing.", "classes.", "stream.")
INSTANT, PLACE_RANGE = "motion.place.instant", "motion.place.range_m"
# What a walk may overlap, by at most MAX_OVERLAP of its duration, as low down no legs are long
# enough for a step; falls to the side not at all, as their feet are not planted.
OVERLAPPED = {
    "sitting_to_walking": "rise_duration_s",
    "walking_to_sitting": "sit_duration_s",
    "falling_to_walking": "rise_duration_s",
    "walking_to_falling": "fall_duration_s",
}
MAX_OVERLAP = 0.3
START_M = 0.6  # from the edge of a zone at which a stream begins, at least
MAX_PLACES = 100  # drawn for a person who comes too near to others


class Draw(Protocol):
    """Random choices of one person in one scene; what one key gets depends on no other key."""

    def number(self, key: str, number: Number) -> float:
        """Draw the number of a dotted key."""

    def index(self, key: str, count: int) -> int:
        """Draw one of `count` things, from 0 on."""

    def happens(self, key: str, probability: float) -> bool:
        """Draw whether something of a probability happens."""


@dataclass(frozen=True)
class NominalDraw:
    """The middle of everything, as nominal scenes have it."""

    def number(self, key: str, number: Number) -> float:
        """Return the middle of a number; 0 of what people do not repeat."""
        return 0.0 if key in UNSTEADY else nominal(number)

    def index(self, key: str, count: int) -> int:
        """Return the middle one."""
        return min(count // 2, count - 1)

    def happens(self, key: str, probability: float) -> bool:
        """Return whether it happens as often as not, or more often."""
        return probability >= 0.5


@dataclass(frozen=True)
class SeededDraw:
    """Draws by random streams, one for each key, named by seed, class, index and key.

    Keys that have moved since an earlier version keep its streams, and so their numbers.

    Attributes:
        seed: Seed of the data set.
        activity: Class of the sample.
        sample: Number of the sample within its class.
        attempt: Number of earlier draws of the person's motion that could not be used.
        subject: Number of a named person, whose personal numbers are drawn once; None without.
        person: Place in `people`, from 1 on; 0 for the sample's main person.
        radar: Name of the radar where there are several, whose numbers are drawn one by one.
    """

    seed: int
    activity: Activity
    sample: int
    attempt: int = 0
    subject: int | None = None
    person: int = 0
    radar: str | None = None

    def number(self, key: str, number: Number) -> float:
        """Draw the number of a dotted key, by its quantile function.

        That of INSTANT rises with the range of the place. If far places were passed anywhere on a
        course, those who walk would be spread over more ranges than those who do not.
        """
        share = self._share(key)
        if key == INSTANT:
            share = (share + self._share(PLACE_RANGE)) / 2
        return quantile(number, share)

    def index(self, key: str, count: int) -> int:
        """Draw one of `count` things, from 0 on."""
        return min(int(self._share(key) * count), count - 1)

    def happens(self, key: str, probability: float) -> bool:
        """Draw whether something of a probability happens."""
        return self._share(key) < probability

    def _share(self, key: str) -> float:
        """Draw the share, 0 to 1, of a key's distribution that lies below its draw."""
        name = _key_among_radars(EARLIER_KEYS.get(key, key), self.radar)
        if self.subject is not None and key in PERSONAL:
            return stream(self.seed, PERSON, self.subject, name=name).random()
        attempt = self.attempt if key.startswith(REDRAWN) else 0
        name = f"people.{self.person}.{name}" if self.person else name
        place = (self.activity.index, self.sample, attempt)
        return stream(self.seed, SCENE, *place, name=name).random()


def _key_among_radars(key: str, radar: str | None) -> str:
    """Key of a number of one of several radars, whichever of them a config is of.

    Args:
        key: dotted key in the config of a radar.
        radar: name of that radar; None where there is one alone.
    """
    if key.startswith(f"{OTHER_RADARS}."):
        return f"radars.{key.removeprefix(f'{OTHER_RADARS}.')}"
    if radar is None or not key.startswith(RADAR_KEYS):
        return key
    return f"radars.{radar}.{key.removeprefix('radar.')}"


@dataclass(frozen=True)
class Person:
    """One person of a scene.

    Attributes:
        scene: the scene they are in.
        activity: activity of the person.
        config: config whose `subject`, `motion`, `timing` and `classes` are theirs.
        number: 0 for the sample's main person, else their place in `people`, from 1 on.
        held: objects made of them that are needed again, by name.
    """

    scene: "Scene"
    activity: Activity
    config: Config
    number: int = 0
    held: dict[str, Any] = field(default_factory=dict, init=False, compare=False, repr=False)

    @property
    def subject(self) -> SubjectConfig[float]:
        """Body of the person."""
        return cast(SubjectConfig[float], self.config.subject)

    @property
    def motion(self) -> MotionConfig[float]:
        """Motion of the person."""
        return cast(MotionConfig[float], self.config.motion)

    @property
    def timing(self) -> TimingConfig[float]:
        """Timing of the person's motion."""
        return cast(TimingConfig[float], self.config.timing)

    @property
    def place(self) -> tuple[float, float]:
        """Range and cross-range (m) at which the person starts, or is at one instant."""
        motion = self.motion
        if motion.range_m is not None:
            return motion.range_m, motion.cross_range_m or 0.0
        aside = motion.cross_range_m
        return motion.place.range_m, motion.place.cross_range_m if aside is None else aside

    @property
    def prefix(self) -> str:
        """Prefix of the names of the person's random streams and keys."""
        return f"people.{self.number}." if self.number else ""

    @property
    def seconds(self) -> float:
        """Duration of the recording, s."""
        return float(self.scene.seconds)

    @property
    def own_class(self) -> SequenceConfig[float] | FilesConfig[float]:
        """Section of `classes` for the person's activity."""
        section = self.config.classes[self.activity.slug]
        return cast(SequenceConfig[float] | FilesConfig[float], section)

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
        index: number of the sample within its class; names its noise, with the seed and the class.
        subject: number of the person, or None where every sample is a person of its own.
        attempt: number of times the scene was redrawn (`on_invalid: redraw`).
    """

    config: Config
    activity: Activity
    index: int
    subject: int | None = None
    attempt: int = 0

    @property
    def radar(self) -> SceneRadar:
        """Radar of the scene."""
        return fixed_radar(self.config)

    @property
    def of_each_radar(self) -> tuple["Scene", ...]:
        """This scene as each of its radars has it, in the order of the alphabet of their names.

        Of a radar alone it is the scene itself.
        """
        scenes = {str(self.config.radar_name): self}
        for name in self.config.other_radars:
            scenes[name] = replace(self, config=self.config.of_other_radar(name))
        return tuple(scenes[name] for name in sorted(scenes))

    @property
    def wall(self) -> WallConfig[float] | None:
        """Wall between radar and people; None in free space."""
        return cast(WallConfig[float] | None, self.config.wall)

    @property
    def room(self) -> RoomConfig[float]:
        """Objects in the room, and its faces."""
        return cast(RoomConfig[float], self.config.room)

    @property
    def receiver(self) -> ReceiverConfig[float]:
        """Noise and interference of the receiver."""
        return cast(ReceiverConfig[float], self.config.receiver)

    @property
    def seconds(self) -> float:
        """Duration of the recording, s."""
        return cast(float, self.config.duration_s)

    @property
    def snr_db(self) -> float | None:
        """SNR of a raw sample, dB; None where noise is thermal, or none."""
        return cast(float | None, self.config.snr_db)

    @property
    def name(self) -> str:
        """Name of the sample in messages, such as walking/3."""
        return f"{self.activity.slug}/{self.index}"

    @property
    def is_empty(self) -> bool:
        """Whether nobody is in the scene (class `nobody`)."""
        return self.activity.is_nobody

    @cached_property
    def people(self) -> tuple[Person, ...]:
        """Everybody in the scene, the sample's main person first.

        In an empty scene it is a person who would stand there, without an echo: an SNR refers to
        theirs, and gates follow their place.
        """
        scene = replace(self)  # a twin: with the scene itself, motions would be freed late
        others = (
            Person(
                scene, self.config.activities_of(number)[0], self.config.of_person(number), number
            )
            for number, one in enumerate(self.config.people, 1)
            if one.share > 0 and not self.is_empty
        )
        return (Person(scene, self.activity, self.config), *others)

    @property
    def present(self) -> tuple[Person, ...]:
        """Everybody who makes an echo: `people`, and nobody in an empty scene."""
        return () if self.is_empty else self.people

    def noise_stream(self, name: str, channel: object = "") -> np.random.Generator:
        """Random stream of the noise of the scene's radar, of several its own.

        Args:
            name: name of the noise.
            channel: name of the receive channel; "" for the antennas of the config.
        """
        name = f"{name} channel {channel}" if channel else name
        if self.config.radar_name is not None:
            name = f"{name} radar {self.config.radar_name}"
        return self.surroundings_stream(name)

    def surroundings_stream(self, name: str) -> np.random.Generator:
        """Random stream of moving things besides people, the same for all radars of the scene."""
        return stream(self.config.seed, NOISE, self.activity.index, self.index, name=name)


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
    draw = SeededDraw(config.seed, activity, index, attempt, subject, radar=config.radar_name)
    fixed = _draw_config(config, activity, draw, subject)
    if config.people:
        attempts = people_attempts or (0,) * len(config.people)
        draws = [
            SeededDraw(config.seed, activity, index, attempts[number - 1], person=number)
            for number in range(1, len(config.people) + 1)
        ]
        fixed = changed(fixed, {"people": draw_people(config, draws)})
    return Scene(fixed, activity, index, subject, attempt)


def nominal_scene(config: Config, activity: Activity) -> Scene:
    """Make the scene with every number at its middle, and nothing that people do not repeat."""
    fixed = _draw_config(config, activity, NominalDraw(), None)
    if config.people:
        draws = [NominalDraw()] * len(config.people)
        fixed = changed(fixed, {"people": draw_people(config, draws)})
    return Scene(fixed, activity, 0)


def _draw_config(config: Config, activity: Activity, draw: Draw, subject: int | None) -> Config:
    """Draw the config of one person's scene.

    Args:
        config: config in which the person's numbers are at the top level.
        draw: random choices, or the middle of everything.
        subject: number of the person, or None without named persons.
    """
    fixed = _fix_numbers(config, activity, draw)
    falling = fixed.motion.falling.direction
    if isinstance(falling, Falls):
        fixed = changed(fixed, {FALL: falling.at_rank(draw.number(FALL, uniform(0.0, 1.0)))})
    files = config.files_of(activity)
    if files is not None and files.file is None:
        fixed = _with_file(fixed, activity, draw, subject)
    sequence = _sequence_to_draw(config, activity)
    if sequence is not None:
        key = f"classes.{activity.slug}"
        fixed = changed(fixed, {f"{key}.order": sequence.draw_order(f"{key}.sequence", draw)})
    if _draws_stream(config, activity):
        fixed = _with_stream(fixed, config, draw)
    return _with_possible_overlap(fixed, activity)


def _sequence_to_draw(config: Config, activity: Activity) -> SequenceConfig | None:
    """Sequence of an activity whose movements are still to be drawn."""
    sequence = config.classes.get(activity.slug)
    if isinstance(sequence, SequenceConfig) and sequence.is_drawn and sequence.order is None:
        return sequence
    return None


def _draws_stream(config: Config, activity: Activity) -> bool:
    """Whether the bouts of a stream are still to be drawn."""
    return activity.slug == STREAM and STREAM not in config.classes


def _with_stream(fixed: Config, config: Config, draw: Draw) -> Config:
    """Draw the bouts of a person's stream, and where it begins.

    Args:
        fixed: config of the scene.
        config: config that it is drawn of.
        draw: random choices, or the middle of everything.
    """
    assert config.stream is not None
    zone = config.stream.zone.strips(1 + len(config.people))[0]
    seconds = cast(float, fixed.duration_s)
    drawn = draw_stream(config.stream, seconds, config.stream_activities, config.classes, draw)
    places = {
        "range_m": uniform(zone.range_m[0] + START_M, zone.range_m[1] - START_M),
        "cross_range_m": uniform(zone.cross_range_m[0] + START_M, zone.cross_range_m[1] - START_M),
        "angle_deg": uniform(-180.0, 180.0),
    }
    motion = {f"motion.{key}": draw.number(f"motion.{key}", law) for key, law in places.items()}
    return changed(fixed, {"classes": {**fixed.classes, STREAM: drawn}, **motion})


def draw_people(config: Config, draws: Sequence[Draw]) -> tuple[PersonConfig, ...]:
    """Draw `people`, with nothing left to draw; an absent person has a share of 0.

    Args:
        config: config of the data set.
        draws: random choices of each of `people`.
    """
    numbered = enumerate(zip(config.people, draws, strict=True), 1)
    return tuple(_draw_person(config, number, person, draw) for number, (person, draw) in numbered)


def _draw_person(config: Config, number: int, person: PersonConfig, draw: Draw) -> PersonConfig:
    """Draw what one of `people`, 1 the first, is and does in a scene."""
    activities = config.activities_of(number)
    activity = activities[draw.index("activity", len(activities))]
    is_present = draw.happens("share", person.share)
    fixed = _draw_config(_of_person(ByIdentity(config), number), activity, draw, None)
    movements = {slug: c for slug, c in fixed.classes.items() if slug == activity.slug}
    return PersonConfig.model_construct(
        activity=activity.slug,
        share=float(is_present),
        subject=fixed.subject,
        motion=fixed.motion,
        timing=fixed.timing,
        classes=movements or None,
    )


def _with_possible_overlap(config: Config, activity: Activity) -> Config:
    """Cut the overlap of S9 to S12's movements to what legs are long enough for."""
    timing: Any = config.timing
    key = OVERLAPPED.get(activity.usual_slug)
    if key is None or config.motion.model != "human":
        return config
    sideways = (
        activity.usual_slug == "walking_to_falling"
        and config.motion.falling.direction == "sideways"
    )
    largest = 0.0 if sideways else MAX_OVERLAP * getattr(timing, key)
    capped = {"timing.overlap_s": min(timing.overlap_s, largest)}
    starts = timing.rise_start_s, timing.walk_start_s
    if key == "rise_duration_s" and None not in starts:
        earliest = timing.rise_start_s + timing.rise_duration_s - largest
        capped["timing.walk_start_s"] = max(timing.walk_start_s, earliest)
    return changed(config, capped)


def _with_file(config: Config, activity: Activity, draw: Draw, subject: int | None) -> Config:
    """Choose the motion file of an activity.

    Named persons have files of their own, as long as there are enough: then training and validation
    share none.
    """
    section = config.files_of(activity)
    assert section is not None
    files = range(len(section.files))
    if subject is not None:
        files = files[subject :: config.split.subjects] or files
    key = f"classes.{activity.slug}.file"
    return changed(config, {key: files[draw.index(key, len(files))]})


def subject_of(config: Config, index: int) -> int | None:
    """Number of the person in sample `index` of any class, or None without named persons."""
    return None if config.split.subjects is None else index % config.split.subjects


def number_at(scene: Scene, key: str) -> float:
    """Number of a scene under a dotted key, such as `radar.tx_m.0` or `people.0.motion.range_m`.

    It is NaN where the scene does not depend on such a number. `motion.falling.direction` is its
    place in FALLS.
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

    `motion.falling.direction` is its place in FALLS.
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
    config = same.config.without_other_words().with_class_of(activity)
    drawn = dict[str, Any]()

    def fix(key: str, number: Any) -> float | None:
        of_activity = for_activity(number, activity)
        if of_activity is None:
            return None
        if config.depends_on(activity, key) and not is_fixed(of_activity):
            drawn[key] = of_activity
        return nominal(of_activity)

    keys = (*SCENE_KEYS, OTHER_RADARS)
    sections = {key: each_number(at(config, key), key, fix) for key in keys}
    if activity.slug != STREAM:  # whose activities are the classes of its labels
        sections["activities"] = (activity.slug,)
    return changed(config, sections), drawn


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
    listed |= _sequence_to_draw(config, activity) is not None or _draws_stream(config, activity)
    if listed or isinstance(config.motion.falling.direction, Falls):
        return Redrawn.CHOICES
    if not drawn_again:
        return Redrawn.NOTHING
    lists = [one.choice for one in drawn_again if isinstance(one, Choice)]
    chosen = any(isinstance(one, float) for choices in lists for one in choices)
    return Redrawn.CHOICES if chosen else Redrawn.NUMBERS


def _fix_numbers(config: Config, activity: Activity, draw: Draw) -> Config:
    """Fix the numbers of a config; those that its activity does not depend on at their middle."""
    fixed, drawn = _fixed_and_drawn(ByIdentity(config), activity)
    values = {key: draw.number(key, number) for key, number in drawn.items()}
    if isinstance(draw, NominalDraw):
        values |= dict.fromkeys(UNSTEADY, 0.0)
    height: Any = values.get("subject.height_m", fixed.subject.height_m)
    if fixed.subject.weight_kg is None:
        values["subject.weight_kg"] = default_weight(height)
    if config.motion.model == "human":
        for key, usual in USUAL_SPEEDS.items():
            if for_activity(at(config, key), activity) == usual:
                values[key] = froude_scale(height) * values.get(key, at(fixed, key))
    return changed(fixed, values)
