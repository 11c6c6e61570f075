"""Maps in blocks of frames: the same as at once, wherever the blocks end."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.processing import frames as frames_module
from radhar_cli.processing import fsst, image, stft
from radhar_cli.processing.entropy import entropy_bits
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.image import levels
from radhar_cli.processing.long_map import LongMap, joined

RANGE_DB = 50.0
# Reduced in height first and in width then, powers differ by float32's rounding: 1e-7 of them, of
# 51 levels a decade, turn over where they lie that close between two levels.
FLIPS = 1e-4
ENTROPY = 1e-12


def noisy_chirp(count: int, seed: int) -> np.ndarray:
    """A chirp whose strength varies over 60 dB, in noise 40 dB below."""
    rng, t = np.random.default_rng(seed), np.linspace(0, 1, count)
    chirp = 10 ** (-3 * t) * np.exp(2j * np.pi * 0.1 * count * t**2)
    return chirp + 1e-2 * rng.standard_normal((count, 2)).view(complex)[:, 0]


def power_blocks(kind: str, x: np.ndarray, frames: Frames, threshold: float) -> list[np.ndarray]:
    spectra = stft.spectra(x, frames)
    if kind == "stft":
        return [stft.power_map(v) for v in spectra]
    return list(fsst.power_blocks(x, spectra, frames, threshold))


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
        patch.setattr(frames_module, "BLOCK_COEFFICIENTS", block * length)
        blocks = power_blocks(kind, x, frames, threshold)
    assert [b.shape[1] for b in blocks[:-1]] == [block] * (len(blocks) - 1)
    assert sum(b.shape[1] for b in blocks) == count
    assert np.array_equal(joined(iter(blocks), count), whole)
    long = LongMap(iter(blocks), count, size)
    assert long.entropy_bits == pytest.approx(entropy_bits(whole), rel=ENTROPY, abs=ENTROPY)
    right, found = levels(whole, size, RANGE_DB).astype(int), long.levels(RANGE_DB)
    assert np.abs(found - right).max() <= 1
    assert np.sum(found != right) <= max(1, FLIPS * right.size)


@pytest.mark.parametrize("size", [(256, 256), (64, 300), (300, 16)])
@pytest.mark.parametrize("shape", [(2000, 90), (51, 700), (101, 20)])
def test_few_pixels_flip(shape, size):
    power = np.random.default_rng(0).exponential(size=shape) * np.geomspace(1e-5, 1, shape[1])
    found = LongMap((power[:, i : i + 7] for i in range(0, shape[1], 7)), shape[1], size)
    assert np.mean(found.levels(RANGE_DB) != levels(power, size, RANGE_DB)) <= FLIPS


def test_how_many_columns_are_weighed_at_once_does_not_matter(monkeypatch):
    power = np.random.default_rng(0).exponential(size=(20, 70))
    whole = LongMap(iter([power]), 70, (16, 24)).levels(RANGE_DB)
    monkeypatch.setattr(image, "AT_ONCE", 24 * 9)
    assert np.array_equal(LongMap(iter([power]), 70, (16, 24)).levels(RANGE_DB), whole)


@pytest.mark.parametrize("scale", [5e-324, 1e-300, 1e-30, 1e30, 1e300])
@pytest.mark.parametrize("order", [1, -1])
def test_scale_does_not_matter(scale, order):
    """Not of the whole nor of a block: a loud one may come last, and only then be known."""
    rng = np.random.default_rng(0)
    power = rng.integers(1, 40000, (30, 20)) * 1.0
    power[:, ::order][:, :10] = np.floor(power[:, ::order][:, :10] / 1000)
    power *= scale
    long = LongMap((power[:, i : i + 3] for i in range(0, 20, 3)), 20, (16, 16))
    assert long.entropy_bits == pytest.approx(entropy_bits(power), rel=ENTROPY)
    right = levels(power, (16, 16), RANGE_DB).astype(int)
    assert np.abs(long.levels(RANGE_DB) - right).max() <= 1


@pytest.mark.parametrize("loud", [0, 2, 4])
def test_a_block_beyond_all_bounds_of_the_others(loud):
    """1e-310 beside 1e300, and blocks of nothing."""
    power = np.zeros((8, 5))
    power[3] = 1e-310
    power[:, 1] = 0
    power[5, loud] = 1e300
    long = LongMap((power[:, [i]] for i in range(5)), 5, (8, 5))
    assert long.entropy_bits == 0
    assert np.array_equal(long.levels(RANGE_DB), levels(power, (8, 5), RANGE_DB))


def test_a_map_of_nothing_is_black_and_has_no_entropy():
    long = LongMap(iter([np.zeros((9, 2))] * 3), 6, (4, 4))
    assert long.entropy_bits == 0
    assert not long.levels(RANGE_DB).any()


@pytest.mark.parametrize(("threshold", "passes"), [(1e-3, 2), (0.0, 1)])
def test_only_a_threshold_takes_a_second_pass(monkeypatch, threshold, passes):
    """And an ordinary recording takes one whatever its threshold."""
    calls = []
    original = stft.spectrum

    def noted(x, frames, fft_length=None):
        calls.append(frames.count(x.size))
        return original(x, frames, fft_length)

    monkeypatch.setattr(stft, "spectrum", noted)
    frames, x = Frames(20, 2), noisy_chirp(100, 0)
    power_blocks("fsst", x, frames, threshold)
    assert calls == [41]
    calls.clear()
    monkeypatch.setattr(frames_module, "BLOCK_COEFFICIENTS", 10 * 20)
    power_blocks("fsst", x, frames, threshold)
    assert calls == [10, 10, 10, 10, 1] * passes


@pytest.mark.parametrize("length", [40, 41])
def test_columns_add_up_to_the_signal_at_every_sample(monkeypatch, length):
    """Hop 1 in blocks: sum_k T = L g[L//2] x[l + L//2], power by power where one bin holds it."""
    monkeypatch.setattr(frames_module, "BLOCK_COEFFICIENTS", 33 * length)
    frames, x = Frames(length, 1), noisy_chirp(500, 3)
    spectra = stft.spectra(x, frames)
    sums, first = [], 0
    for v in spectra:
        span = frames.span(slice(first, first + len(v)))
        sums.append(fsst.synchrosqueeze(x[span], v, frames, 0.0, 0.0).sum(axis=1))
        first += len(v)
    middle = length // 2
    right = length * frames.window[middle] * x[middle : middle + first]
    assert first == 500 - length + 1
    assert np.abs(np.concatenate(sums) - right).max() < 1e-12 * np.abs(right).max()
