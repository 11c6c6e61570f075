"""Chirps, frames and samples of a radar that sends frames, whichever file says them."""

from dataclasses import dataclass, field
from enum import IntEnum

from radhar_cli.errors import CaptureError
from radhar_cli.numerics.constants import SPEED_OF_LIGHT

ROUNDING = 1 + 1e-6  # of times that a file states in decimals


class Sampling(IntEnum):
    """Samples of a chirp, by TI's number adcOutputFmt."""

    REAL = 0
    COMPLEX = 1  # complex 1x
    COMPLEX_2X = 2  # with the image band


@dataclass(frozen=True)
class ChirpProfile:
    """Ramp of a chirp and the samples that are taken in it, in TI's units.

    Attributes:
        start_ghz: Frequency at which the ramp starts.
        idle_us: Time before the ramp.
        adc_start_us: Time from the start of the ramp to the first sample.
        ramp_end_us: Time from the start of the ramp to its end.
        slope_mhz_per_us: Slope of the ramp.
        samples: Number of samples.
        rate_ksps: Sampling rate.
        backoff_db: By how much the power of each transmitter is lower; () for none.
        place: Line and argument of the number of samples, which messages name.
    """

    start_ghz: float
    idle_us: float
    adc_start_us: float
    ramp_end_us: float
    slope_mhz_per_us: float
    samples: int
    rate_ksps: float
    backoff_db: tuple[float, ...] = ()
    place: str = field(default="", compare=False)

    @property
    def sweep(self) -> tuple[float, ...]:
        """What of the profile decides a sampled sweep, whenever and however strong it is sent."""
        ramp = self.start_ghz, self.slope_mhz_per_us, self.adc_start_us
        return (*ramp, self.samples, self.rate_ksps)

    @property
    def slope_hz(self) -> float:
        """Slope of the ramp, Hz per second."""
        return self.slope_mhz_per_us * 1e12

    @property
    def carrier_hz(self) -> float:
        """Frequency at the first sample, Hz."""
        return self.start_ghz * 1e9 + self.slope_hz * self.adc_start_us * 1e-6

    @property
    def adc_rate_hz(self) -> float:
        """Sampling rate, Hz."""
        return self.rate_ksps * 1e3

    @property
    def slot_s(self) -> float:
        """Time from the start of a chirp to that of the next, s."""
        return (self.idle_us + self.ramp_end_us) * 1e-6

    def require_samples_within_ramp(self) -> None:
        """Raise CaptureError if the ramp ends before the last sample."""
        sampled_us = self.ramp_end_us - self.adc_start_us
        if self.samples / self.adc_rate_hz > sampled_us * 1e-6 * ROUNDING:
            ended_us = self.adc_start_us + self.samples / self.adc_rate_hz * 1e6
            fitting = max(int(sampled_us * self.adc_rate_hz / 1e6), 0)
            raise CaptureError(
                f"{self.place} = {self.samples}: should be at most {fitting}: at "
                f"{self.adc_rate_hz:g} Hz they end at {ended_us:.6g} us, after the ramp "
                f"({self.ramp_end_us:g} us)"
            )


@dataclass(frozen=True)
class FrameHeader:
    """What a radar sends in frames, and the samples that it takes: all that a raw capture tells.

    A board of TI, whose file says more, has a header of its own (`ti_cfg.BoardHeader`).

    Attributes:
        profile: Ramp and samples of every chirp.
        masks: Transmitters of the chirps of a loop, until they repeat; bit n is transmitter n.
        loops: Number of loops of a frame.
        frames: Number of frames of a recording; 0 is as many as there is time for.
        period_s: Time from frame to frame, s.
        receivers: Numbers of the receivers that are on, from 0 on.
        sampling: Kind of the samples.
        loop_s: Time from loop to loop, s.
        adc_bits: Number of bits of a sample.
        bpm: Places in the loop of the chirps that have the sum and the difference of two
            transmitters; None where transmitters take turns.
        averaged: Number of chirps in a row of which one sample is the mean.
        chirp_starts_s: Times from the first ramp of a loop to each of its ramps, s; () where chirps
            follow each other after a slot.
        subframe: Number of the subframe that these are the chirps of, from 0 on.
        subframes: Number of subframes of a frame.
        delay_s: Time from the start of a frame to that of the subframe, s.
    """

    profile: ChirpProfile
    masks: tuple[int, ...]
    loops: int
    frames: int
    period_s: float
    receivers: tuple[int, ...]
    sampling: Sampling
    loop_s: float
    adc_bits: int = field(default=16, kw_only=True)
    bpm: tuple[int, int] | None = field(default=None, kw_only=True)
    averaged: int = field(default=1, kw_only=True)
    chirp_starts_s: tuple[float, ...] = field(default=(), kw_only=True)
    subframe: int = field(default=0, kw_only=True)
    subframes: int = field(default=1, kw_only=True)
    delay_s: float = field(default=0.0, kw_only=True)

    @property
    def order(self) -> tuple[int, ...]:
        """Numbers of the transmitters in their order within a loop, from 0 on.

        Of two that send together the lower takes the place of their sum.
        """
        order = [mask.bit_length() - 1 for mask in self.masks]
        if self.bpm is not None:
            lower, higher = transmitters_of(self.masks[self.bpm[0]])
            order[self.bpm[0]], order[self.bpm[1]] = lower, higher
        return tuple(order)

    @property
    def antennas(self) -> list[tuple[int, int]]:
        """Transmitter and receiver of each virtual element, from 0 on."""
        return [(t, r) for t in self.order for r in self.receivers]

    @property
    def frames_apart(self) -> bool:
        """Whether there is time between the last chirp of a frame and the next frame."""
        chirps_s = self.loops * self.loop_s
        return abs(self.period_s - chirps_s) >= 1e-9 * self.period_s

    @property
    def start_hz(self) -> float:
        """Frequency at which a ramp starts, Hz."""
        return self.profile.start_ghz * 1e9

    @property
    def carrier_hz(self) -> float:
        """Frequency at the first sample that is kept, Hz."""
        return self.profile.carrier_hz

    @property
    def centre_hz(self) -> float:
        """Middle of the sampled band, f_adc + K (N - 1)/(2 fs), Hz."""
        return self.carrier_hz + self.slope_hz * (self.samples - 1) / (2 * self.adc_rate_hz)

    @property
    def fastest_mps(self) -> float:
        """Radial speed up to which Doppler is unambiguous, c/(4 f_c loop), m/s."""
        return SPEED_OF_LIGHT / (4 * self.centre_hz * self.loop_s)

    def doppler_step_mps(self, carrier_hz: float | None = None) -> float:
        """Spacing of the Doppler bins, c/(2 f loop N_D), m/s.

        Args:
            carrier_hz: Frequency f that speeds refer to, Hz; None for f_c, the middle of the
                sampled band, which is the one that is right.
        """
        doppler_bins = 1 << (self.loops - 1).bit_length()
        return SPEED_OF_LIGHT / (2 * (carrier_hz or self.centre_hz) * self.loop_s * doppler_bins)

    @property
    def slope_hz(self) -> float:
        """Slope of a ramp, Hz per second."""
        return self.profile.slope_hz

    @property
    def adc_rate_hz(self) -> float:
        """Sampling rate, Hz."""
        return self.profile.adc_rate_hz

    @property
    def samples(self) -> int:
        """Number of samples of a chirp."""
        return self.profile.samples

    @property
    def slot_s(self) -> float:
        """Time from chirp to chirp, or from mean to mean, s."""
        return self.profile.slot_s * self.averaged

    @property
    def has_bursts(self) -> bool:
        """Whether chirps of a loop, or loops, do not follow each other after a slot each."""
        return (
            bool(self.chirp_starts_s)
            or abs(self.loop_s - len(self.masks) * self.slot_s) > 1e-9 * self.loop_s
        )

    @property
    def bins(self) -> int:
        """Number of range bins: those of half the band, unless samples are complex 1x."""
        n_fft = 1 << (self.samples - 1).bit_length()
        return n_fft if self.sampling is Sampling.COMPLEX else n_fft // 2

    @property
    def farthest_m(self) -> float:
        """Range at which the range bins end, m."""
        share = 1 if self.sampling is Sampling.COMPLEX else 2
        return SPEED_OF_LIGHT * self.adc_rate_hz / (2 * share * self.slope_hz)

    @property
    def range_step_m(self) -> float:
        """Spacing of the range bins, c fs/(2 K N_FFT), m."""
        return self.farthest_m / self.bins

    @property
    def bandwidth_hz(self) -> float:
        """Frequency swept while the samples are taken, Hz."""
        return self.slope_hz * self.samples / self.adc_rate_hz

    @property
    def prf_hz(self) -> float:
        """Chirps of one transmitter per second, within a frame."""
        return 1 / self.loop_s


def transmitters_of(mask: int) -> tuple[int, ...]:
    """Numbers of the transmitters of a mask, from 0 on."""
    return tuple(n for n in range(mask.bit_length()) if mask >> n & 1)


@dataclass(frozen=True)
class RoomBox:
    """Box in the axes of the room, from the floor point below a board.

    Attributes:
        ahead_m: Limits along the x axis of scenes, m.
        left_m: Limits along the y axis, m.
        up_m: Limits of heights above the floor, m.
    """

    ahead_m: tuple[float, float]
    left_m: tuple[float, float]
    up_m: tuple[float, float]
