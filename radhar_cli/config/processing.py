"""Clutter, range compression, gate, windows."""

from math import sqrt
from typing import Annotated, Any, Literal

from pydantic import Field, field_validator, model_validator

from radhar_cli.config.acting import (
    CHIRPS,
    DENOISED,
    EVEN,
    FSSTS,
    NO_BOARD,
    RANGE_TIME,
    SIGNAL_MAPS,
    SPECTRA,
    STFTS,
)
from radhar_cli.config.radar import MIN_WINDOW
from radhar_cli.numerics.constants import SPEED_OF_LIGHT
from radhar_cli.numerics.rounding import half_up
from radhar_cli.processing import canceller
from radhar_cli.processing.frames import Frames
from radhar_cli.radar.chirp_window import ChirpWindow, WindowName
from radhar_cli.schema.annotations import ByModel, NeedsKey
from radhar_cli.schema.number import value_error
from radhar_cli.schema.section import Flag, Section, defaults_of


class SavgolConfig(Section):
    """The Savitzky-Golay filter of the denoised maps."""

    order: Annotated[int, Field(ge=0, le=30, strict=True)] = 5
    """Order of the polynomial."""
    frame: Annotated[int, Field(ge=1, strict=True)] = 11
    """Number of pulses that the polynomial is fitted to; odd, above the order."""

    @model_validator(mode="after")
    def _require_fitting_frame(self) -> "SavgolConfig":
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

    def make_canceller(self, prf: float) -> canceller.HighPass:
        """Make the filter for `prf` pulses a second."""
        cutoff = DEFAULT_CUTOFF if self.cutoff_hz is None else 2 * self.cutoff_hz / prf
        return canceller.HighPass(self.order, cutoff, self.zero_phase, self.remove_mean)


DEFAULT_CUTOFF = 0.0075  # of PRF/2


LIMB_ACCELERATION = 2.0  # m/s^2 along the line of sight; gait and kicks are resolved at 2 to 77 GHz


MAX_WINDOW_SHARE = 0.25


PAPER_WINDOW = 0.1  # of the recording


_GATED = NeedsKey("processing.range_sum", "gated")


class ProcessingConfig(Section):
    """Clutter, range compression, gate, windows and thresholds."""

    clutter: Literal["difference", "mean", "highpass", "none"] = "difference"
    """Clutter canceller: difference is s[m + 1] - s[m], the paper's MTI; mean takes out that of the
    recording; highpass is the filter below; none leaves leakage, walls and faces of the room."""
    highpass: Annotated[HighpassConfig, NeedsKey("processing.clutter", "highpass")] = defaults_of(
        HighpassConfig
    )
    range_sum: Annotated[Literal["coherent", "gated"], SPECTRA] = "coherent"
    """Sum over range of Doppler maps: the coherent sum of the kept bins, or STFTs of those in the
    gate, summed incoherently."""
    gate_m: Annotated[float | tuple[float, float], _GATED] = 1.0
    """Reach of the gate to both sides of the torso, m, or [from, to]: fixed ranges."""
    gate_sum: Annotated[Literal["power", "magnitude"], _GATED] = "power"
    """Sum of the gate's bins: their powers, or (sum of the magnitudes)^2."""
    range_fft_length: Annotated[
        Annotated[int, Field(ge=2, multiple_of=2, strict=True)] | None, NO_BOARD
    ] = None
    """Length of the range FFT, even, at least the samples of a chirp; null finds one."""
    range_window: Annotated[
        WindowName | None,
        ByModel(human="hann", paper="rectangular", file="hann"),
        CHIRPS,
        SIGNAL_MAPS,
    ] = None
    """Window over the samples of a chirp, before range compression; its energy is that of none.
    Frame maps and points of a board have windows of their own."""
    range_sidelobes_db: Annotated[
        float,
        Field(ge=20, le=120, strict=True),
        NeedsKey("processing.range_window", "taylor", "chebyshev"),
    ] = 60.0
    """Sidelobes of taylor and chebyshev, dB below the peak."""
    range_gain_power: Annotated[float, Field(ge=0, le=8, strict=True), RANGE_TIME] = 0.0
    """Exponent p of the gain (R/largest R)^p of the rtm's range bins, after canceller and noise."""
    range_reference: Annotated[Literal["centre", "start"], NO_BOARD] = "centre"
    """Instant of the chirp at which the phase of range bins is taken."""
    window_s: Annotated[float | None, Field(gt=0, le=1e7, strict=True), SPECTRA] = None
    """Length of the STFT's window; null is a tenth of duration_s (paper), else by the wavelength,
    as limbs need."""
    overlap_fraction: Annotated[float, Field(ge=0, lt=1, strict=True), SPECTRA, EVEN] = 0.9
    """Overlap of consecutive STFT windows, as a fraction of the window."""
    stft_fft_length: Annotated[int | None, Field(ge=8, strict=True), STFTS] = None
    """Length of the STFT's FFT, at least the window; null finds one."""
    savgol: Annotated[SavgolConfig, DENOISED] = defaults_of(SavgolConfig)
    fsst_hop_pulses: Annotated[int | None, Field(ge=1, le=2**24, strict=True), FSSTS, EVEN] = None
    """Hop of the fsst maps in pulses; 1 is every sample, null the STFT's."""
    fsst_threshold: Annotated[float, Field(ge=0, lt=1, strict=True), FSSTS] = 1e-3
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

    @property
    def leaves_static(self) -> bool:
        """Whether the canceller leaves something of static echoes."""
        return self.clutter == "none" or (
            self.clutter == "highpass" and not self.highpass.remove_mean
        )

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

    def make_frames(self, duration: float, prf: float, f0: float) -> Frames:
        """Make the windows of the STFT, of `window_pulses`."""
        return Frames.of(self.window_pulses(duration, prf, f0), self.overlap_fraction)

    def make_fsst_frames(self, duration: float, prf: float, f0: float) -> Frames:
        """Make the windows of the FSST: those of the STFT, with a hop of its own if it has one."""
        frames, hop = self.make_frames(duration, prf, f0), self.fsst_hop_pulses
        return frames if hop is None else Frames(frames.length, hop)

    def make_canceller(self, prf: float) -> canceller.Canceller:
        """Make the canceller of static echoes for `prf` pulses a second."""
        match self.clutter:
            case "difference":
                return canceller.FIRST_DIFFERENCE
            case "mean":
                return canceller.MeanRemoval()
            case "none":
                return canceller.NO_CANCELLER
        return self.highpass.make_canceller(prf)

    def make_chirp_window(self) -> ChirpWindow:
        """Make the window before range compression."""
        assert self.range_window is not None  # filled in where the config was read
        return ChirpWindow(self.range_window, self.range_sidelobes_db)
