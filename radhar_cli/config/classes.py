"""Classes of one's own: sequences of movements, or files of recorded motion."""

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, ClassVar, Generic, Literal, TypeAlias

from pydantic import AfterValidator, Discriminator, Field, Tag, field_validator, model_validator

from radhar_cli.config.sequence import BY_ITSELF, SequenceConfig
from radhar_cli.errors import did_you_mean
from radhar_cli.motion.activities.activity import (
    ACTIVITIES,
    Activity,
    activity_of_movements,
    is_new_slug,
)
from radhar_cli.motion.movements.catalogue import MOVEMENTS
from radhar_cli.motion.movements.standing import NOBODY
from radhar_cli.motion.recorded.joint_sets import JOINT_SETS
from radhar_cli.motion.recorded.names import WANTED
from radhar_cli.motion.recorded.recording import LONGEST_NAME
from radhar_cli.schema.number import Choice, uniform, value_error, vary, within
from radhar_cli.schema.section import N, Section, default_draw

FileSecond = Annotated[float, Field(ge=0, le=1e5, strict=True)]


SPREAD = 0.15  # share by which a movement that is a class takes longer or shorter than usual


def movement_class(name: str) -> SequenceConfig:
    """Class of people who make one movement, whose duration differs from sample to sample."""
    seconds = MOVEMENTS[name].seconds
    durations = () if seconds is None else (vary(seconds, SPREAD),)
    return SequenceConfig(sequence=(name,), durations_s=durations)


MAX_FILES = 1500  # of all classes together


MAX_PATH_LENGTH = 240


SHARE = within(0, 1)
MAX_MEANS = 20  # joints of a file that one joint of ours is the mean of


class FilesConfig(Section, Generic[N]):
    """A class whose motion is recorded: BVH, AMC, npz and others; a list of them is enough."""

    files: dict[str, str]
    """Motion files {path: SHA-256}; a list of paths and patterns when a person writes it."""
    skeleton: Annotated[str, Field(max_length=MAX_PATH_LENGTH)] | None = None
    """ASF file of AMC files, where it is not beside them."""
    joints: dict[str, str | tuple[str, ...]] | str = {}
    """Names of joints {radhar's: the file's, or a list whose mean it is}, where the tables of names
    do not know the file's, or their numbers from 0 where it has no names; or the set in whose order
    the file's joints are, such as coco17."""
    up: Literal["x", "y", "z", "-x", "-y", "-z"] | None = None
    """Axis of the files that points up; null is that of their format, where its maker says one."""
    unit_m: Annotated[float, Field(ge=1e-6, le=1e3, strict=True)] | None = None
    """Length unit of the files; null is that of their format, else the one of m, cm and mm which
    makes a person."""
    left_handed: Annotated[bool, Field(strict=True)] = False
    """Whether the axes of the files are left-handed, or a camera mirrors: knees bend backwards."""
    rate_hz: Annotated[float, Field(ge=1, le=1e4, strict=True)] | None = None
    """Frames per second of the files, instead of their own."""
    section_s: tuple[FileSecond, FileSecond] | None = None
    """Section [from, to] of each file that is used; null is all of it."""
    low_pass_hz: Annotated[float, Field(ge=0.1, le=1e3, strict=True)] | None = 8.0
    """Cut-off of the zero-phase low-pass of the positions; null is no filter."""
    travel: Literal["file", "feet"] = "file"
    """Path of the hips: as the file says, or as the foot on the floor tells, where poses are
    relative to the hips (MediaPipe's world landmarks, Human3.6M)."""
    past_end: Literal["rest", "loop"] = "rest"
    """Motion of people where a file is shorter than the recording: they come to rest, or go on in a
    loop."""
    file: Annotated[int, Field(ge=0, strict=True)] | None = None
    """Number of the one file that is used, from 0; null draws one."""
    start: Annotated[N, SHARE] = default_draw(uniform(0.0, 1.0))
    """Place in the section at which a recording begins, 0 at the earliest, 1 at the latest."""
    playback_speed: Annotated[N, within(0.25, 4)] = default_draw(uniform(0.9, 1.1))
    """Playback rate, seconds of the file per second of the recording."""
    mirror: Annotated[N, SHARE] = default_draw(Choice(choice=(0, 1)))
    """Whether left and right are exchanged: 1 exchanges them."""

    NUMBERS: ClassVar = ("start", "playback_speed", "mirror")

    @model_validator(mode="before")
    @classmethod
    def _list(cls, value: Any) -> Any:
        return {"files": value} if isinstance(value, (list, tuple)) else value

    @field_validator("files", mode="before")
    @classmethod
    def _paths(cls, value: Any) -> Any:
        if isinstance(value, (list, tuple)) and all(isinstance(one, str) for one in value):
            return dict.fromkeys(value, "")
        return value

    @field_validator("files")
    @classmethod
    def _require_motion_files(cls, value: dict[str, str]) -> dict[str, str]:
        from radhar_cli.readers.motion.reading import (  # slow to import
            describe_unknown,
            may_be_motion,
        )

        for path in value:
            if not may_be_motion(path):
                raise value_error(f"{path[:MAX_PATH_LENGTH]}: {describe_unknown(Path(path))}")
            if len(path) > MAX_PATH_LENGTH or "\0" in path:
                raise value_error(f"should be short paths of motion files, not {path!r}")
        if not 0 < len(value) <= MAX_FILES:
            raise value_error(f"should have 1 to {MAX_FILES} files")
        return value

    @field_validator("joints", mode="before")
    @classmethod
    def _require_known_joints(cls, value: Any) -> Any:
        if isinstance(value, str) and value not in JOINT_SETS:
            sets = ", ".join(JOINT_SETS)
            raise value_error(did_you_mean(value, JOINT_SETS, f"joint sets are {sets}"))
        if isinstance(value, str):
            return value
        if not isinstance(value, dict):
            raise value_error("should be {right_knee: NAME, hip: [NAME, NAME], ...} or a joint set")
        for joint, names in value.items():
            if joint not in WANTED:
                raise value_error(
                    did_you_mean(str(joint), WANTED, f"joints are {', '.join(WANTED)}")
                )
            _require_joint_names(joint, names)
        return {joint: _texts_of(names) for joint, names in value.items()}

    @model_validator(mode="after")
    def _require_fitting_files(self) -> "FilesConfig[N]":
        if self.file is not None and self.file >= len(self.files):
            raise value_error(f"should have a file below {len(self.files)}, the number of files")
        if self.skeleton is not None:
            if not self.skeleton.lower().endswith(".asf"):
                raise value_error("should have an .asf file as skeleton")
            if not any(path.lower().endswith((".amc", "*")) for path in self.files):
                raise value_error("should have .amc files with a skeleton")
        if self.section_s is not None and not self.section_s[0] < self.section_s[1]:
            raise value_error("should have a section_s that begins before it ends")
        return self


def _require_joint_names(joint: str, names: Any) -> None:
    """Refuse a value that is neither a name or a number nor a list of them."""
    listed = names if isinstance(names, (list, tuple)) else [names]
    if not 0 < len(listed) <= MAX_MEANS or not all(map(_is_joint_name, listed)):
        raise value_error(
            f"{joint} should be the name of a joint in the file, its number from 0 where it has "
            f"none, or a list of up to {MAX_MEANS} of them, whose mean it is"
        )


def _is_joint_name(name: Any) -> bool:
    """Whether a value is a name, or a whole number from 0."""
    if isinstance(name, int):
        return not isinstance(name, bool) and name >= 0
    return isinstance(name, str) and 0 < len(name) <= LONGEST_NAME


def _texts_of(names: Any) -> str | tuple[str, ...]:
    """Names, or numbers as texts, by which joints without names are known."""
    return tuple(map(str, names)) if isinstance(names, (list, tuple)) else str(names)


def _class_kind(value: Any) -> str:
    of_files = isinstance(value, (FilesConfig, list, tuple))
    of_files |= isinstance(value, dict) and "files" in value
    return "<recordings>" if of_files else "<movements>"


ClassConfig: TypeAlias = Annotated[
    Annotated[SequenceConfig[N], Tag("<movements>")]
    | Annotated[FilesConfig[N], Tag("<recordings>")],
    Discriminator(_class_kind),
]


def _own_classes(value: dict[str, ClassConfig]) -> dict[str, ClassConfig]:
    twelve = {activity.slug for activity in ACTIVITIES}
    for slug, section in value.items():
        if getattr(section, "sequence", ()) == (NOBODY,) != (slug,):
            raise value_error(f"should be called {NOBODY}, which is a class by itself: {BY_ITSELF}")
        if not (is_new_slug(slug) or (isinstance(section, FilesConfig) and slug in twelve)):
            raise value_error(f"should have a new name of a-z, 0-9 and _ instead of {slug!r}")
    if (
        sum(len(section.files) for section in value.values() if isinstance(section, FilesConfig))
        > MAX_FILES
    ):
        raise value_error(f"should have at most {MAX_FILES} files in all")
    return value


# At most 200, as labels are uint8.
Classes = Annotated[dict[str, ClassConfig], Field(max_length=200), AfterValidator(_own_classes)]


def class_activities(classes: Mapping[str, ClassConfig]) -> dict[str, Activity]:
    """{slug: activity} of a config's classes: S13 and so on, or one of the twelve from files."""
    activities: dict[str, Activity] = {}
    twelve = {activity.slug: activity for activity in ACTIVITIES}
    number = len(ACTIVITIES)
    for slug, section in classes.items():
        if slug in twelve:
            activities[slug] = replace(twelve[slug], movements=())
            continue
        number += 1
        movements = section.possible_movements if isinstance(section, SequenceConfig) else ()
        activities[slug] = activity_of_movements(slug, movements, number)
    return activities
