"""Frequencies and times of the chirps of an FMCW radar, however its files state them."""

from dataclasses import asdict, dataclass
from typing import Self

from radhar_cli.radar.waveform import Waveform


@dataclass(frozen=True)
class FmcwTiming:
    """Frequencies and times of the chirps of one transmitter.

    Capture formats, headers and configs state them in their own words; who reads those makes this
    type of them, and nothing behind a reader asks for anything else. Slow time has none.
    """

    carrier_hz: float  # at the first sample that is kept
    bandwidth_hz: float  # B, swept while the samples are taken
    adc_rate_hz: float  # fs
    samples: int  # N, of a chirp
    prf_hz: float  # chirps of this transmitter per second, within a frame

    @classmethod
    def of_waveform(cls, w: Waveform) -> Self:
        """Timing of the samples of a waveform, N = N_ADC."""
        bandwidth = w.slope * w.n_adc / w.adc_rate
        return cls(w.fc, bandwidth, w.adc_rate, w.n_adc, w.prf)

    @property
    def chirp_s(self) -> float:
        """Duration of sampling N/fs, s."""
        return self.samples / self.adc_rate_hz

    def waveform(
        self, duration: float, fft_length: int | None = None, centred: bool = True
    ) -> Waveform:
        """Waveform of these chirps.

        Args:
            duration: Duration of the recording, s.
            fft_length: Length of the transform over a chirp; None is the number of samples.
            centred: Whether ranges refer to the middle of the chirp.
        """
        return Waveform(
            fc=self.carrier_hz,
            bandwidth=self.bandwidth_hz,
            chirp=self.chirp_s,
            adc_rate=self.adc_rate_hz,
            prf=self.prf_hz,
            duration=duration,
            fft_length=fft_length,
            centred=centred,
        )

    def first_difference(self, other: Self, tolerance: float = 1e-6) -> str | None:
        """Name of the first number that differs from `other` by more than a relative tolerance."""
        expected = asdict(other)
        for name, value in asdict(self).items():
            if abs(value - expected[name]) > tolerance * abs(expected[name]):
                return name
        return None
