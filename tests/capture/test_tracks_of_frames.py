"""A walker of a radar of low carrier with frames, whose Doppler cells are wide, is not lost."""

from pathlib import Path

import h5py
import numpy as np
import pytest
import yaml
from helpers.command_line import radhar

from radhar_cli.capture.tracking import TorsoTrack, least_power, moving_power
from radhar_cli.commands import process
from radhar_cli.motion.skeleton import JOINTS

STEPS = "waveform: sfcw, carrier_hz: 2e9, bandwidth_hz: 1e9, steps: 128, dwell_s: 20e-6"
CHIRPS = "carrier_hz: 2e9, bandwidth_hz: 1e9, adc_rate_hz: 2e6, chirp_s: 64e-6"
TWO_BY_FOUR = "array: {tx: [[-2, 0], [2, 0]], rx: [[-1.5, 0], [-0.5, 0], [0.5, 0], [1.5, 0]]}"
PAIR = "array: {rx: [[0, 0], [1, 0]]}"
RADARS = {
    "steps, pause": f"{STEPS}, frame: {{chirps: 32, period_s: 0.2}}, {TWO_BY_FOUR}",
    "steps, no pause": f"{STEPS}, frame: {{chirps: 32}}, {TWO_BY_FOUR}",
    "chirps, pause": f"{CHIRPS}, frame: {{chirps: 64, interval_s: 250e-6, period_s: 0.2}}, {PAIR}",
    "chirps, no pause": f"{CHIRPS}, frame: {{chirps: 64, interval_s: 5e-3}}, {PAIR}",
}
SCENE = """
radar: {{{radar}, position_m: [0, 0, 1.2]}}
activities: [walking]
duration_s: 2
motion: {{range_m: 5}}
engine: {{kind: cube}}
maps: [stft, range_doppler]
"""
POSITION = np.array([0, 0, 1.2])


def recorded(folder: Path, radar: str) -> tuple[Path, Path]:
    """Config and folder of a scene of a walker who recedes from 5 to 7.4 m."""
    config, scene = folder / "scene.yaml", folder / "scene"
    config.write_text(SCENE.format(radar=radar))
    done = radhar("simulate", config, "-o", scene, "--raw", "--no-figures")
    assert done.returncode == 0, done.stderr
    return config, scene


@pytest.mark.parametrize("radar", RADARS)
def test_a_walker_is_followed_and_the_map_is_that_of_the_scene(tmp_path: Path, radar: str) -> None:
    config, folder = recorded(tmp_path, RADARS[radar])
    out = tmp_path / "out"
    command = ("process", folder / "recording.h5", "--config", config, "--no-figures", "-o", out)
    done = radhar(*command)
    assert done.returncode == 0, done.stderr
    assert "the torso's track" not in done.stderr
    with h5py.File(folder / "scene.h5") as scene, h5py.File(out / "maps.h5") as processed:
        place = scene["truth/positions"][:, JOINTS.index("torso")]
        truth = np.linalg.norm(place - POSITION, axis=1)
        assert truth.max() - truth.min() > 2
        at = np.interp(processed["track/time"][:], scene["truth/time"][:], truth)
        assert np.abs(processed["track/range"][:] - at).max() < 0.15
        assert processed["track/confidence"][:].min() > 0.5
        expected, result = scene["maps/stft"][:], processed["maps/stft"][:]
        assert expected.shape == result.shape
        columns = 10 * np.log10(result.sum(axis=0) / expected.sum(axis=0))
        assert np.abs(columns).max() < 0.5, "dB"


@pytest.mark.parametrize("looks", [1, 4])
def test_white_noise_has_no_moving_power(looks: int) -> None:
    rng = np.random.default_rng(0)
    power = rng.gamma(looks, 3.0, (200, 160))
    power[7] += 1000
    profile = moving_power(power, looks)
    assert profile[7] == pytest.approx(160 * 1000, rel=0.02)
    assert abs(np.delete(profile, 7).mean()) < 0.01 * 3 * looks * 160


@pytest.mark.parametrize("looks", [1, 4])
def test_noise_hardly_has_the_least_power(looks: int) -> None:
    """Noise under Hann's windows along both axes, summed over receivers."""
    rng, window = np.random.default_rng(0), np.hanning(66)[1:-1]
    shares = []
    for _ in range(50):
        pairs = rng.standard_normal((2, looks, 64, 64))
        noise = (pairs[0] + 1j * pairs[1]) * window[:, None] * window
        power = np.square(np.abs(np.fft.fft2(noise))).sum(axis=0)
        shares.append(moving_power(power, looks).sum() / least_power(power, looks))
    assert abs(np.mean(shares)) < 0.25
    assert 0.15 < np.std(shares) < 0.6, "about a third"
    assert np.max(shares) < 1.3


def track_of(confidence: list[float]) -> TorsoTrack:
    """Track of a torso at 3 m in frames 0.1 s apart."""
    frames = len(confidence)
    still, time = np.full(frames, 3.0), 0.1 * np.arange(frames)
    return TorsoTrack(time, still, np.zeros(frames), np.array(confidence))


def test_an_unsure_track_is_doubted_from_where_it_may_be_lost() -> None:
    assert track_of([1, 1, 1, 0.2]).is_reliable, "a quarter"
    lost = track_of([1, 1, 1, 0.2, 0, 0])
    assert not lost.is_reliable
    assert "may be lost from 0.30 s on: it is unsure in 3 of 6" in process._describe_doubt(lost)
    assert "unsure in 3 of 6" in process._describe_doubt(track_of([0, 0, 0, 1, 1, 1]))
    assert "from" not in process._describe_doubt(track_of([0, 0, 0, 1, 1, 1]))
    assert "from 0.00 s on" in process._describe_doubt(track_of([0, 0, 0]))


def test_what_may_be_lost_is_said_and_its_ranges_are_not_fitted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """As if another stood where the track is, and the walker were elsewhere in later frames."""
    config, folder = recorded(tmp_path, RADARS["steps, pause"])
    recording, fitted = folder / "recording.h5", tmp_path / "fitted.yaml"
    done = radhar("fit", recording, "-o", fitted)
    assert done.returncode == 0, done.stderr
    low, high = yaml.safe_load(fitted.read_text())["motion"]["place"]["range_m"]["uniform"]
    assert high - low > 1.5
    monkeypatch.setattr("radhar_cli.capture.tracking.NEAR_M", 0.0)
    done = radhar("fit", recording, "-o", fitted, "--overwrite")
    assert done.returncode == 0, done.stderr
    assert "ranges of 1 of 1 parts are left out" in done.stderr
    assert "motion" not in yaml.safe_load(fitted.read_text())
    done = radhar("process", recording, "--config", config, "-o", tmp_path / "p", "--no-figures")
    assert done.returncode == 0, done.stderr
    assert "warning: the torso's track may be lost from" in done.stderr
