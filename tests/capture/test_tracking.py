"""Tracking the torso in range-Doppler maps: gaps, ambiguous velocities, limbs."""

from dataclasses import replace

import numpy as np
import pytest

from radhar_cli.capture.tracking import TorsoTrack, hann_in_range, peaks, track_torso
from radhar_cli.echo.beat import beat_matrix
from radhar_cli.numerics.arrays import Complex, Float
from radhar_cli.processing.range_compression import range_compression
from radhar_cli.radar.fmcw import SPEED_OF_LIGHT, Waveform
from radhar_cli.radar.pulse_times import PulseTimes

WAVEFORM = Waveform(fc=24e9, bandwidth=1e9, chirp=40e-6, adc_rate=5e6, prf=1000.0, duration=4.0)
LENGTH = 160


def bins_of(
    ranges: Float, amplitude: Float, w: Waveform = WAVEFORM, noise: float = 0.1, seed: int = 0
) -> Complex:
    """Range bins [1, K, M] of points at ranges [I, M] with amplitudes [I, M]."""
    delay = 2 * ranges / SPEED_OF_LIGHT
    beat = beat_matrix(delay, amplitude, w)
    rng = np.random.default_rng(seed)
    pairs = rng.standard_normal((2, *beat.shape))
    noisy = beat + noise * (pairs[0] + 1j * pairs[1])
    return range_compression(noisy, replace(w, centred=False))[None]


def track(bins: Complex, w: Waveform = WAVEFORM) -> TorsoTrack | None:
    one = PulseTimes(np.zeros(1), np.zeros(1, np.int64), bins.shape[2], w.prf)
    return track_torso(bins, one, w)


def times(w: Waveform = WAVEFORM) -> Float:
    return np.arange(w.n_pulses) / w.prf


def rms(found: TorsoTrack, t: Float, true: Float) -> float:
    return float(np.sqrt(np.mean((found.range_at(t) - true) ** 2)))


@pytest.mark.parametrize("speed", [-1.5, -0.4, 0.7, 2.0])
def test_a_point_is_followed(speed: float) -> None:
    t = times()
    r = 6 + speed * (t - 2)
    found = track(bins_of(r[None], np.ones((1, t.size))))
    assert found is not None
    assert rms(found, t, r) < 0.03, "a fifth of a range bin"
    assert np.abs(found.velocity - speed).max() < 0.08, "two cells of velocity"
    assert found.confidence.mean() > 0.9
    assert np.allclose(found.delay_at(t), 2 * found.range_at(t) / SPEED_OF_LIGHT)


def test_limbs_do_not_divert_the_track() -> None:
    """A limb that swings by 0.3 m at 2 Hz is faster than a torso turns, though as bright."""
    t = times()
    torso = 3 + 1.2 * t
    limb = torso + 0.3 * np.sin(2 * np.pi * 2 * t)
    found = track(bins_of(np.stack([torso, limb]), np.ones((2, t.size))))
    assert found is not None
    assert rms(found, t, torso) < 0.08


def test_gaps_are_bridged_with_low_confidence() -> None:
    t = times()
    r = 5 + np.sin(0.8 * t)
    there = ((t < 1.5) | (t > 2.2)).astype(float)
    found = track(bins_of(r[None], there[None]))
    assert found is not None
    assert rms(found, t, r) < 0.15
    hidden = (found.time > 1.6) & (found.time < 2.1)
    assert (found.confidence[hidden] == 0).all()
    assert found.confidence[~hidden].mean() > 0.6


def test_ambiguous_velocities_are_told_apart_by_the_range() -> None:
    """At 250 Hz and 24 GHz the Doppler of 1.5 m/s is that of -0.06 m/s."""
    w = Waveform(fc=24e9, bandwidth=1e9, chirp=40e-6, adc_rate=5e6, prf=250.0, duration=12.0)
    t = times(w)
    r = 2 + 0.9 * t
    found = track(bins_of(r[None], np.ones((1, t.size)), w), w)
    assert found is not None
    assert w.highest_speed < 0.9
    assert np.abs(found.velocity[2:-2] - 0.9).max() < 0.1


@pytest.mark.parametrize("seed", range(3))
def test_nothing_is_found_in_noise(seed: int) -> None:
    t = times()
    assert track(bins_of(np.full((1, t.size), 3.0), np.zeros((1, t.size)), seed=seed)) is None


def test_silence_is_no_torso() -> None:
    assert track(np.zeros((1, 8, 400), complex)) is None


def test_a_peak_lies_between_its_bins() -> None:
    """The parabola finds a range to a tenth of a bin."""
    w = WAVEFORM
    for off in (0.0, 0.3, 0.5, 0.8):
        r = np.full((1, LENGTH), (20 + off) * w.range_step)
        r += np.arange(LENGTH) / w.prf * 0.8
        bins = hann_in_range(bins_of(r, np.ones((1, LENGTH)), w, 0.0))
        spectrum = np.fft.fft(bins[0] * np.hanning(LENGTH), axis=1)
        power = np.abs(np.fft.fftshift(spectrum, axes=1)[:, ::-1]) ** 2
        speeds = np.arange(1 - LENGTH // 2, LENGTH // 2 + 1) * 2 * w.highest_speed / LENGTH
        found = peaks(power, w.range_axis(), speeds)
        middle = r[0, LENGTH // 2]
        assert found.range[0] == pytest.approx(middle, abs=0.1 * w.range_step)
        assert found.velocity[0] == pytest.approx(0.8, abs=0.04)


def test_a_person_who_leaves_is_not_found_elsewhere() -> None:
    """Something faint that sways in place, 4 m from where the person was last, is no person."""
    t = times()
    r = 9 + 1.4 * t
    gone = (t < 2.5).astype(float)
    ghost = 8 + 0.02 * np.sin(2 * np.pi * 0.7 * t)
    later = 0.05 * (t > 2.7)
    found = track(bins_of(np.stack([r, ghost]), np.stack([gone, later]), noise=0.02))
    assert found is not None
    before = t < 2.4
    assert np.abs(found.range_at(t[before]) - r[before]).max() < 0.1
    assert np.abs(found.velocity).max() < 3
    assert (found.confidence[found.time > 2.8] == 0).all()


def test_a_velocity_is_believed_within_its_cell() -> None:
    """Frames of 16 ms at 2 GHz have cells of 4.7 m/s: a walker seems to rest in each of them."""
    w = Waveform(fc=2e9, bandwidth=1e9, chirp=40e-6, adc_rate=5e6, prf=4000.0, duration=0.16)
    frames = PulseTimes(0.2 * np.arange(10), 64 * np.arange(10), w.n_pulses, w.prf)
    t = frames.times(np.arange(w.n_pulses))
    walker, rest = 3 + 1.5 * t, np.full(t.size, 2.0)
    bins = bins_of(
        np.stack([walker, rest]), np.stack([np.ones(t.size), np.full(t.size, 0.8)]), w, 0.01
    )
    found = track_torso(bins, frames, w)
    assert found is not None
    assert rms(found, t, walker) < 0.1
