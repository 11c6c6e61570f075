"""simulate, preview and inspect as a user meets them."""

import json
from pathlib import Path
from shutil import copytree

import h5py
import numpy as np
import pytest
from helpers.command_line import ok, radhar
from helpers.small import SMALL, small_config

from radhar_cli.config.maps import CADENCE_MAPS, MAP_NAMES


def test_simulate_writes_everything(tmp_path):
    """A tenth of a second: two frames of animation are drawn as a hundred are."""
    config, out = small_config(tmp_path), tmp_path / "out"
    short = ("--set", "duration_s=0.1", "--set", "radar.prf_hz=2000", "--maps", "stft,rtm")
    ok("simulate", config, "-a", "S12", "--seed", 3, "-o", out, "--overlay", *short)
    names = sorted(p.name for p in out.iterdir())
    assert names == ["maps.png", "scene.h5", "scene.json", "scene.yaml", "stickman.gif"]
    described = json.loads((out / "scene.json").read_text())
    assert described["seed"] == 3
    looked = ok("inspect", out)
    assert "walking_to_falling" in looked.stdout


def test_simulate_for_scripts(tmp_path):
    out = tmp_path / "out"
    ok(
        *("simulate", small_config(tmp_path), "-a", "walking", "-o", out, "--no-figures"),
        *(
            "--set",
            "engine.kind=cube",
            "--maps",
            "stft,rtm",
            "--raw",
            "--joint",
            "head",
            "--nominal",
        ),
    )
    files = {"recording.h5", "scene.h5", "scene.json", "scene.yaml"}
    assert {p.name for p in out.iterdir()} == files
    described = json.loads((out / "scene.json").read_text())
    assert described["engine"] == "cube"
    assert described["accuracy"] is None
    assert described["joint"] == "head"
    assert set(described["entropy_bits"]) == {"stft", "rtm"}


def test_simulate_says_how_accurate_it_is(tmp_path):
    chosen = []
    for budget in ("-40", "-100"):
        out = tmp_path / budget
        ok(
            *("simulate", small_config(tmp_path), "-a", "walking", "-o", out, "--no-figures"),
            *("--tolerance", budget, "--maps", "stft"),
        )
        accuracy = json.loads((out / "scene.json").read_text())["accuracy"]
        assert accuracy["tolerance_db"] == float(budget)
        assert accuracy["error_db"] < float(budget)
        chosen.append(accuracy["table_oversampling"])
    assert chosen[0] < chosen[1]
    refused = radhar(
        *("simulate", small_config(tmp_path), "-a", "walking", "-o", out, "--tolerance", "-5")
    )
    assert refused.returncode == 2
    assert "engine.tolerance_db = -5" in refused.stderr


def test_a_tolerance_looser_than_the_default_is_said_to_run_as_it_once(tmp_path):
    config, loose = small_config(tmp_path), ("--tolerance", "-40")
    once = "engine.tolerance_db: -40 is looser than the default and runs as -80"
    for number, command in enumerate(
        (
            ("simulate", config, "-a", "walking", "--no-figures", "--maps", "stft"),
            ("generate", config, "--jobs", "1"),
            ("generate", config, "--dry-run"),
        )
    ):
        done = ok(*command, *loose, "-o", tmp_path / str(number))
        assert done.stderr.count(once) + done.stdout.count(once) == 1, command
    for scene in ("usual", "looser"):
        more = loose * (scene == "looser")
        ok(*("simulate", config, "-a", "walking", "--no-figures", "-o", tmp_path / scene), *more)
    usual, looser = (h5py.File(tmp_path / scene / "scene.h5") for scene in ("usual", "looser"))
    with usual, looser:
        assert np.array_equal(usual["slow_time/raw"], looser["slow_time/raw"])


def test_preview_and_inspect(small_set, tmp_path):
    out = Path(copytree(small_set, tmp_path / "set"))
    sheet = ok("preview", out, "--map", "stft", "--per-class", 2)
    assert (out / "preview_stft.png").exists()
    assert "half-band" not in sheet.stdout
    table = radhar("inspect", out)
    assert "punching" in table.stdout
    found = json.loads(radhar("inspect", out, "--json").stdout)
    assert found["samples"] == 9


def test_preview_replaces_its_own_sheet_and_no_other_file(small_set, tmp_path):
    out = Path(copytree(small_set, tmp_path / "set"))
    for _ in range(2):
        ok("preview", out, "--map", "stft", "--per-class", 1)
    named = tmp_path / "photo.png"
    named.write_text("mine")
    refused = radhar("preview", out, "--map", "stft", "-o", named)
    assert refused.returncode == 2
    assert f"{named}: already exists; --overwrite replaces it" in refused.stderr
    assert named.read_text() == "mine"
    ok("preview", out, "--map", "stft", "--per-class", 1, "-o", named, "--overwrite")
    assert named.read_bytes() == (out / "preview_stft.png").read_bytes()


def test_simulate_refuses_a_folder_of_other_things(tmp_path):
    config, out = small_config(tmp_path), tmp_path / "out"
    once = ("simulate", config, "-a", "S8", "--no-figures", "--maps", "rtm", "-o")
    refused = radhar(*once, tmp_path)
    assert refused.returncode == 2
    assert "holds small.yaml but no scene of radhar's; choose an empty folder" in refused.stderr
    assert [path.name for path in tmp_path.iterdir()] == ["small.yaml"]
    assert radhar(*once, out).returncode == 0
    (out / "notes.txt").touch()
    assert radhar(*once, out, "--overwrite").returncode == 0, "a folder with a scene may be used"
    assert (out / "notes.txt").exists()


def test_simulate_replaces_nothing_unless_it_is_told_to(tmp_path):
    """A recording of an earlier run is neither removed nor overwritten."""
    scene = ("simulate", small_config(tmp_path), "-a", "S8", "--no-figures", "--maps", "rtm")
    scene = (*scene, "-o", tmp_path / "out")
    ok(*scene, "--raw")
    before = {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()}
    assert "recording.h5" in before
    for raw in ((), ("--raw",)):
        refused = radhar(*scene, *raw, "--seed", 2)
        assert refused.returncode == 2
        assert "holds scene.h5, scene.json, scene.yaml, ... of an earlier run" in refused.stderr
        assert "--overwrite replaces them" in refused.stderr
    assert {path.name: path.read_bytes() for path in (tmp_path / "out").iterdir()} == before
    ok(*scene, "--seed", 2, "--overwrite")
    assert not (tmp_path / "out/recording.h5").exists(), "of another scene"


def test_simulate_makes_the_maps_of_the_config_or_all(tmp_path):
    scene = ("simulate", small_config(tmp_path), "-a", "S8", "--no-figures")
    for name, more, maps in (
        ("own", (), {"rtm", "stft", "fsst_compensated"}),
        ("all", ("--maps", "all"), {*MAP_NAMES, *CADENCE_MAPS}),
        ("one", ("--maps", "fsst"), {"fsst"}),
    ):
        ok(*scene, *more, "-o", tmp_path / name)
        with h5py.File(tmp_path / name / "scene.h5") as file:
            assert set(file["maps"]) == maps
            assert file["slow_time/raw"].size


def test_an_index_that_no_data_set_has_is_warned_of(tmp_path):
    what = ("simulate", small_config(tmp_path), "-a", "S8", "--no-figures", "--maps", "rtm")
    done = ok(*what, "-o", tmp_path / "a", "--index", 3)
    assert "--index 3: a data set of this config has the samples 0 to 2 of walking" in done.stderr
    assert "--index" not in radhar(*what, "-o", tmp_path / "b", "--index", 2).stderr


@pytest.mark.parametrize(
    ("word", "slug", "said"),
    [
        ("boxing", "boxing", ""),
        ("Shadow-Boxing", "shadow_boxing", ""),
        ("Punching", "punching", ""),
        ("S2", "punching", ""),
        ("crawl", "crawling", "--activity: crawl is taken for crawling\n"),
    ],
)
def test_a_word_for_one_of_the_twelve_is_kept(tmp_path, word, slug, said):
    """As `activities` of a config keeps it; the scene is the same by any name."""
    config = small_config(tmp_path, SMALL.replace("motion: {model: paper}", ""))
    look = ("simulate", config, "--no-figures", "--maps", "stft")
    done = ok(*look, "--activity", word, "-o", tmp_path / "out")
    assert done.stderr == said
    scene = json.loads((tmp_path / "out/scene.json").read_text())
    assert scene["activity"]["slug"] == slug
    if slug.endswith("boxing"):
        ok(*look, "--activity", "punching", "-o", tmp_path / "other")
        other = json.loads((tmp_path / "other/scene.json").read_text())
        assert other["parameters"] == scene["parameters"]
