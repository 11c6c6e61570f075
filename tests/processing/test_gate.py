"""A range gate: which bins a frame shows, and the incoherent sum over them."""

from dataclasses import replace

import numpy as np
import pytest
from helpers.signals import signal
from hypothesis import given, settings
from hypothesis import strategies as st

from radhar_cli.processing import stft as stft_module
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.gate import Gate, around, interval
from radhar_cli.processing.signal import Signal
from radhar_cli.processing.stft import Stft

FRAMES, COUNT = Frames(32, 5), 34


def noise(bins: int, pulses: int = 200) -> Signal:
    x = np.random.default_rng(bins).standard_normal((bins, pulses, 2)).view(complex)[..., 0]
    return signal(x, 100.0)


def by_definition(x: np.ndarray, gate: Gate, length: int, magnitudes: bool) -> np.ndarray:
    """sum_k |X_k|^p [frames, N], k over the bins of each frame."""
    window = np.sin(np.pi * (np.arange(32) + 0.5) / 32) ** 2
    rows = []
    for start, first in zip(range(0, x.shape[1] - 31, 5), gate.first, strict=True):
        cut = x[first : first + gate.count, start : start + 32] * window
        size = np.abs(np.fft.fftshift(np.fft.fft(cut, length, axis=1), axes=1))
        rows.append(size.sum(axis=0) ** 2 if magnitudes else (size**2).sum(axis=0))
    return np.array(rows)


@pytest.mark.parametrize("magnitudes", [False, True])
@pytest.mark.parametrize("length", [32, 100])
@pytest.mark.parametrize("block", [10**6, 200])
@pytest.mark.parametrize("single", [False, True])
def test_the_sum_over_the_bins_of_each_frame(monkeypatch, magnitudes, length, block, single):
    """The bins wander: up, down, and at the end far away at once."""
    monkeypatch.setattr(stft_module, "BLOCK_COEFFICIENTS", block)
    signals = noise(20)
    first = np.clip(np.rint(8 + 8 * np.sin(np.arange(COUNT) / 4)), 0, 16).astype(int)
    first[-3:] = 0
    gate = Gate(first, 4)
    found = Stft(signals, FRAMES, length, single, gate, magnitudes)
    power = np.concatenate(list(found.power_blocks())) * 4.0**found.exponent
    right = by_definition(signals.x[0], gate, length, magnitudes)
    assert power == pytest.approx(right, rel=1e-4 if single else 1e-10, abs=1e-6 * right.max())


def test_only_the_bins_that_are_shown_need_be_there():
    signals, gate = noise(20), Gate(np.full(COUNT, 7), 5)
    some = replace(signals, x=signals.x[:, gate.bins], ranges=signals.ranges[gate.bins], first=7)
    whole, part = (Stft(s, FRAMES, gate=gate) for s in (signals, some))
    scale = 4.0 ** (whole.exponent - part.exponent)
    found, right = (np.concatenate([*one.power_blocks()]) for one in (part, whole))
    assert found == pytest.approx(scale * right, rel=1e-12)


def test_powers_of_channels_are_added_up():
    signals, other, gate = noise(20), noise(21), Gate(np.full(COUNT, 7), 5)
    both = replace(signals, x=np.concatenate([signals.x, other.x[:, :20]]))
    powers = []
    for one in (both, signals, replace(other, x=other.x[:, :20])):
        stft = Stft(one, FRAMES, gate=gate)
        powers.append(np.concatenate([*stft.power_blocks()]) * 4.0**stft.exponent)
    assert powers[0] == pytest.approx(powers[1] + powers[2], rel=1e-12)


def test_one_bin_for_all_frames_is_its_own_stft():
    signals, gate = noise(3), Gate(np.array([1]), 1)
    found = Stft(signals, FRAMES, gate=gate)
    power = np.concatenate(list(found.power_blocks())) * 4.0**found.exponent
    every = Gate(np.ones(COUNT, int), 1)
    assert power == pytest.approx(by_definition(signals.x[0], every, 32, False))


@given(
    torso=st.lists(st.floats(-5, 60), min_size=1, max_size=20),
    within=st.floats(1e-3, 40),
    step=st.floats(0.01, 2),
    bins=st.integers(1, 60),
)
@settings(max_examples=200, deadline=None)
def test_bins_around_the_torso(torso, within, step, bins):
    """As many in every frame, all of them on the axis, the torso's in their middle where it can."""
    ranges = np.arange(bins) * step
    gate = around(np.array(torso), within, ranges)
    assert 1 <= gate.count <= bins
    assert gate.first.min() >= 0
    assert gate.first.max() + gate.count <= bins
    for first, at in zip(gate.first, torso, strict=True):
        shown = ranges[first : first + gate.count]
        assert np.all(np.diff(shown) > 0)
        if bins > 1 and within <= at <= ranges[-1] - within:
            assert np.abs(shown - at).max() <= within + 0.5 * step + 1e-9


def test_the_interval_of_the_measured_data_at_5_8_ghz():
    """21 bins from 3.75 to 11.25 m; their step is 37.47 cm, not 37.5."""
    gate = interval(3.75, 11.25, np.arange(64) * 299_792_458 / 8e8)
    assert (gate.first.tolist(), gate.count) == ([10], 21)


def test_a_single_bin_has_no_step():
    assert around(np.array([3.0, 9.0]), 1.0, np.array([5.0])).count == 1
