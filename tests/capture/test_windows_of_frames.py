"""Data sets of recordings have the maps of frames that simulated data sets of the same have."""

import json
from pathlib import Path

import numpy as np
import pytest
import yaml
from helpers.command_line import ok, radhar

from radhar_cli.dataset.reading import open_dataset
from radhar_cli.dataset.sample_page import sample_entries

OF_FRAMES = ("range_doppler", "range_azimuth", "doppler_azimuth")
MAPS = ("stft", "azimuth_time", "elevation_time", *OF_FRAMES)
CONFIG = {
    "radar": {
        "frame": {"chirps": 64, "interval_s": 250e-6, "period_s": 0.05},
        "carrier_hz": 60e9, "chirp_s": 64e-6, "bandwidth_hz": 1e9, "adc_rate_hz": 2e6,
        "array": {"tx": [[0, 0]], "rx": [[0, 0], [1, 0], [1, 1]]}, "position_m": [0, 0, 1],
    },
    "maps": [*MAPS],
    "activities": ["walking"],
    "samples_per_class": 1,
    "duration_s": 1,
    "snr_db": 20,
    "motion": {"range_m": 3, "cross_range_m": 0.5, "angle_deg": 150},
    "processing": {"range_sum": "coherent"},
    "image": {"size_px": 64, "range_limits_m": [0, 6]},
    "engine": {"kind": "cube"},
    "seed": 3,
}  # fmt: skip


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Folder with a config, the raw recording of its only scene, and a manifest of that."""
    folder = tmp_path_factory.mktemp("frames")
    (folder / "scene.yaml").write_text(yaml.safe_dump(CONFIG))
    ok("simulate", folder / "scene.yaml", "--raw", "--no-figures", "-o", folder / "raw")
    (folder / "list.csv").write_text("file,label\nraw/recording.h5,walking\n")
    return folder


def measured(recorded: Path, out: Path, config: Path, *more: object) -> Path:
    sets = ("--set", "recordings.window_s=0.966", "--jobs", 1)
    ok("generate", config, "--recordings", recorded / "list.csv", "-o", out, *sets, *more)
    return out


def test_they_are_those_of_the_simulated_data_set(recorded: Path, tmp_path: Path) -> None:
    ok("generate", recorded / "scene.yaml", "-o", tmp_path / "simulated", "--jobs", 1)
    again = measured(recorded, tmp_path / "measured", recorded / "scene.yaml")
    with (
        open_dataset(tmp_path / "simulated" / "dataset.h5") as one,
        open_dataset(again / "dataset.h5") as two,
    ):
        assert set(two.products) == {*OF_FRAMES}
        for name in MAPS:
            pair = (one.maps[name][0].astype(int), two.maps[name][0].astype(int))
            assert np.ptp(pair[0]) > 100, name
            assert np.abs(pair[0] - pair[1]).max() <= 1, name
            np.testing.assert_allclose(one.extents(name), two.extents(name), rtol=1e-6, atol=1e-9)
        for name in OF_FRAMES:
            frames = one.products[name][0].astype(int), two.products[name][0].astype(int)
            assert frames[0].shape == frames[1].shape
            assert len(frames[0]) == 20
            assert np.abs(frames[0] - frames[1]).max() <= 1, name
        entry = json.dumps(sample_entries(two, [0]), default=str)
        titles = ("azimuth-time map", "range-Doppler", "range-azimuth", "Doppler-azimuth")
        assert all(f'"{title}"' in entry for title in titles), "the page of a sample shows them"
    ok("verify", again)


def test_the_recording_tells_its_frames_where_the_config_does_not(
    recorded: Path, tmp_path: Path
) -> None:
    keys = ("maps", "image", "processing")
    (tmp_path / "maps.yaml").write_text(yaml.safe_dump({key: CONFIG[key] for key in keys}))
    out = measured(recorded, tmp_path / "set", tmp_path / "maps.yaml")
    radar = yaml.safe_load((out / "config.yaml").read_text())["radar"]
    assert radar["frame"]["chirps"] == 64
    assert len(radar["array"]["rx"]) == 3


def test_what_a_recording_lacks_is_said(recorded: Path, tmp_path: Path) -> None:
    def message(config: Path, manifest: Path, *sets: str) -> str:
        options = [part for text in sets for part in ("--set", text)]
        out = tmp_path / "refused"
        command = ("generate", config, "--recordings", manifest, "-o", out, *options)
        done = radhar(*command, "--jobs", 1)
        assert done.returncode == 2
        assert "Traceback" not in done.stderr
        return done.stderr

    list_csv = recorded / "list.csv"
    points = message(recorded / "scene.yaml", list_csv, "maps=[points]", "recordings.window_s=0.9")
    assert "radhar process" in points
    short = message(recorded / "scene.yaml", list_csv, "recordings.window_s=0.01")
    assert "holds no whole frame" in short
    plain = tmp_path / "plain.yaml"
    plain.write_text(
        "radar: {carrier_hz: 24e9, bandwidth_hz: 1e9, prf_hz: 1000}\nmaps: [stft]\n"
        "activities: [walking]\nduration_s: 1\nrecordings: {window_s: 1}\n"
    )
    ok("simulate", plain, "--raw", "--no-figures", "-o", tmp_path / "raw")
    (tmp_path / "list.csv").write_text("file,label\nraw/recording.h5,walking\n")
    frames = message(plain, tmp_path / "list.csv", "maps=[azimuth_time]")
    assert "radar.frame" in frames
