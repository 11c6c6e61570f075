"""Slow time is processed without a config; maps of it are no data set."""

from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers.command_line import ok, radhar
from PIL import Image


@pytest.fixture
def walk(tmp_path: Path) -> Path:
    tone = np.exp(2j * np.pi * 0.1 * np.arange(2000))
    np.save(tmp_path / "x.npy", tone + 3)
    sets = ("--set", "carrier_hz=24e9", "--set", "prf_hz=1000")
    ok("import", tmp_path / "x.npy", *sets, "-o", tmp_path / "walk.h5")
    return tmp_path / "walk.h5"


def test_slow_time_needs_no_config(walk: Path, tmp_path: Path) -> None:
    done = radhar("process", walk, "-o", tmp_path / "maps", "--no-figures")
    assert done.returncode == 0, done.stderr
    assert "without --config: maps stft" in done.stdout
    with h5py.File(tmp_path / "maps/maps.h5") as file:
        power, frequency = file["maps/stft"][:], file["axes/stft/frequency"][:]
    assert frequency[power.sum(axis=1).argmax()] == pytest.approx(100, abs=8)
    done = radhar("process", walk, "-o", tmp_path / "fine", "--set", "maps=[fsst]", "--no-figures")
    assert done.returncode == 0, done.stderr
    with h5py.File(tmp_path / "fine/maps.h5") as file:
        assert [*file["maps"]] == ["fsst"]


def test_a_map_that_slow_time_has_not_is_refused(walk: Path, tmp_path: Path) -> None:
    done = radhar("process", walk, "-o", tmp_path / "maps", "--maps", "rtm")
    assert done.returncode == 2
    assert "cw has no range" in done.stderr


@pytest.mark.parametrize("name", ["", "maps.h5"])
@pytest.mark.parametrize("side", [0, 1])
def test_maps_of_a_recording_are_no_data_set(
    walk: Path, tmp_path: Path, name: str, side: int
) -> None:
    ok("process", walk, "-o", tmp_path / "maps", "--no-figures")
    rng = np.random.default_rng(0)
    for n in range(4):
        path = tmp_path / "tree" / "walking" / f"{n}.png"
        path.parent.mkdir(parents=True, exist_ok=True)
        Image.fromarray(rng.integers(0, 255, (16, 16)).astype(np.uint8)).save(path)
    paths = [tmp_path / "maps" / name, tmp_path / "tree"]
    done = radhar("compare", paths[side], paths[1 - side], "-o", tmp_path / "out")
    assert done.returncode == 2
    assert "is no data set: `radhar generate CONFIG --recordings MANIFEST" in done.stderr
    assert done.stderr.count("\n") == 1
