"""A range gate: which bins a frame shows, and the incoherent sum over them."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from radhar_cli.processing.range_signals import RangeSignals

from radhar_cli.processing import frames as frames_module
from radhar_cli.processing.frames import Frames
from radhar_cli.processing.gate import Gate, GatedPower, around, interval

FRAMES = Frames(32, 5)


def noise(bins: int, pulses: int = 200) -> RangeSignals:
    x = np.random.default_rng(bins).standard_normal((bins, pulses, 2)).view(complex)[..., 0]
    return RangeSignals(x, np.arange(bins) * 0.5, 0.0, 100.0, 1e9)


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
    monkeypatch.setattr(frames_module, "BLOCK_COEFFICIENTS", block)
    signals, count = noise(20), FRAMES.count(200)
    first = np.clip(np.rint(8 + 8 * np.sin(np.arange(count) / 4)), 0, 16).astype(int)
    first[-3:] = 0
    gate = Gate(first, 4)
    found = GatedPower(signals, gate, FRAMES, length, magnitudes, single)
    power = np.concatenate(list(found)) * 4.0**found.exponent
    right = by_definition(signals.x, gate, length, magnitudes)
    assert power == pytest.approx(right, rel=1e-4 if single else 1e-10, abs=1e-6 * right.max())


def test_only_the_bins_that_are_shown_need_be_there():
    signals, gate = noise(20), Gate(np.full(FRAMES.count(200), 7), 5)
    some = RangeSignals(signals.x[gate.bins], signals.ranges[gate.bins], 0.0, 100.0, 1e9, 7)
    whole, part = (GatedPower(s, gate, FRAMES, 32) for s in (signals, some))
    scale = 4.0 ** (whole.exponent - part.exponent)
    assert np.concatenate([*part]) == pytest.approx(scale * np.concatenate([*whole]), rel=1e-12)


def test_one_bin_for_all_frames_is_its_own_stft():
    signals, gate = noise(3), Gate(np.array([1]), 1)
    found = GatedPower(signals, gate, FRAMES, 32)
    power = np.concatenate(list(found)) * 4.0**found.exponent
    every = Gate(np.ones(found.count, int), 1)
    assert power == pytest.approx(by_definition(signals.x, every, 32, False))


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
