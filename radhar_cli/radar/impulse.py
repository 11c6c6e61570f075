"""Impulse radar: a Gaussian pulse on a carrier, received in real samples over range.

p(t) = exp(-t^2/(2 s^2)) cos(2 pi fm t), s = sqrt(ln 10)/(pi B), fm = fc + B/2: its spectrum is
10 dB down at fc and fc + B.
"""

from dataclasses import dataclass
from math import log, pi, sqrt

import numpy as np

from radhar_cli.numerics.arrays import Float
from radhar_cli.radar.waveform import SPEED_OF_LIGHT, Waveform


@dataclass(frozen=True)
class Impulse(Waveform):
    """A train of pulses; range bins are the samples of its profile."""

    profile: tuple[float, float] = (0.0, 1.0)  # where the range axis begins and ends, m
    samples: int = 256  # of a profile

    @property
    def width(self) -> float:
        """Standard deviation s of the pulse's envelope, s."""
        return sqrt(log(10)) / (pi * self.bandwidth)

    @property
    def n_bins(self) -> int:
        """Number of samples of a profile, all of which are kept."""
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

    def pulse(self, t: Float) -> Float:
        """Pulse p(t) at times t [...] (s)."""
        p: Float = np.exp(-((t / self.width) ** 2) / 2) * np.cos(2 * pi * self.f0 * t)
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
) -> Impulse:
    """An impulse radar, without the chirp that other waveforms have.

    Args:
        fc: Lower end of the band, Hz.
        bandwidth: Bandwidth at -10 dB, Hz.
        prf: Pulses per second, Hz.
        duration: Duration of a recording, s.
        profile: Ranges at which the range axis begins and ends, m.
        samples: Number of samples of a profile.
    """
    return Impulse(fc, bandwidth, 2e-9, 1e9, prf, duration, profile=profile, samples=samples)
