"""The schema of a data set's YAML file: one class a section, then the whole.

Units stand in the keys. Every number of a scene (`SCENE_KEYS`) may be fixed or drawn.
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Annotated, Any, Generic, Literal, TypeAlias, TypeVar

from pydantic import (
    BaseModel,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    ValidationInfo,
    field_validator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from radhar_cli.activity import (
    ACTIVITIES,
    MOVEMENTS,
    Activity,
    activity_named,
    is_new_slug,
    sequence_uses,
)
from radhar_cli.config.checks import problems
from radhar_cli.config.number import (
    Angle,
    AtLeastOne,
    Coordinate,
    Decibel,
    Normal,
    NotNegative,
    Number,
    Positive,
    Uniform,
    Vary,
    Vector,
    support,
    within,
)
from radhar_cli.errors import did_you_mean

Flag: TypeAlias = Annotated[bool, Field(strict=True)]


class Section(BaseModel):
    """Base of all config models."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, validate_default=True, allow_inf_nan=False
    )


class RadarConfig(Section):
    """Waveform, antenna positions and gains; every number may be drawn."""

    carrier_hz: Annotated[Positive, within(1e6, 1e13, "Hz")] = 77e9
    bandwidth_hz: Annotated[Positive, within(1e3, 1e12, "Hz")] = 4e9
    prf_hz: Annotated[Positive, within(1e-3, 1e7, "Hz")] = 5000.0
    adc_rate_hz: Annotated[Positive, within(1e-3, 1e13, "Hz")] = 10e6
    chirp_s: Annotated[Positive, within(1e-12, 1e4, "s")] = 40e-6
    tx_m: Vector = (0.4, -0.1, 1.5)
    rx_m: Vector = (0.4, 0.1, 1.5)
    antenna_gain_dbi: Annotated[Decibel, within(-150, 150, "dBi")] = 6.0
    antenna_isolation_db: Decibel = 10.0
    residual_video_phase: Flag = False


T = TypeVar("T")


class PerActivity(Section, Generic[T]):
    """``{per_activity: {default: 2.0, walking: 1.0, S9: 1.0}}``: a number by activity."""

    per_activity: dict[str, T]

    @field_validator("per_activity")
    @classmethod
    def _by_slug(cls, value: dict[str, T]) -> dict[str, T]:
        numbers: dict[str, T] = {}
        for name, number in value.items():
            try:
                slug = name if name == "default" else activity_named(name).slug
            except ValueError as error:
                raise PydanticCustomError("activity", "{what}", {"what": str(error)}) from None
            if slug in numbers:
                raise PydanticCustomError("activity", "should name {slug} once", {"slug": slug})
            numbers[slug] = number
        if "default" not in numbers:
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


def for_activity(value: Number | PerActivity[Number], activity: Activity) -> Number:
    """Return the number that holds for one activity."""
    if isinstance(value, PerActivity):
        return value.per_activity.get(activity.slug, value.per_activity["default"])
    return value


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
    weight_kg: Annotated[Positive, within(1e-3, 1e6, "kg")] | None = None
    sway_ahead_m: Metres = Uniform(uniform=(0.002, 0.006))
    sway_aside_m: Metres = Uniform(uniform=(0.0015, 0.0035))
    breathing_hz: Rate = Normal(normal=(0.25, 0.04), min=0.15, max=0.4)
    chest_m: Metres = Uniform(uniform=(0.002, 0.006))
    pulse_hz: Rate = Normal(normal=(1.15, 0.12), min=0.8, max=1.8)
    heart_m: Metres = Uniform(uniform=(0.0001, 0.0004))


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

    range_m to speed_mps: both models. gait_hz to turn_deg: the paper's. turn_deg on: the human
    model's. What the other model alone knows is ignored. docs/motion.md describes both.
    """

    model: Literal["human", "paper"] = "human"
    range_m: CoordinateBy = Uniform(uniform=(1.0, 3.0))
    cross_range_m: CoordinateBy = 0.0
    angle_deg: AngleBy = Uniform(uniform=(-30.0, 30.0))
    speed_mps: SpeedBy | None = None
    gait_hz: FrequencyBy = 1.0
    thigh_deg: AngleBy = Vary(vary=(30.0, 0.2))
    calf_deg: AngleBy = Vary(vary=(45.0, 0.2))
    arm_deg: AngleBy = Vary(vary=(35.0, 0.2))
    turn_deg: AngleBy = Vary(vary=(45.0, 0.2))
    rotation_hz: FrequencyBy = Vary(vary=(0.45, 0.2))
    period_scale: RatioBy = Normal(normal=(0.95, 0.04), min=0.85, max=1.05)
    cycle_phase: SignedBy = Uniform(uniform=(-0.5, 0.5))
    arm_swing: RatioBy = Uniform(uniform=(0.6, 1.3))
    trunk_pitch_deg: AngleBy = Normal(normal=(3.0, 2.0), min=-2.0, max=8.0)
    step_width: RatioBy = Normal(normal=(0.063, 0.011), min=0.03, max=0.1)
    step_asymmetry: SignedBy = Normal(normal=(0.0, 0.02), min=-0.05, max=0.05)
    ragged_speed: RatioBy = Uniform(uniform=(0.0, 0.06))
    stride_jitter: RatioBy = Uniform(uniform=(0.0, 0.03))
    width_jitter_m: RatioBy = Uniform(uniform=(0.0, 0.02))
    punch_hz: FrequencyBy = Vary(vary=(0.7, 0.15))
    kick_hz: FrequencyBy = Vary(vary=(0.45, 0.1))
    strike_scale: RatioBy = Normal(normal=(1.0, 0.12), min=0.8, max=1.25)
    tempo_jitter: RatioBy = Uniform(uniform=(0.0, 0.1))
    size_jitter: RatioBy = Uniform(uniform=(0.0, 0.1))
    bend_deg: AngleBy = Normal(normal=(72.0, 5.0), min=60.0, max=85.0)
    dwell_s: SecondsBy = Uniform(uniform=(0.2, 0.6))
    seat_height: RatioBy = Normal(normal=(0.285, 0.015), min=0.25, max=0.32)
    lean_deg: AngleBy = Normal(normal=(42.0, 6.0), min=25.0, max=58.0)
    recline_deg: AngleBy = 0.0
    fall: FallName | Falls = "forward"
    fidget_hz: FrequencyBy = Uniform(uniform=(0.0, 0.4))
    fidget_size: RatioBy = Uniform(uniform=(0.5, 1.5))
    shuffle_hz: FrequencyBy = Uniform(uniform=(0.0, 0.2))
    idle_from_s: SecondsBy = Uniform(uniform=(0.0, 1000.0))


class TimingConfig(Section):
    """When the phases of an activity begin and how long they last.

    seat_*: S5 and S6. grab_*: S4. rise_*, walk_start_s: S9 and S11. walk_stop_s: S10 and S12, then
    sit_duration_s (S10) or fall_duration_s (S12). What is null takes the value of the model
    (`defaults.py`). blend_s, of the paper: length of the raised-cosine ramps that switch the gait
    on and off; 0 is the paper's hard switch. overlap_s, of people: how long before the first
    movement of S9 to S12 has come to rest the second begins, unless walk_start_s says when.
    """

    seat_start_s: SecondsBy = 0.5
    seat_duration_s: SecondsBy | None = None
    grab_start_s: SecondsBy = 0.5
    grab_duration_s: SecondsBy = Normal(normal=(2.5, 0.3), min=1.9, max=3.4)
    rise_start_s: SecondsBy = 0.5
    rise_duration_s: SecondsBy | None = None
    walk_start_s: SecondsBy | None = None
    walk_stop_s: SecondsBy = 2.0
    sit_duration_s: SecondsBy | None = None
    fall_duration_s: SecondsBy | None = None
    blend_s: SecondsBy = 0.3
    overlap_s: SecondsBy = 0.0


SHORTEST_MOVEMENT = 0.3


class SequenceConfig(Section):
    """A class of one's own: movements one after the other, joined at rest.

    Attributes:
        sequence: names of movements (`radhar_cli.activity.MOVEMENTS`).
        durations_s: of each; null is the usual one, of the last one until the recording ends.
        pauses_s: at rest before each; not given, none.
    """

    sequence: Annotated[tuple[str, ...], Field(min_length=1, max_length=64)]
    durations_s: tuple[Seconds | None, ...] = ()
    pauses_s: tuple[Seconds, ...] = ()

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
                raise _wrong(did_you_mean(name, MOVEMENTS, f"movements are {', '.join(MOVEMENTS)}"))
            if state not in (None, movement.before):
                raise _wrong(
                    f"should be joined at rest: {name} begins {movement.before}, "
                    f"{self.sequence[n - 1]} ends {state}"
                )
            if duration is not None and not support(duration)[0] >= SHORTEST_MOVEMENT:
                raise _wrong(f"should have durations_s from {SHORTEST_MOVEMENT} s on")
            if movement.seconds is None and duration is None and n < last:
                raise _wrong(f"should have a duration of {name}, which something follows")
            state = movement.after
        return self


def _wrong(what: str) -> PydanticCustomError:
    return PydanticCustomError("sequence", "{what}", {"what": what})


Size: TypeAlias = Annotated[Positive, within(1e-6, 1e6, "m")]


class WallConfig(Section):
    """Centre, size along x, y, z, relative permittivity and loss tangent of the wall.

    `rays` and `fresnel` are physics that one may add; docs/engines.md has their size.
    """

    center_m: Vector = (1.0, 0.0, 1.25)
    size_m: tuple[Size, Size, Size] = (0.24, 5.0, 2.5)
    eps_r: Annotated[AtLeastOne, within(1, 1e6)] = 6.0
    loss_tangent: Annotated[NotNegative, within(0, 1e12)] = 0.03
    rays: Literal["straight", "refracted"] = "straight"
    fresnel: Literal["normal", "perpendicular", "parallel"] = "normal"


class SavgolConfig(Section):
    """The Savitzky-Golay filter of the denoised maps."""

    order: Annotated[int, Field(ge=0, le=30, strict=True)] = 5
    frame: Annotated[int, Field(ge=1, strict=True)] = 11

    @model_validator(mode="after")
    def _fits(self) -> "SavgolConfig":
        if self.frame % 2 == 0 or self.frame <= self.order:
            raise PydanticCustomError(
                "frame", "should have a frame that is odd and above the order"
            )
        return self


class ProcessingConfig(Section):
    """MTI, range compression, windows and thresholds."""

    mti: Flag = True
    range_fft_length: Annotated[int, Field(ge=2, multiple_of=2, strict=True)] | None = None
    range_reference: Literal["centre", "start"] = "centre"
    window_fraction: Annotated[float, Field(gt=0, lt=1, strict=True)] = 0.1
    overlap_fraction: Annotated[float, Field(ge=0, lt=1, strict=True)] = 0.9
    stft_fft_length: Annotated[int, Field(ge=8, strict=True)] | None = None
    savgol: SavgolConfig = SavgolConfig()
    fsst_hop_pulses: Annotated[int, Field(ge=1, le=2**24, strict=True)] | None = None
    fsst_threshold: Annotated[float, Field(ge=0, lt=1, strict=True)] = 1e-3


DEFAULT_COLOUR_MAP = "viridis"
Pixels = Annotated[int, Field(ge=2, le=8192, strict=True)]


class ImageConfig(Section):
    """Size (height, width; one number means square), dynamic range and colour map."""

    size_px: tuple[Pixels, Pixels] = (256, 256)
    dynamic_range_db: Annotated[float, Field(gt=0, le=300, strict=True)] = 50.0
    colour_map: str = DEFAULT_COLOUR_MAP

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
    train: Share = 0.8
    validation: Share = 0.2
    test: Share = 0.0
    subjects: Annotated[int, Field(ge=1, strict=True)] | None = None

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
    tolerance_db: Annotated[float, Field(ge=-400, le=MAX_TOLERANCE_DB, strict=True)] = -80.0
    fallback: Literal["refuse", "cube"] = "refuse"
    precision: Literal["auto", "double"] = "auto"
    motion_in_chirp: Flag = False


Level = Annotated[int, Field(ge=0, le=9, strict=True)]


class OutputConfig(Section):
    """PNG tree or not, and the compression levels (0 none, 1 fast, 9 small)."""

    png: Flag = True
    png_level: Level = 1
    hdf5_level: Level = 1


MapName = Literal[
    "rtm",
    "stft",
    "stft_denoised",
    "stft_compensated",
    "stft_compensated_denoised",
    "fsst",
    "fsst_denoised",
    "fsst_compensated",
    "fsst_compensated_denoised",
]
MAP_NAMES: tuple[MapName, ...] = MapName.__args__  # type: ignore[attr-defined]


MODEL_DEFAULTS: dict[str, dict[str, dict[str, Any]]] = {
    "paper": {
        "motion": {"speed_mps": 1.5},
        "timing": {
            "seat_duration_s": 2.0,
            "rise_duration_s": 1.5,
            "walk_start_s": 2.0,
            "sit_duration_s": 1.5,
            "fall_duration_s": 0.8,
        },
    },
    "human": {
        "motion": {"speed_mps": Normal(normal=(1.3, 0.18), min=0.7, max=2.0)},
        "timing": {
            "seat_duration_s": PerActivity[Seconds](
                per_activity={
                    "default": Normal(normal=(2.0, 0.25), min=1.3, max=3.0),
                    "standing_up": Normal(normal=(1.8, 0.25), min=1.2, max=3.0),
                }
            ),
            "rise_duration_s": PerActivity[Seconds](
                per_activity={
                    "default": Normal(normal=(1.8, 0.25), min=1.2, max=3.0),
                    "falling_to_walking": Normal(normal=(3.0, 0.5), min=2.2, max=4.5),
                }
            ),
            "sit_duration_s": Normal(normal=(2.0, 0.25), min=1.3, max=3.0),
            "fall_duration_s": Normal(normal=(1.1, 0.15), min=0.9, max=1.5),
        },
    },
}


class Config(Section):
    """A data set: what to draw, what to compute, how to store it."""

    seed: Annotated[int, Field(ge=0, lt=2**63, strict=True)] = 1
    samples_per_class: Annotated[int, Field(ge=1, le=10_000_000, strict=True)] = 300
    classes: dict[str, SequenceConfig] = {}
    activities: Literal["all"] | tuple[str, ...] = "all"
    duration_s: Annotated[Positive, within(1e-9, 1e7, "s")] = 4.0
    radar: RadarConfig = RadarConfig()
    subject: SubjectConfig = SubjectConfig()
    motion: MotionConfig = MotionConfig()
    timing: TimingConfig = TimingConfig()
    wall: WallConfig | None = None
    snr_db: Decibel | None = 30.0
    snr_reference: Literal["free_space", "received"] = "free_space"
    on_invalid: Literal["keep", "redraw", "error"] = "keep"
    processing: ProcessingConfig = ProcessingConfig()
    image: ImageConfig = ImageConfig()
    maps: tuple[MapName, ...] = ("stft",)
    split: SplitConfig = SplitConfig()
    engine: EngineConfig = EngineConfig()
    output: OutputConfig = OutputConfig()

    @field_validator("classes")
    @classmethod
    def _new_names(cls, value: dict[str, SequenceConfig]) -> dict[str, SequenceConfig]:
        for slug in value:
            if not is_new_slug(slug):
                raise _wrong(f"should have a new name of a-z, 0-9 and _ instead of {slug!r}")
        return value

    @field_validator("activities", mode="before")
    @classmethod
    def _slugs(cls, value: object, info: ValidationInfo) -> object:
        if not isinstance(value, (list, tuple)):
            return value
        own = sequences(info.data.get("classes", {}))
        try:
            chosen = [own.get(str(name)) or activity_named(str(name)) for name in value]
        except ValueError as error:
            raise PydanticCustomError("activity", "{what}", {"what": str(error)}) from None
        if not chosen or len({a.slug for a in chosen}) != len(chosen):
            raise PydanticCustomError("activity", "should name at least one activity, each once")
        # One's own last: those of `classes`, then added ones.
        return tuple(a.slug for a in sorted(chosen, key=lambda a: (a.motion is not None, a.number)))

    @field_validator("maps")
    @classmethod
    def _each_once(cls, value: tuple[MapName, ...]) -> tuple[MapName, ...]:
        if not value:
            raise PydanticCustomError("maps", "should name at least 1 map")
        if len(set(value)) != len(value):
            raise PydanticCustomError("maps", "should name each map once")
        return tuple(sorted(value, key=MAP_NAMES.index))

    @model_validator(mode="after")
    def _filled(self) -> "Config":
        """What is null and has a default by model takes it."""
        for section, defaults in MODEL_DEFAULTS[self.motion.model].items():
            now = getattr(self, section)
            unset = {key: value for key, value in defaults.items() if getattr(now, key) is None}
            if unset:
                object.__setattr__(self, section, now.model_copy(update=unset))
        return self

    @model_validator(mode="after")
    def _consistent(self) -> "Config":
        found = list(problems(self))
        if found:
            raise PydanticCustomError("across", "{problems}", {"problems": found})
        return self

    @property
    def every_class(self) -> tuple[Activity, ...]:
        """Every class by its label: the twelve, those of `classes`, then added ones."""
        known = {a.slug: a for a in (*ACTIVITIES, *sequences(self.classes).values())}
        return (*(known | {a.slug: a for a in self.chosen_activities}).values(),)

    @property
    def chosen_activities(self) -> tuple[Activity, ...]:
        """The activities to build: S1 to S12, then one's own, numbered from 13 in their order."""
        own = sequences(self.classes)
        if self.activities == "all":
            return (*ACTIVITIES, *own.values())
        chosen = [own.get(slug) or activity_named(slug) for slug in self.activities]
        added = [a for a in chosen if a.motion is not None]
        return (
            *(a for a in chosen if a.motion is None),
            *(replace(a, number=len(ACTIVITIES) + len(own) + 1 + n) for n, a in enumerate(added)),
        )


def sequences(classes: Mapping[str, SequenceConfig]) -> dict[str, Activity]:
    """{slug: activity} of the sequences of a config, S13 and so on."""
    return {
        slug: Activity(len(ACTIVITIES) + 1 + n, slug, human=sequence_uses(one.sequence))
        for n, (slug, one) in enumerate(classes.items())
    }
