"""Maps in blocks of frames: the same wherever the blocks end, in double and in single precision."""

import numpy as np
import pytest
from helpers.signals import signal
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.errors import RadharError
from radhar_cli.processing import fsst
from radhar_cli.processing import stft as stft_module
from radhar_cli.processing.entropy import entropy_bits
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.image import levels, reduced, reduced_map
from radhar_cli.processing.stft import Stft

RANGE_DB = 50.0
# Powers that are summed up in another order differ by float32's rounding: 1e-7 of them, of 51
# levels a decade, turn over where they lie that close between two levels.
FLIPS = 1e-4
ENTROPY = 1e-12


def noisy_chirp(count: int, seed: int) -> np.ndarray:
    """A chirp whose strength varies over 60 dB, in noise 40 dB below."""
    rng, t = np.random.default_rng(seed), np.linspace(0, 1, count)
    chirp = 10 ** (-3 * t) * np.exp(2j * np.pi * 0.1 * count * t**2)
    return chirp + 1e-2 * rng.standard_normal((count, 2)).view(complex)[:, 0]


def power_blocks(
    kind: str, x: np.ndarray, frames: Frames, threshold: float = 1e-3, single: bool = False
) -> list[np.ndarray]:
    stft = Stft(signal(x), frames, single=single)
    return list(stft.power_blocks() if kind == "stft" else fsst.power_blocks(stft, threshold))


@settings(max_examples=60, deadline=None)
@given(
    kind=st.sampled_from(["stft", "fsst"]),
    length=st.integers(8, 41),
    hop=st.integers(1, 45),
    count=st.integers(1, 40),
    rest=st.integers(0, 44),
    block=st.integers(1, 45),
    threshold=st.sampled_from([0.0, 1e-3, 0.3]),
    size=st.tuples(st.integers(2, 60), st.integers(2, 60)),
)
def test_blocks_are_the_whole(kind, length, hop, count, rest, block, threshold, size):
    """One frame, odd windows, a last block that is shorter: identical power, the same image."""
    frames = Frames(length, hop)
    x = noisy_chirp(length + (count - 1) * hop + rest % hop, count)
    (whole,) = power_blocks(kind, x, frames, threshold)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(stft_module, "BLOCK_COEFFICIENTS", block * length)
        blocks = power_blocks(kind, x, frames, threshold)
    assert [len(b) for b in blocks[:-1]] == [block] * (len(blocks) - 1)
    assert sum(map(len, blocks)) == count
    assert np.array_equal(np.concatenate(blocks), whole)
    found, right = reduced(blocks, count, size), reduced([whole], count, size)
    assert found.entropy == pytest.approx(entropy_bits(whole), rel=ENTROPY, abs=ENTROPY)
    one, other = (levels(r.cells, RANGE_DB).astype(int) for r in (found, right))
    assert np.abs(one - other).max() <= 1
    assert np.sum(one != other) <= max(1, FLIPS * one.size)


@pytest.mark.parametrize(("length", "hop"), [(200, 20), (51, 5)])
def test_float32_is_enough_for_images_of_the_stft(length, hop):
    """Entropies to 1e-4 bits, and one pixel in 1e4 by one level."""
    frames, x = Frames(length, hop), noisy_chirp(10 * length, 1)
    count = 9 * length // hop + 1
    exact, single = (
        reduced(power_blocks("stft", x, frames, single=single), count, (128, 128))
        for single in (False, True)
    )
    assert single.entropy == pytest.approx(exact.entropy, abs=1e-4)
    off = np.abs(levels(single.cells, RANGE_DB) - levels(exact.cells, RANGE_DB).astype(int))
    assert off.max() <= 1
    assert np.mean(off > 0) <= FLIPS


@pytest.mark.parametrize("kind", ["stft", "fsst"])
@pytest.mark.parametrize("single", [False, True])
@pytest.mark.parametrize("scale", [2.0**-1060, 2.0**-600, 2.0**-70, 2.0**70, 2.0**1000])
def test_the_scale_of_a_signal_does_not_matter(kind, single, scale):
    """No square overflows or vanishes; whole numbers, so that the smallest lose no digit."""
    x = np.round(noisy_chirp(400, 2) * 1000)
    frames = Frames(40, 4)
    right = np.concatenate(power_blocks(kind, x, frames, single=single))
    found = np.concatenate(power_blocks(kind, x * scale, frames, single=single))
    found *= right.max() / found.max()
    assert found == pytest.approx(right, rel=1e-6)


def test_power_has_its_scale_back_with_the_exponent():
    x, frames = 3e-9 * noisy_chirp(400, 2), Frames(40, 4)
    stft = Stft(signal(x), frames)
    (power,) = stft.power_blocks()
    right = np.abs(np.fft.fft(x[:40] * frames.window)) ** 2
    assert np.ldexp(power[0], 2 * stft.exponent) == pytest.approx(np.fft.fftshift(right))


@pytest.mark.parametrize("kind", ["stft", "fsst"])
@pytest.mark.parametrize("single", [False, True])
def test_a_silent_signal_is_a_map_of_zeros(kind, single):
    blocks = power_blocks(kind, np.zeros(100, complex), Frames(20, 2), single=single)
    found = reduced(blocks, 41, (8, 8))
    assert found.entropy == 0
    assert not levels(found.cells, RANGE_DB).any()


@pytest.mark.parametrize("broken", [np.nan, np.inf])
def test_a_broken_signal_is_refused(broken):
    x = noisy_chirp(100, 0)
    x[50] = broken
    with np.errstate(invalid="ignore"), pytest.raises(RadharError, match="should be finite"):
        reduced(power_blocks("stft", x, Frames(20, 2)), 41, (8, 8))


@pytest.mark.parametrize("size", [(256, 256), (64, 300), (300, 16)])
@pytest.mark.parametrize("shape", [(2000, 90), (51, 700), (101, 20)])
def test_few_pixels_flip(shape, size):
    power = np.random.default_rng(0).exponential(size=shape) * np.geomspace(1e-5, 1, shape[1])
    found = reduced((power.T[i : i + 7] for i in range(0, shape[1], 7)), shape[1], size)
    right = reduced_map(power, size)
    assert np.mean(levels(found.cells, RANGE_DB) != levels(right.cells, RANGE_DB)) <= FLIPS


@pytest.mark.parametrize(("threshold", "passes"), [(1e-3, 2), (0.0, 1)])
def test_only_a_threshold_takes_a_second_pass(monkeypatch, threshold, passes):
    """And a recording of one block none, whatever its threshold: its spectrum is held."""
    transforms = []
    original = Stft.transform

    def noted(stft, row, block, window):
        if window is stft.frames.window:
            transforms.append(block.stop - block.start)
        return original(stft, row, block, window)

    monkeypatch.setattr(Stft, "transform", noted)
    frames, x = Frames(20, 2), noisy_chirp(100, 0)
    power_blocks("fsst", x, frames, threshold)
    assert transforms == [41]
    transforms.clear()
    monkeypatch.setattr(stft_module, "BLOCK_COEFFICIENTS", 10 * 20)
    power_blocks("fsst", x, frames, threshold)
    assert transforms == [10, 10, 10, 10, 1] * passes


@pytest.mark.parametrize("length", [40, 41])
def test_columns_add_up_to_the_signal_at_every_sample(monkeypatch, length):
    """Hop 1 in blocks: sum_k T = L g[L//2] x[l + L//2]."""
    monkeypatch.setattr(stft_module, "BLOCK_COEFFICIENTS", 33 * length)
    frames, x = Frames(length, 1), noisy_chirp(500, 3)
    stft, sums = Stft(signal(x), frames), []
    for block in stft.blocks:
        v, slope = (stft.transform(x, block, g) for g in (frames.window, frames.window_slope))
        sums.append(fsst.synchrosqueeze(v, slope, 0.0).sum(axis=1))
    middle = length // 2
    right = length * frames.window[middle] * x[middle : middle + 500 - length + 1]
    found = np.concatenate(sums) * 2.0**stft.exponent
    assert np.abs(found - right).max() < 1e-12 * np.abs(right).max()
