"""The FMCW waveform and everything that follows from it (paper, section "Radar Echo Model")."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from radhar_cli.numerics.arrays import Float
from radhar_cli.numerics.constants import SPEED_OF_LIGHT as SPEED_OF_LIGHT
from radhar_cli.numerics.rounding import half_up
from radhar_cli.radar.chirp_window import RECTANGULAR, ChirpWindow


@dataclass(frozen=True)
class Waveform:
    """A train of linear chirps."""

    fc: float  # carrier at the start of a chirp, Hz
    bandwidth: float  # B, Hz
    chirp: float  # Tp, s
    adc_rate: float  # fs, Hz
    prf: float  # pulses per second, Hz
    duration: float  # T, s
    fft_length: int | None = None  # N_FFT, or None for N_ADC (rounded up to even)
    # whether range bins are referred to mid-chirp (n0 = N_ADC/2) or to its start
    centred: bool = True
    residual_video_phase: bool = False  # whether the term + pi K tau^2 is kept
    window: ChirpWindow = RECTANGULAR  # over the samples of a chirp, before range compression

    @property
    def slope(self) -> float:
        """Slope of the chirp, K = B/Tp, Hz/s."""
        return self.bandwidth / self.chirp

    @property
    def wavelength(self) -> float:
        """Wavelength lambda = c/fc, m."""
        return SPEED_OF_LIGHT / self.fc

    @cached_property
    def n_adc(self) -> int:
        """Number of samples of a chirp, N_ADC = round(fs Tp)."""
        return half_up(self.adc_rate, self.chirp)

    @property
    def raw_samples(self) -> int:
        """Number of raw samples of a pulse, each with noise of its own."""
        return self.n_adc

    @cached_property
    def n_pulses(self) -> int:
        """Number of pulses, M = round(T PRF)."""
        return half_up(self.duration, self.prf)

    @property
    def n_fft(self) -> int:
        """Length N_FFT of the range transform, even and at least N_ADC."""
        return self.fft_length if self.fft_length is not None else self.n_adc + self.n_adc % 2

    @property
    def n_bins(self) -> int:
        """Number of range bins that are kept: the first half."""
        return self.n_fft // 2

    @property
    def orthogonal(self) -> bool:
        """Whether range bins are orthogonal: neither padded nor windowed."""
        return self.n_fft == self.n_adc and self.window.is_rectangular

    @property
    def n0(self) -> float:
        """Phase reference n0 within the chirp, in fast-time samples."""
        return self.n_adc / 2 if self.centred else 0.0

    @property
    def f0(self) -> float:
        """Frequency at which Doppler is read: fc + K n0/fs, Hz."""
        return self.fc + self.slope * self.n0 / self.adc_rate

    @property
    def sample_rate(self) -> float:
        """Samples per second that noise is white up to: fs, or the PRF of one sample a pulse, Hz.

        A receiver takes thermal noise from as many Hz.
        """
        return self.prf if self.n_adc == 1 else self.adc_rate

    @property
    def range_step(self) -> float:
        """Spacing of the range bins, c fs/(2 K N_FFT), m."""
        return SPEED_OF_LIGHT * self.adc_rate / (2 * self.slope * self.n_fft)

    @property
    def half_band_range(self) -> float:
        """Range c fs/(4 K), m, beyond which a beat leaves the kept bins."""
        return SPEED_OF_LIGHT * self.adc_rate / (4 * self.slope)

    @property
    def highest_speed(self) -> float:
        """Radial speed (m/s) at which the Doppler reaches PRF/2."""
        return SPEED_OF_LIGHT * self.prf / (4 * self.f0)

    @property
    def bin_gain(self) -> float:
        """Factor of range bins, 2 of samples that are real: half of their echo is elsewhere."""
        return 1.0

    def frequencies(self) -> Float:
        """Frequencies fc + K n/fs [N_ADC] (Hz) at the fast-time samples of a chirp."""
        return self.fc + self.slope * np.arange(self.n_adc) / self.adc_rate

    def times(self, pulses: Float) -> Float:
        """Slow times (s) of pulse numbers [...]."""
        return pulses / self.prf

    def range_axis(self) -> Float:
        """Ranges R_k [N_FFT/2] of the kept bins, m."""
        return np.arange(self.n_bins) * self.range_step
