"""Commands with several radars of the same scenes: made for each, or refused in a line."""

import json
import shutil
from pathlib import Path

import h5py
import numpy as np
import pytest
from helpers.command_line import ok, radhar
from helpers.small import fingerprint

from radhar_cli.config import load_radars
from radhar_cli.dataset.radar_folders import RADARS
from radhar_cli.dataset.reading import open_dataset

TEXT = """
seed: 3
samples_per_class: 3
activities: [walking, grabbing]
duration_s: 1.5
image: {size_px: 16}
radar: {prf_hz: 2000}
people: [{activity: walking, share: 0.5}]
radars:
  side: {aspect: {angle_deg: 90, distance_m: 4, about_m: [3, 0]}, maps: [rtm, stft]}
  front: {}
"""


@pytest.fixture(scope="module")
def config(tmp_path_factory):
    path = tmp_path_factory.mktemp("several") / "several.yaml"
    path.write_text(TEXT)
    return path


@pytest.fixture(scope="module")
def built(config):
    out = config.parent / "built"
    ok("generate", config, "-o", out, "--jobs", 1)
    return out


@pytest.fixture(scope="module")
def scene(config):
    out = config.parent / "scene"
    ok("simulate", config, "-a", "walking", "-o", out, "--no-figures", "--raw")
    return out


def test_each_radar_has_a_data_set_of_the_same_samples(built):
    assert json.loads((built / RADARS).read_text()) == {"radars": ["front", "side"]}
    assert sorted(path.name for path in built.iterdir()) == ["front", RADARS, "side"]
    with open_dataset(built / "front") as front, open_dataset(built / "side") as side:
        assert (front.config.maps, side.config.maps) == (("stft",), ("rtm", "stft"))
        for name in ("label", "split", "labels", "person_label", "sample_key"):
            assert np.array_equal(getattr(front, name)[:], getattr(side, name)[:]), name
        assert np.array_equal(front.scene["height"][:], side.scene["height"][:])
        assert not np.isclose(front.scene["aspect"][:], side.scene["aspect"][:]).any()
        absent = front.person_label[:, 1] < 0
        assert np.array_equal(np.isnan(front.scene["people_1_aspect"][:]), absent)
        assert not np.array_equal(front.maps["stft"][0], side.maps["stft"][0])


def test_build_again_does_nothing_and_resumes_what_is_missing(config, built):
    done = ok("generate", config, "-o", built, "--json")
    results = json.loads(done.stdout)["radars"]
    assert [(name, one["made"]) for name, one in results.items()] == [("front", 0), ("side", 0)]
    before = fingerprint(built / "side")
    shutil.rmtree(built / "side")
    ok("generate", config, "-o", built, "--jobs", 1)
    assert fingerprint(built / "side") == before


def test_order_of_radars_changes_no_byte(config, built, tmp_path):
    side, front = TEXT.splitlines()[-2:]
    path = tmp_path / "other.yaml"
    path.write_text("\n".join([*TEXT.splitlines()[:-2], front, side, ""]))
    ok("generate", path, "-o", tmp_path / "out", "--jobs", 1)
    for name in ("front", "side"):
        assert fingerprint(tmp_path / "out" / name) == fingerprint(built / name)


def test_one_radar_alone_is_the_same_data_set(config, built, tmp_path):
    ok("generate", config, "-o", tmp_path / "one", "--set", "radar_name=side", "--jobs", 1)
    assert fingerprint(tmp_path / "one") == fingerprint(built / "side")


def test_parts_merge_to_the_same(config, built, tmp_path):
    out = tmp_path / "parts"
    for part in ("1/2", "2/2"):
        done = ok("generate", config, "-o", out, "--shard", part, "--jobs", 1)
        assert f"radhar merge {out}\n" in done.stdout
    done = ok("merge", out, "--json")
    assert [*json.loads(done.stdout)["radars"]] == ["front", "side"]
    for name in ("front", "side"):
        with open_dataset(out / name) as one, open_dataset(built / name) as other:
            assert np.array_equal(one.maps["stft"][0], other.maps["stft"][0])
    assert "the same people" in ok("verify", out, "--samples", 1).stdout


def test_parts_of_other_machines_merge_into_a_new_folder(config, built, tmp_path):
    places = [tmp_path / "a", tmp_path / "b"]
    for number, place in enumerate(places, 1):
        ok("generate", config, "-o", place, "--shard", f"{number}/2", "--jobs", 1)
    ok("merge", tmp_path / "out", *places)
    assert fingerprint(tmp_path / "out") == fingerprint(built)
    assert "the same people" in ok("verify", tmp_path / "out", "--samples", 0).stdout
    ok("generate", config, "-o", tmp_path / "c", "--set", "radars.third={}", "--shard", "1/2")
    done = radhar("merge", tmp_path / "other", places[0], tmp_path / "c")
    assert done.returncode == 2
    assert "holds parts of the radars front, side, third, not front, side" in done.stderr
    assert not (tmp_path / "other").exists()


def test_verify_finds_other_people(config, built, tmp_path):
    done = ok("verify", built, "--samples", 2)
    assert "2 radars: the same people, labels and splits in every sample" in done.stdout
    other = tmp_path / "mixed"
    ok("generate", config, "-o", other, "--jobs", 1, "--set", "seed=4")
    ok("generate", config, "-o", tmp_path / "one", "--set", "radar_name=side", "--jobs", 1)
    (other / "side").rename(tmp_path / "away")
    (tmp_path / "one").rename(other / "side")
    done = radhar("verify", other, "--samples", 0)
    assert done.returncode == 1
    assert "should be of the same people" in done.stdout


@pytest.mark.parametrize("held", ["notes.txt", "front/dataset.h5", "other"])
def test_foreign_folders_are_refused(config, tmp_path, held):
    path = tmp_path / held
    path.parent.mkdir(exist_ok=True)
    path.mkdir() if held == "other" else path.write_text("mine")
    for command in ("generate", "simulate"):
        more = ["-a", "walking"] if command == "simulate" else []
        done = radhar(command, config, "-o", tmp_path, *more)
        assert done.returncode == 2
        assert "choose an empty folder" in done.stderr


def test_folder_of_other_radars_is_refused(config, built):
    done = radhar("generate", config, "-o", built, "--set", "radars.third={}")
    assert done.returncode == 2
    assert "holds the radars front, side, not front, side, third" in done.stderr


def test_a_difference_has_the_key_of_the_file(config, built):
    for name in ("front", "side"):
        done = radhar("generate", config, "-o", built, "--set", f"radars.{name}.prf_hz=1000")
        assert done.returncode == 2
        assert f"\n  radars.{name}.prf_hz: 2000.0 there, 1000.0 here" in done.stderr
        assert "other_radars" not in done.stderr


def test_what_is_not_made_yet_is_named_with_the_command_that_makes_it(config, built, tmp_path):
    out = tmp_path / "out"
    shutil.copytree(built, out)
    shutil.rmtree(out / "side")
    (out / "side").mkdir()
    goes_on = f"`radhar generate CONFIG -o {out}` goes on with all radars"
    for command in (["verify", out], ["verify", out / "side"]):
        done = radhar(*command)
        assert (done.returncode, goes_on in done.stderr) == (2, True)
        assert "front" not in done.stderr + done.stdout
    (out / "side").rmdir()
    for command in ("inspect", "preview", "audit"):
        done = radhar(command, out / "side")
        assert (done.returncode, goes_on in done.stderr) == (2, True)
    ok("generate", config, "-o", tmp_path / "parts", "--shard", "1/2", "--jobs", 1)
    lines = radhar("verify", tmp_path / "parts").stderr.splitlines()
    assert len(lines) == 2
    assert all(f"`radhar merge {tmp_path / 'parts'}` puts" in line for line in lines)


def test_a_warning_names_its_radar(config, tmp_path):
    done = ok("generate", config, "-o", tmp_path / "out", "--jobs", 1, "-q")
    warnings = [line for line in done.stderr.splitlines() if "warning" in line]
    assert warnings
    assert all("warning: radar " in line for line in warnings)


def test_dry_run_writes_nothing(config, tmp_path):
    done = ok("generate", config, "-o", tmp_path / "none", "--dry-run")
    assert done.stdout.count("radar ") >= 2
    assert not (tmp_path / "none").exists()


def test_scene_of_each_radar_has_its_truth_and_reads_back(config, scene, tmp_path):
    truths = {}
    for name in ("front", "side"):
        again = tmp_path / name
        ok("simulate", scene / name / "scene.yaml", "-o", again, "--index", 0, "--no-figures")
        with h5py.File(scene / name / "scene.h5") as one, h5py.File(again / "scene.h5") as other:
            assert np.array_equal(one["slow_time/raw"], other["slow_time/raw"])
            assert one.attrs["config"] == other.attrs["config"]
            truths[name] = one["truth/positions"][:], one["truth/aspect"][:]
        assert (scene / name / "recording.h5").exists()
        assert json.loads((scene / name / "scene.json").read_text())["radar"] == name
    assert np.array_equal(truths["front"][0], truths["side"][0])
    assert not np.isclose(truths["front"][1], truths["side"][1]).any()


ONE_DATA_SET = {
    "train": ["-o", "OUT"],
    "preview": [],
    "audit": [],
    "inspect": [],
    "convert": ["--to", "parquet", "-o", "OUT"],
    "view": ["-o", "OUT.html"],
    "compare": ["DATA/side", "-o", "OUT"],
}


@pytest.mark.parametrize("command", ONE_DATA_SET)
def test_commands_that_take_one_data_set_name_those_of_the_radars(built, tmp_path, command):
    more = [
        one.replace("DATA", str(built)).replace("OUT", str(tmp_path / "out"))
        for one in ONE_DATA_SET[command]
    ]
    done = radhar(command, built, *more)
    assert done.returncode == 2
    assert f"give {built / 'front'}, {built / 'side'}" in done.stderr


ONE_CONFIG = {
    "tradeoff": ["-o", "OUT", "--quick"],
    "limits": ["--minutes", "0.01"],
    "generate": ["-o", "OUT", "--recordings", "none.csv"],
}


@pytest.mark.parametrize("command", ONE_CONFIG)
def test_commands_that_take_one_radar_ask_for_its_name(config, tmp_path, command):
    more = [one.replace("OUT", str(tmp_path / "out")) for one in ONE_CONFIG[command]]
    done = radhar(command, config, *more)
    assert done.returncode == 2
    assert "radars: has several radars, front and side; should be one here" in done.stderr


def test_process_takes_the_chosen_radar(config, scene, tmp_path):
    recording = scene / "side" / "recording.h5"
    done = radhar("process", recording, "--config", config, "-o", tmp_path / "maps")
    assert "--set radar_name=front" in done.stderr
    ok(
        *("process", recording, "--config", config, "--set", "radar_name=side"),
        *("-o", tmp_path / "maps", "--no-figures"),
    )
    assert (tmp_path / "maps" / "maps.h5").exists()


def test_config_show_shows_each(config):
    shown = json.loads(ok("config", "show", config, "--json").stdout)["radars"]
    assert [*shown] == ["front", "side"]
    assert shown["side"]["tx_m"][1] == pytest.approx(-4)
    assert (shown["front"]["maps"], shown["side"]["maps"]) == (["stft"], ["rtm", "stft"])


def test_what_config_show_prints_makes_the_same(config, tmp_path):
    path = tmp_path / "shown.yaml"
    path.write_text(ok("config", "show", config).stdout)
    assert load_radars(path) == load_radars(config)


def test_motion_is_that_of_all(config, tmp_path):
    out = [tmp_path / "all.bvh", tmp_path / "side.bvh"]
    ok("motion", config, "-a", "walking", "-o", out[0])
    ok("motion", config, "-a", "walking", "-o", out[1], "--set", "radar_name=side")
    assert out[0].read_bytes() == out[1].read_bytes()


def test_damaged_list_is_refused(tmp_path: Path):
    for text in ('{"radars": ["../a"]}', "{", "[]", '{"radars": []}', '{"radars": [1]}'):
        (tmp_path / RADARS).write_text(text)
        done = radhar("verify", tmp_path)
        assert done.returncode == 2
        assert "is damaged" in done.stderr
