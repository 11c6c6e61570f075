"""`radhar compare` as a user calls it."""

import json
from pathlib import Path

import numpy as np
import pytest
from helpers.command_line import ok, radhar
from helpers.documented import KEYS
from PIL import Image

CONFIG = """
samples_per_class: 24
activities: [walking, punching]
duration_s: 3.0
radar: {carrier_hz: 10e9, bandwidth_hz: 1e9, prf_hz: 500}
snr_db: 20
maps: [rtm, stft]
image: {size_px: 64}
output: {png: false}
split: {train: 0.67, validation: 0.33}
"""


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """People who walk on their feet, twice, and the paper's."""
    folder = tmp_path_factory.mktemp("compare")
    (folder / "c.yaml").write_text(CONFIG)
    for name, sets in {
        "human": ["seed=1"],
        "others": ["seed=2"],
        "paper": ["seed=2", "motion.model=paper"],
    }.items():
        more = [part for one in sets for part in ("--set", one)]
        ok("generate", folder / "c.yaml", "-o", folder / name, "--jobs", 1, *more)
    return folder


def report(place, one, other):
    out = place / f"{one}_{other}"
    options = ("--json", "--map", "stft")
    done = ok("compare", place / one, place / other, "-o", out, *options)
    expected = json.loads(done.stdout)
    assert expected.keys() == KEYS["compare"]
    found: dict[str, dict[str, object]] = json.loads((out / "report.json").read_text())
    for key in ("test", "classes", "warnings"):
        assert expected[key] == found[key]
    for file in expected["files"]:
        assert Path(file).stat().st_size > 0
        if file.endswith(".png"):
            assert np.asarray(Image.open(file)).std() > 0
    return found


@pytest.mark.slow
def test_the_papers_motion_differs_from_people_and_people_not_from_people(place):
    same = report(place, "human", "others")
    low, high = same["test"]["accuracy_95"]
    assert low < 0.5 < high
    other = report(place, "paper", "others")
    assert other["test"]["accuracy_95"][0] > 0.85
    statistics = other["classes"]["walking"]["statistics"]
    assert "limb_below_torso" in statistics, "levels of known decibels tell power"
    assert {one["unit"] for one in statistics.values()} == {"%", "Hz", "s", "dB", ""}


def few(place, out, map_name="stft"):
    """The command on walking alone."""
    (place / "walking.yaml").write_text("punching: null\n")
    options = ("--per-class", 6, "--classes", place / "walking.yaml")
    return ["compare", place / "human", place / "paper", "-o", out, "--map", map_name, *options]


def test_repeated_compare_writes_the_same_bytes_and_removes_old_files(place, tmp_path):
    other = tmp_path / "b"
    other.mkdir()
    for name in ("old.png", "mine.png"):
        (other / name).touch()
    (other / "report.json").write_text('{"files": ["old.png", "../mine.txt"]}')
    (tmp_path / "mine.txt").touch()
    done = ok(*few(place, tmp_path / "a"))
    for word in ("walking: ", "% told apart (", "all classes: "):
        assert word in done.stdout
    assert "--overwrite replaces them" in radhar(*few(place, other)).stderr
    again = radhar(*few(place, other), "-q", "--overwrite")
    assert (again.returncode, again.stdout) == (0, "")
    files = sorted(p.name for p in (tmp_path / "a").iterdir() if p.is_file())
    assert files == [
        *("pictures.png", "report.json", "statistics.csv"),
    ]
    for name in files:
        assert (tmp_path / "a" / name).read_bytes() == (other / name).read_bytes(), name
    assert (other / "mine.png").exists()
    assert not (other / "old.png").exists()
    assert (tmp_path / "mine.txt").exists()


def test_what_noise_leaves_undefined_is_left_out_and_named(place, tmp_path):
    """At -10 dB nobody stands out of the noise in some maps, or in none."""
    options = ("--set", "snr_db=-10", "--set", "samples_per_class=6", "--jobs", 1)
    weak = tmp_path / "weak"
    assert radhar("generate", place / "c.yaml", "-o", weak, *options).returncode == 0
    done = ok("compare", weak, place / "human", "-o", tmp_path / "out", "--map", "stft")
    assert "nan" not in done.stdout
    statistics = json.loads((tmp_path / "out/report.json").read_text())["classes"]["walking"]
    for name in ("fast_energy", "receding_energy", "torso_energy"):
        for side in ("simulated", "measured"):
            found = statistics["statistics"][name][side]
            assert found["known"] < 6 or side == "measured"
            assert found["mean"] is None or 0 <= found["mean"] <= 100, name


def test_a_range_time_map(place, tmp_path):
    ok(*few(place, tmp_path / "r", "rtm"))
    found = json.loads((tmp_path / "r/report.json").read_text())
    assert found["units"] == {"rows": "m", "columns": "s"}
    assert "noise_sd" not in found["classes"]["walking"]["statistics"]
