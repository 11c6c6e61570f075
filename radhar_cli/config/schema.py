"""The schema of a data set's YAML file: one class a section, then the whole.

Units stand in the keys. Every number of a scene (`SCENE_KEYS`) may be fixed or drawn.
"""

import ast
import inspect
from collections.abc import Mapping
from dataclasses import replace
from functools import cached_property
from itertools import pairwise
from math import floor, sqrt
from pathlib import PurePosixPath
from textwrap import dedent
from typing import Annotated, Any, ClassVar, Generic, Literal, TypeAlias, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    GetJsonSchemaHandler,
    Tag,
    ValidationInfo,
    field_validator,
    model_validator,
)
from pydantic_core import CoreSchema, PydanticCustomError

from radhar_cli.activity import (
    ACTIVITIES,
    DEFAULT,
    MOVEMENTS,
    TWELVE,
    Activity,
    activity_named,
    is_new_slug,
    sequence_uses,
)
from radhar_cli.config.checks import MIN_WINDOW, problems
from radhar_cli.config.number import (
    Angle,
    AtLeastOne,
    Choice,
    Coordinate,
    Decibel,
    Normal,
    NotNegative,
    Number,
    Positive,
    Real,
    Uniform,
    Vary,
    Vector,
    support,
    within,
)
from radhar_cli.errors import did_you_mean
from radhar_cli.light import SPEED_OF_LIGHT
from radhar_cli.motion.files.names import WANTED
from radhar_cli.motion.files.reading import SUFFIXES
from radhar_cli.registry import is_known, own_products
from radhar_cli.rounding import half_up

Flag: TypeAlias = Annotated[bool, Field(strict=True)]


class Section(BaseModel):
    """Base of all config models."""

    model_config = ConfigDict(
        extra="forbid",
        frozen=True,
        validate_default=True,
        allow_inf_nan=False,
    )

    @classmethod
    def descriptions(cls) -> dict[str, str]:
        """What stands under each field in the source; Pydantic would read it at every start."""
        try:
            body = ast.parse(dedent(inspect.getsource(cls))).body[0]
        except OSError:  # PerActivity[...] is written nowhere
            return {}
        assert isinstance(body, ast.ClassDef)
        return {
            ast.unparse(field.target): inspect.cleandoc(text.value.value)
            for field, text in pairwise(body.body)
            if isinstance(field, ast.AnnAssign)
            and isinstance(text, ast.Expr)
            and isinstance(text.value, ast.Constant)
            and isinstance(text.value.value, str)
        }

    @classmethod
    def __get_pydantic_json_schema__(
        cls, schema: CoreSchema, handler: GetJsonSchemaHandler
    ) -> dict[str, Any]:
        document = handler(schema)
        properties = handler.resolve_ref_schema(document)["properties"]
        for name, text in cls.descriptions().items():
            if name in properties:
                properties[name]["description"] = text
        return document


class RadarConfig(Section):
    """Waveform, antenna positions and gains; every number may be drawn."""

    carrier_hz: Annotated[Positive, within(1e6, 1e13, "Hz")] = 77e9
    """At the start of the chirp."""
    bandwidth_hz: Annotated[Positive, within(1e3, 1e12, "Hz")] | None = None
    """Swept by a chirp; null is the model's: 1e9 of human, 4e9 of paper and file."""
    prf_hz: Annotated[Positive, within(1e-3, 1e7, "Hz")] | None = None
    """Chirps per second; null is the model's: 10000 of human, 5000 of paper and file."""
    adc_rate_hz: Annotated[Positive, within(1e-3, 1e13, "Hz")] = 10e6
    """Samples per second within a chirp."""
    chirp_s: Annotated[Positive, within(1e-12, 1e4, "s")] = 40e-6
    """Shorter than 1/prf_hz."""
    tx_m: Vector = (0.4, -0.1, 1.5)
    """Transmitter: range, cross-range, height."""
    rx_m: Vector = (0.4, 0.1, 1.5)
    """Receiver: range, cross-range, height."""
    antenna_gain_dbi: Annotated[Decibel, within(-150, 150, "dBi")] = 6.0
    """Of each antenna."""
    antenna_isolation_db: Decibel = 10.0
    """Only a raw echo shows the leakage."""
    residual_video_phase: Flag = False
    """Keep the term pi K tau^2."""


T = TypeVar("T")


class PerActivity(Section, Generic[T]):
    """``{per_activity: {default: 2.0, walking: 1.0, S9: 1.0}}``: a number by activity.

    Names that are none of the twelve's are a config's own classes, which `Config` knows.
    """

    per_activity: dict[str, T]

    @classmethod
    def model_parametrized_name(cls, params: tuple[Any, ...]) -> str:
        """Such as PerActivity[Speed], by which pickle finds the class again in any process.

        Raises:
            TypeError: the number has no name in this module before the class is made of it.
        """
        for name, kind in globals().items():
            if kind is params[0]:
                return f"{cls.__name__}[{name}]"
        raise TypeError(f"{params[0]}: should have a name in {__name__}")

    @field_validator("per_activity")
    @classmethod
    def _by_slug(cls, value: dict[str, T]) -> dict[str, T]:
        numbers: dict[str, T] = {}
        for name, number in value.items():
            slug = TWELVE.get(name.strip().lower(), name)
            if slug in numbers:
                raise PydanticCustomError("activity", "should name {slug} once", {"slug": slug})
            numbers[slug] = number
        if DEFAULT not in numbers:
            raise PydanticCustomError(
                "activity", "should have a 'default' beside the activities it names"
            )
        return numbers


def _kind(value: Any) -> str:
    per_activity = isinstance(value, PerActivity) or (
        isinstance(value, dict) and "per_activity" in value
    )
    return "per_activity" if per_activity else "same"


# One alias a constraint: pydantic cannot substitute a type variable inside an Annotated union.
_Either = Discriminator(_kind)
Speed = Annotated[NotNegative, within(0, 1e4, "m/s")]
Frequency = Annotated[NotNegative, within(0, 1e3, "Hz")]
Seconds = Annotated[NotNegative, within(0, 1e7, "s")]
SpeedBy: TypeAlias = Annotated[
    Annotated[Speed, Tag("same")] | Annotated[PerActivity[Speed], Tag("per_activity")], _Either
]
FrequencyBy: TypeAlias = Annotated[
    Annotated[Frequency, Tag("same")] | Annotated[PerActivity[Frequency], Tag("per_activity")],
    _Either,
]
SecondsBy: TypeAlias = Annotated[
    Annotated[Seconds, Tag("same")] | Annotated[PerActivity[Seconds], Tag("per_activity")], _Either
]
AngleBy: TypeAlias = Annotated[
    Annotated[Angle, Tag("same")] | Annotated[PerActivity[Angle], Tag("per_activity")], _Either
]
CoordinateBy: TypeAlias = Annotated[
    Annotated[Coordinate, Tag("same")] | Annotated[PerActivity[Coordinate], Tag("per_activity")],
    _Either,
]


def for_activity(value: T | PerActivity[T], activity: Activity) -> T:
    """Return the number that holds for one activity."""
    if isinstance(value, PerActivity):
        numbers: dict[str, T] = value.per_activity
        return numbers[activity.slug if activity.slug in numbers else DEFAULT]
    return value


Samples = Annotated[int, Field(ge=1, le=10_000_000, strict=True)]
SamplesBy: TypeAlias = Annotated[
    Annotated[Samples, Tag("same")] | Annotated[PerActivity[Samples], Tag("per_activity")], _Either
]

# Under `motion.model: human` numbers have narrower limits yet: checks.HUMAN_LIMITS.
Metres = Annotated[NotNegative, within(0, 1, "m")]
Rate = Annotated[NotNegative, within(0, 20, "Hz")]
Ratio = Annotated[NotNegative, within(0, 10)]
Signed = Annotated[Number, within(-1, 1)]
RatioBy: TypeAlias = Annotated[
    Annotated[Ratio, Tag("same")] | Annotated[PerActivity[Ratio], Tag("per_activity")], _Either
]
SignedBy: TypeAlias = Annotated[
    Annotated[Signed, Tag("same")] | Annotated[PerActivity[Signed], Tag("per_activity")], _Either
]


class SubjectConfig(Section):
    """The person; without a weight it is 26 kg/m^2 times the height squared.

    Of the human model alone, standard deviations of the sway, amplitude and rate of breathing
    (chest) and of the pulse (heart).
    """

    height_m: Annotated[Positive, within(0.1, 10, "m")] = Uniform(uniform=(1.5, 1.9))
    """Stature."""
    weight_kg: Annotated[Positive, within(1e-3, 1e6, "kg")] | None = None
    """null is 26 kg/m^2 times the height squared."""
    sway_ahead_m: Metres = Uniform(uniform=(0.002, 0.006))
    """Standard deviation of a standing person's sway."""
    sway_aside_m: Metres = Uniform(uniform=(0.0015, 0.0035))
    """The same to the side."""
    breathing_hz: Rate = Normal(normal=(0.25, 0.04), min=0.15, max=0.4)
    """Rate of breathing."""
    chest_m: Metres = Uniform(uniform=(0.002, 0.006))
    """Amplitude of breathing."""
    pulse_hz: Rate = Normal(normal=(1.15, 0.12), min=0.8, max=1.8)
    """Heart rate."""
    heart_m: Metres = Uniform(uniform=(0.0001, 0.0004))
    """Amplitude of the pulse."""


FallName = Literal["forward", "backward", "sideways"]
FALLS: tuple[FallName, ...] = FallName.__args__  # type: ignore[attr-defined]


class Falls(Section):
    """``{choice: [forward, forward, sideways]}``: one of the directions, equally likely."""

    choice: Annotated[tuple[FallName, ...], Field(min_length=1)]

    def drawn(self, u: float) -> FallName:
        """The direction at a fraction u, 0 to 1, of the draws."""
        ordered = sorted(self.choice, key=FALLS.index)
        return ordered[min(int(u * len(ordered)), len(ordered) - 1)]


class MotionConfig(Section):
    """Where people stand, where they head and how they move.

    range_m to angle_deg: all. speed_mps: not of files. gait_hz to turn_deg: the paper's. turn_deg
    on: the human model's. What another model alone knows is ignored; what is null takes the value
    of the model (MODEL_DEFAULTS, docs/motion.md). folder: paths of files are relative to it; it is
    not part of a data set's identity.
    """

    model: Literal["human", "paper", "file"] = "human"
    """Of people, of the paper, or motion files for every class."""
    folder: Annotated[str | None, Field(exclude=True, max_length=1000)] = None
    """Folder that paths of motion files are relative to; not part of a data set's identity."""
    range_m: CoordinateBy | None = None
    """Where people are: the torso (paper), the feet at first (human); null is the model's."""
    cross_range_m: CoordinateBy = 0.0
    """The same across."""
    angle_deg: AngleBy | None = None
    """Heading; 0 faces away from the radar, 180 faces it; null is the model's."""
    speed_mps: SpeedBy | None = None
    """Of walking; null is the model's."""
    gait_hz: FrequencyBy = 1.0
    """paper: strides per second."""
    thigh_deg: AngleBy = Vary(vary=(30.0, 0.2))
    """paper: amplitude."""
    calf_deg: AngleBy = Vary(vary=(45.0, 0.2))
    """paper: amplitude."""
    arm_deg: AngleBy = Vary(vary=(35.0, 0.2))
    """paper: amplitude."""
    turn_deg: AngleBy = Vary(vary=(45.0, 0.2))
    """How far S7 turns to each side."""
    rotation_hz: FrequencyBy = Vary(vary=(0.45, 0.2))
    """human: turns to both sides per second."""
    period_scale: RatioBy = Normal(normal=(0.95, 0.04), min=0.85, max=1.05)
    """Stride time relative to Boulic and Thalmann's."""
    cycle_phase: SignedBy = Uniform(uniform=(-0.5, 0.5))
    """Where in their cycle steady walks, punches, kicks and turns are at 0 s."""
    arm_swing: RatioBy = Uniform(uniform=(0.6, 1.3))
    """Relative to Boulic and Thalmann's."""
    trunk_pitch_deg: AngleBy = Normal(normal=(3.0, 2.0), min=-2.0, max=8.0)
    """Forward pitch of a walker's trunk."""
    step_width: RatioBy = Normal(normal=(0.063, 0.011), min=0.03, max=0.1)
    """Of a walker, relative to the stature."""
    step_asymmetry: SignedBy = Normal(normal=(0.0, 0.02), min=-0.05, max=0.05)
    """Of left relative to right steps."""
    surge: RatioBy = Normal(normal=(0.125, 0.015), min=0.09, max=0.17)
    """Amplitude of the hip's speed within each step, relative to the mean speed."""
    surge_asymmetry: SignedBy = Normal(normal=(0.0, 0.05), min=-0.1, max=0.1)
    """Of the right step's surge relative to the left one's."""
    ragged_speed: RatioBy = Uniform(uniform=(0.0, 0.06))
    """Standard deviation of the speed over time, relative to the speed."""
    stride_jitter: RatioBy = Uniform(uniform=(0.0, 0.03))
    """Standard deviation of the stride time, relative to it."""
    width_jitter_m: RatioBy = Uniform(uniform=(0.0, 0.02))
    """Standard deviation of half the step width from stride to stride, m."""
    lane_m: CoordinateBy = 0.0
    """Walkers turn round whenever they have gone so far; 0 is never."""
    lane_start: RatioBy = Uniform(uniform=(0.0, 1.0))
    """Share of the first lane that lies behind them at 0 s."""
    speed_up: RatioBy = 0.6
    """Strides in which a walker gains speed from rest."""
    punch_hz: FrequencyBy = Vary(vary=(0.7, 0.15))
    """Pairs of punches, right and left, per second."""
    kick_hz: FrequencyBy = Vary(vary=(0.45, 0.1))
    """Kicks per second."""
    strike_scale: RatioBy = Normal(normal=(1.0, 0.12), min=0.8, max=1.25)
    """Duration of a punch or kick, relative to the usual one."""
    tempo_jitter: RatioBy = Uniform(uniform=(0.0, 0.1))
    """Relative standard deviation of the time from one punch or kick to the next."""
    size_jitter: RatioBy = Uniform(uniform=(0.0, 0.1))
    """Relative standard deviation of the size from one punch or kick to the next."""
    bend_deg: AngleBy = Normal(normal=(72.0, 5.0), min=60.0, max=85.0)
    """S4: pitch of the trunk."""
    dwell_s: SecondsBy = Uniform(uniform=(0.2, 0.6))
    """S4: time at the floor."""
    haste: RatioBy = 0.0
    """S4: share of the way down before whose end people come up."""
    seat_height: RatioBy = Normal(normal=(0.285, 0.015), min=0.25, max=0.32)
    """Height of the seated hip, relative to the stature."""
    lean_deg: AngleBy = Normal(normal=(42.0, 8.0), min=25.0, max=58.0)
    """Trunk ahead while rising."""
    recline_deg: AngleBy = 0.0
    """Trunk backwards in the seat."""
    lap: RatioBy = 1.0
    """How far the hands of who sits are on the lap (1); 0 is beside the seat."""
    recline_from: RatioBy = 0.7
    """S5: share of the duration from which on the trunk leans back."""
    squat: SignedBy = Uniform(uniform=(-1.0, 1.0))
    """S4: from over straight legs (-1) to deep in the knees (1)."""
    reach_deg: AngleBy = 12.0
    """S4: of the right arm ahead of the vertical."""
    free_arm: SignedBy = 0.55
    """S4: what the left arm does of what the right one does; below 0 it swings back."""
    stagger: RatioBy = 0.0
    """S4 to S6: share of the movement by which some joints lead and others lag."""
    step_m: RatioBy = Uniform(uniform=(0.0, 0.5))
    """Steps back before sitting down (S5), ahead after standing up (S6), around picking up (S4)."""
    look_deg: AngleBy = Uniform(uniform=(-40.0, 40.0))
    """S5: turn of the trunk to look behind."""
    settle_size: RatioBy = Uniform(uniform=(0.0, 3.0))
    """S4 to S6: size of the fidgets around the end."""
    kneel_s: SecondsBy = Uniform(uniform=(0.0, 0.6))
    """Pause on the knees in a forward fall."""
    heels_deg: AngleBy = 0.0
    """How far the shanks swing up as people land on their knees in a forward fall."""
    fall: FallName | Falls = "forward"
    """Direction, or drawn: {choice: [forward, forward, sideways]}."""
    fidget_hz: FrequencyBy = Uniform(uniform=(0.0, 0.4))
    """How often a standing or seated person fidgets."""
    fidget_size: RatioBy = Uniform(uniform=(0.5, 1.5))
    """Size of the fidgets, relative to the usual one."""
    shuffle_hz: FrequencyBy = Uniform(uniform=(0.0, 0.2))
    """Steps of some centimetres, S1 and after S4."""
    idle_from_s: SecondsBy = Uniform(uniform=(0.0, 1000.0))
    """Time at 0 s of the processes of sway, breath, pulse and ragged speed."""


class TimingConfig(Section):
    """When the phases of an activity begin and how long they last.

    What is null takes the value of the model (MODEL_DEFAULTS).
    """

    seat_start_s: SecondsBy = 0.5
    """S5, S6."""
    seat_duration_s: SecondsBy | None = None
    """S5, S6; null is the model's."""
    grab_start_s: SecondsBy = 0.5
    """S4."""
    grab_duration_s: SecondsBy = Normal(normal=(2.5, 0.5), min=1.6, max=3.6)
    """S4, down and up together."""
    rise_start_s: SecondsBy = 0.5
    """S9, S11."""
    rise_duration_s: SecondsBy | None = None
    """S9, S11; null is the model's."""
    walk_begin_s: SecondsBy | None = None
    """human: S8 stands until then; null: walks all the time."""
    walk_start_s: SecondsBy | None = None
    """S9, S11; null is the model's: of people, when risen."""
    walk_stop_s: SecondsBy = 2.0
    """S10, S12."""
    sit_duration_s: SecondsBy | None = None
    """S10; null is the model's."""
    fall_duration_s: SecondsBy | None = None
    """S12; null is the model's."""
    blend_s: SecondsBy = 0.3
    """paper: raised-cosine ramps of the gait, in and out; 0 is a hard switch."""
    overlap_s: SecondsBy = 0.0
    """human: the second movement of S9 to S12 begins so long before the first rests."""


MIN_MOVEMENT_S = 0.3


FileSecond = Annotated[float, Field(ge=0, le=1e5, strict=True)]


class SequenceConfig(Section):
    """A class of your own: movements one after the other, joined at rest."""

    sequence: Annotated[tuple[str, ...], Field(min_length=1, max_length=64)]
    """Names of movements (`radhar_cli.activity.MOVEMENTS`)."""
    durations_s: tuple[Seconds | None, ...] = ()
    """Of each; null is the usual one, of the last one until the recording ends."""
    pauses_s: tuple[Seconds, ...] = ()
    """At rest before each; not given, none."""

    @model_validator(mode="after")
    def _joined(self) -> "SequenceConfig":
        count, last = len(self.sequence), len(self.sequence) - 1
        if not self.durations_s:
            object.__setattr__(self, "durations_s", (None,) * count)
        if not self.pauses_s:
            object.__setattr__(self, "pauses_s", (0.0,) * count)
        if not len(self.durations_s) == len(self.pauses_s) == count:
            raise _wrong("should have as many durations_s, and pauses_s, as movements")
        state = None
        for n, (name, duration) in enumerate(zip(self.sequence, self.durations_s, strict=True)):
            movement = MOVEMENTS.get(name)
            if movement is None:
                hint = did_you_mean(name, MOVEMENTS, f"movements are {', '.join(MOVEMENTS)}")
                raise _wrong(f"{name!r} is not a movement; {hint}")
            if state not in (None, movement.before):
                raise _wrong(
                    f"should be joined at rest: {name} begins {movement.before}, "
                    f"{self.sequence[n - 1]} ends {state}"
                )
            if duration is not None and not support(duration)[0] >= MIN_MOVEMENT_S:
                raise _wrong(f"should have durations_s from {MIN_MOVEMENT_S} s on")
            if movement.seconds is None and duration is None and n < last:
                raise _wrong(f"should have a duration of {name}, which something follows")
            state = movement.after
        return self


MAX_FILES = 1500  # of all classes together
MAX_PATH_LENGTH = 240
Share01 = Annotated[Number, within(0, 1)]


class FilesConfig(Section):
    """A class whose motion is recorded: BVH, AMC or npz files; a list of them is enough."""

    files: dict[str, str]
    """{path: SHA-256}; a list of paths and patterns when it is written."""
    skeleton: Annotated[str, Field(max_length=MAX_PATH_LENGTH)] | None = None
    """The ASF of AMC files, where it is not beside them."""
    joints: dict[str, Annotated[str, Field(min_length=1, max_length=100)]] = {}
    """{our joint: the file's}, where the tables of names do not know it."""
    up: Literal["x", "y", "z", "-x", "-y", "-z"] | None = None
    """Axis of the files that points up; null is found."""
    unit_m: Annotated[float, Field(ge=1e-6, le=1e3, strict=True)] | None = None
    """Of the files; null is found."""
    rate_hz: Annotated[float, Field(ge=1, le=1e4, strict=True)] | None = None
    """Frames per second, instead of the files'."""
    section_s: tuple[FileSecond, FileSecond] | None = None
    """What of each file is used, from and to; null is all."""
    low_pass_hz: Annotated[float, Field(ge=0.1, le=1e3, strict=True)] | None = 8.0
    """Zero-phase low-pass of the positions; null is none."""
    past_end: Literal["velocity", "rest"] = "velocity"
    """What happens where a file is shorter than the recording."""
    file: Annotated[int, Field(ge=0, strict=True)] | None = None
    """Number of the one file that is used; null is drawn."""
    start: Share01 = Uniform(uniform=(0.0, 1.0))
    """Where in the section a recording begins, 0 at the earliest, 1 at the latest."""
    playback_speed: Annotated[Number, within(0.25, 4)] = Uniform(uniform=(0.9, 1.1))
    """Seconds of the file a second."""
    mirror: Share01 = Choice(choice=(0, 1))
    """1 exchanges left and right."""

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
    def _known(cls, value: dict[str, str]) -> dict[str, str]:
        for path in value:
            if not path.lower().endswith(SUFFIXES) or len(path) > MAX_PATH_LENGTH or "\0" in path:
                raise _wrong(f"should be paths of {', '.join(SUFFIXES)} files, not {path!r}")
        if not 0 < len(value) <= MAX_FILES:
            raise _wrong(f"should have 1 to {MAX_FILES} files")
        return value

    @field_validator("joints")
    @classmethod
    def _ours(cls, value: dict[str, str]) -> dict[str, str]:
        for name in value:
            if name not in WANTED:
                raise _wrong(did_you_mean(name, WANTED, f"joints are {', '.join(WANTED)}"))
        return value

    @model_validator(mode="after")
    def _one_of_them(self) -> "FilesConfig":
        if self.file is not None and self.file >= len(self.files):
            raise _wrong(f"should have a file below {len(self.files)}, the number of files")
        if self.section_s is not None and not self.section_s[0] < self.section_s[1]:
            raise _wrong("should have a section_s that begins before it ends")
        return self


def _class_kind(value: Any) -> str:
    if isinstance(value, dict):
        return "recordings" if "files" in value else "movements"
    return "recordings" if isinstance(value, (FilesConfig, list, tuple)) else "movements"


ClassConfig: TypeAlias = Annotated[
    Annotated[SequenceConfig, Tag("movements")] | Annotated[FilesConfig, Tag("recordings")],
    Discriminator(_class_kind),
]


def _wrong(what: str) -> PydanticCustomError:
    return PydanticCustomError("sequence", "{what}", {"what": what})


Size: TypeAlias = Annotated[Positive, within(1e-6, 1e6, "m")]


class WallConfig(Section):
    """Centre, size along x, y, z, relative permittivity and loss tangent of the wall.

    `rays` and `fresnel` are optional physics; docs/engines.md has the size of their effects.
    """

    center_m: Vector = (1.0, 0.0, 1.25)
    """Range, cross-range, height of its middle."""
    size_m: tuple[Size, Size, Size] = (0.24, 5.0, 2.5)
    """Extent in range, cross-range, height."""
    eps_r: Annotated[AtLeastOne, within(1, 1e6)] = 6.0
    """Relative permittivity."""
    loss_tangent: Annotated[NotNegative, within(0, 1e12)] = 0.03
    """Of its material."""
    rays: Literal["straight", "refracted"] = "straight"
    """Through the wall; refracted is by Snell's law."""
    fresnel: Literal["normal", "perpendicular", "parallel"] = "normal"
    """Loss of the faces: at normal incidence, or the ray's with the field so to its plane."""


class BodyConfig(Section):
    """What of a person scatters: the joints as points, or the segments between them.

    `segments` are ellipsoids of `points_per_segment` points at most; how many a recording needs
    follows from its speeds, window and wavelength. docs/bodies.md has what that brings and costs.
    """

    scatterers: Literal["points", "segments"] = "points"
    """The 13 joints, or ellipsoids between them."""
    points_per_segment: Annotated[int, Field(ge=1, le=1000, strict=True)] = 20
    """At most so many on a segment."""
    shadowing: Flag = True
    """Of segments: trunk and thighs hide what is behind them."""


class ReflectorConfig(Section):
    """Something that stands in the room, with a residual motion along the line of sight."""

    position_m: Vector = (
        Uniform(uniform=(1.0, 6.0)),
        Uniform(uniform=(-3.0, 3.0)),
        Uniform(uniform=(0.0, 2.5)),
    )
    """Range, cross-range, height."""
    rcs_dbsm: Annotated[Number, within(-120, 120, "dBsm")] = Uniform(uniform=(-10.0, 10.0))
    """Its radar cross-section."""
    residual_m: Annotated[NotNegative, within(0, 0.01, "m")] = Uniform(uniform=(5e-5, 5e-4))
    """Standard deviation of its small motion along the line of sight."""
    highest_hz: Annotated[Positive, within(1e-3, 100, "Hz")] = 10.0
    """Highest frequency of that motion."""


MAX_REFLECTORS = 32


class RoomConfig(Section):
    """What stands in the room: a list, or a number of reflectors of one distribution."""

    reflectors: Annotated[tuple[ReflectorConfig, ...], Field(max_length=MAX_REFLECTORS)] = ()
    """A list of {position_m, rcs_dbsm, residual_m, highest_hz}, or how many of the default ones."""
    back_wall_m: Annotated[Number, within(0, 1e4, "m")] | None = None
    """Range of a wall behind people, in which they are seen once more; null is none."""
    back_wall_reflection_db: Annotated[Number, within(-120, 0, "dB")] = -8.0
    """What it reflects, over what meets it; the mirrored echo meets it twice."""

    @field_validator("reflectors", mode="before")
    @classmethod
    def _so_many(cls, value: Any) -> Any:
        if not isinstance(value, int) or isinstance(value, bool):
            return value
        if not 0 <= value <= MAX_REFLECTORS:
            raise PydanticCustomError(
                "number", "should be a list, or a number from 0 to {most}", {"most": MAX_REFLECTORS}
            )
        return (ReflectorConfig(),) * value


class LineConfig(Section):
    """Interference at a fixed Doppler; its level is over the white noise, of a raw sample.

    on_s, off_s: mean times for which it is on and off; always on where off_s is 0.
    """

    doppler_hz: Annotated[Number, within(-1e7, 1e7, "Hz")]
    """Doppler frequency of the line."""
    level_db: Decibel = -10.0
    """Over the white noise of a raw sample."""
    on_s: Annotated[Positive, within(1e-3, 1e7, "s")] = 1.0
    """Mean time for which it is on."""
    off_s: Annotated[NotNegative, within(0, 1e7, "s")] = 0.0
    """Mean time for which it is off; 0: always on."""
    both_sides: Flag = False
    """As strong at the opposite Doppler, at the same times: amplitude modulation, real samples.
    At 0 Hz the two are one line of 6 dB more."""


class ReceiverConfig(Section):
    """Noise that grows towards zero Doppler, and interference lines; both over the white noise."""

    noise_corner_hz: Annotated[NotNegative, within(0, 1e7, "Hz")] = 0.0
    """Doppler at which noise that grows towards zero equals the white noise; 0 is none."""
    noise_slope_db: Annotated[NotNegative, within(1, 20, "dB per decade")] = 10.0
    """Its slope."""
    lines: Annotated[tuple[LineConfig, ...], Field(max_length=16)] = ()
    """Interference: a list of {doppler_hz, level_db}."""


class SavgolConfig(Section):
    """The Savitzky-Golay filter of the denoised maps."""

    order: Annotated[int, Field(ge=0, le=30, strict=True)] = 5
    """Of the polynomial."""
    frame: Annotated[int, Field(ge=1, strict=True)] = 11
    """Odd, above the order."""

    @model_validator(mode="after")
    def _fits(self) -> "SavgolConfig":
        if self.frame % 2 == 0 or self.frame <= self.order:
            raise PydanticCustomError(
                "frame", "should have a frame that is odd and above the order"
            )
        return self


class HighpassConfig(Section):
    """The Butterworth filter of `clutter: highpass`; its cut-off is given once, in any unit."""

    order: Annotated[int, Field(ge=1, le=10, strict=True)] = 4
    """Of the filter."""
    cutoff_hz: Annotated[float, Field(gt=0, le=1e7, strict=True)] | None = None
    """The cut-off; or one of the next two instead."""
    cutoff_mps: Annotated[float, Field(gt=0, le=1e4, strict=True)] | None = None
    """The same as a speed."""
    cutoff_fraction: Annotated[float, Field(gt=0, lt=1, strict=True)] | None = None
    """The same as a fraction of PRF/2."""
    zero_phase: Flag = False
    """Filter both ways."""
    remove_mean: Flag = True
    """Take out the mean first; without it static echoes ring, as with MATLAB's `filter`."""

    @model_validator(mode="after")
    def _one_cutoff(self) -> "HighpassConfig":
        given = [self.cutoff_hz, self.cutoff_mps, self.cutoff_fraction]
        if sum(one is not None for one in given) > 1:
            raise PydanticCustomError(
                "cutoff", "should have one of cutoff_hz, cutoff_mps and cutoff_fraction"
            )
        if given == [None, None, None]:
            object.__setattr__(self, "cutoff_fraction", 0.0075)
        return self


LIMB_ACCELERATION = 2.0  # m/s^2 along the line of sight; gait and kicks are resolved at 2 to 77 GHz
MAX_WINDOW_SHARE = 0.25


class ProcessingConfig(Section):
    """Clutter, range compression, gate, windows and thresholds.

    `mti` is another spelling of `clutter`: true is `difference`, false is `none`. `window_s` goes
    before `window_fraction`; without both the window follows from the wavelength.
    """

    clutter: Literal["difference", "mean", "highpass", "none"] = "difference"
    """s[m + 1] - s[m], the paper's MTI; less the mean; the filter below."""
    mti: Annotated[Flag | None, Field(exclude=True)] = None
    """Another spelling: true is `clutter: difference`, false is `none`."""
    highpass: HighpassConfig = HighpassConfig()
    doppler: Literal["half_band", "gate"] = "half_band"
    """The coherent sum of the kept bins, or STFTs of those around the torso."""
    gate_m: float | tuple[float, float] = 1.0
    """How far the gate reaches to both sides of the torso, or [from, to]."""
    gate_sum: Literal["power", "magnitude"] = "power"
    """Powers are added up, or (sum of the magnitudes)^2."""
    range_fft_length: Annotated[int, Field(ge=2, multiple_of=2, strict=True)] | None = None
    """Even, at least the samples of a chirp; null is found."""
    range_reference: Literal["centre", "start"] = "centre"
    """Where in the chirp the phase is taken."""
    window_fraction: Annotated[float, Field(gt=0, lt=1, strict=True)] | None = None
    """Length of the window, as a fraction of the recording; null is the model's: 0.1 of paper."""
    window_s: Annotated[float, Field(gt=0, le=1e7, strict=True)] | None = None
    """The window in s, before window_fraction; without both as limbs need it at this wavelength."""
    overlap_fraction: Annotated[float, Field(ge=0, lt=1, strict=True)] = 0.9
    """Of consecutive windows, as a fraction of the window."""
    stft_fft_length: Annotated[int, Field(ge=8, strict=True)] | None = None
    """At least the window; null is found."""
    savgol: SavgolConfig = SavgolConfig()
    fsst_hop_pulses: Annotated[int, Field(ge=1, le=2**24, strict=True)] | None = None
    """Of the fsst maps; 1 is every sample; null is the STFT's."""
    fsst_threshold: Annotated[float, Field(ge=0, lt=1, strict=True)] = 1e-3
    """Coefficients below this share of the map's largest are left out."""

    @field_validator("gate_m", mode="before")
    @classmethod
    def _distance_or_interval(cls, value: Any) -> Any:
        numbers = value if isinstance(value, (list, tuple)) and len(value) == 2 else [value]
        good = all(type(one) in (int, float) and 0 <= one <= 1e7 for one in numbers)
        if not good or sorted(numbers) != list(numbers) or numbers == [0]:
            raise PydanticCustomError(
                "gate",
                "should be how far (m) the gate reaches to both sides of the torso, above 0, "
                "or [from, to], ranges with from <= to; 1e7 at most",
            )
        return value

    @model_validator(mode="after")
    def _one_spelling(self) -> "ProcessingConfig":
        if self.mti is not None:
            meant = "difference" if self.mti else "none"
            if "clutter" in self.model_fields_set and self.clutter != meant:
                raise PydanticCustomError(
                    "mti",
                    "should not have mti: {mti}, which means clutter: {meant}, "
                    "beside clutter: {clutter}",
                    {"mti": str(self.mti).lower(), "meant": meant, "clutter": self.clutter},
                )
            object.__setattr__(self, "clutter", meant)
            object.__setattr__(self, "mti", None)
        return self

    def window_pulses(self, duration: float, prf: float, f0: float) -> int:
        """Length of the STFT's window in pulses.

        Where nothing gives it, T = sqrt(2 lambda/a): a limb's Doppler then crosses the main lobe of
        Hann's window, 4/T, in T. It has MIN_WINDOW pulses or more, and at most MAX_WINDOW_SHARE of
        the recording.

        Args:
            duration: of the recording, s.
            prf: pulses per second.
            f0: frequency of the Doppler, Hz.
        """
        if self.window_s is not None:
            return half_up(self.window_s, prf)
        if self.window_fraction is not None:
            return half_up(self.window_fraction, duration, prf)
        seconds = sqrt(2 * SPEED_OF_LIGHT / f0 / LIMB_ACCELERATION)
        return max(half_up(min(seconds, MAX_WINDOW_SHARE * duration), prf), MIN_WINDOW)


DEFAULT_COLOUR_MAP = "viridis"
Pixels = Annotated[int, Field(ge=2, le=8192, strict=True)]


Cells = Annotated[int, Field(ge=0, le=4096, strict=True)]
ExceedingRate = Annotated[Positive, within(1e-12, 0.999)]


class CfarConfig(Section):
    """Cell-averaging CFAR of `image.kind: cfar`; cells are pixels, (rows, columns) on each side.

    Exactly one of pfa, factor and threshold_db is the threshold; pfa is 0.31 where none is given.
    With `on: decibel` the map's median is put at floor_db, as a factor of decibels needs a zero.
    """

    guard: tuple[Cells, Cells] = (10, 2)
    """Pixels on each side, [rows, columns], left out."""
    training: tuple[Cells, Cells] = (50, 10)
    """Pixels on each side, [rows, columns], averaged."""
    pfa: ExceedingRate | None = None
    """False alarm rate; null where another is the threshold."""
    factor: Annotated[Positive, within(1e-3, 1e12)] | None = None
    """Threshold: factor of the mean."""
    threshold_db: Decibel | None = None
    """Threshold: dB above the mean."""
    on: Literal["power", "decibel"] = "decibel"
    """What is averaged and compared."""
    floor_db: Annotated[Decibel, within(0, 200, "dB")] = Uniform(uniform=(10.0, 30.0))
    """With decibels, where the map's median is put."""
    edges: Literal["wrap", "shrink"] = "wrap"
    """Beyond an edge: the cells of the opposite edge, or none."""

    @model_validator(mode="after")
    def _one_threshold(self) -> "CfarConfig":
        given = [key for key in ("pfa", "factor", "threshold_db") if getattr(self, key) is not None]
        if len(given) > 1:
            raise PydanticCustomError(
                "threshold",
                "should have one of pfa, factor and threshold_db; set the others to null (it has "
                "{given})",
                {"given": " and ".join(given)},
            )
        if not given:
            object.__setattr__(self, "pfa", 0.31)
        return self

    def uses(self, key: str) -> bool:
        """Whether masks depend on the number of that key."""
        if key == "floor_db":
            return self.on == "decibel" and self.threshold_db is None
        return True


class ImageConfig(Section):
    """Size (height, width; one number means square), what pixels show, colour map, Doppler limits.

    Doppler limits are speeds, positive approaching: one number v is [-v, v].
    """

    size_px: tuple[Pixels, Pixels] = (256, 256)
    """[height, width]; one number is a square."""
    kind: Literal["decibel", "cfar"] = "decibel"
    """Grey levels, or binary masks of what exceeds its background."""
    dynamic_range_db: Annotated[float, Field(gt=0, le=300, strict=True)] = 50.0
    """Grey levels reach so far below the largest power (`kind: decibel`)."""
    cfar: CfarConfig = CfarConfig()
    colour_map: str = DEFAULT_COLOUR_MAP
    """Any Matplotlib name; of PNGs and figures, as dataset.h5 holds grey levels."""
    doppler_limits_mps: tuple[Real, Real] | None = None
    """v for -v to v, or [low, high], approaching positive; null is all."""

    @field_validator("doppler_limits_mps", mode="before")
    @classmethod
    def _both_sides(cls, value: Any) -> Any:
        number = isinstance(value, (int, float)) and not isinstance(value, bool)
        return (-value, value) if number else value

    @field_validator("doppler_limits_mps")
    @classmethod
    def _ordered(cls, value: tuple[float, float] | None) -> tuple[float, float] | None:
        if value is not None and not value[0] < value[1]:
            raise PydanticCustomError(
                "limits", "should be a speed above 0, or [low, high] with low < high"
            )
        return value

    @field_validator("size_px", mode="before")
    @classmethod
    def _square(cls, value: Any) -> Any:
        return (value, value) if isinstance(value, int) else value

    @field_validator("colour_map")
    @classmethod
    def _known(cls, value: str) -> str:
        if value != DEFAULT_COLOUR_MAP:  # Matplotlib is slow to import
            from matplotlib import colormaps

            if value not in colormaps:
                some = "viridis, gray, turbo, jet are some"
                hint = did_you_mean(value, colormaps, some)
                raise PydanticCustomError(
                    "colour", "should be a Matplotlib colour map; {hint}", {"hint": hint}
                )
        return value


Share = Annotated[float, Field(ge=0, le=1, strict=True)]


class SplitConfig(Section):
    """Shares of the three parts, of the samples of each class or of the persons."""

    by: Literal["sample", "subject"] = "sample"
    """Shares of each class's samples, or of the persons."""
    train: Share = 0.8
    """Share to learn from."""
    validation: Share = 0.2
    """Share to choose the best epoch by."""
    test: Share = 0.0
    """Share that training never sees."""
    subjects: Annotated[int, Field(ge=1, strict=True)] | None = None
    """With `by: subject`: persons who each perform every activity."""

    @model_validator(mode="after")
    def _whole(self) -> "SplitConfig":
        total = self.train + self.validation + self.test
        if abs(total - 1) > 1e-9:
            raise PydanticCustomError(
                "shares",
                "should have train + validation + test = 1 (they add up to {total})",
                {"total": f"{total:g}"},
            )
        if (self.by == "subject") != (self.subjects is not None):
            raise PydanticCustomError(
                "subjects", "should have 'subjects: n' with 'by: subject', and only with it"
            )
        return self


MAX_TOLERANCE_DB = -6.0


class EngineConfig(Section):
    """`cube` is the exact float64 reference; `direct` the closed form, within a tolerance.

    The tolerance is the relative L2 error (dB) of the noiseless slow-time signal after the
    canceller against the cube, measured in every scene. Where `direct` does not reach it, the scene
    is refused, or computed by the cube (`fallback: cube`). `motion_in_chirp` lets the paths of the
    cube go on moving during a chirp.
    """

    kind: Literal["direct", "cube"] = "direct"
    """The closed form within the tolerance, or the exact reference."""
    tolerance_db: Annotated[float, Field(ge=-400, le=MAX_TOLERANCE_DB, strict=True)] = -80.0
    """Relative L2 error of the noiseless signal after MTI, -400 to -6."""
    fallback: Literal["refuse", "cube"] = "refuse"
    """What to do with a scene in which `direct` misses the tolerance."""
    precision: Literal["auto", "double"] = "auto"
    """double: float64 whatever the tolerance."""
    motion_in_chirp: Flag = False
    """Of `cube`: paths go on moving during a chirp."""


Level = Annotated[int, Field(ge=0, le=9, strict=True)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]{0,62}$")]


class OutputConfig(Section):
    """What is written of every sample, and how hard it is compressed: 0 none, 1 fast, 9 small."""

    png: Flag = True
    """Write a tree of images beside dataset.h5."""
    column_labels: Flag = False
    """Store what is done at the time of each column of a map."""
    png_level: Level = 1
    """Compression, 0 to 9."""
    hdf5_level: Level = 1
    """Compression, 0 to 9."""
    power: Literal["float16"] | None = None
    """float16: store the decibels behind every image, not clipped."""
    slow_time: Flag = False
    """Store the complex slow-time signal."""
    products: tuple[Name, ...] = ()
    """Further products to store as arrays, those of your own too (`radhar_cli.registry`)."""
    license: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9.+-]{0,60}$")] | None = None
    """Of the data card, as the Hugging Face Hub calls it: cc-by-4.0, mit."""


MAP_NAMES = (
    "rtm",
    *(
        f"{kind}{suffix}"
        for kind in ("stft", "fsst")
        for suffix in ("", "_denoised", "_compensated", "_compensated_denoised")
    ),
)


def _known_map(name: str) -> str:
    if name not in MAP_NAMES and not is_known(name):
        names = (*MAP_NAMES, *(product.name for product in own_products()))
        right = " or ".join(filter(None, (", ".join(map(repr, names[:-1])), repr(names[-1]))))
        raise PydanticCustomError("map", "should be {right}", {"right": right})
    return name


MapName = Annotated[str, AfterValidator(_known_map)]


def possible_maps(processing: ProcessingConfig) -> tuple[str, ...]:
    """The maps that there can be: no FSST of a gate, whose bins are summed without their phase."""
    gated = processing.doppler == "gate"
    return tuple(name for name in MAP_NAMES if not (gated and name.startswith("fsst")))


# People face the radar, and in 6 s walk 8 m towards it: they start far enough away, all within its
# half-band of 30 m. Classes of one's own may walk all the time.
_FAR, _MIDDLE, _NEAR = (Uniform(uniform=one) for one in ((9.0, 12.0), (5.0, 8.0), (2.0, 5.0)))
_HUMAN_RANGE = PerActivity[Coordinate](
    per_activity={
        DEFAULT: _FAR,
        **{a.slug: _MIDDLE if a.walks else _NEAR for a in ACTIVITIES if a.slug != "walking"},
    }
)
_FACING = Uniform(uniform=(150.0, 210.0))
_OF_FOUR_SECONDS = {"duration_s": 4.0, "radar": {"bandwidth_hz": 4e9, "prf_hz": 5000.0}}

MODEL_DEFAULTS: dict[str, dict[str, Any]] = {
    "file": {
        **_OF_FOUR_SECONDS,
        "on_invalid": "redraw",
        "motion": {"range_m": Uniform(uniform=(2.0, 4.0)), "angle_deg": _FACING},
    },
    "paper": {
        **_OF_FOUR_SECONDS,
        "on_invalid": "keep",
        "processing": {"window_fraction": 0.1},
        "motion": {
            "range_m": Uniform(uniform=(1.0, 3.0)),
            "angle_deg": Uniform(uniform=(-30.0, 30.0)),
            "speed_mps": 1.5,
        },
        "timing": {
            "seat_duration_s": 2.0,
            "rise_duration_s": 1.5,
            "walk_start_s": 2.0,
            "sit_duration_s": 1.5,
            "fall_duration_s": 0.8,
        },
    },
    "human": {
        "duration_s": 6.0,
        "on_invalid": "redraw",
        "radar": {"bandwidth_hz": 1e9, "prf_hz": 1e4},  # +-9.7 m/s: a kick's foot reaches 7 to 9
        "motion": {
            "range_m": _HUMAN_RANGE,
            "angle_deg": _FACING,
            "speed_mps": Normal(normal=(1.3, 0.18), min=0.7, max=2.0),
        },
        "timing": {
            "seat_duration_s": PerActivity[Seconds](
                per_activity={
                    "default": Normal(normal=(2.0, 0.4), min=1.3, max=3.0),
                    "standing_up": Normal(normal=(1.8, 0.4), min=1.2, max=3.0),
                }
            ),
            "rise_duration_s": PerActivity[Seconds](
                per_activity={
                    "default": Normal(normal=(1.8, 0.25), min=1.2, max=3.0),
                    "falling_to_walking": Normal(normal=(3.0, 0.5), min=2.2, max=4.5),
                }
            ),
            "sit_duration_s": Normal(normal=(2.0, 0.25), min=1.3, max=3.0),
            "fall_duration_s": Normal(normal=(1.1, 0.4), min=0.9, max=2.0),
        },
    },
}


MAX_WINDOWS = 1_000_000
SLUG = r"[a-z][a-z0-9_]{0,62}"


class RecordedPart(Section):
    """Part of a recording in which one person does one thing.

    The file is named from the manifest's folder, or below.
    """

    file: Annotated[str, Field(max_length=500)]
    label: Annotated[str, Field(pattern=f"^{SLUG}$")]
    person: Annotated[str, Field(max_length=100)] | None = None
    start_s: Annotated[float, Field(ge=0, le=1e7, strict=True)]
    stop_s: Annotated[float, Field(ge=0, le=1e7, strict=True)]

    @field_validator("file")
    @classmethod
    def _below(cls, value: str) -> str:
        place = PurePosixPath(value)
        if place.is_absolute() or ".." in place.parts or "\\" in value or not place.name:
            raise _wrong("should be a path below the manifest's folder")
        return value


class RecordingsConfig(Section):
    """A data set of measured data: windows of recordings instead of scenes."""

    window_s: Annotated[float, Field(gt=0, le=1e6, strict=True)] = 4.0
    """Length of a sample."""
    hop_s: Annotated[float, Field(gt=0, le=1e6, strict=True)] = 4.0
    """From one sample to the next."""
    receiver: Annotated[int, Field(ge=0, le=2**16, strict=True)] | None = None
    """One of them; null is the sum of all maps' powers."""
    parts: Annotated[tuple[RecordedPart, ...], Field(max_length=10_000)] = ()
    """Filled in from the manifest, in its order."""
    sha256: dict[str, str] = {}
    """Filled in: of each file, which the data set's bytes depend on."""
    rows: tuple[float, float] | None = None
    """Of images that exist already: lowest and highest edge, Hz (m of a range-time map)."""
    packed: Flag = False
    """Whether the columns of masks are bits."""

    @model_validator(mode="after")
    def _bounded(self) -> "RecordingsConfig":
        if (total := sum(map(self.count, self.parts))) > MAX_WINDOWS:
            raise _wrong(f"should have at most {MAX_WINDOWS} windows; hop_s makes {total}")
        return self

    def count(self, part: RecordedPart) -> int:
        """How many windows a part holds."""
        room = part.stop_s - part.start_s - self.window_s
        return floor(room / self.hop_s + 1e-9) + 1 if room >= -1e-9 else 0

    def starts(self, part: RecordedPart) -> list[float]:
        """When the windows of a part begin, s."""
        return [part.start_s + n * self.hop_s for n in range(self.count(part))]

    @cached_property
    def counts(self) -> dict[str, int]:
        """{label: windows}, of those that have any."""
        found: dict[str, int] = {}
        for part in self.parts:
            found[part.label] = found.get(part.label, 0) + self.count(part)
        return {label: count for label, count in found.items() if count}

    @property
    def persons(self) -> tuple[str, ...]:
        """Names of all persons, in alphabetical order."""
        return tuple(sorted({part.person for part in self.parts if part.person is not None}))


class Config(Section):
    """A data set: what to draw, what to compute, how to store it."""

    seed: Annotated[int, Field(ge=0, lt=2**63, strict=True)] = 1
    """0 to 2^63 - 1."""
    samples_per_class: SamplesBy = 300
    """May differ: {per_activity: {default: 300, walking: 100}}."""
    classes: Annotated[dict[str, ClassConfig], Field(max_length=200)] = {}  # labels are uint8
    """Your own: {name: {sequence: [...]}} of movements, {name: [walk/*.bvh]} of files."""
    activities: Literal["all"] | tuple[str, ...] = "all"
    """The twelve and those of `classes`; or a list of slugs or labels, [walking, S12]."""
    duration_s: Annotated[Positive, within(1e-9, 1e7, "s")] | None = None
    """Of a recording; null is the model's: 6 of human, 4 of paper and file."""
    radar: RadarConfig = RadarConfig()
    subject: SubjectConfig = SubjectConfig()
    motion: MotionConfig = MotionConfig()
    timing: TimingConfig = TimingConfig()
    body: BodyConfig = BodyConfig()
    wall: WallConfig | None = None
    """null is free space."""
    room: RoomConfig = RoomConfig()
    snr_db: Decibel | None = 30.0
    """null is noiseless."""
    receiver: ReceiverConfig = ReceiverConfig()
    snr_reference: Literal["free_space", "received"] = "free_space"
    """Signal without the wall, or with its loss."""
    on_invalid: Literal["keep", "redraw", "error"] | None = None
    """A body that meets the wall, a scatterer that leaves the range half-band; null is the model's:
    keep of paper, redraw of human and file."""
    processing: ProcessingConfig = ProcessingConfig()
    image: ImageConfig = ImageConfig()
    maps: tuple[MapName, ...] = ("stft",)
    """Of rtm, stft, fsst; the latter two with _denoised, _compensated, _compensated_denoised."""
    split: SplitConfig = SplitConfig()
    engine: EngineConfig = EngineConfig()
    output: OutputConfig = OutputConfig()
    recordings: RecordingsConfig | None = None
    """Of measured data instead of scenes: see docs/measured.md."""

    @field_validator("classes")
    @classmethod
    def _names(cls, value: dict[str, ClassConfig]) -> dict[str, ClassConfig]:
        twelve = {activity.slug for activity in ACTIVITIES}
        for slug, one in value.items():
            if not (is_new_slug(slug) or (isinstance(one, FilesConfig) and slug in twelve)):
                raise _wrong(f"should have a new name of a-z, 0-9 and _ instead of {slug!r}")
        if (
            sum(len(one.files) for one in value.values() if isinstance(one, FilesConfig))
            > MAX_FILES
        ):
            raise _wrong(f"should have at most {MAX_FILES} files in all")
        return value

    @field_validator("activities", mode="before")
    @classmethod
    def _slugs(cls, value: object, info: ValidationInfo) -> object:
        if not isinstance(value, (list, tuple)) or "classes" not in info.data:
            return value  # a mistake in `classes` is reported once
        own = class_activities(info.data["classes"])
        try:
            chosen = [activity_named(str(name), own) for name in value]
        except ValueError as error:
            raise PydanticCustomError("activity", "{what}", {"what": str(error)}) from None
        if not chosen or len({a.slug for a in chosen}) != len(chosen):
            raise PydanticCustomError("activity", "should name at least one activity, each once")
        # User-defined ones last: those of `classes`, then those of `add_activity`.
        return tuple(a.slug for a in sorted(chosen, key=lambda a: (a.motion is not None, a.number)))

    @field_validator("maps")
    @classmethod
    def _each_once(cls, value: tuple[str, ...]) -> tuple[str, ...]:
        if not value:
            raise PydanticCustomError("maps", "should name at least 1 map")
        if len(set(value)) != len(value):
            raise PydanticCustomError("maps", "should name each map once")
        own = [name for name in value if name not in MAP_NAMES]
        return (*sorted(set(value) - set(own), key=MAP_NAMES.index), *own)

    def filled(self) -> "Config":
        """This config, in which what is null and has a default by model takes it."""
        for name, default in MODEL_DEFAULTS[self.motion.model].items():
            now = getattr(self, name)
            if now is None:
                object.__setattr__(self, name, default)
            elif isinstance(default, dict):
                unset = {key: one for key, one in default.items() if getattr(now, key) is None}
                if unset:
                    object.__setattr__(self, name, now.model_copy(update=unset))
        return self

    @model_validator(mode="after")
    def _consistent(self) -> "Config":
        mistakes = list(problems(self.filled()))
        if mistakes:
            raise PydanticCustomError("across", "{problems}", {"problems": mistakes})
        return self

    def samples_of(self, activity: Activity) -> int:
        """How many samples of an activity there are."""
        if self.recorded is not None:
            return self.recorded.counts.get(activity.slug, 0)
        return for_activity(self.samples_per_class, activity)

    @property
    def recorded(self) -> RecordingsConfig | None:
        """The windows of recordings that this is a data set of; None of scenes."""
        return self.recordings if self.recordings is not None and self.recordings.counts else None

    @property
    def every_class(self) -> tuple[Activity, ...]:
        """Every class by label: the twelve, those of `classes`, then those of `add_activity`."""
        known = {a.slug: a for a in ACTIVITIES} | class_activities(self.classes)
        return (*(known | {a.slug: a for a in self.chosen_activities}).values(),)

    @property
    def chosen_activities(self) -> tuple[Activity, ...]:
        """The activities to build: S1 to S12, then user-defined ones from 13 on, in order.

        All of them are those of `classes` alone with `motion.model: file`.
        """
        own = class_activities(self.classes)
        if self.recorded is not None:
            known = {a.slug: a for a in (*ACTIVITIES, *own.values())}
            new = sorted(self.recorded.counts.keys() - known.keys())
            after = 1 + max(a.number for a in known.values())
            known |= {slug: Activity(after + n, slug) for n, slug in enumerate(new)}
            return tuple(a for slug, a in known.items() if slug in self.recorded.counts)
        if self.activities == "all":
            twelve = {} if self.motion.model == "file" else {a.slug: a for a in ACTIVITIES}
            return (*sorted((twelve | own).values(), key=lambda a: a.number),)
        chosen = [activity_named(slug, own) for slug in self.activities]
        added = [a for a in chosen if a.motion is not None]
        after = 1 + max(a.number for a in (*ACTIVITIES, *own.values()))
        return (
            *(a for a in chosen if a.motion is None),
            *(replace(a, number=after + n) for n, a in enumerate(added)),
        )

    def files_of(self, activity: Activity) -> FilesConfig | None:
        """The files of an activity, None where a model makes its motion."""
        one = self.classes.get(activity.slug)
        return one if isinstance(one, FilesConfig) else None


def class_activities(classes: Mapping[str, ClassConfig]) -> dict[str, Activity]:
    """{slug: activity} of a config's classes: S13 and so on, or one of the twelve from files."""
    activities: dict[str, Activity] = {}
    twelve = {activity.slug: activity for activity in ACTIVITIES}
    number = len(ACTIVITIES)
    for slug, one in classes.items():
        if slug in twelve:
            activities[slug] = replace(twelve[slug], paper=(), human=())
            continue
        number += 1
        uses = sequence_uses(one.sequence) if isinstance(one, SequenceConfig) else ()
        activities[slug] = Activity(number, slug, human=uses)
    return activities
