"""The schema of a data set's YAML file: one class a section, then the whole.

Units stand in the keys. Every number of a scene (`SCENE_KEYS`) may be fixed or drawn.
"""

import ast
import inspect
from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property, partial
from itertools import count, pairwise
from math import floor, sqrt
from pathlib import PurePosixPath
from textwrap import dedent
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Generic, Literal, TypeAlias, TypeVar

from pydantic import (
    AfterValidator,
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    ValidationInfo,
    field_validator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from radhar_cli.activities.activity import (
    ACTIVITIES,
    DEFAULT,
    EXERCISES,
    MOVEMENTS,
    TWELVE,
    Activity,
    activity_named,
    is_new_slug,
)
from radhar_cli.activities.vocabulary import advice_on
from radhar_cli.config.annotations import (
    ABOVE_ZERO,
    GIVEN,
    PERSONAL,
    UNSTEADY,
    ActsIf,
    ActsIfAny,
    ByModel,
    Limits,
    OnlyMaps,
    Paper,
    People,
    Unless,
    at,
    conditions,
    of_kind,
)
from radhar_cli.config.number import (
    Angle,
    AtLeastOne,
    Choice,
    Coordinate,
    Decibel,
    NotNegative,
    Number,
    Positive,
    Real,
    Vector,
    nominal,
    normal,
    require,
    support,
    uniform,
    value_error,
    vary,
    within,
)
from radhar_cli.errors import did_you_mean
from radhar_cli.extensions import is_known, own_products
from radhar_cli.motion.files.names import WANTED
from radhar_cli.motion.files.reading import SUFFIXES
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.numerics.rounding import half_up
from radhar_cli.radar.board import (
    DEVICES,
    EVEN,
    MAX_SIDELOBE,
    Array,
    Places,
    longest_rows,
    sidelobe,
)
from radhar_cli.radar.materials import Material

if TYPE_CHECKING:
    from radhar_cli.config.ti_header import BoardHeader

Flag: TypeAlias = Annotated[bool, Field(strict=True)]


class Section(BaseModel):
    """Base of all config models."""

    model_config = ConfigDict(
        extra="forbid", frozen=True, validate_default=True, allow_inf_nan=False
    )

    @classmethod
    def descriptions(cls) -> dict[str, str]:
        """What stands under each field in the source; Pydantic would read it at every start."""
        body = ast.parse(dedent(inspect.getsource(cls))).body[0]
        assert isinstance(body, ast.ClassDef)
        return {
            ast.unparse(field.target): inspect.cleandoc(text.value.value)
            for field, text in pairwise(body.body)
            if isinstance(field, ast.AnnAssign)
            and isinstance(text, ast.Expr)
            and isinstance(text.value, ast.Constant)
            and isinstance(text.value.value, str)
        }


T = TypeVar("T")
S = TypeVar("S", bound=Section)


def _by_slug(value: dict[str, Any]) -> dict[str, Any]:
    numbers = dict[str, Any]()
    for name, number in value.items():
        slug = TWELVE.get(name.strip().lower(), name)
        if slug in numbers:
            raise value_error(f"should name {slug} once")
        numbers[slug] = number
    if not numbers:
        raise value_error("should name one activity or more, or `default`")
    return numbers


@dataclass(frozen=True)
class PerActivity(Generic[T]):
    """``{per_activity: {default: 2.0, walking: 1.0, S9: 1.0}}``: a number by activity.

    Without a default, the activities that are not named keep that of the key, or of its model.
    Names that are none of the twelve's are a config's own classes, which `Config` knows.
    """

    per_activity: Annotated[dict[str, T], AfterValidator(_by_slug)]

    __pydantic_config__ = ConfigDict(extra="forbid")


def _kind(value: Any) -> str:
    several = "per_activity" in value if isinstance(value, dict) else isinstance(value, PerActivity)
    return "<per_activity>" if several else "<same>"


# A number that may also differ by activity.
By: TypeAlias = Annotated[
    Annotated[T, Tag("<same>")] | Annotated[PerActivity[T], Tag("<per_activity>")],
    Discriminator(_kind),
]


def by_activity(default: Number, **others: Number) -> PerActivity[Number]:
    """A number for every activity, and others for those named."""
    return PerActivity({DEFAULT: default, **others})


def for_activity(value: Any, activity: Activity) -> Any:
    """Return the number that holds for one activity."""
    if isinstance(value, PerActivity):
        numbers = value.per_activity
        return numbers[activity.slug if activity.slug in numbers else DEFAULT]
    return value


Place: TypeAlias = tuple[Real, Real]
HalfPower = Annotated[float, Field(ge=1, le=1000, strict=True)]
_BOARD, _NO_BOARD = ActsIf("radar.cfg", GIVEN), ActsIf("radar.cfg", None)
_NO_IMPULSE = ActsIf("radar.waveform", "fmcw", "sfcw", "cw")
_EVEN = Unless("radar.frames_apart", "the pauses between a board's frames (radar.cfg)")
BOOST = "IWR1443BOOST"


class ArrayConfig(Section):
    """Antenna elements of a board, (left, up) in half wavelengths, looking out of the radar."""

    tx: Annotated[tuple[Place, ...], Field(min_length=1, max_length=4)] = DEVICES[BOOST].tx
    """Places of the transmitters, in the order of the board's TX 1, 2, 3."""
    rx: Annotated[tuple[Place, ...], Field(min_length=1, max_length=4)] = DEVICES[BOOST].rx
    """Places of the receivers, in the order of the board's RX 1 to 4."""


class BeamConfig(Section):
    """A beam of -min(12 (az/azimuth_deg)^2 + 12 (el/elevation_deg)^2, most_db) dB, one way."""

    azimuth_deg: Annotated[Positive, within(1, 1000, "degree")] = 70.0
    """Full width of the beam in azimuth at -3 dB."""
    elevation_deg: Annotated[Positive, within(1, 1000, "degree")] = 30.0
    """Full width of the beam in elevation at -3 dB."""
    pan_deg: Angle = 0.0
    """Angle of the boresight from the x axis, positive to the left."""
    tilt_deg: Angle = 0.0
    """Angle of the boresight below the horizontal, positive down."""
    most_db: Annotated[NotNegative, within(0, 120, "dB")] = 30.0
    """Largest loss: no direction gets less than this below the gain of the boresight."""


class RadarConfig(Section):
    """Waveform, antenna positions and gains; every number may be drawn."""

    carrier_hz: Annotated[Positive, within(1e6, 1e13, "Hz")] = 77e9
    """Carrier frequency at the start of the chirp."""
    bandwidth_hz: Annotated[
        Positive | None, within(1e3, 1e12, "Hz"), ByModel(human=1e9, paper=4e9, file=4e9)
    ] = None
    """Bandwidth B that a chirp sweeps; the range step is c/2B. With the default chirp 1 and 4 GHz
    have a half-band of 30 and 7.5 m."""
    prf_hz: Annotated[
        Positive | None, within(1e-3, 1e7, "Hz"), ByModel(human=1e4, paper=5e3, file=5e3)
    ] = None
    """Pulse repetition frequency, chirps per second; 10 kHz is +-9.7 m/s at 77 GHz, and a kick's
    foot reaches 7 to 9."""
    adc_rate_hz: Annotated[Positive, within(1e-3, 1e13, "Hz")] = 10e6
    """Sampling rate of the ADC within a chirp."""
    chirp_s: Annotated[Positive, within(1e-12, 1e4, "s")] = 40e-6
    """Duration of a chirp, at most 1/prf_hz."""
    tx_m: Annotated[Vector, _NO_BOARD] = (0.4, -0.1, 1.5)
    """Place of the transmitter: range, cross-range, height."""
    rx_m: Annotated[Vector, _NO_BOARD] = (0.4, 0.1, 1.5)
    """Place of the receiver: range, cross-range, height."""
    antenna_gain_dbi: Annotated[Decibel, within(-150, 150, "dBi")] = 6.0
    """Gain of each antenna at its boresight."""
    antenna_isolation_db: Annotated[Decibel, _NO_BOARD] = 10.0
    """Isolation between transmitter and receiver; only a raw echo shows the leakage."""
    residual_video_phase: Annotated[Flag, _NO_BOARD] = False
    """Whether the beat keeps the residual video phase, the term pi K tau^2."""
    polarisation: Annotated[
        Literal["vertical", "horizontal"],
        ActsIfAny(ActsIf("room.faces", GIVEN), ActsIf("wall.echoes", "exact")),
    ] = "vertical"
    """Polarisation of the antennas' field, for room.faces and wall.echoes; horizontal is along
    y."""
    beam: BeamConfig | None = None
    """Beam of both antennas; null radiates evenly. A board has radar.half_power_deg instead."""
    waveform: Literal["fmcw", "sfcw", "cw", "impulse"] = "fmcw"
    """sfcw: sweeps of steps, sampled once each; cw: one sample a pulse, at carrier_hz; impulse:
    Gaussian pulses from carrier_hz to carrier_hz + bandwidth_hz (-10 dB). Without adc_rate_hz and
    chirp_s; cw without bandwidth_hz."""
    output: Annotated[Literal["iq", "real"], ActsIf("radar.waveform", "cw")] = "iq"
    """Output of a cw radar: iq, or real for the in-phase channel alone, whose Doppler is
    symmetric."""
    steps: Annotated[
        Annotated[int, Field(ge=2, le=2**20, strict=True)] | None, ActsIf("radar.waveform", "sfcw")
    ] = None
    """Number of frequencies of an sfcw sweep, carrier_hz + n bandwidth_hz/steps."""
    dwell_s: Annotated[
        Annotated[float, Field(gt=0, le=1e3, strict=True)] | None, ActsIf("radar.waveform", "sfcw")
    ] = None
    """Time that an sfcw radar stays on each frequency."""
    profile_m: Annotated[tuple[Real, Real] | None, ActsIf("radar.waveform", "impulse")] = None
    """Range axis [from, to] of an impulse radar's profiles, m."""
    profile_samples: Annotated[
        int, Field(ge=2, le=2**16, strict=True), ActsIf("radar.waveform", "impulse")
    ] = 256
    """Number of range samples in an impulse radar's profile."""
    cfg: Annotated[str, Field(min_length=1, max_length=2**16)] | None = None
    """The .cfg of a TI board, which gives the waveform: a path from this file's folder on, or a
    known radar (docs/guide/boards.md). A config that is written has its text."""
    device: Annotated[Literal[tuple(DEVICES)] | None, _BOARD] = None  # type: ignore[valid-type]
    """TI board that the .cfg runs on; it decides the antenna array."""
    array: Annotated[ArrayConfig | None, _BOARD] = None
    """Antenna array used instead of the device's."""
    position_m: Annotated[Vector, _BOARD] = (0.0, 0.0, 1.0)
    """Position of a board: range, cross-range, height."""
    yaw_deg: Annotated[Angle, _BOARD] = 0.0
    """Angle of a board's boresight from the x axis, positive to the left."""
    tilt_deg: Annotated[Angle, _BOARD] = 0.0
    """Angle of a board's boresight below the horizontal, positive down."""
    half_power_deg: Annotated[tuple[HalfPower, HalfPower] | None, _BOARD] = None
    """Half-power half-widths of an element in azimuth and elevation; null is the device's."""
    half_wavelength_m: Annotated[float | None, Field(gt=0, le=1, strict=True), _BOARD] = None
    """Unit of an array's places; null is c/(2 f_c), where f_c is the middle of the sampled band."""
    transmit_power_dbm: Annotated[
        Decibel, ActsIf("snr_db", None), ActsIf("receiver.noise_figure_db", GIVEN)
    ] = 12.0
    """Transmitted power, which thermal noise (receiver.noise_figure_db) is compared with."""

    @property
    def chirp_keys(self) -> dict[str, float]:
        """Keys of the chirp that another waveform has instead; empty of fmcw."""
        if self.waveform == "cw":  # of one sample; its length and band change nothing
            return {"adc_rate_hz": 1e9, "chirp_s": 1e-9, "bandwidth_hz": 1e3}
        if self.waveform == "impulse":  # whose middle is that of the band
            return {"adc_rate_hz": 1e9, "chirp_s": 2e-9}
        if self.waveform == "fmcw" or self.steps is None or self.dwell_s is None:
            return {}
        return {"adc_rate_hz": 1 / self.dwell_s, "chirp_s": self.steps * self.dwell_s}

    @property
    def header(self) -> "BoardHeader":
        """Header of the board that `cfg` describes.

        Raises:
            CaptureError: `cfg` cannot be read.
        """
        from radhar_cli.config.ti_header import board_header  # which knows this schema

        assert self.cfg is not None
        return board_header(self.cfg)

    @property
    def frames_apart(self) -> bool:
        """Whether a board pauses between its frames."""
        return self.cfg is not None and self.header.frames_apart

    @property
    def elements(self) -> Array | None:
        """Antenna elements of a board: those of `array`, or its device's."""
        if self.array is None:
            return DEVICES.get(str(self.device))
        return Array(self.array.tx, self.array.rx, (1.0,) * len(self.array.rx), EVEN)


Metres = Annotated[NotNegative, within(0, 1, "m")]
Rate = Annotated[NotNegative, within(0, 20, "Hz")]
Ratio = Annotated[NotNegative, within(0, 10)]
Signed = Annotated[Number, within(-1, 1)]
Speed = Annotated[NotNegative, within(0, 1e4, "m/s")]
Frequency = Annotated[NotNegative, within(0, 1e3, "Hz")]
Seconds = Annotated[NotNegative, within(0, 1e7, "s")]
Samples = Annotated[int, Field(ge=1, le=10_000_000, strict=True)]


class SubjectConfig(Section):
    """The person: body; of the human model also sway, breathing (chest) and pulse (heart)."""

    height_m: Annotated[Positive, within(0.1, 10, "m"), Limits(1.5, 2.1), PERSONAL] = uniform(
        1.5, 1.9
    )
    """Stature of the person."""
    weight_kg: Annotated[Positive | None, within(1e-3, 1e6, "kg"), PERSONAL] = None
    """Body mass of the person; null is 26 kg/m^2 times the height squared."""
    sway_ahead_m: Annotated[Metres, People("", 0, 0.01), PERSONAL] = uniform(0.002, 0.006)
    """Standard deviation of a standing person's sway forwards and backwards."""
    sway_aside_m: Annotated[Metres, People("", 0, 0.01), PERSONAL] = uniform(0.0015, 0.0035)
    """Standard deviation of a standing person's sway to the sides."""
    breathing_hz: Annotated[Rate, People("", 0, 2), PERSONAL] = normal(0.25, 0.04, 0.15, 0.4)
    """Breathing rate, breaths per second."""
    chest_m: Annotated[Metres, People("", 0, 0.01), PERSONAL] = uniform(0.002, 0.006)
    """Amplitude of the chest's motion by breathing."""
    pulse_hz: Annotated[Rate, People("", 0, 4), PERSONAL] = normal(1.15, 0.12, 0.8, 1.8)
    """Heart rate, beats per second."""
    heart_m: Annotated[Metres, People("", 0, 0.002), PERSONAL] = uniform(0.0001, 0.0004)
    """Amplitude of the chest's motion by the heartbeat."""


FallName = Literal["forward", "backward", "sideways"]
FALLS: tuple[FallName, ...] = FallName.__args__  # type: ignore[attr-defined]


SEATS = "sitting_down standing_up falling_off_seat falling_on_rising"


class Falls(Section):
    """``{choice: [forward, forward, sideways]}``: one of the directions, equally likely."""

    choice: Annotated[tuple[FallName, ...], Field(min_length=1)]

    def drawn(self, u: float) -> FallName:
        """The direction at a fraction u, 0 to 1, of the draws."""
        ordered = sorted(self.choice, key=FALLS.index)
        return ordered[min(int(u * len(ordered)), len(ordered) - 1)]


# People face the radar, and in 6 s walk 8 m towards it: they start far enough away, all within its
# half-band of 30 m. Classes of one's own may walk all the time.
_NEARER = {a.slug: uniform(5, 8) if a.walks else uniform(2, 5) for a in ACTIVITIES}
del _NEARER["walking"]
_HUMAN_RANGE = by_activity(uniform(9.0, 12.0), **_NEARER)
_FACING = uniform(150.0, 210.0)
_GAIT = "S8 S9 S10 S11 S12"


class MotionConfig(Section):
    """Where people stand, where they head and how they move, under each model of motion.

    What another model alone knows is ignored; what is null takes the value of the model.
    """

    model: Literal["human", "paper", "file"] = "human"
    """Model of motion: human for measured gaits and movements, paper for the paper's formulas, file
    for motion files in every class (docs/guide/motion.md)."""
    folder: Annotated[str | None, Field(exclude=True, max_length=1000)] = None
    """Folder that paths of motion files are relative to; not part of a data set's identity."""
    range_m: Annotated[
        By[Coordinate] | None,
        ByModel(human=_HUMAN_RANGE, paper=uniform(1.0, 3.0), file=uniform(2.0, 4.0)),
    ] = None
    """Range at which people start: of the torso (paper), of the feet (human)."""
    cross_range_m: By[Coordinate] = 0.0
    """Cross-range at which people start, positive to the left."""
    angle_deg: Annotated[
        By[Angle] | None, ByModel(human=_FACING, paper=uniform(-30.0, 30.0), file=_FACING)
    ] = None
    """Heading of people; 0 faces away from the radar, 180 faces it."""
    speed_mps: Annotated[
        By[Speed] | None,
        People("walking", 0.3, 2.8),
        Paper(_GAIT),
        PERSONAL,
        ByModel(human=normal(1.3, 0.18, 0.7, 2.0), paper=1.5),
    ] = None
    """Walking speed."""
    gait_hz: Annotated[By[Frequency], Paper(f"S2 S3 S4 S7 {_GAIT}"), PERSONAL] = 1.0
    """Strides per second in the paper's gait."""
    thigh_deg: Annotated[By[Angle], Paper(f"S3 {_GAIT}"), PERSONAL] = vary(30.0, 0.2)
    """Peak angle of the thigh in the paper's gait and kick."""
    calf_deg: Annotated[By[Angle], Paper(f"S2 S3 {_GAIT}"), PERSONAL] = vary(45.0, 0.2)
    """Peak angle of the calf in the paper's gait, punch and kick."""
    arm_deg: Annotated[By[Angle], Paper(f"S2 {_GAIT}"), PERSONAL] = vary(35.0, 0.2)
    """Peak angle of the arm in the paper's gait and punch."""
    turn_deg: Annotated[By[Angle], People("body_rotating", -90, 90), Paper("S7"), PERSONAL] = vary(
        45.0, 0.2
    )
    """Angle through which a rotating body (S7) turns to each side."""
    rotation_hz: Annotated[By[Frequency], People("body_rotating", 0, 1)] = vary(0.45, 0.2)
    """Turns of a rotating body (S7), to both sides, per second."""
    period_scale: Annotated[By[Ratio], People("walking", 0.85, 1.05), PERSONAL] = normal(
        0.95, 0.04, 0.85, 1.05
    )
    """Stride time relative to Boulic and Thalmann's."""
    cycle_phase: Annotated[By[Signed], People("punching kicking body_rotating walking", -1, 1)] = (
        uniform(-0.5, 0.5)
    )
    """Initial phase of steady walks, punches, kicks and turns, in cycles."""
    arm_swing: Annotated[By[Ratio], People("walking", 0, 2), PERSONAL] = uniform(0.6, 1.3)
    """Arm swing of a walker, relative to Boulic and Thalmann's."""
    trunk_pitch_deg: Annotated[By[Angle], People("walking", -5, 15), PERSONAL] = normal(
        3.0, 2.0, -2.0, 8.0
    )
    """Forward pitch of a walker's trunk."""
    step_width: Annotated[By[Ratio], People("walking", 0.02, 0.1), PERSONAL] = normal(
        0.063, 0.011, 0.03, 0.1
    )
    """Distance across between a walker's feet, relative to the stature."""
    speed_variation: Annotated[By[Ratio], People("walking", 0, 0.06), UNSTEADY] = uniform(0.0, 0.06)
    """Standard deviation of a walker's speed over time, relative to the speed; that of the stride
    times is half as much, that of the step width a third, in metres."""
    lane_m: Annotated[By[Coordinate], People("walking", 0, 1000)] = 0.0
    """Length of the lane after which walkers turn round, again and again; 0 is never."""
    lane_start: Annotated[
        By[Ratio], People("walking", 0, 1), ActsIf("motion.lane_m", ABOVE_ZERO)
    ] = uniform(0.0, 1.0)
    """Share of the first lane that lies behind a walker at 0 s."""
    speed_up: Annotated[By[Ratio], People("walking", 0.4, 2)] = 0.6
    """Strides in which a walker gains speed from rest."""
    punch_hz: Annotated[By[Frequency], People("punching", 0.05, 1.1)] = vary(0.7, 0.15)
    """Pairs of punches, right and left, per second."""
    kick_hz: Annotated[By[Frequency], People("kicking", 0.05, 0.6)] = vary(0.45, 0.1)
    """Kicks per second."""
    strike_scale: Annotated[By[Ratio], People("punching kicking", 0.8, 1.25), PERSONAL] = normal(
        1.0, 0.12, 0.8, 1.25
    )
    """Duration of a punch or kick, relative to the usual one."""
    exercise_period: Annotated[By[Ratio], People("exercises", 0.6, 1.8)] = uniform(0.8, 1.3)
    """Duration of a repetition of an exercise, relative to the usual one."""
    exercise_size: Annotated[By[Ratio], People("exercises", 0.5, 1.1)] = uniform(0.75, 1.05)
    """Extent of the movements of an exercise, relative to the usual one."""
    tempo_jitter: Annotated[
        By[Ratio], People("punching kicking body_rotating exercises", 0, 0.2), UNSTEADY
    ] = uniform(0.0, 0.1)
    """Relative standard deviation of the time from one punch, kick or turn to the next."""
    size_jitter: Annotated[
        By[Ratio], People("punching kicking body_rotating exercises", 0, 0.15), UNSTEADY
    ] = uniform(0.0, 0.1)
    """Relative standard deviation of the size from one punch, kick or turn to the next."""
    bend_deg: Annotated[By[Angle], People("grabbing", 30, 85)] = normal(72.0, 5.0, 60.0, 85.0)
    """Forward pitch of the trunk when something is picked up."""
    dwell_s: Annotated[By[Coordinate], People("grabbing", -1, 60)] = uniform(0.2, 0.6)
    """Time that the hand stays at the floor when something is picked up; below 0 the rise begins
    before the descent ends, by at most 0.6 of it."""
    seat_height: Annotated[By[Ratio], People(SEATS, 0.24, 0.33)] = normal(0.285, 0.015, 0.25, 0.32)
    """Height of the seated hip, relative to the stature."""
    lean_deg: Annotated[By[Angle], People("sitting_down standing_up", 0, 60), PERSONAL] = normal(
        42.0, 8.0, 25.0, 58.0
    )
    """Forward pitch of the trunk while sitting down or rising."""
    recline_deg: Annotated[By[Angle], People(SEATS, -10, 45)] = 0.0
    """Backward pitch of the trunk in the seat."""
    hands_on_lap: Annotated[By[Ratio], People(SEATS, 0, 1)] = 1.0
    """Place of a seated person's hands: 0 is beside the seat, 1 on the lap."""
    joint_lag: Annotated[
        By[Ratio], People("grabbing sitting_down standing_up", 0, 0.6), UNSTEADY
    ] = 0.0
    """Share of a movement by which some joints lead and others lag; which ones differs between
    recordings."""
    step_m: Annotated[By[Ratio], People("S4 S5 S6", 0, 0.5), UNSTEADY] = uniform(0.0, 0.5)
    """Length of the steps back before sitting down (S5), ahead after standing up (S6) and around
    picking up (S4)."""
    settle_size: Annotated[By[Ratio], People("S4 S5 S6", 0, 3), UNSTEADY] = uniform(0.0, 3.0)
    """Size of the fidgets around the end of a movement, relative to the usual one."""
    heels_deg: Annotated[By[Angle], People("falling", 0, 90), UNSTEADY] = 0.0
    """Angle by which the shanks swing up as people land on their knees in a forward fall."""
    fall: Annotated[
        FallName | Falls, People("falling falling_off_seat falling_on_rising stumbling")
    ] = "forward"
    """Direction of a fall or stumble: forward, backward, sideways, or drawn: {choice: [forward,
    forward, sideways]}."""
    stumble_deg: Annotated[By[Angle], People("stumbling tripping", 0, 45)] = uniform(15.0, 40.0)
    """Angle of the trunk ahead before a stumble is caught; backwards and sideways it is 0.4 of
    that."""
    fidget_hz: Annotated[By[Frequency], People("", 0, 2), UNSTEADY] = uniform(0.0, 0.4)
    """Fidgets of a standing or seated person per second, in the mean."""
    fidget_size: Annotated[By[Ratio], People("", 0, 2)] = uniform(0.5, 1.5)
    """Size of a person's fidgets, relative to the usual one."""
    shuffle_hz: Annotated[By[Frequency], People("S1 S4", 0, 0.5), UNSTEADY] = uniform(0.0, 0.2)
    """Steps of some centimetres per second, of who stands (S1, and S4 afterwards)."""
    idle_phase_s: Annotated[By[Seconds], People("")] = uniform(0.0, 1000.0)
    """Time offset of sway, breathing, pulse and speed variation."""


class TimingConfig(Section):
    """When the phases of an activity begin and how long they last.

    What is null takes the value of the model.
    """

    seat_start_s: Annotated[By[Seconds], People("S5 S6"), Paper("S5 S6")] = 0.5
    """When sitting down or standing up begins."""
    seat_duration_s: Annotated[
        By[Seconds] | None,
        People("S5 S6", 1, 60),
        Paper("S5 S6"),
        ByModel(
            human=by_activity(normal(2.0, 0.4, 1.3, 3.0), standing_up=normal(1.8, 0.4, 1.2, 3.0)),
            paper=2.0,
        ),
    ] = None
    """Duration of sitting down or standing up."""
    grab_start_s: Annotated[By[Seconds], People("S4")] = 0.5
    """When picking up begins."""
    grab_duration_s: Annotated[By[Seconds], People("S4", 1, 60)] = normal(2.5, 0.5, 1.6, 3.6)
    """Duration of picking up, down and up together."""
    rise_start_s: Annotated[By[Seconds], People("S9 S11"), Paper("S9 S11")] = 0.5
    """When standing up or getting up before a walk begins."""
    rise_duration_s: Annotated[
        By[Seconds] | None,
        People("S9 S11", 1, 60),
        Paper("S9 S11"),
        ByModel(
            human=by_activity(
                normal(1.8, 0.25, 1.2, 3.0), falling_to_walking=normal(3.0, 0.5, 2.2, 4.5)
            ),
            paper=1.5,
        ),
    ] = None
    """Duration of standing up or getting up before a walk."""
    walk_begin_s: Annotated[By[Seconds] | None, People("S8", 0, 600)] = None
    """When the walk of S8 begins, after standing; null is a walk that is under way at 0 s."""
    walk_start_s: Annotated[
        By[Seconds] | None, People("S9 S11", 0, 600), Paper("S9 S11"), ByModel(paper=2.0)
    ] = None
    """When the walk after rising begins; null of people is when they have risen, less overlap_s."""
    walk_stop_s: Annotated[By[Seconds], People("S10 S12", 0.5, 600), Paper("S10 S12")] = 2.0
    """When the walk before sitting down or falling ends."""
    sit_duration_s: Annotated[
        By[Seconds] | None,
        People("S10", 1, 60),
        Paper("S10"),
        ByModel(human=normal(2.0, 0.25, 1.3, 3.0), paper=1.5),
    ] = None
    """Duration of sitting down after a walk."""
    fall_duration_s: Annotated[
        By[Seconds] | None,
        People("S12", 0.7, 10),
        Paper("S12"),
        ByModel(human=normal(1.1, 0.4, 0.9, 2.0), paper=0.8),
    ] = None
    """Duration of the fall after a walk."""
    blend_s: Annotated[By[Seconds], Paper("S9 S10 S11 S12")] = 0.3
    """Duration of the raised-cosine ramps of the gait, in and out; 0 is a hard switch."""
    overlap_s: Annotated[By[Seconds], People("S9 S10 S11 S12", 0, 0.8)] = 0.0
    """Time by which the second movement starts before the first ends, unless walk_start_s says
    when. A scene gets at most 0.3 of the duration of rising, sitting down or falling, and nothing
    of a fall to the side: its number is what it got."""


MIN_MOVEMENT_S = 0.3


FileSecond = Annotated[float, Field(ge=0, le=1e5, strict=True)]


class SequenceConfig(Section):
    """A class of your own: movements one after the other, joined at rest."""

    sequence: Annotated[tuple[str, ...], Field(min_length=1, max_length=64)]
    """Movements of the class in order, by their names (docs/guide/motion.md)."""
    durations_s: tuple[Seconds | None, ...] = ()
    """Duration of each movement; null is the usual one, and of the last movement until the
    recording ends."""
    pauses_s: tuple[Seconds, ...] = ()
    """Time at rest before each movement; left out, there is none."""

    @model_validator(mode="after")
    def _joined(self) -> "SequenceConfig":
        count, last = len(self.sequence), len(self.sequence) - 1
        if not self.durations_s:
            object.__setattr__(self, "durations_s", (None,) * count)
        if not self.pauses_s:
            object.__setattr__(self, "pauses_s", (0.0,) * count)
        if not len(self.durations_s) == len(self.pauses_s) == count:
            raise value_error("should have as many durations_s, and pauses_s, as movements")
        state = None
        for n, (name, duration) in enumerate(zip(self.sequence, self.durations_s, strict=True)):
            movement = MOVEMENTS.get(name)
            if movement is None:
                hint = advice_on(name, MOVEMENTS, f"movements are {', '.join(MOVEMENTS)}")
                raise value_error(f"{name!r} is not a movement; {hint}")
            if state not in (None, movement.before):
                raise value_error(
                    f"should be joined at rest: {name} begins {movement.before}, "
                    f"{self.sequence[n - 1]} ends {state}"
                )
            if duration is not None and not support(duration)[0] >= MIN_MOVEMENT_S:
                raise value_error(f"should have durations_s from {MIN_MOVEMENT_S} s on")
            if movement.seconds is None and duration is None and n < last:
                raise value_error(f"should have a duration of {name}, which something follows")
            state = movement.after
        return self


MAX_FILES = 1500  # of all classes together
MAX_PATH_LENGTH = 240
Share01 = Annotated[Number, within(0, 1)]


class FilesConfig(Section):
    """A class whose motion is recorded: BVH, AMC or npz files; a list of them is enough."""

    files: dict[str, str]
    """Motion files {path: SHA-256}; a list of paths and patterns when a person writes it."""
    skeleton: Annotated[str, Field(max_length=MAX_PATH_LENGTH)] | None = None
    """ASF file of AMC files, where it is not beside them."""
    joints: dict[str, Annotated[str, Field(min_length=1, max_length=100)]] = {}
    """Names of joints {radhar's: the file's}, where the tables of names do not know the file's."""
    up: Literal["x", "y", "z", "-x", "-y", "-z"] | None = None
    """Axis of the files that points up; null finds it by the body's pose."""
    unit_m: Annotated[float, Field(ge=1e-6, le=1e3, strict=True)] | None = None
    """Length unit of the files; null finds it by the body's size."""
    rate_hz: Annotated[float, Field(ge=1, le=1e4, strict=True)] | None = None
    """Frames per second of the files, instead of what they say."""
    section_s: tuple[FileSecond, FileSecond] | None = None
    """Section [from, to] of each file that is used; null is all of it."""
    low_pass_hz: Annotated[float, Field(ge=0.1, le=1e3, strict=True)] | None = 8.0
    """Cut-off of the zero-phase low-pass of the positions; null is no filter."""
    past_end: Literal["rest", "loop"] = "rest"
    """What people do where a file is shorter than the recording: they come to rest, or go on in a
    loop."""
    file: Annotated[int, Field(ge=0, strict=True)] | None = None
    """Number of the one file that is used, from 0; null draws one."""
    start: Share01 = uniform(0.0, 1.0)
    """Place in the section at which a recording begins, 0 at the earliest, 1 at the latest."""
    playback_speed: Annotated[Number, within(0.25, 4)] = uniform(0.9, 1.1)
    """Playback rate, seconds of the file per second of the recording."""
    mirror: Share01 = Choice(choice=(0, 1))
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
    def _known(cls, value: dict[str, str]) -> dict[str, str]:
        for path in value:
            if not path.lower().endswith(SUFFIXES) or len(path) > MAX_PATH_LENGTH or "\0" in path:
                raise value_error(f"should be paths of {', '.join(SUFFIXES)} files, not {path!r}")
        if not 0 < len(value) <= MAX_FILES:
            raise value_error(f"should have 1 to {MAX_FILES} files")
        return value

    @field_validator("joints")
    @classmethod
    def _ours(cls, value: dict[str, str]) -> dict[str, str]:
        for name in value:
            if name not in WANTED:
                raise value_error(did_you_mean(name, WANTED, f"joints are {', '.join(WANTED)}"))
        return value

    @model_validator(mode="after")
    def _one_of_them(self) -> "FilesConfig":
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


def _class_kind(value: Any) -> str:
    of_files = isinstance(value, (FilesConfig, list, tuple))
    of_files |= isinstance(value, dict) and "files" in value
    return "<recordings>" if of_files else "<movements>"


ClassConfig: TypeAlias = Annotated[
    Annotated[SequenceConfig, Tag("<movements>")] | Annotated[FilesConfig, Tag("<recordings>")],
    Discriminator(_class_kind),
]


Size: TypeAlias = Annotated[Positive, within(1e-6, 1e6, "m")]


class LayerConfig(Section):
    """A layer of a wall, of a material or of a permittivity."""

    thickness_m: Size = 0.1
    """Thickness of the layer."""
    material: Material | None = None
    """Material of ITU-R P.2040, whose permittivity depends on frequency; null takes eps_r."""
    eps_r: Annotated[AtLeastOne | None, within(1, 1e6)] = None
    """Relative permittivity of the layer, where no material is named."""
    loss_tangent: Annotated[NotNegative, within(0, 1e12)] = 0.0
    """Loss tangent of the layer, used with eps_r."""


_NO_LAYERS = ActsIf("wall.layers", None)


class WallConfig(Section):
    """Centre, size along x, y, z, relative permittivity and loss tangent of the wall.

    `rays` and `fresnel` are optional physics; docs/physics/engines.md has the size of it.
    """

    center_m: Vector = (1.0, 0.0, 1.25)
    """Middle of the wall: range, cross-range, height."""
    size_m: tuple[Size | None, Size, Size] = (0.24, 5.0, 2.5)
    """Extent of the wall in range, cross-range, height; with layers, whose thickness counts, [null,
    y, z]."""
    eps_r: Annotated[AtLeastOne, within(1, 1e6), _NO_LAYERS] = 6.0
    """Relative permittivity of the wall."""
    loss_tangent: Annotated[NotNegative, within(0, 1e12), _NO_LAYERS] = 0.03
    """Loss tangent of the wall's material."""
    rays: Annotated[
        Literal["straight", "plane", "refracted"] | None,
        ByModel(human="plane", paper="straight", file="plane"),
    ] = None
    """Path of a ray through the wall: the chord, a plane wave's at the same angle, or Snell's
    law."""
    fresnel: Literal["normal", "perpendicular", "parallel"] = "normal"
    """Loss of the wall's faces: at normal incidence, or at the ray's angle with the field
    perpendicular or parallel to its plane."""
    echoes: Literal["none", "exact"] = "none"
    """Reflections inside the wall: none, or exact over frequency, by radar.polarisation; exact
    needs engine.kind: cube or an impulse radar."""
    layers: Annotated[
        Annotated[tuple[LayerConfig, ...], Field(min_length=1, max_length=16)] | None,
        ActsIf("wall.echoes", "exact"),
    ] = None
    """Layers of the wall, nearest first, with echoes: exact; null is one layer of size_m, eps_r and
    loss_tangent."""


_SEGMENTS = ActsIf("body.scatterers", "segments")


class BodyConfig(Section):
    """What of a person scatters: the joints as points, or the segments between them.

    `segments` are ellipsoids of `points_per_segment` points at most; how many a recording needs
    follows from its speeds, window and wavelength (docs/physics/bodies.md).
    """

    scatterers: Literal["points", "segments", "surfaces"] = "points"
    """What scatters: the 13 joints, ellipsoids between them, or surfaces that face the radar."""
    points_per_segment: Annotated[
        int, Field(ge=1, le=1000, strict=True), ActsIf("body.scatterers", "segments", "surfaces")
    ] = 20
    """Largest number of points of a segment; a surface has 14 at most."""
    shadowing: Annotated[Flag, ActsIfAny(_SEGMENTS, ActsIf("people", GIVEN))] = True
    """Whether trunk and thighs hide the segments behind them and, with `people`, each person hides
    others."""


class ReflectorConfig(Section):
    """Something that stands in the room, with a residual motion along the line of sight."""

    position_m: Vector = (uniform(1.0, 6.0), uniform(-3.0, 3.0), uniform(0.0, 2.5))
    """Position of the reflector: range, cross-range, height."""
    rcs_dbsm: Annotated[Number, within(-120, 120, "dBsm")] = uniform(-10.0, 10.0)
    """Radar cross-section of the reflector."""
    residual_m: Annotated[NotNegative, within(0, 0.01, "m")] = uniform(5e-5, 5e-4)
    """Standard deviation of the reflector's small motion along the line of sight."""
    highest_hz: Annotated[Positive, within(1e-3, 100, "Hz")] = 10.0
    """Highest frequency of the reflector's small motion."""


MAX_REFLECTORS = 32


class DielectricConfig(Section):
    """A material by its permittivity eps_r (1 - j loss_tangent)."""

    eps_r: Annotated[AtLeastOne, within(1, 1e6)] = 5.0
    """Relative permittivity of the material."""
    loss_tangent: Annotated[NotNegative, within(0, 1e12)] = 0.0
    """Loss tangent of the material."""


class BoxConfig(Section):
    """Where the faces of a room are; the floor is at 0."""

    x: tuple[Number, Number] = (0.0, 6.0)
    """Ranges of the front and the back face, m."""
    y: tuple[Number, Number] = (-2.5, 2.5)
    """Cross-ranges of the right and the left face, m."""
    height: Positive = 2.8
    """Height of the ceiling, m."""


def _material_kind(value: Any) -> str:
    return "<dielectric>" if isinstance(value, (dict, DielectricConfig)) else "<material>"


_Face = Annotated[
    Annotated[Material, Tag("<material>")] | Annotated[DielectricConfig, Tag("<dielectric>")],
    Discriminator(_material_kind),
]


class FacesConfig(Section):
    """What the faces of a room are made of: ITU-R P.2040's name, or {eps_r, loss_tangent}."""

    floor: _Face | None = None
    """Material of the floor: concrete, brick, plasterboard, wood, glass, ceiling_board, chipboard,
    floorboard, metal, or {eps_r, loss_tangent}; null does not reflect. The floor alone needs no
    room.box_m."""
    ceiling: _Face | None = None
    """Material of the ceiling, at the height of room.box_m."""
    left: _Face | None = None
    """Material of the face at the larger y of room.box_m."""
    right: _Face | None = None
    """Material of the face at the smaller y of room.box_m."""
    front: _Face | None = None
    """Material of the face at the smaller x of room.box_m."""
    back: _Face | None = None
    """Material of the face at the larger x of room.box_m."""

    @property
    def given(self) -> dict[str, Material | DielectricConfig]:
        """{name: material} of the faces that reflect."""
        return {name: one for name in type(self).model_fields if (one := getattr(self, name))}


class RoomConfig(Section):
    """What stands in the room, what its faces echo, or a wall behind people."""

    box_m: Annotated[BoxConfig | None, ActsIf("room.faces", GIVEN)] = None
    """Places of the room's faces."""
    faces: FacesConfig | None = None
    """Faces in which people are seen again; null is none."""
    order: Annotated[int, Field(ge=0, le=2, strict=True), ActsIf("room.faces", GIVEN)] = 1
    """Largest number of bounces of a path, on the ways there and back together."""

    reflectors: Annotated[tuple[ReflectorConfig, ...], Field(max_length=MAX_REFLECTORS)] = ()
    """Things that stand in the room, up to 32 of {position_m, rcs_dbsm, residual_m, highest_hz};
    `[{}, {}]` is two default ones."""
    back_wall_m: Annotated[Number, within(0, 1e4, "m")] | None = None
    """Range of a rear wall beyond people, which mirrors them (image source); null is none."""
    back_wall_reflection_db: Annotated[
        Number, within(-120, 0, "dB"), ActsIf("room.back_wall_m", GIVEN)
    ] = -8.0
    """Reflection loss of the rear wall, applied twice to the mirrored echo."""


class ToneConfig(Section):
    """Interference at a fixed Doppler.

    on_s, off_s: mean times for which it is on and off; always on where off_s is 0.
    """

    doppler_hz: Annotated[Number, within(-1e7, 1e7, "Hz")]
    """Doppler frequency of the tone."""
    level_db: Decibel = -10.0
    """Level of the tone, relative to the white noise of a raw sample."""
    on_s: Annotated[Positive, within(1e-3, 1e7, "s")] = 1.0
    """Mean time for which the tone is on."""
    off_s: Annotated[NotNegative, within(0, 1e7, "s")] = 0.0
    """Mean time for which the tone is off; 0 is always on."""
    both_sides: Flag = False
    """Whether the tone stands as strong at the opposite Doppler, at the same times: amplitude
    modulation, real samples. At 0 Hz the two are one tone of 6 dB more."""


class ReceiverConfig(Section):
    """Noise that grows towards zero Doppler, and interference tones, beside the white noise."""

    noise_corner_hz: Annotated[
        NotNegative, within(0, 1e7, "Hz"), ActsIf("receiver.noise_corner_hz", ABOVE_ZERO)
    ] = 0.0
    """Doppler at which noise that grows towards zero equals the white noise; 0 is no such noise."""
    noise_slope_db: Annotated[
        NotNegative,
        within(1, 20, "dB per decade"),
        ActsIf("receiver.noise_corner_hz", ABOVE_ZERO),
    ] = 10.0
    """Slope of the noise that grows towards zero Doppler, dB per decade."""
    tones: Annotated[tuple[ToneConfig, ...], Field(max_length=16)] = ()
    """Interference tones: up to 16 of {doppler_hz, level_db, on_s, off_s, both_sides}."""
    noise_figure_db: Annotated[
        Annotated[NotNegative, within(0, 100, "dB")] | None, ActsIf("snr_db", None)
    ] = None
    """F of thermal noise, k T0 fs F in a raw sample, where snr_db is null; null is no noise. Left
    out, it is 15 dB of a board; given, it makes snr_db null unless that is given, too."""
    channel_gain_db: Annotated[NotNegative, within(0, 20, "dB"), _BOARD] = 0.0
    """Standard deviation of the virtual channels' gains."""
    channel_phase_deg: Annotated[NotNegative, within(0, 180, "degree"), _BOARD] = 0.0
    """Standard deviation of the virtual channels' phases."""
    channel_errors: Annotated[
        Literal["data_set", "sample"],
        _BOARD,
        ActsIfAny(
            ActsIf("receiver.channel_gain_db", ABOVE_ZERO),
            ActsIf("receiver.channel_phase_deg", ABOVE_ZERO),
        ),
    ] = "data_set"
    """How often gains and phases of the channels are drawn: once a data set, or once a sample."""


class SavgolConfig(Section):
    """The Savitzky-Golay filter of the denoised maps."""

    order: Annotated[int, Field(ge=0, le=30, strict=True)] = 5
    """Order of the polynomial."""
    frame: Annotated[int, Field(ge=1, strict=True)] = 11
    """Number of pulses that the polynomial is fitted to; odd, above the order."""

    @model_validator(mode="after")
    def _fits(self) -> "SavgolConfig":
        if self.frame % 2 == 0 or self.frame <= self.order:
            raise value_error("should have a frame that is odd and above the order")
        return self


class HighpassConfig(Section):
    """The Butterworth filter of `clutter: highpass`."""

    order: Annotated[int, Field(ge=1, le=10, strict=True)] = 4
    """Order of the filter."""
    cutoff_hz: Annotated[float, Field(gt=0, le=1e7, strict=True)] | None = None
    """Cut-off frequency; null is 0.00375 of the PRF."""
    zero_phase: Flag = False
    """Whether the filter runs both ways, without a delay."""
    remove_mean: Flag = True
    """Whether the mean is taken out first; false starts from rest as MATLAB's `filter`: static
    echoes ring."""

    def cutoff(self, prf: float) -> float:
        """Cut-off of the filter as a fraction of PRF/2, for `prf` pulses a second."""
        return DEFAULT_CUTOFF if self.cutoff_hz is None else 2 * self.cutoff_hz / prf


DEFAULT_CUTOFF = 0.0075  # of PRF/2
LIMB_ACCELERATION = 2.0  # m/s^2 along the line of sight; gait and kicks are resolved at 2 to 77 GHz
MAX_WINDOW_SHARE = 0.25
MIN_WINDOW = 8
PAPER_WINDOW = 0.1  # of the recording


_GATED = ActsIf("processing.range_sum", "gated")
_SPECTRA = OnlyMaps("st")  # of stft and fsst


class ProcessingConfig(Section):
    """Clutter, range compression, gate, windows and thresholds."""

    clutter: Literal["difference", "mean", "highpass", "none"] = "difference"
    """Clutter canceller: difference is s[m + 1] - s[m], the paper's MTI; mean takes out that of the
    recording; highpass is the filter below."""
    highpass: Annotated[HighpassConfig, ActsIf("processing.clutter", "highpass")] = HighpassConfig()
    range_sum: Annotated[Literal["coherent", "gated"], _SPECTRA] = "coherent"
    """What Doppler maps show: the coherent sum of the kept bins, or STFTs of those in the gate,
    summed incoherently."""
    gate_m: Annotated[float | tuple[float, float], _GATED] = 1.0
    """Reach of the gate to both sides of the torso, m, or [from, to]: fixed ranges."""
    gate_sum: Annotated[Literal["power", "magnitude"], _GATED] = "power"
    """How the gate's bins are added up: their powers, or (sum of the magnitudes)^2."""
    range_fft_length: Annotated[
        Annotated[int, Field(ge=2, multiple_of=2, strict=True)] | None, _NO_BOARD
    ] = None
    """Length of the range FFT, even, at least the samples of a chirp; null finds one."""
    range_gain_power: Annotated[float, Field(ge=0, le=8, strict=True), OnlyMaps("rtm")] = 0.0
    """Exponent p of the gain (R/largest R)^p of the rtm's range bins, after canceller and noise."""
    range_reference: Annotated[Literal["centre", "start"], _NO_BOARD] = "centre"
    """Instant of the chirp at which the phase of range bins is taken."""
    window_s: Annotated[float | None, Field(gt=0, le=1e7, strict=True), _SPECTRA] = None
    """Length of the STFT's window; null is a tenth of duration_s (paper), else by the wavelength,
    as limbs need."""
    overlap_fraction: Annotated[float, Field(ge=0, lt=1, strict=True), _SPECTRA, _EVEN] = 0.9
    """Overlap of consecutive STFT windows, as a fraction of the window."""
    stft_fft_length: Annotated[int | None, Field(ge=8, strict=True), OnlyMaps("stft")] = None
    """Length of the STFT's FFT, at least the window; null finds one."""
    savgol: Annotated[SavgolConfig, OnlyMaps("denoised")] = SavgolConfig()
    fsst_hop_pulses: Annotated[int | None, Field(ge=1, le=2**24, strict=True), OnlyMaps("fsst")] = (
        None
    )
    """Hop of the fsst maps in pulses; 1 is every sample, null the STFT's."""
    fsst_threshold: Annotated[float, Field(ge=0, lt=1, strict=True), OnlyMaps("fsst")] = 1e-3
    """Share of the fsst map's largest coefficient below which coefficients are left out."""

    @field_validator("gate_m", mode="before")
    @classmethod
    def _distance_or_interval(cls, value: Any) -> Any:
        numbers = value if isinstance(value, (list, tuple)) and len(value) == 2 else [value]
        good = all(type(one) in (int, float) and 0 <= one <= 1e7 for one in numbers)
        if not good or sorted(numbers) != list(numbers) or numbers == [0]:
            raise value_error(
                "should be how far (m) the gate reaches to both sides of the torso, above 0, "
                "or [from, to], ranges with from <= to; 1e7 at most"
            )
        return value

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
        seconds = sqrt(2 * SPEED_OF_LIGHT / f0 / LIMB_ACCELERATION)
        return max(half_up(min(seconds, MAX_WINDOW_SHARE * duration), prf), MIN_WINDOW)


BOARD_GAIN_DBI, BOARD_NOISE_FIGURE_DB = 9.0, 15.0
DEFAULT_COLOUR_MAP = "viridis"
Pixels = Annotated[int, Field(ge=2, le=8192, strict=True)]


Cells = Annotated[int, Field(ge=0, le=4096, strict=True)]


class CfarConfig(Section):
    """Cell-averaging CFAR of `image.kind: cfar`; cells are pixels, (rows, columns) on each side.

    With `domain: decibel` the map's median is put at floor_db: a factor of decibels needs a zero.
    """

    guard: tuple[Cells, Cells] = (10, 2)
    """Guard cells on each side, [rows, columns] of pixels, left out of the average."""
    training: tuple[Cells, Cells] = (50, 10)
    """Training cells on each side, [rows, columns] of pixels, averaged."""
    pfa: Annotated[Positive, within(1e-12, 0.999)] = 0.31
    """False alarm rate in exponentially distributed power, which gives the threshold."""
    domain: Literal["power", "decibel"] = "decibel"
    """Quantity that is averaged and compared."""
    floor_db: Annotated[Decibel, within(0, 200, "dB"), ActsIf("image.cfar.domain", "decibel")] = (
        uniform(10.0, 30.0)
    )
    """Level at which the map's median is put with `domain: decibel`: the threshold is then a factor
    of decibels."""
    edges: Literal["wrap", "shrink"] = "wrap"
    """What stands for cells beyond an edge: those of the opposite edge, or none."""


class CloudConfig(Section):
    """How points are found in the frames of a board (docs/guide/boards.md)."""

    chain: Literal["best", "board"] = "best"
    """Detection chain: best is what the data allow, board what TI's firmware does with the .cfg."""
    pfa: Annotated[float, Field(gt=0, le=0.1, strict=True), ActsIf("cloud.chain", "best")] = 1e-5
    """Rate of false alarms of a range-Doppler cell."""
    quantise: Annotated[Flag, ActsIf("cloud.chain", "board")] = True
    """Whether numbers are rounded as the firmware's fixed-point ones."""
    doppler_carrier: Literal["centre", "start"] = "centre"
    """Frequency that the points' speeds refer to; TI's software takes that at which ramps start."""


class ImageConfig(Section):
    """Size (height, width; one number means square), what pixels show, colour map, Doppler limits.

    Doppler limits are speeds, positive approaching.
    """

    size_px: Annotated[
        tuple[Pixels, Pixels],
        BeforeValidator(
            lambda one: (one, one) if isinstance(one, int) else one,
            json_schema_input_type=Pixels | tuple[Pixels, Pixels],
        ),
    ] = (256, 256)
    """Image size [height, width]; one number is a square."""
    kind: Literal["decibel", "cfar", "signed"] = "decibel"
    """What pixels show: grey levels of decibels; cfar, binary masks of what exceeds its background;
    or signed, the samples of an impulse radar's rtm, 0 in the middle."""
    clipped: Annotated[float, Field(ge=0, lt=1, strict=True), ActsIf("image.kind", "signed")] = 0.02
    """Share of the samples that are black or white."""
    dynamic_range_db: Annotated[float, Field(gt=0, le=300, strict=True)] = 50.0
    """Range of the grey levels below the largest power (`kind: decibel`)."""
    cfar: Annotated[CfarConfig, ActsIf("image.kind", "cfar")] = CfarConfig()
    colour_map: str = DEFAULT_COLOUR_MAP
    """Colour map of PNGs and figures, any Matplotlib name; dataset.h5 holds grey levels."""
    doppler_limits_mps: Annotated[
        tuple[Real, Real] | None,
        require(lambda value: value[0] < value[1], "should be [low, high] with low < high"),
        _SPECTRA,
    ] = None
    """Speeds [low, high] that Doppler maps show, approaching positive; null is all."""

    @field_validator("colour_map")
    @classmethod
    def _known(cls, value: str) -> str:
        if value != DEFAULT_COLOUR_MAP:  # Matplotlib is slow to import
            from matplotlib import colormaps

            if value not in colormaps:
                hint = did_you_mean(value, colormaps, "viridis, gray, turbo, jet are some")
                raise value_error(f"should be a Matplotlib colour map; {hint}")
        return value


Share = Annotated[float, Field(ge=0, le=1, strict=True)]


class SplitConfig(Section):
    """Shares of the three parts, of the samples of each class or of the persons."""

    by: Literal["sample", "subject"] = "sample"
    """Whether samples of each class are split, or persons."""
    train: Share = 0.8
    """Share to train on."""
    validation: Share = 0.2
    """Share to choose the best epoch by."""
    test: Share = 0.0
    """Share that training never sees."""
    subjects: Annotated[int, Field(ge=1, strict=True)] | None = None
    """Number of persons, who each perform every activity, with `by: subject`."""

    @model_validator(mode="after")
    def _whole(self) -> "SplitConfig":
        total = self.train + self.validation + self.test
        if abs(total - 1) > 1e-9:
            raise value_error(
                f"should have train + validation + test = 1 (they add up to {total:g})"
            )
        if (self.by == "subject") != (self.subjects is not None):
            raise value_error("should have 'subjects: n' with 'by: subject', and only with it")
        return self


MAX_TOLERANCE_DB = -6.0


_DIRECT = ActsIf("engine.kind", "direct")


class EngineConfig(Section):
    """`cube` is the exact float64 reference; `direct` the closed form, within a tolerance.

    The tolerance is the relative L2 error (dB) of the noiseless slow-time signal after the
    canceller against the cube, measured in every scene. Where `direct` does not reach it, the scene
    is refused, or computed by the cube (`fallback: cube`). `motion_in_chirp` lets the paths of the
    cube go on moving during a chirp.
    """

    kind: Literal["direct", "cube"] = "direct"
    """Echo engine: the closed form within the tolerance, or the exact reference."""
    tolerance_db: Annotated[
        float, Field(ge=-400, le=MAX_TOLERANCE_DB, strict=True), _DIRECT, _NO_IMPULSE
    ] = -80.0
    """Largest relative L2 error of the noiseless signal after the canceller, measured in every
    scene."""
    fallback: Annotated[Literal["refuse", "cube"], _DIRECT, _NO_IMPULSE] = "refuse"
    """What to do with a scene in which `direct` misses the tolerance."""
    precision: Annotated[Literal["auto", "double"], _DIRECT] = "auto"
    """Arithmetic of the direct engine: single where the tolerance allows it, or float64 always."""
    motion_in_chirp: Flag = False
    """Whether paths go on moving during a chirp, with `kind: cube`."""


Level = Annotated[int, Field(ge=0, le=9, strict=True)]
Name = Annotated[str, Field(pattern=r"^[A-Za-z_][A-Za-z0-9_]{0,62}$")]


class OutputConfig(Section):
    """What is written of every sample, and how hard it is compressed: 0 none, 1 fast, 9 small."""

    png: Flag = True
    """Whether a tree of images is written beside dataset.h5."""
    column_labels: Flag = False
    """Whether the movement at the time of each column of a map is stored."""
    png_level: Level = 1
    """Compression of PNGs, 0 to 9."""
    hdf5_level: Level = 1
    """Compression of dataset.h5, 0 to 9."""
    power: Literal["float16"] | None = None
    """Powers behind the images: float16 stores the decibels of every map, not clipped."""
    slow_time: Flag = False
    """Whether the complex slow-time signal is stored."""
    products: tuple[Name, ...] = ()
    """Further products that are stored as arrays, a user's own too (`radhar_cli.extensions`)."""
    license: Annotated[str, Field(pattern=r"^[a-z0-9][a-z0-9.+-]{0,60}$")] | None = None
    """Licence in the data card, as the Hugging Face Hub calls it: cc-by-4.0, mit."""


MAP_NAMES = (
    "rtm",
    *(
        f"{kind}{suffix}"
        for kind in ("stft", "fsst")
        for suffix in ("", "_denoised", "_compensated", "_compensated_denoised")
    ),
)


# Maps of a board, frame by frame: data sets hold them as arrays, and sheets of frames as images.
MIN_LOOPS = 4  # of a frame: of 2 or fewer, a Hann window keeps one
FRAME_MAPS = ("range_doppler", "range_azimuth", "range_elevation", "points")
# What comes with the points, and with any of these maps.
OF_POINTS = ("points", "points_start", "points_person")
OF_FRAMES = ("skeleton", "skeleton_velocity")


def _known_map(name: str) -> str:
    if name not in (*MAP_NAMES, *FRAME_MAPS) and not is_known(name):
        names = (*MAP_NAMES, *FRAME_MAPS, *(product.name for product in own_products()))
        right = " or ".join(filter(None, (", ".join(map(repr, names[:-1])), repr(names[-1]))))
        raise value_error(f"should be {right}")
    return name


MapName = Annotated[str, AfterValidator(_known_map)]


MAX_WINDOWS = 1_000_000
SLUG = r"[a-z][a-z0-9_]{0,62}"


class RecordedPart(Section):
    """Part of a recording in which one person does one thing.

    The file is named from the manifest's folder, or below.
    """

    file: Annotated[str, Field(max_length=500)]
    """Path of the recording, from the manifest's folder on."""
    label: Annotated[str, Field(pattern=f"^{SLUG}$")]
    """Class of what the person does."""
    person: Annotated[str, Field(max_length=100)] | None = None
    """Name or number of the person, where it is known."""
    start_s: Annotated[float, Field(ge=0, le=1e7, strict=True)]
    """When the part begins."""
    stop_s: Annotated[float, Field(ge=0, le=1e7, strict=True)]
    """When the part ends."""

    @field_validator("file")
    @classmethod
    def _below(cls, value: str) -> str:
        place = PurePosixPath(value)
        if place.is_absolute() or ".." in place.parts or "\\" in value or not place.name:
            raise value_error("should be a path below the manifest's folder")
        return value


class RecordingsConfig(Section):
    """A data set of measured data: windows of recordings instead of scenes."""

    window_s: Annotated[float, Field(gt=0, le=1e6, strict=True)] = 4.0
    """Duration of a sample."""
    hop_s: Annotated[float, Field(gt=0, le=1e6, strict=True)] = 4.0
    """Time from the start of a sample to the start of the next."""
    receiver: Annotated[int, Field(ge=0, le=2**16, strict=True)] | None = None
    """Number of the receiver that maps are made of; null is the sum of all receivers' powers."""
    parts: Annotated[tuple[RecordedPart, ...], Field(max_length=10_000)] = ()
    """Parts of recordings, filled in from the manifest, in its order."""
    sha256: dict[str, str] = {}
    """SHA-256 of each file, filled in; the data set's bytes depend on it."""
    rows: tuple[float, float] | None = None
    """Lowest and highest edge of images that exist already, Hz (m of a range-time map)."""
    packed: Flag = False
    """Whether the columns of masks are bits."""

    @model_validator(mode="after")
    def _bounded(self) -> "RecordingsConfig":
        if (total := sum(map(self.count, self.parts))) > MAX_WINDOWS:
            raise value_error(f"should have at most {MAX_WINDOWS} windows; hop_s makes {total}")
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


class OneOf(Section):
    """``{choice: [walking, punching]}``: one of them, equally likely."""

    choice: Annotated[tuple[str, ...], Field(min_length=1, max_length=200)]


def _name_or_choice(value: object) -> object:
    names: Any = value.get("choice") if isinstance(value, dict) and len(value) == 1 else None
    listed = isinstance(names, (list, tuple)) and all(isinstance(one, str) for one in names)
    if isinstance(value, (str, OneOf)) or (listed and names):
        return value
    raise value_error("should be a slug or label, or {choice: [walking, punching]}")


class PersonConfig(Section):
    """Somebody besides the sample's main person."""

    REPEATS: ClassVar = True  # sections of the top level

    activity: Annotated[str | OneOf, BeforeValidator(_name_or_choice)] = "walking"
    """Activity of the person: a slug or label, or {choice: [...]}."""
    share: Share = 1.0
    """Share of the scenes in which the person is there."""
    subject: SubjectConfig = SubjectConfig()
    motion: MotionConfig = MotionConfig()
    """Motion of the person; its `cross_range_m` is -1.5 to 1.5 unless given."""
    timing: TimingConfig = TimingConfig()
    classes: dict[str, ClassConfig] | None = None
    """Drawn numbers of a class of one's own, filled in for a scene."""

    @property
    def names(self) -> tuple[str, ...]:
        """Names, slugs or labels, of all activities that the person may do."""
        return (self.activity,) if isinstance(self.activity, str) else self.activity.choice


def _own_classes(value: dict[str, ClassConfig]) -> dict[str, ClassConfig]:
    twelve = {activity.slug for activity in ACTIVITIES}
    for slug, one in value.items():
        if not (is_new_slug(slug) or (isinstance(one, FilesConfig) and slug in twelve)):
            raise value_error(f"should have a new name of a-z, 0-9 and _ instead of {slug!r}")
    if sum(len(one.files) for one in value.values() if isinstance(one, FilesConfig)) > MAX_FILES:
        raise value_error(f"should have at most {MAX_FILES} files in all")
    return value


def _maps_in_order(value: tuple[str, ...]) -> tuple[str, ...]:
    if not value:
        raise value_error("should name at least 1 map")
    if len(set(value)) != len(value):
        raise value_error("should name each map once")
    known = (*MAP_NAMES, *FRAME_MAPS)
    own = [name for name in value if name not in known]
    return (*sorted(set(value) - set(own), key=known.index), *own)


# Of data sets of scenes and of recordings; labels are uint8.
Seed = Annotated[int, Field(ge=0, lt=2**63, strict=True)]
Classes = Annotated[dict[str, ClassConfig], Field(max_length=200), AfterValidator(_own_classes)]
Maps = Annotated[tuple[MapName, ...], AfterValidator(_maps_in_order)]


class Config(Section):
    """A data set: what to draw, what to compute, how to store it."""

    seed: Seed = 1
    """Seed of everything that is drawn, 0 to 2^63 - 1."""
    samples_per_class: By[Samples] = 300
    """Number of samples of each class; it may differ: `{per_activity: {default: 300, walking:
    100}}`."""
    classes: Classes = {}
    """Classes of your own: `{name: {sequence: [...]}}` of movements, `{name: [walk/*.bvh]}` of
    files."""
    activities: Literal["all"] | tuple[str, ...] = "all"
    """Classes of the data set: all is the twelve and those of `classes`; or a list of slugs or S1
    to S12, [walking, S12]. A place in it, from 0, is a label of the data set."""
    duration_s: Annotated[
        Positive | None,
        within(1e-9, 1e7, "s"),
        Limits(0, 600),
        ByModel(human=6.0, paper=4.0, file=4.0),
    ] = None
    """Duration of a recording."""
    radar: RadarConfig = RadarConfig()
    subject: SubjectConfig = SubjectConfig()
    motion: MotionConfig = MotionConfig()
    timing: TimingConfig = TimingConfig()
    body: BodyConfig = BodyConfig()
    people: Annotated[tuple[PersonConfig, ...], Field(max_length=7)] = ()
    """Other people in the scene, up to seven of {activity, share, subject, motion, timing}; see
    docs/guide/scenes.md."""
    wall: WallConfig | None = None
    """Wall between radar and people; null is free space."""
    room: RoomConfig = RoomConfig()
    snr_db: Decibel | None = 30.0
    """SNR of a raw sample; null: thermal noise by receiver.noise_figure_db, which a board has by
    default, or none where that is null, too."""
    receiver: ReceiverConfig = ReceiverConfig()
    snr_reference: Annotated[
        Literal["free_space", "received"],
        ActsIf("snr_db", GIVEN),
        ActsIfAny(ActsIf("wall", GIVEN), ActsIf("radar.beam", GIVEN), ActsIf("radar.cfg", GIVEN)),
    ] = "free_space"
    """Echo that snr_db refers to: as it would be without the wall, in the middle of the antennas'
    beam (free_space); or as it is received, less what the wall and the beam take."""
    on_invalid: Annotated[
        Literal["keep", "redraw", "error"] | None,
        ByModel(human="redraw", paper="keep", file="redraw"),
    ] = None
    """What happens to a scene in which a body meets the wall or a scatterer leaves the range
    half-band. A scene in which one comes within 5 cm of an antenna is drawn again with `redraw`,
    and refused otherwise."""
    processing: ProcessingConfig = ProcessingConfig()
    cloud: Annotated[CloudConfig, OnlyMaps("points")] = CloudConfig()
    image: ImageConfig = ImageConfig()
    maps: Maps = ("stft",)
    """Maps of the data set: `rtm`, `stft`, `fsst`, the latter two also with `_denoised`,
    `_compensated`, `_compensated_denoised`; of boards also `range_doppler`, `range_azimuth`,
    `range_elevation`, `points`."""
    split: SplitConfig = SplitConfig()
    engine: EngineConfig = EngineConfig()
    output: OutputConfig = OutputConfig()
    _places: tuple[dict[str, str], dict[str, str]] = ({}, {})  # {key: file:line}, {key: option}

    recordings: RecordingsConfig | None = None
    """How `radhar generate --recordings` cuts recordings into samples: see
    docs/guide/measured.md."""

    @field_validator("activities", mode="before")
    @classmethod
    def _slugs(cls, value: object, info: ValidationInfo) -> object:
        if not isinstance(value, (list, tuple)) or "classes" not in info.data:
            return value  # a mistake in `classes` is reported once
        own = class_activities(info.data["classes"])
        try:
            chosen = [activity_named(str(name), own) for name in value]
        except ValueError as error:
            raise value_error(str(error)) from None
        if not chosen or len({a.slug for a in chosen}) != len(chosen):
            raise value_error("should name at least one activity, each once")
        return tuple(a.slug for a in chosen)

    @property
    def stored(self) -> tuple[str, ...]:
        """Products that a data set holds as arrays: those of `output.products` and of boards."""
        frames = [name for name in self.maps if name in FRAME_MAPS]
        ghosts = ("points_kind",) if self.room.faces is not None else ()
        points = (*OF_POINTS, *ghosts) if "points" in frames else ()
        people = OF_FRAMES if frames else ()
        return tuple(dict.fromkeys((*frames, *points, *people, *self.output.products)))

    @property
    def has_error(self) -> bool:
        """Whether the direct engine makes something whose error is measured."""
        signals = set(self.maps) & set(MAP_NAMES) - {"rtm"}
        return self.engine.kind == "direct" and bool(signals or self.radar.cfg is not None)

    def filled(self) -> "Config":
        """This config, in which what is null and has a default by model takes it.

        So do activities that a number by activity does not name.
        """
        changed = _missing_defaults(self)
        for key, default in of_kind(Config, ByModel):
            name, _, rest = key.rpartition(".")
            holder = getattr(self, name) if name else self
            if holder is not None and getattr(holder, rest) is None:
                changed.setdefault(name, {})[rest] = default.values.get(self.motion.model)
        wall = self.wall
        if wall is not None and wall.layers and "size_m" not in wall.model_fields_set:
            changed.setdefault("wall", {})["size_m"] = (None, *wall.size_m[1:])
        if self.receiver.noise_figure_db is not None and "snr_db" not in self.model_fields_set:
            changed.setdefault("", {})["snr_db"] = None
        if self.radar.cfg is not None:
            _fill_from_cfg(self, changed)
        for key, number in self.radar.chirp_keys.items():
            if key not in self.radar.model_fields_set:
                changed.setdefault("radar", {})[key] = number
        for name, value in changed.pop("", {}).items():
            object.__setattr__(self, name, value)
        for name, values in changed.items():
            object.__setattr__(self, name, _with_defaults(getattr(self, name), values))
        if self.people:
            filled = tuple(self._filled_person(n) for n in range(1, len(self.people) + 1))
            object.__setattr__(self, "people", filled)
        if self.motion.model == "paper" and self.processing.window_s is None:
            window = {"window_s": PAPER_WINDOW * nominal(self.duration_s)}
            object.__setattr__(self, "processing", _with_defaults(self.processing, window))
        return self

    def of_person(self, number: int) -> "Config":
        """Config of one of `people`, 1 the first: with their numbers at the top level."""
        one = self.people[number - 1]
        theirs = {"subject": one.subject, "motion": one.motion, "timing": one.timing, "people": ()}
        classes = self.classes if one.classes is None else one.classes
        return self.model_copy(update={**theirs, "classes": classes})

    def activities_of(self, number: int) -> tuple[Activity, ...]:
        """What one of `people` may do.

        Raises:
            ValueError: there is no such activity.
        """
        own = {one.slug: one for one in self.every_class}
        return tuple(activity_named(name, own) for name in self.people[number - 1].names)

    def _filled_person(self, number: int) -> PersonConfig:
        filled, one = self.of_person(number).filled(), self.people[number - 1]
        motion = filled.motion
        if "cross_range_m" not in one.motion.model_fields_set:
            motion = motion.model_copy(update={"cross_range_m": uniform(-1.5, 1.5)})
        return one.model_copy(update={"motion": motion, "timing": filled.timing})

    @model_validator(mode="after")
    def _consistent(self) -> "Config":
        from radhar_cli.config.checks import problems  # which knows this schema

        mistakes = list(problems(self.filled()))
        if mistakes:
            raise PydanticCustomError("across", "{problems}", {"problems": mistakes})
        return self

    def samples_of(self, activity: Activity) -> int:
        """How many samples of an activity there are."""
        samples: int = for_activity(self.samples_per_class, activity)
        return samples

    @property
    def every_class(self) -> tuple[Activity, ...]:
        """Every class that anybody may show: the chosen ones, whose place here is their label, then
        the others of the twelve and of `classes`, which only `people` do."""
        known = {a.slug: a for a in ACTIVITIES} | class_activities(self.classes)
        return (*({a.slug: a for a in self.chosen_activities} | known).values(),)

    @property
    def chosen_activities(self) -> tuple[Activity, ...]:
        """The activities to build, in the order of `activities`; a place here, from 0, is a label.

        `activities: all` is S1 to S12, then those of `classes`; with `motion.model: file` only the
        latter. Those of `add_activity` have the numbers after these, which name random streams.
        """
        own = class_activities(self.classes)
        if self.activities == "all":
            twelve = {} if self.motion.model == "file" else {a.slug: a for a in ACTIVITIES}
            return (*sorted((twelve | own).values(), key=lambda a: a.number),)
        chosen = [activity_named(slug, own) for slug in self.activities]
        numbers = count(1 + max(a.number for a in (*ACTIVITIES, *own.values())))
        return tuple(a if a.motion is None else replace(a, number=next(numbers)) for a in chosen)

    def depends_on(self, activity: Activity, key: str) -> bool:
        """Whether scenes of an activity depend on the number of this dotted key."""
        value_at = partial(at, self)
        if not all(one.holds(value_at) for one in conditions(Config, key)):
            return False
        if key.startswith("classes."):
            return key.startswith(f"classes.{activity.slug}.")
        uses = _uses().get(key)
        if uses is None or activity.motion is not None:
            return uses is None or key in activity.uses
        names = uses.get(self.motion.model)
        if names is None or self.files_of(activity) is not None:
            return False
        return not names or not names.isdisjoint((activity.label, *activity.movements))

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
        one = self.classes.get(activity.slug)
        return one if isinstance(one, FilesConfig) else None


class MeasuredConfig(Section):
    """A data set of recordings, which `radhar generate --recordings` makes of a `Config`."""

    # What else data sets are asked for: here are no other people, no noise, no further products.
    people: ClassVar[tuple[PersonConfig, ...]] = ()
    snr_db: ClassVar[None] = None
    has_noise: ClassVar[bool] = False
    stored: ClassVar[tuple[str, ...]] = ()
    engine: ClassVar[EngineConfig] = EngineConfig()

    seed: Seed
    classes: Classes
    radar: RadarConfig
    processing: ProcessingConfig
    image: ImageConfig
    maps: Maps
    split: SplitConfig
    output: OutputConfig
    recordings: RecordingsConfig

    @model_validator(mode="after")
    def _consistent(self) -> "MeasuredConfig":
        from radhar_cli.config.checks import measured_problems  # which knows this schema

        if mistakes := list(measured_problems(self)):
            raise PydanticCustomError("across", "{problems}", {"problems": mistakes})
        return self

    @property
    def duration_s(self) -> float:
        """Duration of a window, s."""
        return self.recordings.window_s

    def samples_of(self, activity: Activity) -> int:
        """How many windows of an activity there are."""
        return self.recordings.counts.get(activity.slug, 0)

    @cached_property
    def every_class(self) -> tuple[Activity, ...]:
        """Every class: those that have windows, whose place is their label, then the others."""
        known = {a.slug: a for a in ACTIVITIES} | class_activities(self.classes)
        new = sorted(self.recordings.counts.keys() - known.keys())
        known |= {slug: Activity(len(known) + n, slug) for n, slug in enumerate(new, 1)}
        return tuple(sorted(known.values(), key=lambda one: not self.samples_of(one)))

    @property
    def chosen_activities(self) -> tuple[Activity, ...]:
        """Classes that have windows: of the twelve, of `classes`, then new ones by the alphabet."""
        return tuple(filter(self.samples_of, self.every_class))


AnyConfig: TypeAlias = Config | MeasuredConfig


class ConfigOfRecordings(Config):
    """A config before its recordings are opened: sections are not checked against each other."""


class ProcessedConfig(Config):
    """A config with radar and length of the recording that it processes, and checked for that."""


def _with_defaults(section: S, values: Mapping[str, Any]) -> S:
    """A section with defaults of other keys' making, which do not count as given."""
    filled = section.model_copy(update=dict(values))
    object.__setattr__(filled, "__pydantic_fields_set__", set(section.model_fields_set))
    return filled


def _missing_defaults(c: Config) -> dict[str, dict[str, Any]]:
    """{section: {key: number}} of numbers by activity that have no default: that of the key."""
    by_model, changed = dict(of_kind(Config, ByModel)), dict[str, dict[str, Any]]()
    for name in ("", "motion", "timing"):
        holder: BaseModel = getattr(c, name) if name else c
        for key, field in type(holder).model_fields.items():
            value = getattr(holder, key)
            if not isinstance(value, PerActivity) or DEFAULT in value.per_activity:
                continue
            dotted = f"{name}.{key}" if name else key
            usual = field.get_default(call_default_factory=False)
            if dotted in by_model:
                usual = by_model[dotted].values.get(c.motion.model)
            if isinstance(usual, PerActivity):
                numbers = {**usual.per_activity, **value.per_activity}
            elif usual is not None:
                numbers = {DEFAULT: usual, **value.per_activity}
            else:  # of no use to this model
                numbers = {DEFAULT: next(iter(value.per_activity.values())), **value.per_activity}
            changed.setdefault(name, {})[key] = PerActivity(numbers)
    return changed


def _fill_from_cfg(c: Config, changed: dict[str, dict[str, Any]]) -> None:
    """Note what the .cfg of a board gives, and the defaults of boards, of what was not given."""
    from radhar_cli.errors import CaptureError

    try:
        board = c.radar.header
    except CaptureError as error:
        raise value_error(str(error)) from None
    radar = {
        key: value for key, value in board.numbers.items() if key not in c.radar.model_fields_set
    }
    if "antenna_gain_dbi" not in c.radar.model_fields_set:
        radar["antenna_gain_dbi"] = BOARD_GAIN_DBI
    changed.setdefault("radar", {}).update(radar)
    if "snr_db" not in c.model_fields_set:
        changed.setdefault("", {})["snr_db"] = None
    if "noise_figure_db" not in c.receiver.model_fields_set:
        changed.setdefault("receiver", {})["noise_figure_db"] = BOARD_NOISE_FIGURE_DB
    if "clutter" not in c.processing.model_fields_set:
        clutter = "mean" if board.detection.remove_mean else "none"
        changed.setdefault("processing", {})["clutter"] = clutter
    if "range_sum" not in c.processing.model_fields_set:
        changed.setdefault("processing", {})["range_sum"] = "gated"


@cache
def _uses() -> dict[str, dict[str, frozenset[str]]]:
    """{dotted key: {model: who uses it}} of the keys that not everybody uses."""
    found = dict[str, dict[str, frozenset[str]]]()
    for key, one in of_kind(Config, People):
        names = one.names.replace("exercises", " ".join(EXERCISES)).split()
        found.setdefault(key, {})["human"] = frozenset(names)
    for key, other in of_kind(Config, Paper):
        found.setdefault(key, {})["paper"] = frozenset(other.names.split())
    return found


def class_activities(classes: Mapping[str, ClassConfig]) -> dict[str, Activity]:
    """{slug: activity} of a config's classes: S13 and so on, or one of the twelve from files."""
    activities: dict[str, Activity] = {}
    twelve = {activity.slug: activity for activity in ACTIVITIES}
    number = len(ACTIVITIES)
    for slug, one in classes.items():
        if slug in twelve:
            activities[slug] = replace(twelve[slug], movements=())
            continue
        number += 1
        movements = one.sequence if isinstance(one, SequenceConfig) else ()
        movements += tuple(other for name in movements if (other := MOVEMENTS[name].like))
        activities[slug] = Activity(number, slug, movements)
    return activities


def possible_maps(config: Config) -> tuple[str, ...]:
    """The maps that the radar of a config makes, and the cube of a board.

    Without those of a board whose frames are shorter than the filter of the denoised maps.
    """
    names: tuple[str, ...] = (*MAP_NAMES, *FRAME_MAPS, "cube")
    if config.radar.cfg is not None and config.processing.savgol.frame > config.radar.header.loops:
        names = tuple(name for name in names if "denoised" not in name)
    return tuple(name for name in names if why_no_map(config, name) is None)


def why_no_map(config: "AnyConfig", name: str) -> str | None:
    """Why the radar of a config cannot make a map of that name, or the cube; None if it can."""
    radar, gated = config.radar, config.processing.range_sum == "gated"
    if name in (*FRAME_MAPS, "cube"):
        if radar.cfg is None:
            return f"{name} is of the frames of a board (radar.cfg, docs/guide/boards.md)"
        return _why_no_frames(config, name)
    if name not in MAP_NAMES:  # of a user's own
        return None
    if radar.cfg is not None and name != "rtm" and radar.header.loops < MIN_WINDOW:
        loops = f"{radar.header.loops} loop{'s' * (radar.header.loops > 1)}"
        return f"the {loops} of a frame (radar.cfg, frameCfg) are fewer than {MIN_WINDOW} pulses"
    if radar.waveform == "cw" and name == "rtm":
        return "radar.waveform: cw has no range"
    if radar.waveform == "cw" and radar.output == "real" and "compensated" in name:
        return "radar.output: real has no sign of the Doppler"
    if radar.waveform == "impulse" and name not in ("rtm", "stft"):
        return "radar.waveform: impulse takes real samples"
    if radar.waveform == "impulse" and name == "stft" and not gated:
        return (
            "the real samples of radar.waveform: impulse have no mean over range; "
            "stft needs processing.range_sum: gated"
        )
    if gated and name.startswith("fsst"):
        cause = "processing.range_sum: gated"
        if radar.cfg is not None and "range_sum" not in config.processing.model_fields_set:
            cause += ", the default of boards,"
        return f"{cause} adds up powers of bins, and the fsst moves coefficients by their phase"
    return None


def _why_no_frames(config: "AnyConfig", name: str) -> str | None:
    """Why a board cannot make the cube or a map of its frames; None if it can.

    A board that lacks elements which its .cfg names is refused elsewhere.
    """
    header, places = config.radar.header, _virtual_places(config.radar)
    if name in ("range_doppler", "points") and header.loops < MIN_LOOPS:
        loops = f"{header.loops} loop{'s' * (header.loops > 1)}"
        return f"the {loops} of a frame (radar.cfg, frameCfg) show no Doppler; {MIN_LOOPS} do"
    if not places:
        return None
    for axis, (of, line) in enumerate((("range_azimuth", "column"), ("range_elevation", "row"))):
        if name == of and len({round(place[axis], 6) for place in places}) == 1:
            return f"all elements of the array lie in one {line}"
    if name == "points" and isinstance(config, Config):
        return _why_no_points(config, places)
    return None


def _why_no_points(config: Config, places: Places) -> str | None:
    """Why the elements of a board do not tell where points are; None if they do.

    The firmware's chain takes the elements of a row for neighbours. The other knows their places,
    but takes high sidelobes of a sparse row for targets of their own.
    """
    row = [places[v][0] for v in longest_rows(places, 0)[0]]
    apart, chain = [after - before for before, after in pairwise(row)], config.cloud.chain
    if not apart:
        return None
    neighbours = min(apart) >= 0.8 and max(apart) <= 1.2
    if neighbours or (chain == "best" and min(apart) <= 1.2 and sidelobe(row) <= MAX_SIDELOBE):
        return None
    at = ", ".join(f"{place:g}" for place in row)
    return (
        f"the longest row of the array, with elements at {at} half wavelengths, does not tell "
        f"azimuths apart for the points of cloud.chain: {chain}"
    )


def _virtual_places(radar: RadarConfig) -> Places:
    """Places of a board's virtual elements, half wavelengths; none where elements are missing."""
    array, board = radar.elements, radar.header
    if array is None:
        return ()
    if max(board.order) >= len(array.tx) or max(board.receivers) >= len(array.rx):
        return ()
    scale = 1.0
    if radar.half_wavelength_m is not None:
        centre = board.carrier_hz + board.slope_hz * (board.samples - 1) / (2 * board.adc_rate_hz)
        scale = radar.half_wavelength_m * 2 * centre / SPEED_OF_LIGHT
    return tuple(
        (scale * (array.tx[t][0] + array.rx[r][0]), scale * (array.tx[t][1] + array.rx[r][1]))
        for t in board.order
        for r in board.receivers
    )
