"""Frames of a radar by its data sheet's numbers."""

from dataclasses import dataclass

from radhar_cli.numerics.rounding import half_up
from radhar_cli.radar.frame_header import ChirpProfile, FrameHeader, Sampling


@dataclass(frozen=True)
class WrittenFrames:
    """Frames of a radar whose transmitters take turns, chirp by chirp.

    Attributes:
        carrier_hz: Frequency at the first sample of a chirp, Hz.
        bandwidth_hz: Bandwidth that is swept while a chirp is sampled, Hz.
        adc_rate_hz: Sampling rate, Hz.
        chirp_s: Duration of the sampled sweep, s.
        interval_s: Time from chirp to chirp, s.
        chirps: Number of chirps of each transmitter in a frame.
        period_s: Time from frame to frame, s; None for no pause between frames.
        transmitters: Number of transmitters.
        receivers: Number of receivers.
        is_real: Whether samples are real.
    """

    carrier_hz: float
    bandwidth_hz: float
    adc_rate_hz: float
    chirp_s: float
    interval_s: float
    chirps: int
    period_s: float | None
    transmitters: int
    receivers: int
    is_real: bool

    @property
    def busy_s(self) -> float:
        """Duration of the chirps of a frame, s."""
        return self.chirps * self.transmitters * self.interval_s

    @property
    def samples(self) -> int:
        """Number of samples of a chirp."""
        return half_up(self.adc_rate_hz, self.chirp_s)

    @property
    def header(self) -> FrameHeader:
        """Header of these frames."""
        return FrameHeader(
            profile=self._profile,
            masks=tuple(1 << n for n in range(self.transmitters)),
            loops=self.chirps,
            frames=0,
            period_s=self.busy_s if self.period_s is None else self.period_s,
            receivers=tuple(range(self.receivers)),
            sampling=Sampling.REAL if self.is_real else Sampling.COMPLEX,
            loop_s=self.transmitters * self.interval_s,
        )

    @property
    def _profile(self) -> ChirpProfile:
        """Ramp that is sampled from its start to its end."""
        ramp_us = self.chirp_s * 1e6
        return ChirpProfile(
            start_ghz=self.carrier_hz / 1e9,
            idle_us=self.interval_s * 1e6 - ramp_us,
            adc_start_us=0.0,
            ramp_end_us=ramp_us,
            slope_mhz_per_us=self.bandwidth_hz / self.chirp_s / 1e12,
            samples=max(self.samples, 1),
            rate_ksps=self.adc_rate_hz / 1e3,
        )
