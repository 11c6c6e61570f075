"""Fourier synchrosqueezed transform."""

import numpy as np
import pytest
from helpers import reference as ref
from helpers.signals import signal

from radhar_cli.numerics.accelerators import installed
from radhar_cli.processing import fsst
from radhar_cli.processing import stft as stft_module
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.stft import Stft

lengths = pytest.mark.parametrize("length", [20, 21, 51])
ROUNDING = 1e-12


def squeezed(x: np.ndarray, frames: Frames, threshold: float = 1e-3) -> np.ndarray:
    """T [frames, L]."""
    stft = Stft(signal(x), frames)
    (block,) = stft.blocks
    v, slope = (stft.transform(x, block, g) for g in (frames.window, frames.window_slope))
    return fsst.synchrosqueeze(v, slope, threshold * np.abs(v).max()) * 2.0**stft.exponent


def power_map(x: np.ndarray, frames: Frames) -> np.ndarray:
    """|T|^2 [frequency, frames]."""
    stft = Stft(signal(x), frames)
    (block,) = fsst.power_blocks(stft, 1e-3)
    return np.ldexp(block.T, 2 * stft.exponent)


def random_signal(length: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal((length, 2)).view(complex)[:, 0]


def middles(x: np.ndarray, frames: Frames) -> np.ndarray:
    """L g[L//2] x[l hop + L//2], to which the columns add up."""
    middle = frames.length // 2
    starts = np.array(ref.frame_starts(x.size, frames.length, frames.hop))
    return frames.length * frames.window[middle] * x[starts + middle]


@lengths
@pytest.mark.parametrize("threshold", [0.0, 1e-3, 0.1, 0.5])
def test_matches_the_definition(length, threshold):
    x = random_signal(70)
    right = ref.fsst(x, length, 4, threshold)
    found = squeezed(x, Frames(length, 4), threshold)
    assert np.abs(found.T - right).max() < ROUNDING * np.abs(right).max()


@lengths
def test_columns_add_up_to_the_signal(length):
    """With threshold 0: the inverse of a transform whose window is 1/L at L//2."""
    x, frames = random_signal(200), Frames(length, 3)
    right = middles(x, frames)
    found = squeezed(x, frames, 0.0).sum(axis=1)
    assert np.abs(found - right).max() < ROUNDING * np.abs(right).max()


def test_the_default_threshold_costs_little():
    """1e-4 to 2e-2 of the signal, for one whose strength varies by 60 dB."""
    t = np.linspace(0, 1, 5000)
    x = 10 ** (-3 * t) * np.exp(2j * np.pi * 80 * np.sin(3 * t)) + 1e-4 * random_signal(5000)
    frames = Frames(500, 50)
    right = middles(x, frames)
    error = np.linalg.norm(squeezed(x, frames).sum(axis=1) - right) / np.linalg.norm(right)
    assert 1e-4 < error < 2e-2


@pytest.mark.parametrize("length", [50, 51])
@pytest.mark.parametrize(("first", "second"), [(10.0, -12.0), (10.3, -11.7), (-24.4, 3.4)])
def test_two_tones_become_two_bins(length, first, second):
    """Each its nearest bin with its whole power, in every frame; approaching above the middle."""
    n = np.arange(300)
    tones = [a * np.exp(2j * np.pi * f * n / length) for a, f in ((1.0, first), (0.5, second))]
    frames = Frames(length, 5)
    found = power_map(sum(tones), frames)
    bins = [length // 2 + round(first), length // 2 + round(second)]
    right = (length * frames.window[length // 2]) ** 2
    assert found[bins[0]] == pytest.approx(np.full(found.shape[1], right), rel=0.01)
    assert found[bins[1]] == pytest.approx(np.full(found.shape[1], right / 4), rel=0.01)
    assert np.delete(found, bins, axis=0).max() < 1e-3 * right


@lengths
@pytest.mark.parametrize("rate", [0.5, 2.0])
def test_it_sharpens_a_gentle_chirp(length, rate):
    """Of the power of a frame, the strongest bin holds 60 % before and 85 % after at least."""
    chirp = np.exp(1j * np.pi * rate * (np.arange(6 * length) / length) ** 2)
    frames = Frames(length, 4)
    (before,) = Stft(signal(chirp), frames).power_blocks()
    before, after = before.T, power_map(chirp, frames)

    def strongest_share(power):
        return np.mean(power.max(axis=0) / power.sum(axis=0))

    assert strongest_share(before) < 0.61
    assert strongest_share(after) > 0.85
    assert ref.entropy_bits(after) < ref.entropy_bits(before) - 0.9


@pytest.mark.parametrize("length", [20, 21])
def test_map_is_laid_out_like_that_of_the_stft(length):
    for k in range(-(length // 2), (length + 1) // 2):
        x = np.exp(2j * np.pi * k * np.arange(100) / length)
        frames = Frames(length, 4)
        found = power_map(x, frames)
        assert found.shape == (length, (100 - length) // 4 + 1)
        assert (found.argmax(axis=0) == length // 2 + k).all()


def test_the_threshold_is_relative_to_the_whole_map():
    """A quiet tone 30 dB down lives at 1e-3 and is gone at 0.1, wherever its frame is."""
    n, frames = np.arange(400), Frames(40, 10)
    x = np.where(n < 200, 1.0, 10**-1.5) * np.exp(2j * np.pi * 7 * n / 40)
    quiet = slice(20, None)
    assert squeezed(x, frames, 1e-3)[quiet].any(axis=1).all()
    assert not squeezed(x, frames, 0.1)[quiet].any()
    assert squeezed(x, frames, 0.1)[:10].any(axis=1).all()


def test_the_signal_it_is_given_stays_as_it_was():
    x, frames = random_signal(60), Frames(20, 2)
    stft, kept = Stft(signal(x), frames), x.copy()
    list(fsst.power_blocks(stft, 1e-3))
    list(stft.power_blocks())
    assert np.array_equal(x, kept)


@pytest.mark.skipif(installed("numba") is None, reason="needs radhar[fast]")
@pytest.mark.parametrize("threshold", [0.0, 1e-3, 0.1])
@pytest.mark.parametrize("length", [60, 61])
def test_compiled_sums_are_those_of_numpy(length: int, threshold: float, monkeypatch) -> None:
    """But for the few coefficients on the border between two bins; in blocks and of channels."""
    n, frames = np.arange(3000), Frames(length, 4)
    walker = np.exp(2j * np.pi * (0.2 * n / length + 3 * np.sin(n / 100)))
    x = np.stack([walker + 1e-2 * random_signal(n.size, seed) for seed in range(2)])[:, None]
    stft = Stft(signal(x[0, 0]).with_samples(x), frames, single=True)
    monkeypatch.setattr(stft_module, "BLOCK_COEFFICIENTS", 300 * length)
    maps = []
    for least in (np.inf, 1):
        monkeypatch.setattr(fsst, "MIN_COEFFICIENTS", least)
        maps.append(np.concatenate(list(fsst.power_blocks(stft, threshold))))
    plain, compiled = maps
    assert len(stft.blocks) > 2
    assert compiled.dtype == plain.dtype == np.float32
    differ = np.abs(compiled - plain) > 1e-3 * plain + 1e-8 * plain.max()
    assert np.mean(differ) < 1e-3
    assert compiled.sum() == pytest.approx(plain.sum(), rel=1e-4)


@pytest.mark.skipif(installed("numba") is None, reason="needs radhar[fast]")
def test_compiled_sums_of_nothing_are_nothing(monkeypatch) -> None:
    monkeypatch.setattr(fsst, "MIN_COEFFICIENTS", 1)
    stft = Stft(signal(np.zeros(400, complex)), Frames(50, 5), single=True)
    assert not np.concatenate(list(fsst.power_blocks(stft, 1e-3))).any()
