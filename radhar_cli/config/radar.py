"""The radar: its waveform, antennas and board."""

from typing import Annotated, Literal, TypeAlias

from pydantic import Field

from radhar_cli.config.acting import BOARD, NO_BOARD
from radhar_cli.config.annotations import GIVEN, ActsIf, ActsIfAny, ByModel
from radhar_cli.config.number import Angle, Decibel, NotNegative, Positive, Real, Vector, within
from radhar_cli.config.section import Flag, Section
from radhar_cli.radar.board import DEVICES, EVEN, Array
from radhar_cli.radar.ti_cfg import BoardHeader, parse_ti_cfg

Place: TypeAlias = tuple[Real, Real]


HalfPower = Annotated[float, Field(ge=1, le=1000, strict=True)]


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
    tx_m: Annotated[Vector, NO_BOARD] = (0.4, -0.1, 1.5)
    """Place of the transmitter: range, cross-range, height."""
    rx_m: Annotated[Vector, NO_BOARD] = (0.4, 0.1, 1.5)
    """Place of the receiver: range, cross-range, height."""
    antenna_gain_dbi: Annotated[Decibel, within(-150, 150, "dBi")] = 6.0
    """Gain of each antenna at its boresight."""
    antenna_isolation_db: Annotated[Decibel, NO_BOARD] = 10.0
    """Isolation between transmitter and receiver; only a raw echo shows the leakage."""
    residual_video_phase: Annotated[Flag, NO_BOARD] = False
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
    device: Annotated[Literal[tuple(DEVICES)] | None, BOARD] = None  # type: ignore[valid-type]
    """TI board that the .cfg runs on; it decides the antenna array."""
    array: Annotated[ArrayConfig | None, BOARD] = None
    """Antenna array used instead of the device's."""
    position_m: Annotated[Vector, BOARD] = (0.0, 0.0, 1.0)
    """Position of a board: range, cross-range, height."""
    yaw_deg: Annotated[Angle, BOARD] = 0.0
    """Angle of a board's boresight from the x axis, positive to the left."""
    tilt_deg: Annotated[Angle, BOARD] = 0.0
    """Angle of a board's boresight below the horizontal, positive down."""
    half_power_deg: Annotated[tuple[HalfPower, HalfPower] | None, BOARD] = None
    """Half-power half-widths of an element in azimuth and elevation; null is the device's."""
    half_wavelength_m: Annotated[float | None, Field(gt=0, le=1, strict=True), BOARD] = None
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
    def header(self) -> BoardHeader:
        """Header of the board that `cfg` describes.

        Raises:
            CaptureError: `cfg` cannot be read.
        """
        assert self.cfg is not None
        return parse_ti_cfg(self.cfg)

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
