"""The radar: eight kinds, each with the keys that it alone has.

`radar:` is the one that `cfg`, `frame` and `waveform` tell. A kind answers for itself: what its
pulses are, which maps it makes, and why not the others.
"""

from itertools import pairwise
from math import radians
from typing import (
    TYPE_CHECKING,
    Annotated,
    Any,
    ClassVar,
    Generic,
    Literal,
    Protocol,
    Self,
    TypeAlias,
    Union,
    get_args,
)

from pydantic import (
    BeforeValidator,
    ConfigDict,
    Discriminator,
    Field,
    Tag,
    field_validator,
    model_validator,
)

from radhar_cli.config.maps import MIN_LOOPS
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.numerics.rounding import half_up
from radhar_cli.processing.angle_time import ANGLE_TIME_KINDS
from radhar_cli.processing.frame_maps import FRAME_MAP_KINDS, RANGE
from radhar_cli.processing.map_kind import MapKind, Transform
from radhar_cli.radar.board import (
    DEVICES,
    EVEN,
    MAX_SIDELOBE,
    NOISE_FIGURE_DB,
    Array,
    Places,
    axis_after_roll,
    device_name,
    longest_rows,
    sidelobe,
)
from radhar_cli.radar.detection import Chain, Firmware
from radhar_cli.radar.fmcw import Waveform
from radhar_cli.radar.frame_timing import FrameTiming, Sampling
from radhar_cli.radar.impulse import Impulse, impulse
from radhar_cli.schema.annotations import GIVEN, ByModel, NeedsAnyKey, NeedsKey
from radhar_cli.schema.number import (
    ANGLE,
    DECIBEL,
    NOT_NEGATIVE,
    POSITIVE,
    Number,
    Real,
    support,
    value_error,
    within,
)
from radhar_cli.schema.section import Filled, Flag, N, Section, VectorOf, default_draw

if TYPE_CHECKING:
    from radhar_cli.readers.ti.ti_cfg import BoardHeader

BOOST = "IWR1443BOOST"
NO_RANGE = "radar.waveform: cw has no range"
MAX_ELEMENTS = 32  # transmitters, or receivers, of a radar with frames
MIN_WINDOW = 8  # pulses of the window of a Doppler-time map
Place: TypeAlias = tuple[Real, Real]


def _refuse_law(value: object) -> object:
    """Refuse a law of draws where frames, bins and axes of all samples follow from a number."""
    if isinstance(value, dict):
        raise value_error(
            "should be a number: frames, bins and axes of all samples follow from it, and do not "
            "differ within a data set; a config for each value makes one of each"
        )
    return value


FIXED = BeforeValidator(_refuse_law)
HalfPower = Annotated[float, Field(ge=1, le=1000, strict=True)]


class ArrayConfig(Section):
    """Antenna elements of a board, (left, up) in half wavelengths, looking out of the radar."""

    tx: Annotated[tuple[Place, ...], Field(min_length=1, max_length=4)] = DEVICES[BOOST].array.tx
    """Places of the transmitters, in the order of the board's TX 1, 2, 3."""
    rx: Annotated[tuple[Place, ...], Field(min_length=1, max_length=4)] = DEVICES[BOOST].array.rx
    """Places of the receivers, in the order of the board's RX 1 to 4."""


class BeamConfig(Section, Generic[N]):
    """A beam of -min(12 (az/azimuth_deg)^2 + 12 (el/elevation_deg)^2, most_db) dB, one way."""

    azimuth_deg: Annotated[N, POSITIVE, within(1, 1000, "degree")] = default_draw(70.0)
    """Full width of the beam in azimuth at -3 dB."""
    elevation_deg: Annotated[N, POSITIVE, within(1, 1000, "degree")] = default_draw(30.0)
    """Full width of the beam in elevation at -3 dB."""
    pan_deg: Annotated[N, ANGLE] = default_draw(0.0)
    """Angle of the boresight from the x axis, positive to the left."""
    tilt_deg: Annotated[N, ANGLE] = default_draw(0.0)
    """Angle of the boresight below the horizontal, positive down."""
    most_db: Annotated[N, NOT_NEGATIVE, within(0, 120, "dB")] = default_draw(30.0)
    """Largest loss: no direction gets less than this below the gain of the boresight."""


class PulseNumbers(Protocol):
    """Numbers of the pulses of any radar of a scene.

    Attributes:
        carrier_hz: Carrier frequency at the start of a pulse.
        bandwidth_hz: Bandwidth that a pulse covers.
        prf_hz: Pulse repetition frequency.
        adc_rate_hz: Sampling rate within a pulse.
        chirp_s: Duration of a pulse.
    """

    @property
    def carrier_hz(self) -> float: ...
    @property
    def bandwidth_hz(self) -> float: ...
    @property
    def prf_hz(self) -> float: ...
    @property
    def adc_rate_hz(self) -> float: ...
    @property
    def chirp_s(self) -> float: ...


class AnyRadar(Section):
    """Questions that every kind of radar answers by its own keys."""

    kind: ClassVar[str]
    named: ClassVar[str]  # as messages name it: the key, and value, that tell the kind
    has_range: ClassVar[bool] = True  # whether pulses have a band, whose echoes tell ranges
    sweeps: ClassVar[bool] = True  # whether pulses sweep their band, and a beat is sampled

    def make_waveform(
        self: PulseNumbers, seconds: float, fft_length: int | None, centred: bool
    ) -> Waveform:
        """Make the waveform of the pulses of a recording of so many seconds.

        Args:
            seconds: Duration of the recording.
            fft_length: Length of the transform over a chirp; None is the number of samples.
            centred: Whether ranges refer to the middle of the chirp.
        """
        return Waveform(
            fc=self.carrier_hz,
            bandwidth=self.bandwidth_hz,
            chirp=self.chirp_s,
            adc_rate=self.adc_rate_hz,
            prf=self.prf_hz,
            duration=seconds,
            fft_length=fft_length,
            centred=centred,
        )

    @property
    def frames_apart(self) -> bool:
        """Whether the radar pauses between frames."""
        return False

    @property
    def place_keys(self) -> tuple[str, ...]:
        """Keys of the places where the radar's antennas stand."""
        return ("tx_m", "rx_m")

    def why_no_map(self, kind: MapKind, gating: str | None) -> str | None:
        """Return why the radar does not make a map of a signal; None if it makes it.

        Args:
            gating: key that makes Doppler maps those of a gate, in words; None where they show the
                coherent sum over range.
        """
        if gating and kind.transform is Transform.FSST:
            return (
                f"{gating} adds up powers of bins, and the fsst moves coefficients by their phase"
            )
        return None

    def why_no_frames(self, name: str) -> str | None:
        """Return why the radar makes no map of frames, nor the cube; None if it does."""
        return (
            f"{name} is of the frames of a board (radar.cfg, docs/guide/boards.md) or of an FMCW "
            "radar with radar.frame, such as 'frame: {chirps: 64}'"
        )


class _Pulses(AnyRadar, Generic[N]):
    """Keys of radars that send pulse after pulse."""

    carrier_hz: Annotated[N, POSITIVE, within(1e6, 1e13, "Hz")] = default_draw(77e9)
    """Carrier frequency: at the start of a chirp, of the first step, at the lower end of an
    impulse's band (-10 dB)."""
    prf_hz: Annotated[
        Filled[N], POSITIVE, within(1e-3, 1e7, "Hz"), ByModel(human=1e4, paper=5e3, file=5e3)
    ] = default_draw(None)
    """Pulse repetition frequency, chirps per second; 10 kHz is +-9.7 m/s at 77 GHz, and a kick's
    foot reaches 7 to 9."""


class _Band(_Pulses[N], Generic[N]):
    """Keys of pulses that have a band."""

    bandwidth_hz: Annotated[
        Filled[N],
        POSITIVE,
        within(1e3, 1e12, "Hz"),
        ByModel(human=1e9, paper=4e9, file=4e9),
    ] = default_draw(None)
    """Bandwidth B that a pulse covers; the range step is c/2B. With the default chirp, ranges up to
    30 m are seen with 1 GHz, up to 7.5 m with 4 GHz."""


class _AntennaPair(AnyRadar, Generic[N]):
    """Keys of a transmitting and a receiving antenna."""

    tx_m: VectorOf[N] = default_draw((0.4, -0.1, 1.5))
    """Place of the transmitter: range, cross-range, height."""
    rx_m: VectorOf[N] = default_draw((0.4, 0.1, 1.5))
    """Place of the receiver: range, cross-range, height."""
    antenna_gain_dbi: Annotated[N, DECIBEL, within(-150, 150, "dBi")] = default_draw(6.0)
    """Gain of each antenna at its boresight."""
    antenna_isolation_db: Annotated[N, DECIBEL] = default_draw(10.0)
    """Isolation between transmitter and receiver; raw recordings have the leakage, and maps where
    `processing.clutter` leaves static echoes."""
    beam: BeamConfig[N] | None = None
    """Beam of both antennas; null radiates evenly."""


class _Emission(AnyRadar, Generic[N]):
    """Keys of the field that a radar sends out."""

    polarisation: Annotated[
        Literal["vertical", "horizontal"],
        NeedsAnyKey(NeedsKey("room.faces", GIVEN), NeedsKey("wall.echoes", "exact")),
    ] = "vertical"
    """Polarisation of the antennas' field, for room.faces and wall.echoes; horizontal is along
    y."""
    transmit_power_dbm: Annotated[
        N,
        DECIBEL,
        NeedsAnyKey(NeedsKey("snr_db", None), NeedsKey("image.reference.dbm", GIVEN)),
        NeedsAnyKey(
            NeedsKey("receiver.noise_figure_db", GIVEN), NeedsKey("image.reference.dbm", GIVEN)
        ),
    ] = default_draw(12.0)
    """Transmitted power, which thermal noise (receiver.noise_figure_db) is compared with, and by
    which image.reference has its dBm."""


class SweptPulses(_Band[N], Generic[N]):
    """Keys of pulses that sweep their band, whose beat is sampled."""

    residual_video_phase: Flag = False
    """Whether the beat keeps the residual video phase, the term pi K tau^2."""


class FmcwRadar(_Emission[N], _AntennaPair[N], SweptPulses[N], Generic[N]):
    """A radar that sends chirps: antennas, gains, and a linear sweep sampled by an ADC."""

    kind: ClassVar[str] = "fmcw"
    named: ClassVar[str] = "radar.waveform: fmcw"

    waveform: Literal["fmcw"] = "fmcw"
    """Kind of the radar: fmcw sends chirps; sfcw sweeps of steps, sampled once each; cw takes one
    sample a pulse, at carrier_hz; impulse sends Gaussian pulses from carrier_hz to carrier_hz +
    bandwidth_hz (-10 dB). A TI board has `cfg` instead."""
    adc_rate_hz: Annotated[N, POSITIVE, within(1e-3, 1e13, "Hz")] = default_draw(10e6)
    """Sampling rate of the ADC within a chirp."""
    chirp_s: Annotated[N, POSITIVE, within(1e-12, 1e4, "s")] = default_draw(40e-6)
    """Duration of a chirp, at most 1/prf_hz."""


def _require_waveform(schema: dict[str, Any]) -> None:
    """Ask for `waveform` in the JSON schema of a radar that is not the default one."""
    schema["required"] = [*schema.get("required", ()), "waveform"]


class Steps(AnyRadar, Generic[N]):
    """Keys of sweeps that are steps of frequency."""

    waveform: Literal["sfcw"] = "sfcw"
    """Kind of the radar."""
    steps: Annotated[int, Field(ge=2, le=2**20, strict=True), FIXED]
    """Number of frequencies of a sweep, carrier_hz + n bandwidth_hz/steps."""
    dwell_s: Annotated[float, Field(gt=0, le=1e3, strict=True), FIXED]
    """Time that the radar stays on each frequency."""

    @property
    def adc_rate_hz(self) -> float:
        """Samples per second of a sweep."""
        return 1 / self.dwell_s

    @property
    def chirp_s(self) -> float:
        """Duration of a sweep, s."""
        return self.steps * self.dwell_s


class SfcwRadar(Steps[N], _Emission[N], _AntennaPair[N], SweptPulses[N], Generic[N]):
    """A radar that steps through frequencies and takes a sample at each."""

    kind: ClassVar[str] = "sfcw"
    named: ClassVar[str] = "radar.waveform: sfcw"
    model_config = ConfigDict(json_schema_extra=_require_waveform)


class ContinuousWave(AnyRadar):
    """Keys of radars that send one frequency: pulses of a sample, whose band changes nothing."""

    has_range: ClassVar[bool] = False
    sweeps: ClassVar[bool] = False
    adc_rate_hz: ClassVar[float] = 1e9
    chirp_s: ClassVar[float] = 1e-9
    bandwidth_hz: ClassVar[float] = 1e3

    waveform: Literal["cw"] = "cw"
    """Kind of the radar."""

    def why_no_map(self, kind: MapKind, gating: str | None) -> str | None:
        """Return why the radar, which has no range, makes no map; None if it does."""
        return NO_RANGE if kind.transform is Transform.RTM else super().why_no_map(kind, gating)


class CwRadar(ContinuousWave, _Emission[N], _AntennaPair[N], _Pulses[N], Generic[N]):
    """A radar that sends one frequency and takes one sample a pulse; it has no range."""

    kind: ClassVar[str] = "cw"
    named: ClassVar[str] = "radar.waveform: cw"
    model_config = ConfigDict(json_schema_extra=_require_waveform)

    output: Literal["iq", "real"] = "iq"
    """Output of the mixer: iq, or real for the in-phase channel alone, whose Doppler is
    symmetric."""

    def why_no_map(self, kind: MapKind, gating: str | None) -> str | None:
        """Return why the radar makes no map (real samples lack the sign); None if it does."""
        if self.output == "real" and kind.treatment.compensated:
            return "radar.output: real has no sign of the Doppler"
        return super().why_no_map(kind, gating)


class ImpulseRadar(_Emission[N], _AntennaPair[N], _Band[N], Generic[N]):
    """A radar that sends Gaussian pulses; its receiver samples range profiles."""

    kind: ClassVar[str] = "impulse"
    named: ClassVar[str] = "radar.waveform: impulse"
    sweeps: ClassVar[bool] = False
    model_config = ConfigDict(json_schema_extra=_require_waveform)

    waveform: Literal["impulse"] = "impulse"
    """Kind of the radar."""
    output: Literal["rf", "iq"] = "rf"
    """Samples of a profile: rf are real, of the pulse as it comes; iq are complex, as chips give
    them that mix it down by the middle of the band."""
    profile_m: tuple[Real, Real]
    """Range axis [from, to] of the profiles, m."""
    profile_samples: Annotated[int, Field(ge=2, le=2**16, strict=True)] = 256
    """Number of range samples in a profile."""

    # A pulse of one sample, whose middle is that of the band.
    adc_rate_hz: ClassVar[float] = 1e9
    chirp_s: ClassVar[float] = 2e-9

    @field_validator("profile_m")
    @classmethod
    def _require_rising_ranges(cls, value: tuple[float, float]) -> tuple[float, float]:
        if not 0 <= value[0] < value[1]:
            raise value_error("should be [from, to], 0 <= from < to, with radar.waveform: impulse")
        return value

    def make_waveform(
        self: "ImpulseRadar[float]", seconds: float, fft_length: int | None, centred: bool
    ) -> Impulse:
        """Make the waveform of the pulses, which have no chirp to transform or refer to."""
        return impulse(
            fc=self.carrier_hz,
            bandwidth=self.bandwidth_hz,
            prf=self.prf_hz,
            duration=seconds,
            profile=self.profile_m,
            samples=self.profile_samples,
            is_iq=self.output == "iq",
        )

    def why_no_map(self, kind: MapKind, gating: str | None) -> str | None:
        """Return why the radar does not make a map of its samples; None if it does."""
        if self.output == "iq":
            return super().why_no_map(kind, gating)
        if kind not in (MapKind.parse("rtm"), MapKind.parse("stft")):
            return f"{self.named} takes real samples; radar.output: iq has complex ones"
        if kind.is_doppler_time and not gating:
            return (
                f"the real samples of {self.named} have no mean over range; stft needs "
                "processing.range_sum: gated, or radar.output: iq"
            )
        return super().why_no_map(kind, gating)


class ArrayRadar(_Emission[N], Generic[N]):
    """A radar that sends frames of chirps and receives them by an array: what all of them are."""

    waveform: Literal["fmcw", "sfcw", "cw"] = "fmcw"
    """Waveform of a radar with frames: fmcw sends chirps, sfcw sweeps of steps, cw one
    frequency."""
    position_m: VectorOf[N] = default_draw((0.0, 0.0, 1.0))
    """Position of the array: range, cross-range, height."""
    yaw_deg: Annotated[N, ANGLE] = default_draw(0.0)
    """Angle of the boresight from the x axis, positive to the left."""
    tilt_deg: Annotated[N, ANGLE] = default_draw(0.0)
    """Angle of the boresight below the horizontal, positive down."""
    roll_deg: Annotated[N, ANGLE] = default_draw(0.0)
    """Angle by which the array is turned about its boresight, positive where its left side, looking
    out of it, goes up."""
    antenna_gain_dbi: Annotated[N, DECIBEL, within(-150, 150, "dBi")] = default_draw(9.0)
    """Gain of each antenna at its boresight."""
    half_power_deg: tuple[HalfPower, HalfPower] | None = None
    """Half-power half-widths of an element in azimuth and elevation; null is the device's, and none
    of an array by hand."""
    half_wavelength_m: Annotated[float, Field(gt=0, le=1, strict=True), FIXED] | None = None
    """Unit of an array's places; null is c/(2 f_c), where f_c is the middle of the sampled band."""

    chirps_key: ClassVar[str]  # as messages name what says how many loops a frame has

    @property
    def timing(self) -> FrameTiming:
        """Chirps, frames and samples of the radar."""
        raise NotImplementedError

    @property
    def firmware(self) -> Firmware | None:
        """Chain of TI's firmware whose commands the radar's file has; None without a file."""
        return None

    @property
    def removes_mean(self) -> bool:
        """Whether the mean of each frame is removed unless the config says otherwise."""
        return True

    @property
    def stated_pose(self) -> dict[str, Any]:
        """Place and angles by the radar's file, {key of the radar: number}; {} without a file."""
        return {}

    @property
    def elements(self) -> Array | None:
        """Antenna elements of the radar; None where nothing says them."""
        raise NotImplementedError

    @property
    def other_subframes(self) -> dict[str, int]:
        """Numbers of the subframes but the chosen one, {end of names: number}."""
        return {}

    @property
    def ends_in_files(self) -> dict[str, str]:
        """Ends of the names of what is stored of each subframe, {end of products: end in files}."""
        return {"": ""}

    @property
    def first_subframe(self) -> Self:
        """This radar with subframe 0 chosen."""
        return self

    @property
    def frames_apart(self) -> bool:
        """Whether the radar pauses between its frames."""
        return self.timing.frames_apart

    @property
    def place_keys(self) -> tuple[str, ...]:
        """Key of the place of the array."""
        return ("position_m",)

    @property
    def usual_noise_figure_db(self) -> float:
        """Noise figure of a radar whose elements stand in the config, dB."""
        return NOISE_FIGURE_DB

    @property
    def virtual_places(self) -> Places:
        """Places of the virtual elements, half wavelengths; none where elements are missing."""
        array, timing = self.elements, self.timing
        if array is None:
            return ()
        if max(timing.order) >= len(array.tx) or max(timing.receivers) >= len(array.rx):
            return ()
        scale = 1.0
        if self.half_wavelength_m is not None:
            scale = self.half_wavelength_m * 2 * timing.centre_hz / SPEED_OF_LIGHT
        return tuple(
            (scale * (array.tx[t][0] + array.rx[r][0]), scale * (array.tx[t][1] + array.rx[r][1]))
            for t in timing.order
            for r in timing.receivers
        )

    def why_no_map(self, kind: MapKind, gating: str | None) -> str | None:
        """Return why the radar makes no map (a frame may be too short); None if it does."""
        if kind.is_doppler_time and self.timing.loops < MIN_WINDOW:
            return (
                f"the {self._loops} of a frame ({self.chirps_key}) are fewer than "
                f"{MIN_WINDOW} pulses"
            )
        return super().why_no_map(kind, gating)

    def why_no_frames(self, name: str) -> str | None:
        """Return why the radar does not make a map of its frames; None if it does.

        A board that lacks elements which its .cfg names is refused elsewhere.
        """
        kind = FRAME_MAP_KINDS.get(name)  # none of the points
        shows_doppler = name == "points" or (kind is not None and kind.shows_doppler)
        if shows_doppler and 1 < self.timing.loops < MIN_LOOPS:  # a window keeps a loop of one
            return (
                f"the {self._loops} of a frame ({self.chirps_key}) show no Doppler; "
                f"{MIN_LOOPS} do, or 1, whose Doppler is 0"
            )
        of_angles = ANGLE_TIME_KINDS.get(name, kind)
        axis = None if of_angles is None else of_angles.array_axis
        if axis is None:
            return None
        roll: Number = self.roll_deg  # type: ignore[assignment]  # of a config or a scene
        for side in {axis_after_roll(axis, radians(end)) for end in support(roll)}:
            if len({round(place[side], 6) for place in self.virtual_places}) == 1:
                rolled = " of the board that is rolled (radar.roll_deg)" if side != axis else ""
                return f"all elements of the array lie in one {('column', 'row')[side]}{rolled}"
        return None

    @property
    def likely_chain(self) -> Chain:
        """The firmware's chain whose commands the file has, unless elements or masks do not fit."""
        if self.firmware is None or self.why_no_points(self.firmware) is not None:
            return "best"
        return self.firmware

    def why_no_points(self, chain: Chain) -> str | None:
        """Return why a chain does not find points with the radar; None if it does."""
        return self._why_no_azimuths(chain)

    def _why_no_azimuths(self, chain: Chain) -> str | None:
        """Return why the array does not tell azimuths apart; None if it does.

        Firmware takes the elements of a row for neighbours, but for people tracking, whose .cfg has
        their places. `best` knows them, but takes high sidelobes of a sparse row for targets.
        """
        if "people_tracking" in (chain, self.firmware if chain == "board" else None):
            return None
        places = self.virtual_places
        row = [places[v][0] for v in longest_rows(places, 0)[0]] if places else []
        spacings = [right - left for left, right in pairwise(row)]
        if not spacings:
            return None
        neighbours = min(spacings) >= 0.8 and max(spacings) <= 1.2
        unambiguous = min(spacings) <= 1.2 and sidelobe(row) <= MAX_SIDELOBE
        if neighbours or (chain == "best" and unambiguous):
            return None
        listed = ", ".join(f"{place:g}" for place in row)
        return (
            f"the longest row of the array, with elements at {listed} half wavelengths, does not "
            f"tell azimuths apart for the points of cloud.chain: {chain}"
        )

    @property
    def _loops(self) -> str:
        return f"{self.timing.loops} loop{'s' * (self.timing.loops > 1)}"


def _array_of(places: "ArrayConfig | ElementsConfig") -> Array:
    """Array of elements at places, none of them turned and without a pattern of their own."""
    return Array(places.tx, places.rx, (1.0,) * len(places.rx), EVEN)


class BoardRadar(ArrayRadar[N], Generic[N]):
    """A TI board: the .cfg says its chirps, frames and receivers, the device its antennas."""

    kind: ClassVar[str] = "board"
    named: ClassVar[str] = "radar.cfg"
    chirps_key: ClassVar[str] = "radar.cfg, frameCfg"

    waveform: Literal["fmcw"] = "fmcw"
    cfg: Annotated[str, Field(min_length=1, max_length=2**16)]
    """The .cfg of a TI board, which gives the waveform: a path from this file's folder on, or a
    known radar (docs/guide/boards.md). A config that is written has its text."""
    device: Literal[tuple(DEVICES)] | None = None  # type: ignore[valid-type]
    """TI board that the .cfg runs on; it decides the antenna array."""
    array: ArrayConfig | None = None
    """Antenna array used instead of the device's."""
    subframe: Annotated[int, Field(ge=0, le=3, strict=True)] = 0
    """Number of the subframe (advFrameCfg of the .cfg) that images and Doppler-time maps are of."""

    @field_validator("device", mode="before")
    @classmethod
    def _name_device(cls, device: Any) -> Any:
        """Name a board by any spelling of it: IWR6843AOPEVM, awr1843, IWR6843ISK_ODS."""
        if not isinstance(device, str):
            return device
        name = device_name(device)
        if name is None:
            raise value_error(
                f"should be one of {', '.join(DEVICES)}; or leave it out, and radar.array says "
                "where antennas are: {tx: [[0, 0], ...], rx: [[0, 0], [1, 0], ...]}, (left, up) in "
                "half wavelengths"
            )
        return name

    @property
    def header(self) -> "BoardHeader":
        """Header of the board that `cfg` describes.

        Raises:
            CaptureError: `cfg` cannot be read.
        """
        from radhar_cli.readers.ti.ti_cfg import parse_ti_cfg  # slow to import, and of boards alone

        return parse_ti_cfg(self.cfg, device=self.device, subframe=self.subframe)

    @property
    def timing(self) -> FrameTiming:
        """Chirps, frames and samples that `cfg` describes."""
        return self.header.timing

    @property
    def firmware(self) -> Firmware | None:
        """Chain of TI's firmware whose commands `cfg` has; None without any."""
        return self.header.firmware

    @property
    def removes_mean(self) -> bool:
        """Whether `cfg` has the mean of each frame removed."""
        return self.header.detection.remove_mean

    @property
    def stated_pose(self) -> dict[str, Any]:
        """Place and angles by sensorPosition of `cfg`; {} without that line."""
        return {} if self.header.pose is None else vars(self.header.pose)

    @property
    def other_subframes(self) -> dict[str, int]:
        """Numbers of the subframes of the .cfg but the chosen one, {end of products: number}."""
        numbers = range(self.timing.subframes)
        return {f"_sf{number}": number for number in numbers if number != self.subframe}

    @property
    def ends_in_files(self) -> dict[str, str]:
        """Ends of the names of what is stored of each subframe, {end of products: end in files}.

        Products of the chosen subframe have no end, in files those of subframe 0.
        """
        chosen = {"": self.subframe}
        numbers = sorted((chosen | self.other_subframes).items(), key=lambda pair: pair[1])
        return {end: f"_sf{number}" if number else "" for end, number in numbers}

    @property
    def first_subframe(self) -> Self:
        """This board with subframe 0 chosen."""
        return self.model_copy(update={"subframe": 0})

    @property
    def carrier_hz(self) -> float:
        """Frequency at the first sample of a chirp that is kept, Hz."""
        return self.timing.carrier_hz

    @property
    def bandwidth_hz(self) -> float:
        """Bandwidth that a chirp sweeps while it is sampled, Hz."""
        return self.timing.bandwidth_hz

    @property
    def prf_hz(self) -> float:
        """Loops per second within a frame."""
        return self.timing.prf_hz

    @property
    def adc_rate_hz(self) -> float:
        """Sampling rate of the ADC, Hz."""
        return self.timing.adc_rate_hz

    @property
    def chirp_s(self) -> float:
        """Duration for which a chirp is sampled, s."""
        return self.timing.chirp_s

    @property
    def usual_noise_figure_db(self) -> float:
        """Noise figure of the device, or of boards whose elements `array` gives, dB."""
        return NOISE_FIGURE_DB if self.device is None else DEVICES[self.device].noise_figure_db

    @property
    def elements(self) -> Array | None:
        """Antenna elements of the board: those of `array`, or its device's; None without either."""
        if self.array is None:
            return None if self.device is None else DEVICES[self.device].array
        return _array_of(self.array)

    def why_no_points(self, chain: Chain) -> str | None:
        """Return why a chain does not find points on the board; None if it does."""
        return self._why_no_pair(chain) or super().why_no_points(chain)

    def _why_no_pair(self, chain: Chain) -> str | None:
        """Return why a demo refuses chirps that two transmitters send together, or None.

        The out-of-box firmware takes two chirps alone, of TX1 and TX3, on a 1642 of TX1 and TX2.
        """
        timing = self.timing
        firmware = self.firmware if chain == "board" else chain
        if timing.bpm is None or firmware not in ("sdk1", "sdk3"):
            return None
        masks = {"16": (3,), "18": (5,), "68": (5,)}.get(str(self.device)[3:5], (3, 5, 6))
        right = "two chirps of the same two transmitters"
        if len(timing.masks) == 2:
            if timing.masks[0] in masks:
                return None
            right = f"the mask {masks[0]}"
        masks_given = " ".join(map(str, timing.masks))
        return (
            f"bpmCfg with the masks {masks_given} (chirpCfg txEnable): the out-of-box firmware "
            f"takes {right} (cloud.chain: {chain})"
        )


class FrameConfig(Section):
    """Frames of a radar: so many chirps, sweeps or samples, and a pause until the next frame."""

    chirps: Annotated[int, Field(ge=1, le=2**14, strict=True), FIXED]
    """Number of chirps, sweeps of sfcw, or samples of cw, of each transmitter in a frame: the
    pulses of a range-Doppler map."""
    interval_s: Annotated[float, Field(gt=0, le=1e3, strict=True), FIXED] | None = None
    """Time from chirp to chirp, of whichever transmitter; null is 1/(prf_hz times the number of
    transmitters), or the length of a chirp without prf_hz."""
    period_s: Annotated[float, Field(gt=0, le=1e4, strict=True), FIXED] | None = None
    """Time from frame to frame; null is that of the chirps, without a pause."""


class ElementsConfig(Section):
    """Antenna elements of a radar with frames, (left, up) in half wavelengths, looking out."""

    tx: Annotated[tuple[Place, ...], Field(min_length=1, max_length=MAX_ELEMENTS)] = ((0.0, 0.0),)
    """Places of the transmitters, which take turns, chirp by chirp, in this order."""
    rx: Annotated[tuple[Place, ...], Field(min_length=1, max_length=MAX_ELEMENTS)] = ((0.0, 0.0),)
    """Places of the receivers."""


ONE_PAIR = ElementsConfig.model_construct()


class _FrameStart(ArrayRadar[N], Generic[N]):
    """First keys of radars with frames whose numbers stand in the config."""

    frame: FrameConfig
    """Frames of the radar, which range-Doppler and angle maps, cubes, points and skeletons are
    of."""
    carrier_hz: Annotated[float, Field(ge=1e6, le=1e13, strict=True), FIXED] = 77e9
    """Frequency at the first sample of a chirp, of the first step, or of cw."""

    if TYPE_CHECKING:  # of each waveform, in its own way

        @property
        def bandwidth_hz(self) -> float: ...
        @property
        def adc_rate_hz(self) -> float: ...
        @property
        def chirp_s(self) -> float: ...


class _SweptBand(_FrameStart[N], Generic[N]):
    """Band of radars with frames that sweep it."""

    bandwidth_hz: Annotated[float, Field(ge=1e3, le=1e12, strict=True), FIXED] = 1e9
    """Bandwidth that a chirp sweeps while it is sampled, or the steps cover."""


class _SampledChirps(_SweptBand[N], Generic[N]):
    """Samples of radars with frames of chirps."""

    adc_rate_hz: Annotated[float, Field(ge=1e-3, le=1e13, strict=True), FIXED] = 10e6
    """Sampling rate of the ADC within a chirp."""
    chirp_s: Annotated[float, Field(ge=1e-12, le=1e4, strict=True), FIXED] = 40e-6
    """Duration of the sampled sweep."""


class FramesRadar(_FrameStart[N], Generic[N]):
    """A radar with frames whose numbers stand in the config, as its data sheet has them."""

    named: ClassVar[str] = "radar.frame"
    chirps_key: ClassVar[str] = "radar.frame.chirps"

    prf_hz: Filled[Annotated[float, Field(ge=1e-3, le=1e7, strict=True), FIXED]] = default_draw(
        None
    )
    """Chirps of each transmitter per second, within a frame; null is by frame.interval_s."""
    output: Literal["iq", "real"] = "iq"
    """Samples of the receivers: iq, or real for one channel of the mixer, whose range bins are
    those of half the band."""
    array: ElementsConfig = ONE_PAIR
    """Antenna elements; one transmitter and one receiver at the same place unless given."""
    tx_m: VectorOf[N] | None = None
    """Place of one transmitter in the scene, with rx_m instead of array and position_m."""
    rx_m: VectorOf[N] | None = None
    """Place of one receiver in the scene."""

    @model_validator(mode="after")
    def _fill_prf(self) -> Self:
        """Fill the rate of chirps that the interval gives."""
        if self.prf_hz is None:
            object.__setattr__(self, "prf_hz", 1 / (self.interval_s * len(self.array.tx)))
        return self

    @property
    def interval_s(self) -> float:
        """Time from chirp to chirp, s."""
        if self.frame.interval_s is not None:
            return self.frame.interval_s
        if self.prf_hz is not None:
            return 1 / (self.prf_hz * len(self.array.tx))
        return self.chirp_s

    @property
    def timing(self) -> FrameTiming:
        """Chirps, frames and samples of the radar."""
        transmitters, chirps = len(self.array.tx), self.frame.chirps
        pause_free_s = chirps * transmitters * self.interval_s
        return FrameTiming(
            start_hz=self.carrier_hz,
            carrier_hz=self.carrier_hz,
            slope_hz=self.bandwidth_hz / self.chirp_s,
            samples=max(half_up(self.adc_rate_hz, self.chirp_s), 1),
            adc_rate_hz=self.adc_rate_hz,
            slot_s=self.interval_s,
            masks=tuple(1 << n for n in range(transmitters)),
            receivers=tuple(range(len(self.array.rx))),
            loops=chirps,
            frames=0,
            period_s=pause_free_s if self.frame.period_s is None else self.frame.period_s,
            sampling=Sampling.REAL if self.output == "real" else Sampling.COMPLEX,
        )

    @property
    def place_keys(self) -> tuple[str, ...]:
        """Keys of the places of the antennas, or of the array."""
        written = [name for name in ("tx_m", "rx_m") if getattr(self, name) is not None]
        return (*written,) or ("position_m",)

    @property
    def elements(self) -> Array:
        """Antenna elements, which have no pattern unless half_power_deg gives one."""
        return _array_of(self.array)


class ChirpFramesRadar(FramesRadar[N], _SampledChirps[N], Generic[N]):
    """A radar that sends frames of chirps."""

    kind: ClassVar[str] = "frames"

    waveform: Literal["fmcw"] = "fmcw"


class StepFramesRadar(FramesRadar[N], Steps[N], _SweptBand[N], Generic[N]):
    """A radar that sends frames of sweeps, each of steps of frequency with a sample."""

    kind: ClassVar[str] = "sfcw_frames"
    named: ClassVar[str] = "radar.frame of waveform: sfcw"
    model_config = ConfigDict(json_schema_extra=_require_waveform)

    waveform: Literal["sfcw"] = "sfcw"


class CwFramesRadar(ContinuousWave, FramesRadar[N], Generic[N]):
    """A radar that sends one frequency, whose samples are taken in frames: it has no range."""

    kind: ClassVar[str] = "cw_frames"
    named: ClassVar[str] = "radar.frame of waveform: cw"
    model_config = ConfigDict(json_schema_extra=_require_waveform)

    waveform: Literal["cw"] = "cw"
    """Kind of the radar."""

    @model_validator(mode="before")
    @classmethod
    def _require_rate(cls, value: object) -> object:
        """Require the key that gives the rate of the samples."""
        if isinstance(value, dict) and isinstance(value.get("frame"), dict):
            rates = value.get("prf_hz"), value["frame"].get("interval_s")
            if rates == (None, None):
                raise value_error(
                    "should have prf_hz, the samples of each receiver per second, with "
                    "waveform: cw and frame"
                )
        return value

    def why_no_frames(self, name: str) -> str | None:
        """Return why the radar, which has no range, makes no map of frames; None if it does."""
        kind = FRAME_MAP_KINDS.get(name)
        if name == "points" or (kind is not None and kind.rows is RANGE):
            return NO_RANGE
        return super().why_no_frames(name)

    def why_no_points(self, chain: Chain) -> str | None:
        """Return why there are no points: the radar has no range."""
        return NO_RANGE


Kind: TypeAlias = (
    FmcwRadar[N]
    | SfcwRadar[N]
    | CwRadar[N]
    | ImpulseRadar[N]
    | BoardRadar[N]
    | ChirpFramesRadar[N]
    | StepFramesRadar[N]
    | CwFramesRadar[N]
)
RADARS: tuple[type[AnyRadar], ...] = get_args(Kind)
# {waveform: kind} of the radars that have frames in the config.
KINDS_WITH_FRAMES = {
    "fmcw": ChirpFramesRadar.kind,
    "sfcw": StepFramesRadar.kind,
    "cw": CwFramesRadar.kind,
}
for _kind in RADARS:
    _kind.ALTERNATIVES = tuple(other for other in RADARS if other is not _kind)


def class_of_radar(value: Any) -> type[AnyRadar] | None:
    """Return the class of a radar, or of a mapping that describes one; None of an unknown kind."""
    if isinstance(value, AnyRadar):
        return type(value)
    if not isinstance(value, dict):
        return FmcwRadar  # which refuses what is no mapping
    name = value.get("waveform", "fmcw")
    if value.get("cfg") is not None:
        name = "board"
    elif value.get("frame") is not None:
        name = KINDS_WITH_FRAMES.get(name, name)
    return next((radar for radar in RADARS if radar.kind == name), None)


def _tag_of_radar(value: Any) -> str | None:
    """Return the tag in the union `Radar` of a radar, or of a mapping that describes one."""
    radar = class_of_radar(value)
    return None if radar is None else f"<{radar.kind}>"


_KIND_KEYS = ("cfg", "frame")  # which make a radar one of a kind


def _without_null(value: Any) -> Any:
    """Drop nulls by which a config leaves out what its base says of a radar of another kind.

    These are `cfg: null`, `frame: null` and null for keys that only other kinds have.
    """
    if not isinstance(value, dict):
        return value
    outline = {
        key: inner for key, inner in value.items() if inner is not None or key not in _KIND_KEYS
    }
    kind = class_of_radar(outline)
    if kind is None:
        return outline
    of_others = {key for radar in RADARS for key in radar.model_fields} - kind.model_fields.keys()
    return {
        key: inner for key, inner in outline.items() if inner is not None or key not in of_others
    }


# What `radar:` may be: of a config, and with its numbers as floats of a scene.
if TYPE_CHECKING:
    Radar: TypeAlias = Kind[N]
    SceneRadar: TypeAlias = Kind[float]
else:
    Radar = Annotated[
        Union[tuple(Annotated[radar, Tag(f"<{radar.kind}>")] for radar in RADARS)],  # noqa: UP007
        Discriminator(
            _tag_of_radar,
            custom_error_type="wrong",
            custom_error_message=(
                "should have a waveform: fmcw, sfcw, cw or impulse; or cfg, or frame"
            ),
        ),
        BeforeValidator(_without_null),
    ]
    SceneRadar = Kind
