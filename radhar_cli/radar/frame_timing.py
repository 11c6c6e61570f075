"""Timing of the frames of a radar: chirps, frames and samples, whichever file states them."""

from dataclasses import dataclass
from enum import IntEnum

from radhar_cli.numerics.constants import SPEED_OF_LIGHT


class Sampling(IntEnum):
    """Samples of a chirp, by TI's number adcOutputFmt."""

    REAL = 0
    COMPLEX = 1  # complex 1x
    COMPLEX_2X = 2  # with the image band


@dataclass(frozen=True, kw_only=True)
class FrameTiming:
    """Chirps and frames that a radar sends, and the samples that it takes of them.

    Configs, files of boards and captures state these in their own words; their readers make this of
    them, and all other code uses only this.

    Attributes:
        start_hz: Frequency at which a ramp starts.
        carrier_hz: Frequency f_adc at the first sample that is kept.
        slope_hz: Slope K of a ramp, Hz/s.
        samples: Number N of samples of a chirp.
        adc_rate_hz: Sampling rate fs.
        slot_s: Time from chirp to chirp, or from mean to mean.
        masks: Transmitters of the chirps of a loop, until they repeat; bit n is transmitter n.
        receivers: Numbers of the receivers that are on, from 0 on.
        loops: Number of loops of a frame.
        frames: Number of frames of a recording; 0 is as many as there is time for.
        period_s: Time from frame to frame.
        sampling: Kind of the samples.
        adc_bits: Number of bits of a sample.
        backoff_db: By how much the power of each transmitter of the device is lower; () for none.
        bpm: Places in the loop of the chirps that have the sum and the difference of two
            transmitters; None where transmitters take turns.
        averaged: Number of chirps in a row of which one sample is the mean.
        chirp_starts_s: Times from the first ramp of a loop to each of its ramps; () where chirps
            follow each other after a slot.
        burst_s: Time from loop to loop; None where loops follow each other without a pause.
        subframe: Number of the subframe that these are the chirps of, from 0 on.
        subframes: Number of subframes of a frame.
        delay_s: Time from the start of a frame to its first chirp.
    """

    start_hz: float
    carrier_hz: float
    slope_hz: float
    samples: int
    adc_rate_hz: float
    slot_s: float
    masks: tuple[int, ...]
    receivers: tuple[int, ...]
    loops: int
    frames: int
    period_s: float
    sampling: Sampling = Sampling.COMPLEX
    adc_bits: int = 16
    backoff_db: tuple[float, ...] = ()
    bpm: tuple[int, int] | None = None
    averaged: int = 1
    chirp_starts_s: tuple[float, ...] = ()
    burst_s: float | None = None
    subframe: int = 0
    subframes: int = 1
    delay_s: float = 0.0

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
    def antennas_of_channels(self) -> list[tuple[int, int]]:
        """Transmitter and receiver of each virtual element, from 0 on."""
        return [(t, r) for t in self.order for r in self.receivers]

    @property
    def channels(self) -> int:
        """Number V of virtual elements."""
        return len(self.masks) * len(self.receivers)

    @property
    def loop_s(self) -> float:
        """Time from a chirp to the next of the same transmitter, s."""
        return self.burst_s or self.slot_s * len(self.masks)

    @property
    def prf_hz(self) -> float:
        """Chirps of one transmitter per second, within a frame."""
        return 1 / self.loop_s

    @property
    def frames_apart(self) -> bool:
        """Whether there is time between the last chirp of a frame and the next frame."""
        return abs(self.period_s - self.loops * self.loop_s) >= 1e-9 * self.period_s

    def frames_in(self, seconds: float) -> int:
        """Number of frames of a recording of so many seconds, at least one."""
        frames = max(int(seconds / self.period_s + 1e-9), 1)
        return min(frames, self.frames or frames)

    @property
    def chirp_s(self) -> float:
        """Duration N/fs for which a chirp is sampled, s."""
        return self.samples / self.adc_rate_hz

    @property
    def bandwidth_hz(self) -> float:
        """Frequency swept while the samples are taken, Hz."""
        return self.slope_hz * self.samples / self.adc_rate_hz

    @property
    def centre_hz(self) -> float:
        """Frequency of Doppler and angles, the middle of the band: f_adc + K (N - 1)/(2 fs), Hz."""
        return self.carrier_hz + self.slope_hz * (self.samples - 1) / (2 * self.adc_rate_hz)

    @property
    def is_real(self) -> bool:
        """Whether samples are real."""
        return self.sampling is Sampling.REAL

    @property
    def n_fft(self) -> int:
        """Length of the transform over a chirp: the next power of two."""
        return 1 << (self.samples - 1).bit_length()

    @property
    def n_bins(self) -> int:
        """Number of range bins: those of half the band, unless samples are complex 1x."""
        return self.n_fft if self.sampling is Sampling.COMPLEX else self.n_fft // 2

    @property
    def n_doppler(self) -> int:
        """Number of Doppler bins: the next power of two."""
        return 1 << (self.loops - 1).bit_length()

    @property
    def range_step_m(self) -> float:
        """Spacing of the range bins, c fs/(2 K N_FFT), m."""
        return SPEED_OF_LIGHT * self.adc_rate_hz / (2 * self.slope_hz * self.n_fft)

    @property
    def farthest_m(self) -> float:
        """Range at which the range bins end, m."""
        return self.n_bins * self.range_step_m

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
        carrier_hz = carrier_hz or self.centre_hz
        return SPEED_OF_LIGHT / (2 * carrier_hz * self.loop_s * self.n_doppler)


def transmitters_of(mask: int) -> tuple[int, ...]:
    """Numbers of the transmitters of a mask, from 0 on."""
    return tuple(n for n in range(mask.bit_length()) if mask >> n & 1)
