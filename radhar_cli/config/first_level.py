"""All sections of a data set together, not yet checked across sections."""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import replace
from functools import cache, cached_property, partial
from itertools import count, zip_longest
from typing import Annotated, Any, ClassVar, Literal, Self, TypeAlias

from pydantic import BaseModel, Field, ValidationInfo, field_validator

from radhar_cli.config.acting import BOARD
from radhar_cli.config.classes import (
    ClassConfig,
    Classes,
    FilesConfig,
    class_activities,
    movement_class,
)
from radhar_cli.config.cloud import CloudConfig
from radhar_cli.config.engine import EngineConfig
from radhar_cli.config.image import LEAST_PX, ImageConfig
from radhar_cli.config.maps import CADENCE_MAPS, FRAME_MAPS, MAP_NAMES, OF_FRAMES, OF_POINTS, Maps
from radhar_cli.config.motion import MotionConfig, TimingConfig
from radhar_cli.config.output import OutputConfig, SplitConfig
from radhar_cli.config.people import BodyConfig, OneOf, PersonConfig, SubjectConfig
from radhar_cli.config.processing import PAPER_WINDOW, ProcessingConfig
from radhar_cli.config.radar import ArrayRadar, FmcwRadar, Radar
from radhar_cli.config.range_zone import range_zone
from radhar_cli.config.receiver import ReceiverConfig
from radhar_cli.config.recordings import RecordingsConfig
from radhar_cli.config.room import RoomConfig, WallConfig
from radhar_cli.config.sequence import SequenceConfig
from radhar_cli.config.stream import TURN, StreamConfig
from radhar_cli.errors import CaptureError
from radhar_cli.motion.activities.activity import (
    ACTIVITIES,
    STREAM,
    Activity,
    activity_named,
    class_called,
    is_new_slug,
)
from radhar_cli.motion.activities.links import links_between
from radhar_cli.motion.activities.vocabulary import is_other_word, plain_word
from radhar_cli.motion.movements.catalogue import MOVEMENTS, users_of
from radhar_cli.motion.movements.exercises import EXERCISES
from radhar_cli.schema.annotations import (
    GIVEN,
    ByModel,
    Limits,
    NeedsAnyKey,
    NeedsKey,
    OnlyMaps,
    Paper,
    People,
    Unless,
    at,
    conditions,
    of_kind,
    section,
)
from radhar_cli.schema.number import Decibel, Positive, nominal, uniform, value_error, within
from radhar_cli.schema.section import By, PerActivity, S, Section, defaults_of, for_activity
from radhar_cli.schema.twelve import DEFAULT, TWELVE

Samples = Annotated[int, Field(ge=1, le=10_000_000, strict=True)]


# Seed of a data set, of scenes or of recordings.
Seed = Annotated[int, Field(ge=0, lt=2**63, strict=True)]


class Request(Section):
    """A data set: what to draw, what to compute, how to store it."""

    seed: Seed = 1
    """Seed of everything that is drawn, 0 to 2^63 - 1."""
    samples_per_class: Annotated[
        By[Samples], Unless("stream", "stream, which has a count of its own")
    ] = 300
    """Number of samples of each class; it may differ: `{per_activity: {default: 300, walking:
    100}}`."""
    classes: Classes = {}
    """Classes of your own: `{name: {sequence: [...]}}` of movements, `{name: [walk/*.bvh]}` of
    files."""
    activities: Literal["all"] | tuple[str, ...] = "all"
    """Classes of the data set: all is the twelve and those of `classes`; or a list of slugs, S1 to
    S12 and movements, [walking, S12, squatting]. A place in it, from 0, is a label of the data
    set."""
    stream: StreamConfig | None = None
    """Recordings in which people do one of `activities` after the other, with labels in time; null
    is one activity a recording (docs/guide/streams.md)."""
    duration_s: Annotated[
        Positive | None,
        within(1e-9, 1e7, "s"),
        Limits(0, 600),
        ByModel(human=6.0, paper=4.0, file=4.0),
    ] = None
    """Duration of a recording, s."""
    radar: Radar = defaults_of(FmcwRadar)
    radars: Annotated[dict[str, Any] | None, Field(exclude=True)] = None
    """Several radars of the same scenes, {name: keys of radar}, each over what `radar` has; a data
    set of each is made (docs/guide/several_radars.md)."""
    radar_name: str | None = None
    """Name of the one of `radars` that is meant; null is all of them, or `radar`."""
    other_radars: dict[str, Radar] = {}
    """Other radars of the same scenes, {name: keys of radar}, in a config that is written for one
    of `radars`: people are where all of them see them."""
    subject: SubjectConfig = defaults_of(SubjectConfig)
    motion: MotionConfig = defaults_of(MotionConfig)
    timing: TimingConfig = defaults_of(TimingConfig)
    body: BodyConfig = defaults_of(BodyConfig)
    people: Annotated[tuple[PersonConfig, ...], Field(max_length=7)] = ()
    """Other people in the scene, up to seven of {activity, share, subject, motion, timing}; see
    docs/guide/scenes.md."""
    wall: WallConfig | None = None
    """Wall between radar and people; null is free space."""
    room: RoomConfig = defaults_of(RoomConfig)
    snr_db: Decibel | None = 30.0
    """SNR of a raw sample; null: thermal noise by receiver.noise_figure_db, which a board has by
    default, or none where that is null, too."""
    receiver: ReceiverConfig = defaults_of(ReceiverConfig)
    snr_reference: Annotated[
        Literal["free_space", "received"],
        NeedsKey("snr_db", GIVEN),
        NeedsAnyKey(NeedsKey("wall", GIVEN), NeedsKey("radar.beam", GIVEN), BOARD),
    ] = "free_space"
    """Echo that snr_db refers to: as it would be without the wall, in the middle of the antennas'
    beam (free_space); or as it is received, less what the wall and the beam take."""
    on_invalid: Annotated[
        Literal["keep", "redraw", "error"] | None,
        ByModel(human="redraw", paper="keep", file="redraw"),
    ] = None
    """Treatment of a scene in which a body meets the wall or a scatterer leaves the range
    half-band. A scene in which one comes within 5 cm of an antenna is drawn again with `redraw`,
    and refused otherwise."""
    processing: ProcessingConfig = defaults_of(ProcessingConfig)
    cloud: Annotated[CloudConfig, OnlyMaps(("points",))] = defaults_of(CloudConfig)
    image: ImageConfig = defaults_of(ImageConfig)
    maps: Maps = ("stft",)
    """Maps of the data set: `rtm`, `stft`, `fsst`, the latter two also with `_denoised`,
    `_compensated`, `_compensated_denoised`, and all of these with `_cadence`, their
    cadence-velocity diagrams; of boards also `range_doppler`, `range_azimuth`,
    `range_elevation`, `doppler_azimuth`, `doppler_elevation`, `azimuth_time`, `elevation_time`,
    `points`."""
    split: SplitConfig = defaults_of(SplitConfig)
    engine: EngineConfig = defaults_of(EngineConfig)
    output: OutputConfig = defaults_of(OutputConfig)
    _places: tuple[dict[str, str], dict[str, str]] = ({}, {})  # {key: file:line}, {key: option}
    _other_words: dict[str, str] = {}  # {word of the file: our name of the same meaning}

    recordings: RecordingsConfig | None = None
    """Division of recordings into samples by `radhar generate --recordings`: see
    docs/guide/measured.md."""

    @field_validator("activities", mode="before")
    @classmethod
    def _slugs(cls, value: object, info: ValidationInfo) -> object:
        if not isinstance(value, (list, tuple)) or "classes" not in info.data:
            return value  # a mistake in `classes` is reported once
        classes = class_activities(info.data["classes"])
        try:
            chosen = [activity_named(str(name), classes) for name in value]
        except ValueError as error:
            raise value_error(str(error)) from None
        _require_each_once([str(name) for name in value], [a.slug for a in chosen])
        return tuple(
            str(name) if is_other_word(str(name), a.slug) else a.slug
            for name, a in zip(value, chosen, strict=True)
        )  # other words stay until `filled` has noted them

    @property
    def stored(self) -> dict[str, str]:
        """Products that a data set holds as arrays, {name in files: product}.

        They are those of `output.products` and of boards.
        """
        frames = [name for name in self.maps if name in FRAME_MAPS]
        segments = () if self.stream is None else ("segments",)
        ghosts = ("points_kind",) if self.room.faces is not None else ()
        points = (*OF_POINTS, *ghosts) if "points" in frames else ()
        people = OF_FRAMES if frames else ()
        of_frames = (*frames, *points, *people)
        ends = self.radar.ends_in_files if isinstance(self.radar, ArrayRadar) else {"": ""}
        of_subframes = {
            name + in_files: name + end
            for end, in_files in ends.items()
            for name in (*of_frames, "cube", *FRAME_MAPS)
        }
        names = [name + in_files for in_files in ends.values() for name in of_frames]
        names = [*segments, *names, *self.output.products]
        return {name: of_subframes.get(name, name) for name in names}

    @property
    def has_error(self) -> bool:
        """Whether the direct engine makes something whose error is measured."""
        signals = set(self.maps) & {*MAP_NAMES, *CADENCE_MAPS} - {"rtm"}
        return self.engine.kind == "direct" and (
            bool(signals) or isinstance(self.radar, ArrayRadar)
        )

    def filled(self) -> Self:
        """This config, in which null keys take their defaults by model.

        So do activities that a number by activity does not name.
        """
        self._name_classes()
        changed, chosen_window = _missing_defaults(self), self.processing.range_window
        for key, default in of_kind(Request, ByModel):
            name, _, rest = key.rpartition(".")
            holder = at(self, name) if name else self
            if holder is None or rest not in type(holder).model_fields:
                continue  # no wall, or a radar that has no band
            if getattr(holder, rest) is None:
                changed.setdefault(name, {})[rest] = default.values.get(self.motion.model)
        wall = self.wall
        if wall is not None and wall.layers and "size_m" not in wall.model_fields_set:
            changed.setdefault("wall", {})["size_m"] = (None, *wall.size_m[1:])
        if self.receiver.noise_figure_db is not None and "snr_db" not in self.model_fields_set:
            changed.setdefault("", {})["snr_db"] = None
        if isinstance(self.radar, ArrayRadar):
            _fill_for_board(self, self.radar, changed)
        if self.other_radars:
            changed.setdefault("", {})["other_radars"] = self._filled_others()
        for name, value in changed.pop("", {}).items():
            object.__setattr__(self, name, value)
        for name, values in changed.items():
            outer, _, inner = name.partition(".")
            section_filled = _with_defaults(getattr(self, outer), values, inner)
            object.__setattr__(self, outer, section_filled)
        if self.people:
            filled = tuple(self._filled_person(n) for n in range(1, len(self.people) + 1))
            object.__setattr__(self, "people", filled)
        reads_ends = self.processing.range_reference == "start" and not isinstance(
            self.radar, ArrayRadar
        )
        if reads_ends and not chosen_window:
            none = {"range_window": "rectangular"}  # as its sum reads the ends of a chirp
            object.__setattr__(self, "processing", _with_defaults(self.processing, none))
        if self.motion.model == "paper" and self.processing.window_s is None:
            window = {"window_s": PAPER_WINDOW * nominal(self.duration_s)}
            object.__setattr__(self, "processing", _with_defaults(self.processing, window))
        if self.motion.model == "human" and self.image.range_limits_m is None:
            limits = {"range_limits_m": range_zone(self)}
            object.__setattr__(self, "image", _with_defaults(self.image, limits))
        self._fill_size()
        return self

    def _filled_others(self) -> dict[str, Any]:
        """Other radars with their defaults, in the order of the alphabet."""
        others = sorted(self.other_radars.items())
        return {name: _filled_radar(radar, self.motion.model) for name, radar in others}

    def of_other_radar(self, name: str) -> Self:
        """Config of the same scenes with another of their radars in the place of this one."""
        others = {key: one for key, one in self.other_radars.items() if key != name}
        if self.radar_name is not None:
            others = dict(sorted({**others, self.radar_name: self.radar}.items()))
        changed = {"radar": self.other_radars[name], "radar_name": name, "other_radars": others}
        return self.model_copy(update=changed)

    def _name_classes(self) -> None:
        """Call activities by our names, and enter movements that are classes in `classes`."""
        words = dict(self._other_words)
        for own_class in self.classes.values():
            if isinstance(own_class, SequenceConfig):
                words |= own_class.take_other_words()
        chosen = self.stream_activities
        pairs = [] if self.activities == "all" else [*zip(self.activities, chosen, strict=True)]
        for number, person in enumerate(self.people, 1):
            with suppress(ValueError):  # of names that are unknown, which checks report
                pairs += zip(person.names, self.activities_of(number), strict=True)
        if self.activities != "all":
            named = [self._class_called(*pair) for pair in pairs[: len(chosen)]]
            object.__setattr__(self, "activities", tuple(a.slug for a in named))
            for activity in named:
                object.__setattr__(self, "classes", self.with_class_of(activity).classes)
            pairs = [
                pair for pair, a in zip_longest(pairs, named) if a is None or a.slug == pair[1].slug
            ]
        words |= {word: a.slug for word, a in pairs if is_other_word(word, a.slug)}
        self._other_words = words

    def _class_called(self, word: str, activity: Activity) -> Activity:
        """The class of an activity, called by the word that somebody used for our movement.

        Under `motion.model: human` movements beside the twelve are entered in `classes`.
        """
        slug, name = activity.slug, plain_word(word)
        is_ours = slug in MOVEMENTS and slug not in {*self.classes, *TWELVE}
        if activity.is_nobody or not (is_ours and is_other_word(word, slug) and is_new_slug(name)):
            return activity
        if self.motion.model != "human":
            return activity  # refused elsewhere
        classes = {**self.classes, name: movement_class(slug)}
        object.__setattr__(self, "classes", classes)
        return class_activities(classes)[name]

    def with_class_of(self, activity: Activity) -> Self:
        """Config whose `classes` have that of an activity which is a movement.

        Other activities, and `motion.model` other than human, leave it as it is.
        """
        slug = activity.slug
        is_known = slug in self.classes or slug in TWELVE or activity.motion is not None
        if is_known or slug not in MOVEMENTS or self.motion.model != "human":
            return self
        return self.model_copy(update={"classes": {**self.classes, slug: movement_class(slug)}})

    @property
    def other_words(self) -> Mapping[str, str]:
        """Words that somebody used for names of ours, {word: name}; scenes have none."""
        return self._other_words

    def without_other_words(self) -> Self:
        """Copy that has forgotten them, and equals one that is read from what it writes."""
        copy = self.model_copy()
        copy._other_words = {}
        return copy

    def _fill_size(self) -> None:
        """Give images the width of a stream's time steps, or, of maps of frames, a pixel a cell."""
        height, width = self.image.size_px
        if self.duration_s is None:
            return
        seconds, is_sheet = nominal(self.duration_s), bool({*FRAME_MAPS} & {*self.maps})
        has_usual_size = is_sheet or self.image.kind == "cfar"  # whose window counts pixels
        if self.stream is not None:
            if height == width:
                width = self.stream.columns_of(seconds)
        elif "size_px" not in self.image.model_fields_set and not has_usual_size:
            height, width = size_of_frames(self.radar, seconds) or (height, width)
        if (height, width) != self.image.size_px:
            size = {"size_px": (height, width)}
            object.__setattr__(self, "image", _with_defaults(self.image, size))

    def of_person(self, number: int) -> Self:
        """Config of one of `people`, 1 the first: with their numbers at the top level."""
        person = self.people[number - 1]
        sections = {
            "subject": person.subject,
            "motion": person.motion,
            "timing": person.timing,
            "people": (),
        }
        classes = self.classes if person.classes is None else person.classes
        stream = self.stream if STREAM in person.names else None
        if stream is not None:
            strip = stream.zone.strips(1 + len(self.people))[number]
            stream = stream.model_copy(update={"zone": strip})
        return self.model_copy(update={**sections, "classes": classes, "stream": stream})

    def activities_of(self, number: int) -> tuple[Activity, ...]:
        """List the activities that one of `people` may do.

        Raises:
            ValueError: there is no such activity.
        """
        by_slug = self.listed_classes
        return tuple(activity_named(name, by_slug) for name in self.people[number - 1].names)

    def _filled_person(self, number: int) -> PersonConfig:
        filled, person = self.of_person(number).filled(), self.people[number - 1]
        motion, aside, zoned = filled.motion, uniform(-1.5, 1.5), STREAM in person.names
        if motion.cross_range_m is None and motion.range_m is not None:
            motion = motion.model_copy(update={"cross_range_m": aside})
        elif motion.cross_range_m is None and not (
            zoned or "cross_range_m" in motion.place.model_fields_set
        ):
            place = motion.place.model_copy(update={"cross_range_m": aside})
            motion = motion.model_copy(update={"place": place})
        changed = {"motion": motion, "timing": filled.timing, "activity": self._doing_of(number)}
        return person.model_copy(update=changed)

    def _doing_of(self, number: int) -> str | OneOf:
        """Return the activity of one of `people`, by our names where other words were used."""
        person = self.people[number - 1]
        names = [self._other_words.get(name, name) for name in person.names]
        return names[0] if isinstance(person.activity, str) else OneOf(choice=tuple(names))

    def samples_of(self, activity: Activity) -> int:
        """Count the samples of an activity."""
        if self.stream is not None and activity.slug == STREAM:
            return self.stream.count
        samples: int = for_activity(self.samples_per_class, activity)
        return samples

    @property
    def places_people(self) -> bool:
        """Whether a stream that is still to be drawn says where people are."""
        return self.stream is not None and STREAM not in self.classes

    @property
    def own_activities(self) -> dict[str, Activity]:
        """{slug: activity} of the classes of one's own, and of streams."""
        activities = class_activities({s: c for s, c in self.classes.items() if not _is_drawn(c)})
        if self.stream is None:
            return activities
        number = 1 + max(a.number for a in (*ACTIVITIES, *activities.values()))
        movements = _movements_of_stream(self.stream_activities)
        return activities | {STREAM: Activity(number, STREAM, movements)}

    @property
    def every_class(self) -> tuple[Activity, ...]:
        """Every class that anybody may show.

        First the chosen ones, whose place here is their label, then the others of the twelve and of
        `classes`, and movements, which only `people` do.
        """
        every = self.listed_classes
        for number in range(1, len(self.people) + 1):
            with suppress(ValueError):  # of names that are unknown, which checks report
                every |= {a.slug: a for a in self.activities_of(number) if a.slug not in every}
        return (*every.values(),)

    @property
    def listed_classes(self) -> dict[str, Activity]:
        """{slug: activity} of the chosen ones, then the others of the twelve and of `classes`."""
        known = {a.slug: a for a in ACTIVITIES} | self.own_activities
        return {a.slug: a for a in self.chosen_activities} | known

    @property
    def chosen_activities(self) -> tuple[Activity, ...]:
        """The activities to build, in the order of `activities`; a place here, from 0, is a label.

        `activities: all` is S1 to S12, then those of `classes`; with `motion.model: file` only the
        latter. Those of `add_activity` have the numbers after these, which name random streams.
        Of streams it is the one class of all recordings.
        """
        return self.stream_activities if self.stream is None else (self.own_activities[STREAM],)

    @property
    def stream_activities(self) -> tuple[Activity, ...]:
        """The activities that `activities` names, in its order: those of which streams consist."""
        classes = class_activities({s: c for s, c in self.classes.items() if not _is_drawn(c)})
        if self.activities == "all":
            twelve = {} if self.motion.model == "file" else {a.slug: a for a in ACTIVITIES}
            return (*sorted((twelve | classes).values(), key=lambda a: a.number),)
        chosen = [class_called(slug, classes) for slug in self.activities]
        numbers = count(1 + max(a.number for a in (*ACTIVITIES, *classes.values())))
        return tuple(a if a.motion is None else replace(a, number=next(numbers)) for a in chosen)

    def depends_on(self, activity: Activity, key: str) -> bool:
        """Whether scenes of an activity depend on the number of this dotted key."""
        value_at = partial(at, self)
        if not all(one.holds(value_at) for one in conditions(Request, key)):
            return False
        if key.startswith("classes."):
            return key.startswith(f"classes.{activity.slug}.")
        if key.startswith("motion.place.") and not self._has_place(activity, key):
            return False
        uses = _uses().get(key)
        if uses is None or activity.motion is not None:
            return uses is None or key in activity.uses
        names = uses.get(self.motion.model)
        if names is None or self.files_of(activity) is not None:
            return False
        return not names or not names.isdisjoint((activity.label, *activity.movements))

    def _has_place(self, activity: Activity, key: str) -> bool:
        """Whether people who do this are where a key of `motion.place` says, not at a start."""
        start = ["range_m"] + ["cross_range_m"] * key.endswith(".cross_range_m")
        return all(for_activity(getattr(self.motion, name), activity) is None for name in start)

    def users_of(self, key: str) -> tuple[str, ...]:
        """Movements and activities that use the number of a dotted key under the model of motion.

        Empty where the model does not know it, and where everybody uses it.
        """
        names = set(_uses().get(key, {}).get(self.motion.model, ()))
        if names.issuperset(EXERCISES):
            names = names.difference(EXERCISES) | {"exercises"}
        activities = [one.slug for one in ACTIVITIES if one.label in names]
        return (*(name for name in (*MOVEMENTS, "exercises") if name in names), *activities)

    @property
    def has_noise(self) -> bool:
        """Whether a receiver adds noise to the echo."""
        return self.snr_db is not None or self.receiver.noise_figure_db is not None

    def files_of(self, activity: Activity) -> FilesConfig | None:
        """The files of an activity, None where a model makes its motion."""
        section = self.classes.get(activity.slug)
        return section if isinstance(section, FilesConfig) else None


class MeasuredRequest(Section):
    """A data set of recordings, which `radhar generate --recordings` makes of a `Config`."""

    # What else data sets are asked for: here are no other people, no noise, no further products.
    people: ClassVar[tuple[PersonConfig, ...]] = ()
    stream: ClassVar[None] = None
    snr_db: ClassVar[None] = None
    has_noise: ClassVar[bool] = False
    engine: ClassVar[EngineConfig] = defaults_of(EngineConfig)

    seed: Seed
    classes: Classes
    radar: Radar
    processing: ProcessingConfig
    image: ImageConfig
    maps: Maps
    split: SplitConfig
    output: OutputConfig
    recordings: RecordingsConfig

    @property
    def duration_s(self) -> float:
        """Duration of a window, s."""
        return self.recordings.window_s

    @property
    def stored(self) -> tuple[str, ...]:
        """Products that a data set holds as arrays: maps of frames, recorded points and joints."""
        of_frames = tuple(name for name in self.maps if name in FRAME_MAPS and name != "points")
        joints = ("skeleton",) if self.recordings.joints else ()
        return (*of_frames, *OF_POINTS, *joints) if "points" in self.maps else of_frames

    def samples_of(self, activity: Activity) -> int:
        """Count the windows of an activity."""
        return self.recordings.counts.get(activity.slug, 0)

    @cached_property
    def every_class(self) -> tuple[Activity, ...]:
        """Every class: those that have windows, whose place is their label, then the others."""
        known = {a.slug: a for a in ACTIVITIES} | class_activities(self.classes)
        new = sorted(self.recordings.counts.keys() - known.keys())
        known |= {slug: Activity(len(known) + n, slug) for n, slug in enumerate(new, 1)}
        return tuple(sorted(known.values(), key=lambda activity: not self.samples_of(activity)))

    @property
    def chosen_activities(self) -> tuple[Activity, ...]:
        """Classes that have windows: of the twelve, of `classes`, then new ones by the alphabet."""
        return tuple(filter(self.samples_of, self.every_class))


AnyRequest: TypeAlias = Request | MeasuredRequest


def _require_each_once(names: Sequence[str], slugs: Sequence[str]) -> None:
    """Refuse a list of names that is empty or has a class twice, whatever it is called."""
    if not names:
        raise value_error("should name at least one activity")
    first = dict[str, str]()
    for name, slug in zip(names, slugs, strict=True):
        if slug in first:
            both = name if name == first[slug] else f"{first[slug]} and {name}"
            raise value_error(f"should name each class once: {both} is {slug} twice")
        first[slug] = name


def _is_drawn(section: ClassConfig) -> bool:
    """Whether a class is the drawn stream of a scene."""
    return isinstance(section, SequenceConfig) and bool(section.labels)


def _movements_of_stream(activities: Iterable[Activity]) -> tuple[str, ...]:
    """Movements that a stream of these activities may have, links and turns included."""
    movements = [name for activity in activities for name in activity.movements]
    states = {s for name in movements for both in MOVEMENTS[name].states.items() for s in both}
    ways = (links_between(a, b) or () for a in sorted(states) for b in sorted(states))
    return tuple(dict.fromkeys((*movements, TURN, *(name for way in ways for name in way))))


def _with_defaults(section: S, values: Mapping[str, Any], inner: str = "") -> S:
    """A section with defaults of other keys' making, which do not count as given.

    Args:
        values: {key: default}.
        inner: key of the section within it whose keys they are; "" for its own.
    """
    if inner:
        values = {inner: _with_defaults(getattr(section, inner), values)}
    filled = section.model_copy(update=dict(values))
    object.__setattr__(filled, "__pydantic_fields_set__", set(section.model_fields_set))
    return filled


def _missing_defaults(c: Request) -> dict[str, dict[str, Any]]:
    """{section: {key: number}} of numbers by activity that lack a default, or our names."""
    by_model, changed = dict(of_kind(Request, ByModel)), dict[str, dict[str, Any]]()
    known = c.listed_classes
    groups = [key for key, field in MotionConfig.model_fields.items() if section(field)]
    for name in ("", "motion", *(f"motion.{group}" for group in groups), "timing"):
        holder: BaseModel = at(c, name) if name else c
        for key, field in type(holder).model_fields.items():
            value = getattr(holder, key)
            if not isinstance(value, PerActivity):
                continue
            written, value = value, _by_our_names(value, known)
            if value is not written:
                changed.setdefault(name, {})[key] = value
            if DEFAULT in value.per_activity:
                continue
            dotted = f"{name}.{key}" if name else key
            usual = field.get_default(call_default_factory=False)
            if dotted in by_model:
                usual = by_model[dotted].values.get(c.motion.model)
            if isinstance(usual, PerActivity):
                numbers = {**usual.per_activity, **value.per_activity}
            elif usual is not None:
                numbers = {DEFAULT: usual, **value.per_activity}
            else:  # the others have none
                continue
            changed.setdefault(name, {})[key] = PerActivity(numbers)
    return changed


def _by_our_names(number: PerActivity[Any], known: Mapping[str, Activity]) -> PerActivity[Any]:
    """A number whose activities have our names where other words were used, each once.

    Args:
        number: the number by activity.
        known: {slug: activity} that is known beside movements.
    """
    names = dict[str, str]()
    for word in number.per_activity:
        try:
            names[word] = word if word == DEFAULT else activity_named(word, known).slug
        except ValueError:  # of an unknown name, which checks report
            names[word] = word
    if all(word == name for word, name in names.items()) or len({*names.values()}) < len(names):
        return number
    return PerActivity({names[word]: one for word, one in number.per_activity.items()})


def _filled_radar(radar: Any, model: str) -> Any:
    """A radar with the defaults of a model of motion, and the pose that a .cfg gives."""
    missing = {
        key.removeprefix("radar."): default.values.get(model)
        for key, default in of_kind(Request, ByModel)
        if key.startswith("radar.")
    }
    fields = type(radar).model_fields
    filled = {k: v for k, v in missing.items() if k in fields and getattr(radar, k) is None}
    return _with_defaults(radar, filled | _pose_of_cfg(radar))


def _pose_of_cfg(radar: Any) -> dict[str, float]:
    """Keys of a radar's place that its .cfg gives and its config does not.

    Raises:
        ValueError: the .cfg cannot be read.
    """
    if not isinstance(radar, ArrayRadar):
        return {}
    try:
        pose = radar.stated_pose
    except CaptureError as error:
        raise value_error(str(error)) from None
    return {key: number for key, number in pose.items() if key not in radar.model_fields_set}


def _fill_for_board(c: Request, radar: ArrayRadar, changed: dict[str, dict[str, Any]]) -> None:
    """Note the defaults that a board has of its own, for keys that are not given."""
    try:
        _ = radar.timing
    except CaptureError as error:
        raise value_error(str(error)) from None
    if "snr_db" not in c.model_fields_set:
        changed.setdefault("", {})["snr_db"] = None
    if "noise_figure_db" not in c.receiver.model_fields_set:
        changed.setdefault("receiver", {})["noise_figure_db"] = radar.usual_noise_figure_db
    if "clutter" not in c.processing.model_fields_set:
        clutter = "mean" if radar.removes_mean else "none"
        changed.setdefault("processing", {})["clutter"] = clutter
    if "range_sum" not in c.processing.model_fields_set:
        range_sum = "gated" if radar.has_range else "coherent"
        changed.setdefault("processing", {})["range_sum"] = range_sum
    if "chain" not in c.cloud.model_fields_set:
        changed.setdefault("cloud", {})["chain"] = radar.likely_chain
    for key, number in _pose_of_cfg(radar).items():
        changed.setdefault("radar", {})[key] = number


def size_of_frames(radar: Radar, seconds: float) -> tuple[int, int] | None:
    """Size of a Doppler-time map of frames: a row a Doppler bin, a column a frame.

    Returns:
        (height, width), each within LEAST_PX and the usual size; None of radars whose chirps go on.
    """
    if not isinstance(radar, ArrayRadar) or not (timing := radar.timing).frames_apart:
        return None
    cells = timing.n_doppler, timing.frames_in(seconds)
    limits = ImageConfig().size_px
    height, width = (min(max(c, LEAST_PX), m) for c, m in zip(cells, limits, strict=True))
    return height, width


@cache
def _uses() -> dict[str, dict[str, frozenset[str]]]:
    """{dotted key: {model: users}} of the keys that not everybody uses."""
    uses = dict[str, dict[str, frozenset[str]]]()
    for key, people in of_kind(Request, People):
        uses.setdefault(key, {})["human"] = frozenset(users_of(key, people))
    for key, other in of_kind(Request, Paper):
        uses.setdefault(key, {})["paper"] = frozenset(other.names.split())
    return uses
