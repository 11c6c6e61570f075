"""Bulk Doppler compensation."""

from dataclasses import asdict

import numpy as np
import pytest
from helpers import reference as ref

from radhar_cli.processing.doppler_compensation import compensate
from radhar_cli.radar.fmcw import Waveform

RADAR = ref.Radar(24e9, 1e9, adc_rate=1e6, prf=1000, duration=0.2)
centred = pytest.mark.parametrize("centred", [True, False], ids=["centre", "start"])


def target(speed: float, radar: ref.Radar) -> tuple[np.ndarray, np.ndarray]:
    """Delay track [M] and slow-time signal [M] of one point."""
    delay = 2 * (1.5 + speed * radar.times) / ref.C
    return delay, ref.slow_time(delay[None], np.ones((1, delay.size)), radar)


@centred
@pytest.mark.parametrize("speed", [-2.5, -0.4, 0.4, 2.5])
@pytest.mark.parametrize("mti", [True, False])
def test_a_target_of_constant_velocity_stops(centred, speed, mti):
    """To the zero bin goes what a target at rest would leave there: all but some range walk."""
    radar = ref.Radar(**asdict(RADAR) | {"centred": centred})
    delay, y = target(speed, radar)
    x = compensate(ref.mti(y) if mti else y, delay, Waveform(**asdict(radar)).f0)
    spectrum = np.abs(np.fft.fft(x)) ** 2
    assert spectrum.argmax() == 0
    # The ghosts of the start reference hold up to half of the energy (test_half_band_sum).
    assert spectrum[0] > (0.99 if centred else 0.5) * spectrum.sum()


def test_the_later_pulse_of_each_pair_counts():
    """Seen where the track jumps between the pulses of one pair."""
    track = np.array([3e-9, 3e-9, 5e-9, 5e-9])
    f0 = 1.1e9
    turned = np.exp(2j * np.pi * f0 * 2e-9)
    assert compensate(np.ones(3, complex), track, f0) == pytest.approx([1, turned, turned])
    assert compensate(np.ones(4, complex), track, f0) == pytest.approx([1, 1, turned, turned])


def test_compensation_changes_phases_only():
    x = np.random.default_rng(0).standard_normal((50, 2)).view(complex)[:, 0]
    track = np.random.default_rng(1).uniform(1e-9, 5e-8, 51)
    assert np.abs(compensate(x, track, 77e9)) == pytest.approx(np.abs(x), rel=1e-14)
    assert np.array_equal(compensate(x, np.full(51, 2e-8), 77e9), x)
