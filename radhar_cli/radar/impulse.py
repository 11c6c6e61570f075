"""Impulse radar: a Gaussian pulse on a carrier, received in samples over range.

p(t) = g(t) cos(2 pi fm t), g(t) = exp(-t^2/(2 s^2)), s = sqrt(ln 10)/(pi B), fm = fc + B/2: its
spectrum is 10 dB down at fc and fc + B. Samples are real, or complex ones of a chip that mixes them
down by fm and keeps the lower band: an echo of delay tau is g(t - tau) exp(-j 2 pi fm tau), whose
real part, mixed up again, is p(t - tau).
"""

from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np

from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT, Waveform


@dataclass(frozen=True)
class Impulse(Waveform):
    """A train of pulses; range bins are the samples of its profile."""

    profile: tuple[float, float] = (0.0, 1.0)  # where the range axis begins and ends, m
    samples: int = 256  # of a profile
    is_iq: bool = False  # whether samples are complex, mixed down by fm

    @property
    def width(self) -> float:
        """Standard deviation s of the pulse's envelope, s."""
        return sqrt(log(10)) / (pi * self.bandwidth)

    @property
    def n_bins(self) -> int:
        """Number of samples of a profile, all of which are kept."""
        return self.samples

    @property
    def raw_samples(self) -> int:
        """Number of raw samples of a pulse: those of its profile."""
        return self.samples

    @property
    def f0(self) -> float:
        """Frequency at which Doppler is read: fm, Hz."""
        return self.fc + self.bandwidth / 2

    @property
    def range_step(self) -> float:
        """Spacing of the samples, m."""
        first, last = self.profile
        return (last - first) / self.samples

    @property
    def half_band_range(self) -> float:
        """Range at which the axis ends, m."""
        return self.profile[1]

    def range_axis(self) -> Float:
        """Ranges R_k = from + k (to - from)/samples [samples], m."""
        return self.profile[0] + np.arange(self.samples) * self.range_step

    @property
    def peak_to_power(self) -> float:
        """Power of the highest sample of an echo over P_s: 2 of real samples, 1 of complex ones."""
        return 1.0 if self.is_iq else 2.0

    @property
    def coarsest_step(self) -> float:
        """Widest spacing of samples that holds the band, m.

        Real samples take two a period of fc + 1.5 B, up to where the spectrum is 40 dB down;
        complex ones may be as far apart as the resolution c/(2 B), which folds what is 10 dB down
        or more.
        """
        if self.is_iq:
            return SPEED_OF_LIGHT / (2 * self.bandwidth)
        return SPEED_OF_LIGHT / (4 * (self.fc + 1.5 * self.bandwidth))

    def envelope(self, t: Float) -> Float:
        """Envelope g(t) of the pulse at times t [...] (s)."""
        g: Float = np.exp(-((t / self.width) ** 2) / 2)
        return g

    def pulse(self, t: Float) -> Float:
        """Pulse p(t) at times t [...] (s)."""
        p: Float = self.envelope(t) * np.cos(2 * pi * self.f0 * t)
        return p

    def spectrum(self, f: Float) -> Float:
        """Spectrum P(f) = s sqrt(2 pi) exp(-2 (pi s (f - fm))^2) at f [...] above 0 (Hz)."""
        turn = pi * self.width * (f - self.f0)
        return self.width * sqrt(2 * pi) * np.exp(-2 * turn * turn)

    @property
    def orthogonal(self) -> bool:
        """Whether range bins are orthogonal: never, as a pulse spreads over several samples."""
        return False

    def stepped(self, reach: float) -> Waveform:
        """Waveform of the frequencies that hold the pulse's spectrum.

        They are so close that echoes up to a range `reach` (m) do not fold. P falls to 2e-10 within
        2.2 B on both sides of fm.
        """
        low, high = max(self.f0 - 2.2 * self.bandwidth, 0.0), self.f0 + 2.2 * self.bandwidth
        step = SPEED_OF_LIGHT / (4 * reach)
        steps = int((high - low) / step) + 1
        first, band = low + step / 2, steps * step
        return Waveform(first, band, 1e-6, steps * 1e6, self.prf, self.duration)


def impulse(
    fc: float,
    bandwidth: float,
    prf: float,
    duration: float,
    profile: tuple[float, float],
    samples: int,
    is_iq: bool = False,
) -> Impulse:
    """An impulse radar, without the chirp that other waveforms have.

    Args:
        fc: Lower end of the band, Hz.
        bandwidth: Bandwidth at -10 dB, Hz.
        prf: Pulses per second, Hz.
        duration: Duration of a recording, s.
        profile: Ranges at which the range axis begins and ends, m.
        samples: Number of samples of a profile.
        is_iq: Whether samples are complex, mixed down by the middle of the band.
    """
    timing = fc, bandwidth, 2e-9, 1e9, prf, duration
    return Impulse(*timing, profile=profile, samples=samples, is_iq=is_iq)
