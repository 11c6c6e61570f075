"""Short-time Fourier transform of the slow-time signal."""

import numpy as np
import pytest
from helpers import reference as ref
from helpers.signals import signal

from radhar_cli.processing.frames import Frames
from radhar_cli.processing.stft import Stft

frame_sizes = pytest.mark.parametrize(("length", "hop"), [(16, 3), (17, 3), (8, 1), (21, 25)])


def random_signal(length: int) -> np.ndarray:
    return np.random.default_rng(0).standard_normal((length, 2)).view(complex)[:, 0]


def power(x: np.ndarray, frames: Frames, fft_length: int | None = None) -> np.ndarray:
    """|X|^2 [frequency, frames]."""
    stft = Stft(signal(x), frames, fft_length)
    (block,) = stft.power_blocks()
    return np.ldexp(block.T, 2 * stft.exponent)


@frame_sizes
@pytest.mark.parametrize("padding", [None, 0, 1, 10])
def test_matches_the_definition(length, hop, padding):
    x = random_signal(60)
    fft_length = None if padding is None else length + padding
    right = ref.stft(x, length, hop, fft_length)
    found = power(x, Frames(length, hop), fft_length)
    assert found.shape == (fft_length or length, (60 - length) // hop + 1)
    assert found == pytest.approx(right, rel=1e-9, abs=1e-9)


@frame_sizes
def test_energy_is_kept(length, hop):
    """Parseval: sum_k |X|^2 = N sum_n |x g|^2, frame by frame, padded or not."""
    x, frames = random_signal(60), Frames(length, hop)
    cut = np.lib.stride_tricks.sliding_window_view(x, length)[::hop]
    energy = np.sum(np.abs(cut * frames.window) ** 2, axis=1)
    for size in (length, 2 * length + 1):
        assert power(x, frames, size).sum(axis=0) == pytest.approx(size * energy, rel=1e-12)


@frame_sizes
def test_the_time_of_a_frame_is_the_middle_of_its_pulses(length, hop):
    stft = Stft(signal(random_signal(60)), Frames(length, hop))
    pulses = stft.signal.times.times(np.arange(60))
    middles = [pulses[start : start + length].mean() for start in stft.starts]
    assert stft.time.values == pytest.approx(middles, rel=1e-12, abs=1e-12)


@pytest.mark.parametrize("place", range(0, 40, 3))
def test_an_impulse_is_flat_and_weighed_by_the_window(place):
    frames = Frames(16, 5)
    x = np.zeros(40, complex)
    x[place] = 1j
    found = power(x, frames)
    for column, start in enumerate(ref.frame_starts(40, 16, 5)):
        inside = 0 <= place - start < 16
        level = frames.window[place - start] ** 2 if inside else 0.0
        assert found[:, column] == pytest.approx(np.full(16, level), abs=1e-14)


@pytest.mark.parametrize("length", [20, 21])
@pytest.mark.parametrize("doppler_bin", [-10, -9, -3, 0, 1, 9])
def test_zero_doppler_is_in_the_middle_and_the_lowest_first(length, doppler_bin):
    x = np.exp(2j * np.pi * doppler_bin * np.arange(100) / length)
    found = power(x, Frames(length, 4))
    assert (found.argmax(axis=0) == length // 2 + doppler_bin).all()


@pytest.mark.parametrize("speed", [-1.7, -0.3, 0.3, 1.7])
@pytest.mark.parametrize("fft_length", [None, 333])
def test_a_radial_velocity_lands_in_its_doppler_bin(speed, fft_length):
    """From the beat matrix on: f_D = -2 v f0/c, so approaching (v < 0) is positive."""
    radar = ref.Radar(24e9, 1e9, adc_rate=1e6, prf=1000, duration=0.4)
    delay = 2 * (1.5 + speed * radar.times) / ref.C
    x = ref.mti(ref.slow_time(delay[None], np.ones((1, delay.size)), radar))
    frames = Frames(100, 10)
    found = power(x, frames, fft_length)
    size = fft_length or frames.length
    doppler = (found.argmax(axis=0) - size // 2) * radar.prf / size
    # Half a bin; range walk adds next to nothing with the centre reference.
    assert np.abs(doppler - -2 * speed * radar.f0 / ref.C).max() <= 0.51 * radar.prf / size
    assert (np.sign(doppler) == -np.sign(speed)).all()
