"""Window, hop and frames that STFT and FSST share."""

import numpy as np
import pytest
from helpers import reference as ref

from radhar_cli.config.data_set import Config
from radhar_cli.config.processing import ProcessingConfig
from radhar_cli.processing.frames import Frames


@pytest.mark.parametrize(
    ("duration", "prf", "length", "hop", "kept", "count"),
    [(4.0, 5000.0, 2000, 200, 19999, 90), (4.0, 128.0, 51, 5, 511, 93)],
    ids=["free space", "through the wall"],
)
def test_settings_of_the_paper(duration, prf, length, hop, kept, count):
    """L = round(0.1 T PRF), hop = round(0.1 L), floor((M - 1 - L)/hop) + 1 frames."""
    window = Config(motion={"model": "paper"}).processing.window_pulses(duration, prf, 77e9)
    frames = Frames.of(window, 0.9)
    assert frames == Frames(length, hop)
    assert len(frames.starts([slice(0, kept)])) == count


@pytest.mark.parametrize(
    ("pulses", "length", "hop"),
    [(450, 45, 5), (250, 25, 3), (150, 15, 2), (145, 15, 2), (94, 9, 1)],
)
def test_halves_are_rounded_up(pulses, length, hop):
    """45 -> 4.5 -> 5 and 25 -> 2.5 -> 3: neither to even, nor down as 0.1 * 45 would in binary."""
    for seconds, prf in ((0.1, float(pulses)), (pulses / 1000, 100.0)):
        window = ProcessingConfig(window_s=seconds).window_pulses(1.0, prf, 77e9)
        assert Frames.of(window, 0.9) == Frames(length, hop)


@pytest.mark.parametrize(
    ("overlap", "hop"), [(0.0, 80), (0.5, 40), (0.75, 20), (0.99, 1), (0.9999, 1)]
)
def test_hop_follows_the_overlap_and_is_never_zero(overlap, hop):
    assert Frames.of(80, overlap) == Frames(80, hop)


@pytest.mark.parametrize(("length", "hop"), [(8, 1), (9, 4), (10, 13), (50, 50)])
@pytest.mark.parametrize("samples", [50, 51, 63, 64])
def test_frames_lie_whole_within_the_signal(length, hop, samples):
    starts = Frames(length, hop).starts([slice(0, samples)]).tolist()
    assert starts == list(ref.frame_starts(samples, length, hop))
    assert samples - hop < starts[-1] + length <= samples


def test_no_frame_lies_across_a_gap():
    """Each stretch begins anew; one shorter than a frame has none."""
    stretches = [slice(0, 30), slice(30, 38), slice(38, 60)]
    assert Frames(9, 7).starts(stretches).tolist() == [0, 7, 14, 21, 38, 45]


@pytest.mark.parametrize("length", [8, 9, 51, 2000])
def test_window_is_a_raised_cosine_between_samples(length):
    g = Frames(length, 1).window
    n = np.arange(length)
    assert g == pytest.approx((1 - np.cos(2 * np.pi * (n + 0.5) / length)) / 2, abs=1e-15)
    assert g == pytest.approx(g[::-1], abs=1e-15)
    assert g.min() > 0
    # Sums of a sampled cosine over whole periods: no sidelobe structure is left to chance.
    assert g.sum() == pytest.approx(length / 2)
    assert np.sum(g**2) == pytest.approx(3 * length / 8)


@pytest.mark.parametrize("length", [8, 9, 51])
def test_window_slope_is_the_derivative_per_sample(length):
    def g(n):
        return (1 - np.cos(2 * np.pi * (n + 0.5) / length)) / 2

    n, h = np.arange(length), 1e-5
    difference = (g(n + h) - g(n - h)) / (2 * h)
    assert Frames(length, 1).window_slope == pytest.approx(difference, abs=1e-9)


def test_windows_of_a_radar_with_frames_lie_within_them() -> None:
    windows = Frames(223, 22)
    assert windows.within(64, are_apart=True) == Frames(64, 64), "one of each frame"
    assert windows.within(64, are_apart=False) == Frames(64, 22)
    assert Frames(16, 4).within(64, are_apart=True) == Frames(16, 64)
    assert Frames(128, 100).within(64, are_apart=False) == Frames(64, 64), "no pulse is left out"
